#include "ab_samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../engines.h"
#include "../system/statistic.h"

const char *const bench_build_names[] = {"the baseline", "this build"};

const char *bench_value_name(const BenchAbScene *samples, int value)
{
    if (!value) return "total";
    if (value >= BENCH_TIMES) return bench_counter_names[value - BENCH_TIMES];
    return sm_engine_stage(bench_engine(samples->side[BENCH_NEW].row.engine)->type[0],
                           (SmStage)(value - 1));
}

bool bench_side_has(const BenchSide *side, int value)
{
    for (int i = 0; i < side->count; i++)
        if (!isfinite(side->value[value][i]) || side->value[value][i] <= 0) return false;
    return side->count > 0;
}

double bench_side_counter(const BenchSide *side, BenchCounter counter)
{
    int value = BENCH_TIMES + (int)counter;
    if (!bench_side_has(side, value)) return NAN;
    return bench_quantile(side->value[value], side->count, BENCH_LOW);
}

/* Old files may not say. */
static bool same_or_unsaid(const char *a, const char *b)
{
    return !*a || !*b || !strcmp(a, b);
}

BenchAbScene *bench_ab_scene(BenchAbSamples *all, const BenchRow *row)
{
    BenchAbScene *samples = NULL;
    for (int i = 0; i < all->count && !samples; i++) {
        BenchAbScene *s = &all->scenes[i];
        if (!strcmp(s->scene, row->scene) && same_or_unsaid(s->engine, row->engine) &&
            same_or_unsaid(s->precision, row->precision))
            samples = s;
    }
    if (!samples) {
        all->scenes = sm_realloc(all->scenes, (size_t)all->count + 1, sizeof *all->scenes);
        samples = &all->scenes[all->count++];
        *samples = (BenchAbScene){.side = {{.valid = true}, {.valid = true}}};
        snprintf(samples->scene, sizeof samples->scene, "%s", row->scene);
    }
    if (!*samples->engine) memcpy(samples->engine, row->engine, sizeof samples->engine);
    if (!*samples->precision) memcpy(samples->precision, row->precision, sizeof row->precision);
    return samples;
}

/* Measured on that build alone, and nothing says why. */
static bool alone(const BenchAbScene *samples, BenchBuild build)
{
    const BenchSide *other = &samples->side[!build];
    return samples->side[build].count && !other->count && !other->reason[0];
}

static void say_which(BenchAbScene *samples)
{
    size_t length = strlen(samples->scene);
    const char *between = *samples->precision ? ", " : ""; /* old files do not say it */
    snprintf(samples->scene + length, sizeof samples->scene - length, " (%s%s%s)", samples->engine,
             between, samples->precision);
}

void bench_ab_finish(BenchAbSamples *all)
{
    for (int i = 0; i < all->count; i++)
        for (int j = 0; j < all->count && alone(&all->scenes[i], BENCH_OLD); j++) {
            BenchAbScene *now = &all->scenes[j];
            if (strcmp(all->scenes[i].scene, now->scene) != 0 || !alone(now, BENCH_NEW)) continue;
            all->scenes[i].side[BENCH_NEW] = now->side[BENCH_NEW];
            memmove(now, now + 1, (size_t)(--all->count - j) * sizeof *now);
            if (j < i) i--;
            break;
        }
    bool *shared = sm_alloc((size_t)all->count + 1, sizeof *shared);
    for (int i = 0; i < all->count; i++)
        for (int j = 0; j < i; j++)
            if (!strcmp(all->scenes[i].scene, all->scenes[j].scene)) shared[i] = shared[j] = true;
    for (int i = 0; i < all->count; i++)
        if (shared[i]) say_which(&all->scenes[i]);
    free(shared);
}

/* Room for one process more, and its repeats. */
static void grow(BenchSide *side, int repeats)
{
    size_t processes = (size_t)side->count + 1, blocks = (size_t)side->blocks + (size_t)repeats;
    side->round = sm_realloc(side->round, processes, sizeof *side->round);
    for (int v = 0; v < BENCH_VALUES; v++) {
        side->value[v] = sm_realloc(side->value[v], processes, sizeof *side->value[v]);
        side->block[v] = sm_realloc(side->block[v], blocks, sizeof *side->block[v]);
    }
}

/* One of a repeat. */
static double value_of(const BenchRow *row, int repeat, int value)
{
    if (!value) return row->total[repeat];
    if (value < BENCH_TIMES) return row->stage[repeat][value - 1];
    return row->counter ? row->counter[repeat][value - BENCH_TIMES] : NAN;
}

void bench_ab_add(BenchAbSamples *all, BenchBuild build, int round, const BenchRow *row)
{
    BenchSide *side = &bench_ab_scene(all, row)->side[build];
    if (side->count == 0) {
        side->row = *row;
        side->row.total = NULL;
        side->row.stage = NULL;
        side->row.counter = NULL;
        side->row.change.time = NULL;
    }
    if (!row->valid && side->valid) {
        side->valid = false;
        snprintf(side->reason, sizeof side->reason, "%s", row->reason);
    }
    grow(side, row->repeats);
    for (int v = 0; v < BENCH_VALUES; v++) {
        double *block = side->block[v] + side->blocks;
        bool there = true;
        for (int r = 0; r < row->repeats; r++) there &= isfinite(block[r] = value_of(row, r, v));
        side->value[v][side->count] = there ? bench_quantile(block, row->repeats, 0.02) : NAN;
    }
    side->blocks += row->repeats;
    side->round[side->count++] = round;
}

void bench_ab_add_repeats(BenchAbSamples *all, BenchBuild build, const BenchRow *row)
{
    BenchRow one = *row;
    one.repeats = 1;
    if (!row->valid) bench_ab_add(all, build, 0, row);
    for (int r = 0; r < row->repeats && row->valid; r++) {
        one.total = row->total + r;
        one.stage = row->stage + r;
        one.counter = row->counter ? row->counter + r : NULL;
        bench_ab_add(all, build, r, &one);
    }
}

void bench_ab_free(BenchAbSamples *all)
{
    for (int i = 0; i < all->count; i++)
        for (int b = 0; b < BENCH_BUILDS; b++) {
            BenchSide *side = &all->scenes[i].side[b];
            free(side->round);
            for (int v = 0; v < BENCH_VALUES; v++) {
                free(side->value[v]);
                free(side->block[v]);
            }
        }
    free(all->scenes);
    *all = (BenchAbSamples){0};
}
