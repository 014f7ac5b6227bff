/* The brute-force engine through the common interface: what a step does, and to whom. */
#include "../lib/test_fields.h"
#include "../lib/test_frame.h"
#include "../lib/test_random.h"
#include "brute.h"

#define CONST(array) ((const double(*)[3])(array))

static const SmEngineType *const type = &ref_brute_engine;

static SmEngine *create(int nx, int ny, int nz, const SmEngineParams *params)
{
    SmVoxels voxels;
    sm_voxels_block(&voxels, nx, ny, nz, 1.0);
    SmEngine *engine = NULL;
    SmError error;
    assert_int_equal(type->create(&voxels, params, &engine, &error), SM_OK);
    sm_voxels_free(&voxels); /* the engine has its own */
    return engine;
}

static long particles(SmEngine *engine)
{
    SmCounts counts;
    type->count(engine, &counts);
    return counts.particles;
}

/* The caller frees the array. */
static double (*field(SmEngine *engine, SmField name))[3]
{
    double(*values)[3] = sm_alloc((size_t)particles(engine), sizeof *values);
    type->get(engine, name, values);
    return values;
}

static void shake(SmEngine *engine, unsigned seed)
{
    long count = particles(engine);
    double(*x)[3] = field(engine, SM_POSITION), (*v)[3] = field(engine, SM_VELOCITY);
    for (long p = 0; p < count; p++)
        for (int a = 0; a < 3; a++) {
            x[p][a] += 0.5 * random_between(&seed, -0.5, 0.5);
            v[p][a] += random_between(&seed, -0.5, 0.5);
        }
    type->set(engine, SM_POSITION, CONST(x));
    type->set(engine, SM_VELOCITY, CONST(v));
    free(x);
    free(v);
}

TEST(a_body_falls_as_one)
{
    const SmEngineParams params = {.w = 2, .h = 0.01, .gravity = {0, -9.81, 1}, .damping = 0.5};
    SmEngine *engine = create(3, 2, 2, &params);
    const int steps = 20;
    for (int n = 0; n < steps; n++) type->step(engine, NULL);
    double(*x0)[3] = field(engine, SM_REST), (*x)[3] = field(engine, SM_POSITION);
    double(*v)[3] = field(engine, SM_VELOCITY);
    for (long p = 0; p < particles(engine); p++)
        for (int a = 0; a < 3; a++) { /* v_n = n h g, x_n = x0 + h^2 g n (n + 1) / 2 */
            double g = params.gravity[a], h = params.h;
            assert_true(fabs(v[p][a] - steps * h * g) < 1e-11);
            assert_true(fabs(x[p][a] - x0[p][a] - h * h * g * steps * (steps + 1) / 2) < 1e-12);
        }
    free(x0);
    free(x);
    free(v);
    type->destroy(engine);
}

static void momenta(SmEngine *engine, const double *m, double linear[3], double angular[3])
{
    double(*x)[3] = field(engine, SM_POSITION), (*v)[3] = field(engine, SM_VELOCITY);
    field_momenta(particles(engine), m, CONST(x), CONST(v), linear, angular);
    free(x);
    free(v);
}

TEST(steps_conserve_momentum)
{
    double m[60], linear[2][3], angular[2][3];
    unsigned seed = 3;
    for (int p = 0; p < 60; p++) m[p] = 1 + random_between(&seed, -0.5, 0.5);
    const SmEngineParams params = {.w = 1, .h = 0.1, .damping = 0.3, .mass = m};
    SmEngine *engine = create(4, 3, 2, &params);
    double masses[60];
    type->masses(engine, masses);
    assert_memory_equal(masses, m, sizeof m);
    shake(engine, 5);
    momenta(engine, m, linear[0], angular[0]);
    for (int n = 0; n < 20; n++) type->step(engine, NULL);
    momenta(engine, m, linear[1], angular[1]);
    for (int a = 0; a < 3; a++) {
        assert_true(fabs(linear[1][a] - linear[0][a]) < 1e-10);
        assert_true(fabs(angular[1][a] - angular[0][a]) < 1e-9);
    }
    type->destroy(engine);
}

/* Energy after one step with and without damping, and on the steps that damping_every leaves out.
 */
