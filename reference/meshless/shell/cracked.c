#include "cracked.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../../../lib/vector.h"
#include "field_transfer.h"

enum { SHARE_POINTS = 8 }; /* along a cover's edge */
/* Functions that give a surface more than so many times its area have it far from where it is. */
static const double MOST_AREA = 4;

static bool terminal(const RefCracked *cracked, long c)
{
    return cracked->shell->tree.cell[c].child < 0;
}

static double edge_of(const RefCracked *cracked, long c)
{
    return ref_quadtree_edge(&cracked->shell->tree, cracked->shell->tree.cell + c);
}

static void forget_cell(RefCrackedCell *cell)
{
    ref_samples_free(&cell->samples);
    ref_element_free(&cell->element);
}

void ref_cracked_free(RefCracked *cracked)
{
    for (long c = 0; cracked->cell && c < cracked->shell->tree.count; c++)
        forget_cell(cracked->cell + c);
    if (cracked->shell) {
        cracked->shell->nodes.cut = (RefCut){NULL, NULL};
        cracked->shell->functions = (RefShellFunctions){NULL, NULL, NULL};
        free(cracked->shell->up);
        cracked->shell->up = NULL;
    }
    ref_cracks_free(&cracked->cracks);
    ref_cracks_free(&cracked->cracks_before);
    ref_nodes_free(&cracked->whole);
    sm_free_all(cracked->cell, cracked->seen, cracked->whole_X, cracked->whole_above);
    *cracked = (RefCracked){.shell = NULL};
}

/* The cells' nodes, in the order of ref_quadtree_nodes(). */
static void number_nodes(RefCracked *cracked)
{
    const RefShell *shell = cracked->shell;
    double theta[REF_MOST_CELL_NODES][3], reach[REF_MOST_CELL_NODES];
    int next = 0;
    for (long c = 0; c < shell->tree.count; c++) {
        RefCrackedCell *cell = cracked->cell + c;
        RefNodes own = {.position = theta, .reach = reach};
        if (!terminal(cracked, c)) continue;
        ref_quadtree_add_nodes(&shell->tree, shell->tree.cell + c, 1, &own);
        cell->whole = (int)c;
        cell->reach = shell->nodes.reach[next];
        cell->nodes = (int)own.count;
        for (int n = 0; n < cell->nodes; n++) cell->node[n] = next++;
    }
}

/* How far parameters of the middle surface are from it: half a curvature times a cell's square; and
 * its normals. */
static void find_above(RefCracked *cracked)
{
    const RefNodes *whole = &cracked->whole;
    RefShape shape = ref_shape_create(whole);
    cracked->whole_above = sm_alloc((size_t)whole->count, sizeof *cracked->whole_above);
    cracked->shell->up = sm_alloc((size_t)whole->count, sizeof *cracked->shell->up);
    for (long n = 0; n < whole->count; n++) {
        if (!ref_mls_at(whole, cracked->shell->basis, whole->position[n], &shape)) continue;
        RefFrame frame = ref_middle_of((const double(*)[3])cracked->whole_X, &shape);
        sm_subtract(cracked->whole_X[n], frame.x, cracked->whole_above[n]);
        memcpy(cracked->shell->up[n], frame.normal, sizeof frame.normal);
    }
    ref_shape_free(&shape);
}

/* Place, area and normal of the whole shell's middle surface; where functions are not defined,
 * place and area of the chart's, which that was fitted to. */
static RefFrame whole_at(const RefCracked *cracked, const double theta[3], RefShape *whole)
{
    const RefChart *chart = &cracked->shell->chart;
    RefFrame frame = {.area = 0};
    if (ref_mls_at(&cracked->whole, cracked->shell->basis, theta, whole))
        return ref_middle_of((const double(*)[3])cracked->whole_X, whole);
    double L = chart->factor(chart->data, theta);
    chart->place(chart->data, theta, frame.x);
    frame.area = L * L;
    return frame;
}

/* The areas of a cell's samples are those of the whole shell. */
static void find_areas(const RefCracked *cracked, RefShape *whole, RefSamples *samples)
{
    for (long p = 0; p < samples->count; p++) {
        double area = whole_at(cracked, samples->theta[p], whole).area;
        samples->trace[p] = 2 / area; /* as if the map were conformal: see cracked.h */
        samples->area[p] = area * samples->weight[p];
    }
}

