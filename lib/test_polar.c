/* Holds every polar decomposition to GSL's on all classes of matrices. */
#include "../reference/svd_polar.h"
#include "polar.h"
#include "test_frame.h"
#include "test_random.h"

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void random_rotation(unsigned *seed, double R[9])
{
    double A[9];
    for (int i = 0; i < 9; i++) A[i] = random_between(seed, -1, 1);
    ref_polar(A, NULL, R);
}

/* A = scale P diag(stretch) Q. */
static void compose(unsigned *seed, const double stretch[3], double scale, double A[9])
{
    double P[9], Q[9];
    random_rotation(seed, P);
    random_rotation(seed, Q);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            A[i * 3 + j] = 0;
            for (int k = 0; k < 3; k++)
                A[i * 3 + j] += scale * P[i * 3 + k] * stretch[k] * Q[k * 3 + j];
        }
}

static double rotation_error(const double R[9])
{
    double worst = 0, det = R[0] * (R[4] * R[8] - R[5] * R[7]) -
                            R[1] * (R[3] * R[8] - R[5] * R[6]) + R[2] * (R[3] * R[7] - R[4] * R[6]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double dot = 0;
            for (int k = 0; k < 3; k++) dot += R[k * 3 + i] * R[k * 3 + j];
            worst = fmax(worst, fabs(dot - (i == j)));
        }
    return isnan(det) ? 1 : fmax(worst, fabs(det - 1));
}

static double distance(const double A[9], const double B[9])
{
    double worst = 0;
    for (int i = 0; i < 9; i++) worst = fmax(worst, fabs(A[i] - B[i]));
    return worst;
}

/* How far R is from maximising tr(R^T A), relative to the best. */
static double loss(const double A[9], const double R[9], const double best[9])
{
    double got = 0, most = 0;
    for (int i = 0; i < 9; i++) {
        got += R[i] * A[i];
        most += best[i] * A[i];
    }
    double size = 0;
    for (int i = 0; i < 9; i++) size = fmax(size, fabs(A[i]));
    return size > 0 ? (most - got) / size : 0;
}

static void batch32(const double A[9], const double last[9], double R[9])
{
    float a[9], l[9], r[9];
    for (int i = 0; i < 9; i++) {
        a[i] = (float)A[i];
        l[i] = (float)last[i];
    }
    sm_polar_batch_f32(1, a, l, r);
    for (int i = 0; i < 9; i++) R[i] = (double)r[i];
}

static void batch64(const double A[9], const double last[9], double R[9])
{
    sm_polar_batch_f64(1, A, last, R);
}

static void robust(const double A[9], const double last[9], double R[9])
{
    sm_polar_robust(A, last, 1e-12, R);
}

static void jacobi(const double A[9], const double last[9], double R[9])
{
    double V[9];
    memcpy(V, identity, sizeof V);
    assert_true(sm_polar_jacobi(A, V, last, 1e-6, R) >= 0);
}

static void jacobi64(const double A[9], const double last[9], double R[9])
{
    double V[9];
    memcpy(V, identity, sizeof V);
    assert_true(sm_polar_jacobi(A, V, last, 1e-13, R) >= 0);
}

typedef void Method(const double A[9], const double last[9], double R[9]);
enum { METHODS = 5 };
static Method *const methods[METHODS] = {batch32, batch64, robust, jacobi, jacobi64};
/* Of R where it is unique and well conditioned; and of R being a rotation at all, always. */
static const double accuracy[METHODS] = {3e-5, 1e-11, 1e-11, 1e-5, 1e-11},
                    proper[METHODS] = {3e-5, 1e-11, 1e-13, 1e-5, 1e-11};

/* Well-conditioned matrices, reflected and flat ones among them, at many scales. */
TEST(test_unique)
{
    const double stretch[6][3] = {{1, 1, 1},      {2, 1, 0.5}, {1, 0.9, 0},
                                  {1, 0.8, -0.3}, {5, 1, 0.2}, {1, 0.3, 0.3}};
    const double scale[5] = {1, 1e-6, 1e6, 1e-12, 1e12};
    unsigned seed = 1;
    for (int trial = 0; trial < 6000; trial++) {
        double A[9], R[9], best[9];
        compose(&seed, stretch[trial % 6], scale[trial / 6 % 5], A);
        ref_polar(A, identity, best);
        for (int m = 0; m < METHODS; m++) {
            methods[m](A, identity, R);
            if (!(distance(R, best) < accuracy[m]))
                fail_msg("method %d, class %d, scale %g: off by %g", m, trial % 6,
                         scale[trial / 6 % 5], distance(R, best));
        }
    }
}

/* Of what is flat and narrow, or folded, rounding may turn the thin directions, but no more than it
 * must, and not the long one. */
