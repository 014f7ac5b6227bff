/* Mesh files, and what lies beside them. */
#include <sys/stat.h>
#include <unistd.h>

#include "test_meshes.h"

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

TEST(test_unusable_files)
{
    expect_error(path_in("missing.obj"), NULL, "no such file");
    expect_error(folder, NULL, "is a directory");
    expect_error("/dev/null", NULL, "is a pipe or device");
    expect_error(write_text("empty.obj", ""), NULL, "empty");
    expect_error(write_text("text.docx", "hello"), NULL, "save it as ");
    expect_error(write_text("nosuffix", "hello"), NULL, "save it as ");
    expect_error(write_text("words.glb", "glTF but not quite"), NULL, "");
    expect_error(write_text("points.xyz", "1 2 3\n"), NULL, "run --engine meshless");
    expect_error(write_text("points.las", "LASF"), NULL, "a point format that is not read");
}

TEST(test_no_permission_to_read)
{
    const char *secret = write_text("secret.obj", "v 0 0 0\n");
    assert_int_equal(chmod(secret, 0), 0);
    needs(access(secret, R_OK) != 0, "this user (root?) may read every file");
    expect_error(secret, NULL, "cannot be opened");
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
    expect_error(outer, NULL, "which is not in its folder");
    snprintf(outer, sizeof outer, "%s/link.gltf", inner);
    expect_error(outer, NULL, "which is not in its folder");
    snprintf(outer, sizeof outer, "%s/pipe.gltf", inner);
    expect_error(outer, NULL, "which is not in its folder");
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
