/* Octree engines that are resampled behind the common interface, in both precisions: numbers of
 * particles, handles, cuts; what cannot be resampled. */
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../engine.h"
#include "test_batches.h"

static const SmEngineType *const engines[2] = {&octree_engine_f32, &octree_engine_f64};
static const double limit[2] = {5e-5, 1e-10};

/* A bar of 6 x 12 x 6 cells of edge 0.5 in base cells of 4, all of them leaves. */
static SmEngine *make_bar(int precision, double creep)
{
    SmVoxels voxels;
    sm_voxels_block(&voxels, 6, 12, 6, 0.5);
    OctOptions options = {.epsilon = 0.5,
                          .sampling = {.levels = 2, .criteria_count = 1},
                          .creep = creep,
                          .yield = 0.05};
    options.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM, .level = 1};
    SmEngineParams params = {.h = 0.01, .damping = 0.1, .threads = 1, .octree = &options};
    SmEngine *engine;
    SmError error;
    if (engines[precision]->create(&voxels, &params, &engine, &error)) fail_msg("%s", error.text);
    sm_voxels_free(&voxels);
    return engine;
}

static long particles(const SmEngineType *type, SmEngine *engine)
{
    SmCounts counts;
    type->count(engine, &counts);
    return counts.particles;
}

static void change(SmEngine *engine, unsigned *seed)
{
    OctStructure *s;
    assert_int_equal(oct_engine_begin(engine, &s, NULL), SM_OK);
    split_some(seed, s, 5);
    merge_some(seed, s, 5);
    oct_engine_end(engine);
}

/* Positions, velocities and masses come by the leaves that live; what is set is read back. */
static void check_fields(const SmEngineType *type, SmEngine *engine, double tolerance)
{
    const OctStructure *s = oct_engine_structure(engine);
    long n = particles(type, engine);
    const int *leaf = oct_engine_leaves(engine);
    double(*rest)[3] = triples(n), (*x)[3] = triples(n), (*v)[3] = triples(n), (*b)[3] = triples(n);
    double *mass = sm_alloc((size_t)n, sizeof *mass), all = 0, centre[3];
    unsigned seed = 9;
    assert_int_equal(n, s->tree.live);
    type->get(engine, SM_REST, rest);
    type->masses(engine, mass);
    for (long p = 0; p < n; p++) {
        assert_true(s->tree.node[leaf[p]] >= 0 && (p == 0 || leaf[p] > leaf[p - 1]));
        oct_structure_centre(s, leaf[p], centre);
        all += mass[p];
        for (int d = 0; d < 3; d++) {
            assert_true(fabs(rest[p][d] - centre[d]) < 1e-12);
            x[p][d] = rest[p][d] + 0.01 * (random_unit(&seed) - 0.5);
            v[p][d] = random_unit(&seed);
        }
    }
    assert_true(fabs(all - 6 * 12 * 6) < 1e-9);
    type->set(engine, SM_POSITION, (const double(*)[3])x);
    type->set(engine, SM_VELOCITY, (const double(*)[3])v);
    const long pushed = n / 2;
    type->push(engine, 1, &pushed, (const double[1][3]){{0.25 * mass[pushed], 0, 0}});
    v[pushed][0] += 0.25;
    type->get(engine, SM_POSITION, b);
    assert_true(field_difference(n, (const double(*)[3])x, (const double(*)[3])b) < tolerance);
    type->get(engine, SM_VELOCITY, b);
    assert_true(field_difference(n, (const double(*)[3])v, (const double(*)[3])b) < tolerance);
    memset(v, 0, (size_t)n * sizeof *v);
    type->set(engine, SM_POSITION, (const double(*)[3])rest);
    type->set(engine, SM_VELOCITY, (const double(*)[3])v);
    free(mass);
    free(rest);
    free(x);
    free(v);
    free(b);
}

/* Regions name particles, and hold each other both ways. */
static void check_regions(const SmEngineType *type, SmEngine *engine)
{
    long n = particles(type, engine), *member = sm_alloc((size_t)n, sizeof *member);
    char *in = sm_alloc((size_t)(n * n), 1);
    for (long p = 0; p < n; p++) {
        long count = type->region(engine, p, member, n);
        assert_in_range(count, 1, n);
        for (long k = 0; k < count; k++) {
            assert_true(member[k] >= 0 && member[k] < n && (k == 0 || member[k] > member[k - 1]));
            in[p * n + member[k]] = 1;
        }
        assert_true(in[p * n + p]);
    }
    for (long p = 0; p < n; p++)
        for (long q = 0; q < p; q++) assert_int_equal(in[p * n + q], in[q * n + p]);
    free(member);
    free(in);
}

TEST(particles_are_the_leaves)
{
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngine *engine = make_bar(precision, 0);
        unsigned seed = 1;
        check_fields(type, engine, limit[precision]);
        for (int batch = 0; batch < 10; batch++) {
            change(engine, &seed);
            check_fields(type, engine, limit[precision]);
            check_regions(type, engine);
        }
        type->destroy(engine);
    }
}

/* Rest shapes of plastic bodies follow, and can be set. */
TEST(shapes_follow)
{
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngine *engine = make_bar(precision, 10);
        const double shape[9] = {1.25, 0, 0, 0, 0.8, 0, 0, 0, 1};
        unsigned seed = 2;
        long n = particles(type, engine);
        double(*S)[9] = sm_alloc((size_t)n, sizeof *S);
        for (long p = 0; p < n; p++) memcpy(S[p], shape, sizeof shape);
        assert_true(type->set_shapes(engine, (const double(*)[9])S));
        for (int batch = 0; batch < 5; batch++) {
            change(engine, &seed);
            n = particles(type, engine);
            S = sm_realloc(S, (size_t)n, sizeof *S);
            assert_true(type->get_shapes(engine, S));
            for (long p = 0; p < n; p++)
                for (int i = 0; i < 9; i++) assert_true(fabs(S[p][i] - shape[i]) < 1e-6);
            assert_true(type->set_shapes(engine, (const double(*)[9])S));
        }
        free(S);
        type->destroy(engine);
    }
}

