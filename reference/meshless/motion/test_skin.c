/* Surface points beside the shape functions themselves. */
#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "../test_beam.h"
#include "skin.h"

TEST(points_follow_their_shape_functions)
{
    enum { POINTS = 3000 };
    unsigned seed = 1;
    static const double size[3] = {2, 1.1, 0.9};
    RefBodyOptions options = {
        .cell = 0.23, .coarser = 1, .basis = REF_MLS_LINEAR, .material = steel};
    double(*x)[3] = sm_alloc(POINTS, sizeof *x), (*now)[3] = sm_alloc(POINTS, sizeof *now);
    for (int p = 0; p < POINTS; p++) { /* on all faces */
        for (int d = 0; d < 3; d++) x[p][d] = size[d] * random_unit(&seed);
        x[p][p % 3] = p % 2 ? 0 : size[p % 3];
    }
    RefBody body = brick_body_showing(size, &options, POINTS, (const double(*)[3])x);
    double(*moved)[3] = sm_alloc((size_t)body.nodes.count, sizeof *moved);
    for (long n = 0; n < body.nodes.count; n++)
        for (int d = 0; d < 3; d++) moved[n][d] = random_between(&seed, -0.5, 0.5);
    RefSkin skin;
    long loose = -1;
    ref_skin_create(&body, POINTS, (const double(*)[3])x, &skin, &loose);
    assert_int_equal(loose, 0);
    ref_skin_place(&skin, (const double(*)[3])moved, NULL, now);
    RefShape shape = ref_shape_create(&body.nodes);
    int *seen = sm_alloc(POINTS, sizeof *seen);
    for (int p = 0; p < POINTS; p++) {
        const double *at = x[skin.order[p]];
        seen[skin.order[p]]++;
        assert_true(ref_mls_at(&body.nodes, REF_MLS_LINEAR, at, &shape));
        for (int d = 0; d < 3; d++) {
            double wanted = at[d];
            for (int n = 0; n < shape.count; n++)
                wanted += shape.value[n] * moved[shape.node[n]][d];
            assert_true(fabs(now[p][d] - wanted) < 3e-6);
        }
    }
    for (int p = 0; p < POINTS; p++) assert_int_equal(seen[p], 1);
    ref_skin_free(&skin);
    double far[1][3] = {{50, 0, 0}}, there[1][3];
    ref_skin_create(&body, 1, (const double(*)[3])far, &skin, &loose);
    assert_int_equal(loose, 1);
    ref_skin_place(&skin, (const double(*)[3])moved, NULL, there);
    assert_true(fabs(there[0][0] - 50) <= 0.5);
    ref_skin_free(&skin);
    ref_shape_free(&shape);
    ref_body_free(&body);
    free(moved);
    free(seen);
    free(x);
    free(now);
}
