#include "kernels.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../system/statistic.h"
#include "cubes.h"
#include "matrices.h"
#include "tree_body.h"

/* Trailing arguments: further members. */
#define SUM(method, sums, width)                                                                   \
    {                                                                                              \
        "sum-" method "-w" #width, "sum", &bench_cube_kernels, width, 32, width,                   \
            .part = SM_FAST_SUM, .summation = (sums)                                               \
    }
#define SUMS(width)                                                                                \
    SUM("naive", SM_SUM_NAIVE, width), SUM("bars", SM_SUM_BARS, width),                            \
        SUM("fast", SM_SUM_FAST, width)
#define STEP(label, of, number, n, width, ...)                                                     \
    {                                                                                              \
        label, of, &bench_cube_kernels, number, n, width, .part = BENCH_CUBE_STEP, __VA_ARGS__     \
    }
#define SCENE(label, number, ns, share)                                                            \
    {                                                                                              \
        label, "cases", &bench_scene_kernels, number, .at_most = (ns), .avx2_share = (share)       \
    }
/* Wide regions: at most so many times the body's own time at w = 1. */
#define BODY(number, body, width, times, by_name)                                                  \
    {                                                                                              \
        body "-w" #width, "bodies", &bench_scene_kernels, number,                                  \
            .w = width, .large = by_name, .base = body "-w1", .wanted = times,                     \
            .scene = body "-solid"                                                                 \
    }
#define BODIES(number, body)                                                                       \
    BODY(number, body, 1, 0, false), BODY(number, body, 4, 2, false),                              \
        BODY(number, body, 10, 3.3, true)
/* The cost of a change does not grow with the body: at most twice the processor time that it takes
 * in 10^3 nodes, whose caches the others outgrow. */
#define CHANGE(number, of, label, which, ...)                                                      \
    {                                                                                              \
        label, "resampling", &bench_change_kernels, number, .side = (of), .part = (which),         \
                                                            __VA_ARGS__                            \
    }
#define CHANGES(number, of, size, ...)                                                             \
    CHANGE(number, of, "oct-refine-" size, BENCH_REFINE, .base = "oct-refine-1e3", .wanted = 2,    \
           __VA_ARGS__),                                                                           \
        CHANGE(number, of, "oct-cut-" size, BENCH_CUT, .base = "oct-cut-1e3", .wanted = 2,         \
               __VA_ARGS__)

static const BenchKernel kernels[] = {
    SUMS(1),
    SUMS(2),
    SUMS(3),
    SUMS(5),
    SUMS(8),
    {"polar-fast", "polar", &bench_polar_kernels, 10, .part = BENCH_POLAR_BATCH,
     .avx2_share = 0.35},
    {"polar-jacobi-cold", "polar", &bench_polar_kernels, 10, .part = BENCH_POLAR_COLD},
    {"polar-jacobi-warm", "polar", &bench_polar_kernels, 10, .part = BENCH_POLAR_WARM},
    {"polar-robust", "polar", &bench_polar_kernels, 10, .part = BENCH_POLAR_ROBUST},
    {"damping", "damping", &bench_cube_kernels, 11, 64, 1, .part = SM_DAMPING, .damping = 0.1},
    {"integration", "integration", &bench_cube_kernels, 11, 64, 1, .part = SM_OTHER},
    STEP("cube32-w1", "cases", 20, 32, 1, .at_most = 8, .avx2_share = 0.35),
    STEP("cube64-w1", "cases", 21, 64, 1, .at_most = 8),
    STEP("cube64-w1-2threads", "cases", 21, 64, 1, .threads = 2, .base = "cube64-w1",
         .wanted = 1.85),
    STEP("cube64-w1-double", "cases", 21, 64, 1, .doubled = true, .base = "cube64-w1",
         .wanted = 2.2),
    STEP("cube32-w5", "cases", 22, 32, 5, .at_most = 12, .avx2_share = 0.28),
    STEP("cube128-w2", "cases", 23, 128, 2, .at_most = 13),
    STEP("cube64-w1-damping", "cases", 24, 64, 1, .damping = 0.1, .at_most = 15,
         .avx2_share = 0.28),
    STEP("cube64-w1-jacobi", "cases", 25, 64, 1, .polar = SM_POLAR_JACOBI),
    SCENE("statue-solid", 30, 30, 0.14),
    SCENE("statue-shell", 31, 60, 0),
    SCENE("infant", 32, 45, 0.10),
    SCENE("penguin", 33, 50, 0.13),
    SCENE("penguins", 34, 44, 0),
    SCENE("penguins-free", 35, 20, 0),
    BODIES(36, "statue"),
    BODIES(37, "bunny"),
    BODIES(38, "liver"),
    STEP("scale-1e4", "scaling", 40, 22, 1, .at_most = 0),
    STEP("scale-1e5", "scaling", 40, 46, 1, .base = "scale-1e4", .wanted = 1.25),
    STEP("scale-1e6", "scaling", 40, 100, 1, .base = "scale-1e4", .wanted = 1.25),
    STEP("scale-1e7", "scaling", 40, 215, 1, .large = true, .base = "scale-1e4", .wanted = 1.25),
    {"oct-hand-step", "octree", &bench_tree_step_kernels, 50, .side = BENCH_HAND, .at_most = 60e3,
     .avx2_share = 0.20, .paper = "4.5 ms"},
    CHANGE(60, 10, "oct-refine-1e3", BENCH_REFINE, .at_most = 0),
    CHANGE(60, 10, "oct-cut-1e3", BENCH_CUT, .at_most = 0),
    CHANGES(61, 22, "1e4", .at_most = 0),
    CHANGES(62, 46, "1e5", .at_most = 0),
    CHANGES(63, 100, "1e6", .large = true),
};
enum { KERNELS = sizeof kernels / sizeof kernels[0], SET_MOST = 20 };

