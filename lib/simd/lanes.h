/* lanes.h - small operations on vectors of lanes (real.h), one body for both precisions.
 *
 * Arithmetic and comparisons are the compiler's own. What it does badly is written for each
 * instruction set: lanes_avx512.h, lanes_avx2.h; lanes_portable.h is for the others (lanes_sse2.h,
 * lanes_neon.h, lanes_wasm.h), and says what each does. */
#ifndef SM_LANES_H
#define SM_LANES_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "real.h"

/* A pass is made for each width, layout and precision by inlining all that it does with constants.
 * Under sanitizers every inlined copy would be instrumented anew, which takes compilers minutes:
 * SM_CALLS leaves the choice to them. */
#ifdef SM_CALLS
#define SM_INLINE static inline
#else
#define SM_INLINE static inline __attribute__((always_inline))
#endif

SM_INLINE vec lanes_load(const real *p) /* any alignment */
{
    return *(const vec_loose *)p;
}

SM_INLINE void lanes_store(real *p, vec v)
{
    *(vec_loose *)p = v;
}

/* Coordinates of a block of particles, stored x[3][lanes]; short rows. Any alignment. */
SM_INLINE void load3(const real *p, vec out[3])
{
    for (int d = 0; d < 3; d++) out[d] = lanes_load(p + d * SM_LANES);
}

SM_INLINE void store3(real *p, const vec in[3])
{
    for (int d = 0; d < 3; d++) lanes_store(p + d * SM_LANES, in[d]);
}

/* Into registers or out of them, at most 16: memcpy() would be called for as many, and so would it
 * be by a compiler that has not unrolled the loop first. */
SM_INLINE void lanes_copy(int count, const vec *from, vec *to)
{
#pragma GCC unroll 16
    for (int i = 0; i < count; i++) to[i] = from[i];
}

SM_INLINE vec4 load4(const real *p)
{
    return *(const vec4_loose *)p;
}

SM_INLINE void store4(real *p, vec4 v)
{
    *(vec4_loose *)p = v;
}

SM_INLINE vec lanes_set(real value)
{
    return value - (vec){0};
}

/* 0, 1, 2, .. */
SM_INLINE vec lanes_number(void)
{
    vec number;
    for (int i = 0; i < SM_LANES; i++) number[i] = (real)i;
    return number;
}

/* Bits say which lanes: bit i is lane i. */
#define LANES_ALL ((1u << SM_LANES) - 1)

/* clang-format off */
#if SM_LANES == 16
#define LANES_FROM(o) (o), (o) + 1, (o) + 2, (o) + 3, (o) + 4, (o) + 5, (o) + 6, (o) + 7, \
                      (o) + 8, (o) + 9, (o) + 10, (o) + 11, (o) + 12, (o) + 13, (o) + 14, (o) + 15
#define LANES_SLIDES(F) F(1) F(2) F(3) F(4) F(5) F(6) F(7) F(8) F(9) F(10) F(11) F(12) F(13) F(14) F(15)
#elif SM_LANES == 8
#define LANES_FROM(o) (o), (o) + 1, (o) + 2, (o) + 3, (o) + 4, (o) + 5, (o) + 6, (o) + 7
#define LANES_SLIDES(F) F(1) F(2) F(3) F(4) F(5) F(6) F(7)
#else
#define LANES_FROM(o) (o), (o) + 1, (o) + 2, (o) + 3
#define LANES_SLIDES(F) F(1) F(2) F(3)
#endif
#if SM_LANES == 4
#define LANES_MASK(b) {-((b)&1), -((b) >> 1 & 1), -((b) >> 2 & 1), -((b) >> 3 & 1)}
static const ivec lanes_masks[16] __attribute__((unused)) = {
    LANES_MASK(0), LANES_MASK(1), LANES_MASK(2),  LANES_MASK(3),  LANES_MASK(4),  LANES_MASK(5),  LANES_MASK(6),  LANES_MASK(7),
    LANES_MASK(8), LANES_MASK(9), LANES_MASK(10), LANES_MASK(11), LANES_MASK(12), LANES_MASK(13), LANES_MASK(14), LANES_MASK(15)};
#endif
/* clang-format on */

#if SM_LANES == 4
SM_INLINE ivec lanes_of_bits(unsigned lanes)
{
    return lanes_masks[lanes];
}
#endif

#if SM_VECTOR_BYTES == 64
#include "lanes_avx512.h"
#elif SM_VECTOR_BYTES == 32
#include "lanes_avx2.h"
#else
#include "lanes_portable.h"
#endif

#if SM_VECTOR_BYTES < 64
SM_INLINE vec lanes_choose(unsigned lanes, vec yes, vec no)
{
    return lanes_select(lanes_of_bits(lanes), yes, no);
}

/* Zero in the lanes whose bit is not set. */
SM_INLINE vec lanes_keep(unsigned lanes, vec v)
{
    return (vec)((ivec)v & lanes_of_bits(lanes));
}
#endif

SM_INLINE vec lanes_and(vec v, ivec mask)
{
    return (vec)((ivec)v & mask);
}

SM_INLINE vec lanes_abs(vec v)
{
#if SM_REAL_BITS == 32
    return (vec)((ivec)v & 0x7fffffff);
#else
    return (vec)((ivec)v & 0x7fffffffffffffffll);
#endif
}

