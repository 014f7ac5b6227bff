#include "kernels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/fastlsm.h"
#include "../../fastlsm/operations.h"
#include "../../lib/mesh/embed.h"
#include "../../lib/voxel/voxelise.h"
#include "../../octree/surface/surface.h"
#include "../measure/measure.h"
#include "../measure/spread.h"
#include "change_kernels.h"
#include "cubes.h"
#include "kernel_run.h"
#include "matrices.h"
#include "surfaces.h"
#include "tree_kernels.h"

typedef enum { CUBE, POLAR, SURFACE, SCENE } Kind;
enum { WHOLE_STEP = SM_STAGES, SET_MOST = 8 };

/* A kernel that can be asked for. Neighbours of equal `set` are timed in turn. */
typedef struct {
    const char *name, *group;
    Kind kind;
    int set;
    int side, w;
    SmSummation summation;
    SmPolarMethod polar;
    double damping;
    int stage;    /* which part of the step, or WHOLE_STEP */
    int threads;  /* 0: as asked for */
    bool doubled; /* in double precision, beside single */
    bool large;   /* only by name or with --scaling */
    BenchPolar method;
    BenchSurfaceKernel surface;
    double at_most;   /* ns an item on one core in single precision; 0: no limit */
    const char *base; /* the kernel of the set that `ratio` refers to */
    double wanted;
} Spec;

#define SUM_OF(method, summ, width)                                                                \
    {                                                                                              \
        .name = "sum-" method "-w" #width, .group = "sum", .kind = CUBE, .set = width, .side = 32, \
        .w = width, .summation = summ, .stage = SM_FAST_SUM                                        \
    }
#define SUMS_OF(width)                                                                             \
    SUM_OF("naive", SM_SUM_NAIVE, width), SUM_OF("bars", SM_SUM_BARS, width),                      \
        SUM_OF("fast", SM_SUM_FAST, width)
#define STEP_OF(label, of_group, number, n, width)                                                 \
    .name = (label), .group = (of_group), .kind = CUBE, .set = (number), .side = (n),              \
    .w = (width), .stage = WHOLE_STEP

static const char speed_up_of[] = "cube64-w1", single_of[] = "cube64-w1", least_of[] = "scale-1e4";

static const Spec specs[] = {
    SUMS_OF(1),
    SUMS_OF(2),
    SUMS_OF(3),
    SUMS_OF(5),
    SUMS_OF(8),
    {"polar-fast", "polar", POLAR, .set = 10, .method = BENCH_POLAR_BATCH},
    {"polar-jacobi-cold", "polar", POLAR, .set = 10, .method = BENCH_POLAR_COLD},
    {"polar-jacobi-warm", "polar", POLAR, .set = 10, .method = BENCH_POLAR_WARM},
    {"polar-robust", "polar", POLAR, .set = 10, .method = BENCH_POLAR_ROBUST},
    {"damping", "damping", CUBE, 11, 64, 1, .damping = 0.1, .stage = SM_DAMPING},
    {"integration", "integration", CUBE, 11, 64, 1, .stage = SM_OTHER},
    {"voxeliser", "voxeliser", SURFACE, .set = 12, .surface = BENCH_VOXELISE},
    {"embedding", "embedding", SURFACE, .set = 12, .surface = BENCH_EMBED},
    {"octree-surface", "embedding", SURFACE, .set = 12, .surface = BENCH_CARRY},
    {STEP_OF("cube32-w1", "cases", 20, 32, 1), .at_most = 8},
    {STEP_OF("cube64-w1", "cases", 21, 64, 1), .at_most = 8},
    {STEP_OF("cube64-w1-2threads", "cases", 21, 64, 1), .threads = 2, .base = speed_up_of,
     .wanted = 1.85},
    {STEP_OF("cube64-w1-double", "cases", 21, 64, 1), .doubled = true, .base = single_of,
     .wanted = 2.2},
    {STEP_OF("cube32-w5", "cases", 22, 32, 5), .at_most = 12},
    {STEP_OF("cube128-w2", "cases", 23, 128, 2), .at_most = 13},
    {STEP_OF("cube64-w1-damping", "cases", 24, 64, 1), .damping = 0.1, .at_most = 15},
    {STEP_OF("cube64-w1-jacobi", "cases", 25, 64, 1), .polar = SM_POLAR_JACOBI},
    {"statue-solid", "cases", SCENE, .set = 30, .at_most = 30},
    {"statue-shell", "cases", SCENE, .set = 31, .at_most = 60},
    {"infant", "cases", SCENE, .set = 32, .at_most = 45},
    {"penguin", "cases", SCENE, .set = 33, .at_most = 50},
    {"penguins", "cases", SCENE, .set = 34, .at_most = 44},
    {"penguins-free", "cases", SCENE, .set = 35, .at_most = 20},
    {STEP_OF("scale-1e4", "scaling", 40, 22, 1)},
    {STEP_OF("scale-1e5", "scaling", 40, 46, 1), .base = least_of, .wanted = 1.25},
    {STEP_OF("scale-1e6", "scaling", 40, 100, 1), .base = least_of, .wanted = 1.25},
    {STEP_OF("scale-1e7", "scaling", 40, 215, 1), .large = true, .base = least_of, .wanted = 1.25},
};
enum { SPECS = sizeof specs / sizeof specs[0] };

