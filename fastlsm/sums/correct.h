/* correct.h - applies corrections (corrections.h) to a block's sums. */
#ifndef LSM_CORRECT_H
#define LSM_CORRECT_H

#include "corrections.h"

enum { CORRECT_BATCH = 16 };

/* What one correction adds to the sums of half a block. */
typedef void CorrectOne(const Lsm *lsm, const Correction *at, half_vec *sum);

/* m~ of the source, or less than nothing. */
SM_INLINE half_vec weight_of(const Lsm *lsm, const Correction *at)
{
    const ParticleConst *k = &lsm->particle_const[lsm->block_const[at->source]];
    return at->sign * half_load((const real *)&k->weight + at->from, at->lanes);
}

/* Of the sums up of a block's regions (match.h). */
SM_INLINE void correct_region(const Lsm *lsm, const Correction *at, half_vec sum[12])
{
    const real *x = lsm->x + at->source * 3L * SM_LANES + at->from;
    half_vec weight = weight_of(lsm, at);
    for (int d = 0; d < 3; d++) {
        half_vec p = weight * half_load(x + d * SM_LANES, at->lanes);
        sum[d] += p;
        for (int k = 0; k < 3; k++) sum[3 + 3 * d + k] += at->offset[k] * p;
    }
}

/* The same of m~ in place of m~ x. */
SM_INLINE void correct_constant(const Lsm *lsm, const Correction *at, half_vec sum[12])
{
    half_vec p = weight_of(lsm, at);
    for (int d = 0; d < 3; d++) {
        sum[d] += p;
        for (int k = 0; k < 3; k++) sum[3 + 3 * d + k] += at->offset[k] * p;
    }
}

/* Of damping's four triples of sums up. */
SM_INLINE void correct_product(const Lsm *lsm, const Correction *at, half_vec sum[12])
{
    const real *from_x = lsm->x + at->source * 3L * SM_LANES + at->from,
               *from_v = lsm->v + at->source * 3L * SM_LANES + at->from;
    half_vec weight = weight_of(lsm, at), x[3], v[3], p[3];
    for (int d = 0; d < 3; d++) {
        x[d] = half_load(from_x + d * SM_LANES, at->lanes);
        v[d] = half_load(from_v + d * SM_LANES, at->lanes);
        p[d] = weight * x[d];
    }
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        sum[d] += weight * v[d];
        sum[3 + d] += p[e] * v[f] - p[f] * v[e];
        sum[6 + d] += p[d] * x[d];
        sum[9 + d] += p[e] * x[f];
    }
}

/* Of the sums down of a block's particles: of transforms at the particles. */
SM_INLINE void correct_goal(const Lsm *lsm, const Correction *at, half_vec sum[3])
{
    const real *T = lsm->corrections->kept + at->source * 12L * SM_LANES + at->from;
    for (int f = 0; f < 3; f++) {
        half_vec value = half_load(T + f * SM_LANES, at->lanes);
        for (int k = 0; k < 3; k++)
            value -= at->offset[k] * half_load(T + (3 + 3 * f + k) * SM_LANES, at->lanes);
        sum[f] += at->sign * value;
    }
}

/* Of the sums down of rigid velocities. */
SM_INLINE void correct_velocity(const Lsm *lsm, const Correction *at, half_vec sum[6])
{
    const real *kept = lsm->corrections->kept + at->source * 12L * SM_LANES + at->from;
    for (int f = 0; f < 6; f++) sum[f] += at->sign * half_load(kept + f * SM_LANES, at->lanes);
}

/* What the corrections from `c` up to `end` come to. Loops are unrolled early, or the sums would
 * not stay in registers. */
SM_INLINE void correct_batch(const Lsm *lsm, const Correction *c, const Correction *end, int count,
                             CorrectOne *correct_one, half_vec *sum)
{
    half_vec all[12];
#pragma GCC unroll 12
    for (int f = 0; f < count; f++) all[f] = (half_vec){0};
    for (; c < end; c++) correct_one(lsm, c, all);
#pragma GCC unroll 12
    for (int f = 0; f < count; f++) sum[f] = all[f];
}

/* What all of half a block, number `at`, come to. Of thousands of like numbers, one added after the
 * other, each would be rounded the same way; batches are summed on their own, and then batches of
 * batches. */
SM_INLINE void correct_half(const Lsm *lsm, const CorrectionList *list, long at, int count,
                            CorrectOne *correct_one, half_vec *sum)
{
    const Correction *c = list->of + list->first[at], *end = list->of + list->first[at + 1];
    if (end - c <= CORRECT_BATCH) {
        correct_batch(lsm, c, end, count, correct_one, sum);
        return;
    }
    half_vec batch[12], batches[12];
    for (int f = 0; f < count; f++) batches[f] = sum[f] = (half_vec){0};
    for (int i = 1; c < end; i++) {
        const Correction *last = end - c < CORRECT_BATCH ? end : c + CORRECT_BATCH;
        correct_batch(lsm, c, last, count, correct_one, batch);
        for (int f = 0; f < count; f++) batches[f] += batch[f];
        c = last;
        if (i % CORRECT_BATCH && c < end) continue;
        for (int f = 0; f < count; f++) {
            sum[f] += batches[f];
            batches[f] = (half_vec){0};
        }
    }
}

/* Corrects `count` sums of a block. */
SM_INLINE void correct(const Lsm *lsm, const CorrectionList *list, long block, int count,
                       CorrectOne *correct_one, vec *sums)
{
    half_vec low[12], high[12];
    unsigned keep = ~(unsigned)list->clear[block] & LANES_ALL;
    correct_half(lsm, list, 2 * block, count, correct_one, low);
    correct_half(lsm, list, 2 * block + 1, count, correct_one, high);
#pragma GCC unroll 12
    for (int f = 0; f < count; f++)
        sums[f] = lanes_keep(keep, sums[f]) + lanes_join(low[f], high[f]);
}

/* As BlockWork (state.h). */
static __attribute__((noinline, unused)) void correct_regions(const Lsm *lsm, long block, vec *sums)
{
    if (lsm->pass == PASS_CONSTANTS)
        correct(lsm, &lsm->corrections->up, block, 12, correct_constant, sums);
    else
        correct(lsm, &lsm->corrections->up, block, 12, correct_region, sums);
}

static __attribute__((noinline, unused)) void correct_products(const Lsm *lsm, long block,
                                                               vec *sums)
{
    correct(lsm, &lsm->corrections->up, block, 12, correct_product, sums);
}

static __attribute__((noinline, unused)) void correct_goals(const Lsm *lsm, long block, vec *sums)
{
    correct(lsm, &lsm->corrections->down, block, 3, correct_goal, sums);
}

static __attribute__((noinline, unused)) void correct_velocities(const Lsm *lsm, long block,
                                                                 vec *sums)
{
    correct(lsm, &lsm->corrections->down, block, 6, correct_velocity, sums);
}

#endif
