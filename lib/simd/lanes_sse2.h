/* lanes_sse2.h - operations on native_vec (lanes_portable.h) of x86-64's first vectors. */
#ifndef SM_LANES_SSE2_H
#define SM_LANES_SSE2_H

#include <emmintrin.h>

#if SM_REAL_BITS == 32
typedef __m128 sse2_vec;
#define SSE2(name) _mm_##name##_ps
#else
typedef __m128d sse2_vec;
#define SSE2(name) _mm_##name##_pd
#endif

SM_INLINE unsigned native_bits(native_ivec mask)
{
    return (unsigned)SSE2(movemask)((sse2_vec)mask);
}

SM_INLINE bool native_any(native_ivec mask)
{
    return _mm_movemask_epi8(_mm_cmpeq_epi32((__m128i)mask, _mm_setzero_si128())) != 0xffff;
}

SM_INLINE native_vec native_max(native_vec a, native_vec b)
{
    return (native_vec)SSE2(max)((sse2_vec)a, (sse2_vec)b);
}

SM_INLINE native_vec native_sqrt(native_vec v)
{
    return (native_vec)SSE2(sqrt)((sse2_vec)v);
}

SM_INLINE native_vec native_rounded(native_vec product)
{
    __asm__("" : "+x"(product));
    return product;
}

#endif
