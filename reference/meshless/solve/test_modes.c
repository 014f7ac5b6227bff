/* Natural modes and static deflections of beams, beside the theory of Timoshenko's beam. */
#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "../test_beam.h"
#include "modes.h"

static const double length = 10; /* of beams 1 wide and high */

/* Huang 1961: zero at the angular frequencies of Timoshenko's beam, free at both ends or clamped at
 * one. */
static double frequency_equation(double omega, bool clamped)
{
    double young = steel.young, nu = steel.poisson, rho = steel.density;
    double G = young / (2 * (1 + nu));
    double shear = 5 * (1 + nu) / (6 + 5 * nu), I = 1.0 / 12, ends = length;
    double b = sqrt(rho * omega * omega * pow(ends, 4) / (young * I));
    double r2 = I / (ends * ends), s2 = young * I / (shear * G * ends * ends);
    double root = sqrt((r2 - s2) * (r2 - s2) + 4 / (b * b)), q = sqrt(1 - b * b * r2 * s2);
    double alpha = b * sqrt((root - r2 - s2) / 2), beta = b * sqrt((root + r2 + s2) / 2);
    double even = cosh(alpha) * cos(beta), odd = sinh(alpha) * sin(beta);
    if (clamped) return 2 + (b * b * (r2 - s2) * (r2 - s2) + 2) * even - b * (r2 + s2) / q * odd;
    return 2 - 2 * even + b / q * (b * b * r2 * (r2 - s2) * (r2 - s2) + 3 * r2 - s2) * odd;
}

/* The `count` lowest frequencies of bending, by bisection between signs on a fine scale. */
static void theory(bool clamped, int count, double *omega)
{
    double step = 0.01;
    for (double from = 0.2; count > 0; from += step) {
        double low = from, high = from + step;
        double before = frequency_equation(low, clamped);
        if (before * frequency_equation(high, clamped) > 0) continue;
        for (int n = 0; n < 50; n++) {
            double middle = (low + high) / 2;
            *(before * frequency_equation(middle, clamped) > 0 ? &low : &high) = middle;
        }
        *omega++ = low;
        count--;
    }
}

/* The theory holds for slender beams: the third mode of this one is off by 0.3%. */
TEST(the_theory_is_that_of_slender_beams)
{
    static const double beta[2][3] = {{4.73004, 7.85320, 10.99561}, {1.87510, 4.69409, 7.85476}};
    for (int clamped = 0; clamped < 2; clamped++) {
        double omega[3], slender = sqrt(steel.young / 12 / steel.density);
        theory(clamped, 3, omega);
        for (int k = 0; k < 3; k++) {
            double ratio = omega[k] / (pow(beta[clamped][k] / length, 2) * slender);
            assert_true(ratio < 1 && ratio > 0.84);
        }
    }
}

enum { MOST_HELD = 64 };

/* Points of the face x = 0, in the middle of every octant's: as many as it has nodes. */
static long root_points(double cell, double (*x)[3])
{
    int across = (int)rint(1 / cell), count = across * across;
    for (int n = 0; n < count; n++) {
        x[n][0] = 0;
        x[n][1] = (n % across + 0.5) / across;
        x[n][2] = (n / across + 0.5) / across;
    }
    return count;
}

static RefBody beam(double cell)
{
    RefBodyOptions options = {.cell = cell, .basis = REF_MLS_LINEAR, .material = steel};
    double x[MOST_HELD][3];
    long count = root_points(cell, x);
    return brick_body_showing((double[]){length, 1, 1}, &options, count, (const double(*)[3])x);
}

/* Rows that hold the face x = 0. */
static RefRows clamp(const RefBody *body)
{
    RefRows rows = {0};
    RefShape shape = ref_shape_create(&body->nodes);
    double x[MOST_HELD][3];
    long count = root_points(body->octants.cell, x);
    for (long n = 0; n < count; n++) {
        assert_true(ref_mls_at(&body->nodes, body->basis, x[n], &shape));
        for (int d = 0; d < 3; d++) ref_rows_displacement(&rows, &shape, d);
    }
    ref_shape_free(&shape);
    return rows;
}

