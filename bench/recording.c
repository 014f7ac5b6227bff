#include "recording.h"

#include <stdlib.h>
#include <string.h>

#include "../octree/structure.h"

/* The body's surface once for every instance. */
static void repeat_surface(const BenchBody *body, SmMesh *surface)
{
    const SmMesh *mesh = &body->mesh;
    long n = body->instances, vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    *surface = sm_mesh_new(n * vertices, n * triangles);
    for (long k = 0; k < n; k++) {
        for (long i = 0; i < vertices; i++)
            for (int d = 0; d < 3; d++)
                surface->position[k * vertices + i][d] = mesh->position[i][d] + body->pose[k][d][3];
        for (long i = 0; i < triangles; i++)
            for (int d = 0; d < 3; d++)
                surface->triangle[k * triangles + i][d] =
                    mesh->triangle[i][d] + (int)(k * vertices);
    }
}

static void release(BenchRecording *recording)
{
    sm_mesh_free(&recording->surface);
    sm_embed_free(&recording->embedding);
    oct_surface_free(&recording->carried);
    free(recording->x);
    free(recording->v);
    free(recording->g);
    free(recording->S);
    *recording = (BenchRecording){0};
}

static bool is_octree(const BenchRunner *runner)
{
    return !strcmp(runner->type->name, "octree");
}

static void attach_surface(BenchRecording *recording)
{
    const BenchRunner *runner = recording->runner;
    const BenchBody *body = runner->body;
    if (!is_octree(runner)) {
        sm_embed_create(&body->mesh, &body->voxels, &recording->embedding);
        return;
    }
    const OctStructure *s = oct_engine_structure(runner->engine);
    oct_surface_build(&body->mesh, &(OctCarrier){&body->voxels, &s->tree, &s->graph, NULL},
                      &recording->carried);
}

static SmCode check(const BenchRunner *runner, BenchRecord record, SmError *error)
{
    const BenchBody *body = runner->body;
    if ((double)body->instances * (double)body->mesh.vertex_count > 2e9)
        return sm_fail(error, SM_INPUT, "%s: the surfaces of %ld instances have too many vertices",
                       runner->scene->file, body->instances);
    if (record == BENCH_RECORD_PARTICLES && is_octree(runner))
        return sm_fail(error, SM_USAGE,
                       "--record particles stores a lattice, and the octree has none: give "
                       "--record nodes");
    if (record == BENCH_RECORD_NODES && !is_octree(runner))
        return sm_fail(error, SM_USAGE,
                       "--record nodes stores an octree, and %s has none: give --record particles, "
                       "or --engine octree",
                       runner->type->name);
    return SM_OK;
}

SmCode bench_recording_open(const BenchRunner *runner, const char *path, BenchRecord record,
                            const BenchMachine *machine, BenchRecording *recording, SmError *error)
{
    const BenchBody *body = runner->body;
    SmCode code = check(runner, record, error);
    if (code) return code;
    *recording = (BenchRecording){.runner = runner, .record = record};
    repeat_surface(body, &recording->surface);
    attach_surface(recording);
    size_t count = (size_t)runner->particles;
    recording->x = sm_alloc(count, sizeof *recording->x);
    recording->v = sm_alloc(count, sizeof *recording->v);
    recording->g = sm_alloc(count, sizeof *recording->g);
    if (is_octree(runner) && runner->scene->octree.creep > 0)
        recording->S = sm_alloc(count, sizeof *recording->S);
    SmEngineParams params = bench_engine_params(runner->scene, body, machine->threads);
    SmBoundary boundary = bench_runner_boundary(runner);
    BenchTrajectoryParams wanted = {
        .path = path,
        .surface = &recording->surface,
        .machine = machine,
        .scene = runner->scene->name,
        .record = record,
        .voxels = &body->voxels,
        .structure = is_octree(runner) ? oct_engine_structure(runner->engine) : NULL,
        .params = &params,
        .mass = body->mass,
        .engine = runner->type->name,
        .precision = runner->type->precision,
        .boundary = &boundary};
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
    const BenchRunner *runner = recording->runner;
    const BenchBody *body = runner->body;
    runner->type->get(runner->engine, SM_POSITION, recording->x);
    for (long k = 0; k < body->instances; k++) {
        const double(*x)[3] = (const double(*)[3])(recording->x + k * runner->count);
        double(*point)[3] = recording->surface.position + k * body->mesh.vertex_count;
        if (is_octree(runner))
            oct_surface_move(&recording->carried, x, point, NULL);
        else
            sm_embed_apply(&recording->embedding, x, point, NULL);
    }
    return bench_trajectory_frame(recording->trajectory, runner->time,
                                  (const double(*)[3])recording->surface.position, error);
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
    SmCode code = bench_trajectory_close(recording->trajectory, error);
    release(recording);
    return code;
}

void bench_recording_abandon(BenchRecording *recording)
{
    bench_trajectory_abandon(recording->trajectory);
    release(recording);
}
