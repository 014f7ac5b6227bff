/* test_octree_body.h - a random body in one precision and its twin. */
#ifndef OCT_TEST_OCTREE_BODY_H
#define OCT_TEST_OCTREE_BODY_H

#include "../lib/engine/engine.h"
#include "../lib/test_fields.h"
#include "../lib/test_frame.h"
#include "../reference/octree_goals.h"
#include "ghosts.h"
#include "octree.h"
#include "region/frames.h"
#include "region/test_regions.h"
#include "tree/test_trees.h"

typedef struct {
    SmVoxels voxels;
    OctTree tree;
    OctRegions regions;
    long n;
    double (*x)[3], (*v)[3], (*a)[3], (*b)[3], *m;
} Body;

/* Explicit leaves: j in R_i where the max norm is at most the larger w, and everywhere else by
 * chance; with `asymmetric` not always i in R_j. */
static inline void explicit_regions(unsigned *seed, const OctTree *tree, bool asymmetric,
                                    OctRegions *regions)
{
    long n = tree->leaves;
    int *w = sm_alloc((size_t)n, sizeof(int)), base = 2 + random_int(seed, 12);
    char *in = sm_alloc((size_t)(n * n), 1);
    for (long i = 0; i < n; i++) w[i] = base + random_int(seed, 6);
    for (long i = 0; i < n; i++)
        for (long j = 0; j <= i; j++) {
            int d = 0;
            for (int a = 0; a < 3; a++) {
                int gap = abs(tree->centre[tree->node[i]][a] - tree->centre[tree->node[j]][a]);
                if (gap > d) d = gap;
            }
            bool near = d <= (w[i] > w[j] ? w[i] : w[j]);
            in[i * n + j] = in[j * n + i] = (char)near;
            if (asymmetric && i != j && random_int(seed, 20) == 0) in[i * n + j] = !near;
        }
    *regions = (OctRegions){0};
    long *first = sm_alloc((size_t)n + 1, sizeof *first), at = 0;
    int *member = sm_alloc((size_t)(n * n), sizeof *member);
    for (long i = 0; i < n; i++) {
        for (long j = 0; j < n; j++)
            if (in[i * n + j]) member[at++] = tree->node[j];
        first[i + 1] = at;
        if (at - first[i] > regions->most) regions->most = at - first[i];
    }
    sm_csr_adopt(&regions->members, n, first, member, NULL, 0);
    regions->mean = (double)at / (double)n;
    free(w);
    free(in);
}

static inline void body_arrays(unsigned *seed, Body *body)
{
    long n = body->n = body->tree.leaves;
    double(*x0)[3] = triples(n);
    body->x = triples(n);
    body->v = triples(n);
    body->a = triples(n);
    body->b = triples(n);
    body->m = sm_alloc((size_t)n, sizeof(double));
    bool painted = random_int(seed, 2);
    for (long i = 0; i < n; i++) {
        int node = body->tree.node[i];
        body->m[i] = painted ? 0.5 + random_unit(seed) : (double)body->tree.material[node];
        for (int d = 0; d < 3; d++) {
            x0[i][d] = 0.5 * body->tree.centre[node][d];
            body->v[i][d] = 0.1 * (random_unit(seed) - 0.5);
        }
    }
    random_deformation(seed, 1, 0.3, n, (const double(*)[3])x0, body->x);
    free(x0);
}

/* The engine's own regions: intervals of distances in the graph, a width for every node. */
static inline void interval_regions(unsigned *seed, const Body *body, OctRegions *regions)
{
    OctGraph graph;
    int *w = sm_alloc((size_t)body->tree.leaves, sizeof(int)), base = 1 + random_int(seed, 12);
    for (long i = 0; i < body->tree.leaves; i++) w[i] = base + random_int(seed, 6);
    oct_graph_build(&body->tree, &body->voxels, &graph);
    if (oct_regions_build(&body->tree, &graph, w, random_int(seed, 4) / 4.0, OCT_UNION, regions,
                          NULL))
        abort();
    oct_graph_free(&graph);
    free(w);
}

/* Regions by intervals of distances or of places or, with a chance, explicit. */
static inline void body_random(unsigned *seed, int kind, int most, bool asymmetric, Body *body)
{
    random_tree(seed, kind, most, &body->voxels, &body->tree);
    int form = asymmetric ? 0 : random_int(seed, 4);
    if (form == 0)
        explicit_regions(seed, &body->tree, asymmetric, &body->regions);
    else if (form > 1)
        interval_regions(seed, body, &body->regions);
    else
        max_norm_regions(&body->tree, 2 + random_int(seed, 16), random_int(seed, 4) / 4.0,
                         &body->regions);
    body_arrays(seed, body);
}

static inline void body_free(Body *body)
{
    free(body->x);
    free(body->v);
    free(body->a);
    free(body->b);
    free(body->m);
    oct_regions_free(&body->regions);
    oct_tree_free(&body->tree);
    sm_voxels_free(&body->voxels);
}

