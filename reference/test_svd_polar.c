/* The rotation's defining properties on every class of 3x3 matrix. */
#include <float.h>

#include "../lib/test_frame.h"
#include "../lib/test_random.h"
#include "svd_polar.h"

static unsigned seed = 1;

static void multiply(const double A[9], const double B[9], double C[9])
{
    for (int n = 0; n < 9; n++) {
        const double *row = A + n / 3 * 3, *column = B + n % 3;
        C[n] = row[0] * column[0] + row[1] * column[3] + row[2] * column[6];
    }
}

static void transpose(const double A[9], double T[9])
{
    for (int n = 0; n < 9; n++) T[n] = A[n % 3 * 3 + n / 3];
}

static double trace_of_product(const double R[9], const double A[9]) /* tr(R^T A) */
{
    double sum = 0;
    for (int n = 0; n < 9; n++) sum += R[n] * A[n];
    return sum;
}

static double determinant(const double A[9])
{
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
           A[2] * (A[3] * A[7] - A[4] * A[6]);
}

/* Rodrigues; `axis` need not be a unit. */
static void turn(const double axis[3], double angle, double R[9])
{
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double n[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
    double c = cos(angle), s = sin(angle);
    const double skew[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
    for (int k = 0; k < 9; k++)
        R[k] = (1 - c) * n[k / 3] * n[k % 3] + s * skew[k] + (k % 4 == 0 ? c : 0);
}

static void random_rotation(double R[9])
{
    const double axis[3] = {random_between(&seed, -0.5, 0.5), random_between(&seed, -0.5, 0.5),
                            random_between(&seed, -0.5, 0.5)};
    turn(axis, 6.3 * random_between(&seed, -0.5, 0.5), R);
}

/* U diag(s) V^T with random rotations. */
static void random_matrix(double s0, double s1, double s2, double A[9])
{
    double U[9], V[9], T[9], US[9];
    const double s[3] = {s0, s1, s2};
    random_rotation(U);
    random_rotation(V);
    transpose(V, T);
    for (int n = 0; n < 9; n++) US[n] = U[n] * s[n % 3];
    multiply(US, T, A);
}

static void assert_rotation(const double R[9])
{
    double T[9], P[9];
    transpose(R, T);
    multiply(T, R, P);
    for (int n = 0; n < 9; n++) assert_true(fabs(P[n] - (n % 4 == 0)) < 1e-14);
    assert_true(fabs(determinant(R) - 1) < 1e-14);
}

/* R^T A is symmetric and no rotation, near or far, does better. */
static void assert_best(const double A[9], const double R[9])
{
    double scaled[9], largest = 0, T[9], S[9];
    for (int n = 0; n < 9; n++) largest = fmax(largest, fabs(A[n]));
    for (int n = 0; n < 9; n++) scaled[n] = largest > 0 ? ldexp(A[n], -ilogb(largest)) : 0;
    transpose(R, T);
    multiply(T, scaled, S);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < a; b++) assert_true(fabs(S[3 * a + b] - S[3 * b + a]) < 1e-13);
    double best = trace_of_product(R, scaled);
    for (int trial = 0; trial < 40; trial++) {
        const double axis[3] = {random_between(&seed, -0.5, 0.5), random_between(&seed, -0.5, 0.5),
                                random_between(&seed, -0.5, 0.5)};
        double Q[9], near[9];
        turn(axis,
             trial < 20 ? 6.3 * random_between(&seed, -0.5, 0.5)
                        : 0.01 * random_between(&seed, -0.5, 0.5),
             Q);
        multiply(Q, R, near);
        assert_true(trace_of_product(near, scaled) <= best + 1e-13);
    }
}

/* The leading minors of R^T A + 1e-12 are positive. */
static void assert_semidefinite(const double A[9], const double R[9])
{
    double T[9], S[9];
    transpose(R, T);
    multiply(T, A, S);
    for (int n = 0; n < 9; n += 4) S[n] += 1e-12;
    assert_true(S[0] > 0);
    assert_true(S[0] * S[4] - S[1] * S[3] > -1e-24);
    assert_true(determinant(S) > -1e-24);
}

static void check(const double A[9], const double last[9])
{
    double R[9], again[9];
    ref_polar(A, last, R);
    assert_rotation(R);
    assert_best(A, R);
    ref_polar(A, last, again);
    assert_memory_equal(R, again, sizeof R);
}

TEST(random_matrices_of_any_scale)
{
    static const double scale[] = {1, 1e-300, 1e-150, 1e-30, 1e-6, 1e6, 1e30, 1e150, 1e300};
    for (int trial = 0; trial < 9000; trial++) {
        double A[9];
        for (int n = 0; n < 9; n++) A[n] = scale[trial % 9] * random_between(&seed, -0.5, 0.5);
        check(A, NULL);
    }
    double A[9];
    for (int trial = 0; trial < 2000; trial++) { /* entries of very different size */
        for (int n = 0; n < 9; n++)
            A[n] = ldexp(random_between(&seed, -0.5, 0.5),
                         (int)(300 * random_between(&seed, -0.5, 0.5)));
        check(A, NULL);
    }
}

TEST(upright_and_reflected)
{
    for (int trial = 0; trial < 3000; trial++) {
        double A[9], R[9], small = 0.01 + fabs(random_between(&seed, -0.5, 0.5));
        random_matrix(2 + small, 1 + small, small, A);
        check(A, NULL);
        ref_polar(A, NULL, R);
        assert_semidefinite(A, R);
        random_matrix(2 + small, 1 + small, -small, A);
        check(A, NULL);
        random_matrix(2 + small, 2 + small, -small, A);
        check(A, NULL);
        ref_polar(A, NULL, R); /* semidefinite but for the reflected direction */
        assert_true(fabs(trace_of_product(R, A) - (4 + small)) < 1e-13);
    }
}

TEST(a_rotation_is_its_own)
{
    for (int trial = 0; trial < 500; trial++) {
        double Q[9], R[9];
        random_rotation(Q);
        ref_polar(Q, NULL, R);
        for (int n = 0; n < 9; n++) assert_true(fabs(Q[n] - R[n]) < 1e-14);
    }
}

/* The rotations that are as good as any for A = U diag(s) V^T: U P V^T with P a turn in the plane
 * of the last two columns, or, where all |s| are equal, any reflection times diag(1, 1, -1). */
static void another_best(const double s[3], const double U[9], const double V[9], double Q[9])
{
    double P[9], T[9], UP[9];
    const double x_axis[3] = {1, 0, 0};
    if (s[0] + s[2] > 0) {
        turn(x_axis, 6.3 * random_between(&seed, -0.5, 0.5), P);
    } else {
        double n[3] = {random_between(&seed, -0.5, 0.5), random_between(&seed, -0.5, 0.5),
                       random_between(&seed, -0.5, 0.5)};
        double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        for (int k = 0; k < 9; k++)
            P[k] = ((k % 4 == 0) - 2 * n[k / 3] * n[k % 3] / square) * (k % 3 == 2 ? -1 : 1);
    }
    multiply(U, P, UP);
    transpose(V, T);
    multiply(UP, T, Q);
}

TEST(ties_go_to_the_last_rotation)
{
    static const double tied[][3] = {{2, 0, 0}, {1, 0.5, -0.5}, {1, 1, -1}, {3, 1e-17, 1e-18}};
    for (int trial = 0; trial < 400; trial++) {
        const double *s = tied[trial % 4];
        double U[9], V[9], T[9], US[9], A[9], last[9], R[9], again[9];
        random_rotation(U);
        random_rotation(V);
        random_rotation(last);
        for (int n = 0; n < 9; n++) US[n] = U[n] * s[n % 3];
        transpose(V, T);
        multiply(US, T, A);
        check(A, last);
        ref_polar(A, last, R);
        for (int other = 0; other < 300; other++) {
            double Q[9];
            another_best(s, U, V, Q);
            assert_true(fabs(trace_of_product(Q, A) - trace_of_product(R, A)) < 1e-13);
            assert_true(trace_of_product(Q, last) <= trace_of_product(R, last) + 1e-13);
        }
        ref_polar(A, R, again); /* and stays there */
        for (int k = 0; k < 9; k++) assert_true(fabs(R[k] - again[k]) < 1e-14);
    }
}

TEST(rank_two_is_no_tie)
{
    for (int trial = 0; trial < 500; trial++) {
        double A[9], R[9], other[9], last[9];
        random_matrix(1, trial % 2 ? 1 : 0.3, 0, A);
        random_rotation(last);
        check(A, last);
        ref_polar(A, NULL, R);
        ref_polar(A, last, other);
        for (int n = 0; n < 9; n++) assert_true(fabs(R[n] - other[n]) < 1e-13);
    }
}

TEST(special_matrices)
{
    static const double cases[][9] = {
        {1, 0, 0, 0, 1, 0, 0, 0, 1},           {-1, 0, 0, 0, -1, 0, 0, 0, -1},
        {1, 1, 1, 1, 1, 1, 1, 1, 1},           {0, 1, 0, 0, 0, 0, 0, 0, 0},
        {0, 0, 0, 0, 0, 0, 0, 0, -1e-310},     {1e308, 0, 0, 0, 1e308, 0, 0, 0, 1e308},
        {5e-324, 0, 0, 0, 5e-324, 0, 0, 0, 0}, {1, 0, 0, 0, 1e-20, 0, 0, 0, 1e-40},
        {0, -1, 0, 1, 0, 0, 0, 0, 1},          {1, 2, 3, 2, 4, 6, 3, 6, 9},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) check(cases[n], NULL);
}

/* Small whole numbers, repeated rows: every rank and many equal singular values. */
TEST(whole_numbers)
{
    for (int trial = 0; trial < 20000; trial++) {
        double A[9], R[9];
        for (int n = 0; n < 9; n++) A[n] = (int)(5 * random_between(&seed, -0.5, 0.5));
        if (trial % 2) memcpy(A + 6, A + 3, 3 * sizeof *A);
        ref_polar(A, NULL, R);
        assert_rotation(R);
        if (trial % 10 < 2) assert_best(A, R);
    }
}

TEST(zero_and_non_finite_keep_the_last)
{
    double last[9], R[9];
    random_rotation(last);
    double A[9] = {0};
    ref_polar(A, last, R);
    assert_memory_equal(R, last, sizeof R);
    A[4] = NAN;
    ref_polar(A, last, R);
    assert_memory_equal(R, last, sizeof R);
    A[4] = -INFINITY;
    A[8] = 1;
    ref_polar(A, last, R);
    assert_memory_equal(R, last, sizeof R);
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    ref_polar(A, NULL, R);
    assert_memory_equal(R, identity, sizeof R);
}

/* `last` maps the only direction the wrong way: every choice is as far. Still a proper rotation. */
TEST(a_tie_of_ties)
{
    static const double A[9] = {1, 0, 0, 0, 0, 0, 0, 0, 0};
    static const double last[9] = {-1, 0, 0, 0, -1, 0, 0, 0, 1};
    check(A, last);
    static const double minus[9] = {-1, 0, 0, 0, -1, 0, 0, 0, -1};
    check(minus, last);
}
