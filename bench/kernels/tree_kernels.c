#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"
#include "sampled.h"
#include "tree_setup.h"
#include "tree_steps.h"

enum { STEPS_MOST = 16 };

/* What the octree's kernels of a set share. */
typedef struct {
    OctStructure sampled;
    BenchPrecision precision;
    BenchTreeStep step[STEPS_MOST]; /* [count] engines: each weighting, goal form and threads */
    int count;
} Body;

static SmCode open_body(const BenchKernel *kernel, const BenchKernelParams *params, void **body,
                        SmError *error)
{
    Body *made = *body = sm_alloc(1, sizeof *made);
    made->precision = params->precision;
    return bench_sampled(kernel->side, &made->sampled, error);
}

static void close_body(void *of)
{
    Body *body = of;
    for (int s = 0; s < body->count; s++)
        (body->precision == BENCH_F64 ? bench_tree_step_free_f64
                                      : bench_tree_step_free_f32)(&body->step[s]);
    oct_structure_free(&body->sampled);
    free(body);
}

static SmOperations of_body(SmOperations node, const Body *body)
{
    return sm_operations_add((SmOperations){0}, (double)body->sampled.tree.leaves, node);
}

/* ---- steps */

/* Of the hand a step is the item, else a node. */
static bool is_body(const BenchJob *job)
{
    return job->kernel->side == BENCH_HAND && job->kernel->part == BENCH_TREE_WHOLE;
}

static SmCode prepare_step(BenchJob *job, SmError *error)
{
    const BenchKernel *kernel = job->kernel;
    Body *body = job->body;
    int s = 0;
    (void)error;
    while (s < body->count &&
           (kernel->weighting != body->step[s].weighting ||
            kernel->adjoint != body->step[s].adjoint || job->threads != body->step[s].threads))
        s++;
    BenchTreeStep *step = &body->step[s];
    if (s == body->count) {
        assert(body->count < STEPS_MOST);
        body->count++;
        *step = (BenchTreeStep){.body = &body->sampled,
                                .weighting = kernel->weighting,
                                .adjoint = kernel->adjoint,
                                .parts = kernel->part != BENCH_TREE_WHOLE,
                                .threads = job->threads,
                                .seed = job->params->seed};
        (body->precision == BENCH_F64 ? bench_tree_step_create_f64
                                      : bench_tree_step_create_f32)(step);
    }
    assert(kernel->part == BENCH_TREE_WHOLE || step->parts); /* those come first in the list */
    job->trial = &step->trial;
    job->item = is_body(job) ? "step" : "node";
    job->items = is_body(job) ? 1 : body->sampled.tree.leaves;
    job->per_run = (double)job->items;
    return SM_OK;
}

static double step_seconds(const BenchJob *job, int r)
{
    return 1e-9 * (job->precision == BENCH_F64 ? bench_tree_step_ns_f64 : bench_tree_step_ns_f32)(
                      job->trial->timed.subject, (BenchTreePart)job->kernel->part, r);
}

static SmOperations work_of(BenchTreePart part, const OctStepCounts *counts)
{
    static SmOperations (*const of[])(const OctStepCounts *counts) = {
        [BENCH_TREE_DEPTH] = oct_depth_operations,
        [BENCH_TREE_BREADTH] = oct_breadth_operations,
        [BENCH_TREE_GOALS] = oct_goal_operations,
        [BENCH_TREE_DAMPING] = oct_damping_operations,
        [BENCH_TREE_WHOLE] = oct_step_operations};
    return part == BENCH_TREE_POLAR ? sm_polar_batch_operations() : of[part](counts);
}

static void note_step(const BenchKernel *kernel, const BenchTreeStep *step, double ns_per_node,
                      BenchKernelRow *row)
{
    const OctStepCounts *c = &step->counts;
    char *note = row->note;
    size_t room = sizeof row->note;
    double entries = c->leaf_entries + c->inner_entries;
    double goals = c->goal_entries + c->goal_prefix_entries;
    double children = c->leaf_children + c->inner_children;
    switch ((BenchTreePart)kernel->part) {
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
                 kernel->paper ? "paper: " : "", kernel->paper ? kernel->paper : "",
                 kernel->paper ? "; " : "", ns_per_node, step->body->regions.mean,
                 (double)step->bytes / 1e6);
        break;
    }
}

