/* operations.h - what the passes of a step have to do for a particle, counted (lib/operations.h):
 * of the sums in sums/, of match.h and damping.h. */
#ifndef LSM_OPERATIONS_H
#define LSM_OPERATIONS_H

#include <math.h>

#include "../lib/engine/engine.h"
#include "../lib/operations.h"
#include "../lib/polar.h"

/* Mean places of a row's window -w..w that lie inside a row of `side`. */
static inline double lsm_window_places(int w, int side)
{
    double sum = 0;
    for (int i = 0; i < side; i++) sum += 1 + fmin(i, w) + fmin(side - 1 - i, w);
    return sum / side;
}

/* Sums over regions, up and down, in a cube of `side` particles. The sums of
 * sums/sums.h, fields that a stage reads and writes:
 *     up    z 3 -> 6, y 6 -> 9, x 9 -> 12 (stays in registers)
 *     down  x 12 -> 9, y 9 -> 6, z 6 -> 3 (stays in registers)
 * so 3 + 6 + 9 sums and 3 moments at each of three stages up, the same down, where each moment is
 * also taken off a sum. */
static inline SmOperations lsm_sum_operations(SmSummation summation, int w, int side)
{
    enum { SUMS = 2 * (3 + 6 + 9), MOMENTS = 2 * 9, TAKEN_OFF = 9 };
    enum { READ = 3 + 6 + 9 + 12 + 9 + 6, WRITTEN = 6 + 9 + 12 + 9 + 6 };
    double places = lsm_window_places(w, side), members = pow(places, 3);
    switch (summation) {
    case SM_SUM_NAIVE:
        /* Each member once up and once down: 3 values summed (3 flops), or q added (3), and 3 x 3
         * multiply-adds of moments (18). Reads 3 values up, 12 down. */
        return (SmOperations){.flops = members * 2 * (3 + 18), .near_values = members * (3 + 12)};
    case SM_SUM_BARS:
        /* Each stage adds `places` values of each field, and multiply-adds those with a moment,
         * and reads what it adds. */
        return (SmOperations){.flops = (places - 1) * (SUMS + 2 * MOMENTS) + TAKEN_OFF,
                              .near_values = places * READ + WRITTEN};
    case SM_SUM_FAST:
        break;
    }
    /* O(1): a running sum adds one value and takes one off; its moment takes 4 flops (add the two,
     * times w, add, take off the sum). At w = 1 directly: 2 additions, and one difference. */
    return (SmOperations){.flops = 2 * SUMS + (w == 1 ? 1 : 4) * MOMENTS + TAKEN_OFF,
                          .near_values = READ + WRITTEN};
}

/* c = S / M (3), A = S - C offset (9 multiply-adds), q = c - R offset (9 multiply-adds). */
static inline SmOperations lsm_match_operations(void)
{
    return (SmOperations){.flops = 3 + 18 + 18};
}

/* Products m~ v, m~ x X v, m~ x x^T: 18; 12 sums at three stages up and 6 at three down, 2 flops
 * each; the spread and angular momentum 42, the adjugate of a symmetric 3x3 and omega 45, v - omega
 * x c 9; on the particle omega x x 12, v and x 12.
 * Values: z reads 6 (x, v) writes 12, y 12 12, x 12; down x writes 6, reads 6, writes 6, y 6 6, z
 * 6; x and v again 6 and 6. State: x and v read and written once more. */
static inline SmOperations lsm_damping_operations(void)
{
    return (SmOperations){.flops = 18 + 2 * 3 * (12 + 6) + 42 + 45 + 9 + 24,
                          .near_values = 6 + 12 + 12 + 12 + 12 + 6 + 6 + 6 + 6 + 6 + 6 + 12,
                          .far_values = 12};
}

/* g = sum / |R| (3), v += g - x + gravity (9), x += v (3). The sum arrives in registers; reads and
 * writes x and v, of which the sums have brought x near. */
static inline SmOperations lsm_integrate_operations(void)
{
    return (SmOperations){.flops = 15, .near_values = 12, .far_values = 6};
}

/* All of a step. Of the polar decomposition matrices come and go in registers; the last rotation,
 * 12 bytes, is read and written; and x, which the sums read and integration writes. */
static inline SmOperations lsm_step_operations(SmSummation summation, int w, int side, bool damping)
{
    SmOperations step = {.far_bytes = 24, .far_values = 6};
    step.flops = sm_polar_batch_operations().flops;
    step = sm_operations_add(step, 1, lsm_sum_operations(summation, w, side));
    step = sm_operations_add(step, 1, lsm_match_operations());
    step = sm_operations_add(step, 1, lsm_integrate_operations());
    return sm_operations_add(step, damping, lsm_damping_operations());
}

/* Bytes of state a particle that a step streams: x, v of `real` bytes, and the last rotation. */
static inline double lsm_state_bytes(double real)
{
    return 6 * real + 12;
}

#endif
