#include "samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../../../lib/isa.h"
#include "../body/covers.h"
#include "../body/gauss_rule.h"

static const double MOST_SLOPE = 6, MOST_SECOND = 50;
enum { ORDER = 3, PARTS = 2, ALONG = ORDER * PARTS };
_Static_assert(PARTS == 2, "of two parts the second begins at 1");
_Static_assert((int)ALONG == (int)REF_GRID_SIDE && (int)ALONG == (int)REF_CELL_SIDE, "one grid");

void ref_samples_free(RefSamples *samples)
{
    sm_free_all(samples->theta, samples->weight, samples->area, samples->trace, samples->start,
                samples->node, samples->part, samples->frame);
    *samples = (RefSamples){0};
}

void ref_samples_grid(const RefQuadtree *tree, long cell, double at[2][REF_GRID_SIDE])
{
    double middle[2], edge[2];
    ref_quadtree_cell(tree, tree->cell + cell, middle, edge);
    for (int d = 0; d < 2; d++)
        for (int i = 0; i < ALONG; i++) {
            double share = i / ORDER + 0.5 + ref_gauss_three_at[i % ORDER];
            at[d][i] = middle[d] + edge[d] * (share / PARTS - 0.5);
        }
}

/* Appends a cell's points. */
static void place(const RefQuadtree *tree, long cell, RefSamples *samples)
{
    double middle[2], edge[2], at[2][ALONG];
    ref_quadtree_cell(tree, tree->cell + cell, middle, edge);
    ref_samples_grid(tree, cell, at);
    for (int n = 0; n < REF_SAMPLES_PER_CELL; n++, samples->count++) {
        int which[2] = {n % ALONG, n / ALONG};
        double area = edge[0] * edge[1] / (PARTS * PARTS);
        for (int d = 0; d < 2; d++) {
            samples->theta[samples->count][d] = at[d][which[d]];
            area *= ref_gauss_three_weight[which[d] % ORDER];
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
        far |= fabs(shape->value[n]) > REF_SAMPLES_MOST_VALUE;
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
        int part = place >= 1;
        double within = place - part;
        which[d] = ORDER * part + (within >= 0.306) + (within >= 0.694);
    }
    return which[1] * ALONG + which[0];
}

void ref_samples_fetch_quarters(const RefSamples *samples)
{
    for (int q = 0; q < 4 && samples->count; q++) {
        const long *start = samples->start + ref_samples_quarter(q);
        const char *part = (const char *)(samples->part + start[0]);
        const char *end = (const char *)(samples->part + start[1]);
        for (__builtin_prefetch(samples->node + start[0]); part < end; part += 64)
            __builtin_prefetch(part);
    }
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

RefSamplesWork ref_samples_work(const RefNodes *nodes, RefBasis basis, const RefCracks *cracks)
{
    return (RefSamplesWork){
        .nodes = nodes, .basis = basis, .cracks = cracks, .shape = ref_shape_create(nodes)};
}

void ref_samples_work_free(RefSamplesWork *work)
{
    ref_shape_free(&work->shape);
    sm_free_all(work->node, work->member);
    *work = (RefSamplesWork){.room = 0};
}

SM_ISA_TABLE(RefCellFunctions, ref_cell_functions)

/* Of a grid those that a node's cover reaches; false: none. */
static bool reached(const double at[2][REF_GRID_SIDE], const double node[2], double reach,
                    int first[2], RefGrid *grid)
{
    for (int d = 0; d < 2; d++) {
        int begin = 0, end = ALONG;
        while (begin < ALONG && !(fabs(at[d][begin] - node[d]) / reach < REF_MLS_INSIDE)) begin++;
        while (end > begin && !(fabs(at[d][end - 1] - node[d]) / reach < REF_MLS_INSIDE)) end--;
        first[d] = begin;
        grid->count[d] = end - begin;
        grid->at[d] = at[d] + begin;
    }
    return grid->count[0] > 0 && grid->count[1] > 0;
}

/* Multiplies the weights of a node by parts that get to the samples of a grid; whether any is left.
 */
static bool take_parts(const RefGrid *grid, const int first[2], const double (*part)[6],
                       RefCellNode *of)
{
    bool any = false;
    for (int n = 0; n < grid->count[0] * grid->count[1]; n++) {
        int l = ALONG * (first[1] + n / grid->count[0]) + first[0] + n % grid->count[0];
        double w[6];
        for (int k = 0; k < 6; k++) w[k] = of->weight[k][l];
        ref_mls_multiply(part[n], w);
        for (int k = 0; k < 6; k++) of->weight[k][l] = w[0] > 0 ? w[k] : 0;
        any |= w[0] > 0;
    }
    return any;
}

/* What gets past the zeros of a plane of cylinders to the samples of a grid. */
static void pass_zeros(const RefNodes *nodes, long n, const RefGrid *grid, double (*part)[6])
{
    const double *node = nodes->position[nodes->owner[n]];
    for (int p = 0; p < grid->count[0] * grid->count[1]; p++) {
        const double x[3] = {grid->at[0][p % grid->count[0]], grid->at[1][p / grid->count[0]]};
        if (!ref_cylinders_pass(nodes->cylinders, x, nodes->position[n], node, nodes->reach[n],
                                part[p]))
            memset(part[p], 0, sizeof part[p]);
    }
}

/* The weights of one node at a cell's samples; false: none. */
static bool weigh(const double at[2][ALONG], const RefSamplesWork *work, long n, RefCellNode *of)
{
    const RefNodes *nodes = work->nodes;
    int first[2];
    RefGrid grid;
    double spline[2][3][ALONG] = {{{0}}}, part[REF_SAMPLES_PER_CELL][6];
    const double *node = nodes->position[n], reach = nodes->reach[n];
    if (!reached(at, node, reach, first, &grid)) return false;
    for (int d = 0; d < 2; d++)
        for (int i = first[d]; i < first[d] + grid.count[d]; i++) {
            double slope[2];
            spline[d][0][i] = ref_mls_spline((at[d][i] - node[d]) / reach, slope);
            spline[d][1][i] = slope[0] / reach;
            spline[d][2][i] = slope[1] / (reach * reach);
        }
    ref_cell_functions.weigh((const double(*)[3][ALONG])spline, of);
    if (nodes->cylinders && nodes->dimmed[n]) {
        pass_zeros(nodes, n, &grid, part);
        if (!take_parts(&grid, first, (const double(*)[6])part, of)) return false;
    }
    return !ref_cracks_fan(work->cracks, &grid, node, reach, part) ||
           take_parts(&grid, first, (const double(*)[6])part, of);
}

static void set_ways(const double at[2][ALONG], const double node[2], double scale, RefCellNode *of)
{
    double way[2][ALONG];
    for (int d = 0; d < 2; d++)
        for (int i = 0; i < ALONG; i++) way[d][i] = (node[d] - at[d][i]) / scale;
    for (int j = 0; j < ALONG; j++)
        for (int i = 0; i < ALONG; i++) {
            of->way[0][ALONG * j + i] = way[0][i];
            of->way[1][ALONG * j + i] = way[1][j];
        }
}

/* All nodes that a cell's samples see, rising; returns how many. */
static int gather(const double at[2][ALONG], double scale, RefSamplesWork *work)
{
    const RefNodes *nodes = work->nodes;
    int count = 0, home = 0;
    double low[2], high[2];
    for (int d = 0; d < 2; d++) {
        low[d] = at[d][0];
        high[d] = at[d][ALONG - 1];
    }
    if (nodes->cylinders) home = ref_cylinders_at(nodes->cylinders, low);
    for (long n = 0; n < nodes->count + nodes->images; n++) {
        const double *node = nodes->position[n], reach = nodes->reach[n];
        if (nodes->cylinders && nodes->home[n] != home) continue;
        const bool near[] = {low[0] - node[0] < reach, node[0] - high[0] < reach,
                             low[1] - node[1] < reach, node[1] - high[1] < reach};
        if (!(near[0] & near[1] & near[2] & near[3])) continue; /* one branch, seldom taken */
        if (count == work->room) { /* zeroed: lanes that are no samples stay so */
            long more = sm_room_for(count);
            work->node = sm_widen(work->node, count, more, sizeof *work->node, 0);
            work->member = sm_widen(work->member, count, more, sizeof *work->member, 0);
            work->room = more;
        }
        RefCellNode *of = work->node + count;
        if (!weigh(at, work, n, of)) continue;
        set_ways(at, node, scale, of);
        work->member[count++] = nodes->owner ? nodes->owner[n] : (int)n;
    }
    return count;
}

/* Samples of a cell whose functions are still to be found. */
typedef struct {
    bool is[REF_SAMPLES_PER_CELL];
    int count;
} Pending;

/* The functions of a sample that sees no node, as one beside it sees them: on a crack it may. */
static const RefShape *look_beside(double edge, const RefSamples *samples, int p,
                                   RefSamplesWork *work)
{
    ref_samples_shape(work->nodes, work->basis, edge, samples->theta[p], &work->shape);
    return &work->shape;
}

/* Where each sample's functions begin; and all pending that see a node, of `count`. */
static Pending count_seen(double edge, int count, RefSamplesWork *work, RefSamples *samples)
{
    int seen[REF_SAMPLES_PER_CELL] = {0};
    Pending pending = {.count = 0};
    for (int n = 0; n < count; n++)
        for (int p = 0; p < REF_SAMPLES_PER_CELL; p++) seen[p] += work->node[n].weight[0][p] > 0;
    for (int p = 0; p < REF_SAMPLES_PER_CELL; p++) {
        pending.is[p] = seen[p] > 0;
        pending.count += pending.is[p];
        samples->start[p + 1] = samples->start[p] + seen[p];
        if (!pending.is[p]) samples->start[p + 1] += look_beside(edge, samples, p, work)->count;
    }
    return pending;
}

/* Of those that are not pending. */
static void take_others(double edge, const Pending *pending, RefSamplesWork *work,
                        RefSamples *samples)
{
    for (int p = 0; p < REF_SAMPLES_PER_CELL; p++) {
        long at = samples->start[p];
        if (pending->is[p] || samples->start[p + 1] == at) continue;
        const RefShape *shape = look_beside(edge, samples, p, work);
        for (int n = 0; n < shape->count; n++) {
            samples->node[at + n] = shape->node[n];
            ref_samples_part(shape, n, samples->part[at + n]);
        }
    }
}

/* The functions of samples where those of a basis vary no faster than the cell can bear; of the
 * last basis all, but without slopes where they do. */
static void take_basis(RefBasis basis, bool last, double edge, int count, RefSamplesWork *work,
                       Pending *pending, RefSamples *samples)
{
    RefCellFound found;
    bool take[REF_SAMPLES_PER_CELL], serve[REF_SAMPLES_PER_CELL];
    long at[REF_SAMPLES_PER_CELL];
    ref_cell_functions.shape((int)basis, count, edge, work->node, &found);
    for (int p = 0; p < REF_SAMPLES_PER_CELL; p++) {
        serve[p] = found.pivot[p] > REF_LEAST_PIVOT && found.most[0][p] * edge <= MOST_SLOPE &&
                   found.most[1][p] * edge * edge <= MOST_SECOND;
        take[p] = pending->is[p] && (serve[p] || last);
        pending->is[p] = pending->is[p] && !take[p];
        pending->count -= take[p];
        at[p] = samples->start[p];
    }
    for (int n = 0; n < count; n++)
        for (int p = 0; p < REF_SAMPLES_PER_CELL; p++) {
            const RefCellNode *of = work->node + n;
            if (!take[p] || !(of->weight[0][p] > 0)) continue;
            double part[REF_CELL_PARTS] = {of->part[0][p]};
            for (int k = 1; serve[p] && k < REF_CELL_PARTS; k++) part[k] = of->part[k][p];
            memcpy(samples->part[at[p]], part, sizeof part);
            samples->node[at[p]++] = work->member[n];
        }
}

void ref_samples_of(const RefQuadtree *tree, long cell, double edge, RefSamplesWork *work,
                    RefSamples *samples)
{
    const RefBasis bases[] = {work->basis, REF_MLS_PLANE_LINEAR, REF_MLS_PLANE_CONSTANT};
    double at[2][ALONG], low[2], high[2], margin = work->cracks->margin;
    *samples = create(REF_SAMPLES_PER_CELL);
    place(tree, cell, samples);
    ref_samples_grid(tree, cell, at);
    for (int d = 0; d < 2; d++) {
        low[d] = at[d][0] - margin;
        high[d] = at[d][ALONG - 1] + margin;
    }
    ref_cracks_look(work->cracks, low, high);
    int count = gather((const double(*)[ALONG])at, edge, work);
    Pending pending = count_seen(edge, count, work, samples);
    size_t all = (size_t)samples->start[REF_SAMPLES_PER_CELL];
    samples->node = sm_realloc(NULL, all, sizeof *samples->node);
    samples->part = sm_realloc(NULL, all, sizeof *samples->part);
    take_others(edge, &pending, work, samples);
    for (int n = work->basis == bases[1]; n < 3 && pending.count; n++)
        take_basis(bases[n], n == 2, edge, count, work, &pending, samples);
}

SmCode ref_samples_take(const RefQuadtree *tree, RefNodes *nodes, RefBasis basis,
                        RefSamples *samples, SmError *error)
{
    long points = tree->leaves * REF_SAMPLES_PER_CELL;
    *samples = create(points);
    for (long c = 0; c < tree->count; c++)
        if (tree->cell[c].child < 0) place(tree, c, samples);
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
