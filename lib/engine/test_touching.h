/* test_touching.h - two cubes that touch each other, on the ground. */
#ifndef SM_TEST_TOUCHING_H
#define SM_TEST_TOUCHING_H

#include "../test_fields.h"
#include "../voxel/voxel.h"
#include "engine.h"

/* How far a particle of them is, after so many steps, from where it was half way: cubes of `side`
 * cells of edge 0.5, the second one `apart` from the first. */
static inline double touching_moves(const SmEngineType *type, SmEngineParams params, int side,
                                    const double apart[3], int steps)
{
    const SmObstacle ground = {.kind = SM_PLANE, .b = {0, 1, 0}};
    double pose[2][3][4] = {{{0}}};
    SmVoxels voxels;
    SmEngine *engine;
    SmCounts counts;
    sm_voxels_block(&voxels, side, side, side, 0.5);
    for (int d = 0; d < 3; d++) {
        pose[0][d][d] = pose[1][d][d] = 1;
        pose[1][d][3] = apart[d];
    }
    params.h = 0.01;
    params.damping = 0.1;
    params.gravity[1] = -9.81;
    params.collide.bodies = true;
    params.instances = 2;
    params.instance_pose = (const double(*)[3][4])pose;
    assert_int_equal(type->create(&voxels, &params, &engine, NULL), SM_OK);
    type->bound(engine, &(SmBoundary){.obstacle_count = 1, .obstacle = &ground});
    type->count(engine, &counts);
    double(*x)[3] = triples(counts.particles), (*later)[3] = triples(counts.particles);
    for (int step = 0; step < steps; step++) {
        if (step == steps / 2) type->get(engine, SM_POSITION, x);
        type->step(engine, NULL);
    }
    type->get(engine, SM_POSITION, later);
    double moved =
        field_difference(counts.particles, (const double(*)[3])x, (const double(*)[3])later);
    free(x);
    free(later);
    type->destroy(engine);
    sm_voxels_free(&voxels);
    return moved;
}

#endif
