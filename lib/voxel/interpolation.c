#include "interpolation.h"

#include <math.h>

#include "../simd/real.h"
#include "../system/team.h"
#include "../vector.h"

/* Sum of w_i (x_i - x_0). The fourth lane pads a position to a vector register. */
static inline void blend(const float weight[8], const double difference[8][4], double sum[4])
{
    for (int a = 0; a < 4; a++) sum[a] = 0;
    for (int i = 1; i < 8; i++)
        for (int a = 0; a < 4; a++) sum[a] += (double)weight[i] * difference[i][a];
}

static void deformed_normal(const double u[3], const double v[3], double normal[3])
{
    static const double parallel = 1e-12; /* sine of the angle between the tangents */
    double n[3];
    sm_cross(u, v, n);
    double squared = sm_dot(n, n), least = parallel * parallel * sm_dot(u, u) * sm_dot(v, v);
    double scale = squared > least && isfinite(squared) ? 1 / sqrt(squared) : 0;
    for (int a = 0; a < 3; a++) normal[a] = scale > 0 ? n[a] * scale : 0;
}

static void vertices(const SmEmbedding *embedding, const double (*x)[3], double (*position)[3],
                     double (*normal)[3])
{
#pragma omp parallel for schedule(static) num_threads(sm_team(0))
    for (long v = 0; v < embedding->vertex_count; v++) {
        const int *corner = embedding->corner[v];
        const double *first = x[corner[0]];
        double difference[8][4] = {{0}}, sum[4], u[4], w[4];
        for (int i = 1; i < 8; i++)
            for (int a = 0; a < 3; a++) difference[i][a] = x[corner[i]][a] - first[a];
        blend(embedding->weight[v], difference, sum);
        for (int a = 0; a < 3; a++) position[v][a] = first[a] + sum[a];
        if (!normal) continue;
        blend(embedding->tangent_u[v], difference, u);
        blend(embedding->tangent_v[v], difference, w);
        deformed_normal(u, w, normal[v]);
    }
}

const SmInterpolation SM_ISA_NAME(sm_interpolation) = {vertices};
