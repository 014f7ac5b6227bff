/* A shell beside FastLSM, asked natively: hands, knobs, what comes apart, and what is inside. */
#include <stdlib.h>
#include <string.h>

#include "../../lib/test_frame.h"
#include "../../lib/vector.h"
#include "../../reference/meshless/test_solver.h"
#include "../engines.h"
#include "inside.h"
#include "side.h"
#include "view.h"

#define BAR                                                                                        \
    "mesh = \"shape:bar\"; engine = \"shell\"; particles = 400;\n"                                 \
    "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.1, 1.0, 1.0]; }"

static const char still[] =
    BAR " );\ndamping = 0.02;\nmeshless = { young = 1.0e6; nodes = 150; thickness = 0.005; };\n";

/* It is bent until it has torn. */
static const char torn[] =
    BAR ",\n  { box_low = [0.9, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; axis = [0.0, 0.0, 1.0];\n"
        "    centre = [0.0, 0.06, 0.0]; amplitude = 1.0; period = 0.6; } );\n"
        "h = 0.002; steps_per_frame = 4;\n"
        "meshless = { young = 1.0e6; nodes = 200; covers = 4.5; thickness = 0.005; strength = "
        "3.0e4; };\n";

static int opened(const char *text, int keep)
{
    strcpy(view_room((int)strlen(text)), text);
    return view_open((int)strlen(text), keep);
}

static void open_scene(const char *text)
{
    if (opened(text, 0)) fail_msg("%s", view_message());
    for (int side = 0; side < VIEW_SIDES; side++) assert_string_equal(view_absent(side), "");
}

/* The text with `old` in place of `new`, which is as long. */
static const char *with(const char *text, const char *old, const char *new)
{
    static char other[2048];
    snprintf(other, sizeof other, "%s", text);
    assert_int_equal(strlen(old), strlen(new));
    memcpy(strstr(other, old), new, strlen(new));
    return other;
}

static void vertex(int side, long number, double point[3])
{
    view_surface(side);
    for (int d = 0; d < 3; d++) point[d] = view_points(side)[3 * number + d];
}

/* What a shell does not take leaves its side absent, and so it stays when a knob is turned. */
TEST(what_is_absent_stays_so)
{
    for (int keep = 0; keep < 2; keep++) {
        opened(BAR " );\nkick = 1.0;\nmeshless = { nodes = 150; };\n", keep);
        assert_string_not_equal(view_absent(1), "");
    }
}

/* In the middle of the bar's end that is free. */
static int end_of_bar(void)
{
    int found = 0;
    double least = INFINITY;
    for (int v = 0; v < view_vertices(1); v++) {
        double x[3];
        const double end[3] = {0.28, 0.06, 0};
        for (int d = 0; d < 3; d++) x[d] = view_points(1)[3 * v + d];
        if (sm_square_between(x, end) >= least) continue;
        least = sm_square_between(x, end);
        found = v;
    }
    return found;
}

static double mass_of(int side)
{
    const BenchRunner *runner = &view_side_of(side)->play.group[0].runner;
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass), sum = 0;
    runner->type->masses(runner->engine, mass);
    for (long p = 0; p < runner->count; p++) sum += mass[p];
    free(mass);
    return sum;
}

TEST(both_sides_weigh_what_the_shell_does)
{
    needs_solver();
    const double area = 4 * 0.56 * 0.12 + 2 * 0.12 * 0.12, wanted = 1000 * 0.005 * area;
    open_scene(still);
    for (int side = 0; side < VIEW_SIDES; side++) /* it has no sharp edges */
        if (!(mass_of(side) < wanted && mass_of(side) > 0.9 * wanted))
            fail_msg("side %d: %g kg, not %g", side, mass_of(side), wanted);
    assert_true(fabs(mass_of(0) / mass_of(1) - 1) < 1e-6);
    assert_string_equal(view_engine(1), "shell");
    assert_true(view_figure(1, VIEW_PIECES) == 1 && isnan(view_figure(0, VIEW_PIECES)));
}

