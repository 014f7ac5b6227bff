/* The surface of a brick as a mesh. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "outline.h"

static void a_brick_is_closed_and_has_its_volume(void **state)
{
    (void)state;
    RefBrick brick = {{-1, 0, 2}, {1.3, 0.9, 2.5}};
    RefField field = ref_field_brick(&brick);
    SmMesh mesh;
    assert_int_equal(ref_outline(&field, 40, &mesh, NULL), SM_OK);
    assert_int_equal(sm_mesh_check(&mesh, "outline", NULL), SM_OK);
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_true(info.watertight && info.flipped_edges == 0 && info.components == 1);
    assert_true(fabs(info.volume / (2.3 * 0.9 * 0.5) - 1) < 0.02);
    for (long v = 0; v < mesh.vertex_count; v++)
        assert_true(fabs(ref_field_at(&field, mesh.position[v], NULL)) < 0.01);
    sm_mesh_free(&mesh);
}

static double outside_at(const void *body, const double x[3], double gradient[3])
{
    (void)body, (void)x;
    for (int d = 0; gradient && d < 3; d++) gradient[d] = 0;
    return 1;
}

static void nothing_inside(void **state)
{
    (void)state;
    RefField field = {outside_at, NULL, {0, 0, 0}, {1, 1, 1}};
    SmMesh mesh;
    SmError error = {0};
    assert_int_equal(ref_outline(&field, 10, &mesh, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "nothing"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_brick_is_closed_and_has_its_volume),
        cmocka_unit_test(nothing_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
