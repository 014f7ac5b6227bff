/* The meshless engine behind engine.h: rest, falling, pushes, handles, and what it refuses. */
#include "../../lib/shapes/shape.h"
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../lib/vector.h"
#include "../../lib/voxel/voxelise.h"
#include "engine.h"
#include "stored.h"
#include "test_cuts.h"
#include "test_solver.h"

static const SmEngineType *const type = &ref_meshless_engine;

typedef struct {
    SmMesh mesh;
    SmVoxels voxels;
    RefMeshlessOptions options;
    SmEngineParams params;
} Scene;

static Scene scene_create(void)
{
    Scene scene = {.options = {.points = TEST_FIGURES ? 0 : 3000,
                               .nodes = TEST_FIGURES ? 200 : 100,
                               .modes = 30,
                               .material = {.young = 1e5, .poisson = 0.3, .density = 1000}},
                   .params = {.w = 1, .h = 0.01}};
    SmVoxelParams solid = {.fill = SM_SOLID, .particles = 400};
    assert_int_equal(sm_shape_mesh("penguin", &scene.mesh, NULL), SM_OK);
    assert_int_equal(sm_voxelise(&scene.mesh, &solid, "penguin", &scene.voxels, NULL), SM_OK);
    return scene;
}

/* A beam along x, 1 wide and high. */
static Scene beam_create(double length, long nodes)
{
    static const int corner[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                      {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                      {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    Scene scene = {
        .mesh = sm_mesh_new(8, 12),
        .options = {.nodes = nodes, .material = {.young = 1e5, .poisson = 0.3, .density = 1000}},
        .params = {.w = 1, .h = 0.05}};
    SmVoxelParams solid = {.fill = SM_SOLID, .cell = 0.25};
    for (int n = 0; n < 8; n++)
        for (int d = 0; d < 3; d++)
            scene.mesh.position[n][d] = (n >> d & 1 ? 1 - 1e-6 : 1e-6) * (d == 0 ? length : 1);
    for (int t = 0; t < 12; t++)
        for (int c = 0; c < 3; c++) scene.mesh.triangle[t][c] = corner[t][c];
    assert_int_equal(sm_voxelise(&scene.mesh, &solid, "beam", &scene.voxels, NULL), SM_OK);
    return scene;
}

static SmCode create(Scene *scene, SmEngine **engine, SmError *error)
{
    scene->options.mesh = &scene->mesh;
    scene->params.meshless = &scene->options;
    return type->create(&scene->voxels, &scene->params, engine, error);
}

static void scene_free(Scene *scene)
{
    sm_mesh_free(&scene->mesh);
    sm_voxels_free(&scene->voxels);
}

static long particles_of(SmEngine *engine)
{
    SmCounts counts;
    type->count(engine, &counts);
    return counts.particles;
}

static double (*field(SmEngine *engine, SmField which))[3]
{
    double(*values)[3] = sm_alloc((size_t)particles_of(engine), sizeof *values);
    type->get(engine, which, values);
    return values;
}

/* A body at rest stays; one that falls is where h^2 g n (n + 1) / 2 says, undeformed. */
TEST(rest_and_fall)
{
    needs_solver();
    for (int falls = 0; falls < 2; falls++) {
        Scene scene = scene_create();
        SmEngine *engine;
        scene.params.gravity[1] = falls ? -9.81 : 0;
        assert_int_equal(create(&scene, &engine, NULL), SM_OK);
        long count = particles_of(engine);
        assert_int_equal(count, scene.voxels.particle_count);
        for (int step = 0; step < 20; step++) type->step(engine, NULL);
        double(*rest)[3] = field(engine, SM_REST), (*x)[3] = field(engine, SM_POSITION);
        double way = falls ? -9.81 * 1e-4 * 20 * 21 / 2 : 0;
        for (long p = 0; p < count; p++)
            for (int d = 0; d < 3; d++)
                assert_true(fabs(x[p][d] - rest[p][d] - (d == 1 ? way : 0)) < 1e-4);
        free(rest);
        free(x);
        type->destroy(engine);
        scene_free(&scene);
    }
}

/* How far particles are from rest, at most. */
static double farthest(SmEngine *engine, double (**x)[3])
{
    double(*rest)[3] = field(engine, SM_REST), most = 0;
    *x = field(engine, SM_POSITION);
    for (long p = 0; p < particles_of(engine); p++)
        most = fmax(most, sqrt(sm_square_between(rest[p], (*x)[p])));
    free(rest);
    return most;
}

/* A free beam's modes, shown: rising, the first at theory's frequency; about as far as was asked
 * for, to and fro alike; no mode in another; and the motion goes on from where it was. */
TEST(modes_are_shown)
{
    needs_solver();
    Scene scene = beam_create(8, 300);
    SmEngine *engine;
    scene.options.modes = 12;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    assert_int_equal(ref_meshless_shapes(engine), 6);
    long count = particles_of(engine);
    double(*shape[6])[3], (*back)[3], (*rest)[3] = field(engine, SM_REST), last = 0;
    for (int mode = 0; mode < 6; mode++) {
        double hertz = ref_meshless_show(engine, mode, -1e-3);
        farthest(engine, &back);
        assert_true(ref_meshless_show(engine, mode, 1e-3) == hertz && hertz >= last);
        double most = farthest(engine, &shape[mode]);
        if (!(most > 0.8e-3 && most < 1.25e-3)) fail_msg("mode %d: %g", mode, most);
        for (long p = 0; p < count; p++)
            for (int d = 0; d < 3; d++)
                assert_true(fabs(shape[mode][p][d] + back[p][d] - 2 * rest[p][d]) < 1e-5);
        free(back);
        last = hertz;
    }
    /* Timoshenko's is 5% below Euler and Bernoulli's here */
    double euler = pow(4.73004 / 8, 2) * sqrt(1e5 / 1000 / 12) / (2 * M_PI);
    double first = ref_meshless_show(engine, 0, 0);
    if (!(first > 0.9 * euler && first < euler)) fail_msg("%g Hz, by theory %g", first, euler);
    for (int mode = 1; mode < 6; mode++) {
        double dot = 0, square = 0;
        for (long p = 0; p < count; p++)
            for (int d = 0; d < 3; d++) {
                double u = shape[0][p][d] - rest[p][d], v = shape[mode][p][d] - rest[p][d];
                dot += u * v;
                square += v * v;
            }
        assert_true(fabs(dot) < 0.1 * square);
    }
    for (int step = 0; step < 3; step++) type->step(engine, NULL);
    assert_true(farthest(engine, &back) < 1e-6);
    for (int mode = 0; mode < 6; mode++) free(shape[mode]);
    free(back);
    free(rest);
    type->destroy(engine);
    scene_free(&scene);
}

/* Pushes on all particles of a speed times their mass give the body that speed, once it no longer
 * swings; and a little turning, for vertices are not spread as the mass is. */
TEST(pushes)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *engine;
    scene.options.stiffness_damping = 0.05;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    long count = particles_of(engine);
    double *mass = sm_alloc((size_t)count, sizeof *mass), mean = 0;
    long *particle = sm_alloc((size_t)count, sizeof *particle);
    double(*impulse)[3] = sm_alloc((size_t)count, sizeof *impulse);
    type->masses(engine, mass);
    for (long p = 0; p < count; p++) {
        particle[p] = p;
        impulse[p][2] = 0.5 * mass[p];
    }
    type->push(engine, count, particle, (const double(*)[3])impulse);
    for (int step = 0; step < 200; step++)
        type->step(engine, NULL); /* it comes to rest in itself */
    double(*v)[3] = field(engine, SM_VELOCITY);
    for (long p = 0; p < count; p++) mean += v[p][2] / (double)count;
    assert_true(fabs(mean - 0.5) < 0.05);
    free(v);
    free(mass);
    free(particle);
    free(impulse);
    type->destroy(engine);
    scene_free(&scene);
}

/* A handle on everything that turns by 60 degrees takes the body with it. */
TEST(handles)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *engine;
    scene.params.damping = 0.1;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    long count = particles_of(engine);
    long *particle = sm_alloc((size_t)count, sizeof *particle);
    for (long p = 0; p < count; p++) particle[p] = p;
    SmHandle handle = {.count = count, .particle = particle};
    SmBoundary boundary = {.handle_count = 1, .handle = &handle};
    for (int step = 0; step < 400; step++) {
        double angle = acos(0.5) * fmin(step / 300.0, 1), c = cos(angle), s = sin(angle);
        const double pose[3][4] = {{c, 0, s, 0.3}, {0, 1, 0, 0}, {-s, 0, c, 0}};
        memcpy(handle.pose, pose, sizeof pose);
        type->bound(engine, &boundary);
        type->step(engine, NULL);
    }
    double(*rest)[3] = field(engine, SM_REST), (*x)[3] = field(engine, SM_POSITION), off = 0;
    for (long p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) {
            double wanted = handle.pose[d][3];
            for (int e = 0; e < 3; e++) wanted += handle.pose[d][e] * rest[p][e];
            off = at_worst(off, fabs(x[p][d] - wanted));
        }
    assert_true(off < 0.02); /* of a body 1 high: it still swings a little */
    free(rest);
    free(x);
    free(particle);
    type->destroy(engine);
    scene_free(&scene);
}

/* Handles that hold others, as many as before, on one side of the body and the other in turn: each
 * takes the points along that it grips. */
TEST(handles_that_change)
{
    enum { HELD = 30 };
    needs_solver();
    Scene scene = scene_create();
    SmEngine *engine;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    long particle[HELD], count = particles_of(engine);
    double(*rest)[3] = field(engine, SM_REST);
    for (int turn = 0; turn < 8; turn++) {
        SmHandle handle = {.count = HELD, .particle = particle};
        SmBoundary boundary = {.handle_count = 1, .handle = &handle};
        for (int d = 0; d < 3; d++) handle.pose[d][d] = 1;
        handle.pose[1][3] = 0.1 * turn;
        for (long k = 0; k < HELD; k++) particle[k] = turn % 2 ? count - 1 - k : k;
        type->bound(engine, &boundary);
        for (int step = 0; step < 10; step++) type->step(engine, NULL);
        double(*x)[3] = field(engine, SM_POSITION);
        int met = 0;
        for (int k = 0; k < HELD; k++)
            met += fabs(x[particle[k]][1] - rest[particle[k]][1] - 0.1 * turn) < 1e-5;
        assert_true(met >= 4); /* as many at least are gripped; the others swing */
        free(x);
    }
    free(rest);
    type->destroy(engine);
    scene_free(&scene);
}

/* The particles of the slab x <= to; and, into *tip, the one whose rest is nearest to (x, 1/2,
 * 1/2). */
static long slab(SmEngine *engine, double to, double x, long *particle, long *tip)
{
    double(*rest)[3] = field(engine, SM_REST), least = INFINITY;
    long count = 0;
    for (long p = 0; p < particles_of(engine); p++) {
        double way[3] = {rest[p][0] - x, rest[p][1] - 0.5, rest[p][2] - 0.5};
        double square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
        if (rest[p][0] <= to + 1e-9) particle[count++] = p;
        if (square < least) {
            least = square;
            *tip = p;
        }
    }
    free(rest);
    return count;
}

/* A cantilever of 64 modes sags under its weight as Timoshenko's beam does, and stays in its clamp.
 */
TEST(cantilever)
{
    needs_solver();
    needs_figures();
    static const double root = 1, length = 9, g = 1e-3;
    Scene scene = beam_create(length, 1000);
    SmEngine *engine;
    scene.params.gravity[1] = -g;
    scene.params.damping = 0.016; /* about critical */
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    long *particle = sm_alloc((size_t)particles_of(engine), sizeof *particle), tip = 0;
    SmHandle handle = {.count = slab(engine, root, length, particle, &tip), .particle = particle};
    for (int d = 0; d < 3; d++) handle.pose[d][d] = 1;
    SmBoundary boundary = {.handle_count = 1, .handle = &handle};
    type->bound(engine, &boundary);
    for (int step = 0; step < 1600; step++) type->step(engine, NULL);
    double(*rest)[3] = field(engine, SM_REST), (*x)[3] = field(engine, SM_POSITION), held = 0;
    for (long n = 0; n < handle.count; n++)
        for (int d = 0; d < 3; d++)
            held = at_worst(held, fabs(x[particle[n]][d] - rest[particle[n]][d]));
    double L = rest[tip][0] - root, q = 1000 * g, EI = 1e5 / 12, kGA = 5.0 / 6 * 1e5 / 2.6;
    double wanted = q * pow(L, 4) / (8 * EI) + q * L * L / (2 * kGA);
    double sag = rest[tip][1] - x[tip][1];
    print_message("sag %g, in theory %g: %+.1f%%; clamp off by %.1e\n", sag, wanted,
                  100 * (sag / wanted - 1), held);
    assert_true(fabs(sag / wanted - 1) < 0.02);
    assert_true(held < 0.005 * wanted);
    free(rest);
    free(x);
    free(particle);
    type->destroy(engine);
    scene_free(&scene);
}

/* A small squash comes back as it was set; so does a speed. */
TEST(set_and_get)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *engine;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    double(*rest)[3] = field(engine, SM_REST), (*x)[3] = field(engine, SM_REST);
    long count = particles_of(engine);
    for (long p = 0; p < count; p++) x[p][1] = 0.98 * rest[p][1] + 0.1;
    type->set(engine, SM_POSITION, (const double(*)[3])x);
    double(*back)[3] = field(engine, SM_POSITION);
    for (long p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) assert_true(fabs(back[p][d] - x[p][d]) < 0.02);
    type->set(engine, SM_VELOCITY, (const double(*)[3])rest);
    type->get(engine, SM_VELOCITY, back);
    assert_memory_equal(back, rest, (size_t)count * sizeof *rest);
    free(rest);
    free(x);
    free(back);
    type->destroy(engine);
    scene_free(&scene);
}

