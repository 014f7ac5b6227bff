/* real.h - the precision of a kernel, and its vector of lanes.
 *
 * Every kernel file is compiled twice, with SM_REAL_BITS 32 and 64; SM_NAME gives the two builds
 * different names. A vector holds SM_LANES values (GCC and clang vector extensions). */
#ifndef SM_REAL_H
#define SM_REAL_H

#ifndef SM_REAL_BITS
#define SM_REAL_BITS 32
#endif

#if SM_REAL_BITS == 32
typedef float real;
typedef int lane_int;
#define SM_NAME(name) name##_f32
#define SM_LANES      16
#define SM_EPSILON    1.1920929e-7f
#else
typedef double real;
typedef long long lane_int;
#define SM_NAME(name) name##_f64
#define SM_LANES      8
#define SM_EPSILON    2.220446049250313e-16
#endif

typedef real vec __attribute__((vector_size(SM_LANES * sizeof(real))));
typedef lane_int ivec __attribute__((vector_size(SM_LANES * sizeof(real))));
typedef real half_vec __attribute__((vector_size(SM_LANES / 2 * sizeof(real))));
typedef real vec4 __attribute__((vector_size(4 * sizeof(real))));
typedef real vec8 __attribute__((vector_size(8 * sizeof(real))));
typedef real vec16 __attribute__((vector_size(16 * sizeof(real))));

/* The same in memory at any place where a real may be. Accesses through these alias reals only, so
 * that a store does not make the compiler fetch every pointer again. */
typedef real vec_loose __attribute__((vector_size(SM_LANES * sizeof(real)), aligned(sizeof(real))));
typedef real vec4_loose __attribute__((vector_size(4 * sizeof(real)), aligned(sizeof(real))));
typedef real vec8_loose __attribute__((vector_size(8 * sizeof(real)), aligned(sizeof(real))));
typedef real vec16_loose __attribute__((vector_size(16 * sizeof(real)), aligned(sizeof(real))));

#endif
