#include "work.h"

#include <math.h>

/* The moment chain (summation.h), fields that a stage reads and writes:
 *     up    z 3 -> 6, y 6 -> 9, x 9 -> 12 (stays in registers)
 *     down  x 12 -> 9, y 9 -> 6, z 6 -> 3 (stays in registers)
 * so 3 + 6 + 9 sums and 3 moments at each of three stages up, the same down, where each moment is
 * also taken off a sum. */
enum { SUMS = 2 * (3 + 6 + 9), MOMENTS = 2 * 9, TAKEN_OFF = 9 };
enum { VALUES_READ = 3 + 6 + 9 + 12 + 9 + 6, VALUES_WRITTEN = 6 + 9 + 12 + 9 + 6 };

/* Mean places of a row's window -w..w that lie inside a row of `side`. */
static double mean_places(int w, int side)
{
    double sum = 0;
    for (int i = 0; i < side; i++) sum += 1 + fmin(i, w) + fmin(side - 1 - i, w);
    return sum / side;
}

BenchWork bench_work_sums(SmSummation summation, int w, int side)
{
    double places = mean_places(w, side), members = pow(places, 3);
    switch (summation) {
    case SM_SUM_NAIVE:
        /* Each member once up and once down: 3 values summed (3 flops), or q added (3), and 3 x 3
         * multiply-adds of moments (18). Reads 3 values up, 12 down. */
        return (BenchWork){.flops = members * 2 * (3 + 18), .near_values = members * (3 + 12)};
    case SM_SUM_BARS:
        /* Each stage adds `places` values of each field, and multiply-adds those with a moment,
         * and reads what it adds. */
        return (BenchWork){.flops = (places - 1) * (SUMS + 2 * MOMENTS) + TAKEN_OFF,
                           .near_values = places * VALUES_READ + VALUES_WRITTEN};
    case SM_SUM_FAST:
        break;
    }
    /* O(1): a running sum adds one value and takes one off; its moment takes 4 flops (add the two,
     * times w, add, take off the sum). At w = 1 directly: 2 additions, and one difference. */
    return (BenchWork){.flops = 2 * SUMS + (w == 1 ? 1 : 4) * MOMENTS + TAKEN_OFF,
                       .near_values = VALUES_READ + VALUES_WRITTEN};
}

BenchWork bench_work_match(void)
{
    /* c = S / M (3), A = S - C offset (9 multiply-adds), q = c - R offset (9 multiply-adds). */
    return (BenchWork){.flops = 3 + 18 + 18};
}

BenchWork bench_work_polar(void)
{
    /* polar_lanes.h: scale 8 maxima and 9 products; two cofactor matrices of 9 x 3; |A|^2, |cof|^2
     * 17 each, det 5; the start 8; Newton 14 a step, 3 steps; D 9 x 2; R 9 x 3; scalars 12. */
    return (BenchWork){.flops = 17 + 54 + 34 + 5 + 8 + 42 + 18 + 27 + 12, .near_values = 9 + 9};
}

BenchWork bench_work_jacobi(double sweeps)
{
    /* polar.c: scale 18; A V twice and its square, 15 flops a column entry of 9 each; a rotation
     * is 10 flops of angle and 3 x (3 + 3 + 3) x 2 of rows and columns; R another 45 + 12. */
    return (BenchWork){.flops = 18 + 3 * 45 + sweeps * 3 * (10 + 54) + 57, .near_bytes = 4 * 9 * 8};
}

BenchWork bench_work_robust(void)
{
    /* Horn's 4x4 matrix twice (the matrix and the last rotation), each diagonalised in no less than
     * two sweeps of 6 rotations: 10 flops of angle, 4 x 9 x 2 of rows and columns. */
    return (BenchWork){.flops = 2 * (12 + 2 * 6 * (10 + 72)) + 60, .near_bytes = 3 * 9 * 8};
}

