/* The surface of a brick as a mesh. */
#include "surface_nets.h"

#include "../../../lib/test_frame.h"

TEST(a_brick_is_closed_and_has_its_volume)
{
    RefBrick brick = {{-1, 0, 2}, {1.3, 0.9, 2.5}};
    RefField field = ref_field_brick(&brick);
    SmMesh mesh;
    assert_int_equal(ref_surface_nets(&field, 40, &mesh, NULL), SM_OK);
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

TEST(nothing_inside)
{
    RefField field = {outside_at, NULL, {0, 0, 0}, {1, 1, 1}};
    SmMesh mesh;
    SmError error = {0};
    assert_int_equal(ref_surface_nets(&field, 10, &mesh, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "nothing"));
}
