#include "importer.h"
#include "../system/child.h"
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

/* What a file of so many bytes is expected to hold at most: more comes of parts that are used again
 * and again, by which a small file would take minutes and all memory. */
static double most_elements(double bytes)
{
    return 2e6 + bytes;
}

/* The parts with triangles, or the points of those without. */
typedef struct {
    const struct aiScene *scene;
    bool of_points;
    double most; /* points; triangles, and vertices a third of them has */
    SmReplyHeader header;
    double (*position)[3], (*normal)[3]; /* NULL while all is counted */
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

static long triangles_of(const struct aiMesh *mesh)
{
    long triangles = 0;
    for (unsigned f = 0; f < mesh->mNumFaces; f++)
        if (mesh->mFaces[f].mNumIndices > 2) triangles += mesh->mFaces[f].mNumIndices - 2L;
    return triangles;
}

/* False: too many. */
static bool count_mesh(const struct aiMesh *mesh, Import *import)
{
    SmReplyHeader *header = &import->header;
    long triangles = triangles_of(mesh);
    header->triangle_count += triangles;
    header->vertex_count += triangles ? mesh->mNumVertices : 0;
    header->points += triangles ? 0 : mesh->mNumVertices;
    if (import->of_points) return (double)header->points <= import->most;
    return (double)header->triangle_count <= import->most &&
           (double)(header->vertex_count + header->points) <= 3 * import->most;
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

/* A row's product with a vector, of which a part that does not count may be no number. */
static double turned(const double row[4], const struct aiVector3D *vector)
{
    const double part[3] = {(double)vector->x, (double)vector->y, (double)vector->z};
    double sum = 0;
    for (int a = 0; a < 3; a++) sum += row[a] == 0 ? 0 : row[a] * part[a];
    return sum;
}

static void copy_vertices(Import *import, const struct aiMesh *mesh, const Transform *transform)
{
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        long vertex = import->header.vertex_count++;
        for (int a = 0; a < 3; a++) {
            const double *r = transform->row[a];
            import->position[vertex][a] = turned(r, &mesh->mVertices[v]) + r[3] + import->offset[a];
            if (import->of_points)
                import->normal[vertex][a] = mesh->mNormals ? turned(r, &mesh->mNormals[v]) : 0;
        }
    }
}

static bool copy_mesh(Import *import, const struct aiMesh *mesh, const Transform *transform)
{
    bool solid = triangles_of(mesh) > 0;
    if (solid == import->of_points) return true;
    if (solid && !copy_triangles(import, mesh, mirrors(transform))) return false;
    copy_vertices(import, mesh, transform);
    return true;
}

/* Walks the node tree; counts while import->position is NULL, then copies. False: too many while it
 * counts, later no memory. */
static bool walk(Import *import, const struct aiNode *node, const Transform *outer)
{
    Transform transform = compose(outer, &node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; m++) {
        const struct aiMesh *mesh = import->scene->mMeshes[node->mMeshes[m]];
        if (!(import->position ? copy_mesh(import, mesh, &transform) : count_mesh(mesh, import)))
            return false;
    }
    for (unsigned c = 0; c < node->mNumChildren; c++)
        if (!walk(import, node->mChildren[c], &transform)) return false;
    return true;
}

static int reply_text(int reply, const char *text)
{
    size_t length = strlen(text);
    if (length > SM_REPLY_TEXT) length = SM_REPLY_TEXT;
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

/* What is wrong with the parts that were counted, or NULL. */
static const char *refusal(const Import *import)
{
    const SmReplyHeader *header = &import->header;
    if (import->of_points) {
        if (!header->points) return "it holds no points";
        return header->points > INT_MAX ? "more than 2147483647 points" : NULL;
    }
    return header->vertex_count > INT_MAX || header->triangle_count > INT_MAX
               ? "more than 2147483647 vertices or triangles"
               : NULL;
}

static int reply_parts(int reply, Import *import)
{
    static const Transform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    if (!walk(import, import->scene->mRootNode, &identity)) return reply_many(reply, import->most);
    if (refusal(import)) return reply_text(reply, refusal(import));
    SmReplyHeader header = import->header;
    if (import->of_points) header = (SmReplyHeader){.vertex_count = import->header.points};
    size_t vertices = (size_t)header.vertex_count * sizeof *import->position;
    size_t others =
        import->of_points ? vertices : (size_t)header.triangle_count * sizeof *import->triangle;
    void *other = malloc(others + 1);
    import->position = malloc(vertices + 1);
    import->normal = import->of_points ? other : NULL;
    import->triangle = import->of_points ? NULL : other;
    import->header = (SmReplyHeader){0};
    bool copied = import->position && other && walk(import, import->scene->mRootNode, &identity);
    header.magic = SM_REPLY_MAGIC;
    int status = copied ? !(sm_child_write(reply, &header, sizeof header) &&
                            sm_child_write(reply, import->position, vertices) &&
                            sm_child_write(reply, other, others))
                        : SM_CHILD_NO_MEMORY;
    free(import->position);
    free(other);
    return status;
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

/* Returns the scene; NULL, and then errno is ENOMEM where memory is what it lacks. */
static const struct aiScene *read_scene(const char *path, SmMeshFiles *files, double offset[3])
{
    const char *dot = strrchr(path, '.'), *suffix = dot ? dot + 1 : "";
    sm_mesh_files_init(path, files);
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

static int import_file(void *path, int reply, bool of_points)
{
    Import import = {.of_points = of_points};
    SmMeshFiles files;
    import.scene = read_scene(path, &files, import.offset);
    if (!import.scene) return reply_reason(reply, &files);
    import.most = most_elements(files.bytes);
    return reply_parts(reply, &import);
}

int sm_importer(void *path, int reply)
{
    return import_file(path, reply, false);
}

int sm_importer_points(void *path, int reply)
{
    return import_file(path, reply, true);
}
