#include "../system/child.h"
#include "../test_frame.h"
#include "import.h"
#include "mesh_text.h"
#include "reply.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../test_folder.h"

/* cmocka's assert_float_equal() compares in single precision. */
static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) fail_msg("%.17g is not %.17g", value, expected);
}

static SmMeshInfo import_info(const char *path)
{
    SmMesh mesh;
    SmError error = {0};
    if (sm_import(path, NULL, &mesh, &error) != SM_OK) fail_msg("%s", error.text);
    SmMeshInfo info = sm_mesh_info(&mesh);
    sm_mesh_free(&mesh);
    return info;
}

static void expect_error(const char *path, const SmImportLimits *limits, const char *part)
{
    SmMesh mesh;
    SmError error = {0};
    assert_int_equal(sm_import(path, limits, &mesh, &error), SM_INPUT);
    assert_int_equal(strncmp(error.text, path, strlen(path)), 0);
    if (!strstr(error.text, part)) fail_msg("\"%s\" lacks \"%s\"", error.text, part);
    assert_null(mesh.position);
}

static int open_descriptors(void)
{
    int count = 0;
    DIR *listing = opendir("/proc/self/fd");
    assert_non_null(listing);
    while (readdir(listing)) count++;
    closedir(listing);
    return count;
}

static const char tetrahedron_off[] = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                                      "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

TEST(test_formats)
{
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
        "property double z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                              "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    const char *const paths[][2] = {{"a.off", tetrahedron_off}, {"a.ply", ply}, {"A.OBJ", obj}};
    for (int i = 0; i < 3; i++) {
        SmMeshInfo info = import_info(write_text(paths[i][0], paths[i][1]));
        assert_int_equal(info.triangles, 4);
        assert_int_equal(info.vertices, 4);
        assert_true(info.watertight);
        assert_near(info.volume, 1.0 / 6, 1e-7);
    }
}

/* An L-shaped prism of n-gons, one with corners on its straight sides. */
TEST(test_polygons)
{
    static const char obj[] =
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
        "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nv 1 0 0\nv 1 0 1\n"
        "f 6 5 4 3 2 13 1\nf 7 14 8 9 10 11 12\nf 1 13 14 7\nf 13 2 8 14\nf 2 3 9 8\n"
        "f 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";
    SmMeshInfo info = import_info(write_text("prism.obj", obj));
    assert_int_equal(info.triangles, 24);
    assert_int_equal(info.degenerate + info.duplicates + info.flipped_edges, 0);
    assert_true(info.watertight);
    assert_near(info.volume, 3, 1e-6);
}

TEST(test_far_from_origin)
{
    static const char *const text[][2] = {
        {"far.obj", "v %1$.4f %2$.4f 0\nv %3$.4f %2$.4f 0 0.5 0.5 0.5\nv %1$.4f %4$.4f 0\n"
                    "v %1$.4f %2$.4f 0.01\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"},
        {"far.off", "OFF\n# grid\n4 4 6\n%1$.4f %2$.4f 0\n%3$.4f %2$.4f 0\n%1$.4f %4$.4f 0\n"
                    "%1$.4f %2$.4f 0.01\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"},
        {"far.stl", "solid s\n facet normal 0 0 0\n  outer loop\n   vertex %1$.4f %2$.4f 0\n"
                    "   vertex %3$.4f %2$.4f 0\n   vertex %1$.4f %4$.4f 0.01\n  endloop\n"
                    " endfacet\nendsolid s\n"},
    };
    const double x = 665171.25, y = 5648340.125;
    for (int i = 0; i < 3; i++) {
        char filled[1024];
        snprintf(filled, sizeof filled, text[i][1], x, y, x + 0.02, y + 0.03);
        SmMeshInfo info = import_info(write_text(text[i][0], filled));
        assert_near(info.low[0], x, 1e-6);
        assert_near(info.low[1], y, 1e-6);
        assert_near(info.high[0] - info.low[0], 0.02, 1e-8);
        assert_near(info.high[1] - info.low[1], 0.03, 1e-8);
        assert_int_equal(info.degenerate, 0);
    }
}