/* What is grabbed goes with the hand on both sides, a stiffer shell goes on where it is, and it
 * comes back to rest. */
TEST(a_hand_pulls_a_shell)
{
    needs_solver();
    double rest[3], from[3], to[3];
    open_scene(still);
    double cell = view_figure(0, VIEW_CELL);
    int end = end_of_bar();
    vertex(1, end, rest);
    int grip = view_grab(1, end, cell);
    assert_true(grip >= 0);
    view_drag(grip, 0, cell, 0);
    for (int side = 0; side < VIEW_SIDES; side++) {
        double middle[3];
        memcpy(middle, view_grip(side, grip), sizeof middle);
        view_step(side, 100);
        const double *now = view_grip(side, grip);
        if (!(fabs(now[1] - middle[1] - cell) < 0.05 * cell))
            fail_msg("side %d: %g cells", side, (now[1] - middle[1]) / cell);
    }
    vertex(1, end, from);
    assert_true(fabs(from[1] - rest[1] - cell) < 0.1 * cell);
    assert_int_equal(opened(with(still, "young = 1.0e6", "young = 2.0e6"), 1), 0);
    vertex(1, end, to);
    assert_true(view_figure(1, VIEW_STEPS) == 100);
    if (!(sm_square_between(from, to) < 1e-8 * cell * cell))
        fail_msg("off by %g cells", sqrt(sm_square_between(from, to)) / cell);
    assert_non_null(view_grip(1, grip));
    view_release(grip);
    view_step(1, 1500);
    vertex(1, end, to);
    if (!(sm_square_between(rest, to) < 1e-4 * cell * cell))
        fail_msg("%g cells from rest", sqrt(sm_square_between(rest, to)) / cell);
}

/* With other nodes, or where it may break, it begins anew, and with it FastLSM. */
TEST(another_shell_begins_anew)
{
    needs_solver();
    const char *const other[] = {NULL, still, torn, torn};
    open_scene(still);
    for (int n = 0; n < 4; n++) {
        for (int side = 0; side < VIEW_SIDES; side++) view_step(side, 3);
        assert_int_equal(opened(other[n] ? other[n] : with(still, "nodes = 150", "nodes = 300"), 1),
                         0);
        for (int side = 0; side < VIEW_SIDES; side++)
            assert_true(view_figure(side, VIEW_STEPS) == 0 && view_figure(side, VIEW_TIME) == 0);
    }
}

/* How many pieces the triangles of side 1 make, whose inner sheet is the outer one's: the least
 * number of a vertex floods each. */
static long flooded(void)
{
    const int *corner = view_indices(1);
    size_t vertices = (size_t)view_vertices(1);
    int *least = sm_alloc(vertices, sizeof *least);
    bool *used = sm_alloc(vertices, sizeof *used);
    long pieces = 0;
    for (size_t v = 0; v < vertices; v++) least[v] = (int)v;
    for (bool changed = true; changed;) {
        changed = false;
        for (int c = 0; c < 3 * view_triangles(1); c++) {
            int *here = least + corner[c], *next = least + corner[c % 3 < 2 ? c + 1 : c - 2];
            changed = changed || *here != *next;
            *here = *next = *here < *next ? *here : *next;
        }
        for (size_t v = 0, inner = vertices / 2; v < inner; v++) {
            changed = changed || least[v] != least[inner + v];
            least[v] = least[inner + v] = least[v] < least[inner + v] ? least[v] : least[inner + v];
        }
    }
    for (int c = 0; c < 3 * view_triangles(1); c++) used[least[corner[c]]] = true;
    for (size_t v = 0; v < vertices; v++) pieces += used[v];
    free(least);
    free(used);
    return pieces;
}

