/* Readers of meshes: bytes as a file of the format that SHAPEBENCH_FUZZ_SUFFIX names (".obj", the
 * default), or as changes to a sound file of it; and polygons. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "polygon.h"
#include "reader.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

#define CORNERS "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define FACES   "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
#define GLTF                                                                                       \
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,"        \
    "\"scale\":[1,2,-3],"                                                                          \
    "\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0}}}}],"         \
    "\"meshes\":[{"                                                                                \
    "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":4}]}],\"accessors\":" \
    "[{"                                                                                           \
    "\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":" \
    "1,"                                                                                           \
    "\"indices\":{\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":0}}},{"      \
    "\"bufferView\":1,"                                                                            \
    "\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,"    \
    "\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":24}],\"buffers\":[{"        \
    "\"byteLength\":72,"                                                                           \
    "\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"      \
    "AAACAAEAAAABAAMAAQACAAMAAAADAAIA\"}]}"

#define SOUND(suffix, text)                                                                        \
    {                                                                                              \
        suffix, text, sizeof(text) - 1                                                             \
    }
static const char stl[134] = {[80] = 1, [98] = 64, [112] = 64, [126] = 64};

static const struct {
    const char *suffix, *text;
    size_t size;
} sound[] = {
    SOUND(".obj", "v 0 0 0 1 1 1\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1/1 3//1 2\nf -4 -3 -1\nf 2 3 "
                  "4\\\n1\nl 1 2\n"),
    SOUND(".off", "STCNOFF\n4 4 0\n" CORNERS "# c\n" FACES),
    SOUND(".off",
          "OFF BINARY\n\0\0\0\3\0\0\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\0\0\0\0"
          "\0\0\0\0\1\0\0\0\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\0"),
    SOUND(".ply",
          "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty char x\nproperty list "
          "uchar ushort l\nproperty char y\nproperty char z\nelement face 1\nproperty list uchar "
          "uchar vertex_index\nelement tristrips 1\nproperty list char char vertex_indices\n"
          "end_header\n\0\0\0\0\1\1\0\0\0\0\0\0\1\0\3\0\1\2\4\0\1\2\0"),
    SOUND(".ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
          "float z\nproperty float nx\nelement face 4\nproperty list uchar int vertex_index\n"
          "end_header\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" FACES),
    SOUND(".stl",
          "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
          "endloop\nendfacet\nendsolid\n"),
    {".stl", stl, sizeof stl},
    SOUND(".gltf", GLTF),
    SOUND(".glb", "glTF\2\0\0\0----####JSON" GLTF),
    SOUND(".xyz", "2\n0 0 0 0 0 1\n1 1 1 0 0 -1 7\n"),
};

static void require(bool condition, const char *what)
{
    if (condition) return;
    fprintf(stderr, "fuzz_mesh: %s\n", what);
    abort();
}

/* What holds for every mesh that a reader lets through. */
static void inspect(SmMesh *mesh)
{
    require(sm_mesh_check(mesh, "merged", NULL) == SM_OK, "a merged mesh fails its check");
    SmMeshInfo info = sm_mesh_info(mesh);
    require(info.components >= 1 && info.components <= info.triangles, "components");
    bool closed = !info.open_edges && !info.flipped_edges && !info.nonmanifold_edges;
    require(isfinite(info.volume) || !closed, "a closed mesh has no volume");
    require(isnan(info.volume) || !(info.open_edges + info.flipped_edges), "an open mesh has one");
    require(info.duplicates < info.triangles, "duplicates");
    sm_mesh_merge(mesh);
    require(mesh->vertex_count == info.vertices && mesh->triangle_count == info.triangles,
            "merging twice is not merging once");
}

/* A polygon with a corner per three bytes: every corner must be in some triangle. */
static void cut(const unsigned char *data, size_t size)
{
    enum { MOST = 100 };
    double position[MOST][3];
    int corner[MOST], triangle[MOST][3], count = (int)(size / 3 < MOST ? size / 3 : MOST);
    bool used[MOST] = {false};
    if (count < 3) return;
    for (int i = 0; i < count; i++) {
        corner[i] = i;
        for (int a = 0; a < 3; a++) position[i][a] = data[3 * i + a] % 16;
    }
    sm_polygon_cut((const double(*)[3])position, corner, count, triangle);
    for (int t = 0; t < count - 2; t++)
        for (int c = 0; c < 3; c++) used[triangle[t][c]] = true;
    for (int i = 0; i < count; i++) require(used[i], "a corner is lost");
}

static void read_both(const char *suffix, const unsigned char *bytes, size_t size)
{
    SmMeshFile file = {.name = suffix, .bytes = bytes, .size = size};
    SmMesh mesh;
    SmError error = {0};
    long count;
    double(*position)[3], (*normal)[3];
    if (sm_mesh_read(&file, &mesh, NULL, &error) == SM_OK)
        inspect(&mesh);
    else
        require(!strncmp(error.text, suffix, strlen(suffix)) && !mesh.position, "an error's line");
    sm_mesh_free(&mesh);
    if (sm_mesh_read_points(&file, &count, &position, &normal, &error)) return;
    require(count > 0 && isfinite(position[count - 1][2]), "points");
    sm_free_all(position, normal);
}

/* Changes a sound file: the first byte says which, pairs of bytes then how far on and to what. */
static void read_changed(const char *suffix, const unsigned char *data, size_t size)
{
    size_t files = sizeof sound / sizeof *sound, which = size ? data[0] % files : 0;
    for (size_t i = 0; i < files && strcmp(sound[which].suffix, suffix); i++)
        which = (which + 1) % files;
    if (strcmp(sound[which].suffix, suffix) != 0) return;
    size_t length = sound[which].size, at = 0;
    unsigned char *bytes = malloc(length); /* the sanitizer sees its end */
    memcpy(bytes, sound[which].text, length);
    for (int b = 0; b < 4 && sound[which].text[0] == 'g'; b++)
        bytes[12 + b] = (unsigned char)((length - 20) >> 8 * b);
    for (size_t i = 1; i + 1 < size; i += 2) {
        at = (at + data[i]) % length;
        bytes[at] = data[i + 1];
    }
    read_both(suffix, bytes, length);
    read_both(suffix, bytes, size ? length - size % length : length);
    free(bytes);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size)
{
    const char *suffix = getenv("SHAPEBENCH_FUZZ_SUFFIX");
    if (!suffix) suffix = ".obj";
    cut(data, size);
    read_both(suffix, data, size);
    read_changed(suffix, data, size);
    return 0;
}
