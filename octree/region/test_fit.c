/* Affine motions of groups of nodes, where they span space and where they do not. */
#include "../../lib/test_frame.h"
#include "../../lib/voxel/test_bodies.h"
#include "fit.h"

enum { NODES = 12 };
static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void multiply(const double M[9], const double a[3], double b[3])
{
    for (int i = 0; i < 3; i++) b[i] = M[3 * i] * a[0] + M[3 * i + 1] * a[1] + M[3 * i + 2] * a[2];
}

/* Nodes that span the first `span` axes, far from the origin, moved by F and with velocities L X.
 */
static void add_nodes(unsigned *seed, int span, const double F[9], const double L[9], OctFit *fit)
{
    for (int n = 0; n < NODES; n++) {
        double X[3] = {3, -2, 5}, x[3], v[3];
        for (int d = 0; d < span; d++) X[d] += 4 * random_unit(seed);
        multiply(F, X, x);
        multiply(L, X, v);
        for (int d = 0; d < 3; d++) {
            x[d] += 7;
            v[d] -= 2;
        }
        oct_fit_add(fit, 0.5 + random_unit(seed), X, x, v);
    }
}

static void check(const double a[9], const double b[9])
{
    for (int i = 0; i < 9; i++)
        if (!(fabs(a[i] - b[i]) < 1e-11)) fail_msg("entry %d is %g, not %g", i, a[i], b[i]);
}

TEST(affine_motions_of_space_are_exact)
{
    unsigned seed = 1;
    for (int trial = 0; trial < 50; trial++) {
        double F[9], L[9], f[9], l[9];
        OctFit fit = {0};
        for (int i = 0; i < 9; i++) {
            F[i] = 2 * random_unit(&seed) - 1;
            L[i] = 2 * random_unit(&seed) - 1;
        }
        add_nodes(&seed, 3, F, L, &fit);
        assert_int_equal(oct_fit_solve(&fit, 0.1, identity, f, l), 3);
        check(f, F);
        check(l, L);
    }
}

/* L = w x F of a turn by 0.7 about z, then one of 90 degrees about x. */
static void rigid_motion(const double w[3], double F[9], double L[9])
{
    double c = cos(0.7), s = sin(0.7);
    const double R[9] = {c, -s, 0, 0, 0, -1, s, c, 0};
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) {
            int e = (i + 1) % 3, f = (i + 2) % 3;
            F[3 * i + j] = R[3 * i + j];
            L[3 * i + j] = w[e] * R[3 * f + j] - w[f] * R[3 * e + j];
        }
}

TEST(rigid_motions_of_a_plane_are_exact)
{
    unsigned seed = 2;
    double F[9], L[9], f[9], l[9];
    OctFit fit = {0};
    rigid_motion((const double[3]){0.1, 0.2, -0.3}, F, L);
    add_nodes(&seed, 2, F, L, &fit);
    assert_int_equal(oct_fit_solve(&fit, 0.1, identity, f, l), 2);
    check(f, F);
    check(l, L);
}

/* Along the line as it moves, beyond it as `last` turned, without a turn of its own about it. */
TEST(a_line_keeps_its_turn)
{
    unsigned seed = 3;
    double F[9], L[9], f[9], l[9], along[3], turned[3];
    OctFit fit = {0};
    rigid_motion((const double[3]){0.1, 0.2, -0.3}, F, L);
    add_nodes(&seed, 1, F, L, &fit);
    assert_int_equal(oct_fit_solve(&fit, 0.1, F, f, l), 1);
    check(f, F);
    multiply(l, (const double[3]){1, 0, 0}, along);
    multiply(L, (const double[3]){1, 0, 0}, turned);
    for (int d = 0; d < 3; d++) assert_true(fabs(along[d] - turned[d]) < 1e-12);
    double about = 0; /* the turn about the line: of y towards z, as they are now */
    for (int i = 0; i < 3; i++) about += l[3 * i + 1] * F[3 * i + 2];
    assert_true(fabs(about) < 1e-12);
}

TEST(one_node_has_the_last_rotation)
{
    double F[9], L[9], f[9], l[9];
    const double none[9] = {0}, X[3] = {1, 2, 3}, x[3] = {4, 5, 6}, v[3] = {7, 8, 9};
    OctFit fit = {0};
    rigid_motion((const double[3]){0, 0, 0}, F, L);
    oct_fit_add(&fit, 2, X, x, v);
    assert_int_equal(oct_fit_solve(&fit, 0.1, F, f, l), 0);
    check(f, F);
    check(l, none);
}
