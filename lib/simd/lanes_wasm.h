/* lanes_wasm.h - operations on native_vec (lanes_portable.h) of WebAssembly's simd128. */
#ifndef SM_LANES_WASM_H
#define SM_LANES_WASM_H

#include <wasm_simd128.h>

#if SM_REAL_BITS == 32
#define WASM_NUMBERS(name) wasm_f32x4_##name
#define WASM_MASK(name)    wasm_i32x4_##name
#else
#define WASM_NUMBERS(name) wasm_f64x2_##name
#define WASM_MASK(name)    wasm_i64x2_##name
#endif

SM_INLINE unsigned native_bits(native_ivec mask)
{
    return WASM_MASK(bitmask)((v128_t)mask);
}

SM_INLINE bool native_any(native_ivec mask)
{
    return wasm_v128_any_true((v128_t)mask);
}

/* "pmax" is b > a ? b : a. */
SM_INLINE native_vec native_max(native_vec a, native_vec b)
{
    return (native_vec)WASM_NUMBERS(pmax)((v128_t)b, (v128_t)a);
}

SM_INLINE native_vec native_sqrt(native_vec v)
{
    return (native_vec)WASM_NUMBERS(sqrt)((v128_t)v);
}

/* There is no fused multiplication. */
SM_INLINE native_vec native_rounded(native_vec product)
{
    return product;
}

#endif
