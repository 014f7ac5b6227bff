/* Other formats, read through Assimp in a child process, which hands over the mesh. */
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "../system/child.h"
#include "draft.h"
#include "import.h"

static const double default_seconds = 20, default_seconds_per_megabyte = 1;
static const double default_megabytes = 4096;

/* Begins what the child writes; the mesh's positions and triangles follow. */
typedef struct {
    SmError error;
    SmMesh mesh; /* its counts */
    SmMeshLeftOut left_out;
} Reply;

/* ---- in the child */

typedef struct {
    double row[3][4];
} Transform;

static Transform compose(const Transform *outer, const struct aiMatrix4x4 *m)
{
    const double inner[3][4] = {{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                                {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                                {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}};
    Transform whole;
    sm_pose_compose((const double(*)[4])outer->row, inner, whole.row);
    return whole;
}

/* Turns the faces of a mirrored part round. */
static bool add_part(SmDraft *draft, const struct aiMesh *mesh, const Transform *t)
{
    bool mirrored = sm_pose_mirrors((const double(*)[4])t->row);
    double first = (double)draft->mesh.vertex_count;
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        const struct aiVector3D *from = &mesh->mVertices[v];
        const double p[3] = {(double)from->x, (double)from->y, (double)from->z};
        double to[3];
        for (int d = 0; d < 3; d++) to[d] = sm_dot(t->row[d], p) + t->row[d][3];
        if (!sm_draft_vertex(draft, to, NULL)) return false;
    }
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        for (unsigned c = 0, count = face->mNumIndices; c < count; c++)
            if (!sm_draft_corner(draft, first + face->mIndices[mirrored ? count - 1 - c : c]))
                return false;
        if (!sm_draft_face(draft)) return false;
    }
    return true;
}

static bool add_parts(SmDraft *draft, const struct aiScene *scene, const struct aiNode *node,
                      const Transform *outer)
{
    Transform transform = compose(outer, &node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; m++)
        if (!add_part(draft, scene->mMeshes[node->mMeshes[m]], &transform)) return false;
    for (unsigned c = 0; c < node->mNumChildren; c++)
        if (!add_parts(draft, scene, node->mChildren[c], &transform)) return false;
    return true;
}

static bool read_scene(SmDraft *draft)
{
    static const Transform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const char *dot = strrchr(draft->file->name, '.'), *suffix = dot ? dot + 1 : "";
    setrlimit(RLIMIT_NOFILE, &(struct rlimit){0}); /* files that the mesh names are not opened */
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    const struct aiScene *scene = aiImportFileFromMemoryWithProperties(
        draft->begin, (unsigned)(draft->end - draft->begin), 0, suffix, properties);
    const char *why = aiGetErrorString();
    draft->most = 2e6 + (double)draft->file->size;
    if (strstr(why, "bad_alloc")) _exit(SM_CHILD_NO_MEMORY);
    if (scene && scene->mRootNode)
        return add_parts(draft, scene, scene->mRootNode, &identity) && sm_draft_finish(draft);
    return strncmp(why, "No suitable reader", 18)
               ? sm_draft_fail(draft, "cannot be read: %.300s" SM_AGAIN, why)
               : sm_draft_fail(draft, SM_NO_MESH);
}

/* An SmChildBody of an SmMeshFile. */
static int import_bytes(void *argument, int descriptor)
{
    Reply reply = {.error = {.code = SM_OK}};
    SmMesh *mesh = &reply.mesh;
    FILE *file = fdopen(descriptor, "wb");
    if (!file) return SM_CHILD_NO_MEMORY;
    SmCode code = sm_mesh_read_by(argument, read_scene, mesh, &reply.left_out, &reply.error);
    fwrite(&reply, sizeof reply, 1, file);
    if (code) return fclose(file) != 0;
    fwrite(mesh->position, sizeof *mesh->position, (size_t)mesh->vertex_count, file);
    fwrite(mesh->triangle, sizeof *mesh->triangle, (size_t)mesh->triangle_count, file);
    return fclose(file) != 0;
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

/* Takes nothing for granted: the child's memory may have been damaged. */
static bool take_mesh(const SmChildResult *result, Reply *reply)
{
    SmMesh *mesh = &reply->mesh;
    if (result->end != SM_CHILD_REPLIED || result->size < sizeof *reply) return false;
    memcpy(reply, result->reply, sizeof *reply);
    reply->error.text[sizeof reply->error.text - 1] = 0;
    long vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    if (vertices < 0 || vertices > INT_MAX || triangles < 0 || triangles > INT_MAX) return false;
    size_t positions = (size_t)vertices * sizeof *mesh->position;
    size_t corners = (size_t)triangles * sizeof *mesh->triangle;
    if (result->size != sizeof *reply + positions + corners) return false;
    *mesh = sm_mesh_new(vertices, triangles);
    memcpy(mesh->position, result->reply + sizeof *reply, positions);
    memcpy(mesh->triangle, result->reply + sizeof *reply + positions, corners);
    return true;
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
    Reply reply;
    bool taken = take_mesh(&result, &reply);
    SmCode code = taken ? SM_OK : fail_child(&result, &child, file->name, error);
    free(result.reply);
    if (!taken) return code;
    code = reply.error.code ? sm_fail(error, SM_INPUT, "%s", reply.error.text)
                            : sm_mesh_check(&reply.mesh, file->name, error);
    if (code) sm_mesh_free(&reply.mesh);
    if (left_out) *left_out = reply.left_out;
    *mesh = reply.mesh;
    return code;
}
