/* A blade through bodies at rest, deformed, moving and nowhere near. */
#include "blade.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "error.h"
#include "mesh.h"
#include "test_draw.h"
#include "vector.h"

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

/* Moves the body to A X + b + bend sin(X1 / 3) e0. */
static void deform(Body *body, const double A[9], const double b[3], double bend)
{
    for (int k = 0; k < NODES; k++) {
        const double *X = body->rest[k];
        memcpy(body->F[k], A, sizeof body->F[k]);
        body->F[k][1] += bend / 3 * cos(X[1] / 3);
        for (int d = 0; d < 3; d++)
            body->position[k][d] = A[3 * d] * X[0] + A[3 * d + 1] * X[1] + A[3 * d + 2] * X[2] +
                                   b[d] + (d == 0 ? bend * sin(X[1] / 3) : 0);
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

static double area(const SmCut *cut)
{
    double sum = 0;
    for (long t = 0; t < cut->triangles; t++) {
        const double *p = cut->vertex[cut->triangle[t][0]], *q = cut->vertex[cut->triangle[t][1]];
        const double *r = cut->vertex[cut->triangle[t][2]];
        double u[3], v[3], normal[3];
        for (int d = 0; d < 3; d++) {
            u[d] = q[d] - p[d];
            v[d] = r[d] - p[d];
        }
        sm_cross(u, v, normal);
        sum += 0.5 * sqrt(sm_dot(normal, normal));
    }
    return sum;
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

/* A B = 1 */
static void invert(const double A[9], double B[9])
{
    double row[3][3], cofactor[3][3];
    memcpy(row, A, sizeof row);
    for (int i = 0; i < 3; i++) sm_cross(row[(i + 1) % 3], row[(i + 2) % 3], cofactor[i]);
    double determinant = sm_dot(row[0], cofactor[0]);
    for (int i = 0; i < 9; i++) B[i] = cofactor[i % 3][i / 3] / determinant;
}

static void what_it_sweeps_over_is_cut_where_it_was_at_rest(void **state)
{
    (void)state;
    Body *body = body_at_rest();
    for (int trial = 0; trial < 20; trial++) {
        double A[9], B[9], shift[3], from[2][3], to[2][3], end[4][3];
        for (int i = 0; i < 9; i++) A[i] = (i % 4 == 0) + (trial ? uniform(-0.3, 0.3) : 0);
        for (int d = 0; d < 3; d++) shift[d] = trial ? uniform(-20, 20) : 0;
        deform(body, A, shift, 0);
        invert(A, B);
        for (int n = 0; n < 4; n++) { /* within the body at rest, and there now */
            double X[3] = {n % 2 ? 8 : 2, n / 2 ? 8 : 2, uniform(4, 6)};
            for (int d = 0; d < 3; d++)
                end[n][d] = A[3 * d] * X[0] + A[3 * d + 1] * X[1] + A[3 * d + 2] * X[2] + shift[d];
        }
        memcpy(from, end, sizeof from);
        memcpy(to, end + 2, sizeof to);
        SmCarriers c = carriers(body);
        SmBlade blade;
        SmCut cut;
        sm_blade_init(&blade);
        sm_cut_init(&cut, 2);
        assert_int_equal(sm_blade_sweep(&blade, from[0], from[1], &c, &cut), 0);
        assert_true(sm_blade_sweep(&blade, to[0], to[1], &c, &cut) > 20);
        assert_disc(&cut);
        double least[3] = {99, 99, 99}, most[3] = {0};
        for (long v = 0; v < cut.vertices; v++)
            for (int d = 0; d < 3; d++) {
                least[d] = fmin(least[d], cut.vertex[v][d]);
                most[d] = fmax(most[d], cut.vertex[v][d]);
            }
        for (int d = 0; d < 2; d++) {
            assert_true(fabs(least[d] - 2) < 1e-9);
            assert_true(fabs(most[d] - 8) < 1e-9);
        }
        assert_true(area(&cut) > 36 - 1e-9 && area(&cut) < 40);
        sm_cut_free(&cut);
        sm_blade_free(&blade);
    }
    free(body);
}

/* The body turns, bends and drifts while the blade goes through it in many small frames: one sheet
 * without a gap, and nodes on its two sides are parted. */
static void frames_join_on_however_the_body_moves(void **state)
{
    (void)state;
    Body *body = body_at_rest();
    SmBlade blade;
    SmCut cut;
    sm_blade_init(&blade);
    sm_cut_init(&cut, 2);
    enum { FRAMES = 60 };
    for (int f = 0; f <= FRAMES; f++) {
        double turn = 0.02 * f, c = cos(turn), s = sin(turn), shift[3] = {0.1 * f, 0, -0.05 * f};
        const double A[9] = {c, 0, s, 0, 1, 0, -s, 0, c};
        deform(body, A, shift, 0.01 * f);
        double end[2][3];
        for (int n = 0; n < 2; n++) { /* follows the turning middle: goes along y, at z = 5 */
            double X[3] = {n ? 12 : -2, -2 + 14.0 * f / FRAMES, 5};
            for (int d = 0; d < 3; d++)
                end[n][d] = A[3 * d] * X[0] + A[3 * d + 1] * X[1] + A[3 * d + 2] * X[2] + shift[d];
        }
        SmCarriers all = carriers(body);
        sm_blade_sweep(&blade, end[0], end[1], &all, &cut);
    }
    assert_disc(&cut);
    for (int k = 0; k < NODES; k++) {
        double up[3] = {body->rest[k][0] + 0.013, body->rest[k][1] + 0.007, body->rest[k][2] + 1};
        double z = body->rest[k][2];
        if (z < 3 || z > 6) assert_false(sm_cut_crosses(&cut, 0, body->rest[k], up));
    }
    long crossed = 0;
    for (int y = 0; y <= 10; y++)
        for (int x = 0; x <= 10; x++)
            crossed += sm_cut_crosses(&cut, 0, (double[3]){x + 0.01, y + 0.02, 3},
                                      (double[3]){x + 0.01, y + 0.02, 7});
    assert_int_equal(crossed, 121);
    sm_cut_free(&cut);
    sm_blade_free(&blade);
    free(body);
}

/* The blade stands in the world and the body goes through it. */
static void a_body_moving_through_a_blade_is_cut(void **state)
{
    (void)state;
    Body *body = body_at_rest();
    SmBlade blade;
    SmCut cut;
    sm_blade_init(&blade);
    sm_cut_init(&cut, 2);
    for (int f = 0; f <= 40; f++) {
        deform(body, identity, (const double[3]){0, 8 - 0.3 * f, 0}, 0);
        SmCarriers c = carriers(body);
        sm_blade_sweep(&blade, (double[3]){3, 0, 5}, (double[3]){7, 0, 5}, &c, &cut);
    }
    assert_disc(&cut);
    for (int y = 1; y < 3; y++)
        assert_true(sm_cut_crosses(&cut, 0, (double[3]){5.1, y + 0.1, 4.5},
                                   (double[3]){5.1, y + 0.1, 5.5}));
    sm_cut_free(&cut);
    sm_blade_free(&blade);
    free(body);
}

/* Far away, standing still, of no length, lifted and set down elsewhere, in and out and in again.
 */
static void what_is_not_swept_is_not_cut(void **state)
{
    (void)state;
    Body *body = body_at_rest();
    SmCarriers c = carriers(body);
    SmBlade blade;
    SmCut cut;
    sm_blade_init(&blade);
    sm_cut_init(&cut, 2);
    for (int f = 0; f < 10; f++)
        assert_int_equal(
            sm_blade_sweep(&blade, (double[3]){0, f - 5, 20}, (double[3]){9, f, 30}, &c, &cut), 0);
    sm_blade_lift(&blade);
    for (int f = 0; f < 10; f++)
        assert_int_equal(
            sm_blade_sweep(&blade, (double[3]){2, 5, 5 + 0.04 * f}, (double[3]){8, 5, 5}, &c, &cut),
            0);
    assert_true(sm_blade_sweep(&blade, (double[3]){2, 5, 5.7}, (double[3]){8, 5, 5}, &c, &cut) > 0);
    sm_blade_lift(&blade);
    long before = cut.triangles;
    for (int f = 0; f < 20; f++)
        sm_blade_sweep(&blade, (double[3]){f, 5, 5}, (double[3]){f, 5, 5}, &c, &cut);
    assert_int_equal(cut.triangles, before); /* a point sweeps over no area */
    for (int f = 0; f < 3; f++) {
        sm_blade_sweep(&blade, (double[3]){2, 20, 3}, (double[3]){8, 20, 3}, &c, &cut);
        before = cut.triangles;
        assert_true(sm_blade_sweep(&blade, (double[3]){2, 5, 3}, (double[3]){8, 5, 3}, &c, &cut) >
                    0);
        assert_true(cut.triangles > before);
    }
    sm_cut_free(&cut);
    sm_blade_free(&blade);
    free(body);
}

/* Back the way it came it cuts nothing, and nothing twice when it comes again; aside it does. */
static void a_blade_that_is_drawn_back_waits(void **state)
{
    (void)state;
    static const struct {
        double y, z;
        bool cuts;
    } way[] = {{-3, 5, false}, {2, 5, true}, {4, 5, true},    {1, 5, false}, {3.5, 5.1, false},
               {0, 5, false},  {6, 5, true}, {5.4, 5, false}, {5, 7, true}};
    Body *body = body_at_rest();
    SmCarriers c = carriers(body);
    SmBlade blade;
    SmCut cut;
    sm_blade_init(&blade);
    sm_cut_init(&cut, 2);
    for (size_t i = 0; i < sizeof way / sizeof *way; i++) {
        long added = sm_blade_sweep(&blade, (double[3]){3, way[i].y, way[i].z},
                                    (double[3]){7, way[i].y, way[i].z}, &c, &cut);
        if ((added > 0) != way[i].cuts) fail_msg("place %zu: %ld triangles", i, added);
    }
    assert_disc(&cut);
    sm_cut_free(&cut);
    sm_blade_free(&blade);
    free(body);
}

/* Collapsed, turned inside out, nowhere: whatever comes is finite and short. */
static void broken_bodies_do_no_harm(void **state)
{
    (void)state;
    Body *body = body_at_rest();
    SmBlade blade;
    SmCut cut;
    sm_blade_init(&blade);
    sm_cut_init(&cut, 2);
    for (int f = 0; f < 60; f++) {
        double A[9];
        for (int i = 0; i < 9; i++) A[i] = f % 3 ? uniform(-2, 2) : 0;
        deform(body, A, origin, uniform(-3, 3));
        for (int n = 0; n < 30 && f % 5 == 0; n++)
            body->position[draw() % NODES][draw() % 3] = n % 2 ? NAN : INFINITY;
        for (int n = 0; n < 30 && f % 5 == 1; n++) body->F[draw() % NODES][draw() % 9] = NAN;
        double end[2][3];
        for (int i = 0; i < 6; i++) end[i / 3][i % 3] = uniform(-10, 20);
        SmCarriers c = carriers(body);
        sm_blade_sweep(&blade, end[0], end[1], &c, &cut);
    }
    for (long t = 0; t < cut.triangles; t++)
        for (int i = 0; i < 3; i++) {
            const double *p = cut.vertex[cut.triangle[t][i]];
            const double *q = cut.vertex[cut.triangle[t][(i + 1) % 3]];
            double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
            assert_true(sm_dot(d, d) <= 16 * (1 + 1e-12));
        }
    sm_cut_free(&cut);
    sm_blade_free(&blade);
    free(body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_it_sweeps_over_is_cut_where_it_was_at_rest),
        cmocka_unit_test(frames_join_on_however_the_body_moves),
        cmocka_unit_test(a_body_moving_through_a_blade_is_cut),
        cmocka_unit_test(what_is_not_swept_is_not_cut),
        cmocka_unit_test(a_blade_that_is_drawn_back_waits),
        cmocka_unit_test(broken_bodies_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
