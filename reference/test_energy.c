/* Energy in collisions, of both engines: it never grows. */
#include "../fastlsm/fastlsm.h"
#include "../lib/collide/collide.h"
#include "../lib/test_fields.h"
#include "../lib/test_frame.h"
#include "../octree/engine.h"
#include "svd_polar.h"

typedef struct {
    double motion, elastic, gravity; /* J */
    double total;                    /* see below */
} Energy;

typedef struct {
    long count;                    /* of one body */
    double *mass, *share, *region; /* m_i; m_i / M_i; m_r */
    long *start;
    long *member;
} Body;

static void list_regions(const SmEngineType *type, SmEngine *engine, Body *body)
{
    long none;
    body->start = sm_alloc((size_t)body->count + 1, sizeof(long));
    for (long r = 0; r < body->count; r++)
        body->start[r + 1] = body->start[r] + type->region(engine, r, &none, 0);
    body->member = sm_alloc((size_t)body->start[body->count], sizeof(long));
    for (long r = 0; r < body->count; r++)
        type->region(engine, r, body->member + body->start[r], body->start[r + 1] - body->start[r]);
}

static void weights(const SmEngineType *type, SmEngine *engine, Body *body)
{
    size_t count = (size_t)body->count;
    double *reach = sm_alloc(count, sizeof(double));
    body->mass = sm_alloc(count, sizeof(double));
    body->share = sm_alloc(count, sizeof(double));
    body->region = sm_alloc(count, sizeof(double));
    type->masses(engine, body->mass);
    for (long r = 0; r < body->count; r++) {
        body->region[r] = type->weighs_regions ? body->mass[r] : 1;
        for (long k = body->start[r]; k < body->start[r + 1]; k++)
            reach[body->member[k]] += body->region[r];
    }
    for (size_t i = 0; i < count; i++) body->share[i] = body->mass[i] / reach[i];
    free(reach);
}

/* sum over a region of share |x - T x0|^2 / 2. */
static double misfit(const Body *body, long r, const double (*x0)[3], const double (*x)[3])
{
    double M = 0, c[3] = {0}, c0[3] = {0}, A[9] = {0}, R[9], sum = 0;
    for (long k = body->start[r]; k < body->start[r + 1]; k++) {
        long i = body->member[k];
        M += body->share[i];
        for (int d = 0; d < 3; d++) {
            c[d] += body->share[i] * x[i][d];
            c0[d] += body->share[i] * x0[i][d];
        }
    }
    for (int d = 0; d < 3; d++) {
        c[d] /= M;
        c0[d] /= M;
    }
    for (long k = body->start[r]; k < body->start[r + 1]; k++) {
        long i = body->member[k];
        for (int a = 0; a < 9; a++)
            A[a] += body->share[i] * (x[i][a / 3] - c[a / 3]) * (x0[i][a % 3] - c0[a % 3]);
    }
    ref_polar(A, NULL, R);
    for (long k = body->start[r]; k < body->start[r + 1]; k++) {
        long i = body->member[k];
        for (int d = 0; d < 3; d++) {
            double off = x[i][d] - c[d];
            for (int b = 0; b < 3; b++) off -= R[3 * d + b] * (x0[i][b] - c0[b]);
            sum += 0.5 * body->share[i] * off * off;
        }
    }
    return sum;
}

static void add_body(const Body *body, const SmEngineParams *params, const double (*x0)[3],
                     const double (*x)[3], const double (*v)[3], const double (*g)[3],
                     Energy *energy)
{
    double h = params->h;
    for (long r = 0; r < body->count; r++)
        energy->elastic += body->region[r] * misfit(body, r, x0, x) / (h * h);
    for (long i = 0; i < body->count; i++)
        for (int d = 0; d < 3; d++) {
            double m = body->mass[i], kick = (g[i][d] - x[i][d]) / h + h * params->gravity[d];
            energy->motion += 0.5 * m * v[i][d] * v[i][d];
            energy->gravity -= m * params->gravity[d] * x[i][d];
            energy->total += 0.5 * m * v[i][d] * (v[i][d] + kick);
        }
}

/* Shape matching pulls with m_i (g_i - x_i) / h^2 (fastlsm eq. 1). That is the gradient of
 *     V = sum over regions r of m_r sum over i in R_r of m_i / M_i |x_i - T_r x0_i|^2 / 2 h^2,
 * M_i the sum of m_r over the regions that hold i (fastlsm: all m_r are 1; octree: its conserving
 * weights), since T_r is what makes its terms least. The integrator (fastlsm eqs. 1, 2) is
 * symplectic Euler: velocities are those half a step back, and what it keeps, exactly while the
 * force f / m is linear, is not motion + V but
 *     total = sum m v . (v + h f / m) / 2 + V - sum m gravity . x
 * which is `motion` at the mean of the velocities half a step back and ahead, less |h f|^2 / 8m,
 * and V. No handles, plasticity or plain weights. O(members of all regions). */
