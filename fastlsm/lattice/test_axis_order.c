/* Which layout and turn a body gets: the same on vectors of any width, but for a box. */
#include "../../lib/test_frame.h"
#include "../../lib/voxel/test_bodies.h"
#include "axis_order.h"

static const int lanes[] = {4, 8, 16};

static SmLayout choose(const SmVoxels *voxels, int w, int width, int *turn)
{
    SmEngineParams params = {.w = w, .instances = 1};
    return lsm_axes_choose(voxels, &params, width, turn);
}

static SmLayout choose_box(int x, int y, int z, int width)
{
    SmVoxels voxels;
    int turn;
    unsigned seed = 1;
    random_block(&seed, (const int[3]){x, y, z}, 1, 1, &voxels);
    SmLayout layout = choose(&voxels, 2, width, &turn);
    sm_voxels_free(&voxels);
    return layout;
}

/* Regions that are no boxes are what costs in an irregular body, and narrow vectors have no fewer
 * of them. */
TEST(an_irregular_body_has_one_layout)
{
    unsigned seed = 5;
    int blocks = 0;
    for (int round = 0; round < 60; round++) {
        SmVoxels voxels;
        int turn[3];
        SmLayout layout[3];
        int size[3] = {3 + random_int(&seed, 40), 3 + random_int(&seed, 40),
                       3 + random_int(&seed, 40)};
        if (round % 2) size[random_int(&seed, 3)] = 16 + 16 * random_int(&seed, 2);
        random_block(&seed, size, 1, 0.5 + 0.499 * random_unit(&seed), &voxels);
        for (int i = 0; i < 3; i++) layout[i] = choose(&voxels, 2 + round % 4, lanes[i], &turn[i]);
        for (int i = 1; i < 3; i++) assert_int_equal(layout[i], layout[0]);
        for (int i = 1; i < 3; i++) assert_int_equal(turn[i], turn[0]);
        blocks += layout[0] == SM_LAYOUT_BLOCKS;
        sm_voxels_free(&voxels);
    }
    assert_in_range(blocks, 5, 55); /* both are met */
}

/* All regions of a box are boxes: blocks, where its lanes are half full, along its best axis. */
TEST(a_box_goes_by_its_lanes)
{
    for (int i = 0; i < 3; i++) {
        assert_int_equal(choose_box(16, 16, 16, lanes[i]), SM_LAYOUT_BLOCKS);
        assert_int_equal(choose_box(3, 3, 33, lanes[i]), SM_LAYOUT_BLOCKS);
    }
    assert_int_equal(choose_box(5, 5, 5, 4), SM_LAYOUT_BLOCKS);
    assert_int_equal(choose_box(5, 5, 5, 16), SM_LAYOUT_LISTS);
}

/* The long axis of a bar lies along the lanes of blocks, and along z, the pipeline's, of lists. */
TEST(a_long_axis_is_turned)
{
    for (int axis = 0; axis < 3; axis++) {
        SmVoxels voxels;
        int turn, size[3] = {3, 3, 3};
        unsigned seed = 1;
        size[axis] = 48;
        random_block(&seed, size, 1, 1, &voxels);
        assert_int_equal(choose(&voxels, 2, 16, &turn), SM_LAYOUT_BLOCKS);
        assert_int_equal(turn % 3, axis);
        SmEngineParams lists = {.w = 2, .instances = 1, .layout = SM_LAYOUT_LISTS};
        assert_int_equal(lsm_axes_choose(&voxels, &lists, 16, &turn), SM_LAYOUT_LISTS);
        assert_int_equal((turn + 2) % 3, axis);
        sm_voxels_free(&voxels);
    }
}