/* The plane x = level of a beam from y = -0.5 to `front` is cut. */
static SmCode cut_beam(SmEngine *engine, SmCut *cut, double level, double front, SmError *error)
{
    long first = cut->triangles;
    cut_across(cut, 0, level, -0.5, front, 4);
    return type->cut(engine, cut, first, error);
}

/* Momentum and energy of a free body's modes, and its mass. */
static double momentum(SmEngine *engine, double p[3])
{
    const RefElastic *elastic = ref_meshless_elastic(engine);
    const RefMotion *motion = &elastic->motion;
    double all = 0, *mass = sm_alloc((size_t)motion->nodes, sizeof *mass);
    ref_sparse_sums(&elastic->body.matrices.mass, mass);
    memset(p, 0, sizeof(double[3]));
    for (long n = 0; n < motion->nodes; n++) {
        all += mass[n];
        for (int d = 0; d < 3; d++) {
            const double *row = motion->row + (6 * n + d) * motion->modes;
            for (int k = 0; k < motion->modes; k++) p[d] += mass[n] * row[k] * motion->speed[k];
        }
    }
    free(mass);
    return all;
}

/* Kinetic and elastic energy of the modes. */
static void energies(const RefMotion *motion, double energy[2])
{
    energy[0] = energy[1] = 0;
    for (int k = 0; k < motion->modes; k++) {
        energy[0] += 0.5 * motion->speed[k] * motion->speed[k];
        energy[1] += 0.5 * motion->lambda[k] * motion->z[k] * motion->z[k];
    }
}