TEST(damping_takes_energy_when_due)
{
    const SmEngineParams none = {.w = 1, .h = 0.1};
    SmEngineParams third = none, every = none;
    third.damping = every.damping = 0.8;
    third.damping_every = 3;
    SmEngine *engine[3] = {create(3, 3, 3, &none), create(3, 3, 3, &third),
                           create(3, 3, 3, &every)};
    for (int n = 0; n < 6; n++) {
        double energy[3] = {0};
        for (int e = 0; e < 3; e++) {
            double(*rest)[3] = field(engine[e], SM_REST);
            type->set(engine[e], SM_POSITION, CONST(rest));
            memset(rest, 0, 64 * sizeof *rest);
            type->set(engine[e], SM_VELOCITY, CONST(rest));
            free(rest);
            shake(engine[e], 9);
            type->step(engine[e], NULL);
            double(*v)[3] = field(engine[e], SM_VELOCITY);
            for (int p = 0; p < 64; p++)
                for (int a = 0; a < 3; a++) energy[e] += v[p][a] * v[p][a];
            free(v);
        }
        assert_true(energy[2] < 0.5 * energy[0]);
        assert_true(energy[1] == energy[n % 3 == 0 ? 2 : 0]);
    }
    for (int e = 0; e < 3; e++) type->destroy(engine[e]);
}

