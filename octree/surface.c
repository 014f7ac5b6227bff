#include "surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/nearest_cell.h"
#include "../lib/vector.h"
#include "lists.h"

/* What a surface is tied to. */
typedef struct {
    const SmVoxels *voxels;
    const OctTree *tree;
    const OctGraph *graph;
} Carrier;

/* The leaf that holds X, and X in half finest cells, moved into the nearest material cell. */
static int find_leaf(const Carrier *c, const double X[3], double q[3])
{
    int cell[3];
    for (int d = 0; d < 3; d++) q[d] = (X[d] - c->voxels->origin[d]) / c->voxels->cell;
    sm_nearest_cell(c->voxels, q, cell);
    for (int d = 0; d < 3; d++) q[d] = 2 * fmin(fmax(q[d], cell[d]), cell[d] + 1);
    return c->tree->leaf[oct_tree_find(c->tree, cell[0], cell[1], cell[2])];
}

/* w_k at place q, not yet made to add up to 1: along each axis 1 at the node, 1/2 at its cell's
 * side, 0 at a cell's width, with slope 0 at both ends. */
static double weigh(const OctTree *tree, int leaf, const double q[3])
{
    int node = tree->node[leaf];
    double size = tree->size[node], weight = 1 / size;
    for (int d = 0; d < 3; d++) {
        double t = fmin(fabs(q[d] - tree->centre[node][d]) / size, 1);
        weight *= (1 - t) * (1 - t) * (1 + 2 * t);
    }
    return weight;
}

/* The nodes that move a vertex, into its list; not those that nobody would see. */
static void choose(const Carrier *c, const double X[3], long vertex, OctLists *lists)
{
    double q[3];
    int own = find_leaf(c, X, q);
    double least = 1e-9 * weigh(c->tree, own, q);
    oct_lists_add(lists, vertex, &own, 1);
    for (long e = c->graph->first[own]; e < oct_graph_end(c->graph, own); e++)
        if (weigh(c->tree, c->graph->to[e], q) > least)
            oct_lists_add(lists, vertex, &c->graph->to[e], 1);
}

static void share_out(const Carrier *c, long vertex, OctSurface *s)
{
    double q[3], sum = 0;
    find_leaf(c, s->rest[vertex], q);
    for (long n = s->first[vertex]; n < s->first[vertex + 1]; n++)
        sum += weigh(c->tree, s->leaf[n], q);
    for (long n = s->first[vertex] + 1; n < s->first[vertex + 1]; n++)
        s->weight[n] = (float)(weigh(c->tree, s->leaf[n], q) / sum);
}

static void copy_rest(const SmMesh *mesh, const Carrier *c, OctSurface *s)
{
    s->normal = sm_mesh_normals(mesh, c->voxels->cell);
    s->rest = sm_alloc((size_t)s->vertices, sizeof *s->rest);
    s->centre = sm_alloc((size_t)c->tree->leaves, sizeof *s->centre);
    s->F = sm_alloc((size_t)c->tree->leaves, sizeof *s->F);
    for (long v = 0; v < s->vertices; v++) {
        memcpy(s->rest[v], mesh->position[v], sizeof s->rest[v]);
        sm_normalize(s->normal[v]);
    }
    for (long k = 0; k < c->tree->leaves; k++)
        if (c->tree->node[k] >= 0)
            oct_tree_centre(c->tree, c->voxels, c->tree->node[k], s->centre[k]);
}

void oct_surface_build(const SmMesh *mesh, const SmVoxels *voxels, const OctTree *tree,
                       const OctGraph *graph, OctSurface *surface)
{
    Carrier c = {voxels, tree, graph};
    *surface = (OctSurface){.vertices = mesh->vertex_count};
    copy_rest(mesh, &c, surface);
    OctLists lists;
    oct_lists_init(&lists, surface->vertices);
#pragma omp parallel for schedule(dynamic)
    for (long block = 0; block < lists.blocks; block++)
        for (long v = oct_lists_from(block); v < oct_lists_to(&lists, block); v++)
            choose(&c, surface->rest[v], v, &lists);
    oct_lists_pack(&lists, &surface->first, &surface->leaf);
    unsigned char *wanted = sm_alloc((size_t)tree->leaves, 1);
    for (long n = 0; n < surface->first[surface->vertices]; n++) wanted[surface->leaf[n]] = 1;
    oct_gradients_build(tree, graph, wanted, voxels->cell, &surface->gradients);
    free(wanted);
    surface->weight = sm_alloc((size_t)surface->first[surface->vertices], sizeof *surface->weight);
#pragma omp parallel for schedule(static)
    for (long v = 0; v < surface->vertices; v++) share_out(&c, v, surface);
}

void oct_surface_free(OctSurface *surface)
{
    oct_gradients_free(&surface->gradients);
    free(surface->centre);
    free(surface->rest);
    free(surface->normal);
    free(surface->first);
    free(surface->leaf);
    free(surface->weight);
    free(surface->F);
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
    carry(s, x, s->leaf[s->first[v]], s->rest[v], first);
    for (long n = s->first[v] + 1; n < s->first[v + 1]; n++) {
        carry(s, x, s->leaf[n], s->rest[v], other);
        for (int d = 0; d < 3; d++) sum[d] += (double)s->weight[n] * (other[d] - first[d]);
    }
    for (int d = 0; d < 3; d++) position[d] = first[d] + sum[d];
}

/* The rest normal by the cofactors of the blended gradient, which are its inverse transpose but for
 * a factor. */
static inline void turn_normal(const OctSurface *s, long v, double normal[3])
{
    static const double collapsed = 1e-12;
    const double *first = s->F[s->leaf[s->first[v]]];
    double G[9], largest = 0;
    memcpy(G, first, sizeof G);
    for (long n = s->first[v] + 1; n < s->first[v + 1]; n++)
        for (int i = 0; i < 9; i++) G[i] += (double)s->weight[n] * (s->F[s->leaf[n]][i] - first[i]);
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
#pragma omp parallel for schedule(static)
    for (long v = 0; v < surface->vertices; v++) {
        blend(surface, x, v, position[v]);
        if (normal) turn_normal(surface, v, normal[v]);
    }
}
