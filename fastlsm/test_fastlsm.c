/* Holds the engine to its brute-force twin and to the invariants of shape matching. */
#include "test_body.h"

#include "../lib/test_frame.h"
#include "../lib/voxel/sites.h"

/* Largest deviations of goal positions allowed, in cells: what `shapebench tables` allows a row in
 * single precision (coordinates of 30 cells carry 2e-6, a region 12 cells across turns that into
 * several times as much at its ends), and the same multiple of epsilon in double. */
static const double tolerance[2] = {5e-5, 1e-11};

static void check_goals(int precision, SmSummation summation, SmPolarMethod polar, SmLayout layout,
                        int w, Body *body)
{
    SmEngineParams params = {
        .w = w, .h = 0.01, .summation = summation, .polar = polar, .layout = layout, .threads = 1};
    SmEngine *engine = create(engines[precision], body, params);
    RefRegions regions;
    ref_regions_build(&body->voxels, w, NULL, 0, &regions);
    /* the reference starts from the positions as the engine's precision holds them */
    engines[precision]->get(engine, SM_POSITION, body->x);
    engines[precision]->goals(engine);
    engines[precision]->get(engine, SM_GOAL, body->a);
    ref_goals(&regions, (const double(*)[3])body->x0, body->m, (const double(*)[3])body->x,
              body->b);
    double worst = difference(body, (const double(*)[3])body->a, (const double(*)[3])body->b);
    if (!(worst <= tolerance[precision]))
        fail_msg("%s, layout %d, w %d, %dx%dx%d cells, %ld particles: goals differ by %g cells",
                 engines[precision]->precision, (int)layout, w, body->voxels.size[0],
                 body->voxels.size[1], body->voxels.size[2], body->n, worst);
    SmCounts counts;
    engines[precision]->count(engine, &counts);
    assert_int_equal(counts.regions, ref_regions_unique(&regions));
    assert_int_equal(counts.particles, body->n);
    ref_regions_free(&regions);
    engines[precision]->destroy(engine);
}

TEST(test_goals)
{
    unsigned seed = 1;
    for (int trial = 0; trial < (TEST_FIGURES ? 360 : 72); trial++) {
        Body body;
        int w = 1 + trial % 6;
        body_random(&seed, trial / 6 % 6, w > 3 ? 12 : 20, &body);
        check_goals(trial / 36 % 2, (SmSummation)((trial + trial / 6) % 3),
                    (SmPolarMethod)(trial / 12 % 2), (SmLayout)(1 + trial / 18 % 2), w, &body);
        body_free(&body);
    }
}

/* Wide regions, up to the widest, in list form, whose sums are running: random shapes; bodies of
 * several layers; a particle so heavy that its rounding must not stay behind in a sum. */
TEST(test_wide_lists)
{
    unsigned seed = 8;
    for (int trial = 0; trial < 60; trial++) {
        Body body;
        body_random(&seed, trial % 6, trial < 50 ? 14 : 6, &body);
        if (trial % 5 == 4) body.m[random_int(&seed, (int)body.n)] = 100;
        check_goals(trial / 6 % 2, SM_SUM_FAST, SM_POLAR_FAST, SM_LAYOUT_LISTS, 4 + trial % 5,
                    &body);
        body_free(&body);
    }
    for (int trial = 0; trial < 8; trial++) {
        Body body;
        const int size[3] = {trial < 4 ? 7 : 70, 9, trial < 4 ? 128 : 5};
        random_block(&seed, size, 0.5, trial % 2 ? 0.8 : 1, &body.voxels);
        body_arrays(&body);
        random_deformation(&seed, 0.5, 0.3, body.n, (const double(*)[3])body.x0, body.x);
        check_goals(trial / 2 % 2, SM_SUM_FAST, SM_POLAR_FAST,
                    trial == 6 ? SM_LAYOUT_BLOCKS : SM_LAYOUT_LISTS,
                    trial > 4 ? SM_MOST_W : 4 + trial % 3, &body);
        body_free(&body);
    }
}

/* At rest, two tall walls a cell apart and joined at the foot: a block's box sum takes both. */
TEST(test_two_walls_in_a_box)
{
    for (int precision = 0; precision < 2; precision++) {
        Body body;
        sm_voxels_init(&body.voxels, 3, 60, 12, 0.25);
        for (int y = 0; y < 60; y++)
            for (int z = 0; z < 12; z++)
                for (int x = 0; x < 3; x++)
                    if (x != 1 || !y) sm_voxel_set(&body.voxels, x, y, z);
        sm_voxels_count(&body.voxels);
        body_arrays(&body);
        memcpy(body.x, body.x0, (size_t)body.n * sizeof *body.x);
        check_goals(precision, SM_SUM_FAST, SM_POLAR_FAST, SM_LAYOUT_BLOCKS, 8, &body);
        body_free(&body);
    }
}

