#include "tree_kernels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../measure/spread.h"
#include "tree_setup.h"
#include "tree_steps.h"

/* The hand of 661 nodes, the regular one, or a cube of that side. */
enum { HAND = 0, REGULAR = -1, BODY_MOST = 16 };

/* A kernel that can be asked for. Neighbours of one body share it; their steps are timed in turn.
 */
typedef struct {
    const char *name;
    int body;
    bool setup; /* one of `kind`, else `part` of a step */
    BenchSetupKind kind;
    BenchTreePart part;
    OctWeighting weighting;
    bool adjoint;
    int threads;      /* 0: as asked for */
    bool large;       /* only by name or with --scaling */
    double at_most;   /* ns an item on one core in single precision; 0: no limit */
    const char *base; /* the kernel that `ratio` refers to: a step's is of the same body */
    double wanted;
    const char *paper; /* what the octree paper says */
} Spec;

static const char group_name[] = "octree", speed_up_of[] = "oct-regular-step",
                  least_of[] = "oct-setup-1e3";

/* Trailing arguments: further fields. */
#define PART(of, label, which, ...)                                                                \
    {                                                                                              \
        .name = (label), .body = (of), .part = (which), __VA_ARGS__                                \
    }
#define SETUP(of, label, which, ...)                                                               \
    {                                                                                              \
        .name = (label), .body = (of), .setup = true, .kind = (which), __VA_ARGS__                 \
    }
/* Linear: from 1e3 to 1e6 nodes a node's cost at most doubles, an exponent of 1.1. Beside cubes of
 * fewer nodes at their surface (1.2 times the edges) come the caches that they outgrow. */
#define GROWTH(of, label, ...)                                                                     \
    SETUP(of, label, BENCH_SETUP_WHOLE, .base = least_of, .wanted = 2, __VA_ARGS__)
#define PARTS(of, prefix)                                                                          \
    PART(of, prefix "-depth", BENCH_TREE_DEPTH), PART(of, prefix "-breadth", BENCH_TREE_BREADTH),  \
        PART(of, prefix "-polar", BENCH_TREE_POLAR),                                               \
        PART(of, prefix "-goals-hf", BENCH_TREE_GOALS),                                            \
        PART(of, prefix "-goals-adjoint", BENCH_TREE_GOALS, .adjoint = true),                      \
        PART(of, prefix "-damping", BENCH_TREE_DAMPING)

static const Spec specs[] = {
    PARTS(HAND, "oct-hand"),
    PART(HAND, "oct-hand-step", BENCH_TREE_WHOLE, .at_most = 60e3, .paper = "4.5 ms"),
    PART(HAND, "oct-hand-step-plain", BENCH_TREE_WHOLE, .weighting = OCT_PLAIN),
    PART(HAND, "oct-hand-step-adjoint", BENCH_TREE_WHOLE, .adjoint = true),
    SETUP(HAND, "oct-hand-distances", BENCH_SETUP_DISTANCES),
    SETUP(HAND, "oct-hand-graph", BENCH_SETUP_GRAPH),
    SETUP(HAND, "oct-hand-regions", BENCH_SETUP_REGIONS),
    SETUP(HAND, "oct-hand-structure", BENCH_SETUP_STRUCTURE, .at_most = 30e6),
    SETUP(HAND, "oct-hand-sampling", BENCH_SETUP_SAMPLING),
    PARTS(REGULAR, "oct-regular"),
    PART(REGULAR, speed_up_of, BENCH_TREE_WHOLE, .at_most = 120, .paper = "6200 ns"),
    PART(REGULAR, "oct-regular-step-plain", BENCH_TREE_WHOLE, .weighting = OCT_PLAIN),
    PART(REGULAR, "oct-regular-step-adjoint", BENCH_TREE_WHOLE, .adjoint = true),
    PART(REGULAR, "oct-regular-step-2threads", BENCH_TREE_WHOLE, .threads = 2, .base = speed_up_of,
         .wanted = 1.8),
    SETUP(REGULAR, "oct-regular-distances", BENCH_SETUP_DISTANCES),
    SETUP(REGULAR, "oct-regular-graph", BENCH_SETUP_GRAPH),
    SETUP(REGULAR, "oct-regular-regions", BENCH_SETUP_REGIONS),
    SETUP(10, least_of, BENCH_SETUP_WHOLE),
    GROWTH(22, "oct-setup-1e4"),
    GROWTH(46, "oct-setup-1e5"),
    GROWTH(100, "oct-setup-1e6", .large = true),
};
enum { SPECS = sizeof specs / sizeof specs[0] };

