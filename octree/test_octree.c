/* Holds the octree engine to its twins and to the invariants of shape matching, in both precisions
 * (SM_REAL_BITS). */
#include "../fastlsm/fastlsm.h"
#include "plastic.h"
#include "test_octree_body.h"

#include <limits.h>

#define SINGLE (SM_REAL_BITS == 32)

/* Largest deviation of goal positions, in finest cells. */
static const double tolerance = SINGLE ? 5e-5 : 1e-10;

static void check_goals(Body *body, OctParams params, int trial)
{
    Oct *oct = create(body, params);
    RefTreeBody twin;
    adopt(oct, body);
    ref_tree_init(&body->tree, &body->regions, body->m, params.weighting == OCT_PLAIN, &twin);
    oct_goals(oct);
    get(oct, 0, oct->body->g, true, body->a);
    ref_tree_goals(&twin, (const double(*)[3])body->x, false, body->b);
    double worst =
        field_difference(body->n, (const double(*)[3])body->a, (const double(*)[3])body->b);
    if (!(worst <= tolerance))
        fail_msg("trial %d, weighting %d, form %d, %ld nodes: goals differ by %g cells", trial,
                 (int)params.weighting, (int)params.form, body->n, worst);
    ref_tree_free(&twin);
    oct_free(oct);
}

TEST(test_goals)
{
    unsigned seed = 1;
    for (int trial = 0; trial < 240; trial++) {
        Body body;
        body_random(&seed, trial % 6, 14, false, &body);
        check_goals(&body,
                    (OctParams){.weighting = (OctWeighting)(trial / 6 % 2),
                                .form = (OctGoalForm)(trial / 12 % 2),
                                .threads = 1},
                    trial);
        body_free(&body);
    }
}

/* The adjoint sums over the regions that contain a node even where these are not its own. */
TEST(test_asymmetric)
{
    unsigned seed = 2;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        body_random(&seed, trial % 6, 8, true, &body);
        check_goals(&body, (OctParams){.form = OCT_ADJOINT, .threads = 1}, trial);
        body_free(&body);
    }
}

/* How often list t, with its prefixes' lists, holds each leaf. */
static void count_leaves(const OctTree *tree, const OctSumLists *lists, long t, int *count)
{
    for (long at = lists->rows.first[t]; at < lists->rows.end[t]; at++) {
        long row = lists->rows.item[at], node = row - lists->base;
        if (node < 0 && row >= OCT_PREFIX_ROW)
            count_leaves(tree, lists, row - OCT_PREFIX_ROW, count);
        if (node < 0) continue;
        for (long leaf = 0; leaf < tree->leaves; leaf++) {
            int n = tree->node[leaf];
            while (n > node) n = tree->parent[n];
            count[leaf] += n == node;
        }
    }
}

/* Every list against the explicit leaves of its region, and transposed against the regions that
 * contain a leaf. */
TEST(test_lists)
{
    unsigned seed = 3;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        RefTreeBody twin;
        OctSumLists lists, transposed;
        body_random(&seed, trial % 6, 6, trial % 2, &body);
        ref_tree_init(&body.tree, &body.regions, body.m, false, &twin);
        oct_sum_lists_build(&body.tree, &body.regions, &lists);
        oct_sum_lists_transpose(&body.tree, &lists, &transposed);
        size_t n = (size_t)body.n;
        int *in = sm_alloc(n * n, sizeof(int)), *got = sm_alloc(2 * n, sizeof(int));
        for (size_t r = 0; r < n; r++)
            for (long k = twin.regions.start[r]; k < twin.regions.start[r + 1]; k++)
                in[r * n + (size_t)twin.regions.member[k]]++;
        for (size_t r = 0; r < n; r++) {
            memset(got, 0, 2 * n * sizeof(int));
            count_leaves(&body.tree, &lists, lists.prefixes + (long)r, got);
            count_leaves(&body.tree, &transposed, transposed.prefixes + (long)r, got + n);
            for (size_t i = 0; i < n; i++) {
                assert_int_equal(got[i], in[r * n + i]);
                assert_int_equal(got[n + i], in[i * n + r]);
            }
        }
        assert_true(lists.entries <= body.regions.members.live);
        free(in);
        free(got);
        oct_sum_lists_free(&lists);
        oct_sum_lists_free(&transposed);
        ref_tree_free(&twin);
        body_free(&body);
    }
}

