#include "polygonise.h"
#include "../system/team.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF = 2, AXES = 3, EDGES = AXES + 8 }; /* cells per leaf edge; edges a node may own */

/* A cube of cells whose nodes are sampled, and the primitives that matter in and around it. */
typedef struct {
    int at[3];
    int first, count; /* in Lattice.pool */
} Leaf;

/* Node ((k * n[1] + j) * n[0] + i) * 2 + s sits at low + cell * (i, j, k) + s cell / 2. A node owns
 * its edges towards +x, +y, +z of its own kind; one with s = 1 also the 8 to the corners around. */
typedef struct {
    const SmImplicit *implicit;
    double low[3], cell;
    int n[3];
    float *value;   /* [nodes], 0: not sampled, far from the surface */
    int *vertex;    /* [nodes] first vertex on the edges that the node owns */
    uint16_t *mask; /* [nodes] which of those cross the surface */
    Leaf *leaf;
    int leaf_count, leaf_room;
    int *pool, pool_count, pool_room;
    SmMesh *mesh;
} Lattice;

static long node_at(const Lattice *g, int i, int j, int k, int s)
{
    return (((long)k * g->n[1] + j) * g->n[0] + i) * 2 + s;
}

static void node_position(const Lattice *g, const int at[3], int s, double p[3])
{
    for (int i = 0; i < 3; i++) p[i] = g->low[i] + g->cell * (at[i] + 0.5 * s);
}

static void keep_leaf(Lattice *g, const int at[3], const int *active, int count)
{
    sm_make_room(g->leaf, g->leaf_room, g->leaf_count + 1);
    sm_make_room(g->pool, g->pool_room, g->pool_count + count);
    Leaf *leaf = &g->leaf[g->leaf_count++];
    *leaf = (Leaf){{at[0], at[1], at[2]}, g->pool_count, count};
    memcpy(g->pool + g->pool_count, active, (size_t)count * sizeof *active);
    g->pool_count += count;
}

/* Descends from a cube of `size` cells to the leaves that the surface may come near. */
static void descend(Lattice *g, const int at[3], int size, const int *active, int count)
{
    if (at[0] >= g->n[0] || at[1] >= g->n[1] || at[2] >= g->n[2]) return;
    /* A ball around the cube's nodes and the edges and tetrahedra that they have a share in. */
    double half = 0.5 * (size - 0.5), centre[3], radius = g->cell * (sqrt(3) * half + 1.02);
    for (int i = 0; i < 3; i++) centre[i] = g->low[i] + g->cell * (at[i] + half);
    int *kept = sm_alloc((size_t)count, sizeof *kept), kept_count;
    double d = sm_implicit_prune(g->implicit, active, count, centre, radius, kept, &kept_count);
    if (fabs(d) <= SM_IMPLICIT_SLOPE * radius) {
        if (size == LEAF) keep_leaf(g, at, kept, kept_count);
        for (int c = 0; c < 8 && size > LEAF; c++) {
            int step = size / 2;
            int child[3] = {at[0] + step * (c & 1), at[1] + step * (c >> 1 & 1),
                            at[2] + step * (c >> 2)};
            descend(g, child, step, kept, kept_count);
        }
    }
    free(kept);
}

static void find_leaves(Lattice *g)
{
    int longest = g->n[0], size = LEAF, count = g->implicit->count;
    for (int i = 1; i < 3; i++) longest = g->n[i] > longest ? g->n[i] : longest;
    while (size < longest) size *= 2;
    int *all = sm_alloc((size_t)count, sizeof *all), zero[3] = {0, 0, 0};
    for (int i = 0; i < count; i++) all[i] = i;
    descend(g, zero, size, all, count);
    free(all);
}

/* Place c among the nodes of a leaf; false where that is outside the lattice. */
static bool leaf_node(const Lattice *g, const Leaf *leaf, int c, int at[3])
{
    for (int i = 0; i < 3; i++, c /= LEAF) {
        at[i] = leaf->at[i] + c % LEAF;
        if (at[i] >= g->n[i]) return false;
    }
    return true;
}

typedef void (*NodeVisit)(Lattice *g, const Leaf *leaf, const int at[3], int s);

static void visit_nodes(Lattice *g, NodeVisit visit)
{
#pragma omp parallel for schedule(dynamic, 16) num_threads(sm_team(0))
    for (int l = 0; l < g->leaf_count; l++) {
        const Leaf *leaf = &g->leaf[l];
        for (int c = 0; c < LEAF * LEAF * LEAF; c++) {
            int at[3];
            if (!leaf_node(g, leaf, c, at)) continue;
            visit(g, leaf, at, 0);
            visit(g, leaf, at, 1);
        }
    }
}

