/* OFF of Geomview, text and binary. A vertex or a face of text begins a line; what follows its
 * numbers there is a colour, a normal or a place in a picture. */
#include <limits.h>
#include <string.h>

#include "draft.h"

/* Numbers of a vertex, in order: position, normal, colour, place in a picture. */
typedef struct {
    bool normal, colour, place, binary;
} Kind;

/* Takes "[ST][C][N][4][n]OFF"; without it the file begins with its counts. */
static bool read_keyword(SmDraft *draft, Kind *kind)
{
    const char *at = draft->at, *end = draft->end;
    *kind = (Kind){.place = end - at > 2 && at[0] == 'S' && at[1] == 'T'};
    at += kind->place ? 2 : 0;
    if ((kind->colour = at < end && *at == 'C')) at++;
    if ((kind->normal = at < end && *at == 'N')) at++;
    const char *prefix = at;
    while (at < end && (*at == '4' || *at == 'n')) at++;
    if (end - at < 3 || memcmp(at, "OFF", 3) != 0)
        return (*draft->at >= '0' && *draft->at <= '9') ||
               sm_draft_fail(draft, "an OFF file begins with 'OFF', and this one does not");
    if (at > prefix)
        return sm_draft_fail(draft,
                             "%.*sOFF has other coordinates than x, y and z; export it as OFF",
                             at - prefix > 2 ? 2 : (int)(at - prefix), prefix);
    draft->at = at + 3;
    kind->binary = sm_draft_word(draft) && sm_draft_take(draft, "BINARY", false);
    if (!kind->binary) return true;
    sm_draft_line(draft);
    draft->line = 0;
    return draft->big = true;
}

/* Passes over the count of edges, which many writers leave out: a third number in the line of the
 * counts, or the only one in the next line. */
static void skip_edges(SmDraft *draft)
{
    SmDraft before = *draft;
    bool same = sm_draft_word(draft);
    if (!same && !sm_draft_find(draft)) return;
    sm_draft_skip(draft, 1);
    if (same || !sm_draft_word(draft)) return;
    draft->at = before.at;
    draft->line = before.line;
}

static bool read_counts(SmDraft *draft, int size, long *vertices, long *faces)
{
    double edges;
    if (!sm_draft_count(draft, SM_I32, size, vertices)) return false;
    long line = draft->line;
    if (!sm_draft_count(draft, SM_I32, 2, faces)) return false;
    if (!line || draft->line != line) return sm_draft_numbers(draft, SM_I32, 1, &edges);
    skip_edges(draft);
    return true;
}

static bool read_off_vertex(SmDraft *draft, const Kind *kind, int size)
{
    double number[6] = {0};
    int count = kind->normal ? 6 : 3;
    if (!sm_draft_numbers(draft, SM_F32, count, number)) return false;
    if (draft->line)
        sm_draft_skip(draft, LONG_MAX);
    else if (draft->end - draft->at < size - 4 * count)
        return sm_draft_fail(draft, "the file ends in a vertex" SM_AGAIN);
    else
        draft->at += size - 4 * count;
    return sm_draft_vertex(draft, number, number + 3);
}

static bool read_off_face(SmDraft *draft)
{
    long count, colours = 0;
    double vertex;
    if (!sm_draft_count(draft, SM_I32, draft->line ? 2 : 4, &count)) return false;
    for (long c = 0; c < count; c++)
        if (!sm_draft_numbers(draft, SM_I32, 1, &vertex) || !sm_draft_corner(draft, vertex))
            return false;
    if (draft->line)
        sm_draft_skip(draft, LONG_MAX);
    else if (!sm_draft_count(draft, SM_I32, 4, &colours))
        return false;
    draft->at += 4 * colours;
    return sm_draft_face(draft);
}

bool sm_read_off(SmDraft *draft)
{
    Kind kind;
    long vertices, faces;
    draft->comment = '#';
    if (!sm_draft_find(draft)) return sm_draft_fail(draft, "the file holds only comments");
    if (!read_keyword(draft, &kind)) return false;
    if (!kind.binary) sm_draft_trim(draft);
    int size = kind.binary ? 12 + 12 * kind.normal + 16 * kind.colour + 8 * kind.place : 6;
    if (!read_counts(draft, size, &vertices, &faces)) return false;
    sm_draft_reserve(draft, vertices, faces);
    for (long v = 0; v < vertices; v++)
        if (!read_off_vertex(draft, &kind, size)) return false;
    for (long f = 0; f < faces; f++)
        if (!read_off_face(draft)) return false;
    return kind.binary || !sm_draft_find(draft) ||
           sm_draft_fail(draft, "there is more data than the counts say" SM_AGAIN);
}