typedef BenchKernelRun Run;

const char *bench_kernel_name(int index, const char **group)
{
    if (index >= SPECS) {
        int trees = 0;
        const char *name = bench_tree_kernel_name(index - SPECS, group);
        while (bench_tree_kernel_name(trees, NULL)) trees++;
        return name ? name : bench_change_kernel_name(index - SPECS - trees, group);
    }
    if (index < 0) return NULL;
    if (group) *group = specs[index].group;
    return specs[index].name;
}

bool bench_kernel_known(const char *name)
{
    const char *known, *group;
    for (int i = 0; (known = bench_kernel_name(i, &group)); i++)
        if (!strcmp(name, known) || !strcmp(name, group)) return true;
    return false;
}

static bool chosen(const BenchKernelParams *params, const Spec *spec)
{
    if (spec->doubled && params->precision == BENCH_F64) return false; /* cube64-w1 is it */
    return bench_kernel_chosen(params, spec->name, spec->group, spec->large);
}

static int threads_of(const Run *run, const Spec *spec)
{
    return spec->threads ? spec->threads : run->params->threads;
}

static BenchPrecision precision_of(const Run *run, const Spec *spec)
{
    return spec->doubled ? BENCH_F64 : run->params->precision;
}

static BenchKernel *add_row(Run *run, const Spec *spec, const char *item, long items)
{
    bool doubles = precision_of(run, spec) == BENCH_F64;
    BenchKernel *row = bench_kernel_add(run, spec->name, spec->group, item, items);
    row->w = spec->w;
    row->threads = threads_of(run, spec);
    snprintf(row->precision, sizeof row->precision, "%s", doubles ? "double" : "single");
    if (spec->at_most > 0 && row->threads == 1 && !doubles) row->at_most = spec->at_most;
    return row;
}

/* ---- steps of cubes */

static double state_bytes(BenchPrecision precision)
{
    return lsm_state_bytes(precision == BENCH_F32 ? 4 : 8);
}

static SmOperations work_of(const Spec *spec)
{
    switch (spec->stage) {
    case SM_FAST_SUM:
        return lsm_sum_operations(spec->summation, spec->w, spec->side);
    case SM_DAMPING:
        return lsm_damping_operations();
    case SM_OTHER:
        return lsm_integrate_operations();
    }
    return lsm_step_operations(spec->summation, spec->w, spec->side, spec->damping > 0);
}

/* The median over samples of how this cube compares with `base`, timed just before or after. */
static void set_ratio(const Run *run, const Spec *spec, const BenchCube *cube,
                      const BenchCube *base, BenchKernel *row)
{
    if (!base->valid || !cube->valid) return;
    if (bench_watch_busy(&base->watch)) bench_kernel_busy(row, bench_watch_lost(&base->watch));
    double *ratio = sm_alloc((size_t)cube->repeats, sizeof *ratio);
    row->wanted_least = spec->threads > 1;
    for (int r = 0; r < cube->repeats; r++) {
        ratio[r] = bench_cube_ns(cube, r) / bench_cube_ns(base, r);
        if (row->wanted_least) ratio[r] = 1 / ratio[r]; /* a speed-up */
    }
    row->ratio = bench_spread(ratio, cube->repeats).median;
    free(ratio);
    double bytes = state_bytes(precision_of(run, spec));
    int threads = threads_of(run, spec);
    bool same = bench_level_of(run->peak, bytes * (double)cube->particles, threads) ==
                bench_level_of(run->peak, bytes * (double)base->particles, threads);
    /* the cost may rise where the state outgrows a cache, and a speed-up is over one thread */
    if (row->wanted_least ? run->params->threads == 1 : same) row->wanted = spec->wanted;
    snprintf(row->ratio_to, sizeof row->ratio_to, "%s",
             spec->threads > 1 ? "1 thread"
             : spec->doubled   ? "single"
                               : spec->base);
}

