#include "recording.h"

#include <stdlib.h>

#include "../engines.h"

static void release(BenchRecording *recording)
{
    sm_mesh_free(&recording->surface);
    free(recording->point);
    for (int f = 0; f < BENCH_POINT_FIELDS; f++) free(recording->value[f]);
    free(recording->x);
    free(recording->v);
    free(recording->g);
    free(recording->S);
    *recording = (BenchRecording){0};
}

static bool has_tree(const BenchEngine *engine)
{
    return engine->structure;
}

static SmCode check(const BenchPlayback *play, const BenchRunner *runner, BenchRecord record,
                    SmError *error)
{
    const BenchBody *body = play->body;
    if ((double)body->instances * (double)body->mesh.vertex_count > 2e9)
        return sm_fail(error, SM_INPUT, "%s: the surfaces of %ld instances have too many vertices",
                       runner->scene->file, body->instances);
    bool tree = has_tree(bench_engine(runner->type->name));
    char names[BENCH_ENGINES_TEXT];
    if (record == BENCH_RECORD_PARTICLES && tree)
        return sm_fail(error, SM_USAGE,
                       "--record particles stores a lattice, and %s has none: give --record nodes",
                       runner->type->name);
    if (record == BENCH_RECORD_NODES && !tree)
        return sm_fail(error, SM_USAGE,
                       "--record nodes stores an octree, and %s has none: give --record particles, "
                       "or --engine %s",
                       runner->type->name, bench_engines_that(has_tree, names));
    if (record && bench_playback_changes(play))
        return sm_fail(
            error, SM_USAGE,
            "--record stores bodies that stay as they are, and %s may cut, break or refine its "
            "own: leave --record out, and the surface is still written",
            runner->scene->file);
    return SM_OK;
}

/* The surface at rest, and room for what is found of it. */
static void take_surface(BenchRecording *recording)
{
    sm_mesh_free(&recording->surface);
    recording->surface = bench_playback_surface(recording->play);
    size_t count = (size_t)recording->surface.vertex_count;
    recording->point = sm_realloc(recording->point, count, sizeof *recording->point);
    for (int f = 0; f < BENCH_POINT_FIELDS; f++)
        if (recording->fields & 1u << f)
            recording->value[f] = sm_realloc(
                recording->value[f], count * (size_t)bench_field_components[f], sizeof(float));
}

SmCode bench_recording_open(BenchPlayback *play, const char *path, BenchRecord record,
                            BenchFields fields, const BenchMachine *machine,
                            BenchRecording *recording, SmError *error)
{
    const BenchRunner *runner = bench_playback_runner(play);
    const BenchBody *body = runner->body;
    SmCode code = check(play, runner, record, error);
    if (!code) code = bench_fields_check(play, fields, error);
    if (code) return code;
    *recording =
        (BenchRecording){.play = play, .runner = runner, .record = record, .fields = fields};
    take_surface(recording);
    size_t count = (size_t)runner->particles;
    recording->x = sm_alloc(count, sizeof *recording->x);
    recording->v = sm_alloc(count, sizeof *recording->v);
    recording->g = sm_alloc(count, sizeof *recording->g);
    if (runner->type->get_shapes && runner->scene->octree.creep > 0)
        recording->S = sm_alloc(count, sizeof *recording->S);
    SmEngineParams params = bench_engine_params(runner->scene, body, machine->threads);
    SmBoundary boundary = bench_runner_boundary(runner);
    const BenchEngine *engine = bench_engine(runner->type->name);
    BenchTrajectoryParams wanted = {
        .path = path,
        .surface = &recording->surface,
        .machine = machine,
        .scene = runner->scene->name,
        .fields = fields,
        .steps = {.record = record,
                  .voxels = &body->voxels,
                  .structure = engine->structure ? engine->structure(runner->engine) : NULL,
                  .params = &params,
                  .mass = body->mass,
                  .engine = runner->type->name,
                  .precision = runner->type->precision,
                  .boundary = &boundary}};
    code = bench_trajectory_open(&wanted, &recording->trajectory, error);
    if (code) release(recording);
    return code;
}

double bench_recording_bytes(const BenchRecording *recording)
{
    const BenchScene *scene = recording->runner->scene;
    double frames = scene->frames + 1.0, steps = (double)scene->frames * scene->steps_per_frame + 1;
    double state = (sizeof *recording->x + sizeof *recording->v + sizeof *recording->g) *
                   (double)recording->runner->particles;
    if (recording->S) state *= 2;
    return bench_trajectory_bytes(recording->trajectory, frames) +
           (recording->record ? steps * state : 0);
}

SmCode bench_recording_frame(BenchRecording *recording, SmError *error)
{
    if (bench_playback_split(recording->play)) {
        take_surface(recording);
        SmCode code = bench_trajectory_topology(recording->trajectory, &recording->surface, error);
        if (code) return code;
    }
    const double(*point)[3] = (const double(*)[3])recording->point;
    bench_playback_points(recording->play, recording->point);
    bench_fields_find(recording->play, recording->fields, &recording->surface, point,
                      recording->value);
    return bench_trajectory_frame(recording->trajectory, recording->play->time, point,
                                  (const float *const *)recording->value, error);
}

SmCode bench_recording_step(BenchRecording *recording, long step, bool before, SmError *error)
{
    const BenchRunner *runner = recording->runner;
    const SmEngineType *type = runner->type;
    type->get(runner->engine, SM_POSITION, recording->x);
    type->get(runner->engine, SM_VELOCITY, recording->v);
    if (before) {
        type->goals(runner->engine);
        type->get(runner->engine, SM_GOAL, recording->g);
    }
    if (recording->S) type->get_shapes(runner->engine, recording->S);
    return bench_trajectory_step(recording->trajectory, step, (const double(*)[3])recording->x,
                                 (const double(*)[3])recording->v,
                                 before ? (const double(*)[3])recording->g : NULL,
                                 (const double(*)[9])recording->S, error);
}

SmCode bench_recording_close(BenchRecording *recording, SmError *error)
{
    char hash[BENCH_HASH_TEXT];
    bench_playback_hash(recording->play, hash);
    SmCode code = bench_trajectory_close(recording->trajectory, hash, error);
    release(recording);
    return code;
}

void bench_recording_abandon(BenchRecording *recording)
{
    bench_trajectory_abandon(recording->trajectory);
    release(recording);
}
