#include "frames.h"

#include <math.h>
#include <stdlib.h>

#include "spread.h"

/* Seconds in every frame: the least of all rounds. */
typedef struct {
    long frames;
    double *simulation, *change, *follow, *surface;
    bool *changed;
} Times;

static Times make_times(long frames)
{
    size_t n = (size_t)frames;
    Times t = {frames,
               sm_alloc(n, sizeof(double)),
               sm_alloc(n, sizeof(double)),
               sm_alloc(n, sizeof(double)),
               sm_alloc(n, sizeof(double)),
               sm_alloc(n, sizeof(bool))};
    for (long f = 0; f < frames; f++)
        t.simulation[f] = t.change[f] = t.follow[f] = t.surface[f] = INFINITY;
    return t;
}

static void keep_times(const Times *t, BenchChangeRow *row)
{
    row->time = sm_alloc((size_t)t->frames, sizeof *row->time);
    for (long f = 0; f < t->frames; f++) {
        row->time[f][0] = t->simulation[f];
        row->time[f][1] = t->change[f];
        row->time[f][2] = t->follow[f];
        row->time[f][3] = t->surface[f];
    }
}

static void free_times(Times *t)
{
    free(t->simulation);
    free(t->change);
    free(t->follow);
    free(t->surface);
    free(t->changed);
}

static void keep_least(double *least, double seconds)
{
    *least = fmin(*least, seconds);
}

/* What the frame's changes took, of all parts. */
static void note_changes(const BenchPlay *play, long frame, Times *times, BenchChangeRow *row)
{
    double resample = 0, follow = 0;
    long added = 0;
    for (int p = 0; p < play->cast.count; p++) {
        const BenchChanged *last = &play->changes[p].last;
        resample += last->resample_seconds;
        follow += last->follow_seconds;
        added += last->nodes;
        times->changed[frame] |= last->resampled;
    }
    long nodes = bench_cast_particles(&play->cast);
    if (nodes > row->most_nodes) row->most_nodes = nodes;
    if (added > row->most_added) row->most_added = added;
    keep_least(&times->change[frame], resample);
    keep_least(&times->follow[frame], follow);
}

/* Moves the surfaces; seconds for one body. */
static double move_surfaces(BenchPlay *play)
{
    long vertices = 0;
    for (int p = 0; p < play->cast.count; p++)
        vertices += play->cast.part[p].body.instances * play->changes[p].surface.vertex_count;
    double(*point)[3] = sm_alloc((size_t)vertices, sizeof *point);
    double start = sm_now();
    bench_play_points(play, point);
    double seconds = sm_now() - start;
    free(point);
    return seconds / (double)play->cast.body->instances;
}

static SmCode play_frame(BenchPlay *play, long frame, Times *times, BenchChangeRow *row,
                         SmError *error)
{
    SmCode code = bench_play_change(play, error);
    if (code) return code;
    note_changes(play, frame, times, row);
    double start = sm_now();
    for (int s = 0; s < play->cast.scene->steps_per_frame; s++) {
        bench_play_prepare(play);
        bench_play_advance(play, NULL);
    }
    keep_least(&times->simulation[frame], sm_now() - start);
    keep_least(&times->surface[frame], move_surfaces(play));
    return SM_OK;
}

/* Median of a frame's seconds from .. to - 1, in ms, of those that changed where `changed` is set;
 * NaN of none. */
static double median_ms(const Times *times, const double *seconds, long from, long to, bool changed)
{
    int count = 0;
    double *chosen = sm_alloc((size_t)times->frames, sizeof *chosen), median = NAN;
    for (long f = from; f < to; f++)
        if (!changed || times->changed[f]) chosen[count++] = seconds[f];
    if (count) median = 1e3 * bench_spread(chosen, count).median;
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
        row->change_most_ms = fmax(row->change_most_ms, 1e3 * times->change[f]);
    }
    /* scenes that change from the first frame on, or to the last, still have a first and a last */
    row->first_ms = median_ms(times, times->simulation, 0, first > 0 ? first : 1, false);
    row->last_ms = median_ms(times, times->simulation,
                             last < times->frames ? last : times->frames - 1, times->frames, false);
    row->change_ms = median_ms(times, times->change, 0, times->frames, true);
    row->follow_ms = median_ms(times, times->follow, 0, times->frames, true);
    row->surface_ms = median_ms(times, times->surface, 0, times->frames, false);
}

static long count_triangles(const BenchPlay *play)
{
    long triangles = 0;
    for (int p = 0; p < play->cast.count; p++)
        triangles += play->cast.part[p].body.instances * play->changes[p].surface.triangle_count;
    return triangles;
}

static void note_end(const BenchPlay *play, BenchChangeRow *row)
{
    row->last_nodes = bench_cast_particles(&play->cast);
    row->last_triangles = count_triangles(play);
    for (int p = 0; p < play->cast.count; p++) {
        SmMeshInfo info = sm_mesh_info(&play->changes[p].surface);
        long bodies = play->cast.part[p].body.instances;
        row->pieces += bodies * info.components;
        row->open_edges += bodies * (info.open_edges + info.nonmanifold_edges);
        row->left += bodies * play->changes[p].left;
    }
}

static SmCode play_round(BenchPlay *play, int round, const BenchFramesParams *params, Times *times,
                         BenchChangeRow *row, SmError *error)
{
    const BenchScene *scene = play->cast.scene;
    SmCode code = SM_OK;
    row->first_nodes = row->most_nodes = bench_cast_particles(&play->cast);
    row->first_triangles = count_triangles(play);
    for (long f = 0; f < times->frames && !code; f++) {
        code = play_frame(play, f, times, row, error);
        if (params->progress)
            bench_progress_show(params->progress, scene->name,
                                ((double)round + (double)(f + 1) / (double)times->frames) /
                                    params->rounds);
    }
    return code;
}

SmCode bench_frames_play(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         const BenchFramesParams *params, BenchChangeRow *row, BenchPlay *play,
                         SmError *error)
{
    Times times = make_times(scene->frames > 0 ? scene->frames : 1);
    SmCode code = SM_OK;
    *row = (BenchChangeRow){0};
    for (int round = 0; round < params->rounds && !code; round++) {
        if (round > 0) bench_play_free(play);
        code = bench_play_create(scene, body, type, params->threads, params->seed, play, error);
        if (code) break;
        code = play_round(play, round, params, &times, row, error);
        if (code) bench_play_free(play);
    }
    if (!code) {
        summarise(&times, row);
        note_end(play, row);
        keep_times(&times, row);
    }
    free_times(&times);
    return code;
}
