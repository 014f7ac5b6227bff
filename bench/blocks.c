#include "blocks.h"

#include <math.h>
#include <stdlib.h>

#include "spread.h"

typedef struct {
    BenchTimed timed;
    int steps;    /* in a segment */
    int segments; /* in a block */
} Blocks;

/* Runs a segment's steps; seconds that they took. Adds to `stage` unless NULL. */
static double run_segment(Blocks *blocks, int steps, double stage[SM_STAGES])
{
    blocks->timed.restore(blocks->timed.subject);
    blocks->timed.step(blocks->timed.subject, NULL);
    SmLaps laps;
    double start = sm_now();
    if (stage) sm_laps_start(&laps);
    for (int i = 0; i < steps; i++) blocks->timed.step(blocks->timed.subject, stage ? &laps : NULL);
    double seconds = sm_now() - start;
    for (int s = 0; stage && s < SM_STAGES; s++) stage[s] += laps.seconds[s];
    return seconds;
}

/* Seconds a step of one block; fills stage seconds a step unless NULL. */
static double run_block(Blocks *blocks, double stage[SM_STAGES])
{
    double seconds = 0, steps = (double)blocks->steps * blocks->segments;
    for (int i = 0; i < blocks->segments; i++) seconds += run_segment(blocks, blocks->steps, stage);
    for (int s = 0; stage && s < SM_STAGES; s++) stage[s] /= steps;
    return seconds / steps;
}

/* Warms up and finds how many steps and segments fill a block. */
static void size_blocks(Blocks *blocks, double block_seconds)
{
    double step = run_segment(blocks, 1, NULL);
    for (int i = 0; i < 3; i++) step = fmin(step, run_segment(blocks, 2, NULL) / 2);
    double wanted = fmin(fmax(ceil(block_seconds / step), 1), 1e7);
    blocks->steps = (int)fmin(wanted, BENCH_SEGMENT_STEPS);
    blocks->segments = (int)ceil(wanted / blocks->steps);
    run_block(blocks, NULL);
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
        all += share[s] = bench_spread(sample, row->repeats).median;
    }
    for (size_t r = 0; r < count; r++) {
        sample[r] = 0;
        for (int s = 0; s < SM_STAGES; s++) sample[r] += row->stage[r][s];
        sample[r] /= row->total[r];
    }
    BenchSpread total = bench_spread(row->total, row->repeats);
    row->instruments_percent = 100 * (bench_spread(sample, row->repeats).median - 1);
    row->total_ms = 1e3 * total.median;
    row->total_low_ms = 1e3 * total.low;
    row->total_high_ms = 1e3 * total.high;
    for (int s = 0; s < SM_STAGES; s++)
        row->stage_ms[s] = all > 0 ? row->total_ms * share[s] / all : 0;
    row->fps = 1e3 / row->total_ms;
    row->ns_per_particle_step = 1e6 * row->total_ms / (double)row->particles;
    free(sample);
}

void bench_time_blocks(const BenchTimed *timed, const BenchMeasureParams *params, BenchRow *row)
{
    Blocks blocks = {.timed = *timed};
    size_blocks(&blocks, params->block_seconds > 0 ? params->block_seconds : 0.02);
    row->repeats = params->repeats > 0 ? params->repeats : 15;
    row->steps = blocks.steps * blocks.segments;
    row->total = sm_alloc((size_t)row->repeats, sizeof *row->total);
    row->stage = sm_alloc((size_t)row->repeats, sizeof *row->stage);
    for (int r = 0; r < row->repeats; r++) {
        if (r % 2) run_block(&blocks, row->stage[r]);
        row->total[r] = run_block(&blocks, NULL);
        if (r % 2 == 0) run_block(&blocks, row->stage[r]);
        if (params->progress)
            bench_progress_show(params->progress, row->scene, (r + 1.0) / row->repeats);
    }
    summarise(row);
}