static void report_step(BenchJob *job, BenchKernelRow *row)
{
    const Body *body = job->body;
    const BenchTreeStep *step = job->trial->timed.subject;
    double nodes = (double)body->sampled.tree.leaves;
    job->least = work_of((BenchTreePart)job->kernel->part, &step->counts);
    if (is_body(job)) job->least = of_body(job->least, body);
    job->footprint = (double)step->bytes;
    note_step(job->kernel, step, is_body(job) ? row->ns / nodes : row->ns, row);
}

const BenchKernelKind bench_tree_step_kernels = {.open = open_body,
                                                 .close = close_body,
                                                 .prepare = prepare_step,
                                                 .seconds = step_seconds,
                                                 .report = report_step};

/* ---- setting up */

/* Three or four digits, without an exponent. */
static int decimals(double ms)
{
    return ms < 10 ? 2 : ms < 100 ? 1 : 0;
}

static void note_setup(const BenchSetup *setup, double user_ns, BenchKernelRow *row)
{
    const OctStructure *body = setup->body;
    double nodes = (double)body->tree.leaves, edges = (double)body->graph.first[body->tree.leaves];
    double leaves = 0; /* of all regions */
    char *note = row->note;
    size_t room = sizeof row->note;
    double ms = row->ns * (row->items == body->tree.leaves ? nodes : 1) / 1e6;
    switch (setup->kind) {
    case BENCH_SETUP_DISTANCES:
        snprintf(note, room, "Bucket-Moore; %.1f ns a node", row->ns / nodes);
        break;
    case BENCH_SETUP_GRAPH:
        snprintf(note, room, "%.*f ms; %.1f edges a node", decimals(ms), ms, edges / nodes);
        break;
    case BENCH_SETUP_REGIONS:
        for (long i = 0; i < body->regions.leaves; i++) leaves += body->regions.size[i];
        snprintf(note, room, "%.*f ms, distances included; %.1f leaves a region", decimals(ms), ms,
                 leaves / nodes);
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
                 decimals(ms), ms, body->tree.leaves, user_ns);
        break;
    }
}

static SmCode prepare_setup(BenchJob *job, SmError *error)
{
    const Body *body = job->body;
    BenchSetup *setup = job->subject = sm_alloc(1, sizeof *setup);
    BenchSetupKind kind = (BenchSetupKind)job->kernel->part;
    (void)error;
    bench_setup_create(&body->sampled, kind, job->precision, setup);
    if (kind != BENCH_SETUP_WHOLE) job->arithmetic = "integer";
    job->trial = &setup->trial;
    job->item = "node";
    job->items = body->sampled.tree.leaves;
    if (kind == BENCH_SETUP_DISTANCES) job->item = "source", job->items = setup->sources;
    if (kind == BENCH_SETUP_STRUCTURE) job->item = "body", job->items = 1;
    job->per_run = (double)job->items;
    return SM_OK;
}

static void report_setup(BenchJob *job, BenchKernelRow *row)
{
    const BenchSetup *setup = job->subject;
    double user = 0;
    for (int r = 0; r < setup->trial.samples; r++) user += setup->trial.user[r];
    job->own_ns = 1e9 * user / (setup->trial.samples * job->per_run);
    job->least =
        setup->kind == BENCH_SETUP_STRUCTURE ? of_body(setup->least, job->body) : setup->least;
    job->footprint = setup->bytes + setup->engine_bytes;
    note_setup(setup, job->own_ns, row);
}

static void release_setup(void *subject)
{
    bench_setup_free(subject);
}

const BenchKernelKind bench_tree_setup_kernels = {.open = open_body,
                                                  .close = close_body,
                                                  .prepare = prepare_setup,
                                                  .report = report_setup,
                                                  .release = release_setup,
                                                  .apart = true,
                                                  .own = "user time"};
