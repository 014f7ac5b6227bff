/* lanes_portable.h - operations on lanes (lanes.h) for sets with vectors of 16 bytes, and, lane by
 * lane where the compiler's vectors have no such, for any other and with SM_SCALAR. */
#ifndef SM_LANES_PORTABLE_H
#define SM_LANES_PORTABLE_H

/* As wide as the processor's: in double precision a vector is two of these, low and high. Compilers
 * take wider ones apart, some of them number by number. */
typedef real native_vec __attribute__((vector_size(16)));
typedef lane_int native_ivec __attribute__((vector_size(16)));

#ifdef SM_SCALAR
#elif defined(__SSE2__)
#define LANES_NATIVE
#include "lanes_sse2.h"
#elif defined(__ARM_NEON) && defined(__aarch64__)
#define LANES_NATIVE
#include "lanes_neon.h"
#elif defined(__wasm_simd128__)
#define LANES_NATIVE
#include "lanes_wasm.h"
#endif

#if SM_REAL_BITS == 32
#define LANES_UNARY(f, v)     f(v)
#define LANES_BINARY(f, a, b) f(a, b)
#else
#define LANES_LOW(v)        __builtin_shufflevector(v, v, 0, 1)
#define LANES_HIGH(v)       __builtin_shufflevector(v, v, 2, 3)
#define LANES_OF(low, high) __builtin_shufflevector(low, high, 0, 1, 2, 3)
#define LANES_UNARY(f, v)   LANES_OF(f(LANES_LOW(v)), f(LANES_HIGH(v)))
#define LANES_BINARY(f, a, b)                                                                      \
    LANES_OF(f(LANES_LOW(a), LANES_LOW(b)), f(LANES_HIGH(a), LANES_HIGH(b)))
#endif

#define LANES_LESS(a, b) ((native_ivec)((a) < (b)))

/* Of lanes with `mask` set all over, and else 0. */
SM_INLINE vec lanes_select(ivec mask, vec yes, vec no)
{
    return (vec)((mask & (ivec)yes) | (~mask & (ivec)no));
}

/* The lanes whose mask is set, as bits. */
SM_INLINE unsigned lanes_bits(ivec mask)
{
#ifndef LANES_NATIVE
    unsigned lanes = 0;
    for (int i = 0; i < SM_LANES; i++) lanes |= (unsigned)(mask[i] & 1) << i;
    return lanes;
#elif SM_REAL_BITS == 32
    return native_bits(mask);
#else
    return native_bits(LANES_LOW(mask)) | native_bits(LANES_HIGH(mask)) << 2;
#endif
}

/* Is any bit set? */
SM_INLINE bool lanes_any(ivec mask)
{
#ifndef LANES_NATIVE
    return lanes_bits(mask != 0) != 0;
#elif SM_REAL_BITS == 32
    return native_any(mask);
#else
    return native_any(LANES_LOW(mask) | LANES_HIGH(mask));
#endif
}

/* The lanes where a < b; a NaN is not. */
SM_INLINE unsigned lanes_below(vec a, vec b)
{
    return lanes_bits(LANES_BINARY(LANES_LESS, a, b));
}

/* b where one of the two is a NaN. */
SM_INLINE vec lanes_max(vec a, vec b)
{
#ifdef LANES_NATIVE
    return LANES_BINARY(native_max, a, b);
#else
    return lanes_select(a > b, a, b);
#endif
}

SM_INLINE vec lanes_sqrt(vec v)
{
#ifdef LANES_NATIVE
    return LANES_UNARY(native_sqrt, v);
#else
    for (int i = 0; i < SM_LANES; i++)
        v[i] = SM_REAL_BITS == 32 ? (real)sqrtf((float)v[i]) : (real)sqrt((double)v[i]);
    return v;
#endif
}

/* A product that is rounded before it is used, never fused with a sum: what enters a window leaves
 * it with the same value, and a goal is the same wherever it is computed. */
SM_INLINE vec lanes_rounded(vec product)
{
#ifdef LANES_NATIVE
    return LANES_UNARY(native_rounded, product);
#else
    __asm__("" : "+m"(product)); /* wider than a register, maybe */
    return product;
#endif
}

/* Part of a vector from p on where bit i of `lanes` is set, else zero; what is not set may lie
 * outside of an array. */
SM_INLINE part_vec part_load(const real *p, unsigned lanes)
{
    part_vec picked = {0};
    for (int i = 0; i < SM_PART; i++)
        if (lanes >> i & 1) picked[i] = p[i];
    return picked;
}

#endif
