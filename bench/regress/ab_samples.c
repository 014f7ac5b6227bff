#include "ab_samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../engines.h"
#include "../system/statistic.h"

const char *const bench_build_names[] = {"the baseline", "this build"};

const char *bench_time_name(const BenchAbScene *samples, int time)
{
    if (!time) return "total";
    return sm_engine_stage(bench_engine(samples->side[BENCH_NEW].row.engine)->type[0],
                           (SmStage)(time - 1));
}

BenchAbScene *bench_ab_scene(BenchAbSamples *all, const char *scene)
{
    for (int i = 0; i < all->count; i++)
        if (!strcmp(all->scenes[i].scene, scene)) return &all->scenes[i];
    all->scenes = sm_realloc(all->scenes, (size_t)all->count + 1, sizeof *all->scenes);
    BenchAbScene *samples = &all->scenes[all->count++];
    memset(samples, 0, sizeof *samples);
    snprintf(samples->scene, sizeof samples->scene, "%s", scene);
    for (int b = 0; b < BENCH_BUILDS; b++) {
        samples->side[b].valid = true;
        samples->side[b].instructions = NAN;
    }
    return samples;
}

/* Room for one process more, and its repeats. */
static void grow(BenchSide *side, int repeats)
{
    size_t processes = (size_t)side->count + 1, blocks = (size_t)side->blocks + (size_t)repeats;
    side->round = sm_realloc(side->round, processes, sizeof *side->round);
    for (int t = 0; t < BENCH_TIMES; t++) {
        side->time[t] = sm_realloc(side->time[t], processes, sizeof *side->time[t]);
        side->block[t] = sm_realloc(side->block[t], blocks, sizeof *side->block[t]);
    }
}

void bench_ab_add(BenchAbSamples *all, BenchBuild build, int round, const BenchRow *row)
{
    BenchSide *side = &bench_ab_scene(all, row->scene)->side[build];
    if (side->count == 0) {
        side->row = *row;
        side->row.total = NULL;
        side->row.stage = NULL;
        side->row.change.time = NULL;
    }
    if (!row->valid && side->valid) {
        side->valid = false;
        snprintf(side->reason, sizeof side->reason, "%s", row->reason);
    }
    grow(side, row->repeats);
    for (int t = 0; t < BENCH_TIMES; t++) {
        double *block = side->block[t] + side->blocks;
        bool there = true;
        for (int r = 0; r < row->repeats; r++) {
            block[r] = t ? row->stage[r][t - 1] : row->total[r];
            there &= isfinite(block[r]);
        }
        side->time[t][side->count] = there ? bench_quantile(block, row->repeats, 0.02) : NAN;
    }
    side->blocks += row->repeats;
    side->round[side->count++] = round;
}

void bench_ab_free(BenchAbSamples *all)
{
    for (int i = 0; i < all->count; i++)
        for (int b = 0; b < BENCH_BUILDS; b++) {
            BenchSide *side = &all->scenes[i].side[b];
            free(side->round);
            for (int t = 0; t < BENCH_TIMES; t++) {
                free(side->time[t]);
                free(side->block[t]);
            }
        }
    free(all->scenes);
    *all = (BenchAbSamples){0};
}
