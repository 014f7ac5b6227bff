#include "samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../body/covers.h"
#include "../body/gauss_rule.h"

static const double MOST_SLOPE = 6, MOST_SECOND = 50;
enum { ORDER = 3, PARTS = 2, ALONG = ORDER * PARTS };

void ref_samples_free(RefSamples *samples)
{
    sm_free_all(samples->theta, samples->weight, samples->area, samples->trace, samples->start,
                samples->node, samples->part);
    *samples = (RefSamples){0};
}

/* Appends a cell's points. */
static void place(const RefQuadtree *tree, const RefCell *cell, RefSamples *samples)
{
    double at[ORDER], weight[ORDER], middle[2], edge[2];
    ref_gauss_rule(ORDER, at, weight);
    ref_quadtree_cell(tree, cell, middle, edge);
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

/* Whether functions vary no faster than their cell can bear: where cracks leave a sample few nodes,
 * at their covers' edges, they may, and would be stiffer than all else by orders of magnitude.
 * Whole covers have slopes of 2 over the edge and second derivatives of 9 over its square at most.
 */
static bool tame(const RefShape *shape, double edge)
{
    bool wild = false;
    for (int n = 0; n < shape->count; n++) {
        for (int d = 0; d < 2; d++) wild |= fabs(shape->gradient[n][d]) * edge > MOST_SLOPE;
        for (int m = 0; m < 3; m++) wild |= fabs(shape->second[n][m]) * edge * edge > MOST_SECOND;
    }
    return !wild;
}

int ref_samples_shape(const RefNodes *nodes, RefBasis basis, double edge, const double x[3],
                      RefShape *shape)
{
    const RefBasis bases[] = {basis, REF_MLS_PLANE_LINEAR, REF_MLS_PLANE_CONSTANT};
    const double beside[3] = {x[0] + 1.3e-6 * edge, x[1] + 0.7e-6 * edge, 0};
    const double *eye[2] = {x, beside};
    if (!nodes->cut.pass) return ref_mls_at(nodes, basis, x, shape) ? (int)basis : 0;
    for (int e = 0; e < 2; e++) {
        for (int n = basis == bases[1]; n < 3; n++)
            if (ref_mls_seen_from(nodes, bases[n], x, eye[e], shape) && tame(shape, edge))
                return (int)bases[n];
        if (shape->count) break;
    }
    for (int n = 0; n < shape->count; n++) {
        memset(shape->gradient[n], 0, sizeof shape->gradient[n]);
        memset(shape->second[n], 0, sizeof shape->second[n]);
    }
    return shape->count ? REF_MLS_PLANE_CONSTANT : 0;
}

/* Functions' values beyond this carry a place away with nodes far from it. */
static const double MOST_VALUE = 2;

void ref_samples_expand(const RefSamples *samples, long near, const double theta[2],
                        RefShape *shape)
{
    const double *from = samples->theta[near];
    double x = theta[0] - from[0], y = theta[1] - from[1];
    bool far = false;
    long start = samples->start[near];
    shape->count = (int)(samples->start[near + 1] - start);
    for (int n = 0; n < shape->count; n++) {
        const double *p = samples->part[start + n];
        shape->node[n] = samples->node[start + n];
        shape->value[n] =
            p[0] + x * p[1] + y * p[2] + x * x / 2 * p[3] + y * y / 2 * p[4] + x * y * p[5];
        shape->gradient[n][0] = p[1] + x * p[3] + y * p[5];
        shape->gradient[n][1] = p[2] + y * p[4] + x * p[5];
        for (int m = 0; m < 3; m++) shape->second[n][m] = p[3 + m];
        far |= fabs(shape->value[n]) > MOST_VALUE;
    }
    if (!far) return;
    for (int n = 0; n < shape->count; n++) {
        shape->value[n] = samples->part[start + n][0];
        memset(shape->gradient[n], 0, sizeof shape->gradient[n]);
        memset(shape->second[n], 0, sizeof shape->second[n]);
    }
}

/* Points of a part lie at 0.11, 0.5 and 0.89 of it. */
int ref_samples_nearest(const double middle[2], const double edge[2], const double theta[2])
{
    int which[2];
    for (int d = 0; d < 2; d++) {
        double place = PARTS * ((theta[d] - middle[d]) / edge[d] + 0.5);
        int part = (int)fmin(fmax(floor(place), 0), PARTS - 1);
        double within = place - part;
        which[d] = ORDER * part + (within < 0.306 ? 0 : within < 0.694 ? 1 : 2);
    }
    return which[1] * ALONG + which[0];
}

void ref_samples_part(const RefShape *shape, int n, double part[6])
{
    part[0] = shape->value[n];
    for (int d = 0; d < 2; d++) part[1 + d] = shape->gradient[n][d];
    for (int m = 0; m < 3; m++) part[3 + m] = shape->second[n][m];
}

static void evaluate(const RefNodes *nodes, RefBasis basis, double edge, RefShape *shape,
                     RefSamples *samples)
{
    long end = 0, room = 0, part_room = 0;
    for (long p = 0; p < samples->count; p++) {
        ref_samples_shape(nodes, basis, edge, samples->theta[p], shape);
        sm_make_room(samples->node, room, end + shape->count);
        sm_make_room(samples->part, part_room, end + shape->count);
        for (int n = 0; n < shape->count; n++, end++) {
            samples->node[end] = shape->node[n];
            ref_samples_part(shape, n, samples->part[end]);
        }
        samples->start[p + 1] = end;
    }
}

static RefSamples create(long points)
{
    size_t count = (size_t)points;
    return (RefSamples){.theta = sm_alloc(count, sizeof(double[3])),
                        .weight = sm_alloc(count, sizeof(double)),
                        .area = sm_alloc(count, sizeof(double)),
                        .trace = sm_alloc(count, sizeof(double)),
                        .start = sm_alloc(count + 1, sizeof(long))};
}

void ref_samples_of(const RefQuadtree *tree, long cell, const RefNodes *nodes, RefBasis basis,
                    RefShape *shape, RefSamples *samples)
{
    *samples = create(REF_SAMPLES_PER_CELL);
    place(tree, tree->cell + cell, samples);
    evaluate(nodes, basis, ref_quadtree_edge(tree, tree->cell + cell), shape, samples);
}

SmCode ref_samples_take(const RefQuadtree *tree, RefNodes *nodes, RefBasis basis,
                        RefSamples *samples, SmError *error)
{
    long points = tree->leaves * REF_SAMPLES_PER_CELL;
    *samples = create(points);
    for (long c = 0; c < tree->count; c++)
        if (tree->cell[c].child < 0) place(tree, tree->cell + c, samples);
    long bad = ref_mls_cover(nodes, basis, samples->count, (const double(*)[3])samples->theta);
    if (bad == 0) {
        RefShape shape = ref_shape_create(nodes);
        evaluate(nodes, basis, 0, &shape, samples);
        ref_shape_free(&shape);
        return SM_OK;
    }
    ref_samples_free(samples);
    return sm_fail(error, SM_INPUT,
                   "%ld of the shell's %ld integration points are covered by too few of its %ld "
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
