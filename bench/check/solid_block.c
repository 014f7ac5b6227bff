#include "solid_block.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"

static const double brute_members = 5e7;

SmCode bench_block_create(const int size[3], const SmEngineType *type, const SmEngineParams *params,
                          BenchBlock *block, SmError *error)
{
    BenchBody *body = &block->body;
    *block = (BenchBlock){.type = type, .w = params->w, .body.instances = 1};
    memcpy(block->size, size, sizeof block->size);
    sm_voxels_block(&body->voxels, size[0] - 1, size[1] - 1, size[2] - 1, 1);
    SmCode code = type->create(&body->voxels, params, &block->engine, error);
    if (code) {
        bench_block_free(block);
        return code;
    }
    block->particles = body->voxels.particle_count;
    size_t count = (size_t)block->particles;
    block->brute = bench_check_members(body, params->w) <= brute_members;
    block->x = sm_alloc(count, sizeof *block->x);
    type->get(block->engine, SM_REST, block->x);
    if (!block->brute) return SM_OK;
    body->x0 = sm_alloc(count, sizeof *body->x0);
    memcpy(body->x0, block->x, count * sizeof *block->x);
    return SM_OK;
}

void bench_block_free(BenchBlock *block)
{
    if (block->engine) block->type->destroy(block->engine);
    bench_body_free(&block->body);
    free(block->x);
    *block = (BenchBlock){0};
}

static bool held_to_brute(const BenchBlock *block, size_t room, char *reason)
{
    BenchCheck check;
    bench_check_create(&block->body, block->w, 0, NULL, &check);
    BenchDeviation found = bench_check_state(&check, block->type, block->engine);
    bench_check_free(&check);
    return bench_check_verdict(&found, room, reason) &&
           bench_check_keeps(found.momentum_error, room, reason);
}

static bool keeps_momentum(const BenchBlock *block, size_t room, char *reason)
{
    size_t count = (size_t)block->particles;
    double(*g)[3] = sm_alloc(count, sizeof *g), *mass = sm_alloc(count, sizeof *mass);
    block->type->goals(block->engine);
    block->type->get(block->engine, SM_GOAL, g);
    block->type->masses(block->engine, mass);
    double drift = bench_check_momentum((const double(*)[3])block->x, (const double(*)[3])g, mass,
                                        block->particles);
    free(g);
    free(mass);
    return bench_check_keeps(drift, room, reason);
}

bool bench_block_goals(BenchBlock *block, size_t room, char *reason)
{
    block->type->set(block->engine, SM_POSITION, (const double(*)[3])block->x);
    return (block->brute ? held_to_brute : keeps_momentum)(block, room, reason);
}