typedef struct {
    const BenchKernelParams *params;
    const BenchPeak *peak;
    BenchKernelRow *rows;
    int *count;
    double own_ns[KERNELS]; /* BenchJob.own_ns of what has been timed; 0: not yet */
} Run;

const char *bench_kernel_name(int index, const char **group)
{
    if (index < 0 || index >= KERNELS) return NULL;
    if (group) *group = kernels[index].group;
    return kernels[index].name;
}

bool bench_kernel_known(const char *name)
{
    for (int i = 0; i < KERNELS; i++)
        if (!strcmp(name, kernels[i].name) || !strcmp(name, kernels[i].group)) return true;
    return false;
}

/* Is it asked for? A large one only by its name or with `scaling`; what is in double precision
 * anyway only once. */
static bool chosen(const BenchKernelParams *params, const BenchKernel *kernel)
{
    bool any = !params->only[0];
    if (kernel->doubled && params->precision == BENCH_F64) return false;
    for (const char *const *only = params->only; *only; only++) {
        if (!strcmp(*only, kernel->name)) return true;
        any = any || !strcmp(*only, kernel->group);
    }
    return any && (!kernel->large || params->scaling);
}

static bool has_base(const BenchKernel *kernel, const BenchKernel *base)
{
    return kernel->base && !strcmp(kernel->base, base->name);
}

/* Chosen, or what a chosen one is compared with. */
static bool needed(const BenchKernelParams *params, const BenchKernel *kernel)
{
    if (chosen(params, kernel)) return true;
    for (int i = 0; i < KERNELS; i++)
        if (has_base(&kernels[i], kernel) && chosen(params, &kernels[i])) return true;
    return false;
}

/* ---- rows */

/* Not valid, nothing measured. */
static void start_row(const BenchJob *job, BenchKernelRow *row)
{
    const BenchKernel *kernel = job->kernel;
    *row = (BenchKernelRow){.w = job->w, .threads = job->threads, .items = job->items};
    row->ns = row->low = row->high = row->bound_ns = row->at_most = row->ratio = row->wanted = NAN;
    snprintf(row->kernel, sizeof row->kernel, "%s", kernel->name);
    snprintf(row->group, sizeof row->group, "%s", kernel->group);
    snprintf(row->item, sizeof row->item, "%s", job->item);
    snprintf(row->precision, sizeof row->precision, "%s", job->arithmetic);
    snprintf(row->isa, sizeof row->isa, "%s", job->peak->isa);
}

static void find_busy(const BenchTrial *trial, BenchKernelRow *row)
{
    if (!bench_watch_busy(&trial->watch)) return;
    row->busy = true;
    bench_watch_cause(&trial->watch, row->reason);
}

