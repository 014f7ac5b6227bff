/* rotate_lanes.h - rotations of shape matching regions, SM_LANES at once, with memory for ties. */
#ifndef SM_ROTATE_LANES_H
#define SM_ROTATE_LANES_H

#include "polar_lanes.h"

typedef short short_vec __attribute__((vector_size(SM_LANES * sizeof(short))));

/* The last rotation of a tile of regions is kept as its first two columns in 1/32767: it only says
 * which of several equally good rotations is nearest. */
SM_INLINE void last_store(short *last, const vec R[9])
{
    for (int i = 0; i < 3; i++)
        for (int column = 0; column < 2; column++) {
            /* by way of whole lanes: compilers convert straight to short one by one */
            ivec whole = __builtin_convertvector(R[i * 3 + column] * 32767, ivec);
            short_vec packed = __builtin_convertvector(whole, short_vec);
            memcpy(last + (column * 3 + i) * SM_LANES, &packed, sizeof packed);
        }
}

SM_INLINE void last_load(const short *last, vec R[9])
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        double x[3], y[3], xx = 0, xy = 0, yy = 0;
        for (int i = 0; i < 3; i++) {
            x[i] = last[i * SM_LANES + lane];
            y[i] = last[(3 + i) * SM_LANES + lane];
            xx += x[i] * x[i];
            xy += x[i] * y[i];
        }
        for (int i = 0; i < 3; i++) y[i] -= x[i] * xy / xx;
        for (int i = 0; i < 3; i++) yy += y[i] * y[i];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            R[i * 3][lane] = (real)(x[i] / sqrt(xx));
            R[i * 3 + 1][lane] = (real)(y[i] / sqrt(yy));
            R[i * 3 + 2][lane] = (real)((x[j] * y[k] - x[k] * y[j]) / sqrt(xx * yy));
        }
    }
}

/* Rotations of A by the fast method, near the last ones where they are not unique; updates `last`.
 * Lanes whose slot is negative hold no region. */
SM_INLINE void polar_fast_lanes(const vec A[9], const int *slot, short *last, vec R[9])
{
    ivec tie = polar_quartic(A, R);
    if (__builtin_expect(lanes_any(tie), 0)) {
        vec before[9];
        last_load(last, before);
        for (int lane = 0; lane < SM_LANES; lane++) {
            if (slot[lane] >= 0) continue;
            tie[lane] = 0; /* an empty lane needs no rotation, only a finite one */
            for (int i = 0; i < 9; i++) R[i][lane] = i % 4 == 0;
        }
        polar_mend(A, tie, before, R);
    }
    last_store(last, R);
}

#endif
