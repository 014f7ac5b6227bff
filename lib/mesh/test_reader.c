/* Files of every format, made here so that the answer is known; each kind that was once read
 * wrongly is among them. */
#include "../test_frame.h"
#include "draft.h"

static SmCode read_mesh(const char *name, const char *bytes, size_t size, SmMesh *mesh,
                        SmMeshLeftOut *left_out, SmError *error)
{
    unsigned char *copy = malloc(size + !size); /* of that size alone, for the sanitizer */
    memcpy(copy, bytes, size);
    SmMeshFile file = {.name = name, .bytes = copy, .size = size};
    SmCode code = sm_mesh_read(&file, mesh, left_out, error);
    free(copy);
    return code;
}

/* The closed mesh has so many triangles and that volume, and this is left out of it. */
static void expect_all(const char *name, const char *bytes, size_t size, long triangles,
                       double volume, const char *left_out)
{
    SmMesh mesh;
    SmError error;
    SmMeshLeftOut left;
    char text[SM_LEFT_OUT_TEXT];
    if (read_mesh(name, bytes, size, &mesh, &left, &error)) fail_msg("%s", error.text);
    SmMeshInfo info = sm_mesh_info(&mesh);
    sm_mesh_free(&mesh);
    assert_int_equal(info.triangles, triangles);
    if (!(fabs(info.volume - volume) < 1e-9)) fail_msg("%s: volume %.17g", name, info.volume);
    assert_true(info.watertight && !info.flipped_edges);
    assert_string_equal(sm_mesh_left_out(&left, text), left_out);
}

static void expect(const char *name, const char *text, long triangles, double volume)
{
    expect_all(name, text, strlen(text), triangles, volume, "");
}

static const double sixth = 1.0 / 6;

static void refuse_bytes(const char *name, const char *bytes, size_t size, const char *part)
{
    SmMesh mesh;
    SmError error = {0};
    assert_int_equal(read_mesh(name, bytes, size, &mesh, NULL, &error), SM_INPUT);
    assert_int_equal(strncmp(error.text, name, strlen(name)), 0);
    if (!strstr(error.text, part)) fail_msg("\"%s\" lacks \"%s\"", error.text, part);
    assert_null(mesh.position);
}

static void refuse(const char *name, const char *text, const char *part)
{
    refuse_bytes(name, text, strlen(text), part);
}

#define OBJ_V   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
#define OBJ_F   "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
#define CORNERS "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define FACES   "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
#define FACET(a, b, c)                                                                             \
    "facet normal 0 0 0\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet"  \
    "\n"
#define FACETS                                                                                     \
    FACET("0 0 0", "0 1 0", "1 0 0")                                                               \
    FACET("0 0 0", "1 0 0", "0 0 1")                                                               \
    FACET("1 0 0", "0 1 0", "0 0 1") FACET("0 0 0", "0 0 1", "0 1 0")
#define PLY_HEAD(format)                                                                           \
    "ply\nformat " format " 1.0\ncomment\nelement vertex 4\nproperty float x\nproperty float y\n"  \
    "property float z\n"
#define PLY                                                                                        \
    PLY_HEAD("ascii")                                                                              \
    "element face 4\nproperty list uchar int vertex_index\nend_header\n" CORNERS FACES

/* With line ends of three kinds, a byte order mark, tabulators, zeros at the end. */
TEST(texts)
{
    static const char *const text[][2] = {{"a.obj", "# caf\xe9\no caf\xe9\n" OBJ_V OBJ_F},
                                          {"a.off", "OFF\n4 4 6\n" CORNERS FACES},
                                          {"A.PLY", PLY},
                                          {"a.stl", "solid caf\xe9 #1\n" FACETS "endsolid\n"}};
    static const char *const end[] = {"\n", "\r\n", "\r", "\t\n", " \n\n "};
    for (int t = 0; t < 4; t++)
        for (int e = 0; e < 10; e++) {
            char made[2048], *at = made;
            if (e > 4) at += sprintf(at, "\xef\xbb\xbf");
            for (const char *from = text[t][1]; *from; from++)
                at += *from == '\n' ? sprintf(at, "%s", end[e % 5]) : sprintf(at, "%c", *from);
            memset(at, 0, 16);
            expect_all(text[t][0], made, (size_t)(at - made) + (size_t)e, 4, sixth, "");
        }
}