/* A beam that flies and sways, cut half and then through: its momentum stays, no energy
 * grows, and both pieces fly on, each in its own way, with all particles of one side. */
TEST(a_cut_beam_flies_on_in_pieces)
{
    needs_solver();
    Scene scene = beam_create(4, 150);
    SmEngine *engine;
    SmCut cut;
    SmPieces pieces;
    scene.params.strain_limit = INFINITY;
    scene.options.modes = 40;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    sm_cut_init(&cut, 0.5);
    RefElastic *elastic = ref_meshless_elastic(engine);
    double(*v)[3] = field(engine, SM_REST), before[3], after[3];
    for (long p = 0; p < particles_of(engine); p++) {
        double x = v[p][0] - 2, z = v[p][2];
        v[p][0] = 1 + 0.3 * z, v[p][1] = 0.2 * x * x, v[p][2] = -0.5 - 0.3 * x;
    }
    type->set(engine, SM_VELOCITY, (const double(*)[3])v);
    for (int step = 0; step < 3; step++) type->step(engine, NULL);
    for (int through = 0; through < 2; through++) {
        double mass = momentum(engine, before), energy[2], later[2];
        energies(&elastic->motion, energy);
        assert_int_equal(cut_beam(engine, &cut, 2.05, through ? 1.5 : 0.55, NULL), SM_OK);
        assert_true(fabs(momentum(engine, after) - mass) < 1e-9 * mass);
        for (int d = 0; d < 3; d++) assert_true(fabs(after[d] - before[d]) < 1e-8 * mass);
        energies(&elastic->motion, later);
        for (int k = 0; k < 2; k++) assert_true(later[k] <= energy[k] * (1 + 1e-9));
        assert_true(later[0] > 0.95 * energy[0]);
        type->pieces(engine, &pieces);
        assert_int_equal(pieces.count, 1 + through);
        if (through == 0) sm_pieces_free(&pieces);
    }
    double(*rest)[3] = field(engine, SM_REST);
    for (long p = 0; p < particles_of(engine); p++)
        assert_int_equal(pieces.piece[p] == pieces.piece[0],
                         (rest[p][0] < 2.05) == (rest[0][0] < 2.05));
    for (int step = 0; step < 40; step++) type->step(engine, NULL);
    momentum(engine, after);
    for (int d = 0; d < 3; d++) assert_true(fabs(after[d] - before[d]) < 1e-7 * 4000);
    double(*x)[3] = field(engine, SM_POSITION);
    for (long p = 0; p < particles_of(engine); p++) /* 2 s at about 1 m/s */
        for (int d = 0; d < 3; d++) assert_true(fabs(x[p][d] - rest[p][d]) < 4);
    free(x);
    free(v);
    free(rest);
    sm_pieces_free(&pieces);
    sm_cut_free(&cut);
    type->destroy(engine);
    scene_free(&scene);
}