static Energy total_energy(const SmEngineType *type, SmEngine *engine, const SmEngineParams *params)
{
    SmCounts counts;
    Energy energy = {0};
    type->count(engine, &counts);
    long bodies = params->instances > 1 ? params->instances : 1;
    size_t all = (size_t)counts.particles;
    double(*field[4])[3];
    static const SmField fields[4] = {SM_REST, SM_POSITION, SM_VELOCITY, SM_GOAL};
    type->goals(engine);
    for (int f = 0; f < 4; f++) {
        field[f] = sm_alloc(all, sizeof *field[f]);
        type->get(engine, fields[f], field[f]);
    }
    Body body = {.count = counts.particles / bodies};
    list_regions(type, engine, &body);
    weights(type, engine, &body);
    for (long b = 0; b < bodies; b++) {
        long at = b * body.count;
        add_body(&body, params, (const double(*)[3])(field[0] + at),
                 (const double(*)[3])(field[1] + at), (const double(*)[3])(field[2] + at),
                 (const double(*)[3])(field[3] + at), &energy);
    }
    energy.total += energy.elastic + energy.gravity;
    for (int f = 0; f < 4; f++) free(field[f]);
    free(body.mass);
    free(body.share);
    free(body.region);
    free(body.start);
    free(body.member);
    return energy;
}

enum { STEPS = TEST_FIGURES ? 10000 : 1000, MOST = 8 };

static const SmEngineType *const engines[] = {&fastlsm_engine_f64, &octree_engine_f64,
                                              &fastlsm_engine_f32, &octree_engine_f32};
enum { ENGINES = sizeof engines / sizeof engines[0] };

/* Regular leaves of one finest cell, so that both engines have the same shapes. */
static const OctOptions finest = {
    .sampling = {.levels = 1, .criteria_count = 1, .criteria = {{.kind = OCT_UNIFORM, .level = 1}}},
    .width = {.edges = 1}};

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    SmEngineParams params;
    SmVoxels voxels;
    double pose[MOST][3][4];
    long n; /* nodes of all bodies */
    double (*x)[3], (*v)[3];
    double start; /* energy */
} Trial;

static void begin(Trial *t, const SmEngineType *type, long bodies)
{
    *t = (Trial){.type = type};
    t->params = (SmEngineParams){.w = 1,
                                 .h = 0.01,
                                 .threads = 1,
                                 .instances = bodies,
                                 .octree = &finest,
                                 .collide = {.self = true, .bodies = true}};
    for (int b = 0; b < MOST; b++)
        for (int d = 0; d < 3; d++) t->pose[b][d][d] = 1;
}

static void create(Trial *t)
{
    SmError error;
    SmCounts counts;
    t->params.instance_pose = (const double(*)[3][4])t->pose;
    if (t->type->create(&t->voxels, &t->params, &t->engine, &error)) fail_msg("%s", error.text);
    t->type->count(t->engine, &counts);
    t->n = counts.particles;
    t->x = triples(t->n);
    t->v = triples(t->n);
    t->type->get(t->engine, SM_REST, t->x);
}

static void end(Trial *t)
{
    t->type->destroy(t->engine);
    sm_voxels_free(&t->voxels);
    free(t->x);
    free(t->v);
}

/* Rounding of all steps together, as a share of the start. */
static double rounding(const Trial *t)
{
    return strcmp(t->type->precision, "double") ? 1e-4 : 1e-10;
}

/* Steps, and holds the energy to that of the start; returns contacts met. `swing` is how far what
 * the integrator keeps only while forces are linear goes up and down (total_energy()), as a share.
 */
static long run(Trial *t, long steps, double swing, Energy *last)
{
    SmCounts counts;
    long contacts = 0;
    if (!(t->start > 0)) t->start = total_energy(t->type, t->engine, &t->params).total;
    for (long s = 1; s <= steps; s++) {
        t->type->step(t->engine, NULL);
        t->type->count(t->engine, &counts);
        contacts += counts.contacts;
        if (s % 50) continue;
        *last = total_energy(t->type, t->engine, &t->params);
        assert_true(last->total <= (1 + swing + rounding(t)) * t->start);
    }
    t->type->get(t->engine, SM_POSITION, t->x);
    return contacts;
}