/* Two nodes use one mesh; one moves it, the other mirrors it. */
TEST(test_node_transforms)
{
    char text[4096];
    static const char geometry[] =
        "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" "
        "count=\"12\">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor "
        "source=\"#pa\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/><param "
        "name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
        "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" "
        "source=\"#p\"/></vertices><triangles count=\"4\"><input semantic=\"VERTEX\" "
        "source=\"#v\" offset=\"0\"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh>"
        "</geometry></library_geometries>";
    snprintf(text, sizeof text,
             "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/"
             "COLLADASchema\" version=\"1.4.1\"><asset><up_axis>Y_UP</up_axis></asset>%s"
             "<library_visual_scenes><visual_scene id=\"s\"><node><translate>10 0 0</translate>"
             "<node><translate>0 5 0</translate><instance_geometry url=\"#g\"/></node></node>"
             "<node><scale>-2 1 1</scale><instance_geometry url=\"#g\"/></node>"
             "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
             "url=\"#s\"/></scene></COLLADA>",
             geometry);
    SmMeshInfo info = import_info(write_text("two.dae", text));
    assert_int_equal(info.components, 2);
    assert_true(info.watertight);
    assert_near(info.volume, 0.5, 1e-6); /* 1/6 and, outside kept, 2/6 */
    assert_near(info.low[0], -2, 1e-6);
    assert_near(info.high[0], 11, 1e-6);
    assert_near(info.high[1], 6, 1e-6);
}

