/* Rest shapes of plastic bodies through the common interface: read, and put into another engine. */
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../engine.h"

enum { SIDE = 6, BODIES = 2 };

static const SmEngineType *const engines[2] = {&octree_engine_f32, &octree_engine_f64};

static SmEngine *make(const SmEngineType *type, double creep, long *count)
{
    SmVoxels voxels;
    SmEngine *engine;
    SmCounts counts;
    sm_voxels_init(&voxels, SIDE, SIDE, SIDE, 0.5);
    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        sm_voxel_set(&voxels, n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE);
    sm_voxels_count(&voxels);
    OctOptions options = {.epsilon = 0.5,
                          .sampling = {.levels = 1, .nodes = 100},
                          .yield = 0.02,
                          .creep = creep,
                          .most = 0.5};
    SmEngineParams params = {.h = 0.01, .threads = 1, .instances = BODIES, .octree = &options};
    assert_int_equal(type->create(&voxels, &params, &engine, NULL), SM_OK);
    type->count(engine, &counts);
    *count = counts.particles;
    sm_voxels_free(&voxels);
    return engine;
}

/* A third of the height is pressed out of the first body, a tenth out of the second. */
static void squash(const SmEngineType *type, SmEngine *engine, long n)
{
    double(*x)[3] = triples(n);
    type->get(engine, SM_REST, x);
    for (long i = 0; i < n; i++) x[i][1] *= i < n / BODIES ? 0.67 : 0.9;
    type->set(engine, SM_POSITION, (const double(*)[3])x);
    free(x);
}

static double determinant(const double S[9])
{
    return S[0] * (S[4] * S[8] - S[5] * S[7]) - S[1] * (S[3] * S[8] - S[5] * S[6]) +
           S[2] * (S[3] * S[7] - S[4] * S[6]);
}

TEST(shapes_go_from_engine_to_engine)
{
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        double limit = precision ? 1e-12 : 1e-5, change = 0;
        long n;
        SmEngine *one = make(type, 20, &n), *two = make(type, 20, &n);
        double(*S)[9] = sm_alloc((size_t)n, sizeof *S),
        (*again)[9] = sm_alloc((size_t)n, sizeof *S);
        double(*a)[3] = triples(n), (*b)[3] = triples(n);
        squash(type, one, n);
        type->step(one, NULL);
        assert_true(type->get_shapes(one, S) && type->set_shapes(two, (const double(*)[9])S));
        assert_true(type->get_shapes(two, again));
        assert_memory_equal(S, again, (size_t)n * sizeof *S);
        for (long i = 0; i < n; i++) {
            assert_true(fabs(determinant(S[i]) - 1) < limit);
            change = fmax(change, fabs(S[i][4] - 1));
        }
        assert_true(change > 0.02);
        for (int field = SM_POSITION; field <= SM_VELOCITY; field++) {
            type->get(one, (SmField)field, a);
            type->set(two, (SmField)field, (const double(*)[3])a);
        }
        type->step(one, NULL); /* and flow on alike */
        type->step(two, NULL);
        type->get(one, SM_GOAL, a);
        type->get(two, SM_GOAL, b);
        assert_true(field_difference(n, (const double(*)[3])a, (const double(*)[3])b) < limit);
        type->get_shapes(one, S);
        type->get_shapes(two, again);
        for (long i = 0; i < n; i++)
            for (int k = 0; k < 9; k++) assert_true(fabs(S[i][k] - again[i][k]) < limit);
        type->destroy(one);
        type->destroy(two);
        free(S);
        free(again);
        free(a);
        free(b);
    }
}

TEST(elastic_bodies_have_none)
{
    for (int precision = 0; precision < 2; precision++) {
        long n;
        SmEngine *engine = make(engines[precision], 0, &n);
        double(*S)[9] = sm_alloc((size_t)n, sizeof *S);
        assert_false(engines[precision]->get_shapes(engine, S));
        assert_false(engines[precision]->set_shapes(engine, (const double(*)[9])S));
        engines[precision]->destroy(engine);
        free(S);
    }
}
