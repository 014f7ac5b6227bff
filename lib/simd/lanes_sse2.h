/* lanes_sse2.h - operations on lanes (lanes.h) of vectors of 16 bytes; in double precision of two
 * such. What is not here is portable. */
#ifndef SM_LANES_SSE2_H
#define SM_LANES_SSE2_H

#include <emmintrin.h>

#define LANES_HAVE_MASKS
#define LANES_HAVE_NUMBERS

#if SM_REAL_BITS == 32
SM_INLINE unsigned lanes_bits(ivec mask)
{
    return (unsigned)_mm_movemask_ps((__m128)mask);
}

SM_INLINE vec lanes_max(vec a, vec b)
{
    return (vec)_mm_max_ps((__m128)a, (__m128)b);
}

SM_INLINE vec lanes_sqrt(vec v)
{
    return (vec)_mm_sqrt_ps((__m128)v);
}
#else
#define LANES_LOW(v)        ((__m128d)__builtin_shufflevector(v, v, 0, 1))
#define LANES_HIGH(v)       ((__m128d)__builtin_shufflevector(v, v, 2, 3))
#define LANES_OF(low, high) ((vec)__builtin_shufflevector(low, high, 0, 1, 2, 3))

SM_INLINE unsigned lanes_bits(ivec mask)
{
    return (unsigned)(_mm_movemask_pd(LANES_LOW(mask)) | _mm_movemask_pd(LANES_HIGH(mask)) << 2);
}

SM_INLINE vec lanes_max(vec a, vec b)
{
    return LANES_OF(_mm_max_pd(LANES_LOW(a), LANES_LOW(b)),
                    _mm_max_pd(LANES_HIGH(a), LANES_HIGH(b)));
}

SM_INLINE vec lanes_sqrt(vec v)
{
    return LANES_OF(_mm_sqrt_pd(LANES_LOW(v)), _mm_sqrt_pd(LANES_HIGH(v)));
}
#endif

#endif
