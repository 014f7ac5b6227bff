#include "importer.h"
#include "../system/child.h"
#include "../system/confine.h"
#include "mesh_files.h"
#include "mesh_text.h"
#include "polygon.h"
#include "recentre.h"
#include "reply.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* What a file of so many bytes may hold without wondering: more comes of parts that are used again
 * and again, by which a small file would take minutes and all memory. */
static double most_elements(double bytes)
{
    return 2e6 + bytes;
}

typedef struct {
    const struct aiScene *scene;
    double most; /* triangles, and vertices a third of them has */
    SmReplyHeader header;
    double (*position)[3];
    int (*triangle)[3];
    double offset[3];
} Import;

typedef struct {
    double row[3][4];
} Transform;

_Static_assert(sizeof(struct aiVector3D) == sizeof(float[3]), "Assimp in single precision");

static Transform compose(const Transform *outer, const struct aiMatrix4x4 *inner)
{
    const double m[4][4] = {
        {(double)inner->a1, (double)inner->a2, (double)inner->a3, (double)inner->a4},
        {(double)inner->b1, (double)inner->b2, (double)inner->b3, (double)inner->b4},
        {(double)inner->c1, (double)inner->c2, (double)inner->c3, (double)inner->c4},
        {0, 0, 0, 1}};
    Transform result = {0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++) result.row[i][j] += outer->row[i][k] * m[k][j];
    return result;
}

static bool mirrors(const Transform *t)
{
    const double(*r)[4] = t->row;
    return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
               r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
               r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]) <
           0;
}

static void count_mesh(const struct aiMesh *mesh, SmReplyHeader *header)
{
    long triangles = 0;
    for (unsigned f = 0; f < mesh->mNumFaces; f++)
        if (mesh->mFaces[f].mNumIndices > 2) triangles += mesh->mFaces[f].mNumIndices - 2L;
    header->triangle_count += triangles;
    header->vertex_count += triangles ? mesh->mNumVertices : 0;
    header->points += triangles ? 0 : mesh->mNumVertices;
}

/* Cuts `face` into triangles with the mesh's own vertex numbers. */
static bool cut_face(const struct aiMesh *mesh, const struct aiFace *face, int (*triangle)[3])
{
    bool sound = face->mNumIndices <= INT_MAX;
    for (unsigned c = 0; sound && c < face->mNumIndices; c++)
        sound = face->mIndices[c] < mesh->mNumVertices;
    if (!sound) { /* numbers that the parent will refuse */
        for (unsigned t = 0; t < face->mNumIndices - 2; t++)
            triangle[t][0] = triangle[t][1] = triangle[t][2] = -1;
        return true;
    }
    if (face->mNumIndices > 3)
        return sm_polygon_cut((const float(*)[3])mesh->mVertices, face->mIndices,
                              (int)face->mNumIndices, triangle);
    for (int c = 0; c < 3; c++) triangle[0][c] = (int)face->mIndices[c];
    return true;
}

static bool copy_triangles(Import *import, const struct aiMesh *mesh, bool mirrored)
{
    SmReplyHeader *header = &import->header;
    int first = (int)header->vertex_count;
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        if (face->mNumIndices < 3) continue;
        int(*triangle)[3] = import->triangle + header->triangle_count;
        if (!cut_face(mesh, face, triangle)) return false;
        for (unsigned t = 0; t < face->mNumIndices - 2; t++) {
            int last = triangle[t][2];
            triangle[t][2] = triangle[t][mirrored ? 0 : 2];
            triangle[t][0] = mirrored ? last : triangle[t][0];
            for (int c = 0; c < 3; c++)
                if (triangle[t][c] >= 0) triangle[t][c] += first;
        }
        header->triangle_count += face->mNumIndices - 2L;
    }
    return true;
}

static void copy_vertices(Import *import, const struct aiMesh *mesh, const Transform *transform)
{
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        const struct aiVector3D *p = &mesh->mVertices[v];
        double *position = import->position[import->header.vertex_count++];
        for (int a = 0; a < 3; a++) {
            const double *r = transform->row[a];
            position[a] = r[0] * (double)p->x + r[1] * (double)p->y + r[2] * (double)p->z + r[3] +
                          import->offset[a];
        }
    }
}

static bool too_many(const Import *import)
{
    double vertices = (double)(import->header.vertex_count + import->header.points);
    return (double)import->header.triangle_count > import->most || vertices > 3 * import->most;
}

/* Walks the node tree; counts while import->position is NULL, then copies. False: too many while it
 * counts, later no memory. */