const char *bench_tree_kernel_name(int index, const char **group)
{
    if (index < 0 || index >= SPECS) return NULL;
    if (group) *group = group_name;
    return specs[index].name;
}

static bool chosen(const BenchKernelRun *run, const Spec *spec)
{
    return bench_kernel_chosen(run->params, spec->name, group_name, spec->large);
}

static int threads_of(const BenchKernelRun *run, const Spec *spec)
{
    return spec->threads ? spec->threads : run->params->threads;
}

static BenchKernel *add_row(BenchKernelRun *run, const Spec *spec, const char *item, long items)
{
    BenchKernel *row = bench_kernel_add(run, spec->name, group_name, item, items);
    row->threads = threads_of(run, spec);
    bool compared = row->threads == 1 && run->params->precision == BENCH_F32;
    if (spec->at_most > 0 && compared) row->at_most = spec->at_most;
    return row;
}

/* ---- steps */

static bool same_engine(const BenchKernelRun *run, const Spec *spec, const BenchTreeStep *step)
{
    return spec->weighting == step->weighting && spec->adjoint == step->adjoint &&
           threads_of(run, spec) == step->threads;
}

static BenchTreeStep *engine_of(const BenchKernelRun *run, const Spec *spec, BenchTreeStep *steps,
                                int count)
{
    for (int s = 0; s < count; s++)
        if (same_engine(run, spec, &steps[s])) return &steps[s];
    return NULL;
}

static SmOperations work_of(BenchTreePart part, const OctStepCounts *counts)
{
    switch (part) {
    case BENCH_TREE_DEPTH:
        return oct_depth_operations(counts);
    case BENCH_TREE_BREADTH:
        return oct_breadth_operations(counts);
    case BENCH_TREE_POLAR:
        return sm_polar_batch_operations();
    case BENCH_TREE_GOALS:
        return oct_goal_operations(counts);
    case BENCH_TREE_DAMPING:
        return oct_damping_operations(counts);
    case BENCH_TREE_WHOLE:
        break;
    }
    return oct_step_operations(counts);
}

static void note_step(const Spec *spec, const BenchTreeStep *step, double ns_per_node,
                      BenchKernel *row)
{
    const OctStepCounts *c = &step->counts;
    char *note = row->note;
    size_t room = sizeof row->note;
    double entries = c->leaf_entries + c->inner_entries;
    double goals = c->goal_entries + c->goal_prefix_entries;
    double children = c->leaf_children + c->inner_children;
    switch (spec->part) {
    case BENCH_TREE_DEPTH:
        snprintf(note, room, "%.2f children a node", children);
        break;
    case BENCH_TREE_BREADTH:
        snprintf(note, room, "%.2f entries a node, for %.2f summation nodes", entries,
                 step->body->regions.mean);
        break;
    case BENCH_TREE_POLAR:
        snprintf(note, room, "one matrix a node");
        break;
    case BENCH_TREE_GOALS:
        snprintf(note, room, "depth and breadth; %.2f children, %.2f entries a node", children,
                 goals);
        break;
    case BENCH_TREE_DAMPING:
        snprintf(note, room, "%.2f and %.2f entries a node", entries, goals);
        break;
    case BENCH_TREE_WHOLE:
        snprintf(note, room, "%s%s%s%.1f ns a node; %.2f summation nodes; %.3g MB",
                 spec->paper ? "paper: " : "", spec->paper ? spec->paper : "",
                 spec->paper ? "; " : "", ns_per_node, step->body->regions.mean,
                 (double)step->bytes / 1e6);
        break;
    }
}

/* The median over samples of how this engine compares with `base`, timed just before or after. */
static void set_speed_up(const BenchKernelRun *run, const Spec *spec, const BenchTreeStep *step,
                         const BenchTreeStep *base, BenchKernel *row)
{
    if (!step->valid || !base || !base->valid) return;
    if (bench_watch_busy(&base->watch)) bench_kernel_busy(row, bench_watch_lost(&base->watch));
    int repeats = run->params->repeats;
    double *ratio = sm_alloc((size_t)repeats, sizeof *ratio);
    for (int r = 0; r < repeats; r++) ratio[r] = base->total[r] / step->total[r];
    row->ratio = bench_spread(ratio, repeats).median;
    free(ratio);
    row->wanted_least = true;
    if (base->threads == 1) row->wanted = spec->wanted;
    snprintf(row->ratio_to, sizeof row->ratio_to, "%s", "1 thread");
}

