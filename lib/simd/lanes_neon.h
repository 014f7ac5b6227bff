/* lanes_neon.h - operations on native_vec (lanes_portable.h) of ARM's NEON, 64-bit. */
#ifndef SM_LANES_NEON_H
#define SM_LANES_NEON_H

#include <arm_neon.h>

SM_INLINE unsigned native_bits(native_ivec mask)
{
#if SM_REAL_BITS == 32
    const native_ivec bit = {1, 2, 4, 8};
    return vaddvq_u32((uint32x4_t)(mask & bit));
#else
    const native_ivec bit = {1, 2};
    return (unsigned)vaddvq_u64((uint64x2_t)(mask & bit));
#endif
}

SM_INLINE bool native_any(native_ivec mask)
{
    return vmaxvq_u32((uint32x4_t)mask) != 0;
}

/* NEON's own maximum of a NaN and a number is the NaN. */
SM_INLINE native_vec native_max(native_vec a, native_vec b)
{
#if SM_REAL_BITS == 32
    return (native_vec)vbslq_f32(vcgtq_f32((float32x4_t)a, (float32x4_t)b), (float32x4_t)a,
                                 (float32x4_t)b);
#else
    return (native_vec)vbslq_f64(vcgtq_f64((float64x2_t)a, (float64x2_t)b), (float64x2_t)a,
                                 (float64x2_t)b);
#endif
}

SM_INLINE native_vec native_sqrt(native_vec v)
{
#if SM_REAL_BITS == 32
    return (native_vec)vsqrtq_f32((float32x4_t)v);
#else
    return (native_vec)vsqrtq_f64((float64x2_t)v);
#endif
}

SM_INLINE native_vec native_rounded(native_vec product)
{
    __asm__("" : "+w"(product));
    return product;
}

#endif
