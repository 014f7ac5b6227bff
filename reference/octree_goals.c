#include "octree_goals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "svd_polar.h"

/* Appends the leaves below a tree node to a region, numbered among those that live. */
static void append_leaves(const OctTree *tree, const int *number, long node, long region,
                          SmCsrParts *members)
{
    if (tree->child[node] < 0) sm_csr_parts_add(members, region, &number[tree->leaf[node]], 1);
    for (int i = 0; i < tree->children[node]; i++)
        append_leaves(tree, number, tree->child[node] + i, region, members);
}

/* The leaves of every region, in the order of its summation nodes. */
static void explicit_regions(const OctTree *tree, const OctRegions *regions, RefRegions *explicit)
{
    int *number = sm_alloc((size_t)tree->leaves, sizeof *number), live = 0;
    SmCsr rows;
    SmCsrParts members;
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        if (tree->node[leaf] >= 0) number[leaf] = live++;
    sm_csr_parts_init(&members, live);
    for (long r = 0; r < tree->leaves; r++)
        for (long n = regions->members.first[r]; tree->node[r] >= 0 && n < regions->members.end[r];
             n++)
            append_leaves(tree, number, regions->members.item[n], number[r], &members);
    sm_csr_parts_join(&members, &rows, 0);
    *explicit = (RefRegions){.count = live, .start = rows.first, .member = rows.item};
    free(number);
}

static void start_leaf(RefTreeBody *body, long i, const OctTree *tree, long leaf, double m)
{
    body->m[i] = m;
    for (int a = 0; a < 3; a++) {
        body->x0[i][a] = 0.5 * tree->centre[tree->node[leaf]][a];
        body->R[i][4 * a] = body->S[i][4 * a] = 1;
    }
}

void ref_tree_init(const OctTree *tree, const OctRegions *regions, const double *m, bool plain,
                   RefTreeBody *body)
{
    size_t n = (size_t)tree->leaves;
    long live = 0;
    memset(body, 0, sizeof *body);
    const RefRegions *r = &body->regions;
    explicit_regions(tree, regions, &body->regions);
    body->x0 = sm_alloc(n, sizeof *body->x0);
    body->m = sm_alloc(n, sizeof *body->m);
    body->weight = sm_alloc(n, sizeof *body->weight);
    body->reach = sm_alloc(n, sizeof *body->reach);
    body->R = sm_alloc(n, sizeof *body->R);
    body->S = sm_alloc(n, sizeof *body->S);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        if (tree->node[leaf] >= 0) start_leaf(body, live++, tree, leaf, m[leaf]);
    for (long i = 0; i < r->count; i++)
        for (long k = r->start[i]; k < r->start[i + 1]; k++)
            body->reach[r->member[k]] += body->m[i];
    for (long i = 0; i < r->count; i++)
        body->weight[i] = plain ? body->m[i] : body->m[i] / body->reach[i];
}

void ref_tree_free(RefTreeBody *body)
{
    ref_regions_free(&body->regions);
    sm_free_all(body->x0, body->m, body->weight, body->reach, body->R, body->S);
}

static void multiply(const double A[9], const double B[9], double C[9])
{
    double product[9] = {0};
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) product[i] += A[i / 3 * 3 + k] * B[k * 3 + i % 3];
    memcpy(C, product, sizeof product);
}

static void transpose(const double A[9], double T[9])
{
    for (int i = 0; i < 9; i++) T[i] = A[i % 3 * 3 + i / 3];
}

static double determinant(const double A[9])
{
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
           A[2] * (A[3] * A[7] - A[4] * A[6]);
}

/* False where A is singular for a solid of its size. */
static bool invert(const double A[9], double inverse[9])
{
    double d = determinant(A), third = (A[0] + A[4] + A[8]) / 3;
    if (!(d > 1e-6 * third * third * third)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            inverse[j * 3 + i] =
                (A[i1 * 3 + j1] * A[i2 * 3 + j2] - A[i1 * 3 + j2] * A[i2 * 3 + j1]) / d;
        }
    return true;
}

