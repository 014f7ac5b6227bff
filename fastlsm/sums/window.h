/* window.h - one stage of the sums (sums.h) over lanes: a sum over 2w+1 places, and
 * its moment. */
#ifndef LSM_WINDOW_H
#define LSM_WINDOW_H

#include "../state.h"

/* A moment with what the places o steps to either side of its centre, `apart` the right one's less
 * the left one's, add to it; they come in rising order from o = 1 on. */
#define WINDOW_MOMENT(moment, o, apart) ((o) == 1 ? (apart) : (moment) + (real)(o) * (apart))

/* The sum over 2w+1 places, place c at in[c] + at; and sum (c - w) value, unless `moment` is NULL.
 */
SM_INLINE void window_sum(const real *const *in, long at, int w, vec *sum, vec *moment)
{
    *sum = lanes_load(in[w] + at);
    for (int o = 1; o <= w; o++) {
        vec left = lanes_load(in[w - o] + at), right = lanes_load(in[w + o] + at);
        *sum += left + right;
        if (moment) *moment = WINDOW_MOMENT(*moment, o, right - left);
    }
}

/* The same when the window moves on by one place: `sum` and `moment` hold the window before,
 * `leave` is the place that drops out of it and `enter` the one that joins. Moved by one, offsets
 * fall by one: M' = M - S + (w+1) leave + w enter,   S' = S - leave + enter. */
SM_INLINE void window_move(vec leave, vec enter, int w, vec *sum, vec *moment)
{
    if (moment) *moment += ((real)(w + 1) * leave - *sum) + (real)w * enter;
    *sum += enter - leave;
}

/* The adjoint of a sum and its moment: the values less c - w times what they weigh, place c at
 * in[c] + at and in[c] + weighed. `rest` is the sum of the latter, which a move needs. */
SM_INLINE void window_less(const real *const *in, long at, long weighed, int w, vec *sum, vec *rest)
{
    vec moment = lanes_set(0);
    window_sum(in, at, w, sum, NULL);
    window_sum(in, weighed, w, rest, &moment);
    *sum -= moment;
}

SM_INLINE void window_less_move(const vec leave[2], const vec enter[2], int w, vec *sum, vec *rest)
{
    *sum += *rest + ((enter[0] - (real)w * enter[1]) - (leave[0] + (real)(w + 1) * leave[1]));
    *rest += enter[1] - leave[1];
}

/* The sum along x: offsets are lanes of the block `here` and of its neighbours on either side.
 * o = SM_LANES takes a whole neighbour. */
SM_INLINE vec window_sum_x(vec before, vec here, vec after, int w, vec *moment)
{
    vec sum = here;
    for (int o = 1; o <= w; o++) {
        vec left = lanes_slide(before, here, SM_LANES - o), right = lanes_slide(here, after, o);
        sum += left + right;
        if (moment) *moment = WINDOW_MOMENT(*moment, o, right - left);
    }
    return sum;
}

#endif