/* What no region holds together is found again to the same digits however far it drifts. */
TEST(test_drifted)
{
    unsigned seed = 12;
    long apart = 0;
    for (int trial = 0; trial < 48; trial++) {
        Body body;
        body_random(&seed, trial % 6, 10, false, &body);
        int *group = sm_alloc((size_t)body.n, sizeof *group);
        long groups = oct_frames_groups(&body.tree, &body.regions, group);
        for (long i = 0; i < body.n; i++) body.x[i][trial % 3] += 1e5 / (double)groups * group[i];
        apart += groups > 1;
        check_goals(&body, (OctParams){.form = (OctGoalForm)(trial % 2), .threads = 1}, trial);
        free(group);
        body_free(&body);
    }
    assert_true(apart > 8);
}

/* One step of the twin: eqs. 1, 14 and 2 of fastlsm in cells and steps. */
static void twin_step(RefTreeBody *twin, const OctParams *params, bool damp, Body *body)
{
    ref_tree_goals(twin, (const double(*)[3])body->x, true, body->a);
    for (long i = 0; i < body->n; i++)
        for (int d = 0; d < 3; d++)
            body->v[i][d] += body->a[i][d] - body->x[i][d] + params->gravity[d];
    if (damp)
        ref_tree_rigid_velocity(twin, (const double(*)[3])body->x, (const double(*)[3])body->v,
                                NULL, body->a);
    for (long i = 0; i < body->n; i++)
        for (int d = 0; d < 3; d++) {
            if (damp) body->v[i][d] += params->damping * (body->a[i][d] - body->v[i][d]);
            body->x[i][d] += body->v[i][d];
        }
}

/* Three steps, plastic or not, against those of the twin. Returns the ghosts. */
static long check_steps(Body *body, int trial, double damping)
{
    OctParams params = {.weighting = (OctWeighting)(trial / 6 % 2),
                        .form = (OctGoalForm)(trial / 12 % 2),
                        .damping = damping,
                        .damping_every = 1 + trial % 2,
                        .gravity = {0, -0.01, 0.002},
                        .threads = 1};
    if (trial % 48 >= 24) {
        params.creep = 0.05;
        params.yield = 0.1;
        params.most = 0.4;
    }
    Oct *oct = create(body, params);
    RefTreeBody twin;
    adopt(oct, body);
    long ghosts = oct->ghosts;
    ref_tree_init(&body->tree, &body->regions, body->m, params.weighting == OCT_PLAIN, &twin);
    twin.creep = params.creep;
    twin.yield = params.yield;
    twin.most = params.most;
    for (int step = 0; step < 3; step++) {
        oct_step(oct, NULL);
        if (step == 1) oct_recentre(oct);
        if (step == 1 && trial % 5 == 4) oct_ghosts_merge(oct);
        twin_step(&twin, &params, step % params.damping_every == 0, body);
    }
    get_x(oct, body->b);
    double worst =
        field_difference(body->n, (const double(*)[3])body->b, (const double(*)[3])body->x);
    if (!(worst <= (SINGLE ? 1e-3 : 1e-8)))
        fail_msg("trial %d, %ld nodes: positions differ by %g cells", trial, body->n, worst);
    ref_tree_free(&twin);
    oct_free(oct);
    return ghosts;
}

TEST(test_steps)
{
    unsigned seed = 4;
    for (int trial = 0; trial < 48; trial++) {
        Body body;
        body_random(&seed, trial % 6, 9, false, &body);
        check_steps(&body, trial, 0.3);
        body_free(&body);
    }
}

