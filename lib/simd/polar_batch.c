#include "polar_lanes.h"

static void batch(long count, const real *A, const real *last, real *R)
{
    for (long first = 0; first < count; first += SM_LANES) {
        long lanes = count - first < SM_LANES ? count - first : SM_LANES;
        vec a[9], before[9], r[9];
        for (int i = 0; i < 9; i++) {
            a[i] = before[i] = lanes_set(i % 4 == 0);
            for (long lane = 0; lane < lanes; lane++) {
                a[i][lane] = A[(first + lane) * 9 + i];
                if (last) before[i][lane] = last[(first + lane) * 9 + i];
            }
        }
        unsigned tie = polar_quartic(a, LANES_ALL, r);
        if (tie) polar_mend(a, tie, before, r);
        for (int i = 0; i < 9; i++)
            for (long lane = 0; lane < lanes; lane++) R[(first + lane) * 9 + i] = r[i][lane];
    }
}

void (*const SM_NAME(sm_polar_batch))(long, const real *, const real *, real *) = batch;
