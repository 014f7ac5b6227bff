#include "reader.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#ifdef SM_ZLIB
#include <zlib.h>
#endif

#include "draft.h"

typedef struct {
    const char *suffix;
    bool (*read)(SmDraft *);
} Format;

/* The format by the name's suffix, and whether that is followed by ".gz"; NULL: none of these. */
static const Format *format_of(const char *name, bool *compressed)
{
    static const Format formats[] = {
        {".obj", sm_read_obj},   {".ply", sm_read_ply},  {".stl", sm_read_stl},
        {".off", sm_read_off},   {".glb", sm_read_gltf}, {".xyz", sm_read_rows},
        {".pts", sm_read_rows},  {".pwn", sm_read_rows}, {".asc", sm_read_rows},
        {".gltf", sm_read_gltf}, {".txt", sm_read_rows}};
    size_t length = strlen(name);
    *compressed = length > 3 && !strcasecmp(name + length - 3, ".gz");
    length -= *compressed ? 3 : 0;
    for (size_t f = 0; f < sizeof formats / sizeof *formats; f++) {
        size_t suffix = strlen(formats[f].suffix);
        if (length >= suffix && !strncasecmp(name + length - suffix, formats[f].suffix, suffix))
            return &formats[f];
    }
    return NULL;
}

bool sm_mesh_readable(const char *name)
{
    bool compressed;
    return format_of(name, &compressed) != NULL;
}

const char *sm_mesh_left_out(const SmMeshLeftOut *left_out, char text[SM_LEFT_OUT_TEXT])
{
    const long count[] = {left_out->points, left_out->lines, left_out->curves, left_out->scenes};
    static const char *const noun[] = {"points", "lines", "curves", "scenes beyond the default"};
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; i < 4; i++)
        if (count[i])
            used += (size_t)snprintf(text + used, SM_LEFT_OUT_TEXT - used, "%s%s: %ld",
                                     used ? ", " : "", noun[i], count[i]);
    return text;
}

/* ---- the bytes of a draft */

/* Inflates all members into `owned`, which the caller frees. */
static bool inflate_bytes(SmDraft *draft, char **owned)
{
#ifdef SM_ZLIB
    const SmMeshFile *file = draft->file;
    z_stream stream = {.next_in = (unsigned char *)(uintptr_t)file->bytes};
    stream.avail_in = (unsigned)file->size;
    size_t room = 0, size = 0;
    int state = file->size > INT_MAX ? Z_DATA_ERROR : inflateInit2(&stream, 31);
    while (state == Z_OK || (state == Z_STREAM_END && stream.avail_in && *stream.next_in == 31)) {
        if (state == Z_STREAM_END) inflateReset(&stream);
        sm_make_room(*owned, room, size + 65536);
        if (room > INT_MAX) break;
        stream.next_out = (unsigned char *)*owned + size;
        stream.avail_out = (unsigned)(room - size);
        state = inflate(&stream, Z_NO_FLUSH);
        size = room - stream.avail_out;
    }
    inflateEnd(&stream);
    draft->begin = *owned;
    draft->end = *owned + size;
    return state == Z_STREAM_END ||
           sm_draft_fail(draft, room > INT_MAX ? "over 1 GB when uncompressed; divide the mesh"
                                               : "not a whole gzip file" SM_AGAIN);
#else
    (void)owned;
    return sm_draft_fail(draft, "gzip is read with zlib, which this program was built without; "
                                "uncompress it");
#endif
}

/* Whether the bytes are text of two bytes a character, with a byte order mark or without. */
static bool is_utf16(const char *text, size_t size)
{
    const unsigned char *b = (const unsigned char *)text;
    if (size < 4) return false;
    bool little = b[0] && !b[1] && b[2] && !b[3], big = !b[0] && b[1] && !b[2] && b[3];
    return little || big || (b[0] == 0xff && b[1] == 0xfe && b[2] && !b[3]) ||
           (b[0] == 0xfe && b[1] == 0xff && !b[2] && b[3]);
}

static bool read_format(SmDraft *draft, const Format *format)
{
    size_t size = (size_t)(draft->end - draft->begin);
    if (!size) return sm_draft_fail(draft, "the file is empty");
    if (is_utf16(draft->begin, size))
        return sm_draft_fail(draft, "the file is text in UTF-16; save it in UTF-8");
    if (size > 2 && !memcmp(draft->begin, "\xef\xbb\xbf", 3)) draft->begin += 3;
    draft->at = draft->begin;
    draft->most = 2e6 + (double)size;
    draft->line = 1;
    return format->read(draft) && sm_draft_finish(draft);
}

/* Ends with the draft's mesh, or its points, in place. */
static bool read_draft(SmDraft *draft)
{
    bool compressed;
    char *owned = NULL;
    const Format *format = format_of(draft->file->name, &compressed);
    if (!format) return sm_draft_fail(draft, SM_NO_MESH);
    if (!draft->of_points && format->read == sm_read_rows)
        return sm_draft_fail(draft,
                             "a point format holds only points, no triangles; " SM_POINTS_GO);
    draft->locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    bool good = (!compressed || inflate_bytes(draft, &owned)) && read_format(draft, format);
    freelocale(draft->locale);
    sm_free_all(owned, draft->corner, draft->polygon);
    draft->at = NULL;
    return good;
}

static SmDraft draft_of(const SmMeshFile *file, bool of_points, SmError *error)
{
    const char *bytes = (const char *)file->bytes;
    return (SmDraft){.file = file,
                     .of_points = of_points,
                     .error = error,
                     .begin = bytes,
                     .end = bytes + file->size,
                     .largest = -1};
}

SmCode sm_mesh_read_by(const SmMeshFile *file, bool (*read)(SmDraft *), SmMesh *mesh,
                       SmMeshLeftOut *left_out, SmError *error)
{
    SmError why;
    SmDraft draft = draft_of(file, false, error ? error : &why);
    bool good = read(&draft);
    long others = draft.left_out.points + draft.left_out.lines;
    if (good && !draft.mesh.triangle_count)
        good =
            sm_draft_fail(&draft, "holds only points or lines (%ld), no triangles; " SM_POINTS_GO,
                          others ? others : draft.mesh.vertex_count);
    if (!good) sm_mesh_free(&draft.mesh);
    if (left_out) *left_out = draft.left_out;
    *mesh = draft.mesh;
    return good ? sm_mesh_prepare(mesh, file->name, error) : SM_INPUT;
}

SmCode sm_mesh_read(const SmMeshFile *file, SmMesh *mesh, SmMeshLeftOut *left_out, SmError *error)
{
    return sm_mesh_read_by(file, read_draft, mesh, left_out, error);
}

SmCode sm_mesh_read_points(const SmMeshFile *file, long *count, double (**position)[3],
                           double (**normal)[3], SmError *error)
{
    SmError why;
    SmDraft draft = draft_of(file, true, error ? error : &why);
    bool good = read_draft(&draft);
    if (good && (draft.mesh.triangle_count || !draft.mesh.vertex_count))
        good = sm_draft_fail(&draft, draft.mesh.triangle_count
                                         ? "it holds triangles, and no points alone"
                                         : "it holds no points");
    free(draft.mesh.triangle);
    if (!good) sm_free_all(draft.mesh.position, draft.normal);
    *count = good ? draft.mesh.vertex_count : 0;
    *position = good ? draft.mesh.position : NULL;
    *normal = good ? draft.normal : NULL;
    return good ? SM_OK : SM_INPUT;
}
