/* real.h - the precision of a kernel, and its vector of lanes.
 *
 * Every kernel file is compiled for both precisions, SM_REAL_BITS 32 and 64, of every instruction
 * set; SM_NAME gives these builds different names. A vector holds SM_LANES values (GCC and clang
 * vector extensions), as many as the processor works on at once. */
#ifndef SM_REAL_H
#define SM_REAL_H

#ifndef SM_REAL_BITS
#define SM_REAL_BITS 32
#endif

/* The instruction set that the file is compiled for (lib/isa.h), a suffix of names. */
#ifndef SM_ISA
#define SM_ISA native
#endif
#define SM_JOIN(name, precision, isa)  SM_JOIN_(name, precision, isa)
#define SM_JOIN_(name, precision, isa) name##precision##isa
#define SM_ISA_NAME(name)              SM_JOIN(name, _, SM_ISA) /* of kernels without reals */

/* The width of its vectors; with SM_SCALAR that of the narrowest, and what the compiler does not
 * know of them is done lane by lane. */
#ifdef SM_SCALAR
#define SM_VECTOR_BYTES 16
#elif defined(__AVX512F__) && defined(__AVX512VL__)
#define SM_VECTOR_BYTES 64
#elif defined(__AVX2__)
#define SM_VECTOR_BYTES 32
#else
#define SM_VECTOR_BYTES 16
#endif

#if SM_REAL_BITS == 32
typedef float real;
typedef int lane_int;
#define SM_NAME(name) SM_JOIN(name, _f32_, SM_ISA)
#define SM_LANES      (SM_VECTOR_BYTES / 4)
#define SM_EPSILON    1.1920929e-7f
#else
typedef double real;
typedef long long lane_int;
#define SM_NAME(name) SM_JOIN(name, _f64_, SM_ISA)
#define SM_LANES      (SM_VECTOR_BYTES < 32 ? 4 : SM_VECTOR_BYTES / 8) /* rows are in fours */
#define SM_EPSILON    2.220446049250313e-16
#endif

typedef real vec __attribute__((vector_size(SM_LANES * sizeof(real))));
typedef lane_int ivec __attribute__((vector_size(SM_LANES * sizeof(real))));

/* Part of a vector, 32 bytes or all of it. */
#define SM_PART (SM_LANES * SM_REAL_BITS > 256 ? 256 / SM_REAL_BITS : SM_LANES)
typedef real part_vec __attribute__((vector_size(SM_PART * sizeof(real))));

typedef real vec4 __attribute__((vector_size(4 * sizeof(real))));

/* The same in memory at any place where a real may be. Accesses through these alias reals only, so
 * that a store does not make the compiler fetch every pointer again. */
typedef real vec_loose __attribute__((vector_size(SM_LANES * sizeof(real)), aligned(sizeof(real))));
typedef real vec4_loose __attribute__((vector_size(4 * sizeof(real)), aligned(sizeof(real))));

#endif
