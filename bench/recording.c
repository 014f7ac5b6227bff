#include "recording.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nearest.h"

/* The body's surface once for every instance. */
static void repeat_surface(const BenchBody *body, SmMesh *surface)
{
    const SmMesh *mesh = &body->mesh;
    long n = body->instances, vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    surface->vertex_count = n * vertices;
    surface->triangle_count = n * triangles;
    surface->position = sm_alloc((size_t)surface->vertex_count, sizeof *surface->position);
    surface->triangle = sm_alloc((size_t)surface->triangle_count, sizeof *surface->triangle);
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
    free(recording->nearest);
    free(recording->x);
    free(recording->v);
    free(recording->g);
    *recording = (BenchRecording){0};
}

/* Every vertex follows a lattice's cell, or an octree's node. */
static void attach_surface(BenchRecording *recording)
{
    const BenchRunner *runner = recording->runner;
    const SmMesh *mesh = &runner->body->mesh;
    if (strcmp(runner->type->name, "octree") != 0) {
        sm_embed_create(mesh, &runner->body->voxels, &recording->embedding);
        return;
    }
    BenchNearest nodes;
    bench_nearest_create((const double(*)[3])runner->x0, runner->count, &nodes);
    recording->nearest = sm_alloc((size_t)mesh->vertex_count, sizeof *recording->nearest);
    for (long i = 0; i < mesh->vertex_count; i++)
        recording->nearest[i] = bench_nearest_find(&nodes, mesh->position[i]);
    bench_nearest_free(&nodes);
}

SmCode bench_recording_open(const BenchRunner *runner, const char *path, bool particles,
                            const BenchMachine *machine, BenchRecording *recording, SmError *error)
{
    const BenchBody *body = runner->body;
    if ((double)body->instances * (double)body->mesh.vertex_count > 2e9)
        return sm_fail(error, SM_INPUT, "%s: the surfaces of %ld instances have too many vertices",
                       runner->scene->file, body->instances);
    if (particles && !strcmp(runner->type->name, "octree"))
        return sm_fail(
            error, SM_USAGE,
            "--record particles stores a lattice, and the octree has none: leave it out");
    *recording = (BenchRecording){.runner = runner, .particles = particles};
    repeat_surface(body, &recording->surface);
    attach_surface(recording);
    size_t count = (size_t)runner->particles;
    recording->x = sm_alloc(count, sizeof *recording->x);
    recording->v = sm_alloc(count, sizeof *recording->v);
    recording->g = sm_alloc(count, sizeof *recording->g);
    SmEngineParams params = bench_engine_params(runner->scene, body, machine->threads);
    SmBoundary boundary = bench_runner_boundary(runner);
    BenchTrajectoryParams wanted = {.path = path,
                                    .surface = &recording->surface,
                                    .machine = machine,
                                    .scene = runner->scene->name,
                                    .record_particles = particles,
                                    .voxels = &body->voxels,
                                    .params = &params,
                                    .mass = body->mass,
                                    .engine = runner->type->name,
                                    .precision = runner->type->precision,
                                    .boundary = &boundary};
    SmCode code = bench_trajectory_open(&wanted, &recording->trajectory, error);
    if (code) release(recording);
    return code;
}

double bench_recording_bytes(const BenchRecording *recording)
{
    const BenchScene *scene = recording->runner->scene;
    double frames = scene->frames + 1.0, steps = (double)scene->frames * scene->steps_per_frame + 1;
    double state = (sizeof *recording->x + sizeof *recording->v + sizeof *recording->g) *
                   (double)recording->runner->particles;
    return bench_trajectory_bytes(recording->trajectory, frames) +
           (recording->particles ? steps * state : 0);
}

static void follow_nodes(const BenchRecording *recording, const double (*x)[3], double (*point)[3])
{
    const BenchRunner *runner = recording->runner;
    for (long i = 0; i < runner->body->mesh.vertex_count; i++)
        for (int d = 0; d < 3; d++) {
            long n = recording->nearest[i];
            point[i][d] = runner->body->mesh.position[i][d] + x[n][d] - runner->x0[n][d];
        }
}

SmCode bench_recording_frame(BenchRecording *recording, SmError *error)
{
    const BenchRunner *runner = recording->runner;
    const BenchBody *body = runner->body;
    runner->type->get(runner->engine, SM_POSITION, recording->x);
    for (long k = 0; k < body->instances; k++) {
        const double(*x)[3] = (const double(*)[3])(recording->x + k * runner->count);
        double(*point)[3] = recording->surface.position + k * body->mesh.vertex_count;
        if (recording->nearest)
            follow_nodes(recording, x, point);
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
    return bench_trajectory_step(recording->trajectory, step, (const double(*)[3])recording->x,
                                 (const double(*)[3])recording->v,
                                 before ? (const double(*)[3])recording->g : NULL, error);
}

bool bench_recording_finite(const BenchRecording *recording)
{
    for (long i = 0; i < recording->runner->particles; i++)
        for (int d = 0; d < 3; d++)
            if (!isfinite(recording->x[i][d])) return false;
    return true;
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
