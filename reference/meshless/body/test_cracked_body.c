/* Bodies with cracks: pieces, what moves them freely, and how they open. */
#include "../../../lib/test_frame.h"
#include "../../../lib/vector.h"
#include "../solve/modes.h"
#include "../test_beam.h"
#include "../test_cuts.h"
#include "cracked_body.h"

static const double size[3] = {1, 1, 3};

static const RefBodyOptions options = {.cell = 0.2,
                                       .basis = REF_MLS_LINEAR,
                                       .material = {.young = 1e7, .poisson = 0.3, .density = 1000}};

enum { SIDE = 20, SHOWN = 2 * SIDE * SIDE };

/* Points of both ends. */
static void end_points(double x[SHOWN][3])
{
    for (int n = 0; n < SHOWN; n++) {
        x[n][0] = (n % SIDE + 0.5) / SIDE;
        x[n][1] = (n / SIDE % SIDE + 0.5) / SIDE;
        x[n][2] = n < SIDE * SIDE ? 0 : size[2];
    }
}

/* The bar with the plane z = level cut from x = -0.5 to `front`. */
static RefBody cracked_bar(const RefBody *bar, double level, double front)
{
    RefBrick brick = {{0, 0, 0}, {size[0], size[1], size[2]}};
    RefField field = ref_field_brick(&brick);
    RefBody cracked;
    double x[SHOWN][3];
    SmError error = {0};
    SmCut cut;
    end_points(x);
    sm_cut_init(&cut, 0.5);
    cut_across(&cut, 2, level, -0.5, front, 5);
    if (ref_body_crack(bar, &cut, 0, &field, &steel, SHOWN, (const double(*)[3])x, &cracked,
                       &error) != SM_OK)
        fail_msg("%s", error.text);
    sm_cut_free(&cut);
    return cracked;
}

static double mass_of(const RefBody *body, int piece)
{
    double *mass = sm_alloc((size_t)body->nodes.count, sizeof *mass), sum = 0;
    ref_sparse_sums(&body->matrices.mass, mass);
    for (long n = 0; n < body->nodes.count; n++)
        if (piece < 0 || ref_body_piece(body, n) == piece) sum += mass[n];
    free(mass);
    return sum;
}

/* The elastic energy of a rigid motion of one piece, by what as large a motion that is none has. */
static double rigid_cost(const RefBody *body, int piece, int kind)
{
    size_t unknowns = 3 * (size_t)body->nodes.count;
    double *u = sm_alloc(unknowns, sizeof *u), *Ku = sm_alloc(unknowns, sizeof *Ku);
    double axis[3] = {kind % 3 == 0, kind % 3 == 1, kind % 3 == 2}, cost = 0, all = 0;
    for (long n = 0; n < body->nodes.count; n++) {
        if (ref_body_piece(body, n) != piece) continue;
        memcpy(u + 3 * n, axis, sizeof axis);
        if (kind >= 3) sm_cross(axis, body->nodes.position[n], u + 3 * n);
    }
    ref_sparse_apply(&body->matrices.stiffness, 1, u, Ku);
    for (size_t n = 0; n < unknowns; n++) {
        int at = body->matrices.stiffness.start[n];
        cost += u[n] * Ku[n];
        all += u[n] * u[n] * body->matrices.stiffness.value[at];
    }
    sm_free_all(u, Ku);
    return fabs(cost) / all;
}

/* How many of the lowest modes are at rest: their frequency is none beside the next one's. */
static int zero_modes(const RefBody *body)
{
    RefModes modes;
    SmError error = {0};
    if (ref_modes_find(&body->matrices, NULL, 16, &modes, &error) != SM_OK)
        fail_msg("%s", error.text);
    int zero = 0;
    while (zero < 16 && fabs(modes.lambda[zero]) < 1e-6 * modes.lambda[15]) zero++;
    ref_modes_free(&modes);
    return zero;
}

/* While it holds a bar has six modes at rest, when the crack is through twice as many, and its
 * pieces weigh what they are of it; rigid motions of a piece cost nothing; of cracks along octants
 * and through them. */