static bool walk(Import *import, const struct aiNode *node, const Transform *outer)
{
    Transform transform = compose(outer, &node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; m++) {
        const struct aiMesh *mesh = import->scene->mMeshes[node->mMeshes[m]];
        long triangles = import->header.triangle_count;
        if (!import->position) {
            count_mesh(mesh, &import->header);
            if (too_many(import)) return false;
        } else if (!copy_triangles(import, mesh, mirrors(&transform)))
            return false;
        else if (import->header.triangle_count > triangles)
            copy_vertices(import, mesh, &transform);
    }
    for (unsigned c = 0; c < node->mNumChildren; c++)
        if (!walk(import, node->mChildren[c], &transform)) return false;
    return true;
}

static int reply_text(int reply, const char *text)
{
    size_t length = strnlen(text, SM_REPLY_TEXT);
    SmReplyHeader header = {.magic = SM_REPLY_MAGIC, .text_length = (uint32_t)length};
    return !(sm_child_write(reply, &header, sizeof header) && sm_child_write(reply, text, length));
}

static int reply_many(int reply, double most)
{
    char text[SM_REPLY_TEXT];
    snprintf(
        text, sizeof text,
        "it uses its parts so often that they make more than %.2g million triangles or points, "
        "which a file of its size does not hold: export one of each part",
        most / 1e6);
    return reply_text(reply, text);
}

static int reply_mesh(int reply, Import *import)
{
    static const Transform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    if (!walk(import, import->scene->mRootNode, &identity)) return reply_many(reply, import->most);
    SmReplyHeader header = import->header;
    if (header.vertex_count > INT_MAX || header.triangle_count > INT_MAX)
        return reply_text(reply, "more than 2147483647 vertices or triangles");
    size_t vertices = (size_t)header.vertex_count, triangles = (size_t)header.triangle_count;
    import->position = malloc((vertices + 1) * sizeof *import->position);
    import->triangle = malloc((triangles + 1) * sizeof *import->triangle);
    if (!import->position || !import->triangle) return SM_CHILD_NO_MEMORY;
    import->header = (SmReplyHeader){0};
    if (!walk(import, import->scene->mRootNode, &identity)) return SM_CHILD_NO_MEMORY;
    header.magic = SM_REPLY_MAGIC;
    return !(sm_child_write(reply, &header, sizeof header) &&
             sm_child_write(reply, import->position, vertices * sizeof *import->position) &&
             sm_child_write(reply, import->triangle, triangles * sizeof *import->triangle));
}

/* The whole file and a NUL, or NULL. */
static char *read_text(const char *path, size_t *size)
{
    char *text = NULL;
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    if (fseek(file, 0, SEEK_END) == 0) {
        long length = ftell(file);
        rewind(file);
        text = length < 0 ? NULL : malloc((size_t)length + 1);
        if (text) {
            *size = fread(text, 1, (size_t)length, file);
            text[*size] = 0;
        }
    }
    fclose(file);
    return text;
}

/* The file's bytes where Assimp needs other ones (mesh_text.h, recentre.h), or NULL. */
static char *rewritten(const char *path, const char *suffix, SmMeshFiles *files, double offset[3])
{
    size_t *size = &files->size;
    size_t new_size = 0;
    char *text = read_text(path, size);
    char *ordered = NULL, *moved = NULL;
    if (text && strcasecmp(suffix, "off") == 0 && sm_off_out_of_range(text))
        snprintf(files->altered, sizeof files->altered, "OFF: a face names a vertex out of range");
    if (text && strcasecmp(suffix, "ply") == 0) ordered = sm_ply_ordered(text, *size, &new_size);
    if (ordered) {
        free(text);
        text = ordered;
        *size = new_size;
    }
    if (text && strcasecmp(suffix, "ply") == 0 && sm_ply_lacks_lines(text))
        snprintf(files->altered, sizeof files->altered, "PLY: fewer lines than its header says");
    if (text) moved = sm_recentre(text, *size, suffix, &new_size, offset);
    if (moved || !ordered) free(text);
    if (moved) *size = new_size;
    if (!moved) offset[0] = offset[1] = offset[2] = 0;
    return moved ? moved : ordered;
}

/* What Assimp tells only its log: numbers that it has put in place of those in the file. */
static void note_alteration(const char *line, char *noted)
{
    static const char *const altered[] = {"out of range", "out-of-range", "is incorrect"};
    for (size_t i = 0; i < sizeof altered / sizeof *altered && !*noted; i++)
        if (strstr(line, altered[i])) {
            const char *colon = strstr(line, ": ");
            const char *said = colon ? colon + 2 : line;
            snprintf(noted, SM_REPLY_TEXT, "%.*s", (int)strcspn(said, "\n"), said);
        }
}

/* The scene, from a process that can read nothing but what lies beneath the mesh's folder; NULL,
 * and then errno is ENOMEM where memory is what it lacks. */
