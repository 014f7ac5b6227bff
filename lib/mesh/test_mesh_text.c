/* PLY files with their faces first: reordered they say the same, and what is not one is left. */
#include "../test_frame.h"
#include "import.h"
#include "mesh_text.h"

#include "../test_folder.h"

/* A tetrahedron: faces and an element that nobody knows, then vertices. */
static const char header[] = "ply\nformat %s 1.0\ncomment c\nelement face 4\n"
                             "property list uchar %s vertex_indices\nelement odd 2\n"
                             "property uchar a\nproperty list ushort short b\n"
                             "element vertex 4\nproperty float x\nproperty float y\n"
                             "property float z\nend_header\n";

static void assert_tetrahedron(const char *bytes, size_t size, double low)
{
    const char *path = write_bytes("tetrahedron.ply", bytes, size);
    SmMesh mesh;
    SmError error = {0};
    SmCode code = sm_import(path, NULL, &mesh, &error);
    if (code != SM_OK) fail_msg("%s", error.text);
    SmMeshInfo info = sm_mesh_info(&mesh);
    sm_mesh_free(&mesh);
    assert_int_equal(info.triangles, 4);
    assert_int_equal(info.vertices, 4);
    assert_true(info.watertight);
    assert_true(fabs(info.volume - 1.0 / 6) < 1e-7);
    assert_true(fabs(info.low[0] - low) < 1e-9);
}

/* Without a last newline, which then ends up in the middle; near the origin and far from it. */
TEST(test_ascii)
{
    static const char faces[] = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n", odd[] = "7 2 5 6\n8 0\n";
    static const char *const vertices[2] = {
        "0 0 0\n1 0 0\n0 1 0\n0 0 1",
        "1000000.25 0 0\n1000001.25 0 0\n1000000.25 1 0\n1000000.25 0 1"};
    for (int i = 0; i < 2; i++) {
        char text[1024], expected[96];
        int length = snprintf(text, sizeof text, header, "ascii", "int");
        snprintf(text + length, sizeof text - (size_t)length, "%s%s%s", faces, odd, vertices[i]);
        assert_tetrahedron(text, strlen(text), i ? 1000000.25 : 0);
        size_t size;
        char *copy = sm_ply_ordered(text, strlen(text), &size);
        assert_non_null(copy);
        assert_int_equal(size, strlen(text) + 1);
        const char *data = strstr(copy, "end_header\n") + 11;
        snprintf(expected, sizeof expected, "%s\n3 0 2 1\n", vertices[i]);
        assert_memory_equal(data, expected, strlen(vertices[i]) + 9);
        assert_null(sm_ply_ordered(copy, size, &size));
        free(copy);
    }
}

/* Two to a line, and one over two lines: whatever the lines, the words say what is meant. */
TEST(test_lines_do_not_matter)
{
    static const char start[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                                "property float y\nproperty float z\nelement face 4\n"
                                "property list uchar int vertex_indices\nend_header\n";
    static const char *const data[] = {
        "0 0 0 1 0 0\n0 1 0\t0 0 1\n3 0 2 1 3 0 1 3\n3 1 2 3 3 0 3 2\n",
        "0 0 0\r\n1 0\r\n0\r\n0 1 0\r\n 0 0 1\r\n3 0 2\r\n 1\r\n3 0 1 3\r\n3 1 2 3\r\n3 0 3 2",
        "0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2"};
    char text[512];
    size_t size;
    for (size_t i = 0; i < sizeof data / sizeof *data; i++) {
        snprintf(text, sizeof text, "%s%s", start, data[i]);
        assert_tetrahedron(text, strlen(text), 0);
        char *copy = sm_ply_ordered(text, strlen(text), &size);
        assert_non_null(copy);
        assert_null(sm_ply_ordered(copy, size, &size));
        free(copy);
    }
    snprintf(text, sizeof text, "%s%s 9\n", start, data[0]); /* a word too many: left alone */
    assert_null(sm_ply_ordered(text, strlen(text), &size));
}

static size_t make_binary(bool big, char bytes[512])
{
    static const char faces[16] = {3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 3, 2};
    static const char one[2][4] = {{0, 0, -128, 63}, {63, -128, 0, 0}};
    static const char odd[2][10] = {{7, 2, 0, 1, 0, 1, 0, 8, 0, 0}, {7, 0, 2, 0, 1, 0, 1, 8, 0, 0}};
    const char *format = big ? "binary_big_endian" : "binary_little_endian";
    memset(bytes, 0, 512);
    size_t size = (size_t)snprintf(bytes, 512, header, format, "uchar");
    memcpy(bytes + size, faces, 16);
    memcpy(bytes + size + 16, odd[big], 10);
    size += 26;
    for (size_t v = 1; v < 4; v++) memcpy(bytes + size + 12 * v + 4 * (v - 1), one[big], 4);
    return size + 48;
}

TEST(test_binary)
{
    for (int big = 0; big < 2; big++) {
        char bytes[512];
        assert_tetrahedron(bytes, make_binary(big, bytes), 0);
    }
}

/* Cut off anywhere, or with a header that promises too much: no copy and no crash. */
TEST(test_what_is_left_alone)
{
    char bytes[512];
    size_t size = make_binary(false, bytes), new_size;
    for (size_t length = 0; length < size; length++) {
        char *cut = malloc(length + 1);
        memcpy(cut, bytes, length);
        cut[length] = 0;
        assert_null(sm_ply_ordered(cut, length, &new_size));
        free(cut);
    }
    static const char *const texts[] = {
        "",
        "ply\n",
        "solid\nelement face 0\nproperty int a\nelement vertex 0\n",
        "ply\nformat ascii 1.0\nproperty int x\nend_header\n",
        "ply\nformat ascii 1.0\nelement face -1\nproperty int a\nelement vertex 0\n"
        "property int x\nend_header\n",
        "ply\nformat binary_little_endian 1.0\nelement face 4000000000000000000\nelement vertex 1\n"
        "property int x\nend_header\n1234",
        "ply\nformat ascii 1.0\nelement face 1\nproperty vector x\nelement vertex 1\n"
        "property int x\nend_header\n1\n1\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nelement face 1\n"
        "property int x\nend_header\n1\n1\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_null(sm_ply_ordered(texts[i], strlen(texts[i]), &new_size));
}
