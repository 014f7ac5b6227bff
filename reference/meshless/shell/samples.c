#include "samples.h"

#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../body/covers.h"
#include "../body/gauss_rule.h"

enum { ORDER = 3, PARTS = 2, ALONG = ORDER * PARTS };

void ref_samples_free(RefSamples *samples)
{
    sm_free_all(samples->theta, samples->weight, samples->start, samples->node, samples->part);
    *samples = (RefSamples){0};
}

static void place(const RefQuadtree *tree, RefSamples *samples)
{
    double at[ORDER], weight[ORDER];
    ref_gauss_rule(ORDER, at, weight);
    for (long c = 0; c < tree->count; c++) {
        double middle[2], edge[2];
        if (tree->cell[c].child >= 0) continue;
        ref_quadtree_cell(tree, tree->cell + c, middle, edge);
        for (int n = 0; n < REF_SAMPLES_PER_CELL; n++, samples->count++) {
            int which[2] = {n % ALONG, n / ALONG};
            double area = edge[0] * edge[1] / (PARTS * PARTS);
            for (int d = 0; d < 2; d++) {
                int part = which[d] / ORDER, point = which[d] % ORDER;
                samples->theta[samples->count][d] =
                    middle[d] + edge[d] * ((part + 0.5 + at[point]) / PARTS - 0.5);
                area *= weight[point];
            }
            samples->weight[samples->count] = area;
        }
    }
}

static void evaluate(const RefNodes *nodes, RefBasis basis, RefSamples *samples)
{
    RefShape shape = ref_shape_create(nodes);
    long end = 0, room = 0, part_room = 0;
    for (long p = 0; p < samples->count; p++) {
        ref_mls_at(nodes, basis, samples->theta[p], &shape);
        sm_make_room(samples->node, room, end + shape.count);
        sm_make_room(samples->part, part_room, end + shape.count);
        for (int n = 0; n < shape.count; n++, end++) {
            double *part = samples->part[end];
            samples->node[end] = shape.node[n];
            part[0] = shape.value[n];
            for (int d = 0; d < 2; d++) part[1 + d] = shape.gradient[n][d];
            for (int m = 0; m < 3; m++) part[3 + m] = shape.second[n][m];
        }
        samples->start[p + 1] = end;
    }
    ref_shape_free(&shape);
}

SmCode ref_samples_take(const RefQuadtree *tree, RefNodes *nodes, RefBasis basis,
                        RefSamples *samples, SmError *error)
{
    size_t points = (size_t)tree->leaves * REF_SAMPLES_PER_CELL;
    *samples = (RefSamples){.theta = sm_alloc(points, sizeof(double[3])),
                            .weight = sm_alloc(points, sizeof(double)),
                            .start = sm_alloc(points + 1, sizeof(long))};
    place(tree, samples);
    long bad = ref_mls_cover(nodes, basis, samples->count, (const double(*)[3])samples->theta);
    if (bad == 0) {
        evaluate(nodes, basis, samples);
        return SM_OK;
    }
    ref_samples_free(samples);
    return sm_fail(error, SM_INPUT,
                   "%ld of the shell's %zu integration points are covered by too few of its %ld "
                   "nodes, or by nodes in a line: give it more nodes",
                   bad, points, nodes->count);
}

int ref_samples_nodes(const RefSamples *samples, long cell, int *node, int *number)
{
    int count = 0;
    long from = samples->start[cell * REF_SAMPLES_PER_CELL];
    for (long e = from; e < samples->start[(cell + 1) * REF_SAMPLES_PER_CELL]; e++)
        if (number[samples->node[e]] < 0) {
            number[samples->node[e]] = 0;
            node[count++] = samples->node[e];
        }
    sm_sort_ints(node, count);
    for (int n = 0; n < count; n++) number[node[n]] = n;
    return count;
}

RefPairs ref_samples_pairs(const RefSamples *samples, long nodes)
{
    RefPairs pairs = ref_pairs_begin(nodes);
    int *node = sm_alloc((size_t)nodes, sizeof *node);
    int *number = sm_alloc((size_t)nodes, sizeof *number);
    for (long n = 0; n < nodes; n++) number[n] = -1;
    for (long c = 0; c < samples->count / REF_SAMPLES_PER_CELL; c++) {
        int count = ref_samples_nodes(samples, c, node, number);
        ref_pairs_meet(&pairs, count, node);
        for (int n = 0; n < count; n++) number[node[n]] = -1;
    }
    ref_pairs_end(&pairs);
    free(node);
    free(number);
    return pairs;
}
