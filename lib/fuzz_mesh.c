/* The mesh path behind the importer: a child's reply of any bytes, then merge, check and counts.
 * With SHAPEBENCH_FUZZ_SUFFIX set (say ".obj") the bytes are a mesh file instead and go through the
 * importer's process too. */
#include "import.h"
#include "reply.h"

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
    expect(info.volume == info.volume, "the volume is not a number");
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

static SmCode import_bytes(const unsigned char *data, size_t size, const char *suffix, SmMesh *mesh)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/fuzz_mesh_%ld%s", (long)getpid(), suffix);
    FILE *file = fopen(path, "wb");
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
    SmError error;
    if (sm_reply_read(data, size, "fuzz", &mesh, &error) == SM_OK) inspect(&mesh);
    sm_mesh_free(&mesh);
    if (read_shaped(data, size, &mesh) == SM_OK) {
        inspect(&mesh);
        sm_mesh_free(&mesh);
    }
    return 0;
}
