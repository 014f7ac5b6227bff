/* STL: text in any case with any number of solids, and binary with any header. */
#include <stdint.h>
#include <string.h>

#include "draft.h"

enum { HEADER = 84, FACET = 50 };

/* ---- binary */

static bool add_facets(SmDraft *draft, long count)
{
    sm_draft_reserve(draft, 3 * count, count);
    for (long t = 0; t < count; t++) {
        draft->at = draft->begin + HEADER + FACET * t;
        for (int c = 0; c < 3; c++) {
            double position[3];
            for (int d = 0; d < 3; d++)
                position[d] = sm_number_at(draft->at + 12 + 12 * c + 4 * d, SM_F32, false);
            if (!sm_draft_corner(draft, (double)draft->mesh.vertex_count) ||
                !sm_draft_vertex(draft, position, NULL))
                return false;
        }
        if (!sm_draft_face(draft)) return false;
    }
    return true;
}

/* Some writers count none, or all that there can be, and some fill the file up with zeros. */
static bool read_binary(SmDraft *draft)
{
    draft->line = 0;
    if (draft->end - draft->begin < HEADER)
        return sm_draft_fail(draft, "the file ends in its header" SM_AGAIN);
    draft->at = draft->begin + 80;
    long body = draft->end - draft->begin - HEADER, fit = body / FACET;
    double counted = sm_number_at(draft->at, SM_U32, false); /* a long may have 32 bits */
    if ((counted == 0 || counted == UINT32_MAX) && body % FACET == 0) counted = (double)fit;
    if (counted > (double)fit)
        return sm_draft_fail(draft, "its header counts %.0f triangles, and it holds %ld" SM_AGAIN,
                             counted, fit);
    long count = (long)counted, rest = body - count * FACET;
    const char *behind = draft->end - rest;
    if (rest >= FACET && (*behind || memcmp(behind, behind + 1, (size_t)rest - 1)))
        return sm_draft_fail(
            draft, "its header counts %ld triangles, and %ld bytes follow" SM_AGAIN, count, rest);
    return add_facets(draft, count);
}

/* ---- text */

/* What has begun and not ended. */
typedef struct {
    bool solid, facet;
} Open;

static bool read_stl_vertex(SmDraft *draft, const Open *open)
{
    double position[3];
    if (!open->facet || draft->corners == 3)
        return sm_draft_fail(draft, "a vertex in no facet, or the fourth of one" SM_AGAIN);
    return sm_draft_numbers(draft, SM_F32, 3, position) &&
           sm_draft_corner(draft, (double)draft->mesh.vertex_count) &&
           sm_draft_vertex(draft, position, NULL);
}

/* Passes over "normal 0 0 1", "outer loop", "endloop" and "color 1 1 1". */
static bool skip_word(SmDraft *draft)
{
    static const char *const skipped[] = {"normal", "color", "outer", "loop", "endloop"};
    for (int i = 0; i < 5; i++) {
        if (!sm_draft_take(draft, skipped[i], true)) continue;
        sm_draft_skip(draft, i < 2 ? 3 : 0);
        return true;
    }
    return sm_draft_fail_word(draft, "a word of STL");
}

static bool read_word(SmDraft *draft, Open *open)
{
    if (sm_draft_take(draft, "vertex", true)) return read_stl_vertex(draft, open);
    if (sm_draft_take(draft, "endfacet", true)) {
        if (draft->corners != 3)
            return sm_draft_fail(draft, "a facet of %ld vertices" SM_AGAIN, draft->corners);
        open->facet = false;
        return sm_draft_face(draft);
    }
    bool facet = sm_draft_take(draft, "facet", true), solid = sm_draft_take(draft, "solid", true);
    if (!facet && !solid && !sm_draft_take(draft, "endsolid", true)) return skip_word(draft);
    if (open->facet) return sm_draft_fail(draft, "a facet has no end" SM_AGAIN);
    open->facet = facet;
    if (facet) return true;
    open->solid = solid;
    while (sm_draft_word(draft)) sm_draft_skip(draft, 1); /* its name */
    return true;
}

static bool read_stl_text(SmDraft *draft)
{
    Open open = {false, false};
    while (sm_draft_find(draft))
        if (!read_word(draft, &open)) return false;
    return !(open.solid || open.facet) ||
           sm_draft_fail(draft, "the last solid has no end" SM_AGAIN);
}

/* Text has no zero byte but at its end, and the count of a binary file has one up to 2^24
 * triangles. */
bool sm_read_stl(SmDraft *draft)
{
    const char *end = draft->end;
    sm_draft_trim(draft);
    size_t size = (size_t)(draft->end - draft->begin);
    if (!memchr(draft->begin, 0, size < 1024 ? size : 1024)) return read_stl_text(draft);
    draft->end = end;
    return read_binary(draft);
}