/* Six zeros, M-orthonormal columns, K Psi = M Psi Lambda. */
static void check_modes(const RefBody *body, const RefModes *modes)
{
    size_t size = 3 * (size_t)modes->nodes, count = (size_t)modes->count;
    double *Mx = sm_alloc(size * count, sizeof *Mx), *Kx = sm_alloc(size * count, sizeof *Kx);
    ref_sparse_apply(&body->matrices.mass, 3 * modes->count, modes->shape, Mx);
    ref_sparse_apply(&body->matrices.stiffness, modes->count, modes->shape, Kx);
    for (size_t k = 0; k < 6; k++) assert_true(fabs(modes->lambda[k]) < 1e-6 * modes->lambda[6]);
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < count; b++) {
            double mass = 0, stiffness = 0;
            for (size_t n = 0; n < size; n++) {
                mass += modes->shape[n * count + a] * Mx[n * count + b];
                stiffness += modes->shape[n * count + a] * Kx[n * count + b];
            }
            assert_true(fabs(mass - (a == b)) < 1e-9);
            assert_true(fabs(stiffness - (a == b ? modes->lambda[a] : 0)) <
                        1e-8 * modes->lambda[count - 1]);
        }
    free(Mx);
    free(Kx);
}

TEST(six_zeros_and_orthonormal)
{
    needs_solver();
    for (int quadratic = 0; quadratic < 2; quadratic++) {
        RefBodyOptions options = {.cell = 0.23,
                                  .basis = quadratic ? REF_MLS_QUADRATIC : REF_MLS_LINEAR,
                                  .material = steel};
        RefBody body = brick_body((double[]){1.4, 0.8, 0.9}, &options);
        RefModes modes;
        assert_int_equal(ref_modes_find(&body.matrices, NULL, 24, &modes, NULL), SM_OK);
        check_modes(&body, &modes);
        ref_modes_free(&modes);
        ref_body_free(&body);
    }
}

/* Relative errors of the first two pairs of bending modes. */
static void errors(double cell, bool clamped, double error[2])
{
    RefBody body = beam(cell);
    RefRows rows = {0};
    RefModes modes;
    double omega[2];
    if (clamped) rows = clamp(&body);
    theory(clamped, 2, omega);
    assert_int_equal(ref_modes_find(&body.matrices, clamped ? &rows : NULL, 10, &modes, NULL),
                     SM_OK);
    for (int k = 0; k < 2; k++) {
        double found = sqrt(modes.lambda[(clamped ? 0 : 6) + 2 * k]);
        error[k] = found / omega[k] - 1;
    }
    ref_modes_free(&modes);
    ref_rows_free(&rows);
    ref_body_free(&body);
}

/* Errors of beams two, three and four octants wide; they fall faster than with the square of the
 * octants' size. The theory's own error is 0.05%. */
TEST(beams_converge)
{
    needs_solver();
    static const double cell[3] = {1.0 / 2, 1.0 / 3, 1.0 / 4};
    for (int clamped = 0; clamped < 2; clamped++) {
        double error[3][2];
        for (int n = 0; n < 3; n++) errors(cell[n], clamped, error[n]);
        for (int k = 0; k < 2; k++) {
            double rate = log(fabs(error[0][k] / error[2][k])) / log(2.0);
            print_message("%s beam, mode %d: off by %.2f%%, %.2f%%, %.2f%%; rate %.1f\n",
                          clamped ? "clamped" : "free", k + 1, 100 * error[0][k], 100 * error[1][k],
                          100 * error[2][k], rate);
            assert_true(fabs(error[2][k]) < 0.005 && rate > 2);
        }
    }
}

/* Timoshenko's cantilever: plane stress, a load P at the end that is spread as a parabola; three
 * wide here, with three times the load. */
static const double L = 48, D = 12, WIDTH = 3, E = 3e7, NU = 0.3;
enum { ROOT = 16 }; /* octants of the root */

static double cantilever_I(void)
{
    return WIDTH * D * D * D / 12;
}

/* What the load does to every parameter. */
static void load_end(const RefBody *body, const FacePoints *face, double P, double *load)
{
    RefShape shape = ref_shape_create(&body->nodes);
    for (long p = 0; p < face->count; p++) {
        double y = face->x[p][1] - D / 2;
        if (!(face->normal[p][0] > 0)) continue;
        assert_true(ref_mls_at(&body->nodes, body->basis, face->x[p], &shape));
        for (int n = 0; n < shape.count; n++)
            load[3 * shape.node[n] + 1] +=
                face->area[p] * shape.value[n] * P / (2 * cantilever_I()) * (D * D / 4 - y * y);
    }
    ref_shape_free(&shape);
}

