#include "matrices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../../lib/polar.h"
#include "../../reference/svd_polar.h"
#include "kernel.h"

enum { FRAMES = BENCH_FRAMES, N = BENCH_MATRICES };

struct BenchMotion {
    double A[FRAMES][N][9];
    float single[FRAMES][N][9];
    double R[N][9], V[N][9];
    float single_R[N][9];
    BenchPrecision precision;
};

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
static void move_matrix(BenchMotion *motion, int m, unsigned *seed)
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

static void reset_eigenvectors(BenchMotion *motion)
{
    for (int m = 0; m < N; m++) memcpy(motion->V[m], identity, sizeof identity);
}

/* One method on one frame's matrices; returns the Jacobi sweeps of all. */
static double decompose(BenchMotion *motion, BenchPolar method, int frame)
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

static double deviation(const BenchMotion *motion, BenchPolar method, int frame)
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

static void restore(void *subject)
{
    BenchPolarTrial *polar = subject;
    reset_eigenvectors(polar->motion);
    if (polar->method == BENCH_POLAR_WARM) decompose(polar->motion, polar->method, 0);
    polar->sweeps = 0;
    polar->decomposed = 0;
}

static void step(void *subject, SmLaps *laps)
{
    BenchPolarTrial *polar = subject;
    (void)laps;
    for (int f = 1; f < FRAMES; f++) polar->sweeps += decompose(polar->motion, polar->method, f);
    polar->decomposed += BENCH_POLAR_RUN;
}

void bench_polar_prepare(BenchMotion *motion, BenchPolar method, BenchPolarTrial *polar)
{
    /* Measured: 3e-7 and 1e-15 for the batch; Jacobi stops at off-diagonals of 1e-6. */
    const double limits[BENCH_POLARS] = {motion->precision == BENCH_F32 ? 1e-5 : 1e-9, 1e-5, 1e-5,
                                         1e-9};
    *polar = (BenchPolarTrial){.motion = motion, .method = method};
    polar->trial = (BenchTrial){.timed = {polar, restore, step},
                                .threads = 1,
                                /* so often that the clock does not matter */
                                .runs = method == BENCH_POLAR_BATCH ? 16 : 1,
                                .valid = true};
    reset_eigenvectors(motion);
    for (int f = 0; f < 2; f++) decompose(motion, method, f);
    polar->error = deviation(motion, method, 1);
    if (!(polar->error <= limits[method]))
        bench_trial_fail(&polar->trial,
                         "rotations differ from the SVD's by %.3g; at most %g allowed",
                         polar->error, limits[method]);
}

BenchMotion *bench_motion_create(BenchPrecision precision, unsigned long seed)
{
    BenchMotion *motion = sm_alloc(1, sizeof *motion);
    unsigned state = (unsigned)seed;
    motion->precision = precision;
    for (int m = 0; m < N; m++) move_matrix(motion, m, &state);
    return motion;
}

/* ---- among the kernels */

static SmCode make_body(const BenchKernel *kernel, const BenchKernelParams *params, void **body,
                        SmError *error)
{
    (void)kernel, (void)error;
    *body = bench_motion_create(params->precision, params->seed);
    return SM_OK;
}

static SmCode prepare(BenchJob *job, SmError *error)
{
    BenchPolarTrial *polar = job->subject = sm_alloc(1, sizeof *polar);
    (void)error;
    bench_polar_prepare(job->body, (BenchPolar)job->kernel->part, polar);
    if (polar->method != BENCH_POLAR_BATCH) job->arithmetic = "double";
    job->threads = 1;
    job->trial = &polar->trial;
    job->item = "matrix";
    job->items = N;
    job->per_run = BENCH_POLAR_RUN;
    return SM_OK;
}

static void report(BenchJob *job, BenchKernelRow *row)
{
    const BenchPolarTrial *polar = job->subject;
    double sweeps = polar->sweeps / (double)polar->decomposed;
    bool batch = polar->method == BENCH_POLAR_BATCH, robust = polar->method == BENCH_POLAR_ROBUST;
    job->footprint = 1e5;
    job->least = batch    ? sm_polar_batch_operations()
                 : robust ? sm_polar_robust_operations()
                          : sm_polar_jacobi_operations(sweeps);
    if (batch)
        strcpy(row->note, "packing into lanes included");
    else if (!robust)
        snprintf(row->note, sizeof row->note, "%.2f sweeps a matrix; paper: %s", sweeps,
                 polar->method == BENCH_POLAR_COLD ? "1.9" : "0.4");
}

const BenchKernelKind bench_polar_kernels = {
    .open = make_body, .close = free, .prepare = prepare, .report = report};
