/* Each obstacle: which way out, what becomes of the velocity. */
#include "brute_obstacle.h"

#include "../lib/test_frame.h"

typedef struct {
    SmObstacle obstacle;
    double x[3], v[3];
    bool inside;
    double moved[3], slowed[3];
} Case;

static const Case cases[] = {
    /* a plane that leans: normal (0.6, 0.8, 0) through (0, 1, 0); depth 0.5 */
    {{SM_PLANE, {0, 1, 0}, {0.6, 0.8, 0}, 0, 0},
     {-0.3, 0.6, 2},
     {-0.6, -0.8, 1},
     true,
     {0, 1, 2},
     {0, 0, 1}},
    {{SM_PLANE, {0, 1, 0}, {0.6, 0.8, 0}, 0, 0},
     {0.3, 1.4, 2},
     {-1, -1, 1},
     false,
     {0.3, 1.4, 2},
     {-1, -1, 1}},
    /* half of the tangential velocity goes; what leads out stays */
    {{SM_PLANE, {0, 0, 0}, {0, 1, 0}, 0, 0.5},
     {3, -1, 4},
     {2, -7, -4},
     true,
     {3, 0, 4},
     {1, 0, -2}},
    {{SM_PLANE, {0, 0, 0}, {0, 1, 0}, 0, 1}, {3, -1, 4}, {2, 7, -4}, true, {3, 0, 4}, {0, 7, 0}},
    {{SM_SPHERE, {1, 1, 1}, {0}, 2, 0}, {2, 1, 1}, {-1, 2, 3}, true, {3, 1, 1}, {0, 2, 3}},
    {{SM_SPHERE, {1, 1, 1}, {0}, 2, 0}, {1, 1, 1}, {1, -1, 0}, true, {1, 3, 1}, {1, 0, 0}},
    {{SM_SPHERE, {1, 1, 1}, {0}, 2, 0}, {1, 1, 3.5}, {0, 0, -1}, false, {1, 1, 3.5}, {0, 0, -1}},
    {{SM_BOX, {0, 0, 0}, {4, 4, 4}, 0, 0}, {1, 3.5, 2}, {1, -1, 1}, true, {1, 4, 2}, {1, 0, 1}},
    {{SM_BOX, {0, 0, 0}, {4, 4, 4}, 0, 0}, {2, 2, 0.5}, {1, -1, 1}, true, {2, 2, 0}, {1, -1, 0}},
    {{SM_BOX, {0, 0, 0}, {4, 4, 4}, 0, 0}, {2, 2, 2}, {1, -1, 1}, true, {0, 2, 2}, {0, -1, 1}},
    {{SM_BOX, {0, 0, 0}, {4, 4, 4}, 0, 0}, {2, 5, 2}, {1, -1, 1}, false, {2, 5, 2}, {1, -1, 1}},
    {{SM_CAPSULE, {0, 0, 0}, {0, 4, 0}, 1, 0}, {0.5, 2, 0}, {-1, 1, 0}, true, {1, 2, 0}, {0, 1, 0}},
    {{SM_CAPSULE, {0, 0, 0}, {0, 4, 0}, 1, 0}, {0, 4.5, 0}, {1, -1, 0}, true, {0, 5, 0}, {1, 0, 0}},
    {{SM_CAPSULE, {0, 0, 0}, {0, 4, 0}, 1, 0}, {0, 2, 0}, {-1, 1, 0}, true, {1, 2, 0}, {0, 1, 0}},
    {{SM_CAPSULE, {0, 0, 0}, {0, 0, 0}, 1, 0}, {0, 0, 0}, {1, -1, 0}, true, {0, 1, 0}, {1, 0, 0}},
    {{SM_CAPSULE, {0, 0, 0}, {0, 4, 0}, 1, 0},
     {0, 5.5, 0},
     {1, -1, 0},
     false,
     {0, 5.5, 0},
     {1, -1, 0}},
};

TEST(particles_leave_by_the_nearest_way)
{
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        Case c = cases[n];
        assert_int_equal(ref_obstacle_push_out(&c.obstacle, c.x, c.v), c.inside);
        for (int a = 0; a < 3; a++) {
            assert_true(fabs(c.x[a] - c.moved[a]) < 1e-15);
            assert_true(fabs(c.v[a] - c.slowed[a]) < 1e-15);
        }
    }
}
