/* lanes_avx2.h - operations on lanes (lanes.h, lanes_portable.h) of vectors of 32 bytes. */
#ifndef SM_LANES_AVX2_H
#define SM_LANES_AVX2_H

#include <immintrin.h>
#include <stdint.h>

/* Zips of each half for itself are one instruction, others two. */
#define LANES_HALVES
#if SM_REAL_BITS == 32
#define LANES_ZIP_LOW  0, 8, 1, 9, 4, 12, 5, 13
#define LANES_ZIP_HIGH 2, 10, 3, 11, 6, 14, 7, 15
#define LANES_LOWS     0, 1, 2, 3, 8, 9, 10, 11
#define LANES_HIGHS    4, 5, 6, 7, 12, 13, 14, 15
#else
#define LANES_ZIP_LOW  0, 4, 2, 6
#define LANES_ZIP_HIGH 1, 5, 3, 7
#define LANES_LOWS     0, 1, 4, 5
#define LANES_HIGHS    2, 3, 6, 7
#endif

#if SM_REAL_BITS == 32
typedef __m256 native_vec;
#define AVX2(name) _mm256_##name##_ps
#else
typedef __m256d native_vec;
#define AVX2(name) _mm256_##name##_pd
#endif

SM_INLINE vec lanes_select(ivec mask, vec yes, vec no)
{
    return (vec)AVX2(blendv)((native_vec)no, (native_vec)yes, (native_vec)mask);
}

SM_INLINE bool lanes_any(ivec mask)
{
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
}

#if SM_REAL_BITS == 32
/* Bit i of a number as byte i, all of whose bits are as it is: one instruction widens them. */
#define LANES_BYTE(b, i) ((uint64_t)((b) >> (i)&1) * 0xff << 8 * (i))
#define LANES_BYTES(b)                                                                             \
    LANES_BYTE(b, 0) | LANES_BYTE(b, 1) | LANES_BYTE(b, 2) | LANES_BYTE(b, 3) | LANES_BYTE(b, 4) | \
        LANES_BYTE(b, 5) | LANES_BYTE(b, 6) | LANES_BYTE(b, 7)
#define LANES_BYTES_4(b) LANES_BYTES(b), LANES_BYTES(b + 1), LANES_BYTES(b + 2), LANES_BYTES(b + 3)
#define LANES_BYTES_16(b)                                                                          \
    LANES_BYTES_4(b), LANES_BYTES_4(b + 4), LANES_BYTES_4(b + 8), LANES_BYTES_4(b + 12)
#define LANES_BYTES_64(b)                                                                          \
    LANES_BYTES_16(b), LANES_BYTES_16(b + 16), LANES_BYTES_16(b + 32), LANES_BYTES_16(b + 48)
static const uint64_t lanes_bytes[256] __attribute__((unused)) = {
    LANES_BYTES_64(0), LANES_BYTES_64(64), LANES_BYTES_64(128), LANES_BYTES_64(192)};

SM_INLINE ivec lanes_of_bits(unsigned lanes)
{
    const __m128i *bytes = (const __m128i *)(lanes_bytes + lanes);
    return (ivec)_mm256_cvtepi8_epi32(_mm_loadl_epi64(bytes));
}
#endif

SM_INLINE unsigned lanes_below(vec a, vec b)
{
    return (unsigned)AVX2(movemask)((native_vec)(a < b));
}

SM_INLINE vec lanes_max(vec a, vec b)
{
    return (vec)AVX2(max)((native_vec)a, (native_vec)b);
}

SM_INLINE vec lanes_sqrt(vec v)
{
    return (vec)AVX2(sqrt)((native_vec)v);
}

SM_INLINE vec lanes_rounded(vec product)
{
    __asm__("" : "+x"(product));
    return product;
}

SM_INLINE part_vec part_load(const real *p, unsigned lanes)
{
    return (part_vec)AVX2(maskload)(p, (__m256i)lanes_of_bits(lanes));
}

#endif
