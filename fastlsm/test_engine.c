/* What happens around the step - handles, obstacles, pushes, instances, fracture, long journeys -
 * beside the brute-force engine. */
#include "test_body.h"

#include <float.h>

#include "../lib/engine/test_touching.h"
#include "../lib/test_frame.h"
#include "../lib/test_piece_sums.h"

/* Both engines from the same state, `steps` steps; the largest difference in cells. */
static double race(int precision, Body *body, SmEngineParams params, const SmBoundary *boundary,
                   int steps)
{
    const SmEngineType *type = engines[precision];
    long n = body->n * (params.instances > 1 ? params.instances : 1);
    double(*a)[3] = triples(n), (*b)[3] = triples(n);
    SmEngine *fast, *slow;
    SmError error;
    params.mass = body->m;
    assert_int_equal(type->create(&body->voxels, &params, &fast, &error), SM_OK);
    assert_int_equal(ref_brute_engine.create(&body->voxels, &params, &slow, &error), SM_OK);
    unsigned seed = 11;
    type->get(fast, SM_REST, a);
    for (long p = 0; p < n; p++)
        for (int d = 0; d < 3; d++) a[p][d] += 0.1 * body->voxels.cell * (random_unit(&seed) - 0.5);
    type->set(fast, SM_POSITION, (const double(*)[3])a);
    type->get(fast, SM_POSITION, a);
    ref_brute_engine.set(slow, SM_POSITION, (const double(*)[3])a);
    if (boundary) type->bound(fast, boundary);
    if (boundary) ref_brute_engine.bound(slow, boundary);
    for (int step = 0; step < steps; step++) {
        long pushed[2] = {0, n - 1};
        double impulse[2][3] = {{0.1, 0, 0}, {0, -0.2, 0.1}};
        type->push(fast, 2, pushed, (const double(*)[3])impulse);
        ref_brute_engine.push(slow, 2, pushed, (const double(*)[3])impulse);
        type->step(fast, NULL);
        ref_brute_engine.step(slow, NULL);
    }
    type->get(fast, SM_POSITION, a);
    ref_brute_engine.get(slow, SM_POSITION, b);
    double worst = field_difference(n, (const double(*)[3])a, (const double(*)[3])b);
    type->get(fast, SM_VELOCITY, a);
    ref_brute_engine.get(slow, SM_VELOCITY, b);
    double speed = field_difference(n, (const double(*)[3])a, (const double(*)[3])b);
    worst = fmax(worst, speed * params.h);
    SmCounts counts[2];
    type->count(fast, &counts[0]);
    ref_brute_engine.count(slow, &counts[1]);
    assert_int_equal(counts[0].particles, counts[1].particles);
    assert_int_equal(counts[0].regions, counts[1].regions);
    assert_int_equal(counts[0].links, counts[1].links);
    assert_int_equal(counts[0].broken, counts[1].broken);
    type->destroy(fast);
    ref_brute_engine.destroy(slow);
    free(a);
    free(b);
    return worst / body->voxels.cell;
}

static void block(Body *body, int x, int y, int z)
{
    memset(body, 0, sizeof *body);
    sm_voxels_init(&body->voxels, x, y, z, 0.5);
    for (int k = 0; k < z; k++)
        for (int j = 0; j < y; j++)
            for (int i = 0; i < x; i++)
                if (i + j + k != 3) sm_voxel_set(&body->voxels, i, j, k);
    sm_voxels_count(&body->voxels);
    body_arrays(body);
}

static const double limit[2] = {2e-3, 1e-9}; /* tens of steps magnify single precision's rounding */