TEST(a_bar_holds_until_the_crack_is_through)
{
    needs_solver();
    RefBody bar = brick_body(size, &options);
    static const double level[3] = {1.4, 1.5, 1.27}, front[4] = {0.3, 0.57, 0.85, 1.1};
    for (int l = 0; l < 3; l++)
        for (int f = 0; f < 4; f++) {
            RefBody cracked = cracked_bar(&bar, level[l], front[f]);
            int pieces = front[f] > 1 ? 2 : 1;
            assert_int_equal(ref_body_pieces(&cracked), pieces);
            assert_int_equal(cracked.cracks->blind, 0);
            assert_int_equal(zero_modes(&cracked), 6 * pieces);
            for (int p = 0; p < pieces; p++)
                for (int kind = 0; kind < 6; kind++)
                    assert_true(rigid_cost(&cracked, p, kind) < 1e-10);
            assert_true(fabs(mass_of(&cracked, -1) - 3000) < 1e-8 * 3000);
            if (pieces == 2) {
                double off = fabs(mass_of(&cracked, 0) - 1000 * level[l]);
                assert_true(off < (l < 2 ? 1e-6 : 250 * options.cell)); /* half a point's way */
            }
            ref_body_free(&cracked);
        }
    ref_body_free(&bar);
}

/* Steps of a crack, or all of it at once: the matrices have the same bits. */
TEST(how_a_crack_came_does_not_matter)
{
    RefBrick brick = {{0, 0, 0}, {size[0], size[1], size[2]}};
    RefField field = ref_field_brick(&brick);
    RefBody bar = brick_body(size, &options), half, steps, once;
    SmCut cut;
    sm_cut_init(&cut, 0.5);
    cut_across(&cut, 2, 1.33, -0.5, 0.4, 3);
    assert_int_equal(ref_body_crack(&bar, &cut, 0, &field, &steel, 0, NULL, &half, NULL), SM_OK);
    long first = cut.triangles;
    cut_on(&cut, 2, 1.33, 0.4, 0.8, 2);
    assert_int_equal(ref_body_crack(&half, &cut, first, &field, &steel, 0, NULL, &steps, NULL),
                     SM_OK);
    assert_int_equal(ref_body_crack(&bar, &cut, 0, &field, &steel, 0, NULL, &once, NULL), SM_OK);
    const RefSparse *a = &steps.matrices.stiffness, *b = &once.matrices.stiffness;
    assert_int_equal(a->columns, b->columns);
    assert_memory_equal(a->start, b->start, ((size_t)a->columns + 1) * sizeof(int));
    assert_memory_equal(a->value, b->value, (size_t)a->start[a->columns] * sizeof(double));
    assert_true(half.matrices.stiffness.columns < a->columns);
    RefBody *all[] = {&bar, &half, &steps, &once};
    for (int n = 0; n < 4; n++) ref_body_free(all[n]);
    sm_cut_free(&cut);
}

/* How far the ends of a bar part under a pull along it, which inertia alone holds; the parameters
 * are left in u. */
static double opening(const RefBody *body, double pull, double *u)
{
    size_t unknowns = 3 * (size_t)body->nodes.count;
    double *f = sm_alloc(unknowns, sizeof *f), work = 0, shift = ref_modes_shift(&body->matrices);
    RefShape shape = ref_shape_create(&body->nodes);
    double x[SHOWN][3];
    end_points(x);
    for (int n = 0; n < SHOWN; n++) {
        assert_true(ref_mls_at(&body->nodes, body->basis, x[n], &shape));
        for (int k = 0; k < shape.count; k++)
            f[3 * shape.node[k] + 2] +=
                (n < SIDE * SIDE ? -1 : 1) * pull * shape.value[k] / SIDE / SIDE;
    }
    RefSolver *solver;
    assert_int_equal(ref_solver_create(&body->matrices, 1e-3 * shift, NULL, &solver, NULL), SM_OK);
    ref_solver_solve(solver, f, NULL, u);
    for (size_t n = 0; n < unknowns; n++) work += f[n] * u[n];
    ref_solver_destroy(solver);
    ref_shape_free(&shape);
    free(f);
    return work / pull;
}

