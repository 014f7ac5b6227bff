/* lanes_avx512.h - operations on lanes (lanes.h, lanes_portable.h) of vectors of 64 bytes. Bits are
 * masks of their own here: choosing lanes is one instruction, or none where it goes with the one
 * that makes a value. */
#ifndef SM_LANES_AVX512_H
#define SM_LANES_AVX512_H

#include <immintrin.h>

#if SM_REAL_BITS == 32
typedef __m512 native_vec;
typedef __mmask16 native_mask;
#define AVX512(name) _mm512_##name##_ps
#else
typedef __m512d native_vec;
typedef __mmask8 native_mask;
#define AVX512(name) _mm512_##name##_pd
#endif

SM_INLINE vec lanes_select(ivec mask, vec yes, vec no)
{
    return (vec)((mask & (ivec)yes) | (~mask & (ivec)no));
}

SM_INLINE bool lanes_any(ivec mask)
{
    return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
}

SM_INLINE unsigned lanes_below(vec a, vec b)
{
#if SM_REAL_BITS == 32
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
#else
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#endif
}

SM_INLINE vec lanes_choose(unsigned lanes, vec yes, vec no)
{
    return (vec)AVX512(mask_mov)((native_vec)no, (native_mask)lanes, (native_vec)yes);
}

SM_INLINE vec lanes_keep(unsigned lanes, vec v)
{
    return (vec)AVX512(maskz_mov)((native_mask)lanes, (native_vec)v);
}

SM_INLINE vec lanes_max(vec a, vec b)
{
    return (vec)AVX512(max)((native_vec)a, (native_vec)b);
}

SM_INLINE vec lanes_sqrt(vec v)
{
    return (vec)AVX512(sqrt)((native_vec)v);
}

SM_INLINE vec lanes_rounded(vec product)
{
    __asm__("" : "+v"(product));
    return product;
}

/* lanes_slide() by a constant: compilers take a permutation, whose indices are loaded. */
#if SM_REAL_BITS == 32
#define LANES_SLIDE(o)                                                                             \
    case o:                                                                                        \
        return (vec)_mm512_alignr_epi32((__m512i)high, (__m512i)low, o);
#else
#define LANES_SLIDE(o)                                                                             \
    case o:                                                                                        \
        return (vec)_mm512_alignr_epi64((__m512i)high, (__m512i)low, o);
#endif

/* lanes_slide() by a number that is no constant. */
#define LANES_SLIDE_ANY
SM_INLINE vec lanes_slide_any(vec low, vec high, int o)
{
    static const lane_int number[32] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10,
                                        11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21,
                                        22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
    if (o == SM_LANES) return high;
    __m512i index = _mm512_loadu_si512(number + o);
    return (vec)AVX512(permutex2var)((native_vec)low, index, (native_vec)high);
}

SM_INLINE part_vec part_load(const real *p, unsigned lanes)
{
#if SM_REAL_BITS == 32
    return (part_vec)_mm256_maskz_loadu_ps((__mmask8)lanes, p);
#else
    return (part_vec)_mm256_maskz_loadu_pd((__mmask8)lanes, p);
#endif
}

#endif
