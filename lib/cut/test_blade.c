/* A blade through bodies at rest, deformed, moving and nowhere near. */
#include "blade.h"

#include "../error.h"
#include "../mesh/mesh.h"
#include "../test_frame.h"
#include "../test_random.h"
#include "../vector.h"
#include "test_area.h"

static unsigned seed = 1;

enum { SIDE = 11, NODES = SIDE * SIDE * SIDE };

/* A cube of nodes, one cell apart, from 0 to 10. */
typedef struct {
    double rest[NODES][3], position[NODES][3], F[NODES][9];
} Body;

static SmCarriers carriers(const Body *body)
{
    return (SmCarriers){.nodes = NODES,
                        .rest = body->rest,
                        .position = (const double(*)[3])body->position,
                        .F = (const double(*)[9])body->F,
                        .cell = 1,
                        .reach = 3};
}

/* Where A X + b takes X. */
static void carry(const double A[9], const double b[3], const double X[3], double to[3])
{
    for (int d = 0; d < 3; d++)
        to[d] = A[3 * d] * X[0] + A[3 * d + 1] * X[1] + A[3 * d + 2] * X[2] + b[d];
}

/* Moves the body to A X + b + bend sin(X1 / 3) e0. */
static void deform(Body *body, const double A[9], const double b[3], double bend)
{
    for (int k = 0; k < NODES; k++) {
        const double *X = body->rest[k];
        memcpy(body->F[k], A, sizeof body->F[k]);
        body->F[k][1] += bend / 3 * cos(X[1] / 3);
        carry(A, b, X, body->position[k]);
        body->position[k][0] += bend * sin(X[1] / 3);
    }
}

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, origin[3];

static Body *body_at_rest(void)
{
    Body *body = sm_alloc(1, sizeof *body);
    for (int k = 0; k < NODES; k++) {
        body->rest[k][0] = k % SIDE;
        body->rest[k][1] = k / SIDE % SIDE;
        body->rest[k][2] = k / SIDE / SIDE;
    }
    deform(body, identity, origin, 0);
    return body;
}

/* A blade, what it has cut, and what it goes through. */
typedef struct {
    Body *body;
    SmBlade blade;
    SmCut cut;
} Cutting;

static void start_cutting(Cutting *t)
{
    t->body = body_at_rest();
    sm_blade_init(&t->blade);
    sm_cut_init(&t->cut, 2);
}

static void stop_cutting(Cutting *t)
{
    sm_cut_free(&t->cut);
    sm_blade_free(&t->blade);
    free(t->body);
}

static long sweep(Cutting *t, const double base[3], const double tip[3])
{
    SmCarriers c = carriers(t->body);
    return sm_blade_sweep(&t->blade, base, tip, &c, &t->cut);
}

/* The sheet is in one piece, without holes: a disc. */
static void assert_disc(const SmCut *cut)
{
    SmMesh mesh = {cut->vertices, cut->triangles, cut->vertex, cut->triangle};
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_int_equal(info.components, 1);
    assert_int_equal(info.nonmanifold_edges, 0);
    assert_int_equal(info.flipped_edges, 0);
    long edges = (3 * cut->triangles + info.open_edges) / 2;
    assert_int_equal(cut->vertices - edges + cut->triangles, 1);
}

TEST(what_it_sweeps_over_is_cut_where_it_was_at_rest)
{
    for (int trial = 0; trial < 20; trial++) {
        Cutting t;
        double A[9], shift[3], end[4][3];
        for (int i = 0; i < 9; i++)
            A[i] = (i % 4 == 0) + (trial ? random_between(&seed, -0.3, 0.3) : 0);
        for (int d = 0; d < 3; d++) shift[d] = trial ? random_between(&seed, -20, 20) : 0;
        start_cutting(&t);
        deform(t.body, A, shift, 0);
        for (int n = 0; n < 4; n++) { /* within the body at rest, and there now */
            double X[3] = {n % 2 ? 8 : 2, n / 2 ? 8 : 2, random_between(&seed, 4, 6)};
            carry(A, shift, X, end[n]);
        }
        assert_int_equal(sweep(&t, end[0], end[1]), 0);
        assert_true(sweep(&t, end[2], end[3]) > 20);
        assert_disc(&t.cut);
        double least[3] = {99, 99, 99}, most[3] = {0};
        for (long v = 0; v < t.cut.vertices; v++)
            for (int d = 0; d < 3; d++) {
                least[d] = fmin(least[d], t.cut.vertex[v][d]);
                most[d] = fmax(most[d], t.cut.vertex[v][d]);
            }
        for (int d = 0; d < 2; d++) {
            assert_true(fabs(least[d] - 2) < 1e-9);
            assert_true(fabs(most[d] - 8) < 1e-9);
        }
        double area = cut_area(&t.cut, 0);
        assert_true(area > 36 - 1e-9 && area < 40);
        stop_cutting(&t);
    }
}

/* The body turns, bends and drifts while the blade goes through it in many small frames: one sheet
 * without a gap, and nodes on its two sides are parted. */
