#include "burst.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/shell_engine.h"
#include "../system/statistic.h"
#include "measure.h"

SmCode bench_burst_create(const BenchScene *scene, int threads, BenchBurst *burst, SmError *error)
{
    const long most = 1000000;
    long steps = scene->frames * (long)scene->steps_per_frame;
    *burst = (BenchBurst){.steps = steps, .watch = bench_watch(threads)};
    if (steps < 1 || steps > most)
        return sm_fail(
            error, SM_INPUT,
            "%s: a shell that breaks is timed from its first step to its last, and these "
            "are %ld; give it 'frames' of 1 to %ld steps in all",
            scene->file, steps, most);
    burst->stage = sm_alloc((size_t)steps, sizeof *burst->stage);
    burst->seconds = sm_alloc((size_t)steps, sizeof *burst->seconds);
    burst->good = sm_alloc((size_t)steps, sizeof *burst->good);
    burst->cracked = sm_alloc((size_t)steps, sizeof *burst->cracked);
    return SM_OK;
}

void bench_burst_free(BenchBurst *burst)
{
    sm_free_all(burst->stage, burst->seconds, burst->good, burst->cracked);
    *burst = (BenchBurst){.steps = 0};
}

/* Keeps the times of a step if they count for more than those of rounds before. */
static void keep(BenchBurst *burst, long s, const SmLaps *laps)
{
    double seconds = 0;
    for (int k = 0; k < SM_STAGES; k++) seconds += laps->seconds[k];
    bool first = burst->seconds[s] == 0, good = burst->watch.good;
    bool less = good == burst->good[s] && seconds < burst->seconds[s];
    if (!first && !less && !(good && !burst->good[s])) return;
    burst->seconds[s] = seconds;
    memcpy(burst->stage[s], laps->seconds, sizeof burst->stage[s]);
    burst->good[s] = good;
}

void bench_burst_round(BenchBurst *burst, BenchPlayback *play)
{
    const BenchRunner *runner = bench_playback_runner(play);
    const RefShellBody *body = ref_shell_body(runner->engine);
    char state[BENCH_HASH_TEXT];
    burst->nodes[0] = body->sheet.warp.nodes;
    for (long s = 0; s < burst->steps; s++) {
        long before = body->breaking->cracked.cracks.pieces;
        SmLaps laps;
        bench_watch_start(&burst->watch);
        sm_laps_start(&laps);
        bench_playback_prepare(play);
        sm_lap(&laps, sm_engine_stages(runner->type)->before);
        bench_playback_advance(play, &laps);
        bench_watch_stop(&burst->watch);
        burst->cracked[s] = body->breaking->cracked.cracks.pieces != before;
        keep(burst, s, &laps);
    }
    burst->nodes[1] = body->sheet.warp.nodes;
    bench_playback_hash(play, state);
    burst->differs |= burst->state[0] && strcmp(burst->state, state) != 0;
    memcpy(burst->state, state, sizeof state);
}

void bench_burst_count(BenchBurst *burst)
{
    for (long s = 0; s < burst->steps; s++) {
        burst->watch.good = burst->good[s];
        bench_watch_count(&burst->watch);
    }
}

/* The seconds of steps that made cracks, or of those that did not, into [steps]; how many. */
static int seconds_of(const BenchBurst *burst, bool cracked, double *seconds)
{
    int count = 0;
    for (long s = 0; s < burst->steps; s++)
        if (burst->cracked[s] == cracked) seconds[count++] = burst->seconds[s];
    return count;
}

void bench_burst_row(const BenchBurst *burst, BenchRow *row)
{
    size_t steps = (size_t)burst->steps;
    double *whole = sm_alloc(steps, sizeof *whole);
    int calm = seconds_of(burst, false, whole);
    row->total = sm_alloc(steps, sizeof *row->total);
    row->stage = sm_alloc(steps, sizeof *row->stage);
    row->counter = NULL;
    row->steps = 1;
    row->repeats = seconds_of(burst, calm < burst->steps, row->total);
    for (long s = 0, r = 0; s < burst->steps; s++)
        if (burst->cracked[s] == (calm < burst->steps))
            memcpy(row->stage[r++], burst->stage[s], sizeof *row->stage);
    row->elastic.end_nodes = burst->nodes[1];
    row->elastic.whole_ms = calm ? 1e3 * bench_quartiles(whole, calm).median : NAN;
    free(whole);
    bench_row_times(&burst->watch, row);
    row->instruments_percent = NAN; /* there are no times without them */
    memcpy(row->state_hash, burst->state, sizeof row->state_hash);
    if (row->busy) row->elastic.whole_ms = NAN;
    if (calm == burst->steps) bench_row_invalidate(row, "no step has made a crack");
    if (burst->differs) bench_row_invalidate(row, "the same scene has ended in different states");
}