TEST(obj)
{
    expect("a.obj", "v 0 0 0 1 0 0 1\nv 1 0 0 .5\nv 0 1 0 1 1 1\nv 0 0 1\n" OBJ_F, 4, sixth);
    expect("a.obj", OBJ_V "# part\\\n" OBJ_F "g C:\\a\\\n", 4, sixth);
    expect("a.obj",
           "v 0 \\\n0 0\nv 1 0\\\r\n 0\nv 0 1 0\nv 0 0 1\nf -4/1 -2//2 -3/1/1 # v\nf 1 \\\n2 4\nfo "
           "2 3 4\nf 1 4 3",
           4, sixth);
    expect("a.obj", OBJ_F OBJ_V, 4, sixth);
    expect("a.obj",
           "v -5e-1 0 0\nv +.5 0e9 0\nv -.5 1. 0\nv -0.5 0.000000000000000000000 "
           "1.0000000000000000000000\n" OBJ_F,
           4, sixth);
    static const char other[] = OBJ_V OBJ_F "p 1 2\nl 1 2 3\ncurv 0 1 1 2\nsurf 0 1 0 1 1 2\n";
    expect_all("a.obj", other, sizeof other - 1, 4, sixth, "points: 2, lines: 1, curves: 2");
    refuse("a.obj", OBJ_V OBJ_F "f 1 2 5\n", "line 9: a face names vertex 5 of 4");
    refuse("a.obj", OBJ_V "f 1 2 0\n", "line 5: '0' is not the number of a vertex");
    refuse("a.obj", OBJ_V "f 1 2 -5\n", "'-5'");
    refuse("a.obj", OBJ_V "f 1 2 99999999999\n", "line 5: a face names vertex");
    refuse("a.obj", "v 0 0\n", "line 1: a vertex has three coordinates, not 2");
    refuse("a.obj", "v 0 0 1,5\n", "line 1: '1,5' is not a number");
    refuse("a.obj", "v 0 nan 0\n", "line 1: the y of a vertex is not a finite number");
    refuse("a.obj", OBJ_V "f 1 2", "line 5: a face of 2 vertices");
    refuse_bytes("a.obj", OBJ_V "f\0 1", sizeof OBJ_V + 3, "a zero byte in text");
    refuse("a.obj", "v 0 0 0\nv 1 0 1e999\n", "line 2: the z of a vertex is not a finite number");
    refuse("a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "all vertices are at one point");
    refuse("a.obj", OBJ_V, "only points or lines (4)");
    refuse("a.obj", "", "the file is empty");
    refuse("a.obj", "these are words", "no triangles");
    refuse_bytes("a.obj", "v\0 \0001\0", 6, "UTF-16");
    refuse_bytes("a.off", "\xfe\xff\0O\0F\0F", 8, "UTF-16");
    refuse("a.obj.gz", OBJ_V OBJ_F, "not a whole gzip file");
    refuse("a.dae", OBJ_V OBJ_F, "save it as OBJ, PLY");
    refuse("a.xyz", "1 2 3\n", "run --engine meshless");
}

/* In two parts, as programs append. */
TEST(gzip)
{
    static const char packed[] =
        "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x2b\x53\x30\x00\x41\xae\x32\x05\x43\x28\x6d\x00"
        "\x62\x81\x69\x20\x8b\x0b\x00\xc4\xb1\xb6\x05\x20\x00\x00\x00\x1f\x8b\x08\x00\x00\x00\x00"
        "\x00\x02\x03\x4b\x53\x30\x54\x30\x56\x30\xe2\x4a\x03\xd2\x46\x0a\x26\x40\xda\x08\xc8\x37"
        "\x01\xf3\x4d\x14\x8c\xb9\x00\x57\x7d\x3c\x65\x20\x00\x00\x00";
    expect_all("a.obj.GZ", packed, 81, 4, sixth, "");
    for (size_t size = 1; size < 81; size++) {
        SmMesh mesh;
        assert_int_equal(read_mesh("a.obj.gz", packed, size, &mesh, NULL, NULL), SM_INPUT);
    }
}

/* A body keeps its shape at any place. */
TEST(far_from_the_origin)
{
    static const char *const text[][2] = {
        {"far.obj", "v %1$.2f %2$.2f 0 1 0 0\nv %3$.2f %2$.2f 0\nv %1$.2f %4$.2f 0\nv %1$.2f "
                    "%2$.2f 1\n" OBJ_F},
        {"far.off", "COFF\n4 4 0\n%1$.2f %2$.2f 0 1 1 1 1\n%3$.2f %2$.2f 0 1 1 1\n%1$.2f %4$.2f 0 "
                    "0 0 0 0\n%1$.2f %2$.2f 1 7\n" FACES},
        {"far.ply",
         PLY_HEAD(
             "ascii") "property uchar red\nelement face 4\nproperty list uchar int vertex_index\n"
                      "end_header\n%1$.2f %2$.2f 0 1\n%3$.2f %2$.2f 0 1\n%1$.2f %4$.2f 0 1\n%1$.2f "
                      "%2$.2f 1 1\n" FACES}};
    for (int t = 0; t < 3; t++) {
        char made[1024];
        snprintf(made, sizeof made, text[t][1], 5000000.25, -1e7, 5000001.25, -1e7 + 1);
        expect(text[t][0], made, 4, sixth);
    }
}

/* strtod() is right; digits beyond what a double holds, and beyond what is counted, matter. */
TEST(numbers_are_rounded_correctly)
{
    static const char *const number[] = {
        "1.7976931348623157e308",
        "5e-324",
        "9007199254740993",
        "9007199254740993.0000000000000000001",
        "0.1000000000000000055511151231257827",
        "123456789012345678901234567890e-20",
        "1e23",
        "8.5e-22",
        "0.000000000000000000000000000000000012345678901234567e+33",
        "6.02214076e23",
        "-2.2250738585072011e-308"};
    for (size_t n = 0; n < sizeof number / sizeof *number; n++) {
        char text[200];
        long count;
        double(*position)[3], (*normal)[3];
        SmMeshFile file = {.name = "n.xyz", .bytes = (unsigned char *)text};
        file.size = (size_t)sprintf(text, "%s 0 0", number[n]);
        assert_int_equal(sm_mesh_read_points(&file, &count, &position, &normal, NULL), SM_OK);
        assert_int_equal(count, 1);
        assert_true(position[0][0] == strtod(number[n], NULL));
        sm_free_all(position, normal);
    }
}

TEST(off)
{
    expect("a.off", "OFF4 4 0\n" CORNERS FACES, 4, sixth);
    expect("a.off",
           "# a\nOFF # b\n# c\n4 # d\n4 0\n0 0 0\n# e\n\n1 0 0 # f\n0 1 0\n0 0 1\n3 0 2 1 255 0 "
           "0\n3 0 1 3 # g\n3 1 2\n3\n3 0 3 2\n#",
           4, sixth);
    expect("a.off", "4 4\n" CORNERS FACES, 4, sixth);
    expect("a.off", "OFF\n4 4 # edges\n # none\n 0\n" CORNERS FACES, 4, sixth);
    expect("a.off",
           "NOFF\n4\n4\n0\n0 0 0 nan nan -inf\n1 0 0 1 1 1\n0 1 0 1 1 1\n0 0 1 1 1 1\n" FACES, 4,
           sixth);
    expect("a.off", "OFF 4 4\n1 5 3\n2 7 9\n3 1 2\n4 4 4\n" FACES, 4, 7.5);
    expect("a.off",
           "STCNOFF\n4 4 0\n0 0 0 9 9 9 1 1 1 1 2 2\n1 0 0 9 9 9\n0 1 0 9 9 9\n0 0 1 9 9 9\n" FACES,
           4, sixth);
    refuse("a.off", "4OFF\n4 4 0\n", "4OFF has other coordinates");
    refuse("a.off", "PLY\n", "begins with 'OFF'");
    refuse("a.off", "OFF\n4 4 0\n" CORNERS FACES "3 0 1 2\n", "line 11: there is more data");
    refuse("a.off", "OFF\n4 5 0\n" CORNERS FACES, "line 11: the file ends");
    refuse("a.off", "OFF\n4 1 0\n" CORNERS "3 0 1 4\n", "line 7: a face names vertex 5 of 4");
    refuse("a.off", "OFF\n4 1 0\n" CORNERS "3 0 1 -1\n", "line 7: a face names vertex -1");
    refuse("a.off", "OFF\n4 1 0\n" CORNERS "3 0 1 4294967298\n",
           "line 7: a face names vertex 4294967298");
    refuse("a.off", "OFF\n400000000 1 0\n" CORNERS, "line 2: a count of 400000000 is wrong");
}

TEST(ply)
{
    expect("a.ply",
           PLY_HEAD("ascii") "element tristrips 2\nproperty list int int "
                             "vertex_indices\nend_header\n" CORNERS
                             "5 0 2 1 3 0 \n6 0 -1 0 3 2 -1\n",
           4, sixth);
    expect("a.ply",
           PLY_HEAD("ascii") "obj_info x\nelement face 4\nproperty list uchar int "
                             "vertex_index\nend_header\n"
                             "0 0 0 1 0 0 0 1 0 0 0\n1 3\n0 2 1 3 0 1 3 3 1 2 3\n3 0 3 2",
           4, sixth);
    static const char edges[] =
        PLY_HEAD("ascii") "element face 5\nproperty list uchar int vertex_index\nelement edge 1\n"
                          "property int vertex1\nproperty int vertex2\nend_header\n" CORNERS FACES
                          "1 0\n0 1\n";
    expect_all("a.ply", edges, sizeof edges - 1, 4, sixth, "points: 1, lines: 1");
    refuse("a.ply", PLY "3 0 1 2\n", "line 19: there is more data");
    refuse("a.ply", PLY_HEAD("ascii") "end_header\n" CORNERS, "only points or lines (4)");
    refuse("a.ply",
           PLY_HEAD("ascii") "element face 1\nproperty list uchar int v\nend_header\n" CORNERS
                             "3 0 1 2\n",
           "lacks the list");
    refuse("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n",
           "lack property x, y or z");
    refuse("a.ply",
           PLY_HEAD(
               "ascii") "element face 1\nproperty list uchar int vertex_index\nend_header\n" CORNERS
                        "3 0 1 -1\n",
           "line 15: a face names vertex -1");
    refuse("a.ply", PLY_HEAD("ascii") "element face 1\nproperty list uchar half vertex_index\n",
           "line 9: a property of no type");
    refuse("a.ply", PLY_HEAD("ascii") "element face 4000000000\n", "line 8: a count");
    refuse("a.ply", PLY_HEAD("ascii") "element face 100\nproperty int a\nend_header\n" CORNERS,
           "too small for 100 of its element 'face'");
    refuse("a.ply", "OFF\n", "begins with 'ply'");
    refuse("a.ply", PLY_HEAD("text") "end_header\n", "no format that is known");
}

/* A tetrahedron. */
static size_t make_stl(char *bytes, const char *header, uint32_t count, size_t trailing, int filled)
{
    static const char corner[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    const float one = 1;
    memset(bytes, 0, 284);
    memcpy(bytes, header, strlen(header));
    memcpy(bytes + 80, &count, 4);
    for (int c = 0; c < 12; c++) {
        char *facet = bytes + 84 + 50 * (c / 3);
        memset(facet, 0xff, 12); /* a normal of nan */
        if (corner[c]) memcpy(facet + 12 + 12 * (c % 3) + 4 * (corner[c] - 1), &one, 4);
    }
    memset(bytes + 284, filled, trailing);
    return 284 + trailing;
}

TEST(binary_stl)
{
    char bytes[1024];
    expect_all("a.stl", bytes, make_stl(bytes, "solid part", 4, 2, 1), 4, sixth, "");
    expect_all("a.stl", bytes, make_stl(bytes, "", 0, 0, 0), 4, sixth, "");
    expect_all("a.stl", bytes, make_stl(bytes, "", UINT32_MAX, 0, 0), 4, sixth, "");
    expect_all("a.stl", bytes, make_stl(bytes, "x", 4, 400, 0), 4, sixth, "");
    refuse_bytes("a.stl", bytes, make_stl(bytes, "", 2, 0, 0),
                 "byte 80: its header counts 2 triangles, and 100 bytes follow");
    refuse_bytes("a.stl", bytes, make_stl(bytes, "", 5, 0, 0),
                 "byte 80: its header counts 5 triangles, and it holds 4");
    refuse_bytes("a.stl", bytes, make_stl(bytes, "", 4, 50, 1), "50 bytes follow");
    refuse_bytes("a.stl", bytes, 83, "byte 0: the file ends in its header");
    make_stl(bytes, "", 4, 0, 0);
    memset(bytes + 84 + 16, 0xff, 4);
    refuse_bytes("a.stl", bytes, 284, "byte 84: the y of a vertex is not a finite number");
}

TEST(text_stl)
{
    expect("a.stl",
           "SOLID X\nFacet Normal nan 0 0\nOUTER loop\nvertex 0 0 0\nVERTEX 0 1 0\nvertex 1 0 "
           "0\nENDLOOP\nendfacet\nENDSOLID\n"
           "solid\n" FACET("0 0 0", "1 0 0", "0 0 1") "color 1 1 1\n" FACET(
               "1 0 0", "0 1 0", "0 0 1") FACET("0 0 0", "0 0 1", "0 1 0") "endsolid facet\n",
           4, sixth);
    refuse("a.stl", "solid\n" FACETS, "the last solid has no end");
    refuse("a.stl", "solid\nfacet\nvertex 0 0 0\nendfacet\nendsolid\n",
           "line 4: a facet of 1 vertices");
    refuse("a.stl", "solid\nvertex 0 0 0\n", "line 2: a vertex in no facet");
    refuse("a.stl", "solid words\nwords\n", "line 2: 'words' is not a word of STL");
}

TEST(points)
{
    static const struct {
        const char *name, *text, *says;
        long count;
        double up; /* the last normal's z */
    } file[] = {
        {"a.xyz", "1 2 3\n4 5 6\n", NULL, 2, 0},
        {"a.pts", "2\r\n1, 2; 3 0 0 1 255\r\n# c\r\n\r\n4 5 6 0 0 -1 7\r\n", NULL, 2, -1},
        {"a.asc", "1\t2\t3\t0\t0\t1", NULL, 1, 1},
        {"a.pwn", "2\n0 0 0\n1 1 1\n0 0 1\n0 0 -1\n", NULL, 2, -1},
        {"a.ply",
         PLY_HEAD("ascii") "property float nz\nend_header\n0 0 0 1\n1 1 1 2\n2 2 2 3\n3 3 3 4\n",
         NULL, 4, 4},
        {"a.off", "NOFF\n2 0 0\n0 0 0 0 0 1\n1 1 1 0 0 5\n", NULL, 2, 5},
        {"a.obj", OBJ_V, NULL, 4, 0},
        {"a.xyz", "3\n1 2 3\n", "counts 3 points, and there are 1", 0, 0},
        {"a.xyz", "1 2 3\n1 2 3 4 5 6\n", "line 2: a line of 6 numbers", 0, 0},
        {"a.xyz", "C 1 2 3\n", "line 1: 'C' is not a number", 0, 0},
        {"a.obj", OBJ_V OBJ_F, "it holds triangles, and no points alone", 0, 0},
        {"a.xyz", "# none\n", "it holds no points", 0, 0}};
    for (size_t f = 0; f < sizeof file / sizeof *file; f++) {
        long count;
        double(*position)[3], (*normal)[3];
        SmError error = {0};
        SmMeshFile of = {.name = file[f].name,
                         .bytes = (const unsigned char *)file[f].text,
                         .size = strlen(file[f].text)};
        SmCode code = sm_mesh_read_points(&of, &count, &position, &normal, &error);
        if (file[f].says) {
            assert_int_equal(code, SM_INPUT);
            if (!strstr(error.text, file[f].says)) fail_msg("%s", error.text);
            continue;
        }
        if (code) fail_msg("%s", error.text);
        assert_int_equal(count, file[f].count);
        assert_true(normal[count - 1][2] == file[f].up);
        sm_free_all(position, normal);
    }
}