TEST(test_unusable_files)
{
    expect_error(path_in("missing.obj"), NULL, "no such file");
    expect_error(folder, NULL, "is a directory");
    expect_error("/dev/null", NULL, "is a pipe or device");
    expect_error(write_text("empty.obj", ""), NULL, "empty");
    expect_error(write_text("text.docx", "hello"), NULL, "save it as OBJ");
    expect_error(write_text("nosuffix", "hello"), NULL, "save it as OBJ");
    expect_error(write_text("words.obj", "these are words\n"), NULL, "");
    expect_error(write_text("words.stl", "solid words\n"), NULL, "");
    expect_error(write_text("words.glb", "glTF but not quite"), NULL, "");
    expect_error(write_text("points.xyz", "1 2 3\n"), NULL, "run --engine meshless");
    expect_error(write_text("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), NULL,
                 "the x of a vertex is not a finite number");
    expect_error(write_text("high.obj", "v 0 0 0\nv 1 0 inf\nv 0 1 0\nf 1 2 3\n"), NULL,
                 "the z of a vertex is not a finite number");
    expect_error(write_text("number.obj", "v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n"), NULL,
                 "is it damaged or cut off? Export it again");
    expect_error(write_text("same.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), NULL, "one point");
    expect_error(write_text("points.ply", "ply\nformat ascii 1.0\nelement vertex 2\n"
                                          "property float x\nproperty float y\n"
                                          "property float z\nend_header\n0 0 0\n1 1 1\n"),
                 NULL, "only points");
}

TEST(test_no_permission_to_read)
{
    const char *secret = write_text("secret.obj", "v 0 0 0\n");
    assert_int_equal(chmod(secret, 0), 0);
    needs(access(secret, R_OK) != 0, "this user (root?) may read every file");
    expect_error(secret, NULL, "cannot be opened");
}

/* Truncated at every length, a mesh is read or refused; nothing crashes through. */
TEST(test_truncated)
{
    for (size_t length = 1; length < sizeof tetrahedron_off; length += 6) {
        const char *path = write_bytes("cut.off", tetrahedron_off, length);
        SmMesh mesh;
        SmError error = {0};
        SmCode code = sm_import(path, NULL, &mesh, &error);
        assert_true(code == SM_OK ? mesh.triangle_count > 0 : strstr(error.text, path) != NULL);
        sm_mesh_free(&mesh);
    }
}

/* A glTF file of a tetrahedron whose buffer has that name, and the buffer; its last index is given.
 */
static void write_gltf(const char *name, const char *uri, const char *buffer, unsigned short last)
{
    static const float corner[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const unsigned short index[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, last};
    char bytes[sizeof corner + sizeof index], text[1024];
    memcpy(bytes, corner, sizeof corner);
    memcpy(bytes + sizeof corner, index, sizeof index);
    write_bytes(buffer, bytes, sizeof bytes);
    snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"meshes\":[{"
        "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"buffers\":[{"
        "\"byteLength\":72,\"uri\":\"%s\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{"
        "\"buffer\":0,\"byteOffset\":48,\"byteLength\":24}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},{\"bufferView\":1,"
        "\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],\"nodes\":[{\"mesh\":0}]}",
        uri);
    write_text(name, text);
}

TEST(no_file_beyond_the_folder_is_read)
{
    char inner[300], outer[320];
    snprintf(inner, sizeof inner, "%s", path_in("inner"));
    assert_int_equal(mkdir(inner, 0700), 0);
    assert_int_equal(mkdir(path_in("inner/sub"), 0700), 0);
    write_gltf("inner/in.gltf", "in.bin", "inner/in.bin", 2);
    write_gltf("inner/sub.gltf", "sub/in.bin", "inner/sub/in.bin", 2);
    write_gltf("inner/out.gltf", "../out.bin", "out.bin", 2);
    write_gltf("inner/link.gltf", "link.bin", "out.bin", 2);
    assert_int_equal(symlink("../out.bin", path_in("inner/link.bin")), 0);
    write_gltf("inner/pipe.gltf", "pipe.bin", "out.bin", 2);
    assert_int_equal(mkfifo(path_in("inner/pipe.bin"), 0600), 0);
    assert_int_equal(import_info(path_in("inner/in.gltf")).triangles, 4);
    assert_int_equal(import_info(path_in("inner/sub.gltf")).triangles, 4);
    snprintf(outer, sizeof outer, "%s/out.gltf", inner);
    expect_error(outer, NULL, "which does not lie in its folder");
    snprintf(outer, sizeof outer, "%s/link.gltf", inner);
    expect_error(outer, NULL, "which does not lie in its folder");
    snprintf(outer, sizeof outer, "%s/pipe.gltf", inner);
    expect_error(outer, NULL, "could not open");
}

/* A mesh of 100,000 triangles, used 100 times: 10 million in a file of a megabyte. */
TEST(parts_used_again_and_again_are_counted_first)
{
    FILE *file = fopen(path_in("many.dae"), "w");
    fputs("<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
          "version=\"1.4.1\"><library_geometries><geometry id=\"g\"><mesh><source id=\"p\">"
          "<float_array id=\"pa\" count=\"9\">0 0 0 1 0 0 0 1 0</float_array><technique_common>"
          "<accessor source=\"#pa\" count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/>"
          "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
          "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" "
          "source=\"#p\"/></vertices><triangles count=\"100000\"><input semantic=\"VERTEX\" "
          "source=\"#v\" offset=\"0\"/><p>",
          file);
    for (int t = 0; t < 100000; t++) fputs("0 1 2 ", file);
    fputs("</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
          "<visual_scene id=\"s\">",
          file);
    for (int n = 0; n < 100; n++) fputs("<node><instance_geometry url=\"#g\"/></node>", file);
    fputs(
        "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene>"
        "</COLLADA>",
        file);
    fclose(file);
    expect_error(path_in("many.dae"), NULL, "it uses its parts so often");
}

TEST(numbers_that_the_importer_alters_are_refused)
{
    static const char start[] =
        "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n";
    static const char *const last[] = {"3 0 3 4\n", "3 0 3 -1\n", "3 0 3 4294967298\n", ""};
    for (int i = 0; i < 4; i++) {
        char text[256];
        snprintf(text, sizeof text, "%s%s", start, last[i]);
        expect_error(write_text("last.off", text), NULL, "Export it again");
    }
    static const char *const keyword[] = {"OFF ", "# a\nCOFF # b\n", "\nOFF\n\n"};
    for (int i = 0; i < 3; i++) { /* whole coordinates are no faces, wherever the counts stand */
        char text[256];
        snprintf(text, sizeof text, "%s4 4 0\n1 5 3\n2 7 9\n3 1 2\n4 4 4\n%s%s", keyword[i],
                 "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 ", i % 2 ? "4\n" : "2\n");
        assert_true(sm_off_out_of_range(text) == (i % 2 == 1));
        if (i == 0) assert_int_equal(import_info(write_text("whole.off", text)).triangles, 4);
    }
    write_gltf("last.gltf", "last.bin", "last.bin", 9);
    expect_error(path_in("last.gltf"), NULL, "out-of-range");
    expect_error(write_text("last.ply",
                            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                            "property float y\nproperty float z\nelement face 2\n"
                            "property list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                 NULL, "fewer lines than its header says");
}

static int body_echo(void *argument, int reply)
{
    return !sm_child_write(reply, argument, strlen(argument));
}

static int body_flood(void *argument, int reply)
{
    static const char block[65536];
    (void)argument;
    while (sm_child_write(reply, block, sizeof block)) continue;
    return 0;
}

static int body_crash(void *argument, int reply)
{
    (void)reply;
    raise(*(int *)argument);
    return 0;
}

static int body_sleep(void *argument, int reply)
{
    (void)argument;
    (void)reply;
    for (;;) pause();
    return 0;
}

static int body_close_and_sleep(void *argument, int reply)
{
    close(reply);
    return body_sleep(argument, reply);
}

static int body_status(void *argument, int reply)
{
    (void)reply;
    return *(int *)argument;
}

static int body_hungry(void *argument, int reply)
{
    (void)argument;
    (void)reply;
    for (int megabyte = 0; megabyte < 1024; megabyte++) {
        char *volatile block = malloc(1 << 20); /* or clang leaves it out */
        if (!block) return SM_CHILD_NO_MEMORY;
        memset(block, 1, 1 << 20);
    }
    return 0;
}

static SmChildResult run_child(SmChildBody body, void *argument, double seconds)
{
    SmChildLimits limits = {seconds, 64};
    int before = open_descriptors();
    SmChildResult result = sm_child_run(body, argument, &limits);
    assert_int_equal(open_descriptors(), before);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* no child, living or dead */
    assert_int_equal(errno, ECHILD);
    return result;
}

TEST(test_child_ends)
{
    char word[] = "words";
    SmChildResult result = run_child(body_echo, word, 20);
    assert_int_equal(result.end, SM_CHILD_REPLIED);
    assert_int_equal(result.size, 5);
    assert_memory_equal(result.reply, word, 5);
    free(result.reply);

    int signals[] = {SIGSEGV, SIGABRT, SIGKILL};
    for (int i = 0; i < 3; i++) {
        result = run_child(body_crash, &signals[i], 20);
        assert_int_equal(result.end, SM_CHILD_CRASHED);
        assert_int_equal(result.signal, signals[i]);
        free(result.reply);
    }
    int status = 3;
    result = run_child(body_status, &status, 20);
    assert_int_equal(result.end, SM_CHILD_CRASHED);
    assert_int_equal(result.status, 3);
    free(result.reply);
}

TEST(test_child_limits)
{
    SmChildResult result = run_child(body_sleep, NULL, 0.2);
    assert_int_equal(result.end, SM_CHILD_TOO_LONG);
    free(result.reply);
    result = run_child(body_close_and_sleep, NULL, 0.2);
    assert_int_equal(result.end, SM_CHILD_TOO_LONG);
    free(result.reply);
    result = run_child(body_flood, NULL, 20);
    assert_int_equal(result.end, SM_CHILD_TOO_LARGE);
    free(result.reply);
}

static void needs_memory_limit(void)
{
    needs(SM_CHILD_LIMITS_MEMORY, "sanitizers leave a child's memory without a limit");
}

TEST(test_child_without_memory)
{
    needs_memory_limit();
    SmChildResult result = run_child(body_hungry, NULL, 20);
    assert_int_equal(result.end, SM_CHILD_TOO_LARGE);
    free(result.reply);
}

/* A file that takes long to read. */
static const char *write_long(void)
{
    const char *path = path_in("long.obj");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int i = 0; i < 200000; i++) fprintf(file, "v %d 0 1\n", i);
    fprintf(file, "f 1 2 3\n");
    fclose(file);
    return path;
}

TEST(test_import_limits_time)
{
    expect_error(write_long(), &(SmImportLimits){0.001, 0}, "longer than 0.001 s");
}

TEST(test_import_limits_memory)
{
    needs_memory_limit();
    expect_error(write_long(), &(SmImportLimits){0, 2}, "more than 2 MB");
}

TEST(test_parent_ignores_children)
{
    void (*old)(int) = signal(SIGCHLD, SIG_IGN);
    SmMeshInfo info = import_info(write_text("a.off", tetrahedron_off));
    signal(SIGCHLD, old);
    assert_int_equal(info.triangles, 4);
}

/* Children forked by many threads at once neither hold up nor disturb one another. */
TEST(test_parallel_imports)
{
    const char *path = write_text("a.off", tetrahedron_off);
    int before = open_descriptors(), good = 0;
#pragma omp parallel for num_threads(4) reduction(+ : good)
    for (int i = 0; i < 16; i++) {
        SmMesh mesh;
        good += sm_import(path, NULL, &mesh, NULL) == SM_OK && mesh.triangle_count == 4;
        sm_mesh_free(&mesh);
    }
    assert_int_equal(good, 16);
    assert_int_equal(open_descriptors(), before);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

TEST(test_broken_replies)
{
    unsigned char reply[sizeof(SmReplyHeader) + 64] = {0};
    SmReplyHeader header = {.magic = SM_REPLY_MAGIC, .vertex_count = 1, .triangle_count = 1};
    SmReplyHeader bad[6];
    for (int i = 0; i < 6; i++) bad[i] = header;
    bad[0].magic++;
    bad[1].vertex_count = -1;
    bad[2].triangle_count = INT64_MAX;
    bad[3].vertex_count = INT32_MAX;
    bad[4].text_length = UINT32_MAX;
    bad[5].text_length = 1;
    SmMesh mesh;
    SmError error;
    for (int i = 0; i < 6; i++) {
        memcpy(reply, &bad[i], sizeof header);
        assert_int_equal(sm_reply_read(reply, sizeof header + 36, "f", &mesh, &error), SM_INPUT);
        assert_string_equal(error.text, "f: the importer's reply is broken");
    }
    memcpy(reply, &header, sizeof header);
    for (size_t size = 0; size < sizeof header + 36; size++)
        assert_int_equal(sm_reply_read(reply, size, "f", &mesh, &error), SM_INPUT);
    reply[sizeof header + 24] = 7;
    assert_int_equal(sm_reply_read(reply, sizeof header + 36, "f", &mesh, &error), SM_INPUT);
    assert_string_equal(error.text,
                        "f: a triangle names a vertex that is not there; export the mesh again");
}

TEST(test_shared_meshes)
{
    static const struct {
        const char *name;
        long triangles, components, open, nonmanifold, flipped, duplicates;
    } expected[] = {
        {"armadillo.obj", 29170, 1, 0, 0, 0, 0},
        {"tray_plate.STL", 4520, 1, 0, 0, 0, 0},
        {"liver_female_layered.glb", 93303, 9, 709, 2, 0, 0},
        {"bunny_duplicates.ply", 5766, 1, 0, 0, 0, 0},
        {"bunny_zipper_res2_nonmanifold.ply", 16301, 1, 123, 150, 0, 87},
        {"bad_huge_coordinates_city.obj", 28619, 1, 950, 42, 0, 8},
        {"bad_rounding_gaps.STL", 3476, 1, 0, 0, 0, 0},
        {"bad_house_ngons.obj", 66, 1, 0, 0, 0, 0},
        {"bad_spider_degenerate.stl", 1368 - 56, 18, 72, 0, 10, 0},
    };
    const char *shared = getenv("SHAPEBENCH_MESHES");
    if (!shared) shared = SOURCE_DIR "/../shared/meshes";
    needs(access(shared, R_OK) == 0, "SHAPEBENCH_MESHES names no folder of meshes");
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s", shared, expected[i].name);
        SmMeshInfo info = import_info(path);
        assert_int_equal(info.triangles, expected[i].triangles);
        assert_int_equal(info.components, expected[i].components);
        assert_int_equal(info.open_edges, expected[i].open);
        assert_int_equal(info.nonmanifold_edges, expected[i].nonmanifold);
        assert_int_equal(info.flipped_edges, expected[i].flipped);
        assert_int_equal(info.duplicates, expected[i].duplicates);
    }
}