_Static_assert((int)REF_SAMPLES_PER_CELL < 64, "a bit each, and one beyond");
static uint64_t find_bearing(const RefSamples *samples)
{
    uint64_t bears = 0;
    for (int n = 0; n < REF_SAMPLES_PER_CELL; n++) {
        const RefFrame *frame = samples->frame + n;
        double area = samples->area[n] / samples->weight[n];
        bool does =
            frame->area < MOST_AREA * area && ref_thin_is_stiff(frame, area, samples->trace[n]);
        bears |= (uint64_t)does << n;
    }
    return bears;
}

/* A node that no sample sees gets means of the others' mass and stiffness, so that it is no
 * singularity. */
static void bear_unseen(RefCracked *cracked, RefPairs *pairs)
{
    double mass = 0, stiffness = 0;
    cracked->seen = sm_realloc(cracked->seen, (size_t)pairs->count, sizeof *cracked->seen);
    for (long n = 0; n < pairs->count; n++) {
        mass += pairs->mass[pairs->start[n]] / (double)pairs->count;
        stiffness += pairs->block[pairs->start[n]][0] / (double)pairs->count;
    }
    for (long n = 0; n < pairs->count; n++) {
        long at = pairs->start[n];
        cracked->seen[n] = pairs->mass[at] > 0;
        if (cracked->seen[n]) continue;
        pairs->mass[at] = mass;
        for (int d = 0; d < 3; d++) pairs->block[at][4 * d] += stiffness;
    }
}

static void add_up(RefCracked *cracked)
{
    RefShell *shell = cracked->shell;
    RefPairs pairs = ref_pairs_begin(shell->nodes.count);
    for (int n = 0; n < (int)pairs.count; n++) ref_pairs_add(&pairs, n, 1, &n);
    for (long c = 0; c < shell->tree.count; c++)
        ref_element_meet(&cracked->cell[c].element, &pairs);
    ref_pairs_end(&pairs);
    for (long c = 0; c < shell->tree.count; c++) ref_element_add(&cracked->cell[c].element, &pairs);
    bear_unseen(cracked, &pairs);
    ref_matrices_free(&shell->matrices);
    ref_pairs_matrices(&pairs, cracked->options.material.density, &shell->matrices);
    ref_pairs_free(&pairs);
}

static void count_all(RefCracked *cracked)
{
    RefCrackedCounts *counts = &cracked->counts;
    counts->blind = counts->soft = 0;
    for (long c = 0; c < cracked->shell->tree.count; c++) {
        const RefSamples *samples = &cracked->cell[c].samples;
        if (terminal(cracked, c)) counts->soft += cracked->cell[c].soft;
        for (long p = 0; p < samples->count; p++)
            counts->blind += samples->start[p + 1] == samples->start[p];
    }
}

/* The nearest that no crack parts from a place, of all or of those that bear it; -1: none is. */
static int nearest_unparted(const RefCracked *cracked, long c, bool all, const double theta[2])
{
    const RefCrackedCell *cell = cracked->cell + c;
    double far[REF_SAMPLES_PER_CELL];
    uint64_t left = all ? (1ULL << REF_SAMPLES_PER_CELL) - 1 : cell->bears;
    for (int n = 0; n < REF_SAMPLES_PER_CELL; n++) {
        double x = cell->samples.theta[n][0] - theta[0], y = cell->samples.theta[n][1] - theta[1];
        far[n] = x * x + y * y;
    }
    while (left) { /* the nearest that is left: few are parted, and to find that takes longest */
        int best = __builtin_ctzll(left);
        for (uint64_t more = left & (left - 1); more; more &= more - 1)
            if (far[__builtin_ctzll(more)] < far[best]) best = __builtin_ctzll(more);
        if (!ref_cracks_part(&cracked->cracks, theta, cell->samples.theta[best])) return best;
        left &= ~(1ULL << best);
    }
    return -1;
}

