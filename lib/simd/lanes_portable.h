/* lanes_portable.h - operations on lanes (lanes.h) for any instruction set, lane by lane where the
 * compiler's vectors have no such. */
#ifndef SM_LANES_PORTABLE_H
#define SM_LANES_PORTABLE_H

#ifdef __SSE2__
#include "lanes_sse2.h"
#endif

/* Of lanes with `mask` set all over, and else 0. */
SM_INLINE vec lanes_select(ivec mask, vec yes, vec no)
{
    return (vec)((mask & (ivec)yes) | (~mask & (ivec)no));
}

/* The lanes whose mask is set, as bits. */
#ifndef LANES_HAVE_MASKS
SM_INLINE unsigned lanes_bits(ivec mask)
{
    unsigned lanes = 0;
    for (int i = 0; i < SM_LANES; i++) lanes |= (unsigned)(mask[i] & 1) << i;
    return lanes;
}
#endif

/* Is any bit set? */
SM_INLINE bool lanes_any(ivec mask)
{
    return lanes_bits(mask != 0) != 0;
}

SM_INLINE ivec lanes_of_bits(unsigned lanes)
{
    const ivec bit = {1, 2, 4, 8};
    return ((lane_int)lanes & bit) == bit;
}

/* The lanes where a < b; a NaN is not. */
SM_INLINE unsigned lanes_below(vec a, vec b)
{
    return lanes_bits(a < b);
}

SM_INLINE vec lanes_choose(unsigned lanes, vec yes, vec no)
{
    return lanes_select(lanes_of_bits(lanes), yes, no);
}

/* Zero in the lanes whose bit is not set. */
SM_INLINE vec lanes_keep(unsigned lanes, vec v)
{
    return (vec)((ivec)v & lanes_of_bits(lanes));
}

#ifndef LANES_HAVE_NUMBERS
SM_INLINE vec lanes_max(vec a, vec b)
{
    return lanes_select(a > b, a, b);
}

SM_INLINE vec lanes_sqrt(vec v)
{
    vec root;
    for (int i = 0; i < SM_LANES; i++)
        root[i] = SM_REAL_BITS == 32 ? (real)sqrtf((float)v[i]) : (real)sqrt((double)v[i]);
    return root;
}
#endif

/* 1 / v to a relative error of 1e-4 in single and 1e-8 in double precision, or better. */
SM_INLINE vec lanes_rough_inverse(vec v)
{
    return 1 / v;
}

/* sqrt(v) to 1e-4; v > 0. */
SM_INLINE vec lanes_rough_root(vec v)
{
    return lanes_sqrt(v);
}

/* 1 / v to about the last bit. */
SM_INLINE vec lanes_inverse(vec v)
{
    return 1 / v;
}

/* A product that is rounded before it is used, never fused with a sum: what enters a window leaves
 * it with the same value, and a goal is the same wherever it is computed. */
SM_INLINE vec lanes_rounded(vec product)
{
#if defined(__ARM_FEATURE_FMA) && SM_REAL_BITS == 32
    __asm__("" : "+w"(product));
#elif defined(__FMA__) || defined(__ARM_FEATURE_FMA)
    __asm__("" : "+m"(product)); /* wider than a register */
#endif
    return product;
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
