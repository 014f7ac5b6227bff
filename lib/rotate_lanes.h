/* rotate_lanes.h - rotations of shape matching regions, SM_LANES at once, with memory for ties. */
#ifndef SM_ROTATE_LANES_H
#define SM_ROTATE_LANES_H

#include "polar_lanes.h"

typedef short short_vec __attribute__((vector_size(SM_LANES * sizeof(short))));
typedef short short_loose
    __attribute__((vector_size(SM_LANES * sizeof(short)), aligned(sizeof(short))));

/* The last rotation of a tile of regions is kept as its first two columns in 1/32767: it only says
 * which of several equally good rotations is nearest. */
SM_INLINE void last_store(short *last, const vec R[9])
{
    for (int i = 0; i < 3; i++)
        for (int column = 0; column < 2; column++) {
            /* by way of whole lanes: compilers convert straight to short one by one */
            ivec whole = __builtin_convertvector(R[i * 3 + column] * 32767, ivec);
            short_vec packed = __builtin_convertvector(whole, short_vec);
            *(short_loose *)(last + (column * 3 + i) * SM_LANES) = packed;
        }
}

/* The rotations, orthonormal to rounding. */
SM_INLINE void last_load(const short *last, vec R[9])
{
    vec column[2][3], along = lanes_set(0);
    for (int i = 0; i < 6; i++) {
        short_vec packed = *(const short_loose *)(last + i * SM_LANES);
        column[i / 3][i % 3] =
            __builtin_convertvector(__builtin_convertvector(packed, ivec), vec) / 32767;
    }
    for (int c = 0; c < 2; c++) {
        vec square = lanes_set(0);
        for (int i = 0; i < 3; i++) column[c][i] -= (real)c * along * column[0][i];
        for (int i = 0; i < 3; i++) square += column[c][i] * column[c][i];
        vec inverse = 1 / lanes_sqrt(square);
        for (int i = 0; i < 3; i++) column[c][i] *= inverse;
        for (int i = 0; i < 3; i++) along += column[0][i] * column[1][i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        R[i * 3] = column[0][i];
        R[i * 3 + 1] = column[1][i];
        R[i * 3 + 2] = column[0][j] * column[1][k] - column[0][k] * column[1][j];
    }
}

/* The lanes of one tile that the fast method has left out. */
static __attribute__((noinline)) void polar_ties(const vec A[9], ivec tie, const int *slot,
                                                 const short *last, vec R[9])
{
    vec before[9];
    last_load(last, before);
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (slot[lane] >= 0) continue;
        tie[lane] = 0; /* an empty lane needs no rotation, only a finite one */
        for (int i = 0; i < 9; i++) R[i][lane] = i % 4 == 0;
    }
    polar_mend(A, tie, before, R);
}

/* Rotations of one or two tiles that follow each other by the fast method, near the last ones where
 * they are not unique; updates `last`. Lanes whose slot is negative hold no region. */
SM_INLINE void polar_fast_lanes(int tiles, const vec (*A)[9], const int *slot, short *last,
                                vec (*R)[9])
{
    ivec tie[2];
    polar_quartic(tiles, A, R, tie);
    for (int t = 0; t < tiles; t++)
        if (__builtin_expect(lanes_any(tie[t]), 0)) { /* copies: A and R stay in registers */
            vec from[9], to[9];
            memcpy(from, A[t], sizeof from);
            memcpy(to, R[t], sizeof to);
            polar_ties(from, tie[t], slot + t * SM_LANES, last + t * 6 * SM_LANES, to);
            memcpy(R[t], to, sizeof to);
        }
    for (int t = 0; t < tiles; t++) last_store(last + t * 6 * SM_LANES, R[t]);
}

#endif
