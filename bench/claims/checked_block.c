#include "checked_block.h"

#include <stdlib.h>
#include <string.h>

SmCode bench_block_create(const int size[3], const SmEngineType *type, int w, BenchBlock *block,
                          SmError *error)
{
    const SmEngineParams params = {.w = w, .h = 0.01, .threads = 1};
    *block = (BenchBlock){.type = type, .body.instances = 1};
    memcpy(block->size, size, sizeof block->size);
    sm_voxels_block(&block->body.voxels, size[0] - 1, size[1] - 1, size[2] - 1, 1);
    SmCode code = type->create(&block->body.voxels, &params, &block->engine, error);
    if (code) {
        sm_voxels_free(&block->body.voxels);
        *block = (BenchBlock){0};
        return code;
    }
    block->particles = block->body.voxels.particle_count;
    size_t count = (size_t)block->particles;
    block->x0 = sm_alloc(count, sizeof *block->x0);
    block->x = sm_alloc(count, sizeof *block->x);
    block->g = sm_alloc(count, sizeof *block->g);
    block->body.x0 = sm_alloc(count, sizeof *block->body.x0);
    type->get(block->engine, SM_REST, block->x0);
    memcpy(block->x, block->x0, count * sizeof *block->x);
    memcpy(block->body.x0, block->x0, count * sizeof *block->x0);
    bench_check_create(&block->body, w, &block->check);
    return SM_OK;
}

void bench_block_free(BenchBlock *block)
{
    if (!block->engine) return;
    bench_check_free(&block->check);
    block->type->destroy(block->engine);
    bench_body_free(&block->body);
    free(block->x0);
    free(block->x);
    free(block->g);
    *block = (BenchBlock){0};
}

bool bench_block_goals(BenchBlock *block, size_t room, char *reason)
{
    block->type->set(block->engine, SM_POSITION, (const double(*)[3])block->x);
    BenchDeviation found = bench_check_state(&block->check, block->type, block->engine);
    block->type->get(block->engine, SM_GOAL, block->g);
    return bench_check_verdict(&found, room, reason);
}
