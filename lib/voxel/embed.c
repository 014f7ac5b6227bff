#include "embed.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../isa.h"
#include "../polar.h"
#include "../system/team.h"
#include "../vector.h"
#include "interpolation.h"
#include "voxel.h"

/* U and V with U x V = N, orthonormal; zero when N is. */
void sm_embed_tangents(const double sum[3], double u[3], double v[3])
{
    double n[3] = {sum[0], sum[1], sum[2]}, axis[3] = {0};
    bool usable = sm_normalize(n);
    int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) < fabs(n[least])) least = 2;
    axis[least] = usable;
    sm_cross(axis, n, u);
    sm_normalize(u);
    sm_cross(n, u, v);
}

/* Eqs. 15 and 17 at local coordinates s of the cell. */
static void weigh(const double s[3], const double u[3], const double v[3], float weight[8],
                  float tangent_u[8], float tangent_v[8])
{
    for (int i = 0; i < 8; i++) {
        double factor[3], slope[3], gradient[3];
        for (int a = 0; a < 3; a++) {
            bool high = i >> a & 1;
            factor[a] = high ? s[a] : 1 - s[a];
            slope[a] = high ? 1 : -1;
        }
        for (int a = 0; a < 3; a++)
            gradient[a] = slope[a] * factor[(a + 1) % 3] * factor[(a + 2) % 3];
        weight[i] = (float)(factor[0] * factor[1] * factor[2]);
        tangent_u[i] = (float)(u[0] * gradient[0] + u[1] * gradient[1] + u[2] * gradient[2]);
        tangent_v[i] = (float)(v[0] * gradient[0] + v[1] * gradient[1] + v[2] * gradient[2]);
    }
}

static void embed_vertex(const SmSites *sites, const double position[3], const double normal[3],
                         SmEmbedding *embedding, long vertex)
{
    const SmVoxels *voxels = sites->voxels;
    double q[3], s[3], u[3], v[3];
    int cell[3];
    for (int a = 0; a < 3; a++) q[a] = (position[a] - voxels->origin[a]) / voxels->cell;
    sm_nearest_cell(voxels, q, cell);
    for (int a = 0; a < 3; a++) s[a] = q[a] - cell[a];
    for (int i = 0; i < 8; i += 2) { /* neighbours along x have neighbouring numbers */
        int particle = sm_sites_find(sites, cell[0], cell[1] + (i >> 1 & 1), cell[2] + (i >> 2));
        embedding->corner[vertex][i] = particle;
        embedding->corner[vertex][i + 1] = particle + 1;
    }
    sm_embed_tangents(normal, u, v);
    weigh(s, u, v, embedding->weight[vertex], embedding->tangent_u[vertex],
          embedding->tangent_v[vertex]);
}

void sm_embed_grow(SmEmbedding *e, const SmMesh *mesh, const SmSites *sites,
                   const double (*normal)[3])
{
    size_t count = (size_t)mesh->vertex_count;
    e->corner = sm_realloc(e->corner, count, sizeof *e->corner);
    e->weight = sm_realloc(e->weight, count, sizeof *e->weight);
    e->tangent_u = sm_realloc(e->tangent_u, count, sizeof *e->tangent_u);
    e->tangent_v = sm_realloc(e->tangent_v, count, sizeof *e->tangent_v);
#pragma omp parallel for schedule(static) num_threads(sm_team(0))
    for (long v = e->vertex_count; v < mesh->vertex_count; v++)
        embed_vertex(sites, mesh->position[v], normal[v], e, v);
    e->vertex_count = mesh->vertex_count;
}

void sm_embed_create(const SmMesh *mesh, const SmVoxels *voxels, SmEmbedding *embedding)
{
    assert(voxels->cell_count > 0);
    *embedding = (SmEmbedding){0};
    SmSites sites;
    sm_sites_init(voxels, &sites);
    double(*normal)[3] = sm_mesh_normals(mesh, voxels->cell);
    sm_embed_grow(embedding, mesh, &sites, (const double(*)[3])normal);
    free(normal);
    sm_sites_free(&sites);
}

void sm_embed_free(SmEmbedding *embedding)
{
    sm_free_all(embedding->corner, embedding->weight, embedding->tangent_u, embedding->tangent_v,
                embedding->flat);
    *embedding = (SmEmbedding){0};
}

SM_ISA_TABLE(SmInterpolation, sm_interpolation)

/* The vertex stands off what carries it, and turns with it as a rigid body. */
static void stand_off(const SmFlat *flat, const int corner[8], const double (*x)[3],
                      double position[3], double *normal)
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double A[9] = {0}, R[9];
    for (int i = 1; i < 8; i++)
        for (int n = 0; n < 9; n++)
            A[n] += (x[corner[i]][n / 3] - x[corner[0]][n / 3]) * flat->share[i][n % 3];
    sm_polar_robust(A, identity, 1e-9, R);
    for (int a = 0; a < 3; a++) {
        const double *row = R + 3 * a;
        position[a] += sm_dot(row, flat->offset);
        if (normal) normal[a] = sm_dot(row, flat->normal);
    }
}

void sm_embed_apply(const SmEmbedding *embedding, const double (*x)[3], double (*position)[3],
                    double (*normal)[3])
{
    sm_interpolation.vertices(embedding, x, position, normal);
    for (long n = 0; n < embedding->flat_count; n++) {
        long v = embedding->flat[n].vertex;
        stand_off(&embedding->flat[n], embedding->corner[v], x, position[v],
                  normal ? normal[v] : NULL);
    }
}
