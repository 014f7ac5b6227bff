#include "change_row.h"

#include <math.h>
#include <stdlib.h>

#include "../system/statistic.h"
#include "disturbance.h"

enum { SIMULATION, CHANGE, FOLLOW, SURFACE }; /* in the order of BenchChangeRow */

/* Of every frame. */
typedef struct {
    long frames;
    double (*least)[BENCH_FRAME_PARTS]; /* seconds: the least of all rounds that no other program
                                         * disturbed, or of all */
    bool (*good)[BENCH_FRAME_PARTS];    /* a round was undisturbed */
    bool *changed;
    BenchWatch watch; /* of what is under way */
} Times;

static Times make_times(long frames, int threads)
{
    size_t n = (size_t)frames;
    Times t = {.frames = frames, .watch = bench_watch(threads)};
    t.least = sm_alloc(n, sizeof *t.least);
    t.good = sm_alloc(n, sizeof *t.good);
    t.changed = sm_alloc(n, sizeof *t.changed);
    for (long f = 0; f < frames; f++)
        for (int p = 0; p < BENCH_FRAME_PARTS; p++) t.least[f][p] = INFINITY;
    return t;
}

static void free_times(Times *t)
{
    free(t->least);
    free(t->good);
    free(t->changed);
}

static void keep_least(Times *times, long frame, int part, double seconds)
{
    double *least = &times->least[frame][part];
    bool *good = &times->good[frame][part];
    if (*good && !times->watch.good) return;
    *least = *good == times->watch.good ? fmin(*least, seconds) : seconds;
    *good = times->watch.good;
}

/* What the frame's changes took, of all groups. */
static void note_changes(const BenchPlayback *play, long frame, Times *times, BenchChangeRow *row)
{
    double resample = 0, follow = 0;
    long added = 0;
    for (int g = 0; g < play->count; g++) {
        const BenchChanged *last = &play->group[g].last;
        resample += last->resample_seconds;
        follow += last->follow_seconds;
        added += last->nodes;
        if (last->levels > row->most_levels) row->most_levels = last->levels;
        times->changed[frame] |= last->resampled;
    }
    long nodes = bench_playback_particles(play);
    if (nodes > row->most_nodes) row->most_nodes = nodes;
    if (added > row->most_added) row->most_added = added;
    keep_least(times, frame, CHANGE, resample);
    keep_least(times, frame, FOLLOW, follow);
}

/* Moves the surfaces; seconds for one body. */
static double move_surfaces(BenchPlayback *play, BenchWatch *watch)
{
    long vertices, triangles;
    bench_playback_size(play, &vertices, &triangles);
    double(*point)[3] = sm_alloc((size_t)vertices, sizeof *point);
    bench_watch_start(watch);
    bench_playback_points(play, point);
    double seconds = bench_watch_stop(watch);
    free(point);
    return seconds / (double)play->body->instances;
}

static SmCode play_frame(BenchPlayback *play, long frame, Times *times, BenchChangeRow *row,
                         SmError *error)
{
    bench_watch_start(&times->watch);
    SmCode code = bench_playback_change(play, error);
    bench_watch_stop(&times->watch);
    if (code) return code;
    note_changes(play, frame, times, row);
    bench_watch_start(&times->watch);
    for (int s = 0; s < play->scene->steps_per_frame; s++) {
        bench_playback_prepare(play);
        bench_playback_advance(play, NULL);
    }
    keep_least(times, frame, SIMULATION, bench_watch_stop(&times->watch));
    keep_least(times, frame, SURFACE, move_surfaces(play, &times->watch));
    return SM_OK;
}

/* Median of a frame's seconds from .. to - 1, in ms, of those that changed where `changed` is set;
 * NaN of none. */
static double median_ms(const Times *times, int part, long from, long to, bool changed)
{
    int count = 0;
    double *chosen = sm_alloc((size_t)times->frames, sizeof *chosen), median = NAN;
    for (long f = from; f < to; f++)
        if (!changed || times->changed[f]) chosen[count++] = times->least[f][part];
    if (count) median = 1e3 * bench_quartiles(chosen, count).median;
    free(chosen);
    return median;
}

