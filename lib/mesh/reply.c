#include "reply.h"

#include <limits.h>
#include <stdbool.h>
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

/* Reads the header, whose positions and, of `points`, normals or else triangles follow it. */
static SmCode read_header(const unsigned char *reply, size_t size, bool points, const char *path,
                          SmReplyHeader *header, SmError *error)
{
    *header = (SmReplyHeader){0};
    if (size >= sizeof *header) memcpy(header, reply, sizeof *header);
    bool sound = header->magic == SM_REPLY_MAGIC && header->text_length <= SM_REPLY_TEXT &&
                 header->vertex_count >= 0 && header->vertex_count <= INT_MAX &&
                 header->triangle_count >= 0 && header->triangle_count <= INT_MAX;
    size_t body = header->text_length, vertices = (size_t)header->vertex_count;
    if (sound && !body)
        body = vertices * sizeof(double[3]) +
               (points ? vertices * sizeof(double[3])
                       : (size_t)header->triangle_count * sizeof(int[3]));
    if (!sound || size - sizeof *header != body)
        return sm_fail(error, SM_INPUT, "%s: the importer's reply is broken", path);
    if (header->text_length)
        return fail_with_text(reply + sizeof *header, header->text_length, path, error);
    return SM_OK;
}

SmCode sm_reply_read(const unsigned char *reply, size_t size, const char *path, SmMesh *mesh,
                     SmError *error)
{
    SmReplyHeader header;
    *mesh = (SmMesh){0};
    SmCode code = read_header(reply, size, false, path, &header, error);
    if (code) return code;
    if (!header.triangle_count) return fail_without_triangles(&header, path, error);
    *mesh = sm_mesh_new(header.vertex_count, header.triangle_count);
    size_t positions = (size_t)mesh->vertex_count * sizeof *mesh->position;
    memcpy(mesh->position, reply + sizeof header, positions);
    memcpy(mesh->triangle, reply + sizeof header + positions,
           (size_t)mesh->triangle_count * sizeof *mesh->triangle);
    return sm_mesh_prepare(mesh, path, error);
}

SmCode sm_reply_points(const unsigned char *reply, size_t size, const char *path, long *count,
                       double (**position)[3], double (**normal)[3], SmError *error)
{
    SmReplyHeader header;
    SmCode code = read_header(reply, size, true, path, &header, error);
    if (code) return code;
    size_t bytes = (size_t)header.vertex_count * sizeof **position;
    *count = header.vertex_count;
    *position = sm_alloc((size_t)*count, sizeof **position);
    *normal = sm_alloc((size_t)*count, sizeof **normal);
    memcpy(*position, reply + sizeof header, bytes);
    memcpy(*normal, reply + sizeof header + bytes, bytes);
    return SM_OK;
}
