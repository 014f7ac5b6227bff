#include <assert.h>
#include <stdio.h>

#include "tree_body.h"

/* Of the hand a step is the item, else a node. */
static bool is_body(const BenchJob *job)
{
    return job->kernel->side == BENCH_HAND && job->kernel->part == BENCH_TREE_WHOLE;
}

static SmCode prepare_step(BenchJob *job, SmError *error)
{
    const BenchKernel *kernel = job->kernel;
    BenchTreeBody *body = job->body;
    int s = 0;
    (void)error;
    while (s < body->count &&
           (kernel->weighting != body->step[s].weighting ||
            kernel->adjoint != body->step[s].adjoint || job->threads != body->step[s].threads))
        s++;
    BenchTreeStep *step = &body->step[s];
    if (s == body->count) {
        assert(body->count < (int)(sizeof body->step / sizeof *body->step));
        body->count++;
        *step = (BenchTreeStep){.body = &body->structure,
                                .weighting = kernel->weighting,
                                .adjoint = kernel->adjoint,
                                .parts = kernel->part != BENCH_TREE_WHOLE,
                                .threads = job->threads,
                                .seed = job->params->seed};
        bench_tree_steps(body->precision)->create(step);
    }
    assert(kernel->part == BENCH_TREE_WHOLE || step->parts); /* those come first in the list */
    job->trial = &step->trial;
    job->item = is_body(job) ? "step" : "node";
    job->items = is_body(job) ? 1 : body->structure.tree.leaves;
    job->per_run = (double)job->items;
    return SM_OK;
}

static double step_seconds(const BenchJob *job, int r)
{
    return 1e-9 * bench_tree_steps(job->precision)
                      ->ns(job->trial->timed.subject, (BenchTreePart)job->kernel->part, r);
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
        snprintf(note, room, "%s%s%s%.1f ns a node; %.2f summation nodes",
                 kernel->paper ? "paper: " : "", kernel->paper ? kernel->paper : "",
                 kernel->paper ? "; " : "", ns_per_node, step->body->regions.mean);
        break;
    }
}

static void report_step(BenchJob *job, BenchKernelRow *row)
{
    const BenchTreeBody *body = job->body;
    const BenchTreeStep *step = job->trial->timed.subject;
    double nodes = (double)body->structure.tree.leaves;
    job->least = work_of((BenchTreePart)job->kernel->part, &step->counts);
    if (is_body(job)) job->least = bench_tree_body_operations(body, job->least);
    job->footprint = nodes * oct_node_bytes(&step->counts, job->precision == BENCH_F32 ? 4 : 8);
    note_step(job->kernel, step, is_body(job) ? row->ns / nodes : row->ns, row);
}

const BenchKernelKind bench_tree_step_kernels = {.open = bench_tree_body_open,
                                                 .close = bench_tree_body_close,
                                                 .prepare = prepare_step,
                                                 .seconds = step_seconds,
                                                 .report = report_step};