/* What the energy is by itself: kept by a body that swings and turns. */
TEST(test_kept)
{
    for (int e = 0; e < ENGINES; e++) {
        Trial t;
        Energy last;
        begin(&t, engines[e], 1);
        sm_voxels_block(&t.voxels, 6, 2, 2, 1);
        create(&t);
        for (long i = 0; i < t.n; i++) t.v[i][1] = 2 * t.x[i][0];
        t.type->set(t.engine, SM_VELOCITY, (const double(*)[3])t.v);
        double start = total_energy(t.type, t.engine, &t.params).total;
        assert_int_equal(run(&t, 500, 3e-3, &last), 0);
        assert_true(last.total > 0.98 * start && last.elastic > 1e-3 * start);
        end(&t);
    }
}

static void momentum(Trial *t, double p[3])
{
    double *m = sm_alloc((size_t)(t->n / t->params.instances), sizeof *m);
    t->type->masses(t->engine, m);
    t->type->get(t->engine, SM_VELOCITY, t->v);
    for (int d = 0; d < 3; d++) p[d] = 0;
    for (long i = 0; i < t->n; i++)
        for (int d = 0; d < 3; d++) p[d] += m[i % (t->n / t->params.instances)] * t->v[i][d];
    free(m);
}

/* Two blocks fly at each other, not quite in line, and apart again. */
TEST(test_head_on)
{
    for (int e = 0; e < ENGINES; e++) {
        Trial t;
        Energy last;
        double before[3], after[3];
        begin(&t, engines[e], 2);
        sm_voxels_block(&t.voxels, 3, 3, 3, 1);
        t.pose[1][0][3] = 6;
        t.pose[1][1][3] = 0.7;
        t.pose[1][2][3] = 0.4;
        create(&t);
        for (long i = 0; i < t.n; i++) t.v[i][0] = i < t.n / 2 ? 12 : -12;
        t.type->set(t.engine, SM_VELOCITY, (const double(*)[3])t.v);
        momentum(&t, before);
        assert_true(run(&t, 200, 0, &last) > 20); /* met, and apart again */
        momentum(&t, after);
        for (int d = 0; d < 3; d++)
            assert_float_equal(after[d], before[d], 12.0 * (double)t.n * rounding(&t));
        run(&t, STEPS - 200, 0, &last);
        assert_true(t.x[0][0] < -3 && t.x[t.n - 1][0] > 9); /* none went through the other */
        end(&t);
    }
}

/* The arms of a C clap together. */
TEST(test_fold)
{
    for (int e = 0; e < ENGINES; e++) {
        Trial t;
        Energy last;
        begin(&t, engines[e], 1);
        sm_voxels_init(&t.voxels, 10, 9, 2, 1);
        for (int i = 0; i < 10; i++)
            for (int j = 0; j < 9; j++)
                for (int k = 0; k < 2; k++)
                    if (i < 2 || j < 2 || j >= 7) sm_voxel_set(&t.voxels, i, j, k);
        sm_voxels_count(&t.voxels);
        create(&t);
        for (long i = 0; i < t.n; i++) t.v[i][1] = (t.x[i][1] > 4.5 ? -1.5 : 1.5) * t.x[i][0];
        t.type->set(t.engine, SM_VELOCITY, (const double(*)[3])t.v);
        long contacts = run(&t, STEPS, 1e-3, &last);
        assert_true(contacts > 20);
        end(&t);
    }
}

/* Blocks fall on each other and come to rest as a pile that stands. */
TEST(test_pile)
{
    static const SmObstacle ground = {
        .kind = SM_PLANE, .a = {0, -0.5, 0}, .b = {0, 1, 0}, .friction = 0.3};
    for (int e = 0; e < ENGINES; e++) {
        Trial t;
        Energy last;
        begin(&t, engines[e], 3);
        sm_voxels_block(&t.voxels, 4, 3, 4, 1);
        t.params.gravity[1] = -4;
        t.params.damping = 0.02;
        t.params.collide.friction = 0.3;
        for (int b = 0; b < 3; b++) t.pose[b][1][3] = 3.7 * b;
        create(&t);
        t.type->bound(t.engine, &(SmBoundary){0, NULL, 1, &ground});
        assert_true(run(&t, STEPS, 0, &last) > 1000);
        for (int b = 1; b < 3; b++) { /* the upper ones may slide off, but not in */
            double off[3] = {0};
            for (long i = 0; i < t.n / 3; i++)
                for (int d = 0; d < 3; d++)
                    off[d] += t.x[b * t.n / 3 + i][d] - t.x[(b - 1) * t.n / 3 + i][d];
            double apart = sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
            assert_true(apart > 2.75 * (double)(t.n / 3));
        }
        end(&t);
    }
}

