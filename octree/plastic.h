/* plastic.h - regions that keep a part of what was done to them (octree section 7, eqs. 9 and 10;
 * Mueller et al. 2005), SM_LANES regions at once.
 *
 * Region r matches the rest shape S_r (x0 - c0_r). Its rotation R_r is that of A_r (eq. 9), so that
 * angular momentum is kept; E = R_r^T A_r Aqq_r is how it is stretched beyond that shape. Where
 * |E - I| exceeds the yield, S_r <- (I + creep (E - I)) S_r: at most `most` from I, then divided by
 * the cube root of its determinant, which keeps the volume. Regions whose nodes lie in a plane have
 * no inverse Aqq_r and stay elastic. */
#ifndef OCT_PLASTIC_H
#define OCT_PLASTIC_H

#include <math.h>

#include "../lib/simd/rotate_lanes.h"
#include "state.h"

SM_INLINE void load9(const real *p, vec M[9])
{
    for (int i = 0; i < 9; i++) M[i] = lanes_load(p + i * SM_LANES);
}

SM_INLINE void store9(real *p, const vec M[9])
{
    for (int i = 0; i < 9; i++) lanes_store(p + i * SM_LANES, M[i]);
}

/* C = A B; with `by_transpose` A B^T. */
SM_INLINE void lanes_multiply(const vec A[9], const vec B[9], bool by_transpose, vec C[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            C[i * 3 + j] = lanes_set(0);
            for (int k = 0; k < 3; k++)
                C[i * 3 + j] += A[i * 3 + k] * B[by_transpose ? j * 3 + k : k * 3 + j];
        }
}

/* Eq. 9: A_r <- A_r S_r^T. */
SM_INLINE void plastic_moments(const real *plastic, vec A[9])
{
    vec S[9], product[9];
    load9(plastic, S);
    lanes_multiply(A, S, true, product);
    for (int i = 0; i < 9; i++) A[i] = product[i];
}

/* Eq. 10: Aqq_r from the rest spread (xx yy zz yz zx xy) and S_r; zero where it is singular. */
SM_INLINE void plastic_inverse(const real *spread, const vec S[9], vec inverse[9])
{
    static const int entry[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2};
    vec B[9], SB[9], Q[9], C[9];
    for (int i = 0; i < 9; i++) B[i] = lanes_load(spread + entry[i] * SM_LANES);
    lanes_multiply(S, B, false, SB);
    lanes_multiply(SB, S, true, Q);
    polar_cofactor(Q, C);
    vec third = (Q[0] + Q[4] + Q[8]) / 3;
    vec determinant = Q[0] * C[0] + Q[1] * C[1] + Q[2] * C[2];
    ivec solid = determinant > (real)1e-6 * third * third * third;
    vec over = lanes_and(1 / lanes_select(solid, determinant, lanes_set(1)), solid);
    for (int i = 0; i < 9; i++) inverse[i] = C[i] * over; /* symmetric */
}

SM_INLINE vec lanes_cube_root(vec v)
{
    vec root;
    for (int i = 0; i < SM_LANES; i++) root[i] = (real)cbrt((double)v[i]);
    return root;
}

/* S <- (I + creep strain) S, capped, of volume 1. Returns the lanes where that is a shape. */
SM_INLINE ivec plastic_creep(const OctParams *params, const vec strain[9], vec S[9])
{
    vec add[9], C[9];
    lanes_multiply(strain, S, false, add);
    for (int i = 0; i < 9; i++) S[i] += (real)params->creep * add[i] - (real)(i % 4 == 0);
    vec size = lanes_sqrt(polar_norm(S));
    vec scale = lanes_select(size > (real)params->most, (real)params->most / size, lanes_set(1));
    for (int i = 0; i < 9; i++) S[i] = S[i] * scale + (real)(i % 4 == 0);
    polar_cofactor(S, C);
    vec determinant = S[0] * C[0] + S[1] * C[1] + S[2] * C[2];
    ivec shape = (determinant > (real)0.05) & (determinant < 20);
    vec root = lanes_cube_root(lanes_select(shape, determinant, lanes_set(1)));
    for (int i = 0; i < 9; i++) S[i] /= root;
    return shape;
}

/* What a block's regions keep of this step's stretch. */
static __attribute__((noinline)) void plastic_flow(const OctTask *task, long block,
                                                   const vec strain[9], ivec yields)
{
    real *plastic = task->body->plastic + block * 9 * SM_LANES,
         *to = task->body->inverse + block * 9 * SM_LANES;
    vec S[9], before[9], inverse[9];
    load9(plastic, S);
    load9(plastic, before);
    yields &= plastic_creep(&task->oct->params, strain, S);
    for (int i = 0; i < 9; i++) S[i] = lanes_select(yields, S[i], before[i]);
    plastic_inverse(task->oct->spread + block * 6 * SM_LANES, S, inverse);
    store9(plastic, S);
    store9(to, inverse);
}

/* The linear part F = R_r S_r of a block's transforms, and then what its regions keep. */
SM_INLINE void plastic_block(const OctTask *task, long block, const vec A[9], const vec R[9],
                             vec F[9])
{
    vec S[9], inverse[9], turned[9], strain[9];
    load9(task->body->plastic + block * 9 * SM_LANES, S);
    lanes_multiply(R, S, false, F);
    if (task->goals) return;
    load9(task->body->inverse + block * 9 * SM_LANES, inverse);
    for (int i = 0; i < 9; i++) {
        turned[i] = lanes_set(0); /* R^T A */
        for (int k = 0; k < 3; k++) turned[i] += R[k * 3 + i / 3] * A[k * 3 + i % 3];
    }
    lanes_multiply(turned, inverse, false, strain);
    for (int i = 0; i < 9; i += 4) strain[i] -= 1;
    real yield = (real)(task->oct->params.yield * task->oct->params.yield);
    ivec yields = (polar_norm(strain) > yield) & (inverse[0] > 0);
    if (lanes_any(yields)) plastic_flow(task, block, strain, yields);
}

#endif
