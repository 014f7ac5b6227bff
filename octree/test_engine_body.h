/* test_engine_body.h - the body that the engine is tested with, in both precisions. */
#ifndef OCT_TEST_ENGINE_BODY_H
#define OCT_TEST_ENGINE_BODY_H

#include "../lib/test_frame.h"
#include "engine.h"

static const SmEngineType *const engines[2] = {&octree_engine_f32, &octree_engine_f64};

/* A U of cells of edge 0.5 somewhere: two arms above a bar. */
static inline void make_voxels(SmVoxels *voxels)
{
    sm_voxels_init(voxels, 12, 10, 4, 0.5);
    for (int d = 0; d < 3; d++) voxels->origin[d] = 3 - 2 * d;
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < 10; j++)
            for (int i = 0; i < 12; i++)
                if (j < 4 || i < 5 || i > 5) sm_voxel_set(voxels, i, j, k);
    sm_voxels_count(voxels);
}

static inline SmEngineParams usual(const OctOptions *options)
{
    return (SmEngineParams){.h = 0.01, .threads = 1, .octree = options};
}

static inline SmEngine *make(int precision, const SmVoxels *voxels, const SmEngineParams *params,
                             SmCounts *counts)
{
    SmEngine *engine;
    SmError error;
    if (engines[precision]->create(voxels, params, &engine, &error)) fail_msg("%s", error.text);
    engines[precision]->count(engine, counts);
    return engine;
}

#endif
