/* lanes.h - small operations on vectors of lanes (real.h), one body for both precisions. */
#ifndef SM_LANES_H
#define SM_LANES_H

#include <math.h>
#include <string.h>

#include "real.h"

#ifdef __AVX512F__
#include <immintrin.h>
#endif

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

SM_INLINE vec8 load8(const real *p)
{
    return *(const vec8_loose *)p;
}

SM_INLINE vec16 load16(const real *p)
{
    return *(const vec16_loose *)p;
}

SM_INLINE void store4(real *p, vec4 v)
{
    *(vec4_loose *)p = v;
}
SM_INLINE void store8(real *p, vec8 v)
{
    *(vec8_loose *)p = v;
}
SM_INLINE void store16(real *p, vec16 v)
{
    *(vec16_loose *)p = v;
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

SM_INLINE vec lanes_select(ivec mask, vec yes, vec no)
{
    return (vec)((mask & (ivec)yes) | (~mask & (ivec)no));
}

SM_INLINE vec lanes_and(vec v, ivec mask)
{
    return (vec)((ivec)v & mask);
}

/* Bits say which lanes: bit i is lane i. One instruction, or none where it goes with the one that
 * makes v. */
#define LANES_ALL ((1u << SM_LANES) - 1)

#ifndef __AVX512F__
SM_INLINE ivec lanes_of_bits(unsigned lanes)
{
    ivec mask;
    for (int i = 0; i < SM_LANES; i++) mask[i] = -(lane_int)(lanes >> i & 1);
    return mask;
}
#endif

/* The lanes where a < b; a NaN is not. */
SM_INLINE unsigned lanes_below(vec a, vec b)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
#elif defined(__AVX512F__)
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#else
    ivec mask = a < b;
    unsigned lanes = 0;
    for (int i = 0; i < SM_LANES; i++) lanes |= (unsigned)(mask[i] & 1) << i;
    return lanes;
#endif
}

SM_INLINE vec lanes_choose(unsigned lanes, vec yes, vec no)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec)_mm512_mask_mov_ps((__m512)no, (__mmask16)lanes, (__m512)yes);
#elif defined(__AVX512F__)
    return (vec)_mm512_mask_mov_pd((__m512d)no, (__mmask8)lanes, (__m512d)yes);
#else
    return lanes_select(lanes_of_bits(lanes), yes, no);
#endif
}

/* Zero in the lanes whose bit is not set. */
SM_INLINE vec lanes_keep(unsigned lanes, vec v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec)_mm512_maskz_mov_ps((__mmask16)lanes, (__m512)v);
#elif defined(__AVX512F__)
    return (vec)_mm512_maskz_mov_pd((__mmask8)lanes, (__m512d)v);
#else
    return lanes_and(v, lanes_of_bits(lanes));
#endif
}

SM_INLINE vec lanes_max(vec a, vec b)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec)_mm512_max_ps((__m512)a, (__m512)b);
#elif defined(__AVX512F__)
    return (vec)_mm512_max_pd((__m512d)a, (__m512d)b);
#else
    return lanes_select(a > b, a, b);
#endif
}

SM_INLINE vec lanes_abs(vec v)
{
#if SM_REAL_BITS == 32
    return (vec)((ivec)v & 0x7fffffff);
#else
    return (vec)((ivec)v & 0x7fffffffffffffffll);
#endif
}

SM_INLINE vec lanes_sqrt(vec v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec)_mm512_sqrt_ps((__m512)v);
#elif defined(__AVX512F__)
    return (vec)_mm512_sqrt_pd((__m512d)v);
#else
    vec root;
    for (int i = 0; i < SM_LANES; i++)
        root[i] = SM_REAL_BITS == 32 ? (real)sqrtf((float)v[i]) : (real)sqrt((double)v[i]);
    return root;
#endif
}

/* 1 / v to a relative error of 1e-4 in single and 1e-8 in double precision, or better. */
SM_INLINE vec lanes_rough_inverse(vec v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec)_mm512_rcp14_ps((__m512)v);
#elif defined(__AVX512F__)
    vec rough = (vec)_mm512_rcp14_pd((__m512d)v);
    return rough + rough * (1 - v * rough);
#else
    return 1 / v;
#endif
}

/* sqrt(v) to 1e-4; v > 0. */
SM_INLINE vec lanes_rough_root(vec v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return v * (vec)_mm512_rsqrt14_ps((__m512)v);
#elif defined(__AVX512F__)
    return v * (vec)_mm512_rsqrt14_pd((__m512d)v);
#else
    return lanes_sqrt(v);
#endif
}

