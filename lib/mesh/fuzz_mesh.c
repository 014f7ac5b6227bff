/* The mesh path around the importer: text moved to the origin, polygons cut, a child's reply of any
 * bytes read, then merge, check and counts.
 * With SHAPEBENCH_FUZZ_SUFFIX set (say ".obj") the bytes are a mesh file instead and go through the
 * importer's process too. */
#include "import.h"
#include "mesh_text.h"
#include "polygon.h"
#include "recentre.h"
#include "reply.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

static void expect(bool condition, const char *what)
{
    if (condition) return;
    fprintf(stderr, "fuzz_mesh: %s\n", what);
    abort();
}

/* What holds for every mesh that the reader lets through. */
static void inspect(SmMesh *mesh)
{
    expect(sm_mesh_check(mesh, "merged", NULL) == SM_OK, "a merged mesh fails its check");
    SmMeshInfo info = sm_mesh_info(mesh);
    expect(info.components >= 1 && info.components <= info.triangles, "components");
    bool closed = !info.open_edges && !info.flipped_edges && !info.nonmanifold_edges;
    expect(isfinite(info.volume) || !closed, "a closed mesh has no volume");
    expect(isnan(info.volume) || !(info.open_edges + info.flipped_edges), "volume of an open mesh");
    expect(info.duplicates < info.triangles, "duplicates");
    sm_mesh_merge(mesh);
    expect(mesh->vertex_count == info.vertices && mesh->triangle_count == info.triangles,
           "merging twice is not merging once");
}

/* Random bytes seldom are a header, so it is made to fit them: the first two bytes say how many of
 * the rest are positions; small numbers make vertices coincide. */
static SmCode read_shaped(const unsigned char *data, size_t size, SmMesh *mesh)
{
    if (size < 2) return SM_INPUT;
    size_t vertices = 1 + data[0] % 64, triangles = (size - 2) / 3;
    size_t bytes = sizeof(SmReplyHeader) + vertices * sizeof *mesh->position +
                   triangles * sizeof *mesh->triangle;
    unsigned char *reply = sm_alloc(bytes, 1);
    SmReplyHeader header = {.magic = SM_REPLY_MAGIC};
    header.vertex_count = (int64_t)vertices;
    header.triangle_count = (int64_t)triangles;
    memcpy(reply, &header, sizeof header);
    double *position = (double *)(reply + sizeof header);
    for (size_t i = 0; i < 3 * vertices; i++) position[i] = data[(i * 7 + 1) % size] / 8 * 1e-8;
    int *corner = (int *)(position + 3 * vertices);
    for (size_t i = 0; i < 3 * triangles; i++)
        corner[i] = data[2 + i] % (int)(vertices + data[1] / 255);
    position[0] += 1;
    SmCode code = sm_reply_read(reply, bytes, "fuzz", mesh, NULL);
    free(reply);
    return code;
}

/* Any text in any of the formats; the copies must still be texts of about that length. */
static void rewrite(const unsigned char *data, size_t size)
{
    static const char *const suffix[] = {"obj", "stl", "PLY", "off"};
    char *text = sm_alloc(size + 1, 1);
    memcpy(text, data, size);
    for (int f = 0; f < 4; f++) {
        double offset[3];
        size_t new_size = 0;
        char *copy = sm_recentre(text, size, suffix[f], &new_size, offset);
        expect(!copy || strlen(copy) == new_size, "the moved text has another length");
        free(copy);
    }
    size_t new_size = 0;
    char *copy = sm_ply_ordered(text, size, &new_size);
    expect(!copy || new_size <= size + 1, "reordering adds more than the last newline");
    free(copy);
    free(text);
}

/* A polygon with a corner per three bytes: every corner must be in some triangle. */
static void cut(const unsigned char *data, size_t size)
{
    enum { MOST = 100 };
    float position[MOST][3];
    unsigned corner[MOST];
    int triangle[MOST][3], count = (int)(size / 3 < MOST ? size / 3 : MOST);
    bool used[MOST] = {false};
    if (count < 3) return;
    for (int i = 0; i < count; i++) {
        corner[i] = (unsigned)i;
        for (int a = 0; a < 3; a++) position[i][a] = (float)(data[3 * i + a] % 16);
    }
    expect(sm_polygon_cut((const float(*)[3])position, corner, count, triangle), "no memory");
    for (int t = 0; t < count - 2; t++)
        for (int c = 0; c < 3; c++) used[triangle[t][c]] = true;
    for (int i = 0; i < count; i++) expect(used[i], "a corner is lost");
}

static SmCode import_bytes(const unsigned char *data, size_t size, const char *suffix, SmMesh *mesh)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/fuzz_mesh_XXXXXX%s", suffix);
    int descriptor = mkstemps(path, (int)strlen(suffix));
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    expect(file && fwrite(data, 1, size, file) == size && fclose(file) == 0, "cannot write /tmp");
    SmCode code = sm_import(path, &(SmImportLimits){.seconds = 0.5, .megabytes = 1024}, mesh, NULL);
    unlink(path);
    return code;
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size)
{
    SmMesh mesh;
    const char *suffix = getenv("SHAPEBENCH_FUZZ_SUFFIX");
    if (suffix) {
        if (import_bytes(data, size, suffix, &mesh) == SM_OK) inspect(&mesh);
        sm_mesh_free(&mesh);
        return 0;
    }
    rewrite(data, size);
    cut(data, size);
    SmError error;
    if (sm_reply_read(data, size, "fuzz", &mesh, &error) == SM_OK) inspect(&mesh);
    sm_mesh_free(&mesh);
    if (read_shaped(data, size, &mesh) == SM_OK) {
        inspect(&mesh);
        sm_mesh_free(&mesh);
    }
    return 0;
}