int ref_cracked_sample(const RefCracked *cracked, long c, const double theta[2])
{
    const RefSamples *samples = &cracked->cell[c].samples;
    const RefQuadtree *tree = &cracked->shell->tree;
    double middle[2], edge[2];
    ref_quadtree_cell(tree, tree->cell + c, middle, edge);
    int nearest = ref_samples_nearest(middle, edge, theta);
    const double *there = samples->theta[nearest];
    if (there[0] == theta[0] && there[1] == theta[1]) return nearest;
    if (ref_cracked_bears(cracked, c, nearest) && !ref_cracks_part(&cracked->cracks, theta, there))
        return nearest;
    int best = nearest_unparted(cracked, c, false, theta);
    return best >= 0 ? best : nearest_unparted(cracked, c, true, theta);
}

/* The functions at any place, from the samples' beside it. */
static int functions_at(const void *kept, const double theta[3], RefShape *shape)
{
    const RefCracked *cracked = kept;
    const RefShell *shell = cracked->shell;
    int c = ref_quadtree_at(&shell->tree, theta), n = ref_cracked_sample(cracked, c, theta);
    if (n < 0)
        return ref_samples_shape(&shell->nodes, shell->basis, edge_of(cracked, c), theta, shape);
    ref_samples_expand(&cracked->cell[c].samples, n, theta, shape);
    return shape->count ? (int)shell->basis : 0;
}

static const RefSamples *samples_of(const void *kept, long cell)
{
    return &((const RefCracked *)kept)->cell[cell].samples;
}

bool ref_cracked_side(const RefCracked *cracked, const double theta[2], const double eye[2],
                      RefShape *shape)
{
    int c = ref_quadtree_at(&cracked->shell->tree, eye), n = ref_cracked_sample(cracked, c, eye);
    if (n < 0) return false;
    ref_samples_expand(&cracked->cell[c].samples, n, theta, shape);
    return shape->count > 0;
}

bool ref_cracked_seen(const RefCracked *cracked, long node)
{
    return cracked->seen[node];
}

int ref_cracked_node(const RefCracked *cracked, const double theta[2])
{
    int c = ref_quadtree_at(&cracked->shell->tree, theta),
        n = ref_cracked_sample(cracked, c, theta);
    const RefSamples *samples = &cracked->cell[c].samples;
    return n < 0 || samples->start[n] == samples->start[n + 1] ? -1
                                                               : samples->node[samples->start[n]];
}

void ref_cracked_press(const RefCracked *cracked, double pressure, double (*force)[3])
{
    for (long c = 0; c < cracked->shell->tree.count; c++)
        ref_middle_press(&cracked->cell[c].samples, pressure, force);
}

/* Takes and sums up all samples. Cells that `old` (or NULL) has samples of keep their areas. */
static void make_all(RefCracked *cracked, const RefSamples *old)
{
    RefShell *shell = cracked->shell;
    RefSamplesWork take = ref_samples_work(&shell->nodes, shell->basis, &cracked->cracks);
    RefShape whole = ref_shape_create(&cracked->whole);
    RefThinWork work = ref_thin_work(shell->nodes.count);
    for (long c = 0; c < shell->tree.count; c++) {
        RefCrackedCell *cell = cracked->cell + c;
        RefSamples *samples = &cell->samples;
        if (!terminal(cracked, c)) {
            forget_cell(cell);
            cell->nodes = 0;
            continue;
        }
        ref_samples_of(&shell->tree, c, edge_of(cracked, c), &take, samples);
        if (old && old[c].count) {
            memcpy(samples->area, old[c].area, REF_SAMPLES_PER_CELL * sizeof *samples->area);
            memcpy(samples->trace, old[c].trace, REF_SAMPLES_PER_CELL * sizeof *samples->trace);
        } else
            find_areas(cracked, &whole, samples);
        ref_middle_frames((const double(*)[3])shell->X, samples);
        cell->bears = find_bearing(samples);
        cell->soft = ref_thin_element(samples, 0, cracked->options.thickness,
                                      &cracked->options.material, &work, &cell->element);
    }
    add_up(cracked);
    count_all(cracked);
    ref_thin_work_free(&work);
    ref_samples_work_free(&take);
    ref_shape_free(&whole);
}