static void note_cube(const BenchCube *cube, const char *level, double state, BenchKernel *row)
{
    int used = snprintf(row->note, sizeof row->note, "state %.3g MB, fits %s", state / 1e6, level);
    if (cube->sweeps > 0)
        used += snprintf(row->note + used, sizeof row->note - (size_t)used, "; %.2f sweeps",
                         cube->sweeps);
    if (!cube->brute)
        snprintf(row->note + used, sizeof row->note - (size_t)used,
                 "; checked: finite, momentum only");
}

static void report_cube(Run *run, const Spec *spec, const BenchCube *cube)
{
    BenchKernel *row = add_row(run, spec, "particle", cube->particles);
    if (!cube->valid) {
        snprintf(row->reason, sizeof row->reason, "%s", cube->reason);
        return;
    }
    double *ns = sm_alloc((size_t)cube->repeats, sizeof *ns);
    for (int r = 0; r < cube->repeats; r++)
        ns[r] = spec->stage == WHOLE_STEP ? bench_cube_ns(cube, r)
                                          : bench_cube_stage_ns(cube, (SmStage)spec->stage, r);
    bench_kernel_times(row, ns, cube->repeats, &cube->watch);
    free(ns);
    double state = state_bytes(precision_of(run, spec)) * (double)cube->particles;
    bench_kernel_floor(run, row, work_of(spec), state);
    BenchLevel level = bench_level_of(run->peak, state, row->threads);
    note_cube(cube, bench_level_name(level), state, row);
}

static SmCode create_cube(const Run *run, const Spec *spec, BenchCube *cube, SmError *error)
{
    SmEngineParams params = {.w = spec->w,
                             .h = 0.01,
                             .damping = spec->damping,
                             .summation = spec->summation,
                             .polar = spec->polar,
                             .layout = run->params->layout,
                             .threads = threads_of(run, spec)};
    const SmEngineType *type =
        precision_of(run, spec) == BENCH_F64 ? &fastlsm_engine_f64 : &fastlsm_engine_f32;
    return bench_cube_create(spec->side, type, &params, run->params->seed, cube, error);
}

/* Chosen, or what a chosen one of the set is compared with. */
static bool needed(const Run *run, const Spec *spec, int first, int last)
{
    if (chosen(run->params, spec)) return true;
    for (int i = first; i < last; i++)
        if (specs[i].base && !strcmp(specs[i].base, spec->name) && chosen(run->params, &specs[i]))
            return true;
    return false;
}

static void report_cubes(Run *run, const Spec *const *of, const BenchCube *cubes, int count)
{
    for (int c = 0; c < count; c++) {
        if (!chosen(run->params, of[c])) continue;
        report_cube(run, of[c], &cubes[c]);
        for (int b = 0; b < count; b++)
            if (of[c]->base && !strcmp(of[c]->base, of[b]->name))
                set_ratio(run, of[c], &cubes[c], &cubes[b], &run->rows[*run->count - 1]);
    }
}

/* Times specs first .. last-1 of a set. */
static SmCode run_cubes(Run *run, int first, int last, SmError *error)
{
    BenchCube cubes[SET_MOST];
    const Spec *of[SET_MOST];
    int count = 0;
    bool stages = false;
    SmCode code = SM_OK;
    for (int i = first; i < last && !code; i++) {
        if (!needed(run, &specs[i], first, last)) continue;
        of[count] = &specs[i];
        code = create_cube(run, of[count], &cubes[count], error);
        stages = stages || of[count]->stage != WHOLE_STEP;
        count++;
    }
    if (!code) {
        bench_cubes_time(cubes, count, run->params->repeats, stages);
        report_cubes(run, of, cubes, count);
    }
    for (int c = 0; c < count; c++) bench_cube_free(&cubes[c]);
    return code;
}

