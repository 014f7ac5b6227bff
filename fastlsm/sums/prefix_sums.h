/* prefix_sums.h - the sum along x over 2w+1 places by differences of running sums: O(1), whatever w
 * is (window.h has it place by place). */
#ifndef LSM_PREFIX_SUMS_H
#define LSM_PREFIX_SUMS_H

#include "../state.h"

/* A block's sums from its first lane to each, of values and of values times their lane's number:
 * with these a window along x takes as many operations at any w. */
typedef struct {
    vec sum, weighed;
} Prefixes;

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

/* From the first lane of `here` to w lanes on, less what is more than w lanes back. */
SM_INLINE vec window_between(vec before, vec here, vec after, int w)
{
    const vec zero = lanes_set(0);
    vec until = lanes_slide(here, after + lanes_set(here[SM_LANES - 1]), w);
    vec back = lanes_slide(zero, before, SM_LANES - 1) - lanes_set(before[SM_LANES - 1]);
    return until - lanes_slide(back, lanes_slide(zero, here, SM_LANES - 1), SM_LANES - w);
}

/* As window_sum_x() of window.h, w <= SM_LANES. Lanes are numbered from the first of `here`. */
SM_INLINE vec window_prefixes_x(Prefixes before, Prefixes here, Prefixes after, int w, vec *moment)
{
    vec sum = window_between(before.sum, here.sum, after.sum, w);
    if (moment)
        *moment = window_between(before.weighed - SM_LANES * before.sum, here.weighed,
                                 after.weighed + SM_LANES * after.sum, w) -
                  lanes_number() * sum;
    return sum;
}

#endif
