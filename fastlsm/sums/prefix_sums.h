/* prefix_sums.h - the sum along x over 2w+1 places, and its moment, by differences of running sums
 * within blocks (window.h has it place by place). */
#ifndef LSM_PREFIX_SUMS_H
#define LSM_PREFIX_SUMS_H

#include "../state.h"

/* A block's sums from its first lane to each, of values and of values times their lane's number:
 * with these a window along x takes as many operations at any w, but for the whole blocks in it. */
typedef struct {
    vec sum, weighed;
} Prefixes;

/* Whole blocks that a window reaches to either side, and then it ends within the next one. */
#define PREFIX_BLOCKS(w) (((w)-1) / SM_LANES)

/* Blocks to either side of a run whose prefixes, all zero, its windows meet. */
#define PREFIX_AROUND(w) (PREFIX_BLOCKS(w) + 1)

SM_INLINE vec lanes_prefix(vec v)
{
    for (int o = 1; o < SM_LANES; o *= 2) v += lanes_slide(lanes_set(0), v, SM_LANES - o);
    return v;
}

SM_INLINE Prefixes prefixes_of(vec value, bool weighed)
{
    Prefixes p = {lanes_prefix(value), lanes_set(0)};
    if (weighed) p.weighed = lanes_prefix(lanes_number() * value);
    return p;
}

/* A block's prefixes with lanes numbered from the first of the block that is `blocks` before; and
 * what all of it sums to. */
SM_INLINE vec prefix_at(const Prefixes *here, int blocks, bool weighed)
{
    const Prefixes *p = here + blocks;
    return weighed ? p->weighed + (real)(blocks * SM_LANES) * p->sum : p->sum;
}

SM_INLINE vec whole_at(const Prefixes *here, int blocks, bool weighed)
{
    vec sum = lanes_set(here[blocks].sum[SM_LANES - 1]);
    if (!weighed) return sum;
    return lanes_set(here[blocks].weighed[SM_LANES - 1]) + (real)(blocks * SM_LANES) * sum;
}

SM_INLINE vec prefix_without_own(vec prefix)
{
    return lanes_slide(lanes_set(0), prefix, SM_LANES - 1);
}

/* From the first lane of block `here` to w lanes on, less what is more than w lanes back. */
SM_INLINE vec window_between(const Prefixes *here, int w, int whole, bool weighed)
{
    const int rest = w - whole * SM_LANES;
    vec until =
        lanes_slide(prefix_at(here, whole, weighed),
                    prefix_at(here, whole + 1, weighed) + whole_at(here, whole, weighed), rest);
    vec back = lanes_slide(prefix_without_own(prefix_at(here, -whole - 1, weighed)) -
                               whole_at(here, -whole - 1, weighed),
                           prefix_without_own(prefix_at(here, -whole, weighed)), SM_LANES - rest);
    for (int k = 0; k < whole; k++) {
        until += whole_at(here, k, weighed);
        back -= whole_at(here, -1 - k, weighed);
    }
    return until - back;
}

SM_INLINE void store_window(const Prefixes *here, int w, int whole, real *value, long moment)
{
    vec sum = window_between(here, w, whole, false);
    lanes_store(value, sum);
    if (moment)
        lanes_store(value + moment, window_between(here, w, whole, true) - lanes_number() * sum);
}

/* Sums `count` blocks of a value, `stride` apart, in place, where w <= SM_LANES; and their moments,
 * `moment` values further on, unless that is 0. */
SM_INLINE void prefix_sums_near(int w, real *value, int count, long stride, long moment)
{
    const Prefixes none = prefixes_of(lanes_set(0), false);
    Prefixes at[3] = {none, none, none};
    for (int i = 0; i <= count; i++) {
        at[0] = at[1];
        at[1] = at[2];
        at[2] = i < count ? prefixes_of(lanes_load(value + i * stride), moment != 0) : none;
        if (i > 0) store_window(at + 1, w, 0, value + (i - 1) * stride, moment);
    }
}

/* The same for any w. `at` is room for the prefixes of the blocks and of PREFIX_AROUND(w) to either
 * side, of which those before are zero and stay so. */
SM_INLINE void prefix_sums_far(Prefixes *at, int w, real *value, int count, long stride,
                               long moment)
{
    at += PREFIX_AROUND(w);
    for (int i = 0; i < count; i++)
        at[i] = prefixes_of(lanes_load(value + i * stride), moment != 0);
    memset(at + count, 0, (size_t)PREFIX_AROUND(w) * sizeof *at);
    for (int i = 0; i < count; i++, value += stride)
        store_window(at + i, w, PREFIX_BLOCKS(w), value, moment);
}

#endif
