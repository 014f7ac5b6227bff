#include "surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../../lib/vector.h"
#include "../region/lists.h"
#include "tie.h"

static void find_centre(const OctCarrier *c, int leaf, OctSurface *s)
{
    for (int d = 0; d < 3; d++)
        s->centre[leaf][d] =
            c->voxels->origin[d] + 0.5 * c->voxels->cell * c->tree->centre[c->tree->node[leaf]][d];
}

static void find_normals(const SmMesh *mesh, const OctCarrier *c, OctSurface *s)
{
    free(s->normal);
    s->normal = sm_mesh_normals(mesh, c->voxels->cell);
    for (long v = 0; v < mesh->vertex_count; v++) sm_normalize(s->normal[v]);
}

/* Room for the leaves of the tree and the vertices of the mesh, whose places are taken. */
static void make_room(OctSurface *s, long leaves, const SmMesh *mesh)
{
    long vertices = mesh->vertex_count, before = s->vertices;
    if (leaves > s->leaf_room) {
        s->leaf_room = s->leaf_room ? 2 * leaves : leaves;
        s->centre = sm_realloc(s->centre, (size_t)s->leaf_room, sizeof *s->centre);
        s->F = sm_realloc(s->F, (size_t)s->leaf_room, sizeof *s->F);
        s->edges = sm_realloc(s->edges, (size_t)s->leaf_room, sizeof *s->edges);
        s->users = sm_realloc(s->users, (size_t)s->leaf_room, sizeof *s->users);
    }
    for (; s->leaves < leaves; s->leaves++) s->users[s->leaves] = 0;
    if (vertices > s->vertex_room) {
        s->vertex_room = s->vertex_room ? 2 * vertices : vertices;
        s->rest = sm_realloc(s->rest, (size_t)s->vertex_room, sizeof *s->rest);
        s->reach = sm_realloc(s->reach, (size_t)s->vertex_room, sizeof *s->reach);
    }
    if (vertices > before)
        memcpy(s->rest[before], mesh->position[before],
               (size_t)(vertices - before) * sizeof *s->rest);
    s->vertices = vertices;
}

/* Which leaves move every vertex; the weights come when the lists lie still. */
static void tie_all(const OctCarrier *c, OctSurface *s)
{
    OctLists lists;
    long *first;
    int *leaf;
    oct_lists_init(&lists, s->vertices);
#pragma omp parallel num_threads(sm_team(0))
    {
        OctTie tie = {0};
#pragma omp for schedule(dynamic)
        for (long block = 0; block < lists.blocks; block++)
            for (long v = oct_lists_from(block); v < oct_lists_to(&lists, block); v++) {
                oct_tie_find(c, s->rest[v], &tie);
                oct_lists_add(&lists, v, tie.leaf, tie.count);
                s->reach[v] = tie.reach;
            }
        oct_tie_free(&tie);
    }
    oct_lists_pack(&lists, &first, &leaf);
    oct_rows_adopt(&s->rows, s->vertices, first, leaf, sizeof(float));
    float *weight = s->rows.value;
#pragma omp parallel num_threads(sm_team(0))
    {
        OctTie tie = {0};
#pragma omp for schedule(dynamic, OCT_BLOCK)
        for (long v = 0; v < s->vertices; v++) {
            oct_tie_find(c, s->rest[v], &tie);
            memcpy(weight + s->rows.first[v], tie.weight, (size_t)tie.count * sizeof *weight);
        }
        oct_tie_free(&tie);
    }
}

void oct_surface_build(const SmMesh *mesh, const OctCarrier *carrier, OctSurface *surface)
{
    OctSurface *s = surface;
    long leaves = carrier->tree->leaves;
    *s = (OctSurface){0};
    make_room(s, leaves, mesh);
    find_normals(mesh, carrier, s);
    for (int k = 0; k < leaves; k++)
        if (carrier->tree->node[k] >= 0) find_centre(carrier, k, s);
    tie_all(carrier, s);
    unsigned char *wanted = sm_alloc((size_t)leaves, 1);
    for (long v = 0; v < s->vertices; v++)
        for (long n = s->rows.first[v]; n < oct_rows_end(&s->rows, v); n++)
            s->users[s->rows.leaf[n]]++;
    for (int k = 0; k < leaves; k++) {
        wanted[k] = s->users[k] > 0;
        if (wanted[k]) s->edges[k] = oct_tie_edges(carrier->graph, k);
    }
    oct_gradients_build(carrier->tree, carrier->graph, wanted, carrier->voxels->cell,
                        &s->gradients);
    free(wanted);
}

void oct_surface_grow(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier,
                      long count, const int *node)
{
    long before = surface->vertices;
    make_room(surface, carrier->tree->leaves, mesh);
    oct_rows_grow(&surface->rows, surface->vertices);
    oct_gradients_grow(&surface->gradients, carrier->tree);
    if (surface->vertices > before) find_normals(mesh, carrier, surface);
    for (long n = 0; n < count; n++)
        if (carrier->tree->leaf[node[n]] >= 0)
            find_centre(carrier, carrier->tree->leaf[node[n]], surface);
}

void oct_surface_free(OctSurface *surface)
{
    oct_gradients_free(&surface->gradients);
    oct_rows_free(&surface->rows);
    free(surface->centre);
    free(surface->rest);
    free(surface->normal);
    free(surface->F);
    free(surface->reach);
    free(surface->users);
    free(surface->edges);
    *surface = (OctSurface){0};
}

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
    carry(s, x, s->rows.leaf[n], s->rest[v], first);
    while (++n < oct_rows_end(&s->rows, v)) {
        carry(s, x, s->rows.leaf[n], s->rest[v], other);
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
    const double *first = s->F[s->rows.leaf[s->rows.first[v]]];
    double G[9], largest = 0;
    memcpy(G, first, sizeof G);
    for (long n = s->rows.first[v] + 1; n < oct_rows_end(&s->rows, v); n++)
        for (int i = 0; i < 9; i++)
            G[i] += (double)weight[n] * (s->F[s->rows.leaf[n]][i] - first[i]);
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

void oct_surface_move(OctSurface *surface, const double (*x)[3], double (*position)[3],
                      double (*normal)[3])
{
    oct_gradients_find(&surface->gradients, x, surface->F);
#pragma omp parallel for schedule(static) num_threads(sm_team(0))
    for (long v = 0; v < surface->vertices; v++) {
        blend(surface, x, v, position[v]);
        if (normal) turn_normal(surface, v, normal[v]);
    }
}