/* What is drawn comes apart, and at rest it is the bar. */
TEST(a_shell_comes_apart)
{
    needs_solver();
    open_scene(torn);
    int first = view_surface(1);
    assert_true(view_figure(1, VIEW_PIECES) == 1);
    view_step(1, 40 * 4);
    assert_true(view_surface(1) != first);
    long pieces = (long)view_figure(1, VIEW_PIECES);
    print_message("%ld pieces\n", pieces);
    assert_true(pieces >= 2 && pieces == flooded());
    const float *rest = view_rest_points(1), *normal = view_rest_normals(1);
    const double low[3] = {-0.28, 0, -0.06}, high[3] = {0.28, 0.12, 0.06};
    for (long v = 0; v < view_vertices(1); v++)
        for (int d = 0; d < 3; d++) {
            assert_true(rest[3 * v + d] > low[d] - 1e-3 && rest[3 * v + d] < high[d] + 1e-3);
            assert_true(fabsf(normal[3 * v + d]) < 1.0001F);
            assert_true(isfinite(view_points(1)[3 * v + d]));
        }
    assert_non_null(strstr(view_not_comparable(), "other vertices"));
    int held = view_grab(1, end_of_bar(), view_figure(0, VIEW_CELL)); /* and it is pulled on */
    assert_true(held >= 0);
    view_drag(held, 0.1, 0.1, 0.1);
    view_step(1, 40);
    assert_true(isfinite(view_figure(1, VIEW_KINETIC)));
}

/* How far a place is from the nearest vertex that is drawn. */
static double off_surface(const float *place)
{
    double least = INFINITY;
    for (int v = 0; v < view_vertices(1); v++) {
        double square = 0;
        for (int d = 0; d < 3; d++) {
            double off = (double)place[d] - (double)view_points(1)[3 * v + d];
            square += off * off;
        }
        least = fmin(least, square);
    }
    return sqrt(least);
}

static void check_inside(void)
{
    const double area = 4 * 0.56 * 0.12 + 2 * 0.12 * 0.12, most = 0.02; /* squares are so wide */
    double sum = 0;
    view_surface(1);
    const float *node = view_particle_points(1), *cell = view_cell_frames(1);
    assert_true(view_particles(1) == (int)view_figure(1, VIEW_PARTICLES) && view_cells(1) > 100);
    for (int n = 0; n < view_particles(1); n++) assert_true(off_surface(node + 3 * n) < most);
    for (int c = 0; c < view_cells(1); c++, cell += VIEW_CELL_NUMBERS) {
        double half[3][3], across[3];
        for (int k = 0; k < 9; k++) half[k / 3][k % 3] = cell[3 + k];
        sm_cross(half[0], half[1], across);
        sum += 4 * sqrt(sm_dot(across, across));
        assert_true(off_surface(cell) < most);
        assert_true(fabs(sqrt(sm_dot(half[2], half[2])) - 0.0025) < 1e-6);
        assert_true(cell[VIEW_CELL_NUMBERS - 1] >= 0 && cell[VIEW_CELL_NUMBERS - 1] < 8);
    }
    if (!(fabs(sum / area - 1) < 0.15)) fail_msg("cells of %g m^2, not %g", sum, area);
}

TEST(nodes_and_cells_are_on_the_surface)
{
    needs_solver();
    open_scene(still);
    check_inside();
    int grip = view_grab(1, end_of_bar(), view_figure(0, VIEW_CELL));
    view_drag(grip, 0, 0.1, 0);
    view_step(1, 50);
    check_inside();
    for (int p = 0; p < view_particles(1); p += 7) {
        int count = view_mark(1, p), own = 0;
        for (int m = 0; m < count; m++) {
            own += view_members(1)[3 * m] == p;
            assert_true(m == 0 || view_members(1)[3 * m] > view_members(1)[3 * m - 3]);
        }
        if (!(count >= 6 && own == 1)) fail_msg("node %d: %d movers, %d", p, count, own);
        assert_true(isnan(view_goal(1)[0]) && view_mark_figure(1, VIEW_NODES) == 0);
    }
    assert_int_equal(view_mark(1, view_particles(1)), 0);
    assert_int_equal(view_mark(1, -1), 0);
    assert_string_equal(view_not_comparable(), "");
    assert_non_null(view_difference(1));
}

TEST_GROUP(NULL, NULL)