/* A thread of cells, so long that it has many frames. */
static void thread_body(unsigned *seed, int length, Body *body)
{
    enum { HIGH = 40 };
    int at[2] = {HIGH / 2, HIGH / 2};
    const int corner[3] = {-random_int(seed, 16), -random_int(seed, 16), -random_int(seed, 16)};
    sm_voxels_init(&body->voxels, length, HIGH, HIGH, 1);
    for (int i = 0; i < length; i++) {
        int d = random_int(seed, 2), to = at[d] + random_int(seed, 3) - 1;
        if (to >= 0 && to < HIGH - 1) at[d] = to;
        for (int more = 0; more < 2; more++)
            sm_voxel_set(&body->voxels, i, at[0] + more * random_int(seed, 2), at[1] + more);
    }
    sm_voxels_count(&body->voxels);
    random_split_tree(seed, &body->voxels, 2 + random_int(seed, 3), corner, 0.7, &body->tree);
    interval_regions(seed, body, &body->regions);
    body_arrays(seed, body);
}

/* In single precision coordinates of a thousand cells have not the digits that goals must have. */
TEST(test_wide)
{
    unsigned seed = 13;
    long ghosts = 0;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        thread_body(&seed, 1000, &body);
        check_goals(&body,
                    (OctParams){.weighting = (OctWeighting)(trial % 2),
                                .form = (OctGoalForm)(trial / 2 % 2),
                                .threads = 1 + trial % 3},
                    trial);
        ghosts += check_steps(&body, trial, SINGLE ? 0 : 0.3); /* it resolves no thread's inertia */
        body_free(&body);
    }
    assert_true(ghosts > 1000);
}

TEST(test_momentum)
{
    unsigned seed = 5;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        body_random(&seed, trial % 6, 10, false, &body);
        OctParams params = {.damping = trial % 2 ? 0.3 : 0, .threads = 1};
        Oct *oct = create(&body, params);
        double p[2][3], l[2][3], mass = 0, reach = 1;
        for (int when = 0; when < 2; when++) {
            for (int step = 0; when == 1 && step < 10; step++) oct_step(oct, NULL);
            /* about the middle, as far as single precision can hold places */
            get(oct, 0, oct->body->x, false, body.a);
            get(oct, 0, oct->body->v, false, body.b);
            field_momenta(body.n, body.m, (const double(*)[3])body.a, (const double(*)[3])body.b,
                          p[when], l[when]);
        }
        for (long i = 0; i < body.n; i++) {
            mass += body.m[i];
            for (int d = 0; d < 3; d++) reach = fmax(reach, fabs(body.a[i][d]));
        }
        for (int d = 0; d < 3; d++) { /* of one cell per step */
            double limit = SINGLE ? 1e-6 : 1e-12;
            double dp = fabs(p[1][d] - p[0][d]) / mass / 10,
                   dl = fabs(l[1][d] - l[0][d]) / (mass * reach) / 10;
            if (!(dp < limit && dl < limit))
                fail_msg("trial %d: linear %g, angular %g", trial, dp, dl);
        }
        oct_free(oct);
        body_free(&body);
    }
}