/* By a constant. */
#ifndef LANES_SLIDE
#define LANES_SLIDE(o)                                                                             \
    case o:                                                                                        \
        return __builtin_shufflevector(low, high, LANES_FROM(o));
#endif

/* Lanes o .. o + SM_LANES - 1 of the two vectors low, high laid end to end; 0 <= o <= SM_LANES. One
 * instruction, or two, where o is a constant. */
SM_INLINE vec lanes_slide(vec low, vec high, int o)
{
#ifdef LANES_SLIDE_ANY
    if (!__builtin_constant_p(o)) return lanes_slide_any(low, high, o);
#endif
    switch (o) {
        LANES_SLIDES(LANES_SLIDE)
    default:
        return o ? high : low;
    }
}

/* A vector from its parts. */
SM_INLINE vec lanes_join(const part_vec part[SM_LANES / SM_PART])
{
#if SM_LANES > SM_PART
    return __builtin_shufflevector(part[0], part[1], LANES_FROM(0));
#else
    return part[0];
#endif
}

/* clang-format off */
#if SM_LANES == 16
#define LANES_EVEN     0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30
#define LANES_ODD      1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31
#elif SM_LANES == 8
#define LANES_EVEN     0, 2, 4, 6, 8, 10, 12, 14
#define LANES_ODD      1, 3, 5, 7, 9, 11, 13, 15
#else
#define LANES_EVEN     0, 2, 4, 6
#define LANES_ODD      1, 3, 5, 7
#endif
#ifdef LANES_HALVES
#elif SM_LANES == 16
#define LANES_ZIP_LOW  0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23
#define LANES_ZIP_HIGH 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31
#elif SM_LANES == 8
#define LANES_ZIP_LOW  0, 8, 1, 9, 2, 10, 3, 11
#define LANES_ZIP_HIGH 4, 12, 5, 13, 6, 14, 7, 15
#else
#define LANES_ZIP_LOW  0, 4, 1, 5
#define LANES_ZIP_HIGH 2, 6, 3, 7
#endif
/* clang-format on */

/* log2(n) rounds of zips. */
SM_INLINE void lanes_zip(vec *m, int n)
{
    for (int round = 1; round < n; round *= 2) {
        vec out[16];
        for (int i = 0; i < n / 2; i++) {
            out[2 * i] = __builtin_shufflevector(m[i], m[i + n / 2], LANES_ZIP_LOW);
            out[2 * i + 1] = __builtin_shufflevector(m[i], m[i + n / 2], LANES_ZIP_HIGH);
        }
        for (int i = 0; i < n; i++) m[i] = out[i];
    }
}

/* From `n` vectors, a power of two to 16, to the rows of their lanes: afterwards the vectors, laid
 * end to end, hold lane 0 of all, then lane 1 of all, and so on. Perfect shuffles: log2(n) rounds
 * of zips. With n = SM_LANES this is a transpose. */
#ifndef LANES_HALVES
SM_INLINE void lanes_interleave(vec *m, int n)
{
    lanes_zip(m, n);
}
#else
/* The processor zips the halves of a vector for themselves: they are put in their places first
 * where the rows are vectors, and else at the end. */
SM_INLINE void lanes_interleave(vec *m, int n)
{
    if (n < 2) return;
    vec half[16];
    if (n != SM_LANES) lanes_zip(m, n);
    for (int i = 0; i < n / 2; i++) {
        int a = n == SM_LANES ? i : 2 * i, b = n == SM_LANES ? i + n / 2 : 2 * i + 1;
        half[i] = __builtin_shufflevector(m[a], m[b], LANES_LOWS);
        half[i + n / 2] = __builtin_shufflevector(m[a], m[b], LANES_HIGHS);
    }
    lanes_copy(n, half, m);
    if (n != SM_LANES) return;
    lanes_zip(m, n / 2);
    lanes_zip(m + n / 2, n / 2);
}
#endif

/* The reverse of lanes_interleave(): from the rows of lanes to a vector for each of their values.
 */
SM_INLINE void lanes_separate(vec *m, int n)
{
    for (int round = 1; round < n; round *= 2) {
        vec out[16];
        for (int i = 0; i < n / 2; i++) {
            out[i] = __builtin_shufflevector(m[2 * i], m[2 * i + 1], LANES_EVEN);
            out[i + n / 2] = __builtin_shufflevector(m[2 * i], m[2 * i + 1], LANES_ODD);
        }
        for (int i = 0; i < n; i++) m[i] = out[i];
    }
}

/* `field[f]` lane i = row[i][f], for SM_LANES rows of 16 values each. */
SM_INLINE void lanes_from_rows(const real *const row[SM_LANES], vec field[16])
{
    for (int part = 0; part < 16; part += SM_LANES) {
        for (int i = 0; i < SM_LANES; i++) field[part + i] = lanes_load(row[i] + part);
        lanes_interleave(field + part, SM_LANES);
    }
}

/* The reverse; row i is written whole. Destroys `field`. */
SM_INLINE void lanes_to_rows(vec field[16], real *const row[SM_LANES])
{
    for (int part = 0; part < 16; part += SM_LANES) {
        lanes_interleave(field + part, SM_LANES);
        for (int i = 0; i < SM_LANES; i++) lanes_store(row[i] + part, field[part + i]);
    }
}

#endif