/* Holds the particles whose rest position is below y = 1, a cell's edge, `up` above it. */
static void hold_bottom(const SmEngineType *type, SmEngine *engine, double up)
{
    long n = particles(type, engine), count = 0;
    double(*rest)[3] = triples(n);
    long *held = sm_alloc((size_t)n, sizeof *held);
    type->get(engine, SM_REST, rest);
    for (long p = 0; p < n; p++)
        if (rest[p][1] < 1) held[count++] = p;
    SmHandle handle = {
        .count = count, .particle = held, .pose = {{1, 0, 0, 0}, {0, 1, 0, up}, {0, 0, 1, 0}}};
    type->bound(engine, &(SmBoundary){.handle_count = 1, .handle = &handle});
    free(held);
    free(rest);
}

/* All particles below are where the handle takes them. */
static void check_held(const SmEngineType *type, SmEngine *engine, double up, double tolerance)
{
    long n = particles(type, engine), count = 0;
    double(*rest)[3] = triples(n), (*x)[3] = triples(n);
    type->get(engine, SM_REST, rest);
    type->get(engine, SM_POSITION, x);
    for (long p = 0; p < n; p++) {
        if (rest[p][1] > 1) continue;
        count++;
        for (int d = 0; d < 3; d++)
            if (!(fabs(x[p][d] - rest[p][d] - (d == 1 ? up : 0)) < tolerance))
                fail_msg("particle %ld is at %g %g %g", p, x[p][0], x[p][1], x[p][2]);
    }
    assert_true(count > 0);
    free(rest);
    free(x);
}

TEST(new_nodes_of_held_ones_are_held)
{
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngine *engine = make_bar(precision, 0);
        unsigned seed = 3;
        hold_bottom(type, engine, 0.2);
        for (int batch = 0; batch < 20; batch++) {
            OctStructure *s;
            assert_int_equal(oct_engine_begin(engine, &s, NULL), SM_OK);
            split_some(&seed, s, 4);
            for (int n = 0; n < 4; n++) { /* but not across the end of what is held */
                int node = mergeable(&seed, &s->tree);
                if (node >= 0 && s->tree.size[node] == 4 && s->tree.children[node])
                    assert_int_equal(oct_resample_merge(s, node, NULL), SM_OK);
            }
            oct_engine_end(engine);
            type->step(engine, NULL);
            check_held(type, engine, 0.2, limit[precision]);
            if (batch == 10) hold_bottom(type, engine, 0.2); /* by the new numbers */
        }
        type->destroy(engine);
    }
}

/* A plane through the bar: what is pushed on one side moves, the other stays. */
TEST(a_cut_separates)
{
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngine *engine = make_bar(precision, 0);
        OctStructure *s;
        assert_int_equal(oct_structure_parts(oct_engine_structure(engine)), 1);
        assert_int_equal(oct_engine_begin(engine, &s, NULL), SM_OK);
        int corner[4];
        for (int n = 0; n < 4; n++)
            corner[n] = (int)sm_cut_vertex(&s->cut,
                                           (const double[3]){n & 1 ? 9 : -9, 3.02, n & 2 ? 9 : -9});
        sm_cut_triangle(&s->cut, (const int[3]){corner[0], corner[1], corner[2]});
        sm_cut_triangle(&s->cut, (const int[3]){corner[1], corner[2], corner[3]});
        const OctChange *done = oct_engine_end(engine);
        assert_int_equal(done->added_count + done->removed_count, 0);
        assert_int_equal(oct_structure_parts(oct_engine_structure(engine)), 2);
        long n = particles(type, engine);
        double(*rest)[3] = triples(n), (*v)[3] = triples(n), (*x)[3] = triples(n);
        type->get(engine, SM_REST, rest);
        for (long p = 0; p < n; p++) v[p][1] = rest[p][1] > 3.02 ? 1 : 0;
        type->set(engine, SM_VELOCITY, (const double(*)[3])v);
        for (int step = 0; step < 100; step++) type->step(engine, NULL);
        type->get(engine, SM_POSITION, x);
        for (long p = 0; p < n; p++)
            if (!(fabs(x[p][1] - rest[p][1] - (rest[p][1] > 3.02)) < 100 * limit[precision]))
                fail_msg("at rest in %g, now in %g", rest[p][1], x[p][1]);
        free(rest);
        free(v);
        free(x);
        type->destroy(engine);
    }
}

TEST(refuses_what_cannot_change)
{
    SmVoxels voxels;
    sm_voxels_block(&voxels, 6, 6, 6, 0.5);
    for (int trial = 0; trial < 4; trial++) {
        const SmEngineType *type = engines[trial % 2];
        OctOptions options = {.form = trial / 2 ? OCT_ADJOINT : OCT_HIERARCHICAL};
        SmEngineParams params = {
            .h = 0.01, .threads = 1, .octree = &options, .instances = trial / 2 ? 1 : 3};
        SmEngine *engine;
        OctStructure *s;
        SmError error;
        assert_int_equal(type->create(&voxels, &params, &engine, NULL), SM_OK);
        assert_int_equal(oct_engine_begin(engine, &s, &error), SM_USAGE);
        assert_non_null(strstr(error.text, trial / 2 ? "adjoint" : "3 bodies"));
        type->step(engine, NULL);
        type->destroy(engine);
    }
    sm_voxels_free(&voxels);
}
