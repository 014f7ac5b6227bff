/* The octree behind the common interface, in both precisions: units, handles, obstacles, pushes,
 * instances, masses; what it refuses. */
#include "../lib/engine/test_touching.h"
#include "../lib/test_fields.h"
#include "../lib/test_frame.h"
#include "../reference/octree_goals.h"
#include "engine.h"
#include "test_engine_body.h"
#include "tree/test_trees.h"

static const double limit[2] = {5e-5, 1e-10}; /* finest cells */
static const double jacobi_limit = 5e-6;      /* the method stops at off-diagonals of 1e-6 */

/* The state moved at random by a tenth of a cell. */
static void shake(const SmEngineType *type, SmEngine *engine, long n, double (*x)[3])
{
    unsigned seed = 5;
    type->get(engine, SM_REST, x);
    for (long i = 0; i < n; i++)
        for (int d = 0; d < 3; d++) x[i][d] += 0.1 * (random_unit(&seed) - 0.5);
    type->set(engine, SM_POSITION, (const double(*)[3])x);
    type->get(engine, SM_POSITION, x);
}

TEST(goals_are_the_twins)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    for (int trial = 0; trial < 24; trial++) {
        int precision = trial % 2;
        bool jacobi = trial % 7 > 4;
        const SmEngineType *type = engines[precision];
        OctOptions options = {.epsilon = 0.5,
                              .sampling = {.levels = 2, .nodes = 90},
                              .masses = trial % 3 ? OCT_MATERIAL : OCT_VOLUME,
                              .symmetry = (OctSymmetry)(trial / 8),
                              .weighting = trial / 2 % 2 ? OCT_PLAIN : OCT_CONSERVING,
                              .form = trial / 4 % 2 ? OCT_ADJOINT : OCT_HIERARCHICAL};
        if (options.symmetry == OCT_ASYMMETRIC) options.form = OCT_ADJOINT;
        SmEngineParams params = usual(&options);
        if (jacobi) params.polar = SM_POLAR_JACOBI;
        SmCounts counts;
        SmEngine *engine = make(precision, &voxels, &params, &counts);
        const OctStructure *s = oct_engine_structure(engine);
        RefTreeBody twin;
        long n = counts.particles;
        double(*x)[3] = triples(n), (*g)[3] = triples(n), (*exact)[3] = triples(n);
        assert_int_equal(n, s->tree.leaves);
        assert_true(counts.summation_nodes == s->regions.mean);
        shake(type, engine, n, x);
        for (int turn = 0; turn <= jacobi; turn++) type->goals(engine); /* from where it ended */
        type->get(engine, SM_GOAL, g);
        ref_tree_init(&s->tree, &s->regions, s->mass, options.weighting == OCT_PLAIN, &twin);
        for (long i = 0; i < n; i++)
            for (int d = 0; d < 3; d++) x[i][d] = (x[i][d] - voxels.origin[d]) / voxels.cell;
        ref_tree_goals(&twin, (const double(*)[3])x, false, exact);
        for (long i = 0; i < n; i++)
            for (int d = 0; d < 3; d++) g[i][d] = (g[i][d] - voxels.origin[d]) / voxels.cell;
        assert_true(field_difference(n, (const double(*)[3])g, (const double(*)[3])exact) <
                    (jacobi ? fmax(limit[precision], jacobi_limit) : limit[precision]));
        ref_tree_free(&twin);
        free(x);
        free(g);
        free(exact);
        type->destroy(engine);
    }
    sm_voxels_free(&voxels);
}

TEST(regions_are_the_leaves_and_symmetric)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    OctOptions options = {.epsilon = 0.5, .sampling = {.levels = 2, .nodes = 90}};
    SmEngineParams params = usual(&options);
    params.instances = 2;
    SmCounts counts;
    SmEngine *engine = make(1, &voxels, &params, &counts);
    long n = counts.particles / 2, few[2];
    char *in = sm_alloc((size_t)(n * n), 1);
    long *member = sm_alloc((size_t)n, sizeof *member);
    for (long i = 0; i < n; i++) {
        long count = octree_engine_f64.region(engine, n + i, member, n);
        assert_int_equal(count, octree_engine_f64.region(engine, i, few, 2));
        for (long k = 0; k < count; k++) {
            assert_true(member[k] >= n && member[k] < 2 * n);
            assert_true(k == 0 || member[k] > member[k - 1]);
            if (k < 2) assert_int_equal(few[k], member[k] - n);
            in[i * n + member[k] - n] = 1;
        }
    }
    for (long i = 0; i < n; i++)
        for (long j = 0; j <= i; j++) assert_int_equal(in[i * n + j], in[j * n + i]);
    free(in);
    free(member);
    octree_engine_f64.destroy(engine);
    sm_voxels_free(&voxels);
}