/* ---- the other kernels */

static SmOperations polar_work(BenchPolar method, double sweeps)
{
    if (method == BENCH_POLAR_BATCH) return sm_polar_batch_operations();
    if (method == BENCH_POLAR_ROBUST) return sm_polar_robust_operations();
    return sm_polar_jacobi_operations(sweeps);
}

static void report_polar(Run *run, const Spec *spec, const BenchPolarResult *result)
{
    BenchKernel *row = add_row(run, spec, "matrix", BENCH_MATRICES);
    row->threads = 1;
    if (spec->method != BENCH_POLAR_BATCH) strcpy(row->precision, "double");
    if (!result->valid) {
        snprintf(row->reason, sizeof row->reason,
                 "rotations differ from the SVD's by %.3g; at most %g allowed", result->error,
                 result->limit);
        return;
    }
    bench_kernel_times(row, result->ns, run->params->repeats, &result->watch);
    bench_kernel_floor(run, row, polar_work(spec->method, result->sweeps), 1e5);
    if (spec->method == BENCH_POLAR_COLD || spec->method == BENCH_POLAR_WARM)
        snprintf(row->note, sizeof row->note, "%.2f sweeps a matrix; paper: %s", result->sweeps,
                 spec->method == BENCH_POLAR_COLD ? "1.9" : "0.4");
    else if (spec->method == BENCH_POLAR_BATCH)
        strcpy(row->note, "packing into lanes included");
}

static void run_polar(Run *run, int first, int last)
{
    BenchPolarResult result[BENCH_POLARS] = {{0}};
    for (int i = first; i < last; i++)
        result[specs[i].method].wanted = chosen(run->params, &specs[i]);
    bench_matrices_time(run->params->precision, run->params->repeats, run->params->seed, result);
    for (int i = first; i < last; i++)
        if (result[specs[i].method].wanted) report_polar(run, &specs[i], &result[specs[i].method]);
    for (int p = 0; p < BENCH_POLARS; p++) free(result[p].ns);
}

/* The floor of a surface's kernel, and what there is to say about it. */
static void judge_surface(const Run *run, BenchSurfaceKernel kernel, const BenchSurface *surface,
                          BenchKernel *row)
{
    double vertices = (double)surface->vertices, particles = (double)surface->particles;
    double nodes = (double)surface->nodes, mesh = 24 * vertices + 12 * (double)surface->triangles;
    switch (kernel) {
    case BENCH_EMBED:
        bench_kernel_floor(run, row, sm_embed_operations(particles / vertices),
                           176 * vertices + 24 * particles);
        strcpy(row->note, "positions and normals");
        break;
    case BENCH_CARRY:
        bench_kernel_floor(run, row,
                           oct_surface_operations(surface->nodes_blended, nodes / vertices),
                           (104 + 8 * surface->nodes_blended) * vertices + 120 * nodes);
        snprintf(row->note, sizeof row->note, "positions and normals, %ld nodes, %.2g a vertex",
                 surface->nodes, surface->nodes_blended);
        break;
    default:
        bench_kernel_floor(run, row, sm_voxelise_operations(vertices / (double)surface->triangles),
                           mesh);
        snprintf(row->note, sizeof row->note, "%.3g million triangles/s", 1e3 / row->ns);
    }
}

static void report_surface(Run *run, const Spec *spec, const BenchSurface *surface)
{
    bool voxels = spec->surface == BENCH_VOXELISE;
    const struct BenchSurfaceTime *kernel = &surface->kernel[spec->surface];
    BenchKernel *row = add_row(run, spec, voxels ? "triangle" : "vertex",
                               voxels ? surface->triangles : surface->vertices);
    strcpy(row->precision, "double");
    if (voxels) row->threads = 1;
    if (!kernel->valid) {
        snprintf(row->reason, sizeof row->reason, "%s", kernel->reason);
        return;
    }
    bench_kernel_times(row, kernel->ns, run->params->repeats, &kernel->watch);
    judge_surface(run, spec->surface, surface, row);
}