static void summarise(const Times *times, BenchChangeRow *row)
{
    long first = times->frames, last = 0;
    row->frames = times->frames;
    row->change_most_ms = NAN;
    for (long f = 0; f < times->frames; f++) {
        if (!times->changed[f]) continue;
        if (f < first) first = f;
        last = f + 1;
        row->changed++;
        row->change_most_ms = fmax(row->change_most_ms, 1e3 * times->least[f][CHANGE]);
    }
    /* scenes that change from the first frame on, or to the last, still have a first and a last */
    row->first_ms = median_ms(times, SIMULATION, 0, first > 0 ? first : 1, false);
    row->last_ms = median_ms(times, SIMULATION, last < times->frames ? last : times->frames - 1,
                             times->frames, false);
    row->change_ms = median_ms(times, CHANGE, 0, times->frames, true);
    row->follow_ms = median_ms(times, FOLLOW, 0, times->frames, true);
    row->surface_ms = median_ms(times, SURFACE, 0, times->frames, false);
}

/* Leaves out the times of a busy machine: of more than a quarter of the frames a part was disturbed
 * in every round. */
static void find_busy(Times *times, char *cause, BenchChangeRow *row)
{
    for (long f = 0; f < times->frames; f++) {
        times->watch.good = true;
        for (int p = 0; p < BENCH_FRAME_PARTS; p++) times->watch.good &= times->good[f][p];
        bench_watch_count(&times->watch);
    }
    if (!bench_watch_busy(&times->watch)) return;
    if (cause) bench_watch_cause(&times->watch, cause);
    row->first_ms = row->last_ms = row->change_ms = row->change_most_ms = NAN;
    row->follow_ms = row->surface_ms = NAN;
}

static void note_end(const BenchPlayback *play, BenchChangeRow *row)
{
    long vertices;
    row->last_nodes = bench_playback_particles(play);
    bench_playback_size(play, &vertices, &row->last_triangles);
    for (int g = 0; g < play->count; g++) {
        SmMeshInfo info = sm_mesh_info(&play->group[g].skin.surface);
        long bodies = play->group[g].body.instances;
        row->pieces += bodies * info.components;
        row->open_edges += bodies * (info.open_edges + info.nonmanifold_edges);
        row->left += bodies * play->group[g].skin.incomplete;
    }
}

static SmCode play_round(BenchPlayback *play, int round, const BenchChangeRowParams *params,
                         Times *times, BenchChangeRow *row, SmError *error)
{
    const BenchScene *scene = play->scene;
    SmCode code = SM_OK;
    long vertices;
    row->first_nodes = row->most_nodes = bench_playback_particles(play);
    bench_playback_size(play, &vertices, &row->first_triangles);
    for (long f = 0; f < times->frames && !code; f++) {
        code = play_frame(play, f, times, row, error);
        if (params->progress)
            bench_progress_show(params->progress, scene->name,
                                ((double)round + (double)(f + 1) / (double)times->frames) /
                                    params->rounds);
    }
    return code;
}

SmCode bench_change_row_measure(const BenchScene *scene, const BenchBody *body,
                                const SmEngineType *type, const BenchChangeRowParams *params,
                                BenchChangeRow *row, BenchPlayback *play, SmError *error)
{
    Times times = make_times(scene->frames > 0 ? scene->frames : 1, params->threads);
    SmCode code = SM_OK;
    *row = (BenchChangeRow){0};
    for (int round = 0; round < params->rounds && !code; round++) {
        if (round > 0) bench_playback_free(play);
        code = bench_playback_create(scene, body, type, params->threads, params->seed, play, error);
        if (code) break;
        code = play_round(play, round, params, &times, row, error);
        if (code) bench_playback_free(play);
    }
    if (!code) {
        summarise(&times, row);
        find_busy(&times, params->cause, row);
        note_end(play, row);
        row->time = times.least;
        times.least = NULL;
    }
    free_times(&times);
    return code;
}