static const struct aiScene *read_scene(const char *path, SmMeshFiles *files, double offset[3])
{
    const char *dot = strrchr(path, '.'), *suffix = dot ? dot + 1 : "";
    sm_mesh_files_init(path, files);
    sm_confine(files->folder ? files->folder : "", path);
    errno = 0;
    files->text = rewritten(path, suffix, files, offset);
    if (errno == ENOMEM) return NULL;
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    struct aiLogStream log = {note_alteration, files->altered};
    aiAttachLogStream(&log);
    errno = 0;
    const struct aiScene *scene = aiImportFileExWithProperties(path, 0, &files->io, properties);
    aiDetachLogStream(&log);
    return scene && scene->mRootNode && !files->altered[0] ? scene : NULL;
}

/* Why there is no scene. */
static int reply_reason(int reply, const SmMeshFiles *files)
{
    const char *reason = aiGetErrorString();
    if (strstr(reason, "bad_alloc") || errno == ENOMEM) return SM_CHILD_NO_MEMORY;
    char text[SM_REPLY_TEXT];
    if (files->outside[0])
        snprintf(text, sizeof text,
                 "it names '%s', which does not lie in its folder, and is not read: put it there",
                 files->outside);
    else
        snprintf(text, sizeof text, "%.300s; is it damaged or cut off? Export it again",
                 *reason             ? reason
                 : files->altered[0] ? files->altered
                                     : "the importer gives no reason");
    return reply_text(reply, text);
}

int sm_importer(void *path, int reply)
{
    Import import = {0};
    SmMeshFiles files;
    import.scene = read_scene(path, &files, import.offset);
    if (import.scene) {
        import.most = most_elements(files.bytes);
        int status = reply_mesh(reply, &import);
        free(import.position);
        free(import.triangle);
        return status;
    }
    return reply_reason(reply, &files);
}

/* Points, and their normals behind them; walks as walk() does. `room` 0: counts only. */
typedef struct {
    const struct aiScene *scene;
    int64_t count, room;
    double most; /* of them */
    double (*position)[3], (*normal)[3];
    double offset[3];
    bool bare; /* some have no normals */
} Points;

static void copy_points(Points *points, const struct aiMesh *mesh, const Transform *transform)
{
    if (points->room == 0) { /* counted only */
        points->count += mesh->mNumVertices;
        return;
    }
    for (unsigned v = 0; v < mesh->mNumVertices; v++, points->count++) {
        const struct aiVector3D *p = &mesh->mVertices[v], *n = &mesh->mNormals[v];
        for (int a = 0; a < 3 && points->count < points->room; a++) {
            const double *r = transform->row[a];
            points->position[points->count][a] = r[0] * (double)p->x + r[1] * (double)p->y +
                                                 r[2] * (double)p->z + r[3] + points->offset[a];
            points->normal[points->count][a] =
                r[0] * (double)n->x + r[1] * (double)n->y + r[2] * (double)n->z;
        }
    }
}

static void walk_points(Points *points, const struct aiNode *node, const Transform *outer)
{
    Transform transform = compose(outer, &node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; m++) {
        const struct aiMesh *mesh = points->scene->mMeshes[node->mMeshes[m]];
        SmReplyHeader header = {0};
        count_mesh(mesh, &header);
        if (!header.points) continue;
        points->bare |= !mesh->mNormals;
        if (mesh->mNormals) copy_points(points, mesh, &transform);
    }
    for (unsigned c = 0; c < node->mNumChildren; c++)
        walk_points(points, node->mChildren[c], &transform);
}

static int reply_points(int reply, Points *points)
{
    static const Transform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    walk_points(points, points->scene->mRootNode, &identity);
    if (points->bare) return reply_text(reply, "its points have no normals");
    if (!points->count) return reply_text(reply, "it holds no points");
    if ((double)points->count > points->most) return reply_many(reply, points->most);
    if (points->count > INT_MAX) return reply_text(reply, "more than 2147483647 points");
    SmReplyHeader header = {.magic = SM_REPLY_MAGIC, .vertex_count = points->count};
    size_t size = (size_t)points->count * sizeof *points->position;
    points->room = points->count;
    points->count = 0;
    points->position = malloc(size);
    points->normal = malloc(size);
    int status = SM_CHILD_NO_MEMORY;
    if (points->position && points->normal) {
        walk_points(points, points->scene->mRootNode, &identity);
        status = !(sm_child_write(reply, &header, sizeof header) &&
                   sm_child_write(reply, points->position, size) &&
                   sm_child_write(reply, points->normal, size));
    }
    free(points->position);
    free(points->normal);
    return status;
}

int sm_importer_points(void *path, int reply)
{
    Points points = {0};
    SmMeshFiles files;
    points.scene = read_scene(path, &files, points.offset);
    if (!points.scene) return reply_reason(reply, &files);
    points.most = most_elements(files.bytes);
    return reply_points(reply, &points);
}