static void sample(Lattice *g, const Leaf *leaf, const int at[3], int s)
{
    double p[3];
    node_position(g, at, s, p);
    float value = (float)sm_implicit_at(g->implicit, g->pool + leaf->first, leaf->count, p);
    g->value[node_at(g, at[0], at[1], at[2], s)] = value == 0 ? 1e-30f : value;
}

/* The far end of edge e of a node; false when it is outside the lattice. */
static int far_end(const Lattice *g, const int at[3], int s, int e, int to[3], int *to_s)
{
    int corner = e - AXES;
    for (int i = 0; i < 3; i++) {
        to[i] = at[i] + (e < AXES ? e == i : corner >> i & 1);
        if (to[i] >= g->n[i]) return 0;
    }
    *to_s = e < AXES ? s : 0;
    return 1;
}

static void mark_crossings(Lattice *g, const Leaf *leaf, const int at[3], int s)
{
    (void)leaf;
    long node = node_at(g, at[0], at[1], at[2], s);
    unsigned mask = 0;
    for (int e = 0; e < (s ? EDGES : AXES); e++) {
        int to[3], to_s;
        if (!far_end(g, at, s, e, to, &to_s)) continue;
        float other = g->value[node_at(g, to[0], to[1], to[2], to_s)];
        mask |= (unsigned)(other != 0 && (g->value[node] < 0) != (other < 0)) << e;
    }
    g->mask[node] = (uint16_t)mask;
}

/* Where the function vanishes between p (value a) and q (value b): false position, Illinois. */
static void find_root(const Lattice *g, const Leaf *leaf, double p[3], double a, double q[3],
                      double b, double root[3])
{
    const int *active = g->pool + leaf->first;
    double t0 = 0, t1 = 1, fa = a, fb = b, t = a / (a - b);
    for (int round = 0; round < 4; round++) {
        for (int i = 0; i < 3; i++) root[i] = p[i] + t * (q[i] - p[i]);
        double f = sm_implicit_at(g->implicit, active, leaf->count, root);
        if (fabs(f) < 1e-4 * g->cell) return;
        if ((f < 0) == (a < 0)) {
            t0 = t, fa = f, fb *= round ? 0.5 : 1;
        } else {
            t1 = t, fb = f, fa *= round ? 0.5 : 1;
        }
        t = t0 + (t1 - t0) * fa / (fa - fb);
    }
    for (int i = 0; i < 3; i++) root[i] = p[i] + t * (q[i] - p[i]);
}

static int count_vertices(Lattice *g)
{
    long nodes = 2L * g->n[0] * g->n[1] * g->n[2];
    int count = 0;
    for (long node = 0; node < nodes; node++) {
        g->vertex[node] = count;
        count += __builtin_popcount(g->mask[node]);
    }
    return count;
}

static void place_vertices(Lattice *g, const Leaf *leaf, const int at[3], int s)
{
    long node = node_at(g, at[0], at[1], at[2], s);
    int vertex = g->vertex[node];
    for (int e = 0; e < EDGES; e++) {
        if (!(g->mask[node] >> e & 1)) continue;
        int to[3] = {0}, to_s = 0;
        far_end(g, at, s, e, to, &to_s);
        double p[3], q[3], b = g->value[node_at(g, to[0], to[1], to[2], to_s)];
        node_position(g, at, s, p);
        node_position(g, to, to_s, q);
        find_root(g, leaf, p, g->value[node], q, b, g->mesh->position[vertex++]);
    }
}

static int edge_vertex(const Lattice *g, long node, int e)
{
    return g->vertex[node] + __builtin_popcount(g->mask[node] & ((1u << e) - 1));
}

/* A tetrahedron: nodes 0 and 1 are cube centres, 2 and 3 corners, right-handed. */
typedef struct {
    long node[4];
    int ring_axis; /* edge 2-3 is owned by node 2 or, if ring_back, by node 3 */
    int ring_back;
    int centre_axis;
    int diagonal[2][2]; /* number of the edge from centre 0, 1 to corner 2, 3 */
} Tetrahedron;

static int vertex_between(const Lattice *g, const Tetrahedron *t, int a, int b)
{
    if (a > b) return vertex_between(g, t, b, a);
    if (b == 1) return edge_vertex(g, t->node[0], t->centre_axis);
    if (a == 2) return edge_vertex(g, t->node[t->ring_back ? 3 : 2], t->ring_axis);
    return edge_vertex(g, t->node[a], AXES + t->diagonal[a][b - 2]);
}

static void emit(SmMesh *mesh, int a, int b, int c)
{
    int *triangle = mesh->triangle[mesh->triangle_count++];
    triangle[0] = a, triangle[1] = b, triangle[2] = c;
}

static double gap(const SmMesh *mesh, int a, int b)
{
    return sm_square_between(mesh->position[a], mesh->position[b]);
}