TEST(test_narrow)
{
    unsigned seed = 8;
    for (int trial = 0; trial < 6000; trial++) {
        double A[9], R[9], best[9], off[9], moved[9], long_way = 0;
        double width = exp(-4 * (trial % 100) / 100.0), thin = width * random_between(&seed, -1, 1);
        compose(&seed, (double[3]){1, width, thin > -0.7 * width ? thin : 0}, 1, A);
        for (int i = 0; i < 9; i++) A[i] = (double)(float)A[i];
        ref_polar(A, identity, best);
        batch32(A, identity, R);
        for (int i = 0; i < 9; i++) off[i] = R[i] - best[i];
        for (int i = 0; i < 9; i++) { /* (R - best) A^T: what the error moves of A's spread */
            moved[i] = 0;
            for (int k = 0; k < 3; k++) moved[i] += off[i / 3 * 3 + k] * A[i % 3 * 3 + k];
            long_way = fmax(long_way, fabs(moved[i]));
        }
        if (!(long_way < 2e-6)) fail_msg("width %g, thin %g: off by %g", width, thin, long_way);
    }
}

/* No class of matrix gives anything but a proper rotation, and none a worse one than it must. */
TEST(test_degenerate)
{
    const double stretch[7][3] = {{0, 0, 0},  {1, 0, 0},    {1, 1e-4, 0},    {1, 0.5, -0.5},
                                  {1, 1, -1}, {1, 1, 1e-9}, {1, 1e-3, -1e-3}};
    const double scale[6] = {1, 1e-12, 1e12, 1e-30, 1e30, 1e-38};
    unsigned seed = 2;
    for (int trial = 0; trial < 4200; trial++) {
        double A[9], R[9], best[9], last[9];
        compose(&seed, stretch[trial % 7], scale[trial / 7 % 6], A);
        random_rotation(&seed, last);
        ref_polar(A, last, best);
        for (int m = 0; m < METHODS; m++) {
            methods[m](A, last, R);
            if (!(rotation_error(R) < proper[m] && loss(A, R, best) < 1e-4))
                fail_msg("method %d, class %d, scale %g: rotation to %g, loss %g", m, trial % 7,
                         scale[trial / 7 % 6], rotation_error(R), loss(A, R, best));
        }
    }
}

/* Where nothing is known the last rotation stays; where one axis is, the nearest turn to it. */
/* What has no rotation of its own, or one as far from the last as can be. */
TEST(test_robust)
{
    const double turned[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1}, one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double A[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, R[9];
    sm_polar_robust(A, turned, 1e-12, R);
    for (int i = 0; i < 9; i++) assert_true(fabs(R[i] - one[i]) < 1e-12);
    A[4] = INFINITY;
    sm_polar_robust(A, turned, 1e-12, R);
    assert_memory_equal(R, turned, sizeof R);
}

TEST(test_last)
{
    unsigned seed = 3;
    for (int trial = 0; trial < 300; trial++) {
        double zero[9] = {0}, A[9], R[9], best[9], last[9], one[3] = {1, 0, 0};
        random_rotation(&seed, last);
        compose(&seed, one, 1, A);
        ref_polar(A, last, best);
        for (int m = 0; m < METHODS; m++) {
            methods[m](zero, last, R);
            assert_true(distance(R, last) < 1e-6);
            methods[m](A, last, R);
            if (!(distance(R, best) < (m == 0 ? 2e-3 : 1e-6)))
                fail_msg("method %d: %g", m, distance(R, best));
        }
    }
}

/* A batch gives each matrix what it gets alone, whatever its length. */
TEST(test_batches)
{
    unsigned seed = 4;
    float A[37 * 9], R[37 * 9], alone[9];
    for (int i = 0; i < 37 * 9; i++)
        A[i] = (float)((i % 9 % 4 == 0) + 0.3 * random_between(&seed, -1, 1));
    for (long count = 0; count <= 37; count += 12) {
        memset(R, 0, sizeof R);
        sm_polar_batch_f32(count, A, NULL, R);
        for (long n = 0; n < count; n++) {
            sm_polar_batch_f32(1, A + 9 * n, NULL, alone);
            for (int i = 0; i < 9; i++) assert_true(fabsf(alone[i] - R[9 * n + i]) < 2e-6f);
        }
        for (long i = count * 9; i < 37 * 9; i++) assert_true(R[i] == 0);
    }
}

/* A warm start needs fewer sweeps than a cold one when a matrix changes slowly, and is as exact
 * after many steps, whose eigenvectors are kept in single precision. */
TEST(test_warm_start)
{
    unsigned seed = 5;
    double stretch[3] = {1.3, 1, 0.8}, A[9], V[9], R[9], best[9], cold = 0, warm = 0;
    compose(&seed, stretch, 1, A);
    memcpy(V, identity, sizeof V);
    for (int step = 0; step < 2000; step++) {
        double fresh[9];
        memcpy(fresh, identity, sizeof fresh);
        for (int i = 0; i < 9; i++) A[i] += 1e-4 * random_between(&seed, -1, 1);
        cold += sm_polar_jacobi(A, fresh, identity, 1e-6, R);
        warm += sm_polar_jacobi(A, V, identity, 1e-6, R);
        sm_polar_jacobi(A, V, identity, 1e-13, R);
        for (int i = 0; i < 9; i++) V[i] = (double)(float)V[i];
    }
    ref_polar(A, identity, best);
    assert_true(warm < cold);
    assert_true(distance(R, best) < 1e-11);
}
