#include "step_timer.h"

#include <math.h>
#include <stdlib.h>

#include "../system/statistic.h"

typedef struct {
    BenchTimed timed;
    int threads;
    int steps;    /* in a segment */
    int segments; /* in a block */
    int chunk;    /* steps that are timed together: as many as fill bench_watch_span() */
    BenchWatch watch;
} Blocks;

/* What steps took, and counted. */
typedef struct {
    double seconds, stage[SM_STAGES];
    double steps;
    BenchCounts counts;
} Sum;

/* What has been timed: all, and what nobody disturbed. */
typedef struct {
    Sum all, good;
} Tally;

static void add(Sum *sum, int steps, double seconds, const SmLaps *laps, const BenchCounts *counts)
{
    sum->steps += steps;
    sum->seconds += seconds;
    for (int s = 0; laps && s < SM_STAGES; s++) sum->stage[s] += laps->seconds[s];
    bench_counts_add(&sum->counts, &(BenchCounts){0}, counts);
}

/* Times so many steps; false: they were disturbed. After a disturbance (`cold`) caches hold other
 * things, and the steps do not count either. */
static bool run_chunk(Blocks *blocks, int steps, bool clocks, bool cold, Tally *tally)
{
    SmLaps laps;
    bench_watch_start(&blocks->watch);
    if (clocks) sm_laps_start(&laps);
    for (int i = 0; i < steps; i++)
        blocks->timed.step(blocks->timed.subject, clocks ? &laps : NULL);
    double seconds = bench_watch_stop(&blocks->watch);
    const BenchWatch *watch = &blocks->watch;
    add(&tally->all, steps, seconds, clocks ? &laps : NULL, &watch->counts);
    if (watch->good && !cold)
        add(&tally->good, steps, seconds, clocks ? &laps : NULL, &watch->counts);
    return watch->good;
}

static void run_segment(Blocks *blocks, int steps, bool clocks, Tally *tally)
{
    bool cold = false;
    blocks->timed.restore(blocks->timed.subject);
    blocks->timed.step(blocks->timed.subject, NULL);
    for (int done = 0; done < steps; done += blocks->chunk) {
        int left = steps - done;
        cold = !run_chunk(blocks, left < blocks->chunk ? left : blocks->chunk, clocks, cold, tally);
    }
}

/* One block, and more segments while less than half of it was undisturbed, up to as many again.
 * False: still less than half; then all of it counts. */
static bool run_block(Blocks *blocks, double *total, double counter[BENCH_COUNTERS],
                      double stage[SM_STAGES])
{
    Tally block = {0};
    double half = 0.5 * blocks->steps * blocks->segments;
    int most = 3 * blocks->segments;
    for (int i = 0; i < most && (i < blocks->segments || block.good.steps < half); i++)
        run_segment(blocks, blocks->steps, stage != NULL, &block);
    bool good = block.good.steps >= half;
    const Sum *sum = good ? &block.good : &block.all;
    if (total) *total = sum->seconds / sum->steps;
    if (counter) bench_counts_each(&sum->counts, sum->steps, counter);
    for (int s = 0; stage && s < SM_STAGES; s++) stage[s] = sum->stage[s] / sum->steps;
    return good;
}

/* Warms up and finds how many steps and segments fill a block; if one step does, three timed ones
 * are enough. */
static void size_blocks(Blocks *blocks, double block_seconds)
{
    double step = INFINITY, chunk = bench_watch_span(blocks->threads);
    for (int i = 0; i < 4 && (i < 2 || step < block_seconds); i++) {
        Tally tally = {0};
        run_segment(blocks, i ? 2 : 1, false, &tally);
        step = fmin(step, tally.all.seconds / tally.all.steps);
    }
    double wanted = fmin(fmax(ceil(block_seconds / step), 1), 1e7);
    blocks->steps = (int)fmin(wanted, BENCH_SEGMENT_STEPS);
    blocks->segments = (int)ceil(wanted / blocks->steps);
    blocks->chunk = (int)fmin(fmax(ceil(chunk / step), 1), blocks->steps);
}

/* Both blocks of a repeat. False: one of them was disturbed. */
static bool run_repeat(Blocks *blocks, int r, BenchRow *row)
{
    bool good = true;
    if (r % 2) good &= run_block(blocks, NULL, NULL, row->stage[r]);
    good &= run_block(blocks, &row->total[r], row->counter[r], NULL);
    if (r % 2 == 0) good &= run_block(blocks, NULL, NULL, row->stage[r]);
    return good;
}