TEST(handles_hold_what_they_name)
{
    const SmEngineParams params = {.w = 1, .h = 0.02, .gravity = {0, -5, 0}, .damping = 0.2};
    SmEngine *engine = create(4, 1, 1, &params);
    static const long pinned[] = {0, 5, 10, 15}, moving[] = {4, 19};
    SmHandle handle[2] = {{4, pinned, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
                          {2, moving, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
    const SmObstacle floor = {SM_PLANE, {0, 0.5, 0}, {0, 1, 0}, 0, 0}; /* moves no held one */
    const SmBoundary boundary = {2, handle, 1, &floor};
    double(*x0)[3] = field(engine, SM_REST);
    for (int n = 1; n <= 30; n++) {
        handle[1].pose[0][3] = 0.01 * n;
        type->bound(engine, &boundary);
        type->step(engine, NULL);
        double(*x)[3] = field(engine, SM_POSITION), (*v)[3] = field(engine, SM_VELOCITY);
        for (int a = 0; a < 3; a++) {
            for (int k = 0; k < 4; k++)
                assert_true(fabs(x[pinned[k]][a] - x0[pinned[k]][a]) < 1e-14);
            for (int k = 0; k < 2; k++) {
                double shift = a == 0 ? 0.01 * n : 0, speed = a == 0 ? 0.01 / params.h : 0;
                assert_true(fabs(x[moving[k]][a] - x0[moving[k]][a] - shift) < 1e-13);
                assert_true(fabs(v[moving[k]][a] - speed) < 1e-12);
            }
        }
        for (int k = 1; k < 4; k++) assert_true(x[k][1] > 0.5 - 1e-12); /* the free ones leave */
        free(x);
        free(v);
    }
    free(x0);
    type->destroy(engine);
}

TEST(a_dropped_body_comes_to_rest_on_the_ground)
{
    const SmEngineParams params = {.w = 2, .h = 0.02, .gravity = {0, -9.81, 0}, .damping = 0.1};
    SmEngine *engine = create(2, 2, 2, &params);
    const SmObstacle ground = {SM_PLANE, {0, -0.5, 0}, {0, 1, 0}, 0, 0.3};
    const SmBoundary boundary = {0, NULL, 1, &ground};
    type->bound(engine, &boundary);
    for (int n = 0; n < 300; n++) {
        type->step(engine, NULL);
        double(*x)[3] = field(engine, SM_POSITION);
        for (long p = 0; p < 27; p++) assert_true(x[p][1] >= -0.5);
        free(x);
    }
    double(*v)[3] = field(engine, SM_VELOCITY), (*x)[3] = field(engine, SM_POSITION);
    for (long p = 0; p < 27; p++)
        for (int a = 0; a < 3; a++) assert_true(fabs(v[p][a]) < 0.2);
    for (long p = 0; p < 3; p++) assert_true(fabs(x[p][1] + 0.5) < 1e-3);
    free(x);
    free(v);
    type->destroy(engine);
}

TEST(a_push_is_an_impulse)
{
    double m[27];
    for (int p = 0; p < 27; p++) m[p] = 4;
    const SmEngineParams params = {.w = 1, .h = 0.1, .mass = m, .instances = 2};
    SmEngine *engine = create(2, 2, 2, &params);
    const long particle[] = {5, 27 + 5};
    const double impulse[][3] = {{4, 0, 0}, {0, 8, -2}};
    type->push(engine, 2, particle, impulse);
    double(*v)[3] = field(engine, SM_VELOCITY);
    for (long p = 0; p < 54; p++)
        for (int a = 0; a < 3; a++)
            assert_true(v[p][a] == (p == 5 ? impulse[0][a] / 4 : p == 32 ? impulse[1][a] / 4 : 0));
    free(v);
    type->destroy(engine);
}

/* Two posed instances move as two engines would, one of them turned. */
TEST(instances_are_independent)
{
    const double pose[2][3][4] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                  {{0, -1, 0, 10}, {1, 0, 0, 0}, {0, 0, 1, -3}}};
    const SmEngineParams one = {.w = 1, .h = 0.05, .damping = 0.1};
    SmEngineParams two = one;
    two.instances = 2;
    two.instance_pose = pose;
    SmEngine *pair = create(3, 2, 1, &two), *single = create(3, 2, 1, &one);
    const long pushed[] = {0, 24};
    const double impulse[2][3] = {{3, 1, -2}, {-1, 3, -2}}; /* the second is the first, turned */
    type->push(pair, 2, pushed, impulse);
    type->push(single, 1, pushed, impulse);
    for (int n = 0; n < 10; n++) {
        type->step(pair, NULL);
        type->step(single, NULL);
    }
    double(*both)[3] = field(pair, SM_POSITION), (*alone)[3] = field(single, SM_POSITION);
    assert_memory_equal(both, alone, 24 * sizeof *alone);
    for (int p = 0; p < 24; p++) {
        assert_true(fabs(both[24 + p][0] - (10 - alone[p][1])) < 1e-12);
        assert_true(fabs(both[24 + p][1] - alone[p][0]) < 1e-12);
        assert_true(fabs(both[24 + p][2] - (alone[p][2] - 3)) < 1e-12);
    }
    long member[24];
    assert_int_equal(type->region(pair, 24, member, 2), 8);
    assert_int_equal(member[1], 25);
    free(both);
    free(alone);
    type->destroy(pair);
    type->destroy(single);
}

/* A bar of 4 cells pulled apart across its third: the engine's regions are those of a body built
 * without the links that are too long now. The other instance stays whole. */
TEST(stretched_links_break)
{
    const SmEngineParams params = {.w = 1, .h = 0.01, .strain_limit = 1.5, .instances = 2};
    SmEngine *engine = create(4, 1, 1, &params);
    SmCounts before, after;
    type->count(engine, &before);
    assert_int_equal(before.broken, 0);
    assert_int_equal(before.links, 5 * 6 + 4 * 16);
    double(*x)[3] = field(engine, SM_POSITION);
    for (long p = 0; p < 20; p++)
        if (p % 5 > 2) x[p][0] += 3 + 0.3 * (double)(p / 5); /* some links break, some hold */
    type->set(engine, SM_POSITION, CONST(x));
    double(*rest)[3] = field(engine, SM_REST);
    type->step(engine, NULL);
    type->get(engine, SM_POSITION, x);
    int broken[94][2], count = 0;
    for (int p = 0; p < 20; p++)
        for (int q = p + 1; q < 20; q++) {
            double d = 0, d0 = 0;
            for (int a = 0; a < 3; a++) {
                d += (x[p][a] - x[q][a]) * (x[p][a] - x[q][a]);
                d0 += (rest[p][a] - rest[q][a]) * (rest[p][a] - rest[q][a]);
            }
            if (abs(p % 5 - q % 5) > 1 || !(sqrt(d) > 1.5 * sqrt(d0))) continue;
            broken[count][0] = p;
            broken[count++][1] = q;
        }
    type->count(engine, &after);
    assert_true(count > 0 && count < 94);
    assert_int_equal(after.broken, count);
    assert_int_equal(after.links, before.links - count);

    SmVoxels voxels;
    sm_voxels_block(&voxels, 4, 1, 1, 1.0);
    RefRegions expected, whole;
    ref_regions_build(&voxels, 1, (const int(*)[2])broken, count, &expected);
    ref_regions_build(&voxels, 1, NULL, 0, &whole);
    assert_int_equal(after.regions, ref_regions_unique(&expected));
    for (long p = 0; p < 40; p++) {
        const RefRegions *regions = p < 20 ? &expected : &whole;
        long member[20], size = type->region(engine, p, member, 20), r = p % 20;
        assert_int_equal(size, regions->start[r + 1] - regions->start[r]);
        for (long n = 0; n < size; n++)
            assert_int_equal(member[n] - p / 20 * 20, regions->member[regions->start[r] + n]);
    }
    for (int n = 0; n < 5; n++) type->step(engine, NULL);
    ref_regions_free(&expected);
    ref_regions_free(&whole);
    sm_voxels_free(&voxels);
    free(rest);
    free(x);
    type->destroy(engine);
}

/* Pairs that are there twice, in either order, or that are no links, or no more, count once. */
TEST(links_are_broken_once)
{
    SmEngineParams params = {.w = 1, .h = 0.01, .strain_limit = INFINITY, .instances = 2};
    const int pair[4][2] = {{0, 1}, {1, 0}, {0, 1}, {0, 4}};
    SmError error;
    SmCounts counts;
    SmEngine *engine = create(4, 1, 1, &params);
    for (int n = 0; n < 2; n++) {
        assert_int_equal(type->break_links(engine, 4, pair, &error), SM_OK);
        type->count(engine, &counts);
        assert_int_equal(counts.broken, 2); /* one of each instance */
        assert_int_equal(counts.links, 5 * 6 + 4 * 16 - 1);
    }
    type->destroy(engine);
    params.strain_limit = 0;
    engine = create(4, 1, 1, &params);
    assert_int_equal(type->break_links(engine, 1, pair, &error), SM_USAGE);
    type->destroy(engine);
}

TEST(goals_change_nothing_else)
{
    const SmEngineParams params = {.w = 2, .h = 0.1, .damping = 0.2};
    SmEngine *engine = create(3, 3, 2, &params);
    shake(engine, 21);
    double(*x)[3] = field(engine, SM_POSITION), (*v)[3] = field(engine, SM_VELOCITY);
    type->goals(engine);
    double(*x_after)[3] = field(engine, SM_POSITION), (*v_after)[3] = field(engine, SM_VELOCITY);
    double(*g)[3] = field(engine, SM_GOAL), (*x0)[3] = field(engine, SM_REST), expected[48][3];
    assert_memory_equal(x, x_after, 48 * sizeof *x);
    assert_memory_equal(v, v_after, 48 * sizeof *v);
    SmVoxels voxels;
    sm_voxels_block(&voxels, 3, 3, 2, 1.0);
    RefRegions regions;
    double m[48];
    for (int p = 0; p < 48; p++) m[p] = 1;
    ref_regions_build(&voxels, 2, NULL, 0, &regions);
    ref_goals(&regions, CONST(x0), m, CONST(x), expected);
    assert_memory_equal(g, expected, sizeof expected);
    ref_regions_free(&regions);
    sm_voxels_free(&voxels);
    free(x), free(v), free(x_after), free(v_after), free(g), free(x0);
    type->destroy(engine);
}

TEST(any_thread_count_gives_the_same_bits)
{
    double(*x[3])[3];
    for (int t = 0; t < 3; t++) {
        const SmEngineParams params = {.w = 2, .h = 0.1, .damping = 0.2, .threads = t + 1};
        SmEngine *engine = create(9, 8, 7, &params); /* 720: above REF_SERIAL */
        shake(engine, 33);
        for (int n = 0; n < 5; n++) type->step(engine, NULL);
        x[t] = field(engine, SM_POSITION);
        type->destroy(engine);
    }
    for (int t = 1; t < 3; t++) assert_memory_equal(x[0], x[t], 720 * sizeof *x[0]);
    for (int t = 0; t < 3; t++) free(x[t]);
}

TEST(laps_have_no_gaps)
{
    const SmEngineParams params = {.w = 2, .h = 0.1, .damping = 0.2};
    SmEngine *engine = create(8, 8, 8, &params);
    SmLaps laps;
    sm_laps_start(&laps);
    double start = laps.last, sum = 0;
    type->step(engine, &laps);
    for (int s = 0; s < SM_STAGES; s++) {
        assert_true(laps.seconds[s] >= 0); /* none runs backwards; they may be short */
        sum += laps.seconds[s];
    }
    assert_true(fabs(sum - (laps.last - start)) < 1e-9);
    type->destroy(engine);
}

TEST(bad_parameters_are_refused)
{
    double negative[8] = {1, 1, 1, -1, 1, 1, 1, 1};
    const SmEngineParams good = {.w = 1, .h = 0.1};
    SmEngineParams bad[9] = {good, good, good, good, good, good, good, good, good};
    bad[0].w = 0;
    bad[1].h = 0;
    bad[2].h = NAN;
    bad[3].damping = 1.5;
    bad[4].damping = -0.1;
    bad[5].strain_limit = NAN;
    bad[6].mass = negative;
    bad[7].h = INFINITY;
    bad[8].gravity[1] = NAN;
    SmVoxels voxels, empty;
    sm_voxels_block(&voxels, 1, 1, 1, 1.0);
    sm_voxels_init(&empty, 2, 2, 2, 1.0);
    sm_voxels_count(&empty);
    for (int n = 0; n < 10; n++) {
        SmError error = {0};
        SmEngine *engine = NULL;
        SmCode code = n < 9 ? type->create(&voxels, bad + n, &engine, &error)
                            : type->create(&empty, &good, &engine, &error);
        assert_int_equal(code, SM_INPUT);
        assert_true(strlen(error.text) > 20);
        assert_null(engine);
    }
    sm_voxels_free(&voxels);
    sm_voxels_free(&empty);
}
