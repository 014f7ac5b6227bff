/* work.h - the least work of each kernel, and so its floor: the time below which this machine
 * cannot go, however the kernel is written.
 *
 * Counts are for one item (particle, matrix, triangle, vertex). Flops: an addition, multiplication,
 * division or root is one, a multiply-add two, and the ceiling is the multiply-add rate, which a
 * kernel of mere additions reaches half of. Near bytes: values that every stage has to read and
 * write once, at the L1 rate. Far bytes: what streams from where the whole state lies. The floor is
 * the largest of the three times: at best they overlap. */
#ifndef BENCH_WORK_H
#define BENCH_WORK_H

#include "../../lib/engine.h"
#include "ceilings.h"

typedef struct {
    double flops;
    double near_values; /* values of the kernel's precision */
    double near_bytes;  /* further bytes that are not values of the precision */
    double far_values;  /* values of the precision */
    double far_bytes;   /* further bytes */
} BenchWork;

/* Sums over regions, up and down, in a cube of `side` particles: moment chain (notes in work.c). */
BenchWork bench_work_sums(SmSummation summation, int w, int side);
BenchWork bench_work_match(void); /* moments about the centre, c_r, q_r */
BenchWork bench_work_polar(void); /* the quartic method of lib/simd/polar_lanes.h */
BenchWork bench_work_jacobi(double sweeps);
BenchWork bench_work_robust(void);
BenchWork bench_work_damping(void);
BenchWork bench_work_integrate(void);
BenchWork bench_work_step(SmSummation summation, int w, int side, bool damping); /* all of a step */
BenchWork bench_work_voxelise(double vertices_per_triangle);
BenchWork bench_work_embed(double particles_per_vertex);
/* A vertex by octree/surface/surface.h from so many nodes, and the gradients of `nodes_per_vertex`.
 */
BenchWork bench_work_carry(double blended, double nodes_per_vertex);

/* Both works. */
BenchWork bench_work_together(BenchWork a, BenchWork b);

/* Bytes of state a particle that a step streams: x, v, and the last rotation. */
double bench_state_bytes(BenchPrecision precision);

/* Nanoseconds an item; `footprint` is the bytes that all items' state takes. `bound` receives what
 * bounds it: "flops", "L1", "L2", "L3" or "DRAM". */
double bench_floor(const BenchCeilings *ceilings, const BenchWork *work, BenchPrecision precision,
                   int threads, double footprint, const char **bound);

#endif