/* How far a cantilever sags at x under its own weight a length: Timoshenko's, of a square 1 wide.
 */
static double cantilever_sag(double weight, double length, double x)
{
    double young = 1e5, shear = 10 * 1.3 / (12 + 11 * 0.3) * young / 2.6;
    return weight * x * x * (6 * length * length - 4 * length * x + x * x) / (2 * young) +
           weight * (length * x - x * x / 2) / shear;
}

/* A cut at 1.93 goes on by a tenth: no energy of the modes grows. */
static void cut_on_further(SmEngine *engine, SmCut *cut, double front)
{
    const RefMotion *motion = &ref_meshless_elastic(engine)->motion;
    double before[2], after[2];
    long first = cut->triangles;
    energies(motion, before);
    if (first == 0)
        cut_across(cut, 0, 1.93, -0.5, front, 1);
    else
        cut_on(cut, 0, 1.93, front - 0.1, front, 1);
    assert_int_equal(type->cut(engine, cut, first, NULL), SM_OK);
    energies(motion, after);
    for (int k = 0; k < 2; k++) assert_true(after[k] <= before[k] * (1 + 1e-9));
}

/* A cut through what is held, along the beam, is refused and changes nothing; so is one so close to
 * a particle that is held alone that it has no nodes left. After a cut, handles on both sides, or
 * on a particle without nodes, do no harm. */
