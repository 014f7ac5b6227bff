#include "gradient.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/polar.h"
#include "distance.h"
#include "lists.h"

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
static int *reach_out(const OctTree *tree, OctReach *reach, long k, int most, long *count,
                      Moments *m)
{
    oct_reach_from(reach, (int)k, most);
    *count = reach->count - 1;
    find_moments(tree, k, reach->reached + 1, *count, m);
    return reach->reached + 1;
}

/* The neighbours that leaf k is fitted to, into list n. */
static void choose(const OctTree *tree, const OctGraph *graph, OctReach *reach, long k, long n,
                   OctLists *lists)
{
    long first = graph->first[k], count = oct_graph_end(graph, k) - first;
    const int *leaf = graph->to + first;
    Moments m;
    find_moments(tree, k, leaf, count, &m);
    if (m.span < 3) {
        long more;
        Moments wider;
        int size = tree->size[tree->node[k]], most = 2 * size;
        const int *found = reach_out(tree, reach, k, most, &more, &wider);
        long before = 0;
        while (wider.span < 2 && more > before && most < FAR_EDGES * size) {
            before = more;
            most *= 2;
            found = reach_out(tree, reach, k, most, &more, &wider);
        }
        if (wider.span > m.span) {
            leaf = found;
            count = more;
        }
    }
    oct_lists_add(lists, n, leaf, count);
}

static void choose_all(const OctTree *tree, const OctGraph *graph, OctGradients *g)
{
    OctLists lists;
    oct_lists_init(&lists, g->count);
#pragma omp parallel
    {
        OctReach reach;
        oct_reach_init(&reach, graph);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < lists.blocks; block++)
            for (long n = oct_lists_from(block); n < oct_lists_to(&lists, block); n++)
                choose(tree, graph, &reach, g->leaf[n], n, &lists);
        oct_reach_free(&reach);
    }
    oct_lists_pack(&lists, &g->first, &g->neighbour);
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

static void neighbour_moments(const OctTree *tree, const OctGradients *g, long n, Moments *m)
{
    find_moments(tree, g->leaf[n], g->neighbour + g->first[n], g->first[n + 1] - g->first[n], m);
}

/* Shares of the neighbours in list n; those of flat leaves come without the inverse. */
static void share_out(const OctTree *tree, double cell, long n, OctGradients *g)
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    Moments m;
    double inverse[9], d[3];
    neighbour_moments(tree, g, n, &m);
    g->span[g->leaf[n]] = (unsigned char)m.span;
    compose(&m, true, -1, inverse);
    const double *apply = m.span == 3 ? inverse : identity;
    for (long e = g->first[n]; e < g->first[n + 1]; e++) {
        double scale = offset(tree, g->leaf[n], g->neighbour[e], d) / m.trace * 2 / cell;
        for (int a = 0; a < 3; a++)
            g->share[e][a] =
                scale * (apply[3 * a] * d[0] + apply[3 * a + 1] * d[1] + apply[3 * a + 2] * d[2]);
    }
}

static void list_flats(const OctTree *tree, OctGradients *g)
{
    for (long n = 0; n < g->count; n++) g->flats += g->span[g->leaf[n]] < 3;
    g->flat = sm_alloc((size_t)g->flats, sizeof *g->flat);
    OctFlat *flat = g->flat;
    for (long n = 0; n < g->count; n++) {
        if (g->span[g->leaf[n]] == 3) continue;
        Moments m;
        neighbour_moments(tree, g, n, &m);
        flat->leaf = g->leaf[n];
        compose(&m, true, -1, flat->inverse);
        compose(&m, false, 0, flat->beyond);
        flat++;
    }
}

void oct_gradients_build(const OctTree *tree, const OctGraph *graph, const unsigned char *wanted,
                         double cell, OctGradients *gradients)
{
    OctGradients *g = gradients;
    *g = (OctGradients){.leaves = tree->leaves};
    for (long k = 0; k < g->leaves; k++) g->count += wanted[k];
    g->leaf = sm_alloc((size_t)g->count, sizeof *g->leaf);
    for (long k = 0, n = 0; k < g->leaves; k++)
        if (wanted[k]) g->leaf[n++] = (int)k;
    choose_all(tree, graph, g);
    g->share = sm_alloc((size_t)g->first[g->count], sizeof *g->share);
    g->span = sm_alloc((size_t)g->leaves, 1);
#pragma omp parallel for schedule(static)
    for (long n = 0; n < g->count; n++) share_out(tree, cell, n, g);
    list_flats(tree, g);
}

void oct_gradients_free(OctGradients *gradients)
{
    free(gradients->leaf);
    free(gradients->first);
    free(gradients->neighbour);
    free(gradients->share);
    free(gradients->span);
    free(gradients->flat);
    *gradients = (OctGradients){0};
}

static void multiply(const double A[9], const double B[9], double C[9])
{
    for (int i = 0; i < 9; i++)
        C[i] = A[i / 3 * 3] * B[i % 3] + A[i / 3 * 3 + 1] * B[3 + i % 3] +
               A[i / 3 * 3 + 2] * B[6 + i % 3];
}

/* F = A inverse + R beyond of the flat leaves first..last - 1, where F holds their A. */
static void finish_flats(const OctGradients *g, long first, long last, double (*F)[9])
{
    double A[CHUNK][9] = {{0}}, R[CHUNK][9] = {{0}}, fit[9], turned[9];
    for (long n = first; n < last; n++) memcpy(A[n - first], F[g->flat[n].leaf], sizeof A[0]);
    sm_polar_batch_f64(last - first, &A[0][0], NULL, &R[0][0]);
    for (long n = first; n < last; n++) {
        multiply(A[n - first], g->flat[n].inverse, fit);
        multiply(R[n - first], g->flat[n].beyond, turned);
        for (int i = 0; i < 9; i++) F[g->flat[n].leaf][i] = fit[i] + turned[i];
    }
}

void oct_gradients_find(const OctGradients *gradients, const double (*x)[3], double (*F)[9])
{
    const OctGradients *g = gradients;
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (long n = 0; n < g->count; n++) {
            const double *own = x[g->leaf[n]];
            double sum[9] = {0};
            for (long e = g->first[n]; e < g->first[n + 1]; e++)
                for (int a = 0; a < 3; a++) {
                    double moved = x[g->neighbour[e]][a] - own[a];
                    for (int b = 0; b < 3; b++) sum[3 * a + b] += moved * g->share[e][b];
                }
            memcpy(F[g->leaf[n]], sum, sizeof sum);
        }
#pragma omp for schedule(static)
        for (long n = 0; n < g->flats; n += CHUNK)
            finish_flats(g, n, n + CHUNK < g->flats ? n + CHUNK : g->flats, F);
    }
}