/* Held nodes are where their handle puts them, with the velocity of getting there. */
TEST(handles_hold)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngineParams params = usual(NULL);
        params.gravity[1] = -9.81;
        SmCounts counts;
        SmEngine *engine = make(precision, &voxels, &params, &counts);
        long n = counts.particles, held[3] = {0, 3, n - 1};
        double(*x0)[3] = triples(n), (*x)[3] = triples(n), (*v)[3] = triples(n);
        SmHandle handle = {.count = 3,
                           .particle = held,
                           .pose = {{0.8, -0.6, 0, 1}, {0.6, 0.8, 0, 0}, {0, 0, 1, 0}}};
        SmBoundary boundary = {.handle_count = 1, .handle = &handle};
        type->get(engine, SM_REST, x0);
        type->bound(engine, &boundary);
        for (int step = 0; step < 20; step++) {
            handle.pose[2][3] = 0.01 * step;
            type->bound(engine, &boundary);
            type->step(engine, NULL);
        }
        type->get(engine, SM_POSITION, x);
        type->get(engine, SM_VELOCITY, v);
        for (int k = 0; k < 3; k++) {
            const double *from = x0[held[k]], *at = x[held[k]];
            double unit = precision ? 1e-12 : 1e-5;
            assert_true(fabs(at[0] - (0.8 * from[0] - 0.6 * from[1] + 1)) < unit);
            assert_true(fabs(at[1] - (0.6 * from[0] + 0.8 * from[1])) < unit);
            assert_true(fabs(at[2] - (from[2] + 0.19)) < unit);
            assert_true(fabs(v[held[k]][2] - 1) < 100 * unit); /* 0.01 in a step of 0.01 s */
        }
        free(x0);
        free(x);
        free(v);
        type->destroy(engine);
    }
    sm_voxels_free(&voxels);
}

/* A body that falls a long way does not go through the ground. */
TEST(obstacles_stop)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    const SmObstacle ground = {.kind = SM_PLANE, .a = {0, -60, 0}, .b = {0, 1, 0}, .friction = 0.5};
    SmBoundary boundary = {.obstacle_count = 1, .obstacle = &ground};
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        SmEngineParams params = usual(NULL);
        params.gravity[1] = -9.81;
        params.damping = 0.2;
        SmCounts counts;
        SmEngine *engine = make(precision, &voxels, &params, &counts);
        double(*x)[3] = triples(counts.particles), least = INFINITY;
        type->bound(engine, &boundary);
        for (int step = 0; step < 500; step++) {
            type->step(engine, NULL);
            type->get(engine, SM_POSITION, x);
            for (long i = 0; i < counts.particles; i++) least = fmin(least, x[i][1]);
        }
        assert_true(least > -60 - 1e-3);
        assert_true(least < -59);
        free(x);
        type->destroy(engine);
    }
    sm_voxels_free(&voxels);
}

/* Impulses are momentum, whatever the node weighs, and a step keeps it. */
TEST(pushes_are_momentum)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        OctOptions options = {.epsilon = 0.5, .sampling = {.levels = 2, .nodes = 90}};
        SmEngineParams params = usual(&options);
        params.damping = 0.1;
        SmCounts counts;
        SmEngine *engine = make(precision, &voxels, &params, &counts);
        long n = counts.particles, pushed[2] = {1, n - 2};
        const double impulse[2][3] = {{3, 0, -1}, {0, 2, 0}}, wanted[3] = {3, 2, -1};
        double(*v)[3] = triples(n), *m = sm_alloc((size_t)n, sizeof *m), mass = 0;
        type->masses(engine, m);
        type->push(engine, 2, pushed, impulse);
        for (int step = 0; step < 5; step++) {
            type->get(engine, SM_VELOCITY, v);
            for (int d = 0; d < 3; d++) {
                double sum = 0; /* the whole body at a cell per step has 2e4 */
                for (long i = 0; i < n; i++) sum += m[i] * v[i][d];
                if (!(fabs(sum - wanted[d]) < (precision ? 1e-9 : 0.02)))
                    fail_msg("precision %d, step %d: %g, not %g", precision, step, sum, wanted[d]);
            }
            type->step(engine, NULL);
        }
        for (long i = 0; i < n; i++) mass += m[i];
        assert_true(mass == (double)voxels.cell_count); /* 1 a cell */
        free(v);
        free(m);
        type->destroy(engine);
    }
    sm_voxels_free(&voxels);
}

