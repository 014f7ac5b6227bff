/* blocks_far.h - the stage along x of a block pass (blocks_pass.h) where w is so large that sums of
 * prefixes take fewer operations than sliding lanes: O(1) in w. It runs over one value at a time.
 */
#ifndef LSM_BLOCKS_FAR_H
#define LSM_BLOCKS_FAR_H

#include "window.h"

/* From this width on. */
enum { FAR = SM_LANES == 16 ? 8 : 5 };

/* Sums one value along x over `count` blocks that lie `stride` apart, in place; and its moments,
 * `moment` values further on, unless that is 0. */
SM_INLINE void far_sum(real *value, int count, long stride, int w, long moment)
{
    Prefixes none = prefixes_of(lanes_set(0), false), before = none, here, after;
    here = prefixes_of(lanes_load(value), moment != 0);
    for (int i = 0; i < count; i++, value += stride) {
        vec weighed = lanes_set(0);
        after = i + 1 < count ? prefixes_of(lanes_load(value + stride), moment != 0) : none;
        lanes_store(value, window_prefixes_x(before, here, after, w, moment ? &weighed : NULL));
        if (moment) lanes_store(value + moment, weighed);
        before = here;
        here = after;
    }
}

#endif
