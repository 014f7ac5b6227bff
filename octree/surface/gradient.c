#include "gradient.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/csr.h"
#include "../../lib/polar.h"
#include "../../lib/system/team.h"

enum { FAR_EDGES = 64, CHUNK = 16 };

/* A direction is spanned if it holds this share of the moments: below it, positions say so little
 * that their noise would rule. */
static const double least_share = 0.01;

/* Moments of the neighbours: sum of weight d d^T = V diag(value) V^T. */
typedef struct {
    double value[3], vector[9], trace;
    int span;
} Moments;

/* From leaf k to leaf j in half finest cells; returns the neighbour's weight. */
static double offset(const OctTree *tree, long k, int j, double d[3])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        d[a] = tree->centre[tree->node[j]][a] - tree->centre[tree->node[k]][a];
        square += d[a] * d[a];
    }
    return 1 / square;
}

static void find_moments(const OctTree *tree, long k, const int *leaf, long count, Moments *m)
{
    double S[9] = {0}, d[3];
    *m = (Moments){.vector = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (long n = 0; n < count; n++) {
        double weight = offset(tree, k, leaf[n], d);
        for (int i = 0; i < 9; i++) S[i] += weight * d[i / 3] * d[i % 3];
    }
    m->trace = S[0] + S[4] + S[8];
    sm_jacobi(3, S, m->vector, 1e-14);
    for (int a = 0; a < 3; a++) {
        m->value[a] = S[4 * a];
        m->span += m->value[a] > least_share * m->trace;
    }
}

/* Leaves within `most` of leaf k, without itself, and their moments. */
static int *reach_out(const OctTree *tree, const OctGraph *graph, OctReach *reach, long k, int most,
                      long *count, Moments *m)
{
    if (!reach->graph) oct_reach_init(reach, graph);
    oct_reach_from(reach, (int)k, most);
    *count = reach->count - 1;
    find_moments(tree, k, reach->reached + 1, *count, m);
    return reach->reached + 1;
}

/* The neighbours that leaf k is fitted to, and their moments; `most` becomes how far they were
 * looked for beyond its own, or 0. */
static const int *choose(const OctTree *tree, const OctGraph *graph, OctReach *reach, long k,
                         long *count, int *most, Moments *m)
{
    const int *leaf = graph->edges.item + graph->edges.first[k];
    *count = graph->edges.end[k] - graph->edges.first[k];
    find_moments(tree, k, leaf, *count, m);
    *most = 0;
    if (m->span == 3) return leaf;
    long more, before = 0;
    Moments wider;
    int size = tree->size[tree->node[k]], within = 2 * size;
    const int *found = reach_out(tree, graph, reach, k, within, &more, &wider);
    while (wider.span < 2 && more > before && within < FAR_EDGES * size) {
        before = more;
        within *= 2;
        found = reach_out(tree, graph, reach, k, within, &more, &wider);
    }
    *most = within;
    if (wider.span <= m->span) return leaf;
    *count = more;
    *m = wider;
    return found;
}

static void choose_all(const OctTree *tree, const OctGraph *graph, const unsigned char *wanted,
                       OctGradients *g)
{
    SmCsrParts lists;
    sm_csr_parts_init(&lists, g->leaves);
#pragma omp parallel num_threads(sm_team(0))
    {
        OctReach reach = {0};
#pragma omp for schedule(dynamic)
        for (long block = 0; block < lists.blocks; block++)
            for (long k = sm_csr_parts_from(block); k < sm_csr_parts_to(&lists, block); k++) {
                long count = 0;
                Moments m;
                if (!wanted[k]) continue;
                const int *leaf = choose(tree, graph, &reach, k, &count, &g->reach[k], &m);
                sm_csr_parts_add(&lists, k, leaf, count);
            }
        oct_reach_free(&reach);
    }
    sm_csr_parts_join(&lists, &g->rows, 3 * sizeof(double));
}

/* sum over the directions, spanned or not, of value^power v v^T. */
static void compose(const Moments *m, bool spanned, double power, double M[9])
{
    memset(M, 0, 9 * sizeof *M);
    for (int a = 0; a < 3; a++) {
        if ((m->value[a] > least_share * m->trace) != spanned) continue;
        double factor = power < 0 ? m->trace / m->value[a] : 1;
        for (int i = 0; i < 9; i++)
            M[i] += factor * m->vector[i / 3 * 3 + a] * m->vector[i % 3 * 3 + a];
    }
}

static void neighbour_moments(const OctTree *tree, const OctGradients *g, long k, Moments *m)
{
    find_moments(tree, k, g->rows.item + g->rows.first[k], g->rows.end[k] - g->rows.first[k], m);
}

/* What a share's direction goes through: of flat leaves nothing yet. */
static void find_apply(const Moments *m, double apply[9])
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (m->span == 3)
        compose(m, true, -1, apply);
    else
        memcpy(apply, identity, sizeof identity);
}

