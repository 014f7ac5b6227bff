/* A mesh that the page hands over is the one that the program imports, and is dropped as it drops
 * one; what is no mesh is refused in its words. */
#include <stdlib.h>
#include <string.h>

#include "../../lib/mesh/import.h"
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../engines.h"
#include "../scene/body.h"
#include "given.h"
#include "view.h"

/* Polygons of a file, and the same as an OBJ. */
typedef struct {
    int vertices, polygons, corners;
    const double (*point)[3];
    const int *size, *corner;
} Polygons;

/* An L-shaped prism, of which two polygons have corners on straight sides. */
static const double prism_point[][3] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0},
                                        {0, 2, 0}, {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1},
                                        {1, 2, 1}, {0, 2, 1}, {1, 0, 0}, {1, 0, 1}};
static const int prism_size[] = {7, 7, 4, 4, 4, 4, 4, 4, 4, 2};
static const int prism_corner[] = {5,  4,  3,  2,  1, 12, 0,  6,  13, 7, 8, 9,  10, 11, 0,
                                   12, 13, 6,  12, 1, 7,  13, 1,  2,  8, 7, 2,  3,  9,  8,
                                   3,  4,  10, 9,  4, 5,  11, 10, 5,  0, 6, 11, 0,  1};
enum { PRISM_CORNERS = sizeof prism_corner / sizeof *prism_corner };
static const Polygons prism = {14, 10, PRISM_CORNERS, prism_point, prism_size, prism_corner};

/* Hands it over, moved and scaled; what is said of it. */
static const char *give(const Polygons *polygons, const double offset[3], double scale)
{
    view_given_room(polygons->vertices, polygons->polygons, polygons->corners);
    for (int v = 0; v < polygons->vertices; v++)
        for (int d = 0; d < 3; d++)
            view_given_points()[3 * v + d] = scale * polygons->point[v][d] + offset[d];
    size_t size = sizeof(int);
    memcpy(view_given_sizes(), polygons->size, size * (size_t)polygons->polygons);
    memcpy(view_given_corners(), polygons->corner, size * (size_t)polygons->corners);
    return view_given_take("prism.obj");
}

static const char *write_obj(const Polygons *polygons, const double offset[3], double scale)
{
    const char *path = path_in("prism.obj");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int v = 0; v < polygons->vertices; v++) {
        for (int d = 0; d < 3; d++)
            fprintf(file, "%s %.17g", d ? "" : "v", scale * polygons->point[v][d] + offset[d]);
        fprintf(file, "\n");
    }
    const int *corner = polygons->corner;
    for (int p = 0; p < polygons->polygons; p++) {
        fprintf(file, polygons->size[p] > 2 ? "f" : "l");
        for (int c = 0; c < polygons->size[p]; c++) fprintf(file, " %d", *corner++ + 1);
        fprintf(file, "\n");
    }
    fclose(file);
    return path;
}

static int opened(const char *text)
{
    strcpy(view_room((int)strlen(text)), text);
    return view_open((int)strlen(text), 0);
}

TEST(a_mesh_is_the_one_that_is_imported)
{
    static const double places[][3] = {{0, 0, 0}, {0.1, -0.3, 1.7}, {665171.25, 5648340.125, 30}};
    for (int i = 0; i < 3; i++) {
        SmMesh imported, given;
        SmError error;
        if (sm_import(write_obj(&prism, places[i], 0.7), NULL, &imported, NULL, &error))
            fail_msg("%s", error.text);
        assert_string_equal(give(&prism, places[i], 0.7), "");
        if (view_given_load("folder/prism.obj", &given, &error)) fail_msg("%s", error.text);
        SmMeshInfo is = sm_mesh_info(&given), wanted = sm_mesh_info(&imported);
        assert_int_equal(is.triangles, 24);
        assert_int_equal(is.vertices, wanted.vertices);
        assert_int_equal(is.triangles, wanted.triangles);
        assert_true(is.watertight && wanted.watertight && !is.degenerate);
        for (int d = 0; d < 3; d++) {
            assert_true(fabs(is.low[d] - wanted.low[d]) <= 1e-7);
            assert_true(fabs(is.high[d] - wanted.high[d]) <= 1e-7);
        }
        sm_mesh_free(&imported);
        sm_mesh_free(&given);
    }
}