/* Masses of the lattice's vertices come down to the leaves, none lost. */
TEST(masses_come_from_the_vertices)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    size_t count = (size_t)voxels.particle_count;
    double *vertex = sm_alloc(count, sizeof *vertex), all = 0, left = 0, sum = 0;
    int(*at)[3] = sm_alloc(count, sizeof *at);
    sm_voxels_particles(&voxels, at);
    for (size_t p = 0; p < count; p++) all += vertex[p] = at[p][0] < 6 ? 1 : 9;
    SmEngineParams params = usual(NULL);
    params.mass = vertex;
    SmCounts counts;
    SmEngine *engine = make(1, &voxels, &params, &counts);
    long n = counts.particles;
    double *m = sm_alloc((size_t)n, sizeof *m), (*x0)[3] = triples(n);
    octree_engine_f64.masses(engine, m);
    octree_engine_f64.get(engine, SM_REST, x0);
    for (long i = 0; i < n; i++) {
        sum += m[i];
        if (x0[i][0] < 6) left += m[i];
    }
    assert_true(fabs(sum - all) < 1e-9 * all);
    assert_true(left < 0.25 * all && left > 0.05 * all);
    free(vertex);
    free(at);
    free(m);
    free(x0);
    octree_engine_f64.destroy(engine);
    sm_voxels_free(&voxels);
}

/* Turned and moved instances rest where their poses put them, and stay there. */
TEST(instances_rest_in_their_poses)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    double pose[5][3][4];
    for (int i = 0; i < 5; i++) {
        double c = cos(i), s = sin(i),
               p[3][4] = {{c, -s, 0, 9.0 * i}, {s, c, 0, -i}, {0, 0, 1, 50}};
        memcpy(pose[i], p, sizeof p);
    }
    for (int precision = 0; precision < 2; precision++) {
        const SmEngineType *type = engines[precision];
        OctOptions options = {.epsilon = 0.5};
        SmEngineParams params = usual(&options);
        params.instances = 5;
        params.instance_pose = (const double(*)[3][4])pose;
        params.damping = 0.1;
        SmCounts counts;
        SmEngine *engine = make(precision, &voxels, &params, &counts);
        long n = counts.particles, one = n / 5;
        double(*x0)[3] = triples(n), (*x)[3] = triples(n);
        type->get(engine, SM_REST, x0);
        for (int step = 0; step < 40; step++) type->step(engine, NULL);
        type->get(engine, SM_POSITION, x);
        assert_true(field_difference(n, (const double(*)[3])x0, (const double(*)[3])x) <
                    (precision ? 1e-9 : 1e-3));
        for (int i = 1; i < 5; i++)
            for (int d = 0; d < 3; d++) {
                double wanted = pose[i][d][3];
                for (int e = 0; e < 3; e++) {
                    /* instance 0's pose moves by 50 along z alone */
                    wanted += pose[i][d][e] * (x0[0][e] - (e == 2 ? 50 : 0));
                }
                assert_true(fabs(x0[i * one][d] - wanted) < 1e-9);
            }
        free(x0);
        free(x);
        type->destroy(engine);
    }
    sm_voxels_free(&voxels);
}

/* One block on another on the ground: the lower one carries the upper one. */
TEST(stacks_stand)
{
    for (int precision = 0; precision < 2; precision++) {
        OctOptions options = {.epsilon = 0.5};
        SmEngineParams params = usual(&options);
        params.collide.friction = 0.5;
        double moved = touching_moves(engines[precision], params, 8, (double[]){0, 4, 0}, 4000);
        if (!(moved < 1e-3)) fail_msg("%g", moved);
    }
}

/* A plank of 64 base cells as the engine would choose them. */
TEST(few_nodes_get_large_base_cells)
{
    SmVoxels voxels;
    sm_voxels_block(&voxels, 64, 64, 8, 0.1);
    static const int wanted[] = {64, 16, 4, 1};
    for (int n = 0; n < 4; n++) {
        OctOptions options = {.sampling = {.nodes = wanted[n]}};
        SmEngineParams params = usual(&options);
        SmCounts counts;
        SmEngine *engine = make(0, &voxels, &params, &counts);
        assert_int_equal(counts.particles, wanted[n]);
        octree_engine_f32.destroy(engine);
    }
    sm_voxels_free(&voxels);
}

TEST(other_choices_are_not_resampled)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    for (int symmetry = 0; symmetry < 3; symmetry++) {
        OctOptions options = {.sampling = {.levels = 2, .nodes = 90},
                              .symmetry = (OctSymmetry)symmetry,
                              .form = symmetry == OCT_UNION ? OCT_HIERARCHICAL : OCT_ADJOINT};
        SmEngineParams params = usual(&options);
        SmCounts counts;
        SmEngine *engine = make(1, &voxels, &params, &counts);
        OctStructure *structure;
        SmError error;
        SmCode code = oct_engine_begin(engine, &structure, &error);
        assert_int_equal(code, symmetry == OCT_UNION ? SM_OK : SM_USAGE);
        if (code) assert_non_null(strstr(error.text, "only bodies of symmetry 'union'"));
        octree_engine_f64.destroy(engine);
    }
    sm_voxels_free(&voxels);
}