static void report_step(BenchKernelRun *run, const Spec *spec, const BenchTreeStep *step)
{
    long nodes = step->body->tree.leaves;
    bool whole = spec->body == HAND && spec->part == BENCH_TREE_WHOLE;
    BenchKernel *row = add_row(run, spec, whole ? "step" : "node", whole ? 1 : nodes);
    if (!step->valid) {
        snprintf(row->reason, sizeof row->reason, "%s", step->reason);
        return;
    }
    int repeats = run->params->repeats;
    double *ns = sm_alloc((size_t)repeats, sizeof *ns);
    for (int r = 0; r < repeats; r++) {
        ns[r] = spec->part == BENCH_TREE_WHOLE ? step->total[r] : step->part[r][spec->part];
        if (!whole) ns[r] /= (double)nodes;
    }
    bench_kernel_times(row, ns, repeats, &step->watch);
    free(ns);
    SmOperations work = work_of(spec->part, &step->counts);
    bench_kernel_floor(run, row,
                       whole ? sm_operations_add((SmOperations){0}, (double)nodes, work) : work,
                       (double)step->bytes);
    note_step(spec, step, whole ? row->ns / (double)nodes : row->ns, row);
}

/* Collects the engines that the specs need: one for each weighting, goal form and threads. */
static int collect_engines(const BenchKernelRun *run, const BenchSampled *body, int first, int last,
                           BenchTreeStep *steps)
{
    int count = 0;
    for (int i = first; i < last; i++) {
        if (specs[i].setup || !chosen(run, &specs[i])) continue;
        bool parts = specs[i].part != BENCH_TREE_WHOLE;
        for (int b = first; b < last; b++) { /* itself, and what it is compared with */
            bool base = specs[i].base && !strcmp(specs[i].base, specs[b].name);
            if (b != i && !base) continue;
            BenchTreeStep *known = engine_of(run, &specs[b], steps, count);
            if (!known) {
                known = &steps[count++];
                *known = (BenchTreeStep){.body = body,
                                         .weighting = specs[b].weighting,
                                         .adjoint = specs[b].adjoint,
                                         .threads = threads_of(run, &specs[b]),
                                         .seed = run->params->seed};
            }
            known->parts = known->parts || (b == i && parts);
        }
    }
    return count;
}

static void run_steps(BenchKernelRun *run, const BenchSampled *body, int first, int last)
{
    bool doubles = run->params->precision == BENCH_F64;
    BenchTreeStep steps[BODY_MOST];
    int count = collect_engines(run, body, first, last, steps);
    for (int s = 0; s < count; s++)
        (doubles ? bench_tree_step_create_f64 : bench_tree_step_create_f32)(&steps[s]);
    (doubles ? bench_tree_steps_time_f64 : bench_tree_steps_time_f32)(steps, count,
                                                                      run->params->repeats);
    for (int i = first; i < last; i++) {
        if (specs[i].setup || !chosen(run, &specs[i])) continue;
        const BenchTreeStep *step = engine_of(run, &specs[i], steps, count);
        report_step(run, &specs[i], step);
        for (int b = first; b < last && specs[i].base; b++)
            if (!strcmp(specs[i].base, specs[b].name))
                set_speed_up(run, &specs[i], step, engine_of(run, &specs[b], steps, count),
                             &run->rows[*run->count - 1]);
    }
    for (int s = 0; s < count; s++)
        (doubles ? bench_tree_step_free_f64 : bench_tree_step_free_f32)(&steps[s]);
}

/* ---- setting up */

/* Of times, in which item; the body's is the structure's and no node's. */
static const char *item_of(BenchSetupKind kind)
{
    return kind == BENCH_SETUP_DISTANCES   ? "source"
           : kind == BENCH_SETUP_STRUCTURE ? "body"
                                           : "node";
}

/* Three or four digits, without an exponent. */
static int decimals(double ms)
{
    return ms < 10 ? 2 : ms < 100 ? 1 : 0;
}

static void note_setup(const Spec *spec, const BenchSampled *body, double user_ns, BenchKernel *row)
{
    double nodes = (double)body->tree.leaves, edges = (double)body->graph.first[body->tree.leaves];
    char *note = row->note;
    size_t room = sizeof row->note;
    double ms = row->ns * (row->items == body->tree.leaves ? nodes : 1) / 1e6;
    switch (spec->kind) {
    case BENCH_SETUP_DISTANCES:
        snprintf(note, room, "Bucket-Moore; %.1f ns a node", row->ns / nodes);
        break;
    case BENCH_SETUP_GRAPH:
        snprintf(note, room, "%.*f ms; %.1f edges a node", decimals(ms), ms, edges / nodes);
        break;
    case BENCH_SETUP_REGIONS:
        snprintf(note, room, "%.*f ms, distances included; %.1f leaves a region", decimals(ms), ms,
                 bench_sampled_members(body) / nodes);
        break;
    case BENCH_SETUP_STRUCTURE:
        snprintf(note, room, "%.*f ms: graph, distances, regions of %ld nodes", decimals(ms), ms,
                 body->tree.leaves);
        break;
    case BENCH_SETUP_SAMPLING:
        snprintf(note, room, "%.*f ms: %ld nodes, %ld base cells from %ld cells, lattice placed",
                 decimals(ms), ms, body->tree.leaves, body->tree.roots, body->voxels.cell_count);
        break;
    case BENCH_SETUP_WHOLE:
        snprintf(note, room,
                 "%.*f ms: tree, graph, regions, engine of %ld nodes; %.0f ns of user time",
                 decimals(ms), ms, body->tree.leaves, user_ns / nodes);
        break;
    }
}