#define FASTEST (SM_COLLIDE_SPEED / 0.01) /* cells a second, against what is one cell thick */

/* A plate one cell thick meets another that is held, flat on (turn 0) or with an edge. */
static void throw_at_plate(const SmEngineType *type, int w, int turn)
{
    Trial t;
    begin(&t, type, 2);
    t.params.w = w;
    sm_voxels_block(&t.voxels, 8, 8, 1, 1);
    memset(t.pose[1], 0, sizeof t.pose[1]);
    for (int d = 0; d < 3; d++) t.pose[1][(d + turn) % 3][d] = 1;
    for (int d = 0; d < 3; d++) t.pose[1][d][3] = 0.3;
    t.pose[1][2][3] = -10.4;
    create(&t);
    long half = t.n / 2, *held = sm_alloc((size_t)half, sizeof *held), near = 0;
    for (long i = 0; i < half; i++) held[i] = i;
    SmHandle handle = {.count = half, .particle = held, .pose = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    t.type->bound(t.engine, &(SmBoundary){1, &handle, 0, NULL});
    for (long i = half; i < t.n; i++) t.v[i][2] = FASTEST;
    t.type->set(t.engine, SM_VELOCITY, (const double(*)[3])t.v);
    for (int s = 0; s < 400; s++) {
        t.type->step(t.engine, NULL);
        t.type->get(t.engine, SM_POSITION, t.x);
        for (long i = half; i < t.n; i++) {
            double *x = t.x[i];
            if (x[0] > 0 && x[0] < 8 && x[1] > 0 && x[1] < 8) assert_true(x[2] < 1);
            near += x[2] > -1;
        }
    }
    assert_true(near > 0);
    free(held);
    end(&t);
}

TEST(test_plates)
{
    for (int e = 0; e < ENGINES; e++)
        for (int turn = 0; turn < 3; turn++) throw_at_plate(engines[e], 1 + turn, turn);
}

/* Obstacles one cell thick: a wall, a bar, a ball; the body comes to one side and stays there. */
TEST(test_obstacles)
{
    static const SmObstacle obstacle[3] = {
        {.kind = SM_BOX, .a = {-5e3, -5e3, 6}, .b = {5e3, 5e3, 7}},
        {.kind = SM_PLANE, .a = {0, 0, 6}, .b = {0, 0, -1}},
        {.kind = SM_SPHERE, .a = {1.5, 1.5, 56}, .radius = 50},
    };
    for (int e = 0; e < ENGINES; e++)
        for (int o = 0; o < 3; o++) {
            Trial t;
            Energy last;
            begin(&t, engines[e], 1);
            t.params.collide = (SmCollideParams){0};
            t.params.gravity[2] = 4;
            sm_voxels_block(&t.voxels, 3, 3, 3, 1);
            create(&t);
            for (long i = 0; i < t.n; i++) t.v[i][2] = o == 1 ? 10 * FASTEST : FASTEST;
            t.type->set(t.engine, SM_VELOCITY, (const double(*)[3])t.v);
            t.type->bound(t.engine, &(SmBoundary){0, NULL, 1, &obstacle[o]});
            for (int s = 0; s < 20; s++) {
                run(&t, STEPS / 20, 0, &last);
                for (long i = 0; i < t.n; i++)
                    assert_true(o == 2 ? hypot(hypot(t.x[i][0] - 1.5, t.x[i][1] - 1.5),
                                               t.x[i][2] - 56) > 49.5
                                       : t.x[i][2] < 6.5);
            }
            end(&t);
        }
}

/* A step gives the same bits for any number of threads. */
TEST(test_threads)
{
    for (int e = 0; e < ENGINES; e++) {
        double(*x[2])[3];
        long n = 0;
        for (int k = 0; k < 2; k++) {
            Trial t;
            Energy last;
            begin(&t, engines[e], 4);
            t.params.threads = k ? 3 : 1;
            sm_voxels_block(&t.voxels, 3, 3, 3, 1);
            for (int b = 0; b < 4; b++)
                for (int d = 0; d < 3; d++) t.pose[b][d][3] = 1.9 * b * (d == 1 ? 1 : 0.5);
            create(&t);
            for (long i = 0; i < t.n; i++) t.v[i][1] = -3.0 * (double)(i * 4 / t.n);
            t.type->set(t.engine, SM_VELOCITY, (const double(*)[3])t.v);
            assert_true(run(&t, 200, 1, &last) > 100);
            n = t.n;
            x[k] = t.x;
            t.x = NULL;
            end(&t);
        }
        assert_memory_equal(x[0], x[1], (size_t)n * sizeof *x[0]);
        free(x[0]);
        free(x[1]);
    }
}
