#include "embed.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nearest_cell.h"
#include "vector.h"

/* Particles by lattice row (y, z), in which they rise with x: numbers without a box-sized table. */
typedef struct {
    const SmVoxels *voxels;
    int (*coordinate)[3]; /* [particle_count] */
    int *row;             /* [(size[2] + 1) * (size[1] + 1) + 1], first particle of each row */
} Index;

static size_t row_of(const SmVoxels *voxels, int j, int k)
{
    return (size_t)k * ((size_t)voxels->size[1] + 1) + (size_t)j;
}

static Index make_index(const SmVoxels *voxels)
{
    Index index = {.voxels = voxels};
    size_t rows = row_of(voxels, 0, voxels->size[2] + 1);
    index.coordinate = sm_alloc((size_t)voxels->particle_count, sizeof *index.coordinate);
    index.row = sm_alloc(rows + 1, sizeof *index.row);
    sm_voxels_particles(voxels, index.coordinate);
    for (long p = 0; p < voxels->particle_count; p++)
        index.row[row_of(voxels, index.coordinate[p][1], index.coordinate[p][2]) + 1]++;
    for (size_t r = 0; r < rows; r++) index.row[r + 1] += index.row[r];
    return index;
}

/* The particle at lattice vertex (i, j, k), which exists. */
static int particle_at(const Index *index, int i, int j, int k)
{
    size_t row = row_of(index->voxels, j, k);
    int low = index->row[row], high = index->row[row + 1];
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (index->coordinate[middle][0] <= i)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* U and V with U x V = N, orthonormal; zero when N is. */
static void tangents(const double sum[3], double u[3], double v[3])
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

static void embed_vertex(const Index *index, const double position[3], const double normal[3],
                         SmEmbedding *embedding, long vertex)
{
    const SmVoxels *voxels = index->voxels;
    double q[3], s[3], u[3], v[3];
    int cell[3];
    for (int a = 0; a < 3; a++) q[a] = (position[a] - voxels->origin[a]) / voxels->cell;
    sm_nearest_cell(voxels, q, cell);
    for (int a = 0; a < 3; a++) s[a] = q[a] - cell[a];
    for (int i = 0; i < 8; i += 2) { /* neighbours along x have neighbouring numbers */
        int particle = particle_at(index, cell[0], cell[1] + (i >> 1 & 1), cell[2] + (i >> 2));
        embedding->corner[vertex][i] = particle;
        embedding->corner[vertex][i + 1] = particle + 1;
    }
    tangents(normal, u, v);
    weigh(s, u, v, embedding->weight[vertex], embedding->tangent_u[vertex],
          embedding->tangent_v[vertex]);
}

void sm_embed_create(const SmMesh *mesh, const SmVoxels *voxels, SmEmbedding *embedding)
{
    assert(voxels->cell_count > 0);
    size_t count = (size_t)mesh->vertex_count;
    *embedding = (SmEmbedding){.vertex_count = mesh->vertex_count};
    embedding->corner = sm_alloc(count, sizeof *embedding->corner);
    embedding->weight = sm_alloc(count, sizeof *embedding->weight);
    embedding->tangent_u = sm_alloc(count, sizeof *embedding->tangent_u);
    embedding->tangent_v = sm_alloc(count, sizeof *embedding->tangent_v);
    Index index = make_index(voxels);
    double(*normal)[3] = sm_mesh_normals(mesh, voxels->cell);
#pragma omp parallel for schedule(static)
    for (long v = 0; v < mesh->vertex_count; v++)
        embed_vertex(&index, mesh->position[v], normal[v], embedding, v);
    free(normal);
    free(index.coordinate);
    free(index.row);
}

void sm_embed_free(SmEmbedding *embedding)
{
    free(embedding->corner);
    free(embedding->weight);
    free(embedding->tangent_u);
    free(embedding->tangent_v);
    *embedding = (SmEmbedding){0};
}

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

void sm_embed_apply(const SmEmbedding *embedding, const double (*x)[3], double (*position)[3],
                    double (*normal)[3])
{
#pragma omp parallel for schedule(static)
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