static void report_setup(BenchKernelRun *run, const Spec *spec, const BenchSampled *body,
                         const BenchSetup *setup)
{
    const char *item = item_of(spec->kind);
    bool node = !strcmp(item, "node");
    long nodes = body->tree.leaves, items = node ? nodes : 1;
    BenchKernel *row =
        add_row(run, spec, item, spec->kind == BENCH_SETUP_DISTANCES ? setup->sources : items);
    if (spec->kind != BENCH_SETUP_WHOLE) strcpy(row->precision, "integer");
    if (!setup->valid) {
        snprintf(row->reason, sizeof row->reason, "%s", setup->reason);
        return;
    }
    for (int r = 0; r < setup->samples; r++) setup->ns[r] /= (double)items;
    bench_kernel_times(row, setup->ns, setup->samples, &setup->watch);
    bool structure = spec->kind == BENCH_SETUP_STRUCTURE;
    bench_kernel_floor(run, row,
                       structure ? sm_operations_add((SmOperations){0}, (double)nodes, setup->work)
                                 : setup->work,
                       setup->bytes);
    note_setup(spec, body, setup->user_ns, row);
}

/* User CPU time of a node beside that of the smallest body; page faults are not our work. */
static void set_growth(const Spec *spec, double user_ns, double least_ns, BenchKernel *row)
{
    if (!row->valid || !(least_ns > 0)) return;
    row->ratio = user_ns / least_ns;
    row->own_time = true;
    row->wanted = spec->wanted;
    snprintf(row->ratio_to, sizeof row->ratio_to, "%s's user time", spec->base);
}

/* Chosen, or what a chosen one is compared with. */
static bool needed(const BenchKernelRun *run, const Spec *spec)
{
    if (chosen(run, spec)) return true;
    for (int i = 0; i < SPECS; i++)
        if (specs[i].base && !strcmp(specs[i].base, spec->name) && chosen(run, &specs[i]))
            return true;
    return false;
}

static void run_setup(BenchKernelRun *run, const Spec *spec, const BenchSampled *body,
                      double *least_ns)
{
    BenchSetup setup;
    int before = sm_team_enter(threads_of(run, spec));
    bench_setup_time(body, spec->kind, run->params->precision, run->params->repeats, &setup);
    sm_team_leave(before);
    double user_ns = setup.user_ns / (double)body->tree.leaves;
    if (setup.valid && !strcmp(spec->name, least_of)) *least_ns = user_ns;
    if (chosen(run, spec)) {
        report_setup(run, spec, body, &setup);
        if (spec->base) set_growth(spec, user_ns, *least_ns, &run->rows[*run->count - 1]);
    }
    free(setup.ns);
}

/* Specs first .. last - 1, of one body. */
static SmCode run_body(BenchKernelRun *run, int first, int last, double *least_ns, SmError *error)
{
    BenchSampled body;
    int side = specs[first].body;
    SmCode code = side > 0 ? bench_sampled_cube(side, &body, error)
                           : bench_sampled_hand(side == REGULAR, &body, error);
    if (code) return code;
    run_steps(run, &body, first, last);
    for (int i = first; i < last; i++)
        if (specs[i].setup && needed(run, &specs[i])) run_setup(run, &specs[i], &body, least_ns);
    bench_sampled_free(&body);
    return SM_OK;
}

SmCode bench_tree_kernels_run(BenchKernelRun *run, SmError *error)
{
    double least_ns = 0;
    SmCode code = SM_OK;
    for (int first = 0, last; first < SPECS && !code; first = last) {
        bool any = false;
        for (last = first; last < SPECS && specs[last].body == specs[first].body; last++)
            any |= needed(run, &specs[last]);
        if (!any) continue;
        if (run->params->progress)
            bench_progress_show(run->params->progress, specs[first].name, (double)first / SPECS);
        code = run_body(run, first, last, &least_ns, error);
    }
    return code;
}