/* The cracks become those of the functions. */
static void settle(RefCracked *cracked)
{
    ref_cracks_free(&cracked->cracks_before);
    cracked->cracks_before = ref_cracks_copy(&cracked->cracks);
}

void ref_cracked_create(RefShell *shell, const RefShellOptions *options,
                        const RefCrackedOptions *cracked_options, RefCracked *cracked)
{
    size_t nodes = (size_t)shell->nodes.count;
    double margin = 0;
    *cracked = (RefCracked){.shell = shell, .options = *options, .cracked = *cracked_options};
    cracked->cell = sm_alloc((size_t)shell->tree.count, sizeof *cracked->cell);
    cracked->cell_room = shell->tree.count;
    for (size_t n = 0; n < nodes; n++) margin = fmax(margin, shell->nodes.reach[n]);
    ref_cracks_create(&shell->chart, margin, &cracked->cracks);
    cracked->whole = ref_nodes_copy(&shell->nodes);
    cracked->whole_X = sm_copy(shell->X, nodes, sizeof *shell->X);
    number_nodes(cracked);
    find_above(cracked);
    shell->nodes.cut = (RefCut){ref_cracks_pass, &cracked->cracks};
    make_all(cracked, NULL);
    settle(cracked);
    shell->functions = (RefShellFunctions){functions_at, samples_of, cracked};
}

/* The share of its own weight that a cell's node gets from its cover, as far as this is on the
 * surface. */
static double share_of(const RefCracked *cracked, long c)
{
    const RefShell *shell = cracked->shell;
    double middle[3] = {0}, edge[2], reach = cracked->cell[c].reach, got = 0, all = 0;
    ref_quadtree_cell(&shell->tree, shell->tree.cell + c, middle, edge);
    for (int n = 0; n < SHARE_POINTS * SHARE_POINTS; n++) {
        const int which[2] = {n % SHARE_POINTS, n / SHARE_POINTS};
        double theta[3] = {0}, end[2] = {middle[0], middle[1]}, way[2], weight = 1, slope[2];
        double part[6];
        for (int d = 0; d < 2; d++) {
            double s = (2 * which[d] + 1.0) / SHARE_POINTS - 1;
            way[d] = s * reach;
            theta[d] = middle[d] + way[d];
            weight *= ref_mls_spline(s, slope);
        }
        if (!ref_chart_walk(&shell->chart, end, way)) continue;
        all += weight;
        if (ref_cracks_pass(&cracked->cracks, middle, theta, reach, part)) got += weight * part[0];
    }
    return got / all;
}

/* Makes room for new cells, which are parts of others. */
static void inherit(RefCracked *cracked, long from)
{
    const RefQuadtree *tree = &cracked->shell->tree;
    if (tree->count > cracked->cell_room) {
        cracked->cell =
            sm_widen(cracked->cell, cracked->cell_room, 2 * tree->count, sizeof *cracked->cell, 0);
        cracked->cell_room = 2 * tree->count;
    }
    for (long p = 0; p < tree->count; p++) {
        const RefCrackedCell *parent = cracked->cell + p;
        for (int k = 0; tree->cell[p].child >= from && k < 4; k++)
            cracked->cell[tree->cell[p].child + k] =
                (RefCrackedCell){.whole = parent->whole,
                                 .splits = parent->splits + 1,
                                 .reach = parent->reach / 2,
                                 .from = parent->nodes ? (int)p : parent->from};
    }
}

/* Whether a cover has a zero on its sides. The surface is not smooth over the plane
 * there, so that new nodes' parameters would be off; and cells there are finer already. With splits
 * a crack through a zero made three times as many samples soft. */
static bool has_zero(const RefChart *chart, const double low[2], const double high[2])
{
    return chart->cylinders && ref_cylinders_zero(chart->cylinders, low, high);
}

/* Splits cells whose node gets too little, but about zeros; what others get is no matter. Returns
 * how many cells were terminal and are no more. */