/* A rigidly moving body is left alone, and so is a resting one. */
TEST(test_rigid)
{
    unsigned seed = 6;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        body_random(&seed, trial % 6, 10, false, &body);
        double c = cos(0.7), s = sin(0.7), turn = trial < 12 ? 0 : 0.0005;
        for (long i = 0; i < body.n; i++) {
            const int *centre = body.tree.centre[body.tree.node[i]];
            double x0 = 0.5 * centre[0], y0 = 0.5 * centre[1];
            body.x[i][0] = c * x0 - s * y0 + 3;
            body.x[i][1] = s * x0 + c * y0;
            body.x[i][2] = 0.5 * centre[2] - 7;
            body.v[i][0] = -turn * body.x[i][1];
            body.v[i][1] = turn * (body.x[i][0] - 3);
            body.v[i][2] = trial < 12 ? 0 : 0.003;
        }
        OctParams params = {.damping = 0.5,
                            .weighting = (OctWeighting)(trial % 2),
                            .creep = trial % 4 == 3 ? 0.1 : 0,
                            .yield = 0.05,
                            .most = 1,
                            .threads = 1};
        Oct *oct = create(&body, params);
        adopt(oct, &body);
        oct_step(oct, NULL);
        get(oct, 0, oct->body->v, false, body.a);
        double worst =
            field_difference(body.n, (const double(*)[3])body.a, (const double(*)[3])body.v);
        if (!(worst < (SINGLE ? 5e-5 : 1e-10))) fail_msg("trial %d: %g", trial, worst);
        oct_free(oct);
        body_free(&body);
    }
}

/* A full block of `side` finest cells, of two levels; a share of the cells split. */
static void block_body(unsigned *seed, int side, double split, Body *body)
{
    sm_voxels_block(&body->voxels, side, side, side, 1);
    random_split_tree(seed, &body->voxels, 2, (int[3]){0}, split, &body->tree);
    max_norm_regions(&body->tree, 9, 0.5, &body->regions);
    body_arrays(seed, body);
}

/* Crushed flat, inverted, blown up, or all in one point: it comes back to rest, never a NaN. */
TEST(test_recovery)
{
    const double crush[5][3] = {{1, 1, 0}, {-1, 1, 1}, {1000, 1000, 1000}, {0, 0, 0}, {1, 0, 0}};
    for (int trial = 0; trial < 15; trial++) {
        Body body;
        unsigned seed = 7;
        block_body(&seed, 8, 0.6, &body);
        for (long i = 0; i < body.n; i++)
            for (int d = 0; d < 3; d++) {
                double x0 = 0.5 * body.tree.centre[body.tree.node[i]][d];
                body.v[i][d] = 0;
                body.x[i][d] = x0 * crush[trial / 3][d] + 1e-3 * (random_unit(&seed) - 0.5);
            }
        OctParams params = {.damping = 0.2, .weighting = (OctWeighting)(trial % 3 == 1)};
        if (trial % 3 == 2) params.creep = 0.01, params.yield = 0.5, params.most = 0.5;
        Oct *oct = create(&body, params);
        for (int step = 0; step < 3000; step++) {
            oct_step(oct, NULL);
            if (step % 16 == 0) oct_recentre(oct);
        }
        oct_goals(oct); /* at rest goals and positions agree */
        get(oct, 0, oct->body->g, true, body.a);
        get_x(oct, body.b);
        double worst =
            field_difference(body.n, (const double(*)[3])body.a, (const double(*)[3])body.b);
        /* rounding at 1000 times the size leaves a spin that damping keeps: goals lag behind it */
        if (!(worst < 5e-3)) fail_msg("trial %d: still %g cells from rest", trial, worst);
        oct_free(oct);
        body_free(&body);
    }
}

TEST(test_threads)
{
    for (int trial = 0; trial < 4; trial++) {
        Body body;
        unsigned seed = 8;
        block_body(&seed, 24, 0.9, &body);
        for (int threads = 1; threads <= 5; threads += 2) {
            OctParams params = {.damping = 0.3,
                                .form = (OctGoalForm)(trial % 2),
                                .creep = trial > 1 ? 0.1 : 0,
                                .yield = 0.05,
                                .most = 0.5,
                                .threads = threads};
            Oct *oct = create(&body, params);
            assert_int_equal(oct->threads, threads);
            for (int step = 0; step < 4; step++) oct_step(oct, NULL);
            get_x(oct, threads == 1 ? body.a : body.b);
            if (threads > 1)
                assert_memory_equal(body.a, body.b, (size_t)body.n * sizeof(double[3]));
            oct_free(oct);
        }
        body_free(&body);
    }
}

