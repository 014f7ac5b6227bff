/* Rigid motions, masses, the energy of plain strains, and the patch test. */
#include "../../../lib/test_fields.h"
#include "../../../lib/test_frame.h"
#include "../../../lib/vector.h"
#include "../test_beam.h"

static const RefBodyOptions coarse = {.cell = 0.25,
                                      .basis = REF_MLS_LINEAR,
                                      .material = {.young = 1e7, .poisson = 0.3, .density = 1000}};

/* u = A x + b at the nodes, which linear functions reproduce everywhere. */
static double *linear(const RefBody *body, const double A[9], const double b[3])
{
    double *u = sm_alloc(3 * (size_t)body->nodes.count, sizeof *u);
    for (long n = 0; n < body->nodes.count; n++)
        for (int d = 0; d < 3; d++) {
            u[3 * n + d] = b[d];
            for (int k = 0; k < 3; k++) u[3 * n + d] += A[3 * d + k] * body->nodes.position[n][k];
        }
    return u;
}

static double energy(const RefBody *body, const double *u)
{
    size_t size = 3 * (size_t)body->nodes.count;
    double *product = sm_alloc(size, sizeof *product), sum = 0;
    ref_sparse_apply(&body->matrices.stiffness, 1, u, product);
    for (size_t n = 0; n < size; n++) sum += 0.5 * u[n] * product[n];
    free(product);
    return sum;
}

/* Translations and small turns have no energy; the mass of a translation is the body's. */
TEST(rigid_motions)
{
    static const double turns[4][9] = {{0},
                                       {0, -1, 0, 1, 0, 0, 0, 0, 0},
                                       {0, 0, 1, 0, 0, 0, -1, 0, 0},
                                       {0, 0, 0, 0, 0, -1, 0, 1, 0}};
    static const double shift[3] = {1, 2, 3};
    RefBody body = brick_body((double[]){1.3, 0.9, 0.8}, &coarse);
    size_t size = 3 * (size_t)body.nodes.count;
    double scale = steel.young * ref_octants_volume(&body.octants);
    for (int t = 0; t < 4; t++) {
        double *u = linear(&body, turns[t], shift);
        assert_true(fabs(energy(&body, u)) < 1e-10 * scale);
        free(u);
    }
    double *u = linear(&body, turns[0], shift), *Mu = sm_alloc(size, sizeof *Mu), mass = 0;
    ref_sparse_apply(&body.matrices.mass, 3, u, Mu);
    for (size_t n = 0; n < size; n++) mass += u[n] * Mu[n];
    assert_true(fabs(mass / (14 * 1000 * ref_octants_volume(&body.octants)) - 1) < 1e-12);
    assert_true(fabs(ref_octants_volume(&body.octants) / (1.3 * 0.9 * 0.8) - 1) < 2e-4);
    free(u);
    free(Mu);
    ref_body_free(&body);
}

/* Plain strains have the energy that the material's law says, for both bases. */
TEST(energy_of_plain_strains)
{
    static const double none[3] = {0},
                        strain[9] = {1e-3, 2e-3, 0, 2e-3, -5e-4, 4e-4, 0, 4e-4, 2e-4};
    for (int basis = 0; basis < 2; basis++) {
        RefBodyOptions options = coarse;
        options.basis = basis ? REF_MLS_QUADRATIC : REF_MLS_LINEAR;
        RefBody body = brick_body((double[]){1, 1, 1}, &options);
        double mu = 1e7 / 2.6, lambda = 2 * mu * 0.3 / 0.4, trace = 7e-4, square = 0;
        double *u = linear(&body, strain, none);
        for (int n = 0; n < 9; n++) square += strain[n] * strain[n];
        double wanted = 0.5 * lambda * trace * trace + mu * square;
        assert_true(fabs(energy(&body, u) / wanted - 1) < 1e-9);
        free(u);
        ref_body_free(&body);
    }
}

/* Adds what the traction stress . normal on walls does to every parameter. */
static void load_walls(const RefBody *body, long count, const RefWall *wall, const double stress[9],
                       double *load)
{
    RefShape shape = ref_shape_create(&body->nodes);
    for (long p = 0; p < count; p++) {
        if (!wall[p].surface) continue;
        assert_true(ref_mls_at(&body->nodes, body->basis, wall[p].x, &shape));
        for (int n = 0; n < shape.count; n++)
            for (int d = 0; d < 3; d++)
                load[3 * shape.node[n] + d] +=
                    shape.value[n] * sm_dot(stress + 3 * d, wall[p].area);
    }
    ref_shape_free(&shape);
}

/* The same on the faces' points. */
static void load_faces(const RefBody *body, const FacePoints *face, const double stress[9],
                       double *load)
{
    RefWall *wall = sm_alloc((size_t)face->count, sizeof *wall);
    for (long p = 0; p < face->count; p++) {
        wall[p].surface = true;
        for (int d = 0; d < 3; d++) {
            wall[p].x[d] = face->x[p][d];
            wall[p].area[d] = face->area[p] * face->normal[p][d];
        }
    }
    load_walls(body, face->count, wall, stress, load);
    free(wall);
}

/* Holds a point in three directions, another one in two and a third one in one, so that nothing
 * turns. */
static void hold_still(const RefBody *body, RefRows *rows)
{
    static const double x[3][3] = {{0.1, 0.1, 0.1}, {0.9, 0.1, 0.1}, {0.1, 0.65, 0.1}};
    RefShape shape = ref_shape_create(&body->nodes);
    for (int n = 0; n < 3; n++) {
        assert_true(ref_mls_at(&body->nodes, body->basis, x[n], &shape));
        for (int d = n; d < 3; d++) ref_rows_displacement(rows, &shape, d);
    }
    ref_shape_free(&shape);
}