TEST(frames_join_on_however_the_body_moves)
{
    Cutting t;
    start_cutting(&t);
    enum { FRAMES = 60 };
    for (int f = 0; f <= FRAMES; f++) {
        double turn = 0.02 * f, c = cos(turn), s = sin(turn), shift[3] = {0.1 * f, 0, -0.05 * f};
        const double A[9] = {c, 0, s, 0, 1, 0, -s, 0, c};
        deform(t.body, A, shift, 0.01 * f);
        double end[2][3];
        for (int n = 0; n < 2; n++) { /* follows the turning middle: goes along y, at z = 5 */
            double X[3] = {n ? 12 : -2, -2 + 14.0 * f / FRAMES, 5};
            carry(A, shift, X, end[n]);
        }
        sweep(&t, end[0], end[1]);
    }
    assert_disc(&t.cut);
    for (int k = 0; k < NODES; k++) {
        double up[3] = {t.body->rest[k][0] + 0.013, t.body->rest[k][1] + 0.007,
                        t.body->rest[k][2] + 1};
        double z = t.body->rest[k][2];
        if (z < 3 || z > 6) assert_false(sm_cut_crosses(&t.cut, 0, t.body->rest[k], up));
    }
    long crossed = 0;
    for (int y = 0; y <= 10; y++)
        for (int x = 0; x <= 10; x++)
            crossed += sm_cut_crosses(&t.cut, 0, (double[3]){x + 0.01, y + 0.02, 3},
                                      (double[3]){x + 0.01, y + 0.02, 7});
    assert_int_equal(crossed, 121);
    stop_cutting(&t);
}

/* The blade stands in the world and the body goes through it. */
TEST(a_body_moving_through_a_blade_is_cut)
{
    Cutting t;
    start_cutting(&t);
    for (int f = 0; f <= 40; f++) {
        deform(t.body, identity, (const double[3]){0, 8 - 0.3 * f, 0}, 0);
        sweep(&t, (double[3]){3, 0, 5}, (double[3]){7, 0, 5});
    }
    assert_disc(&t.cut);
    for (int y = 1; y < 3; y++)
        assert_true(sm_cut_crosses(&t.cut, 0, (double[3]){5.1, y + 0.1, 4.5},
                                   (double[3]){5.1, y + 0.1, 5.5}));
    stop_cutting(&t);
}

/* Far away, standing still, of no length, lifted and set down elsewhere, in and out and in again.
 */
TEST(what_is_not_swept_is_not_cut)
{
    Cutting t;
    start_cutting(&t);
    for (int f = 0; f < 10; f++)
        assert_int_equal(sweep(&t, (double[3]){0, f - 5, 20}, (double[3]){9, f, 30}), 0);
    sm_blade_lift(&t.blade);
    for (int f = 0; f < 10; f++)
        assert_int_equal(sweep(&t, (double[3]){2, 5, 5 + 0.04 * f}, (double[3]){8, 5, 5}), 0);
    assert_true(sweep(&t, (double[3]){2, 5, 5.7}, (double[3]){8, 5, 5}) > 0);
    sm_blade_lift(&t.blade);
    long before = t.cut.triangles;
    for (int f = 0; f < 20; f++) sweep(&t, (double[3]){f, 5, 5}, (double[3]){f, 5, 5});
    assert_int_equal(t.cut.triangles, before); /* a point sweeps over no area */
    for (int f = 0; f < 3; f++) {
        sweep(&t, (double[3]){2, 20, 3}, (double[3]){8, 20, 3});
        before = t.cut.triangles;
        assert_true(sweep(&t, (double[3]){2, 5, 3}, (double[3]){8, 5, 3}) > 0);
        assert_true(t.cut.triangles > before);
    }
    stop_cutting(&t);
}

/* Back the way it came it cuts nothing, and nothing twice when it comes again; aside it does. */
TEST(a_blade_that_is_drawn_back_waits)
{
    static const struct {
        double y, z;
        bool cuts;
    } way[] = {{-3, 5, false}, {2, 5, true}, {4, 5, true},    {1, 5, false}, {3.5, 5.1, false},
               {0, 5, false},  {6, 5, true}, {5.4, 5, false}, {5, 7, true}};
    Cutting t;
    start_cutting(&t);
    for (size_t i = 0; i < sizeof way / sizeof *way; i++) {
        long added =
            sweep(&t, (double[3]){3, way[i].y, way[i].z}, (double[3]){7, way[i].y, way[i].z});
        if ((added > 0) != way[i].cuts) fail_msg("place %zu: %ld triangles", i, added);
    }
    assert_disc(&t.cut);
    stop_cutting(&t);
}

/* Collapsed, turned inside out, nowhere: whatever comes is finite and short. */
TEST(broken_bodies_do_no_harm)
{
    Cutting t;
    start_cutting(&t);
    for (int f = 0; f < 60; f++) {
        double A[9];
        for (int i = 0; i < 9; i++) A[i] = f % 3 ? random_between(&seed, -2, 2) : 0;
        deform(t.body, A, origin, random_between(&seed, -3, 3));
        for (int n = 0; n < 30 && f % 5 == 0; n++)
            t.body->position[random_int(&seed, NODES)][random_int(&seed, 3)] =
                n % 2 ? NAN : INFINITY;
        for (int n = 0; n < 30 && f % 5 == 1; n++)
            t.body->F[random_int(&seed, NODES)][random_int(&seed, 9)] = NAN;
        double end[2][3];
        for (int i = 0; i < 6; i++) end[i / 3][i % 3] = random_between(&seed, -10, 20);
        sweep(&t, end[0], end[1]);
    }
    for (long k = 0; k < t.cut.triangles; k++)
        for (int i = 0; i < 3; i++) {
            const double *p = t.cut.vertex[t.cut.triangle[k][i]];
            const double *q = t.cut.vertex[t.cut.triangle[k][(i + 1) % 3]];
            double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
            assert_true(sm_dot(d, d) <= 16 * (1 + 1e-12));
        }
    stop_cutting(&t);
}
