#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../../lib/system/clock.h"
#include "../../reference/meshless/shell_engine.h"
#include "../check/shell_check.h"
#include "../scene/map.h"
#include "experiments.h"

#define CONST(array) ((const double(*)[3])(array))

static SmCode open_map(const BenchExperiment *of, RefSurfaceMap *map, SmError *error)
{
    if (strcmp(of->scene->engine, ref_shell_engine.name) != 0)
        return sm_fail(error, SM_INPUT, "'%.60s' is no shell", of->scene->name);
    return ref_surface_map_create(&of->body->mesh, false, of->scene->name, map, error);
}

/* ---- cells */

/* Of places in the cell, five by five with its sides and its middle, the fewest nodes that have one
 * inside their covers. */
static int fewest_covers(const RefQuadtree *tree, const RefCell *cell, const RefNodes *nodes)
{
    enum { ALONG = 5 };
    double middle[2], edge[2];
    int fewest = INT_MAX;
    ref_quadtree_cell(tree, cell, middle, edge);
    for (int n = 0; n < ALONG * ALONG; n++) {
        double x[2] = {middle[0] + edge[0] * (n % ALONG / (ALONG - 1.0) - 0.5),
                       middle[1] + edge[1] * (n / ALONG / (ALONG - 1.0) - 0.5)};
        int covers = 0;
        for (long k = 0; k < nodes->count + nodes->images; k++)
            covers += fabs(x[0] - nodes->position[k][0]) < nodes->reach[k] &&
                      fabs(x[1] - nodes->position[k][1]) < nodes->reach[k];
        if (covers < fewest) fewest = covers;
    }
    return fewest;
}

/* With covers three edges wide, as the paper's are. */
static int least_covers(const RefQuadtree *tree)
{
    RefNodes nodes;
    int least = INT_MAX;
    ref_quadtree_nodes(tree, 3, &nodes);
    for (long c = 0; c < tree->count; c++) {
        if (tree->cell[c].child >= 0) continue;
        int fewest = fewest_covers(tree, tree->cell + c, &nodes);
        if (fewest < least) least = fewest;
    }
    ref_nodes_free(&nodes);
    return least;
}

SmCode bench_shell_cells(const BenchExperiment *of, SmError *error)
{
    int wanted[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, wanted);
    bool covers = !strcmp(of->measure->field, "least-covers");
    RefSurfaceMap map;
    SmCode code = open_map(of, &map, error);
    if (code) return code;
    for (int c = 0; c < count && !code; c++) {
        RefQuadtree tree;
        code = ref_quadtree_of(&map.chart, 0, wanted[c], &tree, error);
        if (code) break;
        bench_curve_exact(of->curve, (double)tree.leaves,
                          covers ? least_covers(&tree) : 100 * bench_map_spread(&tree));
        ref_quadtree_free(&tree);
    }
    ref_surface_map_free(&map);
    return code;
}

/* ---- seam */

/* A chart whose seam lies half a side farther along its first axis: its place theta is the other's
 * theta + half a side. What closes around that axis has the same seams then. */
static double moved_on(const RefChart *chart, double theta)
{
    double half = (chart->high[0] - chart->low[0]) / 2;
    return theta + (theta < chart->low[0] + half ? half : -half);
}

static double moved_factor(const void *data, const double theta[2])
{
    const RefChart *chart = data;
    return chart->factor(chart->data, (double[]){moved_on(chart, theta[0]), theta[1]});
}

static void moved_place(const void *data, const double theta[2], double x[3])
{
    const RefChart *chart = data;
    chart->place(chart->data, (double[]){moved_on(chart, theta[0]), theta[1]}, x);
}

/* Of a box that the other's seam may cut. */
static double moved_mean(const void *data, const double low[2], const double high[2])
{
    const RefChart *chart = data;
    double middle = (chart->low[0] + chart->high[0]) / 2, half = middle - chart->low[0], sum = 0;
    for (int part = 0; part < 2; part++) {
        double from = part ? fmax(low[0], middle) : low[0];
        double to = part ? high[0] : fmin(high[0], middle), on = part ? -half : half;
        if (!(from < to)) continue;
        double mean =
            chart->mean(chart->data, (double[]){from + on, low[1]}, (double[]){to + on, high[1]});
        sum += mean * mean * (to - from);
    }
    return sqrt(sum / (high[0] - low[0]));
}

static long find_node(const RefNodes *nodes, const double theta[2], double tolerance)
{
    for (long n = 0; n < nodes->count; n++)
        if (fabs(nodes->position[n][0] - theta[0]) < tolerance &&
            fabs(nodes->position[n][1] - theta[1]) < tolerance)
            return n;
    return -1;
}

/* Which of the other shell's nodes is at the same place of the surface; false where one has none.
 */
static bool match_nodes(const RefShell *shell, const RefShell *other, long *match)
{
    const RefChart *chart = &shell->chart;
    double tolerance = 1e-9 * (chart->high[0] - chart->low[0]);
    bool all = shell->nodes.count == other->nodes.count;
    for (long n = 0; n < shell->nodes.count && all; n++) {
        const double *at = shell->nodes.position[n];
        match[n] = find_node(&other->nodes, (double[]){moved_on(chart, at[0]), at[1]}, tolerance);
        all = match[n] >= 0;
    }
    return all;
}