typedef struct {
    double cell;
    RefBasis basis;
    int split;
    bool fine; /* tractions are summed on points of their own, not on the octants' walls */
} Patch;

/* The largest error, relative to the largest displacement, of a brick under the tractions of a
 * plain strain. */
static double patch_error(const Patch *patch)
{
    static const double strain[9] = {1e-3, 2e-3, 0, 2e-3, -5e-4, 4e-4, 0, 4e-4, 2e-4},
                        none[3] = {0};
    static const double size[3] = {1, 0.75, 0.75};
    RefBodyOptions options = {
        .cell = patch->cell, .basis = patch->basis, .split = patch->split, .material = steel};
    FacePoints face = face_points(size, patch->cell / 8);
    RefBody body = brick_body_showing(size, &options, face.count, (const double(*)[3])face.x);
    double mu = 1e7 / 2.6, lambda = 2 * mu * 0.3 / 0.4, stress[9], off = 0, most = 0;
    for (int n = 0; n < 9; n++) stress[n] = 2 * mu * strain[n] + (n % 4 ? 0 : lambda * 7e-4);
    size_t unknowns = 3 * (size_t)body.nodes.count;
    double *u = linear(&body, strain, none), *found = sm_alloc(unknowns, sizeof *found);
    double *load = sm_alloc(unknowns, sizeof *load), target[6];
    RefRows rows = {0};
    RefSolver *solver;
    if (patch->fine)
        load_faces(&body, &face, stress, load);
    else
        load_walls(&body, body.octants.walls, body.octants.wall, stress, load);
    hold_still(&body, &rows);
    for (int r = 0; r < 6; r++) target[r] = ref_rows_apply(&rows, r, u);
    assert_int_equal(ref_solver_create(&body.matrices, 0, &rows, &solver, NULL), SM_OK);
    assert_int_equal(ref_solver_rank(solver), 6);
    ref_solver_solve(solver, load, target, found);
    for (size_t n = 0; n < unknowns; n++) {
        most = fmax(most, fabs(u[n]));
        off = at_worst(off, fabs(u[n] - found[n]));
    }
    for (int r = 0; r < 6; r++)
        assert_true(fabs(ref_rows_apply(&rows, r, found) - target[r]) < 1e-12);
    ref_solver_destroy(solver);
    ref_rows_free(&rows);
    face_points_free(&face);
    ref_body_free(&body);
    free(u);
    free(found);
    free(load);
    return off / most;
}

/* Gradients balanced by the octants' walls leave rounding alone where walls carry the tractions;
 * where finer points do, the walls' own error, which falls with their number. Bricks that octants
 * do not fit are as good as their edges are cut. */
TEST(patch_test)
{
    needs_solver();
    static const struct {
        Patch patch;
        double most;
    } cases[] = {
        {{0.25, REF_MLS_LINEAR, 1, false}, 1e-11},    {{0.25, REF_MLS_LINEAR, 2, false}, 1e-11},
        {{0.25, REF_MLS_QUADRATIC, 1, false}, 1e-10}, {{0.25, REF_MLS_LINEAR, 1, true}, 1e-3},
        {{0.25, REF_MLS_LINEAR, 2, true}, 1e-4},      {{0.23, REF_MLS_LINEAR, 1, true}, 5e-3},
        {{0.23, REF_MLS_LINEAR, 2, true}, 2.5e-3},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        double error = patch_error(&cases[n].patch);
        print_message("octants of %g, split %d, basis of %d%s: off by %.1e\n", cases[n].patch.cell,
                      cases[n].patch.split, (int)cases[n].patch.basis,
                      cases[n].patch.fine ? ", finer load" : "", error);
        assert_true(error < cases[n].most);
    }
}

TEST(materials_out_of_range)
{
    static const RefMaterial wrong[] = {{0, 0.3, 1}, {-1, 0.3, 1},      {NAN, 0.3, 1},
                                        {1, 0.5, 1}, {1, -1, 1},        {1, NAN, 1},
                                        {1, 0.3, 0}, {1, 0.3, INFINITY}};
    RefBrick brick = {{0, 0, 0}, {1, 1, 1}};
    RefField field = ref_field_brick(&brick);
    for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        RefBodyOptions options = coarse;
        RefBody body;
        SmError error = {0};
        options.material = wrong[n];
        assert_int_equal(ref_body_build(&field, &options, 0, NULL, &body, &error), SM_USAGE);
        assert_non_null(strstr(error.text, "give one"));
    }
}

/* A plate of one layer of octants has its nodes in a plane; a node beside the body holds none of
 * it. */
TEST(bodies_that_have_no_matrices)
{
    RefBrick plate = {{0, 0, 0}, {2, 2, 0.25}};
    RefField field = ref_field_brick(&plate);
    RefBody body;
    SmError error = {0};
    assert_int_equal(ref_body_build(&field, &coarse, 0, NULL, &body, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "in a plane"));
    body = brick_body((double[]){1, 1, 1}, &coarse);
    body.nodes.position[0][0] = -5;
    ref_nodes_bin(&body.nodes);
    RefMatrices matrices;
    assert_int_equal(
        ref_matrices_build(&body.octants, &body.nodes, REF_MLS_LINEAR, &steel, &matrices, &error),
        SM_INPUT);
    assert_non_null(strstr(error.text, "holds none of the body"));
    ref_body_free(&body);
}