/* Of an item. */
static double ns_of(const BenchJob *job, int r)
{
    const BenchKernelKind *kind = job->kernel->kind;
    return 1e9 * (kind->seconds ? kind->seconds(job, r) : job->trial->seconds[r]) / job->per_run;
}

static void set_times(const BenchJob *job, BenchKernelRow *row)
{
    int samples = job->trial->samples;
    if (!samples) return;
    double *ns = sm_alloc((size_t)samples, sizeof *ns);
    for (int r = 0; r < samples; r++) ns[r] = ns_of(job, r);
    BenchQuartiles spread = bench_quartiles(ns, samples);
    free(ns);
    find_busy(job->trial, row);
    row->ns = spread.median;
    row->low = spread.low;
    row->high = spread.high;
}

static void set_bound(const BenchJob *job, BenchKernelRow *row)
{
    const char *limit;
    BenchPrecision precision = strcmp(row->precision, "double") ? BENCH_F32 : BENCH_F64;
    row->bound_ns =
        bench_bound(job->peak, &job->least, precision, row->threads, job->footprint, &limit);
    snprintf(row->bound, sizeof row->bound, "%s", limit);
}

/* What is wanted of this instruction set. */
static void set_limit(const BenchJob *job, BenchKernelRow *row)
{
    const BenchKernel *kernel = job->kernel;
    const char *isa = job->peak->isa;
    if (job->threads != 1 || job->precision != BENCH_F32) return;
    if (kernel->avx2_share > 0 && !strcmp(isa, "avx2"))
        row->at_most = row->bound_ns / kernel->avx2_share;
    else if (kernel->at_most > 0 && (!strcmp(isa, "avx512") || !strcmp(row->precision, "integer")))
        row->at_most = kernel->at_most;
}

/* The median over samples of how it compares with its base, timed just before or after. */
static void compare_samples(const BenchJob *job, const BenchJob *base, BenchKernelRow *row)
{
    const BenchKernel *kernel = job->kernel;
    int samples = job->trial->samples;
    if (!base->trial->valid) return;
    find_busy(base->trial, row);
    double *ratio = sm_alloc((size_t)samples, sizeof *ratio);
    row->wanted_least = kernel->threads > 1;
    for (int r = 0; r < samples; r++) {
        ratio[r] = ns_of(job, r) / ns_of(base, r);
        if (row->wanted_least) ratio[r] = 1 / ratio[r]; /* a speed-up */
    }
    row->ratio = bench_quartiles(ratio, samples).median;
    free(ratio);
    double share = (double)base->items / (double)job->items;
    bool same = bench_level_of(job->peak, job->footprint, job->threads) ==
                bench_level_of(job->peak, job->footprint * share, job->threads);
    /* the cost may rise where the state outgrows a cache, and a speed-up is over one thread */
    if (row->wanted_least ? base->threads == 1 : same) row->wanted = kernel->wanted;
    snprintf(row->ratio_to, sizeof row->ratio_to, "%s",
             row->wanted_least ? "1 thread"
             : kernel->doubled ? "single"
                               : kernel->base);
}

/* Processor time of an item beside that of the base, which has been timed in another set. */
static void compare_own(const BenchJob *job, double base_ns, BenchKernelRow *row)
{
    if (!(base_ns > 0 && job->own_ns > 0 && job->kernel->wanted > 0)) return;
    row->ratio = job->own_ns / base_ns;
    row->own_time = true;
    row->wanted = job->kernel->wanted;
    snprintf(row->ratio_to, sizeof row->ratio_to, "%s's %s", job->kernel->base,
             job->kernel->kind->own);
}

/* A row for a job that has been timed, unless it is only one to compare with. */
static void report(Run *run, BenchJob *job, const BenchJob *jobs, int count)
{
    const BenchKernelKind *kind = job->kernel->kind;
    bool shown = chosen(run->params, job->kernel);
    BenchKernelRow unseen, *row = shown ? &run->rows[(*run->count)++] : &unseen;
    start_row(job, row);
    row->valid = job->trial->valid;
    snprintf(row->reason, sizeof row->reason, "%s", job->trial->reason);
    if (!row->valid) return;
    set_times(job, row);
    kind->report(job, row);
    set_bound(job, row);
    set_limit(job, row);
    run->own_ns[job->kernel - kernels] = job->own_ns;
    for (int k = 0; k < KERNELS && kind->own; k++)
        if (has_base(job->kernel, &kernels[k])) compare_own(job, run->own_ns[k], row);
    for (int j = 0; j < count && !kind->own; j++)
        if (has_base(job->kernel, jobs[j].kernel)) compare_samples(job, &jobs[j], row);
}