static void find_share(const OctTree *tree, long k, int j, const Moments *m, const double apply[9],
                       double cell, double share[3])
{
    double d[3], scale = offset(tree, k, j, d) / m->trace * 2 / cell;
    for (int a = 0; a < 3; a++)
        share[a] =
            scale * (apply[3 * a] * d[0] + apply[3 * a + 1] * d[1] + apply[3 * a + 2] * d[2]);
}

/* Shares of leaf k's neighbours; those of flat leaves come without the inverse. */
static void share_out(const OctTree *tree, long k, const Moments *m, OctGradients *g)
{
    double apply[9], (*share)[3] = g->rows.value;
    g->span[k] = (unsigned char)m->span;
    find_apply(m, apply);
    for (long e = g->rows.first[k]; e < g->rows.end[k]; e++)
        find_share(tree, k, g->rows.item[e], m, apply, g->cell, share[e]);
}

/* Takes a leaf, by its moments, into the flat ones, where there is room for all leaves. */
static void add_flat(OctGradients *g, int k, const Moments *m)
{
    int place = g->flat_place[k];
    if (place < 0) g->flat_place[k] = place = (int)g->flats++;
    g->flat[place].leaf = k;
    compose(m, true, -1, g->flat[place].inverse);
    compose(m, false, 0, g->flat[place].beyond);
}

/* Takes a leaf out of the flat ones, if it is there. */
static void drop_flat(OctGradients *g, int k)
{
    int place = g->flat_place[k];
    if (place < 0) return;
    g->flat[place] = g->flat[--g->flats];
    g->flat_place[g->flat[place].leaf] = place;
    g->flat_place[k] = -1;
}

static void make_room(OctGradients *g, long leaves)
{
    if (leaves > g->room) {
        g->room = g->room ? 2 * leaves : leaves;
        size_t room = (size_t)g->room;
        g->leaf = sm_realloc(g->leaf, room, sizeof *g->leaf);
        g->place = sm_realloc(g->place, room, sizeof *g->place);
        g->span = sm_realloc(g->span, room, 1);
        g->reach = sm_realloc(g->reach, room, sizeof *g->reach);
        g->flat = sm_realloc(g->flat, room, sizeof *g->flat);
        g->flat_place = sm_realloc(g->flat_place, room, sizeof *g->flat_place);
    }
    for (; g->leaves < leaves; g->leaves++) {
        g->place[g->leaves] = g->flat_place[g->leaves] = -1;
        g->span[g->leaves] = 0;
        g->reach[g->leaves] = 0;
    }
}

void oct_gradients_build(const OctTree *tree, const OctGraph *graph, const unsigned char *wanted,
                         double cell, OctGradients *g)
{
    *g = (OctGradients){.cell = cell};
    make_room(g, tree->leaves);
    choose_all(tree, graph, wanted, g);
    for (int k = 0; k < g->leaves; k++) {
        if (!wanted[k]) continue;
        g->place[k] = (int)g->count;
        g->leaf[g->count++] = k;
    }
#pragma omp parallel for schedule(static) num_threads(sm_team(0))
    for (long n = 0; n < g->count; n++) {
        Moments m;
        neighbour_moments(tree, g, g->leaf[n], &m);
        share_out(tree, g->leaf[n], &m, g);
    }
    for (long n = 0; n < g->count; n++) {
        Moments m;
        if (g->span[g->leaf[n]] == 3) continue;
        neighbour_moments(tree, g, g->leaf[n], &m);
        add_flat(g, g->leaf[n], &m);
    }
}

void oct_gradients_free(OctGradients *gradients)
{
    sm_csr_free(&gradients->rows);
    sm_free_all(gradients->leaf, gradients->place, gradients->span, gradients->reach,
                gradients->flat, gradients->flat_place);
    *gradients = (OctGradients){0};
}