static SmCode run_surface(Run *run, int first, int last, SmError *error)
{
    BenchSurface surface = {0};
    for (int i = first; i < last; i++)
        surface.kernel[specs[i].surface].wanted = chosen(run->params, &specs[i]);
    SmCode code = bench_surface_time(run->params->threads, run->params->repeats, &surface, error);
    for (int i = first; i < last && !code; i++)
        if (chosen(run->params, &specs[i])) report_surface(run, &specs[i], &surface);
    for (int k = 0; k < BENCH_SURFACE_KERNELS; k++) free(surface.kernel[k].ns);
    return code;
}

static void report_scene(Run *run, const Spec *spec, const BenchScene *scene, const BenchRow *found)
{
    BenchKernel *row = add_row(run, spec, "particle", found->particles);
    row->w = found->w;
    snprintf(row->reason, sizeof row->reason, "%s", found->reason);
    if (!found->valid) return;
    double scale = 1e6 / (double)found->particles;
    row->valid = true;
    if (found->busy) bench_kernel_busy(row, found->lost_percent);
    row->ns = found->ns_per_particle_step;
    row->low = scale * found->total_low_ms;
    row->high = scale * found->total_high_ms;
    double state = state_bytes(run->params->precision) * (double)found->particles;
    int side = (int)cbrt((double)found->particles / (double)found->instances) + 1;
    bench_kernel_floor(
        run, row, lsm_step_operations(scene->params.summation, found->w, side, found->damping > 0),
        state);
    int used = snprintf(row->note, sizeof row->note, "%svoxelised %.3g ms, built %.3g ms",
                        found->damping > 0 ? "damping; " : "", 1e3 * found->voxelise_seconds,
                        1e3 * found->build_seconds);
    if (found->bytes > 0)
        snprintf(row->note + used, sizeof row->note - (size_t)used, ", %.3g bytes a particle",
                 (double)found->bytes / (double)found->particles);
}

static SmCode run_scene(Run *run, const Spec *spec, SmError *error)
{
    BenchScene scene;
    BenchBody body;
    BenchRow found;
    const SmEngineType *type =
        run->params->precision == BENCH_F64 ? &fastlsm_engine_f64 : &fastlsm_engine_f32;
    BenchMeasureParams params = {.repeats = run->params->repeats,
                                 .threads = run->params->threads,
                                 .seed = run->params->seed,
                                 .progress = run->params->progress};
    SmCode code = bench_scene_find(spec->name, &scene, error);
    if (code) return code;
    scene.params.layout = run->params->layout;
    code = bench_body_of_scene(&scene, NULL, &body, error);
    if (code) return code;
    code = bench_measure(&scene, &body, type, &params, &found, error);
    if (!code) {
        report_scene(run, spec, &scene, &found);
        bench_row_free(&found);
    }
    bench_body_free(&body);
    return code;
}

SmCode bench_kernels_run(const BenchKernelParams *params, const BenchPeak *peak, BenchKernel *rows,
                         int *count, SmError *error)
{
    Run run = {params, peak, rows, count};
    SmCode code = SM_OK;
    *count = 0;
    for (int first = 0, last; first < SPECS && !code; first = last) {
        bool any = false;
        for (last = first; last < SPECS && specs[last].set == specs[first].set; last++)
            any |= chosen(params, &specs[last]);
        if (!any) continue;
        if (params->progress)
            bench_progress_show(params->progress, specs[first].name, (double)first / SPECS);
        switch (specs[first].kind) {
        case CUBE:
            code = run_cubes(&run, first, last, error);
            break;
        case POLAR:
            run_polar(&run, first, last);
            break;
        case SURFACE:
            code = run_surface(&run, first, last, error);
            break;
        case SCENE:
            code = run_scene(&run, &specs[first], error);
            break;
        }
    }
    if (!code) code = bench_tree_kernels_run(&run, error);
    return code ? code : bench_change_kernels_run(&run, error);
}

const char *bench_kernel_verdict(const BenchKernel *row)
{
    bool limit = isfinite(row->at_most) && !row->busy;
    bool ratio = isfinite(row->wanted) && (!row->busy || row->own_time);
    if (!limit && !ratio) return "";
    bool met = row->valid;
    if (limit) met = met && row->ns <= row->at_most;
    if (ratio)
        met = met && (row->wanted_least ? row->ratio >= row->wanted : row->ratio <= row->wanted);
    return met ? "met" : "missed";
}
