/* running_lists.h - lists (subsum_lists.h) in which most rows are made from a neighbour's sum: the
 * fast summation of fastlsm section 3.1 for any shape, whose cost a row does not depend on w.
 *
 * The bar around x holds the bar around x - 1, moved on by one place, less the member that leaves
 * it and with the one that enters; so does a plate along y and a region along z. Where material
 * ends a few more members differ; a variant around the same place may be nearer still. With S a
 * row's sum, M its moment, and members v at places o in -w .. w (-w-1 for one that leaves),
 *     S = S_base + sum +-v,   M = M_base - S_base + sum +-o v,
 * without - S_base where the base lies around the same place. That holds for any two lists, so it
 * is exact on any shape. Rounding adds up from row to row: a run ends after LSM_RUN_MOST rows, and
 * the next row starts anew, listed in full, as every row does that no base saves time. A base lies
 * in the same layer.
 *
 * A branch that is guessed wrong costs as much as a row. So rows of a plane that are made in the
 * same way, of as many members (those that are too many are row 0), and are as far down a run,
 * follow each other in a group. */
#ifndef LSM_RUNNING_LISTS_H
#define LSM_RUNNING_LISTS_H

#include "subsum_lists.h"

enum { LSM_RUN_MOST = 16 };

/* What a row's record holds, by the lists' names. Places are one of -w-1 .. w, plus w + 1. */
typedef enum {
    LSM_MOVED,   /* row, base one place back, the member that enters at w, that which leaves at
                    -w-1 */
    LSM_CHANGED, /* row, base (+ 1 if one place back); so many times in turn two members that enter
                    and two that leave, and their places, a byte each, the first one's lowest */
    LSM_LISTED   /* row, a place, the members at so many places from there on */
} LsmWay;

enum { LSM_CHANGES = 5 }; /* ints for two members that enter, two that leave, and their places */

typedef struct {
    LsmWay way;
    int times;
    long first, count; /* in `record` the first int, and how many records there are */
} LsmGroup;

/* Ints in a record. */
static inline int lsm_record_width(LsmWay way, int times)
{
    const int width[] = {4, 2 + LSM_CHANGES * times, 2 + times};
    return width[way];
}

typedef struct {
    int *record;
    LsmGroup *group;
    long *plane; /* [planes + 1] first group of each plane */
    long ints, groups;
} LsmRunningList;

typedef struct {
    LsmRunningList bar, plate, region;
} LsmRunningLists;

/* Running lists for the lists of all particles of a lattice, which are numbered by `slot`. Layer l
 * has the planes layer_plane[l] .. layer_plane[l + 1] - 1. O(rows w). */
void lsm_running_lists_build(const LsmLattice *lattice, const int *slot, const LsmLists *lists,
                             int layers, const int *layer_plane, LsmRunningLists *running_lists);
void lsm_running_lists_free(LsmRunningLists *running_lists);

/* Additions that its rows take: members that enter, leave or are listed. */
long lsm_running_additions(const LsmRunningList *list);

#endif
