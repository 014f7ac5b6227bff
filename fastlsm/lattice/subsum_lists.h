/* subsum_lists.h - region -> plate -> bar -> particle: the paper's region-specific sub-sums
 * (fastlsm section 3.1, "Handling irregular regions").
 *
 * A bar holds the members of one region in one row along x, a plate the bars of one region in one
 * plane z, a region its plates. Identical bars and plates are stored once. Every list has 2w+1
 * places, one for each offset -w..w from the region's centre, so the offset is implied by the place
 * and loops have a fixed length; an absent member is row 0, which always holds zero. Because
 * membership is symmetric the same lists sum regions over a particle.
 *
 * A list names its members: a row's name is its place in memory times LSM_NAME bytes, so that the
 * row's address is base + name * (2, 4 or 8 in single precision), which a load computes by itself.
 * Its place is its number until lsm_lists_place() says otherwise; that of a slot is one more. */
#ifndef LSM_SUBSUM_LISTS_H
#define LSM_SUBSUM_LISTS_H

#include "region.h"

enum { LSM_NAME = 8 };

typedef struct {
    int w, side;                               /* side = 2w+1 */
    long bar_count, plate_count, region_count; /* row 0 of bars and plates included */
    int *bar;                                  /* [bar_count][side] names of 1 + particle slot */
    int *plate;                                /* [plate_count][side] names of bars */
    int *region;                               /* [region_count][side] names of plates */
    long region_room;                          /* rows that `region` has room for */
    int planes;                                /* lattice planes along z */
    long *bar_plane;   /* [planes + 1] first bar of each plane (plane 0 starts at row 1) */
    long *plate_plane; /* [planes + 1] */
    long *bar_end;     /* [planes + 1] bars of plane z end before bar_end[z + 1]; what follows up
                          to bar_plane[z + 1] is spare (list_allocator.h) */
    long *plate_end;   /* [planes + 1] */
    int *bar_shift, *plate_shift, *slot_shift; /* [planes] from a number to its place */
} LsmLists;

/* The name of row `number` of plane z, not 0, and its number (0: absent). */
static inline int lsm_name(const int *shift, int z, long number)
{
    return LSM_NAME * (int)(number + shift[z]);
}

static inline int lsm_named(const int *shift, int z, int name)
{
    return name ? name / LSM_NAME - shift[z] : 0;
}

typedef struct LsmListsBuilder LsmListsBuilder;

/* Ends the program as out of memory where a kind has more rows than names, which are ints, tell
 * apart: from 2^28 on (some 60 GB). */
void lsm_names_reach(long rows);

/* To build lists of particles, which are numbered by `slot` (slot[p] of particle p): open, add
 * regions in rising order, close, which fills `lists` and frees the builder. What the builder was
 * given must stay as it is meanwhile. */
LsmListsBuilder *lsm_lists_open(const LsmLattice *lattice, const int *slot, int w);

/* Lists the members `rows` (region.h) of particle p as the next row of the regions. O(w^2) for a
 * whole cube, O(w^2 + members) else. */
void lsm_lists_add(LsmListsBuilder *builder, long p, const LsmRow *rows);
void lsm_lists_close(LsmListsBuilder *builder, LsmLists *lists);
void lsm_lists_free(LsmLists *lists);

/* Names by other shifts, which the lists then own; region_plane[region_count]. O(names). */
void lsm_lists_place(LsmLists *lists, int *bar_shift, int *plate_shift, int *slot_shift,
                     const int *region_plane);

/* The bar of centre column x in row (y, z) whose members are `bits` (not 0): [2w+1] names. */
void lsm_lists_bar(const LsmLattice *lattice, const int *slot, int slot_shift, int w, int x, int y,
                   int z, LsmRow bits, int *row);

uint64_t lsm_lists_hash(const int *row, int width);

#endif