static long split_cells(RefCracked *cracked)
{
    RefQuadtree *tree = &cracked->shell->tree;
    long before = tree->count;
    for (long c = 0; c < tree->count; c++) {
        double middle[2], edge[2], low[2], high[2], reach = cracked->cell[c].reach;
        long count = tree->count;
        if (!terminal(cracked, c) || cracked->cell[c].splits >= cracked->cracked.most_splits)
            continue;
        ref_quadtree_cell(tree, tree->cell + c, middle, edge);
        for (int d = 0; d < 2; d++) {
            low[d] = middle[d] - reach;
            high[d] = middle[d] + reach;
        }
        if (!ref_cracks_look(&cracked->cracks, low, high)) continue;
        if (has_zero(&cracked->shell->chart, low, high)) continue;
        if (share_of(cracked, c) >= cracked->cracked.least_share) continue;
        if (ref_quadtree_split(tree, c)) inherit(cracked, count);
    }
    return (tree->count - before) / 4;
}

/* A new node in the plane: parameters of the middle surface as those of the whole shell are, above
 * it by what is left of half the curvature times the square of its cell; and the normal. */
static void place_parameter(RefCracked *cracked, const RefCrackedCell *cell, int node,
                            RefShape *whole)
{
    const RefShell *shell = cracked->shell;
    const double *above = cracked->whole_above[cracked->cell[cell->whole].node[0]];
    const RefFrame frame = whole_at(cracked, shell->nodes.position[node], whole);
    for (int d = 0; d < 3; d++) shell->X[node][d] = frame.x[d] + ldexp(above[d], -2 * cell->splits);
    memcpy(shell->up[node], frame.normal, sizeof frame.normal);
}

/* Nodes of cells that were split make way for those of new cells, which are marked in `fresh`
 * ([nodes], the caller's to free). */
static unsigned char *move_nodes(RefCracked *cracked)
{
    RefShell *shell = cracked->shell;
    RefQuadtree *tree = &shell->tree;
    RefNodes *nodes = &shell->nodes;
    long free_count = 0, old = nodes->count;
    size_t most = (size_t)old + REF_MOST_CELL_NODES * (size_t)tree->leaves;
    int *vacant = sm_alloc((size_t)old, sizeof *vacant);
    unsigned char *fresh = sm_alloc(most, 1);
    nodes->position = sm_realloc(nodes->position, most, sizeof *nodes->position);
    nodes->reach = sm_realloc(nodes->reach, most, sizeof *nodes->reach);
    shell->X = sm_realloc(shell->X, most, sizeof *shell->X);
    shell->up = sm_realloc(shell->up, most, sizeof *shell->up);
    for (long c = 0; c < tree->count; c++)
        for (int n = 0; !terminal(cracked, c) && n < cracked->cell[c].nodes; n++)
            vacant[free_count++] = cracked->cell[c].node[n];
    for (long c = 0; c < tree->count; c++) {
        RefCrackedCell *cell = cracked->cell + c;
        double theta[REF_MOST_CELL_NODES][3] = {{0}}, reach[REF_MOST_CELL_NODES];
        RefNodes own = {.position = theta, .reach = reach};
        if (!terminal(cracked, c) || cell->nodes) continue;
        ref_quadtree_add_nodes(tree, tree->cell + c, 1, &own);
        cell->nodes = (int)own.count;
        for (int n = 0; n < cell->nodes; n++) {
            int node = free_count ? vacant[--free_count] : (int)nodes->count++;
            memcpy(nodes->position[node], theta[n], sizeof theta[n]);
            nodes->reach[node] = cell->reach;
            cell->node[n] = node;
            fresh[node] = 1;
        }
    }
    free(vacant);
    ref_nodes_bin(nodes);
    return fresh;
}

/* Parameters of new nodes. */
static void fill_nodes(RefCracked *cracked, const unsigned char *fresh, RefFieldsBefore *before,
                       const RefCrackedFields *fields)
{
    RefShape whole = ref_shape_create(&cracked->whole);
    for (long c = 0; c < cracked->shell->tree.count; c++) {
        const RefCrackedCell *cell = cracked->cell + c;
        for (int n = 0; terminal(cracked, c) && n < cell->nodes; n++) {
            if (!fresh[cell->node[n]]) continue;
            place_parameter(cracked, cell, cell->node[n], &whole);
            if (fields) ref_fields_place(cracked, cell, cell->node[n], before, fields);
        }
    }
    ref_shape_free(&whole);
}

