/* rows.h - rows of 16 values, and of 8, that are read and summed as a whole: fours, of which each
 * is a vector's x, y, z and a fourth value (fastlsm/sums, octree/sum.h).
 *
 * A row is one vector of lanes or several. Compilers take a vector wider than the processor's apart
 * through memory, and gcc 12 then loses stores to it. */
#ifndef SM_ROWS_H
#define SM_ROWS_H

#include "lanes.h"

enum {
    ROW_VECS = 16 / SM_LANES,
    HALF_LANES = SM_LANES < 8 ? SM_LANES : 8,
    HALF_VECS = 8 / HALF_LANES
};
typedef real half_vec __attribute__((vector_size(HALF_LANES * sizeof(real))));
typedef real half_loose
    __attribute__((vector_size(HALF_LANES * sizeof(real)), aligned(sizeof(real))));

typedef struct {
    vec vector[ROW_VECS];
} Row;

typedef struct {
    half_vec vector[HALF_VECS];
} HalfRow;

SM_INLINE Row row_load(const real *p)
{
    Row row;
    for (int i = 0; i < ROW_VECS; i++) row.vector[i] = lanes_load(p + i * SM_LANES);
    return row;
}

SM_INLINE void row_store(real *p, Row row)
{
    for (int i = 0; i < ROW_VECS; i++) lanes_store(p + i * SM_LANES, row.vector[i]);
}

SM_INLINE Row row_add(Row a, Row b)
{
    for (int i = 0; i < ROW_VECS; i++) a.vector[i] += b.vector[i];
    return a;
}

SM_INLINE HalfRow half_load(const real *p)
{
    HalfRow half;
    for (int i = 0; i < HALF_VECS; i++) half.vector[i] = *(const half_loose *)(p + i * HALF_LANES);
    return half;
}

SM_INLINE void half_store(real *p, HalfRow half)
{
    for (int i = 0; i < HALF_VECS; i++) *(half_loose *)(p + i * HALF_LANES) = half.vector[i];
}

SM_INLINE HalfRow half_add(HalfRow a, HalfRow b)
{
    for (int i = 0; i < HALF_VECS; i++) a.vector[i] += b.vector[i];
    return a;
}

/* Two fours. */
SM_INLINE HalfRow half_of(vec4 first, vec4 second)
{
#if SM_LANES == 4
    return (HalfRow){{first, second}};
#else
    return (HalfRow){{__builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7)}};
#endif
}

/* The first four values. */
SM_INLINE vec4 half_first(HalfRow half)
{
#if SM_LANES == 4
    return half.vector[0];
#else
    return __builtin_shufflevector(half.vector[0], half.vector[0], 0, 1, 2, 3);
#endif
}

SM_INLINE Row row_less(Row a, Row b)
{
    for (int i = 0; i < ROW_VECS; i++) a.vector[i] -= b.vector[i];
    return a;
}

SM_INLINE HalfRow half_less(HalfRow a, HalfRow b)
{
    for (int i = 0; i < HALF_VECS; i++) a.vector[i] -= b.vector[i];
    return a;
}

/* A half and zeros. */
SM_INLINE Row row_of_half(HalfRow half)
{
    Row row = {0};
#if SM_LANES == 16 && defined(__AVX512F__)
    row.vector[0] = (vec)_mm512_zextps256_ps512((__m256)half.vector[0]);
#else
    memcpy(&row, &half, sizeof half);
#endif
    return row;
}

SM_INLINE vec4 row_first(Row row)
{
#if SM_LANES == 4
    return row.vector[0];
#else
    return __builtin_shufflevector(row.vector[0], row.vector[0], 0, 1, 2, 3);
#endif
}

/* `half` with `v` added to its first four values, or its last. */
SM_INLINE HalfRow half_add_four(HalfRow half, int last, vec4 v)
{
#if SM_LANES == 4
    half.vector[last] += v;
    return half;
#else
    const vec4 none = {0};
    return half_add(half, last ? half_of(none, v) : half_of(v, none));
#endif
}

/* `row` with `v` added to its four values number `at`. */
SM_INLINE Row row_add_four(Row row, int at, vec4 v)
{
#if SM_LANES == 16 && defined(__AVX512F__) /* the compiler would go through memory, and stall */
    row.vector[0] += (vec)_mm512_maskz_broadcast_f32x4((__mmask16)(15 << 4 * at), (__m128)v);
#elif SM_LANES == 8
    row.vector[at / 2] +=
        at % 2 ? half_of((vec4){0}, v).vector[0] : half_of(v, (vec4){0}).vector[0];
#else
    row.vector[at] += v;
#endif
    return row;
}

#endif
