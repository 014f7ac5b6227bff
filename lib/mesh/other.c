/* Other formats, through Assimp in a child process, which hands over a binary PLY file. */
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "../system/child.h"
#include "import.h"

static const double default_seconds = 20, default_seconds_per_megabyte = 1;
static const double default_megabytes = 4096;

enum { REFUSED = '!' }; /* begins a reply that is a line of error */

/* ---- in the child */

typedef struct {
    double row[3][4];
} Transform;

typedef struct {
    const SmMeshFile *file;
    const struct aiScene *scene;
    FILE *reply;
    bool of_faces;          /* write faces, not vertices; neither where `reply` is NULL */
    double vertices, faces; /* so far */
} Import;

static Transform compose(const Transform *outer, const struct aiMatrix4x4 *m)
{
    const double inner[3][4] = {{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                                {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                                {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}};
    Transform whole;
    sm_pose_compose((const double(*)[4])outer->row, inner, whole.row);
    return whole;
}

static void write_vertices(const Import *import, const struct aiMesh *mesh, const Transform *t)
{
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        const struct aiVector3D *from = &mesh->mVertices[v];
        const double p[3] = {(double)from->x, (double)from->y, (double)from->z};
        double to[3];
        for (int d = 0; d < 3; d++) to[d] = sm_dot(t->row[d], p) + t->row[d][3];
        fwrite(to, sizeof *to, 3, import->reply);
    }
}

/* Turns the faces of a mirrored part round. */
static void write_faces(const Import *import, const struct aiMesh *mesh, const Transform *t)
{
    bool mirrored = sm_pose_mirrors((const double(*)[4])t->row);
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        unsigned count = face->mNumIndices;
        fwrite(&count, sizeof count, 1, import->reply);
        for (unsigned c = 0; c < count; c++) {
            double corner = import->vertices + face->mIndices[mirrored ? count - 1 - c : c];
            fwrite(&corner, sizeof corner, 1, import->reply);
        }
    }
}

static void walk_nodes(Import *import, const struct aiNode *node, const Transform *outer)
{
    Transform transform = compose(outer, &node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; m++) {
        const struct aiMesh *mesh = import->scene->mMeshes[node->mMeshes[m]];
        if (import->reply && import->of_faces) write_faces(import, mesh, &transform);
        if (import->reply && !import->of_faces) write_vertices(import, mesh, &transform);
        import->vertices += mesh->mNumVertices;
        import->faces += mesh->mNumFaces;
    }
    for (unsigned c = 0; c < node->mNumChildren; c++)
        walk_nodes(import, node->mChildren[c], &transform);
}

/* A small file that uses its parts again and again would take minutes and all memory. */
static void write_ply(Import *import, FILE *reply)
{
    static const Transform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    double most = 2e6 + (double)import->file->size;
    walk_nodes(import, import->scene->mRootNode, &identity);
    if (import->faces > most || import->vertices > 3 * most) {
        fprintf(reply, "%c" SM_PARTS_TOO_MANY, REFUSED, most / 1e6);
        return;
    }
    fprintf(reply,
            "ply\nformat binary_%s_endian 1.0\nelement vertex %.0f\nproperty double x\n"
            "property double y\nproperty double z\nelement face %.0f\n"
            "property list uint double vertex_index\nend_header\n",
            __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? "little" : "big", import->vertices,
            import->faces);
    import->reply = reply;
    for (int pass = 0; pass < 2; pass++) {
        import->of_faces = pass == 1;
        import->vertices = 0;
        walk_nodes(import, import->scene->mRootNode, &identity);
    }
}

/* An SmChildBody of an SmMeshFile. */
static int import_bytes(void *argument, int descriptor)
{
    Import import = {.file = argument};
    const char *dot = strrchr(import.file->name, '.'), *suffix = dot ? dot + 1 : "";
    FILE *reply = fdopen(descriptor, "wb");
    setrlimit(RLIMIT_NOFILE, &(struct rlimit){0}); /* files that the mesh names are not opened */
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    import.scene = aiImportFileFromMemoryWithProperties(
        (const char *)import.file->bytes, (unsigned)import.file->size, 0, suffix, properties);
    if (!reply || strstr(aiGetErrorString(), "bad_alloc")) return SM_CHILD_NO_MEMORY;
    if (import.scene && import.scene->mRootNode)
        write_ply(&import, reply);
    else
        fprintf(reply, "%c%.300s", REFUSED, aiGetErrorString());
    return fclose(reply) != 0;
}

/* ---- in the parent */

static SmCode fail_child(const SmChildResult *result, const SmChildLimits *limits, const char *path,
                         SmError *error)
{
    if (result->end == SM_CHILD_TOO_LONG)
        return sm_fail(error, SM_INPUT,
                       "%s: reading it took longer than %g s: it may be damaged; save it anew as "
                       "OBJ, PLY or STL",
                       path, limits->seconds);
    if (result->end == SM_CHILD_TOO_LARGE)
        return sm_fail(error, SM_INPUT, "%s: reading it took more than %g MB", path,
                       limits->megabytes);
    if (result->end == SM_CHILD_FAILED)
        return sm_fail(error, SM_INPUT, "%s: the importer could not be started: %s", path,
                       strerror(result->status));
    return sm_fail(error, SM_INPUT,
                   "%s: the importer crashed on it (%s); save it as OBJ, PLY or STL", path,
                   result->signal ? strsignal(result->signal) : "it gave up");
}

static SmCode fail_reply(const SmChildResult *result, const char *path, SmError *error)
{
    const char *text = (const char *)result->reply + 1;
    int length = (int)fmin((double)result->size - 1, 300);
    if (length > 17 && !memcmp(text, "No suitable reader", 18))
        return sm_fail(
            error, SM_INPUT,
            "%s: not a mesh file that can be read; save it as OBJ, PLY, STL, OFF or glTF", path);
    return sm_fail(error, SM_INPUT,
                   "%s: cannot be read: %.*s; is it damaged or cut off? Export it "
                   "again",
                   path, length, text);
}

SmCode sm_import_other(const SmMeshFile *file, const SmImportLimits *limits, SmMesh *mesh,
                       SmMeshLeftOut *left_out, SmError *error)
{
    SmChildLimits child = {
        rint(default_seconds + default_seconds_per_megabyte * (double)file->size / 1e6),
        default_megabytes};
    if (limits && limits->seconds > 0) child.seconds = limits->seconds;
    if (limits && limits->megabytes > 0) child.megabytes = limits->megabytes;
    *mesh = (SmMesh){0};
    if (!file->size) return sm_fail(error, SM_INPUT, "%s: the file is empty", file->name);
    SmChildResult result = sm_child_run(import_bytes, (void *)file, &child);
    SmMeshFile ply = {
        .name = file->name, .suffix = ".ply", .bytes = result.reply, .size = result.size};
    SmCode code;
    if (result.end != SM_CHILD_REPLIED)
        code = fail_child(&result, &child, file->name, error);
    else if (result.size && result.reply[0] == REFUSED)
        code = fail_reply(&result, file->name, error);
    else
        code = sm_mesh_read(&ply, mesh, left_out, error);
    free(result.reply);
    return code;
}
