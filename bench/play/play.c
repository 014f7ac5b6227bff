#include "play.h"

#include <stdlib.h>

SmCode bench_play_create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         int threads, unsigned long seed, BenchPlay *play, SmError *error)
{
    *play = (BenchPlay){0};
    SmCode code = bench_cast_create(scene, body, type, threads, &play->cast, error);
    if (code) return code;
    for (int i = 0; i < play->cast.count && !code; i++)
        code = bench_changes_check(&play->cast.part[i], error);
    if (code) {
        bench_cast_free(&play->cast);
        return code;
    }
    play->changes = sm_alloc((size_t)play->cast.count, sizeof *play->changes);
    for (int i = 0; i < play->cast.count; i++)
        bench_changes_create(&play->cast.part[i], &play->changes[i]);
    bench_cast_disturb(&play->cast, seed);
    return SM_OK;
}

void bench_play_free(BenchPlay *play)
{
    for (int i = 0; i < play->cast.count; i++) bench_changes_free(&play->changes[i]);
    free(play->changes);
    bench_cast_free(&play->cast);
    *play = (BenchPlay){0};
}

bool bench_play_changes(const BenchPlay *play)
{
    for (int i = 0; i < play->cast.count; i++)
        if (bench_changes_any(&play->cast.part[i])) return true;
    return false;
}

SmCode bench_play_change(BenchPlay *play, SmError *error)
{
    const BenchScene *scene = play->cast.scene;
    double to = play->time + scene->steps_per_frame * scene->params.h;
    SmCode code = SM_OK;
    for (int i = 0; i < play->cast.count && !code; i++)
        if (bench_changes_any(&play->cast.part[i]))
            code = bench_changes_frame(&play->changes[i], play->time, to, error);
    return code;
}

void bench_play_prepare(BenchPlay *play)
{
    for (int i = 0; i < play->cast.count; i++) bench_runner_prepare(&play->cast.part[i].runner);
}

void bench_play_advance(BenchPlay *play, SmLaps *laps)
{
    for (int i = 0; i < play->cast.count; i++)
        bench_runner_advance(&play->cast.part[i].runner, laps);
    play->time = play->cast.part[0].runner.time;
}

SmMesh bench_play_surface(const BenchPlay *play)
{
    long vertices = 0, triangles = 0;
    for (int i = 0; i < play->cast.count; i++) {
        const SmMesh *surface = &play->changes[i].skin.surface;
        vertices += play->cast.part[i].body.instances * surface->vertex_count;
        triangles += play->cast.part[i].body.instances * surface->triangle_count;
    }
    SmMesh all = sm_mesh_new(vertices, triangles);
    long vertex = 0, triangle = 0;
    for (int i = 0; i < play->cast.count; i++) {
        const SmMesh *surface = &play->changes[i].skin.surface;
        const BenchBody *body = &play->cast.part[i].body;
        for (long k = 0; k < body->instances; k++) {
            for (long v = 0; v < surface->vertex_count; v++)
                for (int d = 0; d < 3; d++)
                    all.position[vertex + v][d] = surface->position[v][d] + body->pose[k][d][3];
            for (long t = 0; t < surface->triangle_count; t++)
                for (int c = 0; c < 3; c++)
                    all.triangle[triangle + t][c] = surface->triangle[t][c] + (int)vertex;
            vertex += surface->vertex_count;
            triangle += surface->triangle_count;
        }
    }
    return all;
}

void bench_play_points(BenchPlay *play, double (*point)[3])
{
    for (int i = 0; i < play->cast.count; i++) {
        bench_changes_surface(&play->changes[i], 0, point);
        point += play->cast.part[i].body.instances * play->changes[i].skin.surface.vertex_count;
    }
}

bool bench_play_split(const BenchPlay *play)
{
    for (int i = 0; i < play->cast.count; i++)
        if (play->changes[i].last.slit) return true;
    return false;
}

BenchRunner *bench_play_runner(BenchPlay *play)
{
    return &play->cast.part[play->cast.count - 1].runner;
}
