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

/* A block's prefixes with its lanes numbered from the first of the block that is `blocks` before.
 */
SM_INLINE Prefixes prefixes_from(Prefixes p, int blocks)
{
    p.weighed += (real)(blocks * SM_LANES) * p.sum;
    return p;
}

/* Whole blocks that a window reaches to either side, and then it ends within the next one. */
#define PREFIX_BLOCKS(w) (((w)-1) / SM_LANES)
enum { PREFIX_MOST = 2 * PREFIX_BLOCKS(SM_MOST_W) + 3 };

SM_INLINE vec prefix_without_own(vec prefix)
{
    return lanes_slide(lanes_set(0), prefix, SM_LANES - 1);
}

/* From the first lane of block `here` to w lanes on, less what is more than w lanes back. `whole`
 * is PREFIX_BLOCKS(w), which compilers are to know; at[k] are the prefixes of block here - whole -
 * 1 + k.
 */
SM_INLINE vec window_between(const vec *at, int w, int whole)
{
    const int rest = w - whole * SM_LANES, here = whole + 1;
    vec ahead = lanes_set(0), behind = lanes_set(0);
    for (int k = 0; k < whole; k++) {
        ahead += lanes_set(at[here + k][SM_LANES - 1]);
        behind += lanes_set(at[here - 1 - k][SM_LANES - 1]);
    }
    vec last = lanes_set(at[here + whole][SM_LANES - 1]), first = lanes_set(at[0][SM_LANES - 1]);
    vec until = lanes_slide(at[here + whole], at[here + whole + 1] + last, rest) + ahead;
    vec back =
        lanes_slide(prefix_without_own(at[0]) - first, prefix_without_own(at[1]), SM_LANES - rest) -
        behind;
    return until - back;
}

/* As window_sum_x() of window.h, for any w. Lanes are numbered from the first of `here`. */
SM_INLINE vec window_prefixes_x(const Prefixes *at, int w, int whole, vec *moment)
{
    const int blocks = 2 * whole + 3;
    vec part[PREFIX_MOST] = {{0}};
    for (int k = 0; k < blocks; k++) part[k] = at[k].sum;
    vec sum = window_between(part, w, whole);
    if (moment) {
        for (int k = 0; k < blocks; k++) part[k] = prefixes_from(at[k], k - whole - 1).weighed;
        *moment = window_between(part, w, whole) - lanes_number() * sum;
    }
    return sum;
}

#endif
