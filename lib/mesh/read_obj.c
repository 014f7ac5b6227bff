/* Wavefront OBJ: vertices and faces; lines, points and curves are counted. */
#include <limits.h>
#include <stdint.h>
#include <string.h>

#include "draft.h"

/* Reads "1", "1/2", "1//3" or "1/2/3"; negative numbers count back from the last vertex. */
static bool read_corner(SmDraft *draft)
{
    const char *at = draft->at, *end = at + sm_draft_length(draft);
    bool negative = *at == '-';
    const char *first = at += negative;
    int64_t vertex = 0, known = draft->mesh.vertex_count; /* a long may have 32 bits */
    for (; at < end && *at >= '0' && *at <= '9'; at++)
        if (vertex < INT_MAX) vertex = 10 * vertex + (*at - '0');
    if (at == first || (at < end && *at != '/') || vertex == 0 || (negative && vertex > known))
        return sm_draft_fail_word(draft, "the number of a vertex");
    draft->at = end;
    return sm_draft_corner(draft, (double)(negative ? known - vertex : vertex - 1));
}

static bool read_obj_face(SmDraft *draft)
{
    while (sm_draft_word(draft))
        if (!read_corner(draft)) return false;
    if (draft->corners < 3)
        return sm_draft_fail(draft, "a face of %ld vertices" SM_AGAIN, draft->corners);
    return sm_draft_face(draft);
}

static bool read_obj_vertex(SmDraft *draft)
{
    double position[3];
    for (int d = 0; d < 3; d++) {
        if (!sm_draft_word(draft))
            return sm_draft_fail(draft, "a vertex has three coordinates, not %d" SM_AGAIN, d);
        if (!sm_draft_decimal(draft, &position[d])) return false;
    }
    return sm_draft_vertex(draft, position, NULL);
}

static bool read_statement(SmDraft *draft)
{
    SmMeshLeftOut *left_out = &draft->left_out;
    if (sm_draft_take(draft, "v", false)) return read_obj_vertex(draft);
    if (sm_draft_take(draft, "f", false) || sm_draft_take(draft, "fo", false))
        return read_obj_face(draft);
    if (sm_draft_take(draft, "l", false)) left_out->lines++;
    if (sm_draft_take(draft, "p", false))
        for (; sm_draft_word(draft); sm_draft_skip(draft, 1)) left_out->points++;
    left_out->curves += sm_draft_take(draft, "curv", false) || sm_draft_take(draft, "surf", false);
    return true;
}

bool sm_read_obj(SmDraft *draft)
{
    draft->comment = '#';
    draft->joined = true;
    sm_draft_trim(draft);
    const char *zero = memchr(draft->begin, 0, (size_t)(draft->end - draft->begin));
    if (zero) {
        draft->at = zero;
        draft->line = 0;
        return sm_draft_fail(draft, "a zero byte in text" SM_AGAIN);
    }
    do
        if (sm_draft_word(draft) && !read_statement(draft)) return false;
    while (sm_draft_line(draft));
    return true;
}