TEST(handles_that_are_cut)
{
    needs_solver();
    for (int alone = 0; alone < 2; alone++) {
        Scene scene = beam_create(4, 150);
        SmEngine *engine;
        SmCut cut;
        SmError error;
        scene.params.strain_limit = INFINITY;
        assert_int_equal(create(&scene, &engine, NULL), SM_OK);
        sm_cut_init(&cut, 0.5);
        double(*rest)[3] = field(engine, SM_REST);
        long *particle = sm_alloc((size_t)particles_of(engine), sizeof *particle), held = 0;
        for (long p = 0; p < particles_of(engine); p++)
            if (rest[p][0] < 0.2 && (!alone || held == 0)) particle[held++] = p;
        SmHandle handle = {.count = held, .particle = particle};
        for (int d = 0; d < 3; d++) handle.pose[d][d] = 1;
        SmBoundary boundary = {.handle_count = 1, .handle = &handle};
        type->bound(engine, &boundary);
        type->step(engine, NULL);
        if (alone)
            cut_across(&cut, 0, rest[particle[0]][0] + 0.01, -1, 2, 3);
        else
            cut_across(&cut, 2, 0.5, -1, 5, 6);
        SmCode code = type->cut(engine, &cut, 0, &error);
        assert_true(code == SM_OK || code == SM_INPUT);
        if (!alone) assert_int_equal(code, SM_INPUT);
        if (code) assert_non_null(strstr(error.text, "handle 1"));
        boundary.handle_count = 0; /* and let go */
        type->bound(engine, &boundary);
        assert_int_equal(type->cut(engine, &cut, 0, &error), SM_OK);
        boundary.handle_count = 1;
        type->bound(engine, &boundary);
        double(*x)[3] = field(engine, SM_POSITION);
        for (int step = 0; step < 20; step++) type->step(engine, NULL);
        type->get(engine, SM_POSITION, x);
        for (long p = 0; p < particles_of(engine); p++)
            for (int d = 0; d < 3; d++) assert_true(isfinite(x[p][d]));
        sm_free_all(x, rest, particle);
        sm_cut_free(&cut);
        type->destroy(engine);
        scene_free(&scene);
    }
}

