/* test_bodies.h - irregular voxel shapes and deformations for tests; same seed, same body. */
#ifndef SM_TEST_BODIES_H
#define SM_TEST_BODIES_H

#include <math.h>

#include "../test_random.h"
#include "voxel.h"

/* Kinds: 0 sparse noise, 1 dense noise, 2 a box with holes, 3 a random walk's trail (thin, with
 * gaps of one cell), 4 a sheet of one cell with cuts, 5 a full box. Never empty. */
static inline void random_body(unsigned *seed, int kind, int most, SmVoxels *v)
{
    int n[3];
    for (int d = 0; d < 3; d++) n[d] = 1 + random_int(seed, most);
    if (kind == 4) n[random_int(seed, 3)] = 1;
    sm_voxels_init(v, n[0], n[1], n[2], 0.25 + random_unit(seed));
    for (int d = 0; d < 3; d++) v->origin[d] = 4 * random_unit(seed) - 2;
    double fill = kind == 0 ? 0.25 : kind == 1 ? 0.75 : kind == 4 ? 0.85 : 1;
    if (kind == 3) fill = 0;
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int i = 0; i < n[0]; i++) {
                bool hole = kind == 2 && i % 4 == 1 && j % 3 == 1;
                if (random_unit(seed) < fill && !hole) sm_voxel_set(v, i, j, k);
            }
    int at[3];
    for (int d = 0; d < 3; d++) at[d] = random_int(seed, n[d]);
    sm_voxel_set(v, at[0], at[1], at[2]);
    for (int step = 0; kind == 3 && step < 4 * most; step++) {
        int d = random_int(seed, 3), to = at[d] + (random_int(seed, 2) ? 1 : -1);
        if (to < 0 || to >= n[d]) continue;
        at[d] = to;
        sm_voxel_set(v, at[0], at[1], at[2]);
    }
    sm_voxels_count(v);
}

/* A block of `size` cells of which each is there with probability `fill`. */
static inline void random_block(unsigned *seed, const int size[3], double cell, double fill,
                                SmVoxels *v)
{
    sm_voxels_init(v, size[0], size[1], size[2], cell);
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++)
                if (fill >= 1 || random_unit(seed) < fill) sm_voxel_set(v, i, j, k);
    sm_voxels_count(v);
}

/* x = A x0 + t + noise, with A near a rotation about a random axis; `noise` in cells. */
static inline void random_deformation(unsigned *seed, double cell, double noise, long count,
                                      const double (*x0)[3], double (*x)[3])
{
    double q[4], norm = 0, R[3][3], stretch = 0.2, t[3];
    for (int i = 0; i < 4; i++) {
        q[i] = random_unit(seed) - 0.5;
        norm += q[i] * q[i];
    }
    for (int i = 0; i < 4; i++) q[i] /= sqrt(norm) + 1e-9;
    for (int i = 0; i < 3; i++) t[i] = cell * (10 * random_unit(seed) - 5);
    double w = q[0], a = q[1], b = q[2], c = q[3];
    double M[3][3] = {{1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)},
                      {2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)},
                      {2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) R[i][j] = M[i][j] + stretch * (random_unit(seed) - 0.5);
    for (long p = 0; p < count; p++)
        for (int i = 0; i < 3; i++)
            x[p][i] = R[i][0] * x0[p][0] + R[i][1] * x0[p][1] + R[i][2] * x0[p][2] + t[i] +
                      noise * cell * (random_unit(seed) - 0.5);
}

#endif