void oct_gradients_grow(OctGradients *gradients, const OctTree *tree)
{
    make_room(gradients, tree->leaves);
    sm_csr_grow(&gradients->rows, tree->leaves);
}

void oct_gradients_renew(OctGradients *g, const OctTree *tree, const OctGraph *graph,
                         OctReach *search, int leaf)
{
    long count;
    Moments m;
    const int *neighbour = choose(tree, graph, search, leaf, &count, &g->reach[leaf], &m);
    if (g->place[leaf] < 0) {
        g->place[leaf] = (int)g->count;
        g->leaf[g->count++] = leaf;
    }
    sm_csr_set(&g->rows, leaf, count, neighbour);
    share_out(tree, leaf, &m, g);
    if (m.span < 3)
        add_flat(g, leaf, &m);
    else
        drop_flat(g, leaf);
}

void oct_gradients_drop(OctGradients *g, int leaf)
{
    int place = g->place[leaf];
    if (place < 0) return;
    g->leaf[place] = g->leaf[--g->count];
    g->place[g->leaf[place]] = place;
    g->place[leaf] = -1;
    sm_csr_set(&g->rows, leaf, 0, NULL);
    drop_flat(g, leaf);
}

static void multiply(const double A[9], const double B[9], double C[9])
{
    for (int i = 0; i < 9; i++)
        C[i] = A[i / 3 * 3] * B[i % 3] + A[i / 3 * 3 + 1] * B[3 + i % 3] +
               A[i / 3 * 3 + 2] * B[6 + i % 3];
}

/* F = A inverse + R beyond, of the R that turns A. */
static void finish_flat(const OctFlat *flat, const double A[9], const double R[9], double F[9])
{
    double fit[9], turned[9];
    multiply(A, flat->inverse, fit);
    multiply(R, flat->beyond, turned);
    for (int i = 0; i < 9; i++) F[i] = fit[i] + turned[i];
}

/* The same of the flat leaves first..last - 1, where F holds their A. */
static void finish_flats(const OctGradients *g, long first, long last, double (*F)[9])
{
    double A[CHUNK][9] = {{0}}, R[CHUNK][9] = {{0}};
    for (long n = first; n < last; n++) memcpy(A[n - first], F[g->flat[n].leaf], sizeof A[0]);
    sm_polar_batch_f64(last - first, &A[0][0], NULL, &R[0][0]);
    for (long n = first; n < last; n++)
        finish_flat(&g->flat[n], A[n - first], R[n - first], F[g->flat[n].leaf]);
}

static void add_moved(const double x[3], const double own[3], const double share[3], double sum[9])
{
    for (int a = 0; a < 3; a++) {
        double moved = x[a] - own[a];
        for (int b = 0; b < 3; b++) sum[3 * a + b] += moved * share[b];
    }
}

void oct_gradient_of(const OctTree *tree, const OctGraph *graph, double cell, OctReach *search,
                     int leaf, const double (*x)[3], double F[9])
{
    long count;
    int most;
    Moments m;
    OctFlat flat;
    double apply[9], share[3], A[9] = {0}, R[9];
    const int *neighbour = choose(tree, graph, search, leaf, &count, &most, &m);
    find_apply(&m, apply);
    for (long n = 0; n < count; n++) {
        find_share(tree, leaf, neighbour[n], &m, apply, cell, share);
        add_moved(x[neighbour[n]], x[leaf], share, A);
    }
    memcpy(F, A, sizeof A);
    if (m.span == 3) return;
    compose(&m, true, -1, flat.inverse);
    compose(&m, false, 0, flat.beyond);
    sm_polar_batch_f64(1, A, NULL, R);
    finish_flat(&flat, A, R, F);
}

void oct_gradients_find(const OctGradients *g, const double (*x)[3], double (*F)[9])
{
    const double(*share)[3] = g->rows.value;
#pragma omp parallel num_threads(sm_team(0))
    {
#pragma omp for schedule(static)
        for (long n = 0; n < g->count; n++) {
            int k = g->leaf[n];
            double sum[9] = {0};
            for (long e = g->rows.first[k]; e < g->rows.end[k]; e++)
                add_moved(x[g->rows.item[e]], x[k], share[e], sum);
            memcpy(F[k], sum, sizeof sum);
        }
#pragma omp for schedule(static)
        for (long n = 0; n < g->flats; n += CHUNK)
            finish_flats(g, n, n + CHUNK < g->flats ? n + CHUNK : g->flats, F);
    }
}
