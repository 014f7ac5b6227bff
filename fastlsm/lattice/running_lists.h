/* running_lists.h - lists (subsum_lists.h) in which most rows are made from a neighbour's sum: the
 * fast summation of fastlsm section 3.1 for any shape, whose cost a row does not depend on w.
 *
 * The bar around x holds the bar around x - 1, moved on by one place, less the member that leaves
 * it and with the one that enters; so does a plate along y and a region along z. Where material
 * ends a few more members differ, and each is one more term; a variant around the same place may be
 * nearer still. With S a row's sum, M its moment, and members v at places o in -w .. w (-w-1 for
 * one that leaves),
 *     S = S_base + sum +-v,   M = M_base - S_base + sum +-o v,
 * without - S_base where the base lies around the same place. That holds for any two lists, so it
 * is exact on any shape. Rounding adds up from row to row: a run ends after LSM_RUN_MOST rows, and
 * the next row starts anew, listed in full, as every row does that has no base with fewer terms. A
 * base comes before what is made from it and lies in the same layer. */
#ifndef LSM_RUNNING_LISTS_H
#define LSM_RUNNING_LISTS_H

#include "subsum_lists.h"

enum { LSM_RUN_MOST = 16, LSM_FACTORS = 4 * (LSM_MAX_W + 1) };

typedef struct {
    int row;    /* of the kind below; 0 holds zero */
    int factor; /* which of lsm_running_factors() */
} LsmTerm;

typedef struct {
    int *base; /* [rows] 2 * its base, + 1 where that lies one place back; 0: none */
    int *
        first; /* [rows + 1] terms of a row: first[r] .. first[r + 1] - 1, an even number above 0 */
    LsmTerm *term;
    long rows;
} LsmRunningList;

typedef struct {
    LsmRunningList bar, plate, region;
} LsmRunningLists;

/* What a term's member is multiplied by for the sum and for the moment. */
void lsm_running_factors(int w, double factor[LSM_FACTORS][2]);

/* Running lists for the lists of all particles of a lattice; region p is row p + 1. Layer l has the
 * planes layer_plane[l] .. layer_plane[l + 1] - 1. O(rows w). */
void lsm_running_lists_build(const LsmLattice *lattice, const LsmLists *lists, int layers,
                             const int *layer_plane, LsmRunningLists *running_lists);
void lsm_running_lists_free(LsmRunningLists *running_lists);

#endif
