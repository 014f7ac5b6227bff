/* Surfaces taken apart between pieces of material: closed again on every side. */
#include "split_components.h"

#include "../shapes/shape.h"
#include "../test_frame.h"
#include "../test_random.h"

static unsigned seed = 1;

static SmMesh shape(const char *name)
{
    SmMesh mesh;
    SmError error;
    if (sm_shape_mesh(name, &mesh, &error)) fail_msg("%s", error.text);
    return mesh;
}

/* Pieces are slabs along an axis, `wide` each. */
static int *slabs(const SmMesh *mesh, int axis, double wide)
{
    int *piece = sm_alloc((size_t)mesh->vertex_count, sizeof *piece);
    for (long v = 0; v < mesh->vertex_count; v++)
        piece[v] = (int)floor(mesh->position[v][axis] / wide) + 1000;
    return piece;
}

static void check_closed(const SmMesh *mesh)
{
    SmMeshInfo info = sm_mesh_info(mesh);
    assert_int_equal(info.open_edges + info.nonmanifold_edges, 0);
    assert_int_equal(info.flipped_edges, 0);
}

TEST(slabs_of_shapes_are_closed_pieces)
{
    static const char *const names[] = {"beam", "liver", "hand", "flower", "penguin"};
    for (int n = 0; n < 5; n++)
        for (int axis = 0; axis < 3; axis++) {
            SmMesh mesh = shape(names[n]);
            SmMeshInfo before = sm_mesh_info(&mesh);
            long triangles = mesh.triangle_count;
            double wide = (before.high[axis] - before.low[axis]) / (2.3 + n);
            int *piece = slabs(&mesh, axis, wide);
            assert_true(sm_split_components(&mesh, piece) > 0);
            SmMeshInfo after = sm_mesh_info(&mesh);
            check_closed(&mesh);
            assert_true(after.components > before.components);
            assert_true(fabs(after.volume) <= fabs(before.volume) * (1 + 1e-9));
            assert_true(labs(mesh.triangle_count - triangles) < triangles);
            for (long t = 0; t < mesh.triangle_count; t++) /* of the old vertices, one slab's */
                for (int c = 0, seen = -1; c < 3; c++) {
                    if (mesh.triangle[t][c] >= before.vertices) continue;
                    assert_true(seen < 0 || seen == piece[mesh.triangle[t][c]]);
                    seen = piece[mesh.triangle[t][c]];
                }
            free(piece);
            sm_mesh_free(&mesh);
        }
}

TEST(any_pieces_leave_a_closed_surface)
{
    for (int trial = 0; trial < 50; trial++) {
        SmMesh mesh = shape(trial % 2 ? "block" : "beam");
        int *piece = sm_alloc((size_t)mesh.vertex_count, sizeof *piece);
        for (long v = 0; v < mesh.vertex_count; v++) piece[v] = random_int(&seed, 2 + trial) == 0;
        sm_split_components(&mesh, piece);
        check_closed(&mesh);
        free(piece);
        sm_mesh_free(&mesh);
    }
}

TEST(one_piece_is_left_alone)
{
    SmMesh mesh = shape("beam");
    long triangles = mesh.triangle_count, vertices = mesh.vertex_count;
    int *piece = sm_alloc((size_t)vertices, sizeof *piece);
    assert_int_equal(sm_split_components(&mesh, piece), 0);
    assert_int_equal(mesh.triangle_count, triangles);
    assert_int_equal(mesh.vertex_count, vertices);
    free(piece);
    sm_mesh_free(&mesh);
}

/* A hole that is there stays one: only what goes is closed. */
TEST(open_surfaces_stay_open)
{
    SmMesh mesh = shape("beam");
    mesh.triangle_count -= 1;
    int *piece = slabs(&mesh, 0, (sm_mesh_info(&mesh).high[0] - sm_mesh_info(&mesh).low[0]) / 3.1);
    sm_split_components(&mesh, piece);
    assert_in_range(sm_mesh_info(&mesh).open_edges, 1, 3);
    free(piece);
    sm_mesh_free(&mesh);
}