/* Each of several bodies moves as it would alone. What is added to v is exact, fused with the sum
 * or not. */
TEST(test_instances)
{
    Body body;
    unsigned seed = 9;
    block_body(&seed, 8, 0.6, &body);
    OctParams params = {.damping = 0.1, .threads = 3, .instances = 5}, alone = {.damping = 0.1};
    Oct *all = create(&body, params);
    for (long k = 0; k < 5; k++) {
        real *v = all->body[k].v;
        for (long i = 0; i < body.n; i++) v[oct_index(i, 0)] += (real)(0x1p-7 * (double)k);
    }
    for (int step = 0; step < 20; step++) oct_step(all, NULL);
    for (long k = 0; k < 5; k++) {
        Oct *one = create(&body, alone);
        for (long i = 0; i < body.n; i++)
            one->body->v[oct_index(i, 0)] += (real)(0x1p-7 * (double)k);
        for (int step = 0; step < 20; step++) oct_step(one, NULL);
        get(all, k, all->body[k].x, true, body.a);
        get_x(one, body.b);
        assert_memory_equal(body.a, body.b, (size_t)body.n * sizeof(double[3]));
        oct_free(one);
    }
    oct_free(all);
    body_free(&body);
}

/* How much lower the block is than at rest, relative to its height, after having been held at half
 * of it and left alone. */
static double dent(double creep, double yield, double *volume)
{
    Body body;
    unsigned seed = 10;
    block_body(&seed, 8, 1, &body);
    for (long i = 0; i < body.n; i++)
        for (int d = 0; d < 3; d++) {
            double x0 = 0.5 * body.tree.centre[body.tree.node[i]][d];
            body.x[i][d] = d == 1 ? 0.5 * x0 : x0;
            body.v[i][d] = 0;
        }
    OctParams params = {.damping = 0.2, .creep = creep, .yield = yield, .most = 1};
    Oct *oct = create(&body, params);
    for (int step = 0; step < 600; step++) {
        oct_step(oct, NULL);
        if (step >= 20) continue;
        oct_set_positions(oct, 0, (const double(*)[3])body.x);
        memset(oct->body->v, 0, (size_t)oct->blocks * 3 * SM_LANES * sizeof(real));
    }
    get_x(oct, body.a);
    double low = INFINITY, high = -INFINITY;
    int rest_low = INT_MAX, rest_high = INT_MIN;
    for (long i = 0; i < body.n; i++) {
        int y0 = body.tree.centre[body.tree.node[i]][1];
        low = fmin(low, body.a[i][1]);
        high = fmax(high, body.a[i][1]);
        rest_low = y0 < rest_low ? y0 : rest_low;
        rest_high = y0 > rest_high ? y0 : rest_high;
    }
    *volume = 0; /* largest |det S - 1| */
    for (long i = 0; i < body.n && creep > 0; i++) {
        double S[9];
        for (int e = 0; e < 9; e++)
            S[e] = (double)oct->body->plastic[(i / SM_LANES * 9 + e) * SM_LANES + i % SM_LANES];
        double det = S[0] * (S[4] * S[8] - S[5] * S[7]) - S[1] * (S[3] * S[8] - S[5] * S[6]) +
                     S[2] * (S[3] * S[7] - S[4] * S[6]);
        *volume = at_worst(*volume, fabs(det - 1));
    }
    oct_free(oct);
    body_free(&body);
    return 1 - (high - low) / (0.5 * (rest_high - rest_low));
}

TEST(test_plastic)
{
    double volume, elastic = dent(0, 0.1, &volume), little = dent(0.1, 0.55, &volume),
                   plastic = dent(0.1, 0.45, &volume);
    if (!(fabs(elastic) < 1e-3)) fail_msg("an elastic block keeps a dent of %g", elastic);
    if (!(fabs(little) < 1e-3)) fail_msg("a block below its yield keeps a dent of %g", little);
    if (!(plastic > 0.01)) fail_msg("a plastic block keeps a dent of %g only", plastic);
    if (!(volume < (SINGLE ? 1e-5 : 1e-12))) fail_msg("volume off by %g", volume);
}

