/* ledger.h - which rows of a body's lists (sets.h) are in use, so that regions can change one by
 * one when links break.
 *
 * Every layer of planes gets spare rows behind its own. Equal rows are still stored once; a row
 * that nothing names any more becomes free for the next one of its layer. */
#ifndef LSM_LEDGER_H
#define LSM_LEDGER_H

#include "sets.h"

/* Bars or plates. */
typedef struct {
    int side;
    int *row;    /* [rows][side] the lists: sets->bar or sets->plate */
    int *uses;   /* [rows] how many plates (regions) name this bar (plate); 0: free */
    int *next;   /* [rows] the next in its bucket or list of free rows, or 0 */
    int *bucket; /* [mask + 1] the first row with this hash, or 0 */
    uint64_t mask;
    int *free_row;     /* [planes + 1] first row given back, at the end of its layer's planes */
    const long *limit; /* [planes + 1] sets->bar_plane or plate_plane */
    long *end;         /* [planes + 1] sets->bar_end or plate_end */
} LsmShelf;

typedef struct {
    LsmShelf bars, plates;
    int *layer_end; /* [planes] the plane behind the layer of each plane */
    long bytes;
} LsmLedger;

/* Gives each layer (planes layer_plane[l] .. layer_plane[l + 1] - 1) a quarter more rows and
 * `spare` on top, and opens the books: rows get new numbers. O(rows). */
void lsm_ledger_open(LsmSets *sets, int layers, const int *layer_plane, long spare,
                     LsmLedger *ledger);
void lsm_ledger_free(LsmLedger *ledger);

/* Lists the members `rows` (region.h) of particle p as row `region` of the sets, in place of what
 * that row listed. O((2w+1)^2 + members). False when a layer has no row left: the lists are then
 * spoilt and must be built anew, with more to spare. */
bool lsm_ledger_revise(LsmLedger *ledger, LsmSets *sets, const LsmLattice *lattice, const int *slot,
                       long p, long region, const uint64_t *rows);

#endif