static double *dense(const RefSparse *sparse)
{
    size_t n = (size_t)sparse->columns;
    double *full = sm_alloc(n * n, sizeof *full);
    for (size_t c = 0; c < n; c++)
        for (int e = sparse->start[c]; e < sparse->start[c + 1]; e++)
            full[n * c + (size_t)sparse->row[e]] = full[n * (size_t)sparse->row[e] + c] =
                sparse->value[e];
    return full;
}

/* The largest difference of entries, by the roots of their diagonals. */
static double difference(const RefShell *shell, const RefShell *other, const long *match)
{
    double *a = dense(&shell->matrices.stiffness), *b = dense(&other->matrices.stiffness), most = 0;
    size_t n = 3 * (size_t)shell->nodes.count;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            size_t k = 3 * (size_t)match[i / 3] + i % 3, l = 3 * (size_t)match[j / 3] + j % 3;
            most =
                fmax(most, fabs(a[n * i + j] - b[n * k + l]) / sqrt(a[n * i + i] * a[n * j + j]));
        }
    sm_free_all(a, b);
    return most;
}

static SmCode compare_shells(const BenchExperiment *of, const RefChart *chart, SmError *error)
{
    RefMeshlessOptions options = bench_meshless_options(of->scene, of->body);
    SmBox box = sm_box_around(of->body->mesh.vertex_count, CONST(of->body->mesh.position));
    RefShellOptions wanted = ref_shell_options(&options, sm_box_longest(&box));
    RefChart moved = *chart;
    RefShell shell, other;
    moved.factor = moved_factor;
    moved.place = moved_place;
    moved.mean = moved_mean;
    moved.data = chart;
    SmCode code = ref_shell_build(chart, &wanted, &shell, error);
    if (code) return code;
    code = ref_shell_build(&moved, &wanted, &other, error);
    if (!code) {
        long *match = sm_alloc((size_t)shell.nodes.count, sizeof *match);
        if (match_nodes(&shell, &other, match))
            bench_curve_exact(of->curve, 0, 1e6 * difference(&shell, &other, match));
        else
            bench_curve_fail(of->curve, "nodes are at other places where the seam is moved");
        free(match);
        ref_shell_free(&other);
    }
    ref_shell_free(&shell);
    return code;
}

SmCode bench_shell_seam(const BenchExperiment *of, SmError *error)
{
    RefSurfaceMap map;
    SmCode code = open_map(of, &map, error);
    if (code) return code;
    if (map.kind == REF_MAP_DISK)
        code = sm_fail(error, SM_INPUT, "'%.60s' is a sheet, without a seam", of->scene->name);
    else if (map.chart.cylinders)
        code = sm_fail(
            error, SM_INPUT,
            "'%.60s' has several handles or holes, whose seams are where its form's zeros are",
            of->scene->name);
    else
        code = compare_shells(of, &map.chart, error);
    ref_surface_map_free(&map);
    return code;
}

/* ---- frames */

/* Frames of a shell that moves, after some that are not timed; then it is checked. */
static void time_frames(const BenchExperiment *of, BenchRunner *runner, int points)
{
    int repeats = bench_lab_repeats(of->lab), steps = of->scene->steps_per_frame;
    double *ms = sm_alloc((size_t)repeats, sizeof *ms);
    BenchElasticFound found = {.looked = 0};
    char reason[160];
    for (int r = -repeats / 2; r < repeats; r++) {
        double start = sm_now();
        for (int s = 0; s < steps; s++) bench_runner_step(runner);
        if (r >= 0) ms[r] = 1e3 * (sm_now() - start);
    }
    const RefShellBody *body = ref_shell_body(runner->engine);
    bench_curve_sample(of->curve, (double)body->sheet.warp.nodes, ms, repeats, BENCH_LOW, points);
    bench_shell_check_body(body, &found);
    bench_shell_check_state(runner, &found);
    if (!bench_elastic_verdict(&found, sizeof reason, reason))
        bench_curve_fail(of->curve, "%ld nodes: %s", body->sheet.warp.nodes, reason);
    free(ms);
}

SmCode bench_shell_frames(const BenchExperiment *of, SmError *error)
{
    int nodes[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, nodes);
    SmCode code = SM_OK;
    if (strcmp(of->scene->engine, ref_shell_engine.name) != 0 || of->scene->meshless.strength > 0)
        return sm_fail(error, SM_INPUT, "'%.60s' is no shell that stays whole", of->scene->name);
    for (int c = 0; c < count && !code; c++) {
        BenchRunner runner;
        of->scene->meshless.nodes = nodes[c];
        code = bench_runner_exact(of->scene, of->body, &runner, error);
        if (code) break;
        time_frames(of, &runner, count);
        bench_runner_free(&runner);
    }
    return code;
}