/* A shear's strain is capped; of a stretch the volume decides what is a shape, and of a spread how
 * thin it is. */
TEST(shapes_have_bounds)
{
    const OctParams params = {.creep = 1, .most = 0.5}, free = {.creep = 1, .most = 100};
    const real stretch[] = {(real)-0.951, (real)-0.949, (real)18.99, (real)19.01};
    for (int i = 0; i < 4; i++) {
        vec strain[9] = {0}, S[9], inverse[9];
        for (int k = 0; k < 9; k++) S[k] = lanes_set(k % 4 == 0);
        strain[1] = lanes_set((real)0.2 * (real)(i + 1));
        plastic_creep(&params, strain, S);
        assert_true(fabs((double)S[1][0] - fmin(0.2 * (i + 1), 0.5)) < 1e-6);
        for (int k = 0; k < 9; k++) S[k] = lanes_set(k % 4 == 0);
        strain[1] = lanes_set(0);
        strain[0] = lanes_set(stretch[i]);
        assert_int_equal(lanes_any(plastic_creep(&free, strain, S)), i == 1 || i == 2);
        for (int k = 0; k < 9; k++) S[k] = lanes_set(k % 4 == 0);
        real spread[6 * SM_LANES];
        for (int k = 0; k < 6 * SM_LANES; k++)
            spread[k] = k >= 3 * SM_LANES ? 0 : k >= 2 * SM_LANES ? (real)1e-7 * (real)(i + 1) : 1;
        plastic_inverse(spread, S, inverse);
        assert_int_equal(inverse[0][0] > 0, i >= 2); /* 1e-6 / 27 * 8 is 2.96e-7 */
    }
}

/* The octree and FastLSM engines give the same goal positions: same nodes and neighbours, equal
 * masses, epsilon 0. The regions of each are its own; the octree's hold inner nodes of the tree. */
TEST(test_fastlsm)
{
    const SmEngineType *type = SINGLE ? &fastlsm_engine_f32 : &fastlsm_engine_f64;
    unsigned seed = 11;
    long inner = 0;
    for (int trial = 0; trial < 36; trial++) {
        SmVoxels cells;
        SmEngine *engine;
        Body body;
        random_body(&seed, trial % 6, 8, &cells);
        cells.cell = 1;
        for (int d = 0; d < 3; d++) cells.origin[d] = 0;
        SmEngineParams lattice = {.w = 1 + trial / 6 % 3, .h = 0.01, .threads = 1};
        assert_int_equal(type->create(&cells, &lattice, &engine, NULL), SM_OK);
        double(*x0)[3] = triples(cells.particle_count), (*x)[3] = triples(cells.particle_count);
        type->get(engine, SM_REST, x0);
        random_deformation(&seed, 1, 0.3, cells.particle_count, (const double(*)[3])x0, x);
        type->set(engine, SM_POSITION, (const double(*)[3])x);
        lattice_body(&seed, &cells, lattice.w, engine, type, &body);
        for (long m = 0; m < body.regions.members.live; m++)
            inner += body.tree.child[body.regions.members.item[m]] >= 0;
        Oct *oct = create(&body, (OctParams){.form = (OctGoalForm)(trial % 2), .threads = 1});
        oct_goals(oct);
        get(oct, 0, oct->body->g, true, body.a);
        double worst =
            field_difference(body.n, (const double(*)[3])body.a, (const double(*)[3])body.b);
        if (!(worst <= tolerance)) fail_msg("trial %d: the engines differ by %g", trial, worst);
        oct_free(oct);
        body_free(&body);
        free(x0);
        free(x);
        type->destroy(engine);
        sm_voxels_free(&cells);
    }
    assert_true(inner > 10000);
}
