#include <stdio.h>
#include <stdlib.h>

#include "kernel.h"
#include "tree_body.h"
#include "tree_steps.h"

/* What a set has: one kernel. */
typedef struct {
    OctStructure structure;
    BenchPrecision precision;
    BenchTreeStep step;
} Body;

static SmCode open_body(const BenchKernel *kernel, const BenchKernelParams *params, void **body,
                        SmError *error)
{
    Body *made = *body = sm_alloc(1, sizeof *made);
    made->precision = params->precision;
    return bench_sampled(kernel->side, &made->structure, error);
}

static void close_body(void *of)
{
    Body *body = of;
    if (body->step.engine) bench_tree_steps(body->precision)->free(&body->step);
    oct_structure_free(&body->structure);
    free(body);
}

static SmCode prepare_step(BenchJob *job, SmError *error)
{
    const BenchKernel *kernel = job->kernel;
    Body *body = job->body;
    BenchTreeStep *step = &body->step;
    (void)error;
    *step = (BenchTreeStep){.body = &body->structure,
                            .stages = kernel->part == BENCH_TREE_SUMS,
                            .threads = job->threads,
                            .seed = job->params->seed};
    bench_tree_steps(body->precision)->create(step);
    job->trial = &step->trial;
    job->item = kernel->side == BENCH_HAND ? "step" : "node";
    job->items = kernel->side == BENCH_HAND ? 1 : body->structure.tree.leaves;
    job->per_run = (double)job->items;
    return SM_OK;
}

static double step_seconds(const BenchJob *job, int r)
{
    return job->kernel->part == BENCH_TREE_SUMS ? bench_trial_stage(job->trial, r, SM_FAST_SUM)
                                                : job->trial->seconds[r];
}

static void report_step(BenchJob *job, BenchKernelRow *row)
{
    const BenchTreeStep *step = job->trial->timed.subject;
    const char *paper = job->kernel->paper;
    double nodes = (double)step->body->tree.leaves;
    job->least = sm_operations_add((SmOperations){0}, nodes, oct_step_operations(&step->counts));
    job->footprint = nodes * oct_node_bytes(&step->counts, job->precision == BENCH_F32 ? 4 : 8);
    snprintf(row->note, sizeof row->note, "%s%s%s%.1f ns a node; %.2f summation nodes",
             paper ? "paper: " : "", paper ? paper : "", paper ? "; " : "", row->ns / nodes,
             step->body->regions.mean);
}

const BenchKernelKind bench_tree_step_kernels = {.open = open_body,
                                                 .close = close_body,
                                                 .prepare = prepare_step,
                                                 .seconds = step_seconds,
                                                 .report = report_step};
