#include "interpolation.h"

#include <math.h>
#include <string.h>

#include "../../lib/simd/real.h"
#include "../../lib/system/team.h"
#include "../../lib/vector.h"

/* x_k + F_k (X - X_k) */
static inline void carry(const OctSurface *s, const double (*x)[3], int k, const double X[3],
                         double to[3])
{
    const double *F = s->F[k];
    double d[3] = {X[0] - s->centre[k][0], X[1] - s->centre[k][1], X[2] - s->centre[k][2]};
    for (int a = 0; a < 3; a++)
        to[a] = x[k][a] + F[3 * a] * d[0] + F[3 * a + 1] * d[1] + F[3 * a + 2] * d[2];
}

/* The weights count differences from the first node's, so that their rounding is relative to the
 * deformation and not to the distance from the origin. */
static inline void blend(const OctSurface *s, const double (*x)[3], long v, double position[3])
{
    double first[3], other[3], sum[3] = {0};
    const float *weight = s->rows.value;
    long n = s->rows.first[v];
    carry(s, x, s->rows.item[n], s->rest[v], first);
    while (++n < s->rows.end[v]) {
        carry(s, x, s->rows.item[n], s->rest[v], other);
        for (int d = 0; d < 3; d++) sum[d] += (double)weight[n] * (other[d] - first[d]);
    }
    for (int d = 0; d < 3; d++) position[d] = first[d] + sum[d];
}

/* The rest normal by the cofactors of the blended gradient, which are its inverse transpose but for
 * a factor. */
static inline void turn_normal(const OctSurface *s, long v, double normal[3])
{
    static const double collapsed = 1e-12;
    const float *weight = s->rows.value;
    const double *first = s->F[s->rows.item[s->rows.first[v]]];
    double G[9], largest = 0;
    memcpy(G, first, sizeof G);
    for (long n = s->rows.first[v] + 1; n < s->rows.end[v]; n++)
        for (int i = 0; i < 9; i++)
            G[i] += (double)weight[n] * (s->F[s->rows.item[n]][i] - first[i]);
    for (int i = 0; i < 9; i++) largest = fmax(largest, fabs(G[i]));
    for (int a = 0; a < 3; a++) {
        int p = (a + 1) % 3 * 3, q = (a + 2) % 3 * 3;
        normal[a] = 0;
        for (int b = 0; b < 3; b++) {
            int e = (b + 1) % 3, f = (b + 2) % 3;
            normal[a] += (G[p + e] * G[q + f] - G[p + f] * G[q + e]) * s->normal[v][b];
        }
    }
    if (!(sqrt(sm_dot(normal, normal)) > collapsed * largest * largest))
        memset(normal, 0, 3 * sizeof *normal);
    sm_normalize(normal);
}

static void vertices(const OctSurface *surface, const double (*x)[3], double (*position)[3],
                     double (*normal)[3])
{
#pragma omp parallel for schedule(static) num_threads(sm_team(0))
    for (long v = 0; v < surface->vertices; v++) {
        blend(surface, x, v, position[v]);
        if (normal) turn_normal(surface, v, normal[v]);
    }
}

const OctInterpolation SM_ISA_NAME(oct_interpolation) = {vertices};
