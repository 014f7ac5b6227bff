#include "fit.h"

#include <string.h>

#include "../../lib/polar.h"
#include "../../lib/vector.h"

void oct_fit_add(OctFit *fit, double mass, const double X[3], const double x[3], const double v[3])
{
    fit->mass += mass;
    for (int i = 0; i < 3; i++) {
        fit->X[i] += mass * X[i];
        fit->x[i] += mass * x[i];
        fit->v[i] += mass * v[i];
        for (int j = 0; j < 3; j++) {
            fit->XX[3 * i + j] += mass * X[i] * X[j];
            fit->xX[3 * i + j] += mass * x[i] * X[j];
            fit->vX[3 * i + j] += mass * v[i] * X[j];
        }
    }
}

static void apply(const double M[9], const double a[3], double b[3])
{
    for (int i = 0; i < 3; i++) b[i] = M[3 * i] * a[0] + M[3 * i + 1] * a[1] + M[3 * i + 2] * a[2];
}

/* M += a b^T */
static void add_outer(double M[9], const double a[3], const double b[3])
{
    for (int i = 0; i < 9; i++) M[i] += a[i / 3] * b[i % 3];
}

/* The angular velocity of nodes of moments C = V diag(value) V^T at rest that have turned by R,
 * from B = sum m v X^T: about every axis of inertia that has any. */
static void angular_velocity(const double value[3], const double V[9], const double R[9],
                             const double B[9], double none, double w[3])
{
    double D[9] = {0}; /* sum m v x^T */
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) D[i] += B[i / 3 * 3 + k] * R[i % 3 * 3 + k];
    memset(w, 0, 3 * sizeof *w);
    for (int a = 0; a < 3; a++) {
        double u[3] = {V[a], V[3 + a], V[6 + a]}, axis[3], turn = 0;
        double inertia = value[(a + 1) % 3] + value[(a + 2) % 3];
        if (!(inertia > none)) continue;
        apply(R, u, axis);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            turn += axis[i] * (D[3 * k + j] - D[3 * j + k]);
        }
        for (int i = 0; i < 3; i++) w[i] += turn / inertia * axis[i];
    }
}

int oct_fit_solve(const OctFit *fit, double least, const double last[9], double F[9], double L[9])
{
    double C[9], A[9], B[9], R[9], V[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, over = 1 / fit->mass;
    for (int i = 0; i < 9; i++) {
        C[i] = fit->XX[i] - fit->X[i / 3] * fit->X[i % 3] * over;
        A[i] = fit->xX[i] - fit->x[i / 3] * fit->X[i % 3] * over;
        B[i] = fit->vX[i] - fit->v[i / 3] * fit->X[i % 3] * over;
    }
    double f[3], l[3], w[3], beyond[3][3], value[3], most = least * least * fit->mass;
    int left = 0;
    memset(F, 0, sizeof C);
    memset(L, 0, sizeof C);
    sm_jacobi(3, C, V, 1e-14);
    for (int a = 0; a < 3; a++) {
        double u[3] = {V[a], V[3 + a], V[6 + a]};
        value[a] = C[4 * a];
        if (!(value[a] > most)) {
            memcpy(beyond[left++], u, sizeof u);
            continue;
        }
        apply(A, u, f);
        apply(B, u, l);
        for (int i = 0; i < 3; i++) {
            f[i] /= value[a];
            l[i] /= value[a];
        }
        add_outer(F, f, u);
        add_outer(L, l, u);
    }
    if (!left) return 3;
    sm_polar_robust(A, last, 1e-9, R);
    angular_velocity(value, V, R, B, most / 256, w);
    for (int a = 0; a < left; a++) {
        apply(R, beyond[a], f);
        sm_cross(w, f, l);
        add_outer(F, f, beyond[a]);
        add_outer(L, l, beyond[a]);
    }
    return 3 - left;
}