/* 1 / v to about the last bit. */
SM_INLINE vec lanes_inverse(vec v)
{
#ifdef __AVX512F__
    vec rough = lanes_rough_inverse(v);
    return rough + rough * (1 - v * rough);
#else
    return 1 / v;
#endif
}

SM_INLINE int lanes_any(ivec mask)
{
#ifdef __AVX512F__
    return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#else
    lane_int any = 0;
    for (int i = 0; i < SM_LANES; i++) any |= mask[i];
    return any != 0;
#endif
}

/* The cases of lanes_slide(), whose offset must be written out. */
/* clang-format off */
#ifdef __AVX512F__
static const lane_int lanes_count[32] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
#if SM_LANES == 16
#define LANES_ALIGN(o) case o: return (vec)_mm512_alignr_epi32((__m512i)high, (__m512i)low, o)
#define LANES_ALIGN_REST \
    LANES_ALIGN(8); LANES_ALIGN(9); LANES_ALIGN(10); LANES_ALIGN(11); \
    LANES_ALIGN(12); LANES_ALIGN(13); LANES_ALIGN(14); LANES_ALIGN(15)
#else
#define LANES_ALIGN(o) case o: return (vec)_mm512_alignr_epi64((__m512i)high, (__m512i)low, o)
#define LANES_ALIGN_REST
#endif
#define LANES_ALIGN_ALL \
    LANES_ALIGN(1); LANES_ALIGN(2); LANES_ALIGN(3); LANES_ALIGN(4); \
    LANES_ALIGN(5); LANES_ALIGN(6); LANES_ALIGN(7); LANES_ALIGN_REST
#endif
/* clang-format on */

/* Lanes o .. o + SM_LANES - 1 of the two vectors low, high laid end to end; 0 <= o <= SM_LANES. One
 * instruction where o is a constant. */
SM_INLINE vec lanes_slide(vec low, vec high, int o)
{
#ifdef __AVX512F__
    if (__builtin_constant_p(o)) {
        switch (o) {
            LANES_ALIGN_ALL;
        }
    }
    if (o == SM_LANES) return high;
    __m512i index = _mm512_loadu_si512(lanes_count + o);
#if SM_REAL_BITS == 32
    return (vec)_mm512_permutex2var_ps((__m512)low, index, (__m512)high);
#else
    return (vec)_mm512_permutex2var_pd((__m512d)low, index, (__m512d)high);
#endif
#else
    real both[2 * SM_LANES];
    lanes_store(both, low);
    lanes_store(both + SM_LANES, high);
    return lanes_load(both + o);
#endif
}

/* Half a vector from p on where bit i of `lanes` is set, else zero; what is not set may lie outside
 * of an array. */
SM_INLINE half_vec half_load(const real *p, unsigned lanes)
{
#if defined(__AVX512VL__) && SM_REAL_BITS == 32
    return (half_vec)_mm256_maskz_loadu_ps((__mmask8)lanes, p);
#elif defined(__AVX512VL__)
    return (half_vec)_mm256_maskz_loadu_pd((__mmask8)lanes, p);
#else
    half_vec picked = {0};
    for (int i = 0; i < SM_LANES / 2; i++)
        if (lanes >> i & 1) picked[i] = p[i];
    return picked;
#endif
}

SM_INLINE vec lanes_join(half_vec low, half_vec high)
{
#if SM_LANES == 16
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

#if SM_LANES == 16
#define LANES_ZIP_LOW  0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23
#define LANES_ZIP_HIGH 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31
#define LANES_EVEN     0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30
#define LANES_ODD      1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31
#else
#define LANES_ZIP_LOW  0, 8, 1, 9, 2, 10, 3, 11
#define LANES_ZIP_HIGH 4, 12, 5, 13, 6, 14, 7, 15
#define LANES_EVEN     0, 2, 4, 6, 8, 10, 12, 14
#define LANES_ODD      1, 3, 5, 7, 9, 11, 13, 15
#endif

/* From `n` vectors, a power of two, to the rows of their lanes: afterwards the vectors, laid end to
 * end, hold lane 0 of all, then lane 1 of all, and so on. Perfect shuffles: log2(n) rounds of zips.
 * With n = SM_LANES this is a transpose. */
SM_INLINE void lanes_interleave(vec *m, int n)
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
