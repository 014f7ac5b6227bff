#include "polar.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rotates columns p and q of the eigenvectors V and of the symmetric n x n matrix S so that S[p][q]
 * vanishes (Golub and Van Loan, section 8.4). */
static void jacobi_rotate(int n, double *S, double *V, int p, int q)
{
    double off = S[p * n + q];
    if (off == 0) return;
    double theta = (S[q * n + q] - S[p * n + p]) / (2 * off);
    double t = fabs(theta) > 1e150 ? 0.5 / theta
                                   : (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < n; k++) {
        double kp = S[k * n + p], kq = S[k * n + q];
        S[k * n + p] = c * kp - s * kq;
        S[k * n + q] = s * kp + c * kq;
    }
    for (int k = 0; k < n; k++) {
        double pk = S[p * n + k], qk = S[q * n + k];
        S[p * n + k] = c * pk - s * qk;
        S[q * n + k] = s * pk + c * qk;
        double vp = V[k * n + p], vq = V[k * n + q];
        V[k * n + p] = c * vp - s * vq;
        V[k * n + q] = s * vp + c * vq;
    }
}

double sm_jacobi(int n, double *S, double *V, double tolerance)
{
    int pairs = n * (n - 1) / 2, done = 0;
    for (int sweep = 0; sweep < 30; sweep++) {
        int rotated = 0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                double limit = tolerance * sqrt(fabs(S[p * n + p] * S[q * n + q]));
                if (fabs(S[p * n + q]) <= limit + 1e-300) continue;
                jacobi_rotate(n, S, V, p, q);
                rotated++;
            }
        done += rotated;
        if (!rotated) break;
    }
    return (double)done / pairs;
}

static void from_quaternion(const double q[4], double R[9])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    R[0] = w * w + x * x - y * y - z * z;
    R[4] = w * w - x * x + y * y - z * z;
    R[8] = w * w - x * x - y * y + z * z;
    R[1] = 2 * (x * y - w * z);
    R[3] = 2 * (x * y + w * z);
    R[2] = 2 * (x * z + w * y);
    R[6] = 2 * (x * z - w * y);
    R[5] = 2 * (y * z - w * x);
    R[7] = 2 * (y * z + w * x);
}

/* Horn's symmetric matrix: q^T K q = tr(R(q)^T A). */
static void horn_matrix(const double A[9], double K[16])
{
    double xx = A[0], yy = A[4], zz = A[8];
    double k[16] = {xx + yy + zz, A[7] - A[5],  A[2] - A[6],   A[3] - A[1],
                    A[7] - A[5],  xx - yy - zz, A[1] + A[3],   A[2] + A[6],
                    A[2] - A[6],  A[1] + A[3],  -xx + yy - zz, A[5] + A[7],
                    A[3] - A[1],  A[2] + A[6],  A[5] + A[7],   -xx - yy + zz};
    memcpy(K, k, sizeof k);
}

static void to_quaternion(const double R[9], double q[4])
{
    double K[16], V[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    horn_matrix(R, K);
    for (int i = 0; i < 4; i++) K[5 * i] += 4; /* K + 4 is positive: relative tolerances hold */
    sm_jacobi(4, K, V, 1e-15);
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (K[5 * i] > K[5 * best]) best = i;
    for (int i = 0; i < 4; i++) q[i] = V[i * 4 + best];
}

/* The unit vector nearest to `last` in the span of the eigenvectors of near-largest eigenvalue. */
static void nearest_in_span(const double K[16], const double V[16], const double last[4],
                            double tie, double q[4])
{
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (K[5 * i] > K[5 * best]) best = i;
    double norm = 0;
    memset(q, 0, 4 * sizeof *q);
    for (int i = 0; i < 4; i++) {
        if (K[5 * best] - K[5 * i] > tie) continue;
        double share = 0;
        for (int k = 0; k < 4; k++) share += last[k] * V[k * 4 + i];
        for (int k = 0; k < 4; k++) q[k] += share * V[k * 4 + i];
        norm += share * share;
    }
    if (norm < 1e-20) { /* `last` is orthogonal to the span: any member is as near as another */
        for (int k = 0; k < 4; k++) q[k] = V[k * 4 + best];
        norm = 1;
    }
    for (int k = 0; k < 4; k++) q[k] /= sqrt(norm);
}

void sm_polar_robust(const double A[9], const double last[9], double tie, double R[9])
{
    double scale = 0, B[9], K[16], V[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    for (int i = 0; i < 9; i++) scale = fmax(scale, fabs(A[i]));
    if (!(scale > 0) || !isfinite(scale)) {
        memcpy(R, last, 9 * sizeof *R);
        return;
    }
    for (int i = 0; i < 9; i++) B[i] = A[i] / scale;
    horn_matrix(B, K);
    for (int i = 0; i < 4; i++) K[5 * i] += 8; /* |K| <= 3 sqrt(3): positive definite */
    sm_jacobi(4, K, V, 1e-16);
    double q[4], q_last[4];
    to_quaternion(last, q_last);
    nearest_in_span(K, V, q_last, tie, q);
    from_quaternion(q, R);
}

/* out = A B, or A^T B when `transposed`. */
static void multiply(const double A[9], const double B[9], int transposed, double out[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += (transposed ? A[k * 3 + i] : A[i * 3 + k]) * B[k * 3 + j];
            out[i * 3 + j] = sum;
        }
}

static double determinant(const double A[9])
{
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
           A[2] * (A[3] * A[7] - A[4] * A[6]);
}

/* Makes the columns of V, nearly a rotation, orthonormal again: what rounding took from it would
 * otherwise go into R, and grow from step to step. */
static void straighten(double V[9])
{
    for (int c = 0; c < 3; c++) {
        double norm = 0;
        for (int b = 0; b < c; b++) {
            double along = V[b] * V[c] + V[3 + b] * V[3 + c] + V[6 + b] * V[6 + c];
            for (int i = 0; i < 9; i += 3) V[i + c] -= along * V[i + b];
        }
        for (int i = 0; i < 9; i += 3) norm += V[i + c] * V[i + c];
        for (int i = 0; i < 9; i += 3) V[i + c] /= sqrt(norm);
    }
}

double sm_polar_jacobi(const double A[9], double V[9], const double last[9], double tolerance,
                       double R[9])
{
    double scale = 0, B[9], AV[9], S[9];
    for (int i = 0; i < 9; i++) scale = fmax(scale, fabs(A[i]));
    for (int i = 0; i < 9; i++) B[i] = scale > 0 ? A[i] / scale : 0;
    straighten(V);
    multiply(B, V, 0, AV);
    multiply(AV, AV, 1, S); /* V^T A^T A V */
    double sweeps = sm_jacobi(3, S, V, tolerance);
    double low = fmin(S[0], fmin(S[4], S[8])), high = fmax(S[0], fmax(S[4], S[8]));
    if (!(low > fmax(1e-8, DBL_EPSILON / tolerance) * high) || determinant(B) <= 0) {
        sm_polar_robust(A, last, 1e-12, R);
        return sweeps;
    }
    multiply(B, V, 0, AV); /* R = A V diag(1/sqrt(lambda)) V^T */
    for (int i = 0; i < 9; i++) AV[i] /= sqrt(S[4 * (i % 3)]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[i * 3 + j] =
                AV[i * 3] * V[j * 3] + AV[i * 3 + 1] * V[j * 3 + 1] + AV[i * 3 + 2] * V[j * 3 + 2];
    return sweeps;
}