BenchWork bench_work_damping(void)
{
    /* Products m~ v, m~ x X v, m~ x x^T: 18; 12 sums at three stages up and 6 at three down, 2
     * flops each; the spread and angular momentum 42, the adjugate of a symmetric 3x3 and omega 45,
     * v - omega x c 9; on the particle omega x x 12, v and x 12.
     * Values: z reads 6 (x, v) writes 12, y 12 12, x 12; down x writes 6, reads 6, writes 6, y 6 6,
     * z 6; x and v again 6 and 6. State: x and v read and written once more. */
    return (BenchWork){.flops = 18 + 2 * 3 * (12 + 6) + 42 + 45 + 9 + 24,
                       .near_values = 6 + 12 + 12 + 12 + 12 + 6 + 6 + 6 + 6 + 6 + 6 + 12,
                       .far_values = 12};
}

BenchWork bench_work_integrate(void)
{
    /* g = sum / |R| (3), v += g - x + gravity (9), x += v (3). The sum arrives in registers; reads
     * and writes x and v, of which the sums have brought x near. */
    return (BenchWork){.flops = 15, .near_values = 12, .far_values = 6};
}

BenchWork bench_work_together(BenchWork a, BenchWork b)
{
    return (BenchWork){a.flops + b.flops, a.near_values + b.near_values,
                       a.near_bytes + b.near_bytes, a.far_values + b.far_values,
                       a.far_bytes + b.far_bytes};
}

BenchWork bench_work_step(SmSummation summation, int w, int side, bool damping)
{
    BenchWork polar = bench_work_polar();
    polar.near_values = 0; /* matrices come and go in registers */
    polar.far_bytes = 24;  /* the last rotation, 12 bytes, read and written */
    polar.far_values = 6;  /* x, which the sums read and integration writes */
    BenchWork step = bench_work_together(bench_work_sums(summation, w, side), bench_work_match());
    step = bench_work_together(bench_work_together(step, polar), bench_work_integrate());
    return damping ? bench_work_together(step, bench_work_damping()) : step;
}

BenchWork bench_work_voxelise(double vertices_per_triangle)
{
    /* Each triangle's three numbers and each vertex's position must be read; finding the first cell
     * takes 9 multiply-adds, a plane's normal and offset 14. The lattice, a bit a cell, is small.
     */
    return (BenchWork){.flops = 18 + 14, .far_bytes = 12 + 24 * vertices_per_triangle};
}

BenchWork bench_work_embed(double particles_per_vertex)
{
    /* Eqs. 15 to 17: 7 differences of 3 values, three blends of 7 x 3 multiply-adds, a normal 24.
     * Reads 8 corners and 3 x 8 weights of 4 bytes and each particle once, writes position and
     * normal, in double precision. */
    return (BenchWork){.flops = 21 + 3 * 42 + 3 + 24,
                       .near_bytes = 32 + 96 + 8 * 24 + 48,
                       .far_bytes = 32 + 96 + 48 + 24 * particles_per_vertex};
}

BenchWork bench_work_carry(double blended, double nodes_per_vertex)
{
    /* Each node blended: 3 differences, 9 multiply-adds, and 3 and 9 values blended by difference;
     * a normal 9 cofactors of 3, 9 multiply-adds, a root. Reads 8 bytes and the node's F, x and
     * centre; rest position and normal, writes both; a node's gradient must be written at least. */
    return (BenchWork){.flops = (3 + 18 + 3 * 12) * blended + 27 + 18 + 10,
                       .near_bytes = (8 + 72 + 24 + 24) * blended + 96,
                       .far_bytes = 8 * blended + 8 + 96 + 120 * nodes_per_vertex};
}

double bench_state_bytes(BenchPrecision precision)
{
    return 6 * (precision == BENCH_F32 ? 4 : 8) + 12;
}

double bench_floor(const BenchCeilings *ceilings, const BenchWork *work, BenchPrecision precision,
                   int threads, double footprint, const char **bound)
{
    BenchRates rates = bench_rates(ceilings, threads);
    BenchLevel level = bench_level_of(ceilings, footprint, threads);
    double size = precision == BENCH_F32 ? 4 : 8;
    double flops = work->flops / rates.flops[precision];
    double near = (work->near_values * size + work->near_bytes) / rates.read[BENCH_L1];
    double rate = level == BENCH_DRAM ? rates.update : rates.read[level];
    double far = (work->far_values * size + work->far_bytes) / rate;
    *bound = flops >= near && flops >= far ? "flops" : near >= far ? "L1" : bench_level_name(level);
    return 1e9 * fmax(flops, fmax(near, far));
}
