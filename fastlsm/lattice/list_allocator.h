/* list_allocator.h - which rows of a body's lists (subsum_lists.h) are in use, so that regions can
 * change one by one when links break.
 *
 * Every layer of planes gets spare rows behind its own. Equal rows are still stored once; a row
 * that nothing names any more becomes free for the next one of its layer. */
#ifndef LSM_LIST_ALLOCATOR_H
#define LSM_LIST_ALLOCATOR_H

#include "subsum_lists.h"

/* Bars or plates. */
typedef struct {
    int side;
    int *row;         /* [rows][side] the lists: lists->bar or lists->plate */
    const int *shift; /* [planes] bar_shift or plate_shift */
    int *uses;        /* [rows] how many plates (regions) name this bar (plate); 0: free */
    int *next;        /* [rows] the next in its bucket or list of free rows, or 0 */
    int *bucket;      /* [mask + 1] the first row with this hash, or 0 */
    uint64_t mask;
    int *free_row;          /* [layers] the first row given back */
    const int *layer_plane; /* [layers + 1] its first plane */
    const long *limit;      /* [planes + 1] lists->bar_plane or plate_plane */
    long *end;              /* [planes + 1] lists->bar_end or plate_end */
} LsmRowStore;

typedef struct {
    LsmRowStore bars, plates;
    int *layer; /* [planes] */
} LsmListAllocator;

/* Gives each layer (planes layer_plane[l] .. layer_plane[l + 1] - 1) a quarter more rows and
 * `spare` on top: rows get new numbers, which still are their places. O(rows). */
void lsm_allocator_make_room(LsmLists *lists, int layers, const int *layer_plane, long spare);

/* Opens the books of lists that have room and their places; region_plane[region_count]. O(rows). */
void lsm_allocator_open(LsmLists *lists, int layers, const int *layer_plane,
                        const int *region_plane, LsmListAllocator *allocator);
void lsm_allocator_free(LsmListAllocator *allocator);

/* Lists the members `rows` (region.h) of particle p as row `region` of the lists, in place of what
 * that row listed. O((2w+1)^2 + members). False when a layer has no row left: the lists are then
 * spoilt and must be built anew, with more to spare. */
bool lsm_allocator_revise(LsmListAllocator *allocator, LsmLists *lists, const LsmLattice *lattice,
                          const int *slot, long p, long region, const LsmRow *rows);

#endif
