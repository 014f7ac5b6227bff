/* Shape matching of clusters: each kind of fit meets the motions that it can, and turns with the
 * body. */
#include "../lib/test_fields.h"
#include "../lib/test_frame.h"
#include "shape_matching.h"
#include "svd_polar.h"

enum { NX = 4, NY = 3, NZ = 9, COUNT = NX * NY * NZ };

static double x0[COUNT][3], x[COUNT][3], g[COUNT][3], m[COUNT];

static void fill(void)
{
    for (int p = 0; p < COUNT; p++) {
        x0[p][0] = 10 + 0.5 * (p % NX);
        x0[p][1] = -3 + 0.5 * (p / NX % NY);
        x0[p][2] = 0.5 * (double)(p / (NX * NY));
        m[p] = 1 + 0.3 * (p % 5);
    }
}

/* A quadratic motion, `bent` of its own; with 0 an affine one. */
static void move(double bent)
{
    for (int p = 0; p < COUNT; p++) {
        double a = x0[p][0] - 11, b = x0[p][1] + 2, c = x0[p][2] - 1;
        x[p][0] = 3 + 1.2 * a - 0.4 * b + 0.3 * c + bent * (0.3 * a * c - 0.1 * b * b);
        x[p][1] = -1 + 0.5 * a + 0.8 * b - 0.2 * c + bent * (0.2 * c * c + 0.15 * a * b);
        x[p][2] = 7 - 0.1 * a + 0.3 * b + 1.1 * c + bent * (0.25 * b * c - 0.2 * a * a);
    }
}

static void goals(RefShapeFit fit, int parts, double overlap)
{
    RefRegions clusters;
    ref_shape_slabs(COUNT, (const double(*)[3])x0, 2, parts, overlap, &clusters);
    ref_shape_goals(&clusters, &fit, (const double(*)[3])x0, m, (const double(*)[3])x, g);
    ref_regions_free(&clusters);
}

static double miss(RefShapeFit fit, int parts)
{
    goals(fit, parts, 0.25);
    return field_difference(COUNT, (const double(*)[3])g, (const double(*)[3])x);
}

TEST(linear_matching_meets_affine_motions)
{
    fill();
    move(0);
    assert_true(miss((RefShapeFit){REF_LINEAR, 1, false}, 1) < 1e-12);
    assert_true(miss((RefShapeFit){REF_LINEAR, 1, false}, 3) < 1e-12);
    assert_true(miss((RefShapeFit){REF_QUADRATIC, 1, false}, 3) < 1e-11);
    assert_true(miss((RefShapeFit){REF_RIGID, 1, false}, 1) > 0.1);
}

TEST(quadratic_matching_meets_quadratic_motions)
{
    fill();
    move(1);
    assert_true(miss((RefShapeFit){REF_QUADRATIC, 1, false}, 1) < 1e-11);
    assert_true(miss((RefShapeFit){REF_QUADRATIC, 1, false}, 3) < 1e-11);
    assert_true(miss((RefShapeFit){REF_LINEAR, 1, false}, 1) > 0.1);
}

static const double turn[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6};

static void apply(double (*at)[3])
{
    for (int p = 0; p < COUNT; p++) {
        double v[3];
        memcpy(v, at[p], sizeof v);
        for (int i = 0; i < 3; i++)
            at[p][i] = turn[i * 3] * v[0] + turn[i * 3 + 1] * v[1] + turn[i * 3 + 2] * v[2] - 4 + i;
    }
}

TEST(every_matching_turns_with_the_body)
{
    const RefShapeFit fits[] = {
        {REF_RIGID, 1, false}, {REF_LINEAR, 0.8, true}, {REF_QUADRATIC, 0.6, false}};
    for (int f = 0; f < 3; f++) {
        double expected[COUNT][3];
        fill();
        memcpy(x, x0, sizeof x);
        apply(x);
        assert_true(miss(fits[f], 2) < 1e-12); /* a rigid motion is met by all */
        move(0.5);
        goals(fits[f], 2, 0.25);
        memcpy(expected, g, sizeof expected);
        apply(expected);
        apply(x);
        goals(fits[f], 2, 0.25);
        assert_true(field_difference(COUNT, (const double(*)[3])g, (const double(*)[3])expected) <
                    1e-11);
    }
}

static double volume_ratio(void)
{
    double e[3][3]; /* edges of one cell's goals, in units of the cell */
    const int step[3] = {1, NX, NX * NY};
    for (int a = 0; a < 3; a++)
        for (int d = 0; d < 3; d++) e[a][d] = (g[step[a]][d] - g[0][d]) / 0.5;
    double det = 0;
    for (int i = 0; i < 3; i++)
        det += e[0][i] *
               (e[1][(i + 1) % 3] * e[2][(i + 2) % 3] - e[1][(i + 2) % 3] * e[2][(i + 1) % 3]);
    return det;
}

TEST(linear_matching_keeps_volume_where_asked)
{
    fill();
    move(0);
    goals((RefShapeFit){REF_LINEAR, 1, true}, 1, 0);
    assert_true(fabs(volume_ratio() - 1) < 1e-12);
    goals((RefShapeFit){REF_LINEAR, 1, false}, 1, 0);
    assert_true(fabs(volume_ratio() - 1) > 0.1);
}

TEST(flat_clusters_are_fitted_in_their_span)
{
    fill();
    for (int p = 0; p < COUNT; p++) x0[p][1] = 0;
    memcpy(x, x0, sizeof x);
    for (int p = 0; p < COUNT; p++) x[p][0] *= 1.5;
    assert_true(miss((RefShapeFit){REF_LINEAR, 1, false}, 2) < 1e-11);
    assert_true(miss((RefShapeFit){REF_QUADRATIC, 1, false}, 2) < 1e-11);
    assert_true(miss((RefShapeFit){REF_LINEAR, 1, true}, 2) < 1e-11); /* no volume to keep */
}

TEST(slabs_cover_all_and_overlap)
{
    RefRegions clusters;
    fill();
    ref_shape_slabs(COUNT, (const double(*)[3])x0, 2, 4, 0.25, &clusters);
    int times[COUNT] = {0}, twice = 0;
    for (long n = 0; n < clusters.start[4]; n++) times[clusters.member[n]]++;
    for (int p = 0; p < COUNT; p++) {
        assert_in_range(times[p], 1, 2);
        twice += times[p] == 2;
    }
    assert_int_equal(clusters.start[1], NX * NY * 3); /* layers at 0, 0.5, 1; it ends at 1.25 */
    assert_true(twice > 0 && twice < COUNT);
    ref_regions_free(&clusters);
}