/* The root as the theory has it, in the middle of every octant's face; nothing slides along z. */
static void hold_root(const RefBody *body, double P, RefRows *rows, double *target)
{
    RefShape shape = ref_shape_create(&body->nodes);
    double scale = P / (6 * E * cantilever_I());
    for (int n = 0; n < ROOT; n++) {
        double x[3] = {0.001, 1.5 * (n % 8 + 0.5), 1.5 * (n / 8 + 0.5)}, y = x[1] - D / 2;
        assert_true(ref_mls_at(&body->nodes, body->basis, x, &shape));
        target[rows->count] = -scale * y * (2 + NU) * (y * y - D * D / 4);
        ref_rows_displacement(rows, &shape, 0);
        target[rows->count] = scale * 3 * NU * y * y * L;
        ref_rows_displacement(rows, &shape, 1);
    }
    ref_rows_displacement(rows, &shape, 2);
    ref_shape_free(&shape);
}

/* The tip moves by 0.0089 in theory. */
TEST(cantilever)
{
    needs_solver();
    const double P = 1000 * WIDTH, size[3] = {L, D, WIDTH};
    RefBodyOptions options = {.cell = 1.5, .basis = REF_MLS_LINEAR, .material = {E, NU, 1}};
    FacePoints face = face_points(size, options.cell);
    RefBody body = brick_body_showing(size, &options, face.count, (const double(*)[3])face.x);
    RefShape shape = ref_shape_create(&body.nodes);
    RefRows rows = {0}, tip = {0};
    double *load = sm_alloc(3 * (size_t)body.nodes.count, sizeof *load);
    double *u = sm_alloc(3 * (size_t)body.nodes.count, sizeof *u), target[2 * ROOT + 1] = {0};
    RefSolver *solver;
    load_end(&body, &face, P, load);
    hold_root(&body, P, &rows, target);
    assert_int_equal(ref_solver_create(&body.matrices, 0, &rows, &solver, NULL), SM_OK);
    ref_solver_solve(solver, load, target, u);
    assert_true(
        ref_mls_at(&body.nodes, body.basis, (double[]){L - 0.01, D / 2, WIDTH / 2}, &shape));
    ref_rows_displacement(&tip, &shape, 1);
    double found = ref_rows_apply(&tip, 0, u);
    print_message("cantilever's tip: %.6f, in theory 0.0089\n", found);
    assert_true(fabs(found / 0.0089 - 1) < 0.005);
    ref_solver_destroy(solver);
    ref_rows_free(&rows);
    ref_rows_free(&tip);
    ref_shape_free(&shape);
    face_points_free(&face);
    ref_body_free(&body);
    free(load);
    free(u);
}

/* How far x is from solving (K + 1e6 M) x = b, of b. */
static double left_of(const RefMatrices *matrices, const double *x, const double *b)
{
    int size = matrices->stiffness.columns;
    double *Kx = sm_alloc(2 * (size_t)size, sizeof *Kx), *Mx = Kx + size, most = 0, largest = 0;
    ref_sparse_apply(&matrices->stiffness, 1, x, Kx);
    ref_sparse_apply(&matrices->mass, 3, x, Mx);
    for (int n = 0; n < size; n++) {
        most = fmax(most, fabs(Kx[n] + 1e6 * Mx[n] - b[n]));
        largest = fmax(largest, fabs(b[n]));
    }
    free(Kx);
    return most / largest;
}

/* In their own order, another solver's, that of a solver of the nodes, and where the mass is
 * diagonal and says nothing of the entries. */