static void displacement(const RefBody *body, const double *u, const double x[3], double at[3])
{
    RefShape shape = ref_shape_create(&body->nodes);
    assert_true(ref_mls_at(&body->nodes, body->basis, x, &shape));
    memset(at, 0, sizeof(double[3]));
    for (int n = 0; n < shape.count; n++)
        for (int d = 0; d < 3; d++) at[d] += shape.value[n] * u[3 * shape.node[n] + d];
    ref_shape_free(&shape);
}

/* A bar that is pulled opens a crack in its middle by as much to either side, most at its mouth. It
 * gives way by what fracture mechanics says: of an edge crack a deep in a bar w wide by
 * (4 sigma a / E) V(a / w) (Tada, Paris and Irwin), where stress is plane; where strain is, 9%
 * less. */
TEST(a_crack_opens_as_theory_says)
{
    needs_solver();
    RefBodyOptions fine = options;
    double ends[SHOWN][3];
    end_points(ends);
    fine.cell = 0.125;
    RefBody bar = brick_body_showing(size, &fine, SHOWN, (const double(*)[3])ends);
    double *u = sm_alloc(9 * (size_t)bar.nodes.count, sizeof *u);
    double whole = opening(&bar, 1000, u);
    assert_true(fabs(whole / (1000 * 3 / steel.young) - 1) < 0.02);
    double a = 0.5, V = 0.99 - a * (1 - a) * (1.3 - 1.2 * a + 0.7 * a * a);
    double theory = 4 * 1000 / steel.young * a * V * a / (1 - a) / (1 - a);
    RefBody cracked = cracked_bar(&bar, 1.5, a);
    double more = opening(&cracked, 1000, u) - whole, before = INFINITY;
    print_message("[  NOTE    ] opens by %.3f of theory\n", more / theory);
    assert_true(more / theory > 0.88 && more / theory < 1.03);
    for (int n = 0; n < 5; n++) {
        double side[2][3];
        for (int k = 0; k < 2; k++) {
            double x[3] = {0.04 + 0.08 * n, 0.4, 1.5 + (k ? 0.03 : -0.03)};
            displacement(&cracked, u, x, side[k]);
        }
        double gap = side[1][2] - side[0][2];
        assert_true(gap > 0 && gap < before);
        assert_true(fabs(side[1][2] + side[0][2]) < 1e-6 * gap);
        assert_true(fabs(side[1][0] - side[0][0]) < 1e-6 * gap);
        before = gap;
    }
    free(u);
    ref_body_free(&cracked);
    ref_body_free(&bar);
}

/* Two cracks so close that no node lies between them, and one that leaves a flake: what has no
 * nodes is blind, the rest is whole. */
TEST(what_no_node_is_left_is_blind)
{
    needs_solver();
    RefBody bar = brick_body(size, &options);
    RefBody one = cracked_bar(&bar, 1.5, 1.1), flake = cracked_bar(&bar, 2.995, 1.1), two;
    RefBrick brick = {{0, 0, 0}, {size[0], size[1], size[2]}};
    RefField field = ref_field_brick(&brick);
    SmCut cut;
    sm_cut_init(&cut, 0.5);
    cut_across(&cut, 2, 1.5, -0.5, 1.1, 5);
    long first = cut.triangles;
    cut_across(&cut, 2, 1.51, -0.5, 1.1, 5);
    assert_int_equal(ref_body_crack(&one, &cut, first, &field, &steel, 0, NULL, &two, NULL), SM_OK);
    assert_int_equal(ref_body_pieces(&two), 2);
    assert_int_equal(zero_modes(&two), 12);
    assert_int_equal(ref_body_pieces(&flake), 1);
    assert_int_equal(zero_modes(&flake), 6);
    assert_true(mass_of(&two, -1) > 2900 && mass_of(&flake, -1) > 2900);
    RefBody *all[] = {&bar, &one, &two, &flake};
    for (int n = 0; n < 4; n++) ref_body_free(all[n]);
    sm_cut_free(&cut);
}
