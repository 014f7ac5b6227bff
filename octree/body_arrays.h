/* body_arrays.h - places for leaves and tree nodes in the octree engine: arrays that grow, and what
 * is kept of every leaf. */
#ifndef OCT_BODY_ARRAYS_H
#define OCT_BODY_ARRAYS_H

#include "state.h"

#define oct_slots_room    SM_NAME(oct_slots_room)
#define oct_nodes_room    SM_NAME(oct_nodes_room)
#define oct_slots_reserve SM_NAME(oct_slots_reserve)
#define oct_nodes_reserve SM_NAME(oct_nodes_reserve)
#define oct_slot_fill     SM_NAME(oct_slot_fill)
#define oct_slot_clear    SM_NAME(oct_slot_clear)
#define oct_block_inverse SM_NAME(oct_block_inverse)
#define oct_row_open      SM_NAME(oct_row_open)
#define oct_row_place     SM_NAME(oct_row_place)
#define oct_row_centre    SM_NAME(oct_row_centre)

/* Is there a leaf of that number? */
static inline bool oct_alive(const Oct *oct, long leaf)
{
    return oct->row[leaf] != OCT_SPARE_ROW;
}

/* There are to be `leaves` numbers of leaves, or `nodes` of tree nodes, at least as many as before.
 * Amortised O(1) each; the first call takes as much as it needs. New slots are without a leaf. */
void oct_slots_room(Oct *oct, long leaves);
void oct_nodes_room(Oct *oct, const OctTree *tree, long nodes);

/* Makes room for as many, so that they cost nothing later. O(body). */
void oct_slots_reserve(Oct *oct, long leaves);
void oct_nodes_reserve(Oct *oct, long nodes);

/* Puts a leaf into its slot, or brings the constants there up to date. Its state stays. O(1). */
void oct_slot_fill(Oct *oct, const OctTree *tree, const OctWeights *weights, long leaf,
                   const OctRegionRest *rest);

/* Takes a leaf out of its slot. O(1). */
void oct_slot_clear(Oct *oct, long leaf);

/* Aqq_r of a block of a plastic body, from its rest shapes and moments. */
void oct_block_inverse(Oct *oct, long body, long block);

/* Empties the row of a tree node that is new, whose number another one may have had. */
void oct_row_open(Oct *oct, const OctTree *tree, long node);

/* Where the row of a tree node has its centre: in the middle of its leaves, to half finest cells,
 * because little of a large cell may be material; finest cells from the tree's first node. O(leaves
 * below). The other writes it into the row. */
void oct_row_place(const OctTree *tree, long node, double place[3]);
void oct_row_centre(const OctTree *tree, long node, real *row);

#endif