/* Member by member, single precision keeps thousands of members apart: bars and plates have sums of
 * their own, without which goals are off by 2.2e-5. */
TEST(test_wide_naive)
{
    unsigned seed = 9;
    Body body;
    random_block(&seed, (const int[3]){44, 22, 22}, 0.02, 1, &body.voxels);
    body_arrays(&body);
    random_deformation(&seed, 0.02, 0.3, body.n, (const double(*)[3])body.x0, body.x);
    double(*goal[2])[3] = {body.a, body.b};
    for (int precision = 0; precision < 2; precision++) {
        SmEngineParams params = {.w = 10, .h = 0.01, .summation = SM_SUM_NAIVE, .threads = 1};
        SmEngine *engine = create(engines[precision], &body, params);
        if (precision == 0) engines[0]->get(engine, SM_POSITION, body.x);
        engines[precision]->goals(engine);
        engines[precision]->get(engine, SM_GOAL, goal[precision]);
        engines[precision]->destroy(engine);
    }
    double worst = difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.b);
    if (!(worst < 1e-5)) fail_msg("goals are %g cells from those in double precision", worst);
    body_free(&body);
}

/* Every member list against breadth-first search. */
TEST(test_regions)
{
    unsigned seed = 2;
    for (int trial = 0; trial < 60; trial++) {
        Body body;
        int w = 1 + trial % 6;
        body_random(&seed, trial % 6, 10, &body);
        SmEngineParams params = {.w = w, .h = 0.01};
        SmEngine *engine = create(&fastlsm_engine_f32, &body, params);
        RefRegions regions;
        ref_regions_build(&body.voxels, w, NULL, 0, &regions);
        long *member = sm_alloc((size_t)body.n, sizeof *member);
        for (long p = 0; p < body.n; p++) {
            long count = fastlsm_engine_f32.region(engine, p, member, body.n);
            assert_int_equal(count, regions.start[p + 1] - regions.start[p]);
            for (long i = 0; i < count; i++)
                assert_int_equal(member[i], regions.member[regions.start[p] + i]);
        }
        free(member);
        ref_regions_free(&regions);
        fastlsm_engine_f32.destroy(engine);
        body_free(&body);
    }
}

/* Whole steps, damping and gravity included, beside the brute-force engine. */
TEST(test_steps)
{
    unsigned seed = 3;
    for (int trial = 0; trial < 72; trial++) {
        Body body;
        int precision = trial % 2;
        body_random(&seed, trial % 6, 9, &body);
        SmEngineParams params = {.w = 1 + trial / 6 % 3 + (trial / 36 ? 3 : 0),
                                 .h = 0.01,
                                 .damping = 0.3,
                                 .damping_every = 1 + trial / 2 % 2,
                                 .layout = (SmLayout)(1 + trial / 18 % 2),
                                 .gravity = {0, -9.81, 1}};
        SmEngine *fast = create(engines[precision], &body, params);
        engines[precision]->get(fast, SM_POSITION, body.x);
        engines[precision]->get(fast, SM_VELOCITY, body.v);
        SmEngine *slow = create(&ref_brute_engine, &body, params);
        for (int step = 0; step < 3; step++) {
            engines[precision]->step(fast, NULL);
            ref_brute_engine.step(slow, NULL);
        }
        engines[precision]->get(fast, SM_POSITION, body.a);
        ref_brute_engine.get(slow, SM_POSITION, body.b);
        double worst = difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.b);
        /* three steps of a noisy start: a lone cell's 8 particles may turn by eps / gap */
        if (!(worst <= (precision ? 1e-9 : 1e-3)))
            fail_msg("%s trial %d: positions differ by %g cells", engines[precision]->precision,
                     trial, worst);
        engines[precision]->destroy(fast);
        ref_brute_engine.destroy(slow);
        body_free(&body);
    }
}

