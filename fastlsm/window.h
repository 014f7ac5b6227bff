/* window.h - one stage of the moment chain (summation.h) over lanes: a sum over 2w+1 places. */
#ifndef LSM_WINDOW_H
#define LSM_WINDOW_H

#include "state.h"

/* sum over 2w+1 places of F values `stride` apart; place c starts at in[c]. Moments of values
 * `first` .. `first` + 2 go to `moment`. */
SM_INLINE void window_sum(const real *const *in, long stride, int w, int F, int first, vec *sum,
                          vec *moment)
{
    for (int f = 0; f < F; f++) {
        vec value = lanes_load(in[0] + f * stride);
        sum[f] = value;
        if (first >= 0 && f >= first && f < first + 3) moment[f - first] = -(real)w * value;
    }
    for (int c = 1; c <= 2 * w; c++)
        for (int f = 0; f < F; f++) {
            vec value = lanes_load(in[c] + f * stride);
            sum[f] += value;
            if (first >= 0 && f >= first && f < first + 3 && c != w)
                moment[f - first] += (real)(c - w) * value;
        }
}

/* The same when the window moves on by one place: `sum` and `moment` hold the window before,
 * `leave` is the place that drops out of it and `enter` the one that joins. Moved by one, offsets
 * fall by one: M' = M - S + (w+1) leave + w enter,   S' = S - leave + enter. */
SM_INLINE void window_move(const real *leave, const real *enter, long stride, int w, int F,
                           int first, vec *sum, vec *moment)
{
    for (int f = 0; f < F; f++) {
        vec old = lanes_load(leave + f * stride), new = lanes_load(enter + f * stride);
        if (first >= 0 && f >= first && f < first + 3)
            moment[f - first] += ((real)(w + 1) * old - sum[f]) + (real)w * new;
        sum[f] += new - old;
    }
}

/* The same along x: offsets are lanes of the block at `in` and of its neighbours on either side,
 * `next` values away. o = SM_LANES takes a whole neighbour. */
SM_INLINE void window_sum_x(const real *in, long next, int w, int F, int first, vec *sum,
                            vec *moment)
{
    for (int f = 0; f < F; f++) {
        const real *value = in + f * SM_LANES;
        vec before = lanes_load(value - next), here = lanes_load(value),
            after = lanes_load(value + next);
        bool weighted = first >= 0 && f >= first && f < first + 3;
        vec left = lanes_slide(before, here, SM_LANES - 1), right = lanes_slide(here, after, 1);
        sum[f] = here + (left + right);
        if (weighted) moment[f - first] = right - left;
        for (int o = 2; o <= w; o++) {
            left = lanes_slide(before, here, SM_LANES - o);
            right = lanes_slide(here, after, o);
            sum[f] += left + right;
            if (weighted) moment[f - first] += (real)o * (right - left);
        }
    }
}

/* Takes the moment off the first three sums and leaves the last three out. */
SM_INLINE void finish_down(vec *sum, const vec *moment, bool damping)
{
    if (damping) return;
    for (int d = 0; d < 3; d++) sum[d] -= moment[d];
}

#endif
