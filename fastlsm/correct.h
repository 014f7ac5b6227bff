/* correct.h - applies corrections (corrections.h) to a block's sums. */
#ifndef LSM_CORRECT_H
#define LSM_CORRECT_H

#include "corrections.h"

/* A block's corrections one way. */
typedef struct {
    const Correction *at, *end;
} Span;

SM_INLINE void clear_lanes(unsigned lanes, int values, vec *sum)
{
    for (int i = 0; i < values && lanes; i++) sum[i] = lanes_pick(sum[i], 0, ~lanes);
}

SM_INLINE Span corrections_of(const CorrectionList *list, long block)
{
    return (Span){list->of + list->first[block], list->of + list->first[block + 1]};
}

/* One correction of the sums up of a block's regions (match.h). */
SM_INLINE void correct_region(const Lsm *lsm, const Correction *at, vec weight, vec *sum)
{
    const real *x = lsm->x + at->source * 3L * SM_LANES;
    for (int d = 0; d < 3; d++) {
        vec p = lsm->pass == PASS_CONSTANTS ? weight : weight * lanes_load(x + d * SM_LANES);
        p = lanes_pick(p, at->shift, at->lanes);
        sum[d] += p;
        for (int k = 0; k < 3; k++) sum[3 + 3 * d + k] += at->offset[k] * p;
    }
}

/* One of damping's four triples of sums up. */
SM_INLINE void correct_product(const Lsm *lsm, const Correction *at, vec weight, vec *sum)
{
    const real *from_x = lsm->x + at->source * 3L * SM_LANES,
               *from_v = lsm->v + at->source * 3L * SM_LANES;
    vec x[3], v[3], product[4];
    weight = lanes_pick(weight, at->shift, at->lanes);
    for (int d = 0; d < 3; d++) {
        x[d] = lanes_pick(lanes_load(from_x + d * SM_LANES), at->shift, at->lanes);
        v[d] = lanes_pick(lanes_load(from_v + d * SM_LANES), at->shift, at->lanes);
    }
    for (int d = 0; d < 3; d++) {
        damping_products(weight, (const real *)x, (const real *)v, d, product);
        for (int k = 0; k < 4; k++) sum[3 * k + d] += product[k];
    }
}

SM_INLINE void correct_up(const Lsm *lsm, long block, bool products, vec sums[12])
{
    Span span = corrections_of(&lsm->corrections->up, block);
    if (span.at == span.end) return;
    vec sum[12];
    lanes_copy(12, sums, sum);
    clear_lanes(lsm->corrections->up.clear[block], 12, sum);
    for (const Correction *at = span.at; at < span.end; at++) {
        vec weight = at->sign * lsm->particle_const[lsm->block_const[at->source]].weight;
        if (products)
            correct_product(lsm, at, weight, sum);
        else
            correct_region(lsm, at, weight, sum);
    }
    lanes_copy(12, sum, sums);
}

static __attribute__((noinline, unused)) void correct_regions(const Lsm *lsm, long block,
                                                              vec sums[12])
{
    correct_up(lsm, block, false, sums);
}

static __attribute__((noinline, unused)) void correct_products(const Lsm *lsm, long block,
                                                               vec sums[12])
{
    correct_up(lsm, block, true, sums);
}

/* The sums down of a block's particles: of transforms at the particles, or of `values` plain ones.
 */
SM_INLINE void correct_down(const Lsm *lsm, long block, bool plain, vec *sums)
{
    int n = plain ? 6 : 3;
    vec sum[6];
    Span span = corrections_of(&lsm->corrections->down, block);
    lanes_copy(n, sums, sum);
    clear_lanes(lsm->corrections->down.clear[block], n, sum);
    for (const Correction *at = span.at; at < span.end; at++) {
        const real *T = lsm->corrections->kept + at->source * 12L * SM_LANES;
        for (int f = 0; f < n; f++) {
            vec value = lanes_load(T + f * SM_LANES);
            for (int k = 0; k < 3 && !plain; k++)
                value -= at->offset[k] * lanes_load(T + (3 + 3 * f + k) * SM_LANES);
            sum[f] += lanes_pick(at->sign * value, at->shift, at->lanes);
        }
    }
    lanes_copy(n, sum, sums);
}

#endif
