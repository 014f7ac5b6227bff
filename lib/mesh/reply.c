#include "reply.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static SmCode fail_with_text(const unsigned char *text, size_t length, const char *path,
                             SmError *error)
{
    char line[SM_REPLY_TEXT + 1];
    memcpy(line, text, length);
    line[length] = 0;
    if (strncmp(line, "No suitable reader", 18) == 0)
        return sm_fail(
            error, SM_INPUT,
            "%s: not a mesh file that can be read; save it as OBJ, PLY, STL, OFF or glTF", path);
    return sm_fail(error, SM_INPUT, "%s: cannot be read: %s", path, line);
}

static SmCode fail_without_triangles(const SmReplyHeader *header, const char *path, SmError *error)
{
    if (header->points > 0)
        return sm_fail(error, SM_INPUT,
                       "%s: holds only points or lines (%lld), no triangles; " SM_REPLY_POINTS,
                       path, (long long)header->points);
    return sm_fail(error, SM_INPUT, "%s: holds no triangles", path);
}

static SmMesh copy_arrays(const SmReplyHeader *header, const unsigned char *bytes)
{
    SmMesh mesh = sm_mesh_new(header->vertex_count, header->triangle_count);
    size_t vertices = (size_t)mesh.vertex_count, triangles = (size_t)mesh.triangle_count;
    memcpy(mesh.position, bytes, vertices * sizeof *mesh.position);
    memcpy(mesh.triangle, bytes + vertices * sizeof *mesh.position,
           triangles * sizeof *mesh.triangle);
    return mesh;
}

SmCode sm_reply_read(const unsigned char *reply, size_t size, const char *path, SmMesh *mesh,
                     SmError *error)
{
    SmReplyHeader header = {0};
    *mesh = (SmMesh){0};
    if (size >= sizeof header) memcpy(&header, reply, sizeof header);
    bool sound = header.magic == SM_REPLY_MAGIC && header.text_length <= SM_REPLY_TEXT &&
                 header.vertex_count >= 0 && header.vertex_count <= INT_MAX &&
                 header.triangle_count >= 0 && header.triangle_count <= INT_MAX;
    size_t body = header.text_length;
    if (sound && !body)
        body = (size_t)header.vertex_count * sizeof *mesh->position +
               (size_t)header.triangle_count * sizeof *mesh->triangle;
    if (!sound || size - sizeof header != body)
        return sm_fail(error, SM_INPUT, "%s: the importer's reply is broken", path);
    reply += sizeof header;
    if (header.text_length) return fail_with_text(reply, header.text_length, path, error);
    if (!header.triangle_count) return fail_without_triangles(&header, path, error);
    *mesh = copy_arrays(&header, reply);
    SmCode code = sm_mesh_check(mesh, path, error);
    if (code == SM_OK) {
        sm_mesh_merge(mesh);
        if (mesh->triangle_count == 0)
            code =
                sm_fail(error, SM_INPUT, "%s: every triangle has two corners in one place", path);
        else
            code = sm_mesh_check(mesh, path, error);
    }
    if (code != SM_OK) sm_mesh_free(mesh);
    return code;
}

SmCode sm_reply_points(const unsigned char *reply, size_t size, const char *path, long *count,
                       double (**position)[3], double (**normal)[3], SmError *error)
{
    SmReplyHeader header = {0};
    if (size >= sizeof header) memcpy(&header, reply, sizeof header);
    bool sound = header.magic == SM_REPLY_MAGIC && header.text_length <= SM_REPLY_TEXT &&
                 header.vertex_count >= 0 && header.vertex_count <= INT_MAX;
    size_t half = (size_t)header.vertex_count * sizeof(double[3]);
    if (!sound || size - sizeof header != (header.text_length ? header.text_length : 2 * half))
        return sm_fail(error, SM_INPUT, "%s: the importer's reply is broken", path);
    reply += sizeof header;
    if (header.text_length) return fail_with_text(reply, header.text_length, path, error);
    *count = header.vertex_count;
    *position = sm_alloc((size_t)*count, sizeof **position);
    *normal = sm_alloc((size_t)*count, sizeof **normal);
    memcpy(*position, reply, half);
    memcpy(*normal, reply + half, half);
    return SM_OK;
}