/* One region's shape matching. */
typedef struct {
    double c[3], c0[3], A[9], B[9]; /* B: sum of weight (x0 - c0)(x0 - c0)^T */
} Match;

static void match_region(const RefTreeBody *body, const double (*x)[3], long r, Match *t)
{
    double St[9];
    const double(*x0)[3] = (const double(*)[3])body->x0;
    ref_region_mean(&body->regions, body->weight, x0, r, t->c0);
    ref_region_mean(&body->regions, body->weight, x, r, t->c);
    ref_region_moments(&body->regions, body->weight, x, t->c, x0, t->c0, r, t->A);
    ref_region_moments(&body->regions, body->weight, x0, t->c0, x0, t->c0, r, t->B);
    transpose(body->S[r], St);
    multiply(t->A, St, t->A);
    ref_polar(t->A, body->R[r], body->R[r]);
}

static void flow_region(RefTreeBody *body, long r, const Match *t)
{
    double St[9], Rt[9], Q[9], inverse[9], E[9], S[9], size = 0, strain = 0;
    transpose(body->S[r], St);
    multiply(body->S[r], t->B, Q);
    multiply(Q, St, Q);
    if (!invert(Q, inverse)) return;
    transpose(body->R[r], Rt);
    multiply(Rt, t->A, E);
    multiply(E, inverse, E);
    for (int i = 0; i < 9; i++) {
        E[i] -= i % 4 == 0;
        strain += E[i] * E[i];
    }
    if (!(sqrt(strain) > body->yield)) return;
    multiply(E, body->S[r], S);
    for (int i = 0; i < 9; i++) {
        S[i] = body->S[r][i] + body->creep * S[i] - (i % 4 == 0);
        size += S[i] * S[i];
    }
    for (int i = 0; i < 9; i++) S[i] = S[i] * fmin(1, body->most / sqrt(size)) + (i % 4 == 0);
    double volume = determinant(S);
    if (!(volume > 0.05 && volume < 20)) return; /* no longer a shape */
    for (int i = 0; i < 9; i++) body->S[r][i] = S[i] / cbrt(volume);
}

void ref_tree_goals(RefTreeBody *body, const double (*x)[3], bool flow, double (*g)[3])
{
    const RefRegions *regions = &body->regions;
    memset(g, 0, (size_t)regions->count * sizeof *g);
    for (long r = 0; r < regions->count; r++) {
        Match t;
        double F[9];
        match_region(body, x, r, &t);
        multiply(body->R[r], body->S[r], F);
        for (long n = regions->start[r]; n < regions->start[r + 1]; n++) {
            int i = regions->member[n];
            for (int a = 0; a < 3; a++) {
                double to = t.c[a] - x[i][a];
                for (int b = 0; b < 3; b++) to += F[3 * a + b] * (body->x0[i][b] - t.c0[b]);
                g[i][a] += body->m[r] * to;
            }
        }
        if (flow && body->creep > 0) flow_region(body, r, &t);
    }
    for (long i = 0; i < regions->count; i++)
        for (int a = 0; a < 3; a++) g[i][a] = x[i][a] + g[i][a] / body->reach[i];
}

void ref_tree_rigid_velocity(const RefTreeBody *body, const double (*x)[3], const double (*v)[3],
                             const RefSums *sums, double (*u)[3])
{
    const RefRegions *regions = &body->regions;
    memset(u, 0, (size_t)regions->count * sizeof *u);
    for (long r = 0; r < regions->count; r++) {
        RefRigidMotion motion;
        ref_rigid_motion(regions, body->weight, x, v, sums, r, &motion);
        for (long n = regions->start[r]; n < regions->start[r + 1]; n++) {
            double here[3];
            int i = regions->member[n];
            ref_motion_at(&motion, x[i], here);
            for (int a = 0; a < 3; a++) u[i][a] += body->m[r] * here[a];
        }
    }
    for (long i = 0; i < regions->count; i++)
        for (int a = 0; a < 3; a++) u[i][a] /= body->reach[i];
}