/* Even orders of a tetrahedron's nodes with the inside ones (bits of the index) first. */
static const int inside_first[16][4] = {{0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3},
                                        {2, 0, 1, 3}, {0, 2, 3, 1}, {1, 2, 0, 3}, {0, 1, 2, 3},
                                        {3, 0, 2, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}, {0, 3, 1, 2},
                                        {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 3, 2, 0}, {0, 1, 2, 3}};

static void march(const Lattice *g, const Tetrahedron *t, SmMesh *mesh)
{
    unsigned inside = 0;
    for (int i = 0; i < 4; i++) {
        if (g->value[t->node[i]] == 0) return;
        inside |= (unsigned)(g->value[t->node[i]] < 0) << i;
    }
    if (inside == 0 || inside == 15) return;
    const int *o = inside_first[inside];
    int count = __builtin_popcount(inside);
    if (count == 2) {
        int v[4] = {vertex_between(g, t, o[0], o[2]), vertex_between(g, t, o[0], o[3]),
                    vertex_between(g, t, o[1], o[3]), vertex_between(g, t, o[1], o[2])};
        int turn = gap(mesh, v[0], v[2]) > gap(mesh, v[1], v[3]); /* the shorter diagonal */
        emit(mesh, v[turn], v[turn + 1], v[(turn + 2) % 4]);
        emit(mesh, v[turn], v[(turn + 2) % 4], v[(turn + 3) % 4]);
    } else if (count == 1) {
        emit(mesh, vertex_between(g, t, o[0], o[1]), vertex_between(g, t, o[0], o[2]),
             vertex_between(g, t, o[0], o[3]));
    } else {
        emit(mesh, vertex_between(g, t, o[3], o[0]), vertex_between(g, t, o[3], o[1]),
             vertex_between(g, t, o[3], o[2]));
    }
}

/* The four tetrahedra around the edge from cube centre `at` to the next one along `axis`. */
static void march_around(const Lattice *g, const int at[3], int axis, SmMesh *mesh)
{
    static const int corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    int u = (axis + 1) % 3, w = (axis + 2) % 3, next[3] = {at[0], at[1], at[2]};
    next[axis]++;
    for (int i = 0; i < 3; i++)
        if (next[i] + 1 >= g->n[i]) return;
    Tetrahedron t = {.centre_axis = axis};
    t.node[0] = node_at(g, at[0], at[1], at[2], 1);
    t.node[1] = node_at(g, next[0], next[1], next[2], 1);
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 2; c++) {
            const int *side = corner[r + c];
            int to[3] = {next[0], next[1], next[2]};
            to[u] += side[0], to[w] += side[1];
            t.node[2 + c] = node_at(g, to[0], to[1], to[2], 0);
            int code = side[0] << u | side[1] << w;
            t.diagonal[0][c] = code | 1 << axis;
            t.diagonal[1][c] = code;
        }
        t.ring_axis = r % 2 ? w : u;
        t.ring_back = r >= 2;
        march(g, &t, mesh);
    }
}

void sm_polygonise(const SmImplicit *implicit, const SmBox *box, double cell, SmMesh *mesh)
{
    Lattice g = {.implicit = implicit, .cell = cell, .mesh = mesh};
    for (int i = 0; i < 3; i++) {
        g.low[i] = box->low[i];
        g.n[i] = (int)ceil((box->high[i] - box->low[i]) / cell) + 2;
    }
    size_t nodes = 2 * (size_t)g.n[0] * (size_t)g.n[1] * (size_t)g.n[2];
    g.value = sm_alloc(nodes, sizeof *g.value);
    g.vertex = sm_alloc(nodes, sizeof *g.vertex);
    g.mask = sm_alloc(nodes, sizeof *g.mask);
    find_leaves(&g);
    visit_nodes(&g, sample);
    visit_nodes(&g, mark_crossings);
    mesh->vertex_count = count_vertices(&g);
    mesh->position = sm_alloc((size_t)mesh->vertex_count, sizeof *mesh->position);
    visit_nodes(&g, place_vertices);
    mesh->triangle_count = 0; /* closed: triangles = 2 vertices - 4 + 4 genus; room for any genus */
    mesh->triangle = sm_alloc(6 * (size_t)mesh->vertex_count, sizeof *mesh->triangle);
    for (int l = 0; l < g.leaf_count; l++)
        for (int c = 0; c < LEAF * LEAF * LEAF; c++) {
            int at[3];
            if (!leaf_node(&g, &g.leaf[l], c, at)) continue;
            for (int axis = 0; axis < 3; axis++) march_around(&g, at, axis, mesh);
        }
    sm_free_all(g.value, g.vertex, g.mask, g.leaf, g.pool);
}
