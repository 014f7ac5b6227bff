/* Damping where single precision does not resolve it: on long thin bodies the moments about the
 * body's origin drown the regions' own, and still damping may only take energy. */
#include "../../fastlsm/fastlsm.h"
#include "../../octree/engine.h"
#include "../test_fields.h"
#include "../test_frame.h"
#include "../test_random.h"

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    long count;
    double h, *m, (*x)[3], (*v)[3], (*g)[3];
} Stick;

static double noise(unsigned *seed)
{
    return random_between(seed, -1, 1);
}

static double kinetic(const Stick *s)
{
    double energy = 0;
    for (long p = 0; p < s->count; p++)
        for (int d = 0; d < 3; d++) energy += s->m[p] * s->v[p][d] * s->v[p][d];
    return energy;
}

/* Bowed by a radian, turned out of the axes, at random velocities. */
static void stick_create(const SmEngineType *type, const SmEngineParams *params, int cells,
                         Stick *s)
{
    SmVoxels voxels;
    SmCounts counts;
    unsigned seed = 7;
    sm_voxels_block(&voxels, cells, 1, 1, 1);
    *s = (Stick){.type = type, .h = params->h};
    assert_int_equal(type->create(&voxels, params, &s->engine, NULL), SM_OK);
    sm_voxels_free(&voxels);
    type->count(s->engine, &counts);
    s->count = counts.particles;
    s->m = sm_alloc((size_t)s->count, sizeof *s->m);
    s->x = sm_alloc((size_t)s->count, sizeof *s->x);
    s->v = sm_alloc((size_t)s->count, sizeof *s->v);
    s->g = sm_alloc((size_t)s->count, sizeof *s->g);
    type->masses(s->engine, s->m);
    type->get(s->engine, SM_REST, s->x);
    for (long p = 0; p < s->count; p++) {
        double x = s->x[p][0], y = s->x[p][1], z = s->x[p][2], angle = x / cells;
        double bow[3] = {(cells - y) * sin(angle), cells - (cells - y) * cos(angle), z};
        s->x[p][0] = 0.8 * bow[0] - 0.36 * bow[1] + 0.48 * bow[2];
        s->x[p][1] = 0.6 * bow[0] + 0.48 * bow[1] - 0.64 * bow[2];
        s->x[p][2] = 0.8 * bow[1] + 0.6 * bow[2];
        for (int d = 0; d < 3; d++) s->v[p][d] = 5 * noise(&seed);
    }
    type->set(s->engine, SM_POSITION, (const double(*)[3])s->x);
    type->set(s->engine, SM_VELOCITY, (const double(*)[3])s->v);
}

static void stick_free(Stick *s)
{
    s->type->destroy(s->engine);
    free(s->m);
    free(s->x);
    free(s->v);
    free(s->g);
}

/* Kinetic energy after a step over what it was just before the step's damping. */
static double damped_share(Stick *s)
{
    s->type->goals(s->engine);
    s->type->get(s->engine, SM_GOAL, s->g);
    s->type->get(s->engine, SM_POSITION, s->x);
    s->type->get(s->engine, SM_VELOCITY, s->v);
    for (long p = 0; p < s->count; p++)
        for (int d = 0; d < 3; d++) s->v[p][d] += (s->g[p][d] - s->x[p][d]) / s->h;
    double before = kinetic(s);
    s->type->step(s->engine, NULL);
    s->type->get(s->engine, SM_VELOCITY, s->v);
    return kinetic(s) / before;
}

/* Sticks of one cell across: all but the middle of the longer ones is beyond single precision. */
static void takes_energy(const SmEngineType *type, SmLayout layout, double damping)
{
    static const int length[] = {1000, 5000, 20000};
    static const OctOptions options = {
        .sampling = {.levels = 1}, .epsilon = 0.5, .width = {.edges = 1}};
    const double slack = 1e-6; /* the velocities' own rounding */
    for (int n = 0; n < (TEST_FIGURES ? 3 : 1); n++) {
        Stick stick;
        SmEngineParams params = {.w = 1,
                                 .h = 0.01,
                                 .damping = damping,
                                 .layout = layout,
                                 .octree = &options,
                                 .threads = 1};
        stick_create(type, &params, length[n], &stick);
        for (int step = 0; step < 200; step++) {
            double share = damped_share(&stick);
            if (!(share <= 1 + slack))
                fail_msg("%s, layout %d, %d cells, step %d: damping makes energy %g-fold",
                         type->name, (int)layout, length[n], step, share);
        }
        stick_free(&stick);
    }
}

TEST(octree_damping_takes_energy)
{
    takes_energy(&octree_engine_f32, SM_LAYOUT_AUTO, 0.3);
}

TEST(list_damping_takes_energy)
{
    takes_energy(&fastlsm_engine_f32, SM_LAYOUT_LISTS, 0.3);
}

TEST(block_damping_takes_energy)
{
    takes_energy(&fastlsm_engine_f32, SM_LAYOUT_BLOCKS, 1);
}
