#include "cast.h"

#include <stdlib.h>
#include <string.h>

/* A part with these instances of the body, which the part does not own. */
static SmCode add_part(const BenchCast *cast, long count, const long *instance,
                       const SmEngineType *type, int threads, BenchPart *part, SmError *error)
{
    part->body = *cast->body;
    part->body.instances = count;
    part->body.pose = sm_alloc((size_t)count, sizeof *part->body.pose);
    part->instance = sm_alloc((size_t)count, sizeof *part->instance);
    for (long i = 0; i < count; i++) {
        part->instance[i] = instance[i];
        memcpy(part->body.pose[i], cast->body->pose[instance[i]], sizeof *part->body.pose);
    }
    return bench_runner_create(cast->scene, &part->body, type, threads, &part->runner, error);
}

static bool touched(const BenchScene *scene, long instance)
{
    for (int i = 0; i < scene->touch_count; i++)
        if (scene->touch[i].instance == instance + 1) return true;
    return false;
}

SmCode bench_cast_create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         int threads, BenchCast *cast, SmError *error)
{
    *cast = (BenchCast){.scene = scene, .body = body};
    long *shared = sm_alloc((size_t)body->instances, sizeof *shared), sharing = 0;
    for (long i = 0; i < body->instances; i++)
        if (!touched(scene, i)) shared[sharing++] = i;
    cast->part = sm_alloc((size_t)(body->instances - sharing + 1), sizeof *cast->part);
    SmCode code = SM_OK;
    if (sharing)
        code = add_part(cast, sharing, shared, type, threads, &cast->part[cast->count++], error);
    for (long i = 0; i < body->instances && !code; i++) {
        if (!touched(scene, i)) continue;
        cast->part[cast->count].own = true;
        code = add_part(cast, 1, &i, type, threads, &cast->part[cast->count++], error);
    }
    free(shared);
    if (code) bench_cast_free(cast);
    return code;
}

void bench_cast_free(BenchCast *cast)
{
    for (int i = 0; i < cast->count; i++) {
        bench_runner_free(&cast->part[i].runner);
        free(cast->part[i].body.pose);
        free(cast->part[i].instance);
    }
    free(cast->part);
    *cast = (BenchCast){0};
}

void bench_cast_disturb(BenchCast *cast, unsigned long seed)
{
    for (int i = 0; i < cast->count; i++)
        bench_runner_disturb(&cast->part[i].runner, seed + (unsigned long)i);
}

long bench_cast_particles(const BenchCast *cast)
{
    long particles = 0;
    for (int i = 0; i < cast->count; i++) particles += cast->part[i].runner.particles;
    return particles;
}
