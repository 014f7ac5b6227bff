#include "mesh.h"

#include <sys/stat.h>
#include <unistd.h>

#include "../test_folder.h"
#include "../test_frame.h"

/* cmocka's assert_float_equal() compares in single precision. */
static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) fail_msg("%.17g is not %.17g", value, expected);
}

static const double cube_corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                         {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int cube_triangle[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
                                         {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                                         {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};

/* A unit cube whose 36 triangle corners are vertices of their own, as in an STL file. */
static SmMesh loose_cube(void)
{
    SmMesh mesh = sm_mesh_new(36, 12);
    for (int i = 0; i < 36; i++) {
        memcpy(mesh.position[i], cube_corner[cube_triangle[i / 3][i % 3]], sizeof *mesh.position);
        mesh.triangle[i / 3][i % 3] = i;
    }
    return mesh;
}

static SmMesh cube(void)
{
    SmMesh mesh = loose_cube();
    sm_mesh_merge(&mesh);
    return mesh;
}

static void add_triangle(SmMesh *mesh, int a, int b, int c)
{
    long count = ++mesh->triangle_count;
    mesh->triangle = sm_realloc(mesh->triangle, (size_t)count, sizeof *mesh->triangle);
    memcpy(mesh->triangle[count - 1], (int[3]){a, b, c}, sizeof *mesh->triangle);
}

TEST(test_info_of_cube)
{
    SmMesh mesh = cube();
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_int_equal(info.triangles, 12);
    assert_int_equal(info.vertices, 8);
    assert_int_equal(info.components, 1);
    assert_true(info.watertight);
    assert_int_equal(info.flipped_edges + info.degenerate + info.duplicates, 0);
    assert_near(info.volume, 1, 1e-15);
    for (int a = 0; a < 3; a++) assert_true(info.low[a] == 0 && info.high[a] == 1);
    sm_mesh_free(&mesh);
    assert_null(mesh.position);
}

TEST(test_info_of_defects)
{
    SmMesh mesh = cube();
    mesh.triangle_count = 11;
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_int_equal(info.open_edges, 3);
    assert_false(info.watertight);
    mesh.triangle_count = 12;
    const int *first = mesh.triangle[0];
    add_triangle(&mesh, first[2], first[1], first[0]);
    info = sm_mesh_info(&mesh);
    assert_int_equal(info.duplicates, 1);
    assert_int_equal(info.nonmanifold_edges, 3);
    assert_int_equal(info.open_edges, 0);
    mesh.triangle_count = 12;
    int swapped = mesh.triangle[5][0];
    mesh.triangle[5][0] = mesh.triangle[5][1];
    mesh.triangle[5][1] = swapped;
    info = sm_mesh_info(&mesh);
    assert_int_equal(info.flipped_edges, 3);
    assert_true(info.watertight);
    sm_mesh_free(&mesh);
}

/* Of what is open, or turned two ways, the sum over triangles depends on where it lies. */
TEST(test_volume_only_where_triangles_bound_one)
{
    SmMesh mesh = cube();
    mesh.triangle_count = 11;
    assert_true(isnan(sm_mesh_info(&mesh).volume));
    mesh.triangle_count = 12;
    int swapped = mesh.triangle[5][0];
    mesh.triangle[5][0] = mesh.triangle[5][1];
    mesh.triangle[5][1] = swapped;
    assert_true(isnan(sm_mesh_info(&mesh).volume));
    sm_mesh_free(&mesh);
    mesh = cube(); /* used by four triangles, an edge can still be one of a closed surface */
    for (int t = 0; t < 12; t++)
        add_triangle(&mesh, mesh.triangle[t][0], mesh.triangle[t][1], mesh.triangle[t][2]);
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_int_equal(info.nonmanifold_edges, 18);
    assert_near(info.volume, 2, 1e-15);
    sm_mesh_free(&mesh);
}

/* A cube within a cube, turned inside out, is a hole in it; one turned as it is, or beside it, is
 * none. */
TEST(test_cavities)
{
    for (int turned = 0; turned < 2; turned++)
        for (int beside = 0; beside < 2; beside++) {
            SmMesh mesh = cube(), inner = cube();
            mesh.position = sm_realloc(mesh.position, 16, sizeof *mesh.position);
            for (int v = 0; v < 8; v++)
                for (int a = 0; a < 3; a++)
                    mesh.position[8 + v][a] = 0.25 + 0.5 * inner.position[v][a] + beside;
            mesh.vertex_count = 16;
            for (int t = 0; t < 12; t++) {
                const int *corner = inner.triangle[t];
                add_triangle(&mesh, 8 + corner[0], 8 + corner[1 + turned], 8 + corner[2 - turned]);
            }
            SmMeshInfo info = sm_mesh_info(&mesh);
            assert_int_equal(info.cavities, turned && !beside);
            assert_near(info.cavity_volume, turned && !beside ? 0.125 : 0, 1e-15);
            assert_near(info.volume, turned ? 0.875 : 1.125, 1e-15);
            sm_mesh_free(&mesh);
            sm_mesh_free(&inner);
        }
}

TEST(test_merge_drops)
{
    SmMesh mesh = loose_cube();
    add_triangle(&mesh, 0, 1, 1);
    mesh.position = sm_realloc(mesh.position, 38, sizeof *mesh.position);
    mesh.vertex_count = 38;
    for (int v = 36; v < 38; v++)
        for (int a = 0; a < 3; a++) mesh.position[v][a] = v;
    for (int a = 0; a < 3; a++)
        if (mesh.position[0][a] == 0) mesh.position[0][a] = -0.0;
    sm_mesh_merge(&mesh);
    assert_int_equal(mesh.vertex_count, 8);
    assert_int_equal(mesh.triangle_count, 12);
    for (int v = 0; v < 8; v++)
        for (int a = 0; a < 3; a++) assert_false(signbit(mesh.position[v][a]));
    for (int t = 0; t < 12; t++)
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++)
                assert_true(mesh.position[mesh.triangle[t][c]][a] ==
                            cube_corner[cube_triangle[t][c]][a]);
    sm_mesh_free(&mesh);
}

/* Every corner rounded its own way: merged when that closes the mesh, else not. */
TEST(test_merge_closes_rounding_gaps)
{
    for (int far = 0; far < 2; far++) {
        SmMesh mesh = loose_cube();
        for (int v = 0; v < 36; v++) mesh.position[v][v % 3] += (far ? 2e-7 : 1e-8) * (v % 7);
        sm_mesh_merge(&mesh);
        assert_int_equal(mesh.vertex_count == 8, !far);
        assert_int_equal(sm_mesh_info(&mesh).watertight, !far);
        sm_mesh_free(&mesh);
    }

    SmMesh mesh = loose_cube();
    for (int v = 0; v < 36; v++) mesh.position[v][v % 3] += 1e-9 * (v % 7);
    mesh.triangle_count = 11; /* an open edge would stay: only equal places are merged */
    int places = 0;
    for (int v = 0, same; v < 33; v++, places += !same)
        for (int u = same = 0; u < v; u++)
            same |= !memcmp(mesh.position[u], mesh.position[v], sizeof *mesh.position);
    sm_mesh_merge(&mesh);
    assert_int_equal(mesh.vertex_count, places);
    sm_mesh_free(&mesh);
}

TEST(test_components_and_degenerate)
{
    SmMesh mesh = sm_mesh_new(9, 3);
    for (int v = 0; v < 9; v++) {
        mesh.position[v][0] = 10 * (v / 3) + v % 3;
        mesh.position[v][1] = v < 6 ? v % 2 : 0; /* the last triangle is a line */
        mesh.triangle[v / 3][v % 3] = v;
    }
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_int_equal(info.components, 3);
    assert_int_equal(info.open_edges, 9);
    assert_int_equal(info.degenerate, 1);
    mesh.position[7][1] = 1e-15;
    assert_int_equal(sm_mesh_info(&mesh).degenerate, 1);
    mesh.position[7][1] = 1e-13;
    assert_int_equal(sm_mesh_info(&mesh).degenerate, 0);
    sm_mesh_free(&mesh);
}

TEST(test_volume_far_away)
{
    SmMesh mesh = cube();
    for (int v = 0; v < 8; v++)
        for (int a = 0; a < 3; a++) mesh.position[v][a] = 5e6 + 0.5 - mesh.position[v][a];
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_near(info.volume, -1, 1e-12); /* reflected: inside out */
    sm_mesh_free(&mesh);
}

/* A fan of 20,000 triangles around one vertex must not cost its square. */
TEST(test_fan_is_cheap)
{
    enum { N = 20000 };
    SmMesh mesh = sm_mesh_new(N + 1, N);
    for (int i = 0; i < N; i++) {
        mesh.position[i + 1][0] = cos(2 * M_PI * i / N);
        mesh.position[i + 1][1] = sin(2 * M_PI * i / N);
        memcpy(mesh.triangle[i], (int[3]){0, 1 + i, 1 + (i + 1) % N}, sizeof *mesh.triangle);
    }
    sm_mesh_merge(&mesh);
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_int_equal(info.open_edges, N);
    assert_int_equal(info.components, 1);
    sm_mesh_free(&mesh);
}

static void expect_refusal(SmMesh *mesh, const char *part)
{
    SmError error = {0};
    assert_int_equal(sm_mesh_check(mesh, "some.obj", &error), SM_INPUT);
    assert_int_equal(strncmp(error.text, "some.obj: ", 10), 0);
    assert_non_null(strstr(error.text, part));
}

TEST(test_check)
{
    SmMesh mesh = cube();
    assert_int_equal(sm_mesh_check(&mesh, "some.obj", NULL), SM_OK);
    mesh.triangle_count = 0;
    expect_refusal(&mesh, "no triangles");
    mesh.triangle_count = 12;
    mesh.position[3][1] = NAN;
    expect_refusal(&mesh, "the y of a vertex is not a finite number");
    mesh.position[3][1] = INFINITY;
    expect_refusal(&mesh, "the y of a vertex is not a finite number");
    mesh.position[3][1] = 2e30;
    expect_refusal(&mesh, "scale it");
    mesh.position[3][1] = 1;
    mesh.triangle[7][2] = 8;
    expect_refusal(&mesh, "a triangle names a vertex that is not there");
    mesh.triangle[7][2] = -1;
    expect_refusal(&mesh, "a triangle names");
    mesh.triangle[7][2] = 0;
    for (int i = 0; i < 24; i++) mesh.position[i / 3][i % 3] *= 2e-30;
    assert_int_equal(sm_mesh_check(&mesh, "some.obj", NULL), SM_OK);
    for (int i = 0; i < 24; i++) mesh.position[i / 3][i % 3] *= 0.25;
    expect_refusal(&mesh, "scale it");
    memset(mesh.position, 0, 8 * sizeof *mesh.position);
    expect_refusal(&mesh, "one point");
    sm_mesh_free(&mesh);
}

TEST(test_print_obj)
{
    SmMesh mesh = cube();
    mesh.position[0][0] = 1.0 / 3;
    FILE *file = tmpfile();
    assert_non_null(file);
    sm_mesh_print_obj(&mesh, file);
    rewind(file);
    double p[3];
    int corner[3];
    for (long v = 0; v < mesh.vertex_count; v++) {
        assert_int_equal(fscanf(file, " v %lf %lf %lf", &p[0], &p[1], &p[2]), 3);
        assert_memory_equal(p, mesh.position[v], sizeof p);
    }
    for (long t = 0; t < mesh.triangle_count; t++) {
        assert_int_equal(fscanf(file, " f %d %d %d", &corner[0], &corner[1], &corner[2]), 3);
        for (int c = 0; c < 3; c++) assert_int_equal(corner[c], mesh.triangle[t][c] + 1);
    }
    assert_int_equal(fscanf(file, " %lf", &p[0]), EOF);
    fclose(file);
    sm_mesh_free(&mesh);
}