/* The text says all that bench_scene_drop() does. */
TEST(it_is_dropped_as_the_program_drops_it)
{
    static const double place[3] = {3, 1e7, -5e-9};
    static BenchScene said, wanted;
    SmMesh mesh;
    SmError error;
    assert_string_equal(give(&prism, place, 1e5), "");
    const char *text = view_given_scene();
    if (bench_scene_parse(text, strlen(text), "scene", &said, &error)) fail_msg("%s", error.text);
    if (view_given_load(said.mesh, &mesh, &error)) fail_msg("%s", error.text);
    bench_scene_drop(&mesh, "prism.obj", &wanted);
    sm_mesh_free(&mesh);
    assert_string_equal(said.title, wanted.title);
    assert_int_equal(said.voxel.fill, wanted.voxel.fill);
    assert_int_equal(said.voxel.particles, wanted.voxel.particles);
    assert_int_equal(said.params.w, wanted.params.w);
    assert_true(said.params.h == wanted.params.h);
    assert_true(said.params.damping == wanted.params.damping);
    assert_memory_equal(said.params.gravity, wanted.params.gravity, sizeof said.params.gravity);
    assert_int_equal(said.obstacle_count, 1);
    const SmObstacle *is = said.obstacle, *ground = wanted.obstacle;
    assert_int_equal(is->kind, ground->kind);
    assert_memory_equal(is->a, ground->a, sizeof is->a);
    assert_memory_equal(is->b, ground->b, sizeof is->b);
    assert_true(is->friction == ground->friction);
    assert_int_equal(said.steps_per_frame, wanted.steps_per_frame);
    assert_int_equal(said.frames, wanted.frames);
    assert_int_equal(opened(text), 0);
    BenchBody body;
    strcpy(wanted.mesh, write_obj(&prism, place, 1e5));
    if (bench_body_of_scene(&wanted, NULL, &body, &error)) fail_msg("%s", error.text);
    assert_true(view_figure(VIEW_LATTICE, VIEW_PARTICLES) == (double)body.voxels.particle_count);
    assert_true(view_figure(VIEW_LATTICE, VIEW_CELL) == body.voxels.cell);
    bench_body_free(&body);
}

static void expect_refusal(const Polygons *polygons, const char *part)
{
    static const double origin[3];
    const char *said = give(polygons, origin, 1);
    if (!strstr(said, "prism.obj: ") || !strstr(said, part))
        fail_msg("\"%s\" lacks \"%s\"", said, part);
    assert_string_equal(view_given_scene(), "");
}

TEST(what_is_no_mesh_is_refused)
{
    const double nan_point[][3] = {{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}, {0, INFINITY, 0}};
    const double one_point[][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    const int three[] = {3}, two[] = {2}, many[] = {1 << 30}, less[] = {-1}, four[] = {4};
    const int corner[] = {0, 1, 2, 3}, beyond[] = {0, 1, 2, 14}, below[] = {0, 1, -1};
    expect_refusal(&(Polygons){0, 0, 0, prism_point, two, corner}, "no triangles");
    expect_refusal(&(Polygons){3, 1, 2, prism_point, two, corner}, "no triangles");
    expect_refusal(&(Polygons){3, 1, 3, nan_point, three, corner}, "the x of a vertex is not");
    expect_refusal(&(Polygons){4, 1, 4, nan_point, four, corner}, "the x of a vertex is not");
    expect_refusal(&(Polygons){3, 1, 3, one_point, three, corner}, "all vertices are at one point");
    expect_refusal(&(Polygons){14, 1, 4, prism_point, four, beyond}, "names a vertex that is not");
    expect_refusal(&(Polygons){14, 1, 3, prism_point, three, below}, "names a vertex that is not");
    expect_refusal(&(Polygons){3, 1, 3, prism_point, many, corner}, "more corners than were read");
    expect_refusal(&(Polygons){3, 1, 3, prism_point, less, corner}, "more corners than were read");
}

TEST(a_polygon_of_too_many_corners_is_refused)
{
    enum { CORNERS = 30000 };
    int *corner = sm_alloc(CORNERS, sizeof *corner);
    double(*point)[3] = sm_alloc(CORNERS, sizeof *point);
    const int size[] = {CORNERS};
    for (int c = 0; c < CORNERS; c++) point[corner[c] = c][c % 3] = c;
    expect_refusal(&(Polygons){CORNERS, 1, CORNERS, (const double(*)[3])point, size, corner},
                   "more corners than a page can cut");
    free(corner);
    free(point);
}

/* A scene whose mesh is not there leaves all as it was. */
TEST(a_scene_asks_for_its_mesh)
{
    static const double origin[3];
    assert_string_equal(give(&prism, origin, 1), "");
    assert_int_equal(opened("mesh = \"a/prism.obj\"; particles = 300;"), 0);
    double particles = view_figure(VIEW_LATTICE, VIEW_PARTICLES);
    assert_int_equal(opened("mesh = \"other.obj\"; particles = 500;"), SM_INPUT);
    assert_non_null(strstr(view_message(), "'other.obj' is not in this page"));
    assert_true(view_figure(VIEW_LATTICE, VIEW_PARTICLES) == particles);
    assert_int_equal(opened("mesh = \"shape:hand\"; particles = 500; vertex_mass = \"m\";"),
                     SM_INPUT);
    assert_non_null(strstr(view_message(), "give 'density'"));
    assert_int_equal(opened("mesh = \"shape:nothing\"; particles = 500;"), SM_USAGE);
    assert_non_null(strstr(view_message(), "no such shape"));
}