TEST(test_momentum)
{
    unsigned seed = 4;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        int precision = trial % 2;
        body_random(&seed, trial % 6, 8, &body);
        /* damping conserves both only per region; eq. 14 with equal weights conserves the linear
         * one */
        SmEngineParams params = {
            .w = 1 + trial % 3, .h = 0.01, .layout = (SmLayout)(1 + trial / 12)};
        SmEngine *engine = create(engines[precision], &body, params);
        double p[2][3], l[2][3], scale = 0;
        for (int when = 0; when < 2; when++) {
            engines[precision]->get(engine, SM_POSITION, body.a);
            engines[precision]->get(engine, SM_VELOCITY, body.b);
            field_momenta(body.n, body.m, (const double(*)[3])body.a, (const double(*)[3])body.b,
                          p[when], l[when]);
            for (int step = 0; when == 0 && step < 20; step++)
                engines[precision]->step(engine, NULL);
        }
        double reach = 1 + body.voxels.cell * 20;
        for (long i = 0; i < body.n; i++) scale += body.m[i] * body.voxels.cell / 0.01;
        for (int d = 0; d < 3; d++) {
            double limit = precision ? 1e-12 : 5e-5; /* of one cell per step, over 20 steps */
            double dp = fabs(p[1][d] - p[0][d]) / scale,
                   dl = fabs(l[1][d] - l[0][d]) / (scale * reach);
            if (!(dp < limit && dl < limit))
                fail_msg("%s, trial %d: linear %g, angular %g", engines[precision]->precision,
                         trial, dp, dl);
        }
        engines[precision]->destroy(engine);
        body_free(&body);
    }
}

/* A rigidly moving body is left alone, and so is a resting one. */
TEST(test_rigid)
{
    unsigned seed = 5;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        int precision = trial % 2;
        body_random(&seed, trial % 6, 8, &body);
        double c = cos(0.7), s = sin(0.7), turn = 0.05;
        for (long p = 0; p < body.n; p++) {
            double *x0 = body.x0[p];
            double r[3] = {c * x0[0] - s * x0[1], s * x0[0] + c * x0[1], x0[2]};
            for (int d = 0; d < 3; d++) body.x[p][d] = r[d] + 3;
            body.v[p][0] = trial < 12 ? 0 : -turn * r[1];
            body.v[p][1] = trial < 12 ? 0 : turn * r[0];
            body.v[p][2] = trial < 12 ? 0 : 0.3;
        }
        SmEngineParams params = {
            .w = 1 + trial % 4, .h = 0.01, .damping = 0.5, .layout = (SmLayout)(1 + trial / 2 % 2)};
        SmEngine *engine = create(engines[precision], &body, params);
        engines[precision]->step(engine, NULL);
        engines[precision]->get(engine, SM_VELOCITY, body.a);
        /* in cells per second: (g - x) / h magnifies rounding a hundredfold */
        double worst = difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.v);
        if (!(worst < (precision ? 1e-8 : 5e-3))) fail_msg("trial %d: %g", trial, worst);
        engines[precision]->destroy(engine);
        body_free(&body);
    }
}

/* A large block at rest stays where it is to the last bit, also where regions are wide: sums of
 * many rows round no more than positions do. */
TEST(test_large_at_rest)
{
    needs_figures();
    Body body;
    sm_voxels_block(&body.voxels, 53, 53, 53, 1.0 / 53);
    body_arrays(&body);
    memcpy(body.x, body.x0, (size_t)body.n * sizeof *body.x);
    const int width[] = {1, 3, 4, 5, 8, 12};
    for (size_t i = 0; i < sizeof width / sizeof width[0]; i++) {
        SmEngineParams params = {.w = width[i], .h = 0.01, .layout = SM_LAYOUT_BLOCKS};
        SmEngine *engine = create(&fastlsm_engine_f32, &body, params);
        fastlsm_engine_f32.step(engine, NULL);
        fastlsm_engine_f32.get(engine, SM_POSITION, body.a);
        for (int step = 0; step < 30; step++) fastlsm_engine_f32.step(engine, NULL);
        fastlsm_engine_f32.get(engine, SM_POSITION, body.b);
        double moved = difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.b);
        if (!(moved == 0)) fail_msg("w %d: it moves by %g cells", width[i], moved);
        fastlsm_engine_f32.destroy(engine);
    }
    body_free(&body);
}

/* Crushed flat, inverted, blown up, or all in one point: it comes back to rest, never a NaN. */
TEST(test_recovery)
{
    const double crush[5][3] = {{1, 1, 0}, {-1, 1, 1}, {1000, 1000, 1000}, {0, 0, 0}, {1, 0, 0}};
    for (int trial = 0; trial < 20; trial++) {
        Body body;
        int precision = trial % 2;
        unsigned seed = 6;
        body_random(&seed, 5, 6, &body);
        for (long p = 0; p < body.n; p++)
            for (int d = 0; d < 3; d++) {
                body.v[p][d] = 0;
                body.x[p][d] = body.x0[p][d] * crush[trial / 4][d] +
                               1e-3 * body.voxels.cell * (random_unit(&seed) - 0.5);
            }
        SmEngineParams params = {.w = 1 + trial / 2 % 2,
                                 .h = 0.01,
                                 .damping = 0.2,
                                 .layout = (SmLayout)(1 + trial / 2 % 2)};
        SmEngine *engine = create(engines[precision], &body, params);
        for (int step = 0; step < 3000; step++) engines[precision]->step(engine, NULL);
        /* at rest: goals and positions agree */
        engines[precision]->goals(engine);
        engines[precision]->get(engine, SM_GOAL, body.a);
        engines[precision]->get(engine, SM_POSITION, body.b);
        double worst = difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.b);
        if (!(worst < 1e-3)) fail_msg("trial %d: still %g cells from rest", trial, worst);
        engines[precision]->destroy(engine);
        body_free(&body);
    }
}