/* A beam held at both ends and cut through between them: each end stays with its piece, which sags
 * as a cantilever does. */
TEST(a_held_beam_is_cut)
{
    needs_solver();
    Scene scene = beam_create(4, 150);
    SmEngine *engine;
    SmCut cut;
    scene.params.gravity[1] = -0.5;
    scene.params.damping = 0.2;
    scene.params.strain_limit = INFINITY;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    sm_cut_init(&cut, 0.5);
    double(*rest)[3] = field(engine, SM_REST);
    long *end[2], held[2] = {0};
    for (int k = 0; k < 2; k++) {
        end[k] = sm_alloc((size_t)particles_of(engine), sizeof(long));
        for (long p = 0; p < particles_of(engine); p++)
            if (k ? rest[p][0] > 3.8 : rest[p][0] < 0.2) end[k][held[k]++] = p;
    }
    static const double still[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    SmHandle handle[2] = {{.count = held[0], .particle = end[0]},
                          {.count = held[1], .particle = end[1]}};
    for (int k = 0; k < 2; k++) memcpy(handle[k].pose, still, sizeof still);
    SmBoundary boundary = {.handle_count = 2, .handle = handle};
    for (int step = 0; step < 150; step++) {
        if (step >= 20 && step < 32) cut_on_further(engine, &cut, 0.1 * (step - 20));
        type->bound(engine, &boundary);
        type->step(engine, NULL);
    }
    double(*x)[3] = field(engine, SM_POSITION);
    for (long p = 0; p < particles_of(engine); p++) {
        double from = rest[p][0] < 1.93 ? rest[p][0] : 4 - rest[p][0];
        double wanted = cantilever_sag(500, rest[p][0] < 1.93 ? 1.93 : 2.07, from);
        assert_true(fabs(x[p][1] - rest[p][1] + wanted) < 0.01 + 0.1 * wanted);
    }
    for (int k = 0; k < 2; k++) {
        for (long n = 0; n < held[k]; n++) /* between points that are bound */
            assert_true(sm_square_between(x[end[k][n]], rest[end[k][n]]) < 0.02 * 0.02);
        free(end[k]);
    }
    free(x);
    free(rest);
    sm_cut_free(&cut);
    type->destroy(engine);
    scene_free(&scene);
}

/* A body that was not made for it is not cut. */
TEST(what_is_not_cuttable)
{
    needs_solver();
    Scene scene = beam_create(2, 60);
    SmEngine *engine;
    SmError error = {0};
    SmCut cut;
    assert_int_equal(create(&scene, &engine, NULL), SM_OK);
    sm_cut_init(&cut, 0.5);
    assert_int_equal(cut_beam(engine, &cut, 1, 1.5, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "strain_limit of INFINITY"));
    sm_cut_free(&cut);
    type->destroy(engine);
    scene_free(&scene);
}

TEST(what_is_refused)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *engine;
    SmError error = {0};
    SmEngineParams sound = scene.params;
    scene.params.instances = 2;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "one body"));
    scene.params = sound;
    scene.params.collide.self = true;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    scene.params = sound;
    scene.params.strain_limit = 2;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    RefStored stored = {.nodes = 0};
    scene.params.strain_limit = INFINITY;
    scene.options.stored = &stored;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "cannot be cut"));
    scene.options.stored = NULL;
    scene.params = sound;
    scene.params.damping = 1;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    scene.params = sound;
    scene.options.material.young = 0;
    assert_int_equal(create(&scene, &engine, &error), SM_USAGE);
    scene.options.material.young = 1;
    scene.options.modes = 5000;
    assert_int_equal(create(&scene, &engine, &error), SM_USAGE);
    scene.options.modes = 0;
    scene.params.meshless = NULL;
    assert_int_equal(type->create(&scene.voxels, &scene.params, &engine, &error), SM_INPUT);
    scene_free(&scene);
}

/* A plate 50 times as wide as it is thick, whose sides 12,000 points do not tell apart. */
TEST(a_thin_mesh_gets_more_points)
{
    Scene scene = beam_create(1, 0);
    SmError error = {0};
    RefMpu mpu;
    double gradient[3];
    for (int n = 0; n < 8; n++) scene.mesh.position[n][1] *= 0.02;
    RefMeshlessOptions options = {.mesh = &scene.mesh};
    if (ref_meshless_field(&options, &mpu, &error)) fail_msg("%s", error.text);
    RefField thin = ref_mpu_field(&mpu);
    assert_true(thin.at(&mpu, (double[]){0.5, 0.01, 0.5}, gradient) < 0);
    assert_true(thin.at(&mpu, (double[]){0.5, 0.04, 0.5}, gradient) > 0);
    assert_in_range(mpu.points.count, 20000, 30000);
    ref_mpu_free(&mpu);
    options.points = REF_MESHLESS_POINTS;
    assert_int_equal(ref_meshless_field(&options, &mpu, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "take 24000 (run --points"));
    scene_free(&scene);
}