TEST(refuses_what_it_does_not_do)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    const double masses[1] = {-1};
    const struct {
        OctOptions options;
        SmEngineParams params;
        const char *wanted;
    } cases[] = {
        {{.epsilon = 0}, {.h = 0.01, .strain_limit = 1.5}, "strain_limit: the octree's material"},
        {{.epsilon = 0}, {.h = 0.01, .summation = SM_SUM_NAIVE}, "summation and layout"},
        {{.epsilon = 0}, {.h = 0.01, .layout = SM_LAYOUT_LISTS}, "summation and layout"},
        {{.epsilon = 0}, {.h = 0}, "h is 0"},
        {{.epsilon = 0}, {.h = 0.01, .damping = 2}, "damping is 2"},
        {{.epsilon = 0}, {.h = 0.01, .mass = masses}, "the mass of particle 0 is -1"},
        {{.epsilon = -1}, {.h = 0.01}, "epsilon is -1"},
        {{.epsilon = NAN}, {.h = 0.01}, "epsilon is"},
        {{.width = {.cells = -1}}, {.h = 0.01}, "width of -1 cells"},
        {{.width = {.cells = 2e6}}, {.h = 0.01}, "width of 2e+06 cells"},
        {{.width = {.edges = INFINITY}}, {.h = 0.01}, "width of 0 cells and inf edges"},
        {{.local = {{.width = {NAN, 0}}}, .local_count = 1}, {.h = 0.01}, "width 1 is nan"},
        {{.local = {{.radius = 0.01}}, .local_count = 1}, {.h = 0.01}, "no node's centre lies in"},
        {{.local_count = OCT_MAX_WIDTHS + 1}, {.h = 0.01}, "17 widths: at most 16"},
        {{.summation_nodes = -2}, {.h = 0.01}, "-2 summation nodes wanted"},
        {{.symmetry = OCT_ASYMMETRIC}, {.h = 0.01}, "need goals 'adjoint'"},
        {{.creep = -1}, {.h = 0.01}, "plasticity of yield 0, creep -1"},
        {{.creep = 101}, {.h = 0.01}, "creep is at most 1/h = 100; give less, or a smaller h"},
        {{.sampling = {.levels = 99}}, {.h = 0.01}, "99"},
        {{.sampling = {.nodes = -5}}, {.h = 0.01}, "-5"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        SmEngineParams params = cases[i].params;
        SmEngine *engine;
        SmError error = {0};
        params.octree = &cases[i].options;
        assert_int_equal(octree_engine_f32.create(&voxels, &params, &engine, &error), SM_INPUT);
        if (!strstr(error.text, cases[i].wanted))
            fail_msg("wanted \"%s\", got \"%s\"", cases[i].wanted, error.text);
    }
    sm_voxels_free(&voxels);
}

/* Single precision has not the digits for what is far apart and yet in one region. */
TEST(regions_may_not_reach_further_than_the_digits)
{
    SmVoxels voxels;
    SmEngine *engine;
    SmError error;
    sm_voxels_block(&voxels, 520, 1, 1, 0.5);
    for (int precision = 0; precision < 2; precision++)
        for (int wide = 0; wide < 2; wide++) {
            OctOptions options = {.sampling = {.levels = 1}, .width.cells = wide ? 260 : 256};
            SmEngineParams params = usual(&options);
            SmCode code = engines[precision]->create(&voxels, &params, &engine, &error);
            assert_int_equal(code, precision == 0 && wide ? SM_INPUT : SM_OK);
            if (code) assert_non_null(strstr(error.text, "double precision"));
            if (!code) engines[precision]->destroy(engine);
        }
    sm_voxels_free(&voxels);
}

/* Nor for a wide body's one origin, once it changes: said beforehand. */
TEST(wide_bodies_do_not_change_in_single_precision)
{
    for (int precision = 0; precision < 2; precision++)
        for (int wide = 0; wide < 2; wide++) {
            SmVoxels voxels;
            SmEngine *engine;
            SmError error;
            OctStructure *structure;
            sm_voxels_block(&voxels, wide ? 516 : 512, 1, 1, 0.5);
            OctOptions options = {.sampling = {.levels = 1}};
            SmEngineParams params = usual(&options);
            assert_int_equal(engines[precision]->create(&voxels, &params, &engine, &error), SM_OK);
            SmCode wanted = precision == 0 && wide ? SM_INPUT : SM_OK;
            assert_int_equal(oct_engine_may_change(engine, &error), wanted);
            if (wanted) assert_non_null(strstr(error.text, "double precision"));
            assert_int_equal(oct_engine_begin(engine, &structure, &error), wanted);
            engines[precision]->destroy(engine);
            sm_voxels_free(&voxels);
        }
}
