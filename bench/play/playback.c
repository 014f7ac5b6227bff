#include "playback.h"

#include <stdio.h>
#include <stdlib.h>

#include "../../lib/system/hash.h"

static bool touched(const BenchScene *scene, long instance)
{
    for (int i = 0; i < scene->touch_count; i++)
        if (scene->touch[i].instance == instance + 1) return true;
    return false;
}

/* Those that share one structure first, then each that is touched. */
static SmCode create_groups(BenchPlayback *play, const SmEngineType *type, int threads,
                            SmError *error)
{
    const BenchBody *body = play->body;
    long *shared = sm_alloc((size_t)body->instances, sizeof *shared), sharing = 0;
    for (long i = 0; i < body->instances; i++)
        if (!touched(play->scene, i)) shared[sharing++] = i;
    play->group = sm_alloc((size_t)(body->instances - sharing + 1), sizeof *play->group);
    SmCode code = SM_OK;
    if (sharing)
        code = bench_group_create(play->scene, body, sharing, shared, false, type, threads,
                                  &play->group[play->count++], error);
    for (long i = 0; i < body->instances && !code; i++)
        if (touched(play->scene, i))
            code = bench_group_create(play->scene, body, 1, &i, true, type, threads,
                                      &play->group[play->count++], error);
    free(shared);
    return code;
}

SmCode bench_playback_create(const BenchScene *scene, const BenchBody *body,
                             const SmEngineType *type, int threads, unsigned long seed,
                             BenchPlayback *play, SmError *error)
{
    *play = (BenchPlayback){.scene = scene, .body = body};
    SmCode code = create_groups(play, type, threads, error);
    if (code) {
        bench_playback_free(play);
        return code;
    }
    for (int g = 0; g < play->count; g++)
        bench_runner_disturb(&play->group[g].runner, seed + (unsigned long)g);
    return SM_OK;
}

void bench_playback_free(BenchPlayback *play)
{
    for (int g = 0; g < play->count; g++) bench_group_free(&play->group[g]);
    free(play->group);
    *play = (BenchPlayback){0};
}

long bench_playback_particles(const BenchPlayback *play)
{
    long particles = 0;
    for (int g = 0; g < play->count; g++) particles += play->group[g].runner.particles;
    return particles;
}

bool bench_playback_changes(const BenchPlayback *play)
{
    for (int i = 0; i < play->count; i++)
        if (bench_group_changes(&play->group[i])) return true;
    return false;
}

static SmCode change_until(BenchPlayback *play, double to, SmError *error)
{
    SmCode code = SM_OK;
    for (int i = 0; i < play->count; i++) play->group[i].last = (BenchChanged){0};
    for (int i = 0; i < play->count && !code; i++)
        if (bench_group_changes(&play->group[i]))
            code = bench_group_frame(&play->group[i], play->time, to, error);
    return code;
}

SmCode bench_playback_change(BenchPlayback *play, SmError *error)
{
    const BenchScene *scene = play->scene;
    return change_until(play, play->time + scene->steps_per_frame * scene->params.h, error);
}

SmCode bench_playback_change_now(BenchPlayback *play, SmError *error)
{
    return change_until(play, play->time, error);
}

bool bench_playback_follow(BenchPlayback *play)
{
    bool any = false;
    for (int i = 0; i < play->count; i++)
        if (bench_group_changes(&play->group[i])) any |= bench_group_follow(&play->group[i]);
    return any;
}

void bench_playback_prepare(BenchPlayback *play)
{
    for (int i = 0; i < play->count; i++) bench_runner_prepare(&play->group[i].runner);
}

void bench_playback_advance(BenchPlayback *play, SmLaps *laps)
{
    for (int i = 0; i < play->count; i++) bench_runner_advance(&play->group[i].runner, laps);
    play->time = play->group[0].runner.time;
}

void bench_playback_size(const BenchPlayback *play, long *vertices, long *triangles)
{
    *vertices = *triangles = 0;
    for (int i = 0; i < play->count; i++) {
        const SmMesh *surface = &play->group[i].skin.surface;
        *vertices += play->group[i].body.instances * surface->vertex_count;
        *triangles += play->group[i].body.instances * surface->triangle_count;
    }
}

SmMesh bench_playback_surface(const BenchPlayback *play)
{
    long vertices, triangles;
    bench_playback_size(play, &vertices, &triangles);
    SmMesh all = sm_mesh_new(vertices, triangles);
    long vertex = 0, triangle = 0;
    for (int i = 0; i < play->count; i++) {
        const SmMesh *surface = &play->group[i].skin.surface;
        const BenchBody *body = &play->group[i].body;
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

void bench_playback_points(BenchPlayback *play, double (*point)[3])
{
    for (int i = 0; i < play->count; i++) {
        bench_group_surface(&play->group[i], 0, point);
        point += play->group[i].body.instances * play->group[i].skin.surface.vertex_count;
    }
}

void bench_playback_hash(const BenchPlayback *play, char text[BENCH_HASH_TEXT])
{
    unsigned long long hash = SM_HASH_START;
    for (int g = 0; g < play->count; g++) {
        const BenchRunner *runner = &play->group[g].runner;
        size_t count = (size_t)runner->particles;
        double(*value)[3] = sm_alloc(count, sizeof *value);
        for (int field = SM_POSITION; field <= SM_VELOCITY; field++) {
            runner->type->get(runner->engine, (SmField)field, value);
            hash = sm_hash_bytes(hash, value, count * sizeof *value);
        }
        free(value);
    }
    snprintf(text, BENCH_HASH_TEXT, "%016llx", hash);
}

bool bench_playback_split(const BenchPlayback *play)
{
    for (int i = 0; i < play->count; i++)
        if (play->group[i].last.split) return true;
    return false;
}

BenchRunner *bench_playback_runner(BenchPlayback *play)
{
    return &play->group[play->count - 1].runner;
}