TEST(test_handles)
{
    for (int precision = 0; precision < 2; precision++)
        for (int layout = 1; layout <= 2; layout++) {
            Body body;
            block(&body, 9, 4, 3);
            long left[3] = {0, 10, 20}, right[2] = {9, 19};
            SmHandle handle[2] = {
                {.count = 3, .particle = left, .pose = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
                {.count = 2,
                 .particle = right,
                 .pose = {{0.8, -0.6, 0, 1}, {0.6, 0.8, 0, 0}, {0, 0, 1, 0}}}};
            SmBoundary boundary = {.handle_count = 2, .handle = handle};
            SmEngineParams params = {.w = 2,
                                     .h = 0.01,
                                     .damping = 0.1,
                                     .gravity = {0, -9.81, 0},
                                     .layout = (SmLayout)layout};
            assert_true(race(precision, &body, params, &boundary, 25) < limit[precision]);
            body_free(&body);
        }
}

TEST(test_obstacles)
{
    const SmObstacle obstacle[4] = {
        {.kind = SM_PLANE, .a = {0, -0.1, 0}, .b = {0, 1, 0}, .friction = 0.3},
        {.kind = SM_SPHERE, .a = {1, 0.3, 1}, .radius = 0.7, .friction = 0.1},
        {.kind = SM_BOX, .a = {3, -1, -1}, .b = {3.4, 0.4, 9}},
        {.kind = SM_CAPSULE, .a = {0, 0.2, 0}, .b = {5, 0.2, 0}, .radius = 0.3, .friction = 1},
    };
    for (int precision = 0; precision < 2; precision++)
        for (int n = 0; n < 4; n++) {
            Body body;
            block(&body, 9, 4, 3);
            SmBoundary boundary = {.obstacle_count = 1, .obstacle = &obstacle[n]};
            SmEngineParams params = {
                .w = 1, .h = 0.01, .damping = n % 2 ? 0.2 : 0, .gravity = {0, -9.81, 0}};
            double worst = race(precision, &body, params, &boundary, 12);
            if (!(worst < 2 * limit[precision])) fail_msg("obstacle %d: %g cells", n, worst);
            body_free(&body);
        }
}

TEST(test_instances)
{
    double pose[19][3][4];
    for (int i = 0; i < 19; i++) {
        double c = cos(i), s = sin(i),
               p[3][4] = {{c, -s, 0, 9.0 * i}, {s, c, 0, -i}, {0, 0, 1, 100}};
        memcpy(pose[i], p, sizeof p);
    }
    const SmObstacle ground = {.kind = SM_PLANE, .a = {0, 1, 0}, .b = {0, 1, 0}};
    SmBoundary boundary = {.obstacle_count = 1, .obstacle = &ground};
    for (int trial = 0; trial < 12; trial++) {
        Body body;
        block(&body, 4, 5, 3);
        SmEngineParams params = {.w = 1 + trial / 2 % 3,
                                 .h = 0.01,
                                 .damping = trial / 6 * 0.2,
                                 .gravity = {0, -9.81, 0},
                                 .instances = 19,
                                 .instance_pose = (const double(*)[3][4])pose,
                                 .threads = 1 + trial % 2};
        double worst = race(trial % 2, &body, params, &boundary, 20);
        if (!(worst < limit[trial % 2])) fail_msg("trial %d: %g cells", trial, worst);
        body_free(&body);
    }
}

/* Cubes on the ground, side by side: rounding does not drive them apart. */
TEST(what_touches_does_not_creep)
{
    SmEngineParams params = {.w = 2};
    double moved = touching_moves(engines[0], params, 6, (double[]){2.975, 0, 0}, 4000);
    if (!(moved < 1e-4)) fail_msg("%g", moved);
}

/* Reads one instance of a body, or a body alone, into `to`. */
static void get_instance(const SmEngineType *type, SmEngine *engine, SmField field, long body,
                         long n, double (*to)[3])
{
    SmCounts counts;
    type->count(engine, &counts);
    double(*all)[3] = triples(counts.particles);
    type->get(engine, field, all);
    memcpy(to, all + body * n, (size_t)n * sizeof *to);
    free(all);
}

/* Sets every instance to a random state of its own. */
static void set_random(const SmEngineType *type, SmEngine *engine, const Body *body, long instances,
                       unsigned *seed)
{
    long n = body->n;
    double(*x)[3] = triples(instances * n), (*v)[3] = triples(instances * n);
    for (long k = 0; k < instances; k++)
        random_deformation(seed, body->voxels.cell, 0.3, n, (const double(*)[3])body->x0,
                           x + k * n);
    for (long p = 0; p < instances * n; p++)
        for (int d = 0; d < 3; d++) v[p][d] = body->voxels.cell * (random_unit(seed) - 0.5);
    type->set(engine, SM_POSITION, (const double(*)[3])x);
    type->set(engine, SM_VELOCITY, (const double(*)[3])v);
    free(x);
    free(v);
}

/* Goals of an instance, in body->a, beside those of the same body alone in every form of its sums,
 * and by brute force. */
static void check_alone(const SmEngineType *type, Body *body, SmEngineParams params, double allowed)
{
    params.instances = 1;
    for (int form = 0; form < 6; form++) {
        const SmEngineType *twin = form == 5 ? &ref_brute_engine : type;
        params.layout = form < 3 ? SM_LAYOUT_LISTS : SM_LAYOUT_BLOCKS;
        params.summation = form < 3 ? (SmSummation)form : (SmSummation)(form - 3);
        SmEngine *alone = create(twin, body, params);
        twin->goals(alone);
        twin->get(alone, SM_GOAL, body->b);
        double worst = difference(body, (const double(*)[3])body->a, (const double(*)[3])body->b);
        if (!(worst <= allowed))
            fail_msg("%s, w %d, %ld particles, form %d: goals differ by %g cells", type->precision,
                     params.w, body->n, form, worst);
        twin->destroy(alone);
    }
}

/* Two damped steps of every instance, and of some of them by brute force. */
static void check_steps(const SmEngineType *type, SmEngine *instances, Body *body,
                        SmEngineParams params, double allowed)
{
    long tried[3] = {0, params.instances / 2, params.instances - 1};
    SmEngine *alone[3];
    for (int i = 0; i < 3; i++) {
        get_instance(type, instances, SM_POSITION, tried[i], body->n, body->x);
        get_instance(type, instances, SM_VELOCITY, tried[i], body->n, body->v);
        SmEngineParams one = params;
        one.instances = 1;
        alone[i] = create(&ref_brute_engine, body, one);
    }
    for (int step = 0; step < 2; step++) type->step(instances, NULL);
    for (int i = 0; i < 3; i++) {
        for (int step = 0; step < 2; step++) ref_brute_engine.step(alone[i], NULL);
        get_instance(type, instances, SM_POSITION, tried[i], body->n, body->a);
        ref_brute_engine.get(alone[i], SM_POSITION, body->b);
        double worst = difference(body, (const double(*)[3])body->a, (const double(*)[3])body->b);
        if (!(worst <= allowed))
            fail_msg("%s, w %d, instance %ld of %ld, %ld particles: %g cells off after two steps",
                     type->precision, params.w, tried[i], params.instances, body->n, worst);
        ref_brute_engine.destroy(alone[i]);
    }
}

/* Bodies of one layer of lists and of many, of every kind of shape: an instance moves as the body
 * does alone. */
TEST(test_instances_alone)
{
    unsigned seed = 12;
    for (int trial = 0; trial < (TEST_FIGURES ? 24 : 12); trial++) {
        Body body;
        int precision = trial % 2, w = 1 + trial % 5;
        const SmEngineType *type = engines[precision];
        body_random(&seed, trial % 6, w > 3 ? 12 : 20, &body);
        SmEngineParams params = {.w = w,
                                 .h = 0.01,
                                 .damping = trial % 3 * 0.15,
                                 .gravity = {0, -9.81, 1},
                                 .instances = 2 + random_int(&seed, 20),
                                 .mass = body.m,
                                 .threads = 1 + trial % 2};
        SmEngine *instances;
        SmError error;
        assert_int_equal(type->create(&body.voxels, &params, &instances, &error), SM_OK);
        set_random(type, instances, &body, params.instances, &seed);
        long k = random_int(&seed, (int)params.instances);
        get_instance(type, instances, SM_POSITION, k, body.n, body.x);
        type->goals(instances);
        get_instance(type, instances, SM_GOAL, k, body.n, body.a);
        check_alone(type, &body, params, precision ? 1e-11 : 5e-5);
        check_steps(type, instances, &body, params, precision ? 1e-9 : 1e-3);
        type->destroy(instances);
        body_free(&body);
    }
}

/* Breaking while it runs equals the reference, which builds all regions anew. */
TEST(test_fracture)
{
    for (int trial = 0; trial < 8; trial++) {
        Body body;
        block(&body, 12, 4, 3);
        long left[2] = {0, 13}, right[2] = {12, 25};
        SmHandle handle[2] = {
            {.count = 2, .particle = left, .pose = {{1, 0, 0, -0.3}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
            {.count = 2, .particle = right, .pose = {{1, 0, 0, 0.4}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
        SmBoundary boundary = {.handle_count = 2, .handle = handle};
        SmEngineParams params = {.w = 1 + trial / 4,
                                 .h = 0.01,
                                 .damping = 0.1,
                                 .strain_limit = 1.25,
                                 .layout = (SmLayout)(1 + trial / 2 % 2)};
        int precision = trial % 2;
        double worst = race(precision, &body, params, &boundary, 10);
        if (!(worst < 5 * limit[precision])) fail_msg("trial %d: %g cells", trial, worst);
        body_free(&body);
    }
}

/* A block that is long along an axis, which the engine turns inside, and a plane across it. */
static void long_block(int axis, Body *body, SmCut *cut)
{
    int size[3] = {4, 4, 4};
    size[axis] = 13;
    block(body, size[0], size[1], size[2]);
    memcpy(body->x, body->x0, (size_t)body->n * sizeof *body->x);
    sm_cut_init(cut, 2 * body->voxels.cell);
    for (int n = 0; n < 4; n++) {
        double at[3];
        for (int d = 0; d < 3; d++) {
            bool high = d == (axis + 1) % 3 ? n % 2 : n / 2;
            at[d] = body->voxels.origin[d] + body->voxels.cell * (d == axis ? 5.5
                                                                  : high    ? 20
                                                                            : -20);
        }
        sm_cut_vertex(cut, at);
    }
    sm_cut_triangle(cut, (int[3]){0, 1, 3});
    sm_cut_triangle(cut, (int[3]){0, 3, 2});
}

static bool is_beyond(const Body *body, int axis, long p)
{
    return (body->x0[p][axis] - body->voxels.origin[axis]) / body->voxels.cell > 5.5;
}

TEST(a_body_that_was_not_made_for_it_is_not_cut)
{
    Body body;
    SmCut cut;
    SmError error;
    long_block(0, &body, &cut);
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngine *engine = create(type, &body, (SmEngineParams){.w = 1, .h = 0.01});
        assert_int_equal(type->cut(engine, &cut, 0, &error), SM_USAGE);
        assert_non_null(strstr(error.text, "cut: the body was not made to break"));
        assert_int_equal(type->break_links(engine, 1, (const int[][2]){{0, 1}}, &error), SM_USAGE);
        assert_non_null(strstr(error.text, "break_links: the body was not made to break"));
        type->destroy(engine);
    }
    sm_cut_free(&cut);
    body_free(&body);
}

/* Each has its own mass. */
static void check_cut_pieces(const SmEngineType *type, SmEngine *engine, const Body *body, int axis)
{
    SmPieces pieces;
    SmCounts counts;
    double mass[2], *each = sm_alloc((size_t)body->n, sizeof *each);
    type->pieces(engine, &pieces);
    assert_int_equal(pieces.count, 2);
    type->count(engine, &counts);
    assert_int_equal(counts.broken, 25 + 4 * 2 * 2 * 5 + 4 * 4 * 4); /* faces, edges, corners */
    type->masses(engine, each);
    sum_pieces(&pieces, body->n, each, mass);
    for (long p = 0; p < body->n; p++) {
        assert_int_equal(pieces.piece[p], is_beyond(body, axis, p));
        mass[pieces.piece[p]] -= body->m[p];
    }
    assert_true(fabs(mass[0]) < 1e-4 && fabs(mass[1]) < 1e-4);
    free(each);
    sm_pieces_free(&pieces);
}

/* Pushed apart, each moves as a whole. */
static void check_cut_motion(const SmEngineType *type, SmEngine *engine, Body *body, int axis)
{
    for (long p = 0; p < body->n; p++)
        for (int d = 0; d < 3; d++)
            body->v[p][d] = d != axis ? 0 : is_beyond(body, axis, p) ? 1 : -1;
    type->set(engine, SM_VELOCITY, (const double(*)[3])body->v);
    for (int step = 0; step < 50; step++) type->step(engine, NULL);
    type->get(engine, SM_POSITION, body->x);
    for (long p = 0; p < body->n; p++)
        for (int d = 0; d < 3; d++)
            assert_true(fabs(body->x[p][d] - body->x0[p][d] - 0.5 * body->v[p][d]) < 1e-4);
}

TEST(a_cut_makes_two_bodies)
{
    for (int trial = 0; trial < 12; trial++) {
        const SmEngineType *type = engines[trial % 2];
        int axis = trial / 2 % 3;
        Body body;
        SmCut cut;
        SmError error;
        SmPieces pieces;
        long_block(axis, &body, &cut);
        SmEngineParams params = {
            .w = 1, .h = 0.01, .strain_limit = INFINITY, .layout = (SmLayout)(trial / 6 % 2 + 1)};
        SmEngine *engine = create(type, &body, params);
        type->pieces(engine, &pieces);
        assert_int_equal(pieces.count, 1);
        sm_pieces_free(&pieces);
        assert_int_equal(type->cut(engine, &cut, 0, &error), SM_OK);
        check_cut_pieces(type, engine, &body, axis);
        check_cut_motion(type, engine, &body, axis);
        sm_cut_free(&cut);
        type->destroy(engine);
        body_free(&body);
    }
}

/* Falling 10,000 cells far, goals stay as exact as at home. */
TEST(test_journey)
{
    Body body;
    block(&body, 9, 4, 3);
    SmEngineParams params = {.w = 2, .h = 0.01, .gravity = {0, -981, 0}};
    SmEngine *engine = create(&fastlsm_engine_f32, &body, params);
    RefRegions regions;
    ref_regions_build(&body.voxels, 2, NULL, 0, &regions);
    for (int step = 0; step < 320; step++) fastlsm_engine_f32.step(engine, NULL);
    fastlsm_engine_f32.get(engine, SM_POSITION, body.x);
    assert_true(body.x[0][1] < -4000);
    fastlsm_engine_f32.goals(engine);
    fastlsm_engine_f32.get(engine, SM_GOAL, body.a);
    ref_goals(&regions, (const double(*)[3])body.x0, body.m, (const double(*)[3])body.x, body.b);
    assert_true(difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.b) < 5e-5);
    ref_regions_free(&regions);
    fastlsm_engine_f32.destroy(engine);
    body_free(&body);
}

TEST(test_bad_parameters)
{
    Body body;
    block(&body, 2, 2, 2);
    const double nothing[27] = {0};
    const SmEngineParams bad[] = {{.w = 0, .h = 0.01},
                                  {.w = 99, .h = 0.01},
                                  {.w = 1, .h = 0},
                                  {.w = 1, .h = NAN},
                                  {.w = 1, .h = 0.01, .damping = 2},
                                  {.w = 1, .h = 0.01, .instances = 2, .strain_limit = 2},
                                  {.w = 1, .h = 0.01, .instances = 2, .polar = SM_POLAR_JACOBI},
                                  {.w = 1, .h = 0.01, .strain_limit = -1},
                                  {.w = 1, .h = 0.01, .strain_limit = 0.05},
                                  {.w = 1, .h = 0.01, .gravity = {0, INFINITY, 0}},
                                  {.w = 1, .h = 0.01, .mass = nothing}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        SmEngine *engine;
        SmError error = {0};
        assert_int_equal(fastlsm_engine_f32.create(&body.voxels, &bad[i], &engine, &error),
                         SM_INPUT);
        assert_true(strlen(error.text) > 10);
    }
    body_free(&body);
}

/* A body at rest is held where goals are off by rounding, and not where they are farther off. */
TEST(rounding_alone_is_held)
{
    for (int trial = 0; trial < 8; trial++) {
        Body body;
        int length = trial / 4 ? 200 : 6, precision = trial / 2 % 2, farther = trial % 2;
        const SmEngineType *type = engines[precision];
        block(&body, length, 4, 3);
        double most = 6 * (precision ? DBL_EPSILON : FLT_EPSILON) * (length + 2);
        SmEngine *engine = create(type, &body, (SmEngineParams){.w = 1, .h = 0.01});
        type->get(engine, SM_REST, body.x);
        body.x[0][0] += body.voxels.cell * (farther ? 4 : 0.5) * fmin(most, precision ? 1 : 2.5e-5);
        type->set(engine, SM_POSITION, (const double(*)[3])body.x);
        type->step(engine, NULL);
        type->get(engine, SM_VELOCITY, body.a);
        if ((body.a[0][0] != 0) != farther) fail_msg("trial %d: %g", trial, body.a[0][0]);
        type->destroy(engine);
        body_free(&body);
    }
}

/* The unit of mass changes nothing: neither a grain nor a mountain leaves the fast path's range. */
TEST(test_mass_unit)
{
    const double unit[3] = {1e-25, 1, 1e25};
    for (int trial = 0; trial < 6; trial++) {
        Body body;
        block(&body, 6, 4, 3);
        for (long p = 0; p < body.n; p++) body.m[p] = unit[trial / 2] * (1 + (double)(p % 3));
        random_deformation(&(unsigned){9}, body.voxels.cell, 0.3, body.n,
                           (const double(*)[3])body.x0, body.x);
        SmEngineParams params = {.w = 1, .h = 0.01, .damping = 0.2};
        SmEngine *fast = create(engines[trial % 2], &body, params);
        engines[trial % 2]->get(fast, SM_POSITION, body.x);
        SmEngine *slow = create(&ref_brute_engine, &body, params);
        engines[trial % 2]->step(fast, NULL);
        ref_brute_engine.step(slow, NULL);
        engines[trial % 2]->get(fast, SM_POSITION, body.a);
        ref_brute_engine.get(slow, SM_POSITION, body.b);
        double worst = difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.b);
        if (!(worst < (trial % 2 ? 1e-11 : 1e-4)))
            fail_msg("unit %g: %g cells", unit[trial / 2], worst);
        engines[trial % 2]->masses(fast, body.m);
        assert_true(fabs(body.m[1] / unit[trial / 2] - 2) < 1e-12);
        engines[trial % 2]->destroy(fast);
        ref_brute_engine.destroy(slow);
        body_free(&body);
    }
}