/* ---- sets */

BenchJob bench_job(const BenchKernel *kernel, const BenchKernelParams *params,
                   const BenchPeak *peak)
{
    bool doubles = kernel->doubled || params->precision == BENCH_F64;
    return (BenchJob){.kernel = kernel,
                      .params = params,
                      .peak = peak,
                      .w = kernel->w,
                      .precision = doubles ? BENCH_F64 : BENCH_F32,
                      .arithmetic = doubles ? "double" : "single",
                      .threads = kernel->threads ? kernel->threads : params->threads};
}

SmCode bench_jobs_open(BenchJob *jobs, int count, SmError *error)
{
    SmCode code = SM_OK;
    for (int j = 0; j < count && !code; j++) {
        const BenchKernel *kernel = jobs[j].kernel;
        jobs[j].shares = j > 0 && kernel->set == jobs[j - 1].kernel->set;
        if (jobs[j].shares)
            jobs[j].body = jobs[j - 1].body;
        else if (kernel->kind->open)
            code = kernel->kind->open(kernel, jobs[j].params, &jobs[j].body, error);
    }
    return code;
}

SmCode bench_jobs_time(BenchJob *jobs, int count, SmError *error)
{
    BenchTrial **trials = sm_alloc((size_t)count, sizeof *trials);
    int different = 0;
    SmCode code = SM_OK;
    for (int j = 0; j < count && !code; j++) {
        int known = 0;
        code = jobs[j].kernel->kind->prepare(&jobs[j], error);
        while (known < different && trials[known] != jobs[j].trial) known++;
        if (code || known < different || !jobs[j].trial->timed.step) continue;
        trials[different++] = jobs[j].trial;
    }
    if (!code) bench_trials_time(trials, different, jobs->params->repeats);
    free(trials);
    return code;
}

void bench_jobs_close(BenchJob *jobs, int count)
{
    for (int j = 0; j < count; j++) {
        const BenchKernelKind *kind = jobs[j].kernel->kind;
        if (jobs[j].subject && kind->release) kind->release(jobs[j].subject);
        if (jobs[j].subject && jobs[j].trial) bench_trial_free(jobs[j].trial);
        free(jobs[j].subject);
    }
    for (int j = 0; j < count; j++)
        if (jobs[j].body && !jobs[j].shares) jobs[j].kernel->kind->close(jobs[j].body);
}

/* Kernels first .. last - 1, of one body; those that are timed in turn come first. */
static SmCode run_set(Run *run, int first, int last, SmError *error)
{
    BenchJob jobs[SET_MOST];
    int count = 0, together = 0;
    assert(last - first <= SET_MOST);
    for (int i = first; i < last; i++) {
        if (!needed(run->params, &kernels[i])) continue;
        jobs[count++] = bench_job(&kernels[i], run->params, run->peak);
        together += !kernels[i].kind->apart;
    }
    if (!count) return SM_OK;
    if (run->params->progress)
        bench_progress_show(run->params->progress, kernels[first].name, (double)first / KERNELS);
    SmCode code = bench_jobs_open(jobs, count, error);
    for (int j = 0, n; j < count && !code; j += n) {
        n = j < together ? together : 1;
        code = bench_jobs_time(&jobs[j], n, error);
        for (int i = j; i < j + n && !code; i++) report(run, &jobs[i], &jobs[j], n);
    }
    bench_jobs_close(jobs, count);
    return code;
}

SmCode bench_kernels_run(const BenchKernelParams *params, const BenchPeak *peak,
                         BenchKernelRow *rows, int *count, SmError *error)
{
    Run run = {.params = params, .peak = peak, .rows = rows, .count = count};
    SmCode code = SM_OK;
    int before = sm_team_enter(params->threads);
    *count = 0;
    for (int first = 0, last; first < KERNELS && !code; first = last) {
        for (last = first; last < KERNELS && kernels[last].set == kernels[first].set;) last++;
        code = run_set(&run, first, last, error);
    }
    sm_team_leave(before);
    return code;
}

const char *bench_kernel_verdict(const BenchKernelRow *row)
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
