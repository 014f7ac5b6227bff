#include "matrices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../../lib/polar.h"
#include "../../lib/stage.h"
#include "../../reference/svd_polar.h"

/* Steps of the motion that a sample runs through. */
enum { FRAMES = 8, N = BENCH_MATRICES };

typedef struct {
    double (*A)[N][9];       /* [FRAMES] */
    float (*single)[N][9];   /* [FRAMES] */
    double (*R)[9], (*V)[9]; /* [N] */
    float (*single_R)[9];    /* [N] */
    BenchPrecision precision;
} Motion;

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static double unit(unsigned *seed)
{
    return rand_r(seed) / (double)RAND_MAX;
}

/* Turns columns p and q of M by an angle. */
static void turn(double M[9], int p, int q, double angle)
{
    for (int i = 0; i < 3; i++) {
        double a = M[i * 3 + p], b = M[i * 3 + q];
        M[i * 3 + p] = cos(angle) * a - sin(angle) * b;
        M[i * 3 + q] = sin(angle) * a + cos(angle) * b;
    }
}

/* A = R Q diag(s) Q^T at every frame: R turns by up to 0.05 and Q by up to 0.02 rad a step, the
 * stretches change by up to 1 percent. */
static void move_matrix(Motion *motion, int m, unsigned *seed)
{
    double rest[9], rate[9];
    for (int i = 0; i < 9; i++) {
        rest[i] = 6 * unit(seed);
        rate[i] = (i < 3 ? 0.05 : 0.02) * (2 * unit(seed) - 1);
    }
    for (int f = 0; f < FRAMES; f++) {
        double Q[9], R[9], s[3];
        memcpy(Q, identity, sizeof Q);
        memcpy(R, identity, sizeof R);
        for (int i = 0; i < 3; i++) {
            turn(R, i, (i + 1) % 3, rest[i] + f * rate[i]);
            turn(Q, i, (i + 1) % 3, rest[3 + i] + f * rate[3 + i]);
        }
        for (int i = 0; i < 3; i++) s[i] = 1 + 0.3 * sin(rest[6 + i] + f * rate[6 + i]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                double sum = 0;
                for (int k = 0; k < 3; k++)
                    for (int l = 0; l < 3; l++)
                        sum += R[i * 3 + k] * Q[k * 3 + l] * s[l] * Q[j * 3 + l];
                motion->A[f][m][i * 3 + j] = sum;
                motion->single[f][m][i * 3 + j] = (float)sum;
            }
    }
}

static void reset_eigenvectors(Motion *motion)
{
    for (int m = 0; m < N; m++) memcpy(motion->V[m], identity, sizeof identity);
}

/* One method on one frame's matrices; returns the Jacobi sweeps of all. */
static double decompose(Motion *motion, BenchPolar method, int frame)
{
    double sweeps = 0;
    if (method == BENCH_POLAR_BATCH && motion->precision == BENCH_F32)
        sm_polar_batch_f32(N, motion->single[frame][0], NULL, motion->single_R[0]);
    else if (method == BENCH_POLAR_BATCH)
        sm_polar_batch_f64(N, motion->A[frame][0], NULL, motion->R[0]);
    for (int m = 0; m < N && method != BENCH_POLAR_BATCH; m++) {
        const double *A = motion->A[frame][m];
        if (method == BENCH_POLAR_COLD) memcpy(motion->V[m], identity, sizeof identity);
        if (method == BENCH_POLAR_ROBUST)
            sm_polar_robust(A, identity, 1e-12, motion->R[m]);
        else
            sweeps += sm_polar_jacobi(A, motion->V[m], identity, 1e-6, motion->R[m]);
    }
    return sweeps;
}

static double deviation(const Motion *motion, BenchPolar method, int frame)
{
    double largest = 0, exact[9];
    bool single = method == BENCH_POLAR_BATCH && motion->precision == BENCH_F32;
    for (int m = 0; m < N; m++) {
        ref_polar(motion->A[frame][m], NULL, exact);
        for (int i = 0; i < 9; i++) {
            double found = single ? (double)motion->single_R[m][i] : motion->R[m][i];
            double off = fabs(found - exact[i]);
            if (!(off <= largest)) largest = isfinite(off) ? off : INFINITY;
        }
    }
    return largest;
}

/* Seconds of a sample: every frame once, or so often that the clock does not matter. */
static double try_sample(Motion *motion, BenchPolar method, BenchPolarResult *result)
{
    int rounds = method == BENCH_POLAR_BATCH ? 16 : 1;
    reset_eigenvectors(motion);
    if (method == BENCH_POLAR_WARM) decompose(motion, method, 0);
    double sweeps = 0;
    bench_watch_start(&result->watch);
    for (int r = 0; r < rounds; r++)
        for (int f = 1; f < FRAMES; f++) sweeps += decompose(motion, method, f);
    double done = (double)rounds * (FRAMES - 1) * N;
    result->sweeps = sweeps / done;
    return bench_watch_stop(&result->watch) / done;
}

static double sample(Motion *motion, BenchPolar method, BenchPolarResult *result)
{
    double seconds;
    do seconds = try_sample(motion, method, result);
    while (bench_watch_again(&result->watch));
    return seconds;
}

static void check_method(Motion *motion, BenchPolar method, int repeats, BenchPolarResult *result)
{
    /* Measured: 3e-7 and 1e-15 for the batch; Jacobi stops at off-diagonals of 1e-6. */
    const double limits[BENCH_POLARS] = {motion->precision == BENCH_F32 ? 1e-5 : 1e-9, 1e-5, 1e-5,
                                         1e-9};
    reset_eigenvectors(motion);
    result->limit = limits[method];
    for (int f = 0; f < 2; f++) decompose(motion, method, f);
    result->error = deviation(motion, method, 1);
    result->valid = result->error <= result->limit;
    if (result->valid) result->ns = sm_alloc((size_t)repeats, sizeof *result->ns);
}

void bench_matrices_time(BenchPrecision precision, int repeats, unsigned long seed,
                         BenchPolarResult result[BENCH_POLARS])
{
    Motion motion = {.precision = precision};
    motion.A = sm_alloc(FRAMES, sizeof *motion.A);
    motion.single = sm_alloc(FRAMES, sizeof *motion.single);
    motion.R = sm_alloc(N, sizeof *motion.R);
    motion.V = sm_alloc(N, sizeof *motion.V);
    motion.single_R = sm_alloc(N, sizeof *motion.single_R);
    unsigned state = (unsigned)seed;
    for (int m = 0; m < N; m++) move_matrix(&motion, m, &state);
    for (int p = 0; p < BENCH_POLARS; p++)
        if (result[p].wanted) check_method(&motion, (BenchPolar)p, repeats, &result[p]);
    for (int p = 0; p < BENCH_POLARS; p++) result[p].watch = bench_watch(1);
    for (int r = 0; r < repeats; r++)
        for (int p = 0; p < BENCH_POLARS; p++)
            if (result[p].ns) result[p].ns[r] = 1e9 * sample(&motion, (BenchPolar)p, &result[p]);
    free(motion.A);
    free(motion.single);
    free(motion.R);
    free(motion.V);
    free(motion.single_R);
}
