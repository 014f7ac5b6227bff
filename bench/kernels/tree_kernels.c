#include <stdio.h>

#include "tree_body.h"

static SmCode prepare_step(BenchJob *job, SmError *error)
{
    const BenchKernel *kernel = job->kernel;
    BenchTreeBody *body = job->body;
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
    const BenchTreeBody *body = job->body;
    const BenchTreeStep *step = job->trial->timed.subject;
    const char *paper = job->kernel->paper;
    double nodes = (double)body->structure.tree.leaves;
    job->least = bench_tree_body_operations(body, oct_step_operations(&step->counts));
    job->footprint = nodes * oct_node_bytes(&step->counts, job->precision == BENCH_F32 ? 4 : 8);
    snprintf(row->note, sizeof row->note, "%s%s%s%.1f ns a node; %.2f summation nodes",
             paper ? "paper: " : "", paper ? paper : "", paper ? "; " : "", row->ns / nodes,
             step->body->regions.mean);
}

const BenchKernelKind bench_tree_step_kernels = {.open = bench_tree_body_open,
                                                 .close = bench_tree_body_close,
                                                 .prepare = prepare_step,
                                                 .seconds = step_seconds,
                                                 .report = report_step};
