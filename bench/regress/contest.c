#include "contest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../system/statistic.h"

const char *bench_time_name(int time)
{
    return time ? sm_stage_name((SmStage)(time - 1)) : "total";
}

BenchContest *bench_contest_of(BenchContests *all, const char *scene)
{
    for (int i = 0; i < all->count; i++)
        if (!strcmp(all->contest[i].scene, scene)) return &all->contest[i];
    all->contest = sm_realloc(all->contest, (size_t)all->count + 1, sizeof *all->contest);
    BenchContest *contest = &all->contest[all->count++];
    memset(contest, 0, sizeof *contest);
    snprintf(contest->scene, sizeof contest->scene, "%s", scene);
    for (int b = 0; b < BENCH_BUILDS; b++) {
        contest->side[b].valid = true;
        contest->side[b].instructions = NAN;
    }
    return contest;
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

void bench_contest_add(BenchContests *all, BenchBuild build, int round, const BenchRow *row)
{
    BenchSide *side = &bench_contest_of(all, row->scene)->side[build];
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

void bench_contests_free(BenchContests *all)
{
    for (int i = 0; i < all->count; i++)
        for (int b = 0; b < BENCH_BUILDS; b++) {
            BenchSide *side = &all->contest[i].side[b];
            free(side->round);
            for (int t = 0; t < BENCH_TIMES; t++) {
                free(side->time[t]);
                free(side->block[t]);
            }
        }
    free(all->contest);
    *all = (BenchContests){0};
}