/* Medians, quartiles and shares from the repeats' samples. */
static void summarise(BenchRow *row)
{
    size_t count = (size_t)row->repeats;
    double *sample = sm_alloc(count, sizeof *sample), share[SM_STAGES], all = 0;
    for (int s = 0; s < SM_STAGES; s++) {
        for (size_t r = 0; r < count; r++) {
            double sum = 0;
            for (int t = 0; t < SM_STAGES; t++) sum += row->stage[r][t];
            sample[r] = sum > 0 ? row->stage[r][s] / sum : 0;
        }
        all += share[s] = bench_quartiles(sample, row->repeats).median;
    }
    for (size_t r = 0; r < count; r++) {
        sample[r] = 0;
        for (int s = 0; s < SM_STAGES; s++) sample[r] += row->stage[r][s];
        sample[r] /= row->total[r];
    }
    BenchQuartiles total = bench_quartiles(row->total, row->repeats);
    row->instruments_percent = 100 * (bench_quartiles(sample, row->repeats).median - 1);
    row->total_ms = 1e3 * total.median;
    row->total_low_ms = 1e3 * total.low;
    row->total_high_ms = 1e3 * total.high;
    for (int s = 0; s < SM_STAGES; s++)
        row->stage_ms[s] = all > 0 ? row->total_ms * share[s] / all : 0;
    row->fps = 1e3 / row->total_ms;
    row->ns_per_particle_step = 1e6 * row->total_ms / (double)row->particles;
    free(sample);
}

/* Medians of what was counted; NaN where a sample is not known. */
static void summarise_counters(BenchRow *row)
{
    double *sample = sm_alloc((size_t)row->repeats, sizeof *sample);
    for (int c = 0; c < BENCH_COUNTERS; c++) {
        bool known = true;
        for (int r = 0; r < row->repeats; r++) known &= isfinite(sample[r] = row->counter[r][c]);
        *bench_row_counter(row, (BenchCounter)c) =
            known ? bench_quartiles(sample, row->repeats).median : NAN;
    }
    free(sample);
    if (bench_row_counted(row)) return;
    free(row->counter);
    row->counter = NULL;
}

/* A busy row has no times. */
static void find_busy(const BenchWatch *watch, BenchRow *row)
{
    row->lost_percent = bench_watch_lost(watch);
    row->load = bench_load_average();
    row->busy = bench_watch_busy(watch);
    if (row->valid) bench_watch_cause(watch, row->reason);
    if (!row->busy) return;
    row->total_ms = row->total_low_ms = row->total_high_ms = NAN;
    row->fps = row->ns_per_particle_step = row->instruments_percent = NAN;
    for (int s = 0; s < SM_STAGES; s++) row->stage_ms[s] = NAN;
}

void bench_row_times(const BenchWatch *watch, BenchRow *row)
{
    summarise(row);
    find_busy(watch, row);
}

void bench_time_steps(const BenchTimed *timed, const BenchMeasureParams *params, BenchRow *row)
{
    Blocks blocks = {.timed = *timed, .threads = params->threads, .chunk = 1};
    blocks.watch = bench_watch(params->threads);
    size_blocks(&blocks, params->block_seconds > 0 ? params->block_seconds : 0.02);
    row->repeats = params->repeats > 0 ? params->repeats : 15;
    row->steps = blocks.steps * blocks.segments;
    row->total = sm_alloc((size_t)row->repeats, sizeof *row->total);
    row->stage = sm_alloc((size_t)row->repeats, sizeof *row->stage);
    row->counter = sm_alloc((size_t)row->repeats, sizeof *row->counter);
    run_block(&blocks, NULL, NULL, NULL);
    BenchCounters counters; /* of the threads, which are there now */
    bench_counters_open(params->events ? params->events : bench_processor_events, &counters);
    blocks.watch = bench_watch(params->threads);
    blocks.watch.counters = counters.threads ? &counters : NULL;
    for (int r = 0; r < row->repeats; r++) {
        do blocks.watch.good = run_repeat(&blocks, r, row);
        while (bench_watch_again(&blocks.watch));
        if (params->progress)
            bench_progress_show(params->progress, row->scene, (r + 1.0) / row->repeats);
    }
    bench_counters_close(&counters);
    summarise_counters(row);
    bench_row_times(&blocks.watch, row);
}
