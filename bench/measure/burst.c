#include "burst.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/shell_engine.h"
#include "../system/statistic.h"
#include "measure.h"

static BenchBurst make_burst(const BenchScene *scene, int threads)
{
    int steps = (int)scene->frames * scene->steps_per_frame;
    size_t n = (size_t)steps;
    return (BenchBurst){.steps = steps,
                        .stage = sm_alloc(n, sizeof(double[SM_STAGES])),
                        .seconds = sm_alloc(n, sizeof(double)),
                        .cracked = sm_alloc(n, sizeof(bool)),
                        .watch = bench_watch(threads)};
}

void bench_burst_free(BenchBurst *burst)
{
    sm_free_all(burst->stage, burst->seconds, burst->cracked);
    *burst = (BenchBurst){.steps = 0};
}

/* Keeps the times of a step if they count for more than those of rounds before. */
static void keep(BenchBurst *burst, int s, const SmLaps *laps, bool *good)
{
    double seconds = 0;
    for (int k = 0; k < SM_STAGES; k++) seconds += laps->seconds[k];
    bool first = burst->seconds[s] == 0, better = burst->watch.good && !*good;
    bool less = burst->watch.good == *good && seconds < burst->seconds[s];
    if (!first && !better && !less) return;
    burst->seconds[s] = seconds;
    memcpy(burst->stage[s], laps->seconds, sizeof burst->stage[s]);
    *good = burst->watch.good;
}

static void play_round(BenchBurst *burst, bool *good, BenchPlayback *play)
{
    const RefShellBody *body = ref_shell_body(bench_playback_runner(play)->engine);
    burst->nodes[0] = body->sheet.warp.nodes;
    for (int s = 0; s < burst->steps; s++) {
        int before = body->breaking->cracked.cracks.now;
        SmLaps laps;
        bench_playback_prepare(play);
        bench_watch_start(&burst->watch);
        sm_laps_start(&laps);
        bench_playback_advance(play, &laps);
        bench_watch_stop(&burst->watch);
        burst->cracked[s] = body->breaking->cracked.cracks.now != before;
        keep(burst, s, &laps, good + s);
    }
    burst->nodes[1] = body->sheet.warp.nodes;
}

/* Steps that no round has undisturbed. */
static void count_disturbed(BenchBurst *burst, const bool *good)
{
    for (int s = 0; s < burst->steps; s++) {
        burst->watch.good = good[s];
        bench_watch_count(&burst->watch);
    }
}

SmCode bench_burst_play(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        const BenchMeasureParams *params, int rounds, BenchBurst *burst,
                        BenchPlayback *play, SmError *error)
{
    char first[BENCH_HASH_TEXT] = "", last[BENCH_HASH_TEXT];
    SmCode code = SM_OK;
    *burst = make_burst(scene, params->threads);
    bool *good = sm_alloc((size_t)burst->steps, sizeof *good);
    for (int round = 0; round < rounds && !code; round++) {
        if (round > 0) bench_playback_free(play);
        code = bench_playback_create(scene, body, type, params->threads, params->seed, play, error);
        if (code) break;
        play_round(burst, good, play);
        bench_playback_hash(play, last);
        if (round == 0) memcpy(first, last, sizeof first);
        burst->differs |= strcmp(first, last) != 0;
        if (params->progress)
            bench_progress_show(params->progress, scene->name, (round + 1.0) / rounds);
    }
    count_disturbed(burst, good);
    free(good);
    if (code) bench_burst_free(burst);
    return code;
}

int bench_burst_seconds(const BenchBurst *burst, bool cracked, double *seconds)
{
    int count = 0;
    for (int s = 0; s < burst->steps; s++)
        if (burst->cracked[s] == cracked) seconds[count++] = burst->seconds[s];
    return count;
}

void bench_burst_row(const BenchBurst *burst, BenchRow *row)
{
    size_t steps = (size_t)burst->steps;
    double *whole = sm_alloc(steps, sizeof *whole);
    int calm = bench_burst_seconds(burst, false, whole);
    row->total = sm_alloc(steps, sizeof *row->total);
    row->stage = sm_alloc(steps, sizeof *row->stage);
    row->counter = NULL;
    row->steps = 1;
    row->repeats = bench_burst_seconds(burst, calm < burst->steps, row->total);
    for (int s = 0, r = 0; s < burst->steps; s++)
        if (burst->cracked[s] == (calm < burst->steps))
            memcpy(row->stage[r++], burst->stage[s], sizeof *row->stage);
    row->elastic.nodes = burst->nodes[0];
    row->elastic.end_nodes = burst->nodes[1];
    row->elastic.whole_ms = calm ? 1e3 * bench_quartiles(whole, calm).median : NAN;
    free(whole);
    bench_row_times(&burst->watch, row);
    if (row->busy) row->elastic.whole_ms = NAN;
    if (calm == burst->steps) bench_row_invalidate(row, "no step has made a crack");
    if (burst->differs)
        bench_row_invalidate(row, "the same scene has ended in different states");
}