/* Room for new nodes; residuals are zero. */
static void widen_fields(long before, long nodes, const RefCrackedFields *fields)
{
    size_t size = 3 * (size_t)nodes;
    for (int f = 0; f < fields->count; f++)
        fields->field[f] = sm_widen(fields->field[f], 3 * before, (long)size, sizeof(double), 0);
    for (int f = 0; f < 2; f++) {
        fields->residual[f] = sm_realloc(fields->residual[f], size, sizeof(double));
        memset(fields->residual[f], 0, size * sizeof(double));
    }
}

void ref_cracked_update(RefCracked *cracked, const RefCrackedFields *fields)
{
    RefShell *shell = cracked->shell;
    assert(!fields || fields->count >= 2);
    RefFieldsBefore before = ref_fields_before(cracked, fields);
    cracked->counts = (RefCrackedCounts){.split = split_cells(cracked)};
    unsigned char *fresh = move_nodes(cracked);
    if (fields) widen_fields(before.nodes.count, shell->nodes.count, fields);
    fill_nodes(cracked, fresh, &before, fields);
    ref_fields_take_samples(cracked, &before);
    make_all(cracked, before.samples);
    if (fields) ref_fields_residuals(cracked, &before, fields);
    for (long n = 0; n < shell->nodes.count; n++) /* nodes that nothing sees are at rest */
        for (int f = 0; fields && f < fields->count && !ref_cracked_seen(cracked, n); f++)
            memset(fields->field[f] + 3 * n, 0, sizeof(double[3]));
    settle(cracked);
    ref_fields_before_free(&before);
    free(fresh);
}

RefCrackedSaved ref_cracked_save(const RefCracked *cracked)
{
    const RefShell *shell = cracked->shell;
    size_t cells = (size_t)shell->tree.count;
    RefCrackedSaved saved = {.cells = shell->tree.count,
                             .leaves = shell->tree.leaves,
                             .tree = sm_copy(shell->tree.cell, cells, sizeof *shell->tree.cell),
                             .cell = sm_copy(cracked->cell, cells, sizeof *cracked->cell),
                             .nodes = ref_nodes_copy(&shell->nodes),
                             .X = sm_copy(shell->X, (size_t)shell->nodes.count, sizeof *shell->X),
                             .up =
                                 sm_copy(shell->up, (size_t)shell->nodes.count, sizeof *shell->up),
                             .cracks = ref_cracks_copy(&cracked->cracks_before)};
    for (size_t c = 0; c < cells; c++) {
        saved.cell[c].samples = (RefSamples){.count = 0};
        saved.cell[c].element = (RefElement){.count = 0};
    }
    return saved;
}

void ref_cracked_saved_free(RefCrackedSaved *saved)
{
    ref_nodes_free(&saved->nodes);
    ref_cracks_free(&saved->cracks);
    sm_free_all(saved->tree, saved->cell, saved->X, saved->up);
    *saved = (RefCrackedSaved){.cells = 0};
}

void ref_cracked_restore(RefCracked *cracked, RefCrackedSaved *saved)
{
    RefShell *shell = cracked->shell;
    for (long c = 0; c < shell->tree.count; c++) forget_cell(cracked->cell + c);
    memcpy(shell->tree.cell, saved->tree, (size_t)saved->cells * sizeof *saved->tree);
    memcpy(cracked->cell, saved->cell, (size_t)saved->cells * sizeof *saved->cell);
    shell->tree.count = saved->cells;
    shell->tree.leaves = saved->leaves;
    ref_nodes_free(&shell->nodes);
    shell->nodes = saved->nodes;
    sm_free_all(shell->X, shell->up);
    shell->X = saved->X;
    shell->up = saved->up;
    ref_cracks_free(&cracked->cracks);
    cracked->cracks = saved->cracks;
    make_all(cracked, NULL);
    settle(cracked);
    sm_free_all(saved->tree, saved->cell);
    *saved = (RefCrackedSaved){.cells = 0};
}
