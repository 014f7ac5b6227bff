/* reply.h - what the importer's child process tells its parent: one SmReplyHeader, then either
 * text_length bytes of a message or vertex_count positions (three doubles each) and triangle_count
 * triangles (three ints each). */
#ifndef SM_REPLY_H
#define SM_REPLY_H

#include "mesh.h"

#include <stdint.h>

/* What to do with points without triangles, for messages. */
#define SM_REPLY_POINTS                                                                            \
    "'run --engine meshless' takes points with normals (PLY, .xyz, .pts, .txt), 'run --engine "    \
    "shell' also without"

enum { SM_REPLY_MAGIC = 0x6d657368, SM_REPLY_TEXT = 400 };

typedef struct {
    uint32_t magic;
    uint32_t text_length; /* 0: a mesh follows */
    int64_t vertex_count, triangle_count;
    int64_t points; /* vertices of faces that are points or lines, for the message */
} SmReplyHeader;

/* Makes the merged and checked mesh that `size` bytes of reply describe. Nothing in the reply is
 * trusted. `path` is for the message. SM_INPUT. */
SmCode sm_reply_read(const unsigned char *reply, size_t size, const char *path, SmMesh *mesh,
                     SmError *error);

/* The points that `size` bytes of reply to sm_importer_points() describe: vertex_count positions,
 * then as many normals. Nothing in the reply is trusted, but numbers may be anything. The caller
 * frees both arrays. SM_INPUT. */
SmCode sm_reply_points(const unsigned char *reply, size_t size, const char *path, long *count,
                       double (**position)[3], double (**normal)[3], SmError *error);

#endif
