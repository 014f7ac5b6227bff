/* A mesh that the page hands over is the one that the program imports, and is dropped as it drops
 * one; a file that is refused is refused in the program's words. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../../lib/mesh/import.h"
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../engines.h"
#include "../scene/body.h"
#include "given.h"
#include "view.h"

/* An L-shaped prism, of which two polygons have corners on straight sides. */
static const double prism_point[14][3] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0},
                                          {0, 2, 0}, {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1},
                                          {1, 2, 1}, {0, 2, 1}, {1, 0, 0}, {1, 0, 1}};
static const char prism_faces[] =
    "f 6 5 4 3 2 13 1\nf 7 14 8 9 10 11 12\nf 1 13 14 7\nf 13 2 8 14\nf 2 3 9 8\nf 3 4 10 9\n"
    "f 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\nl 1 2\n";

/* The text of an OBJ of it, moved and scaled. */
static const char *prism(const double offset[3], double scale)
{
    static char text[4096];
    size_t used = 0;
    for (int v = 0; v < 14; v++) {
        double at[3];
        for (int d = 0; d < 3; d++) at[d] = scale * prism_point[v][d] + offset[d];
        used += (size_t)sprintf(text + used, "v %.17g %.17g %.17g\n", at[0], at[1], at[2]);
    }
    strcpy(text + used, prism_faces);
    return text;
}

static void put(const char *name, const char *text)
{
    memcpy(view_given_room(name, (int)strlen(text)), text, strlen(text));
}

/* Hands it over; what is said of it. */
static const char *give(const char *name, const char *text)
{
    put(name, text);
    return view_given_take(name);
}

static int opened(const char *text)
{
    strcpy(view_room((int)strlen(text)), text);
    return view_open((int)strlen(text), 0);
}

/* Checks that the mesh that was given is the one in the program's file, bit for bit. */
static void expect_same(const char *path)
{
    SmMesh imported, given;
    SmError error;
    const char *name = strrchr(path, '/') + 1;
    if (sm_import(path, NULL, &imported, NULL, &error)) fail_msg("%s", error.text);
    if (view_given_load(name, &given, &error)) fail_msg("%s", error.text);
    assert_int_equal(given.vertex_count, imported.vertex_count);
    assert_int_equal(given.triangle_count, imported.triangle_count);
    assert_memory_equal(given.position, imported.position,
                        (size_t)given.vertex_count * sizeof *given.position);
    assert_memory_equal(given.triangle, imported.triangle,
                        (size_t)given.triangle_count * sizeof *given.triangle);
    sm_mesh_free(&imported);
    sm_mesh_free(&given);
}

TEST(a_mesh_is_the_one_that_is_imported)
{
    static const double places[][3] = {{0, 0, 0}, {0.1, -0.3, 1.7}, {665171.25, 5648340.125, 30}};
    for (int i = 0; i < 3; i++) {
        const char *text = prism(places[i], 0.7);
        assert_string_equal(give("prism.obj", text), "");
        expect_same(write_text("prism.obj", text));
        assert_string_equal(view_given_left_out(), "prism.obj: left out: lines: 1");
    }
}

/* A tetrahedron, whose buffer is beside it. */
static const char tetrahedron[] =
    "{'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}],"
    "'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1}]}],"
    "'buffers': [{'uri': 'parts/a%20b.bin', 'byteLength': 60}], 'bufferViews':"
    "[{'buffer': 0, 'byteLength': 48}, {'buffer': 0, 'byteLength': 12, 'byteOffset': 48}],"
    "'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 4, 'type': 'VEC3'},"
    "{'bufferView': 1, 'componentType': 5121, 'count': 12, 'type': 'SCALAR'}]}";
static const struct {
    float point[4][3];
    unsigned char corner[12];
} buffer = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}};

TEST(a_buffer_lies_beside_its_mesh)
{
    char text[sizeof tetrahedron];
    for (size_t c = 0; c < sizeof text; c++)
        text[c] = tetrahedron[c] == '\'' ? '"' : tetrahedron[c];
    assert_non_null(strstr(give("t.gltf", text), "t.gltf: "));
    memcpy(view_given_room("a b.bin", sizeof buffer), &buffer, sizeof buffer);
    assert_string_equal(give("t.gltf", text), "");
    assert_int_equal(mkdir(path_in("parts"), 0700), 0);
    write_bytes("parts/a b.bin", &buffer, sizeof buffer);
    expect_same(write_text("t.gltf", text));
    assert_non_null(strstr(give("t.gltf", text), "t.gltf: ")); /* each time with all its files */
}

/* The text says all that bench_scene_drop() does. */
TEST(it_is_dropped_as_the_program_drops_it)
{
    static const double place[3] = {3, 1e7, -5e-9};
    static BenchScene said, wanted;
    SmMesh mesh;
    SmError error;
    assert_string_equal(give("prism.obj", prism(place, 1e5)), "");
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
    strcpy(wanted.mesh, write_text("prism.obj", prism(place, 1e5)));
    if (bench_body_of_scene(&wanted, NULL, &body, &error)) fail_msg("%s", error.text);
    assert_true(view_figure(VIEW_LATTICE, VIEW_PARTICLES) == (double)body.voxels.particle_count);
    assert_true(view_figure(VIEW_LATTICE, VIEW_CELL) == body.voxels.cell);
    bench_body_free(&body);
}

TEST(what_is_no_mesh_is_refused_in_the_same_words)
{
    static const char *const texts[] = {"",
                                        "words\n",
                                        "v 0 0 0\n",
                                        "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
                                        "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n",
                                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"};
    for (size_t t = 0; t < sizeof texts / sizeof *texts; t++) {
        SmMesh mesh;
        SmError error;
        const char *path = write_text("bad.obj", texts[t]);
        assert_int_equal(sm_import(path, NULL, &mesh, NULL, &error), SM_INPUT);
        assert_string_equal(give("bad.obj", texts[t]), strstr(error.text, "bad.obj: "));
        assert_string_equal(view_given_scene(), "");
    }
}

TEST(a_mesh_of_too_many_triangles_is_refused)
{
    static const char points[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face[] = "f 1 2 3\n";
    enum { MOST = 1000000, POINTS = sizeof points - 1, FACE = sizeof face - 1 };
    char *text = sm_alloc(POINTS + FACE * (MOST + 1) + 1, 1);
    memcpy(text, points, POINTS);
    for (size_t f = 0; f <= MOST; f++) memcpy(text + POINTS + FACE * f, face, FACE);
    assert_non_null(strstr(give("large.obj", text), "takes at most 1000000"));
    text[POINTS + FACE * MOST] = 0;
    assert_string_equal(give("large.obj", text), "");
    free(text);
}

/* A scene whose mesh is not there leaves all as it was. */
TEST(a_scene_asks_for_its_mesh)
{
    static const double origin[3];
    assert_string_equal(give("prism.obj", prism(origin, 1)), "");
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