/* A block of cells in one precision's state, in finest cells. */
static inline void get(const Oct *oct, long instance, const real *field, bool place,
                       double (*values)[3])
{
    for (long i = 0; i < oct->leaves; i++)
        for (int d = 0; d < 3; d++)
            values[i][d] = (double)field[oct_index(i, d)] +
                           (place ? oct_origin(oct, &oct->body[instance], i)[d] : 0);
}

static inline void get_x(const Oct *oct, double (*values)[3])
{
    get(oct, 0, oct->body->x, true, values);
}

/* An engine with the body's positions and velocities. */
static inline Oct *create(const Body *body, OctParams params)
{
    Oct *oct = oct_build(&body->tree, &body->regions, body->m, &params);
    for (long k = 0; k < oct->instances; k++) {
        oct_set_positions(oct, k, (const double(*)[3])body->x);
        for (long i = 0; i < body->n; i++)
            for (int d = 0; d < 3; d++) oct->body[k].v[oct_index(i, d)] = (real)body->v[i][d];
    }
    return oct;
}

/* The body's positions and velocities as the engine's precision holds them. */
static inline void adopt(const Oct *oct, Body *body)
{
    get_x(oct, body->x);
    get(oct, 0, oct->body->v, false, body->v);
}

/* The visibility graph whose neighbours are a lattice's: of leaf i, `ring`, an engine of w = 1,
 * says which particles share a cell with particle[i], all within one cell, and leaf[] which leaves
 * they are. */
static inline void lattice_graph(const SmEngineType *type, SmEngine *ring, long n,
                                 const long *particle, const int *leaf, OctGraph *graph)
{
    long *member = sm_alloc((size_t)n, sizeof *member),
         *first = sm_alloc((size_t)n + 1, sizeof *first);
    int *to = sm_alloc(27 * (size_t)n, sizeof *to),
        *length = sm_alloc(27 * (size_t)n, sizeof *length);
    for (long i = 0; i < n; i++) {
        long count = type->region(ring, particle[i], member, n), at = first[i];
        for (long k = 0; k < count; k++)
            if (member[k] != particle[i]) to[at++] = leaf[member[k]];
        sm_sort_ints(to + first[i], count - 1);
        first[i + 1] = at;
    }
    for (long e = 0; e < first[n]; e++) length[e] = 2;
    *graph = (OctGraph){.longest = 2};
    sm_csr_adopt(&graph->edges, n, first, to, length, sizeof *length);
    free(member);
}

/* The octree over the particles of a FastLSM body of half-width w: a leaf where a particle is, the
 * same neighbours, the regions that the octree itself builds of them; positions and, in body->b,
 * goals are the lattice engine's, masses 1. */
static inline void lattice_body(unsigned *seed, const SmVoxels *cells, int w, SmEngine *engine,
                                const SmEngineType *type, Body *body)
{
    const int corner[3] = {random_int(seed, 9), random_int(seed, 9), random_int(seed, 9)};
    size_t n = (size_t)cells->particle_count;
    int(*coord)[3] = sm_alloc(n, sizeof *coord), *leaf = sm_alloc(n, sizeof *leaf);
    long *particle = sm_alloc(n, sizeof *particle);
    sm_voxels_particles(cells, coord);
    sm_voxels_init(&body->voxels, cells->size[0] + 1, cells->size[1] + 1, cells->size[2] + 1, 1);
    for (size_t p = 0; p < n; p++)
        sm_voxel_set(&body->voxels, coord[p][0], coord[p][1], coord[p][2]);
    sm_voxels_count(&body->voxels);
    assert_int_equal(oct_tree_build(&body->voxels, 3, corner, &body->tree, NULL), SM_OK);
    assert_int_equal(body->tree.leaves, n);
    int *width = sm_alloc(n, sizeof *width);
    for (size_t p = 0; p < n; p++) {
        int node = oct_tree_find(&body->tree, coord[p][0], coord[p][1], coord[p][2]);
        leaf[p] = body->tree.leaf[node];
        particle[leaf[p]] = (long)p;
        width[p] = 2 * w; /* half finest cells */
    }
    SmEngineParams nearest = {.w = 1, .h = 0.01, .threads = 1};
    SmEngine *ring;
    OctGraph graph;
    assert_int_equal(type->create(cells, &nearest, &ring, NULL), SM_OK);
    lattice_graph(type, ring, (long)n, particle, leaf, &graph);
    type->destroy(ring);
    assert_int_equal(
        oct_regions_build(&body->tree, &graph, width, 0, OCT_UNION, &body->regions, NULL), SM_OK);
    oct_graph_free(&graph);
    body_arrays(seed, body);
    double(*x)[3] = triples((long)n), (*g)[3] = triples((long)n);
    type->get(engine, SM_POSITION, x);
    type->goals(engine);
    type->get(engine, SM_GOAL, g);
    for (size_t p = 0; p < n; p++) {
        body->m[leaf[p]] = 1;
        memcpy(body->x[leaf[p]], x[p], sizeof *x);
        memcpy(body->b[leaf[p]], g[p], sizeof *g);
    }
    free(x);
    free(g);
    free(width);
    free(particle);
    free(leaf);
    free(coord);
}

#endif