/* Any number of threads gives the bits that one gives. */
static void check_threads(Body *body, int w, SmLayout layout, int most)
{
    for (int threads = 1; threads <= most; threads += most > 5 && threads < 2 ? 1 : 2) {
        SmEngineParams params = {
            .w = w, .h = 0.01, .damping = 0.3, .threads = threads, .layout = layout};
        SmEngine *engine = create(&fastlsm_engine_f32, body, params);
        for (int step = 0; step < (most > 5 ? 2 : 4); step++) fastlsm_engine_f32.step(engine, NULL);
        fastlsm_engine_f32.get(engine, SM_POSITION, threads == 1 ? body->a : body->b);
        if (threads > 1) assert_memory_equal(body->a, body->b, (size_t)body->n * sizeof(double[3]));
        fastlsm_engine_f32.destroy(engine);
    }
}

TEST(test_threads)
{
    for (int trial = 0; trial < 16; trial++) {
        unsigned seed = 7;
        Body body;
        bool wide = trial >= 8, solid = wide ? trial % 4 : trial < 3;
        const int size[3] = {24 + 7 * (trial % 3), wide ? 11 : 17,
                             wide ? 53 + 9 * (trial % 3) : 40};
        int w = wide ? trial - 5 : trial < 6 ? 1 + trial % 3 : 4;
        random_block(&seed, size, 0.5, solid ? 1 : wide ? 0.95 : 0.8, &body.voxels);
        body_arrays(&body);
        random_deformation(&seed, 0.5, 0.2, body.n, (const double(*)[3])body.x0, body.x);
        check_threads(&body, w, wide ? SM_LAYOUT_BLOCKS : (SmLayout)(1 + trial % 2), wide ? 8 : 5);
        body_free(&body);
    }
}

/* Bodies that are large enough for their building to be shared, whatever axis is turned. */
TEST(test_threads_that_build)
{
    const int size[3][3] = {{70, 30, 34}, {33, 80, 28}, {31, 29, 77}};
    for (int trial = 0; trial < 6; trial++) {
        unsigned seed = 8;
        Body body;
        random_block(&seed, size[trial % 3], 0.5, trial < 3 ? 0.97 : 0.6, &body.voxels);
        body_arrays(&body);
        random_deformation(&seed, 0.5, 0.2, body.n, (const double(*)[3])body.x0, body.x);
        check_threads(&body, 1 + trial % 2, (SmLayout)(1 + trial / 2 % 2), 5);
        body_free(&body);
    }
}

/* What hangs together, from the corners of each cell; bodies of many pieces, and large ones. */
TEST(test_pieces)
{
    for (int trial = 0; trial < 24; trial++) {
        unsigned seed = (unsigned)trial + 1;
        Body body;
        SmPieces made, wanted;
        if (trial < 20)
            body_random(&seed, trial % 5, 14, &body);
        else
            random_block(&seed, (const int[3]){37, 41, 60}, 1, trial % 2 ? 0.05 : 0.1,
                         &body.voxels);
        if (trial >= 20) body_arrays(&body);
        const SmVoxels *v = &body.voxels;
        SmSites sites;
        sm_sites_init(v, &sites);
        sm_pieces_init(body.n, &wanted);
        for (long p = 0; p < body.n; p++) {
            const int *at = sites.coordinate[p];
            for (int c = 1; c < 8 && sm_voxel_get(v, at[0], at[1], at[2]); c++)
                sm_pieces_link(
                    &wanted, p,
                    sm_sites_find(&sites, at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)));
        }
        sm_pieces_finish(&wanted, NULL, body.n);
        SmEngineParams params = {.w = 1, .h = 0.01, .threads = 1 + trial % 3};
        SmEngine *engine = create(&fastlsm_engine_f32, &body, params);
        fastlsm_engine_f32.pieces(engine, &made);
        assert_int_equal(made.count, wanted.count);
        assert_memory_equal(made.piece, wanted.piece, (size_t)body.n * sizeof(int));
        fastlsm_engine_f32.destroy(engine);
        sm_pieces_free(&made);
        sm_pieces_free(&wanted);
        sm_sites_free(&sites);
        body_free(&body);
    }
}
