#include "svd_polar.h"

#include <float.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "../lib/vector.h"

/* Below this share of the largest, a singular value or a sum of two is rounding. */
static const double noise = 32 * DBL_EPSILON;

static void normalise(double a[3])
{
    double length = sqrt(sm_dot(a, a));
    for (int k = 0; k < 3; k++) a[k] /= length;
}

/* Makes the first two rows orthonormal to the last bit and the third their cross product. */
static void complete_basis(double basis[3][3])
{
    double *a = basis[0], *b = basis[1], *c = basis[2];
    normalise(a);
    for (int pass = 0; pass < 2; pass++) {
        double along = sm_dot(a, b);
        for (int k = 0; k < 3; k++) b[k] -= along * a[k];
        normalise(b);
    }
    sm_cross(a, b, c);
}

/* A = U diag(s) V^T with proper rotations whose columns are the rows of u and v: the sign of
 * det A goes to s[2]. s falls in magnitude. */
static void proper_svd(const double A[9], double u[3][3], double v[3][3], double s[3])
{
    double U[9], V[9], work[3];
    memcpy(U, A, sizeof U);
    gsl_matrix_view left = gsl_matrix_view_array(U, 3, 3);
    gsl_matrix_view right = gsl_matrix_view_array(V, 3, 3);
    gsl_vector_view values = gsl_vector_view_array(s, 3);
    gsl_vector_view space = gsl_vector_view_array(work, 3);
    /* Not gsl_linalg_SV_decomp_jacobi(): it aborts, unconverged, on some matrices of low rank. */
    gsl_linalg_SV_decomp(&left.matrix, &right.matrix, &values.vector, &space.vector);
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) {
            u[column][row] = U[3 * row + column];
            v[column][row] = V[3 * row + column];
        }
    double last_u[3], last_v[3];
    memcpy(last_u, u[2], sizeof last_u);
    memcpy(last_v, v[2], sizeof last_v);
    complete_basis(u);
    complete_basis(v);
    if (sm_dot(u[2], last_u) * sm_dot(v[2], last_v) < 0) s[2] = -s[2];
}

/* N = U^T last V */
static void in_bases(double u[3][3], double v[3][3], const double last[9], double N[3][3])
{
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            N[a][b] = 0;
            for (int row = 0; row < 3; row++) N[a][b] += u[a][row] * sm_dot(last + 3 * row, v[b]);
        }
}

/* s = (s0, s1, -s1): every turn in the plane of the last two is as good. The one nearest N. */
static void solve_plane(double N[3][3], double P[3][3])
{
    double cosine = N[1][1] + N[2][2], sine = N[2][1] - N[1][2];
    double length = hypot(cosine, sine);
    if (!(length > 0)) return; /* `last` is as far from all of them: no turn */
    P[1][1] = P[2][2] = cosine / length;
    P[2][1] = sine / length;
    P[1][2] = -P[2][1];
}

void ref_eigen(double S[9], double value[3], double vector[9])
{
    gsl_matrix_view matrix = gsl_matrix_view_array(S, 3, 3);
    gsl_matrix_view vectors = gsl_matrix_view_array(vector, 3, 3);
    gsl_vector_view values = gsl_vector_view_array(value, 3);
    gsl_eigen_symmv_workspace *space = gsl_eigen_symmv_alloc(3);
    gsl_eigen_symmv(&matrix.matrix, &values.vector, &vectors.matrix, space);
    gsl_eigen_symmv_free(space);
}

/* s = (s0, s0, -s0): P = (1 - 2 n n^T) D, D = diag(1, 1, -1), is as good for every unit n. tr(P^T
 * N) is largest where n^T (N D) n is least. */
static void solve_sphere(double N[3][3], double P[3][3])
{
    static const double D[3] = {1, 1, -1};
    double symmetric[9], value[3], vector[9];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) symmetric[3 * a + b] = (N[a][b] * D[b] + N[b][a] * D[a]) / 2;
    ref_eigen(symmetric, value, vector);
    int least = 0;
    for (int e = 1; e < 3; e++)
        if (value[e] < value[least]) least = e;
    const double n[3] = {vector[least], vector[3 + least], vector[6 + least]};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) P[a][b] = ((a == b) - 2 * n[a] * n[b]) * D[b];
}

void ref_polar(const double A[9], const double last[9], double R[9])
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (!last) last = identity;
    double largest = 0, scaled[9];
    for (int k = 0; k < 9; k++) largest = fmax(largest, isfinite(A[k]) ? fabs(A[k]) : INFINITY);
    if (!(largest > 0 && isfinite(largest))) { /* every rotation is as good */
        memmove(R, last, 9 * sizeof *R);
        return;
    }
    for (int k = 0; k < 9; k++) scaled[k] = ldexp(A[k], -ilogb(largest)); /* in range, exact */

    double u[3][3], v[3][3], s[3], N[3][3];
    double P[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    proper_svd(scaled, u, v, s);
    in_bases(u, v, last, N);
    if (s[0] + s[2] <= noise * s[0]) {
        solve_sphere(N, P);
    } else if (s[1] + s[2] <= noise * s[0]) {
        solve_plane(N, P);
    }
    for (int row = 0; row < 3; row++) /* R = U P V^T; P = 1 where R is unique */
        for (int column = 0; column < 3; column++) {
            R[3 * row + column] = 0;
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    R[3 * row + column] += u[a][row] * P[a][b] * v[b][column];
        }
}