TEST(orders_change_no_solution)
{
    needs_solver();
    unsigned seed = 6;
    RefBody body = beam(0.5);
    size_t size = 3 * (size_t)body.nodes.count, nodes = size / 3;
    const RefMatrices *matrices = &body.matrices;
    double *b = sm_alloc(2 * size, sizeof *b), *x = b + size;
    for (size_t n = 0; n < size; n++) b[n] = random_between(&seed, -1, 1);
    RefMatrices lumped = *matrices;
    lumped.mass = (RefSparse){.columns = (int)nodes,
                              .start = sm_alloc(nodes + 1, sizeof(int)),
                              .row = sm_alloc(nodes, sizeof(int)),
                              .value = sm_alloc(nodes, sizeof(double))};
    ref_sparse_sums(&matrices->mass, lumped.mass.value);
    for (size_t n = 0; n < nodes; n++) {
        lumped.mass.row[n] = (int)n;
        lumped.mass.start[n + 1] = (int)n + 1;
    }
    RefSolver *solver[5] = {NULL};
    RefMatrices alone = {.stiffness = matrices->mass};
    assert_int_equal(ref_solver_create(matrices, -1e6, NULL, solver, NULL), SM_OK);
    assert_int_equal(ref_solver_create(&alone, 0, NULL, solver + 1, NULL), SM_OK);
    assert_int_equal(ref_solver_create_like(solver[0], matrices, -1e6, solver + 2, NULL), SM_OK);
    assert_int_equal(ref_solver_create_like(solver[1], matrices, -1e6, solver + 3, NULL), SM_OK);
    assert_int_equal(ref_solver_create(&lumped, -1e6, NULL, solver + 4, NULL), SM_OK);
    for (int n = 0; n < 5; n++) {
        if (n != 1) {
            ref_solver_solve(solver[n], b, NULL, x);
            assert_true(left_of(n == 4 ? &lumped : matrices, x, b) < 1e-9);
        }
        ref_solver_destroy(solver[n]);
    }
    sm_free_all(lumped.mass.start, lumped.mass.row, lumped.mass.value, b);
    ref_body_free(&body);
}

/* Several right sides at once, with rows and without: as each alone. */
TEST(several_are_solved_as_one_by_one)
{
    needs_solver();
    enum { MOST_SIDES = 5 };
    static const int sides[] = {1, 2, 5, 5, 1, 3};
    unsigned seed = 5;
    RefBody body = beam(0.5);
    size_t size = 3 * (size_t)body.nodes.count;
    RefShape shape = ref_shape_create(&body.nodes);
    RefRows rows = {0};
    assert_true(ref_mls_at(&body.nodes, body.basis, body.nodes.position[0], &shape));
    for (int axis = 0; axis < 3; axis++) ref_rows_displacement(&rows, &shape, axis);
    double *b = sm_alloc(MOST_SIDES * size, sizeof *b), *x = sm_alloc(MOST_SIDES * size, sizeof *x);
    double *one = sm_alloc(size, sizeof *one), target[3 * MOST_SIDES];
    RefSolver *solver;
    assert_int_equal(ref_solver_create(&body.matrices, -1e6, &rows, &solver, NULL), SM_OK);
    for (size_t trial = 0; trial < sizeof sides / sizeof *sides; trial++) {
        bool forced = trial != 3, aimed = trial != 2;
        for (size_t n = 0; n < MOST_SIDES * size; n++) b[n] = random_between(&seed, -1, 1);
        for (int r = 0; r < 3 * MOST_SIDES; r++) target[r] = random_between(&seed, -1, 1);
        ref_solver_solve_several(solver, sides[trial], forced ? b : NULL, aimed ? target : NULL, x);
        for (size_t s = 0; s < (size_t)sides[trial]; s++) {
            double most = 0, off = 0;
            ref_solver_solve(solver, forced ? b + s * size : NULL, aimed ? target + 3 * s : NULL,
                             one);
            for (size_t n = 0; n < size; n++) {
                most = fmax(most, fabs(one[n]));
                off = fmax(off, fabs(one[n] - x[s * size + n]));
            }
            assert_true(most > 0 && off < 1e-9 * most);
        }
    }
    ref_solver_destroy(solver);
    ref_rows_free(&rows);
    ref_shape_free(&shape);
    ref_body_free(&body);
    sm_free_all(b, x, one);
}

/* A free body cannot be solved for, nor one held at a point; too many modes and none are refused.
 */
TEST(what_has_no_solution)
{
    needs_solver();
    RefBody body = beam(0.5);
    RefSolver *solver;
    RefModes modes;
    SmError error = {0};
    assert_int_equal(ref_solver_create(&body.matrices, 0, NULL, &solver, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "singular"));
    RefRows rows = {0};
    RefShape shape = ref_shape_create(&body.nodes);
    assert_true(ref_mls_at(&body.nodes, body.basis, (double[]){5, 0.5, 0.5}, &shape));
    for (int d = 0; d < 3; d++) ref_rows_displacement(&rows, &shape, d);
    assert_int_equal(ref_solver_create(&body.matrices, 0, &rows, &solver, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "not held"));
    assert_int_equal(ref_modes_find(&body.matrices, NULL, 0, &modes, &error), SM_USAGE);
    assert_int_equal(ref_modes_find(&body.matrices, NULL, 200, &modes, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "from 1 to 120"));
    ref_rows_free(&rows);
    ref_shape_free(&shape);
    ref_body_free(&body);
}
