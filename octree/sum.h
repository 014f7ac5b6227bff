/* sum.h - sums of rows: what depth, breadth and the adjoint of HF are made of (octree
 * section 4.3).
 *
 * Moments are about the node's own centre, and are shifted exactly when they are added to a sum
 * about another: no large products are subtracted. */
#ifndef OCT_SUM_H
#define OCT_SUM_H

#include "../lib/simd/rows.h"
#include "state.h"

#define oct_each_block SM_NAME(oct_each_block)
#define oct_climb      SM_NAME(oct_climb)
#define oct_descend    SM_NAME(oct_descend)
#define oct_each_ghost SM_NAME(oct_each_ghost)

/* What a pass does with the blocks, inner nodes, prefixes or ghosts first .. last - 1. */
typedef void OctPass(OctTask *task, long first, long last);

/* Each runs its pass over this thread's shares and waits for the others. Which thread does what
 * changes no bits: every row is summed by one thread, in the order of its list. */
void oct_each_block(OctTask *task, OctPass *pass);
void oct_climb(OctTask *task, OctPass *pass); /* inner nodes, level by level from the deepest */
void oct_descend(OctTask *task, const OctSumLists *lists,
                 OctPass *pass); /* prefixes, from the top */
void oct_each_ghost(OctTask *task, OctPass *pass);

#if SM_LANES == 16
#define ROW_PADS     3, 3, 3, 3, 7, 7, 7, 7, 11, 11, 11, 11, 15, 15, 15, 15
#define ROW_QUARTERS 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3
#define ROW_PAD_MASK 0, 0, 0, -1, 0, 0, 0, -1, 0, 0, 0, -1, 0, 0, 0, -1
#elif SM_LANES == 8
#define ROW_PADS     3, 3, 3, 3, 7, 7, 7, 7
#define ROW_QUARTERS 0, 1, 2, 3, 0, 1, 2, 3
#define ROW_PAD_MASK 0, 0, 0, -1, 0, 0, 0, -1
#else
#define ROW_PADS     3, 3, 3, 3
#define ROW_QUARTERS 0, 1, 2, 3
#define ROW_PAD_MASK 0, 0, 0, -1
#endif

/* Every quarter full of its pad. */
SM_INLINE Row row_pads(Row row)
{
    for (int i = 0; i < ROW_VECS; i++)
        row.vector[i] = __builtin_shufflevector(row.vector[i], row.vector[i], ROW_PADS);
    return row;
}

/* The four values at p in every quarter. */
SM_INLINE vec row_spread(const real *p)
{
#if defined(__AVX512F__) && SM_LANES == 16
    return (vec)_mm512_broadcast_f32x4(_mm_loadu_ps(p));
#elif defined(__AVX512F__) && SM_LANES == 8
    return (vec)_mm512_broadcast_f64x4(_mm256_loadu_pd(p));
#else
    vec4 quarter = load4(p);
    return __builtin_shufflevector(quarter, quarter, ROW_QUARTERS);
#endif
}

/* sum += the moments at p, about `centre` (row_pads() of the row that is summed). */
SM_INLINE void row_add_moments(const real *p, const Row *centre, Row *sum, Row *moved)
{
    Row row = row_load(p), pads = row_pads(row);
    vec x = row_spread(p);
    for (int i = 0; i < ROW_VECS; i++) {
        sum->vector[i] += row.vector[i];
        moved->vector[i] += x * (pads.vector[i] - centre->vector[i]);
    }
}

/* One quarter that multiplies a transform's value by 1: its linear part goes with the way from the
 * node's centre. */
SM_INLINE Row row_from(Row pads)
{
    const vec one = {1, 1, 1, 1};
    pads.vector[0] += one; /* the pad of quarter 0 is 0 */
    return pads;
}

/* Adds up, quarter by quarter, the value that the transform at p gives the place `from`
 * (row_from() of its pads). */
SM_INLINE void row_add_values(Row row, const Row *from, Row *value)
{
    Row pads = row_pads(row);
    for (int i = 0; i < ROW_VECS; i++)
        value->vector[i] += row.vector[i] * (from->vector[i] - pads.vector[i]);
}

/* The sum of what a loop over a list kept apart, so that its additions need not wait for each
 * other. */
SM_INLINE Row row_total(const Row partial[OCT_GROUP])
{
    Row sum = partial[0];
    for (int i = 1; i < OCT_GROUP; i++) sum = row_add(sum, partial[i]);
    return sum;
}

/* Stores a sum at p, whose pads stay. */
SM_INLINE void row_keep(real *p, Row sum)
{
    const ivec pad = {ROW_PAD_MASK};
    Row old = row_load(p);
    for (int i = 0; i < ROW_VECS; i++)
        sum.vector[i] = lanes_select(pad, old.vector[i], sum.vector[i]);
    row_store(p, sum);
}

#endif
