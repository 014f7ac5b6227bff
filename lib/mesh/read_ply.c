/* PLY (Turk 1994): ASCII and binary of both byte orders; elements and properties of any number,
 * order and type. */
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "draft.h"

enum { MOST_ELEMENTS = 64, MOST_PROPERTIES = 256 };

/* Uses of a property: 0 to 2 a coordinate, 3 to 5 a part of the normal. */
enum { NO_USE = -1, NUMBERS = 6, CORNERS = 6 };

typedef struct {
    bool list;
    SmNumberType type, count_type;
    int use;
} Property;

typedef enum { VERTICES, FACES, STRIPS, EDGES, OTHERS } Kind;

typedef struct {
    Kind kind;
    char name[24]; /* cut off */
    long count;
    int first, properties;
} Element;

typedef struct {
    SmDraft *draft;
    bool ascii;
    int elements, properties;
    Element element[MOST_ELEMENTS];
    Property property[MOST_PROPERTIES];
} Ply;

/* ---- header */

/* Takes the next word if it is one of the list, and returns its place in it; `count`: it is not. */
static int take_one(SmDraft *draft, const char *const *list, int count)
{
    int i = sm_draft_word(draft) ? 0 : count;
    while (i < count && !sm_draft_take(draft, list[i], false)) i++;
    return i;
}

static bool read_type(SmDraft *draft, SmNumberType *type)
{
    static const char *const types[] = {"char",  "uchar",  "short",   "ushort", "int",   "uint",
                                        "float", "double", "int8",    "uint8",  "int16", "uint16",
                                        "int32", "uint32", "float32", "float64"};
    int found = take_one(draft, types, 16);
    *type = (SmNumberType)(found % 8);
    return found < 16 || sm_draft_fail(draft, "a property of no type that PLY has" SM_AGAIN);
}

static bool read_property(Ply *ply)
{
    static const char *const numbers[] = {"x", "y", "z", "nx", "ny", "nz"};
    static const char *const corners[] = {"vertex_indices", "vertex_index"};
    static const char *const list[] = {"list"};
    SmDraft *draft = ply->draft;
    if (!ply->elements || ply->properties == MOST_PROPERTIES)
        return sm_draft_fail(draft, "a property of no element, or more than %d", MOST_PROPERTIES);
    Element *element = &ply->element[ply->elements - 1];
    Property *property = &ply->property[ply->properties++];
    element->properties++;
    property->use = NO_USE;
    property->list = take_one(draft, list, 1) == 0;
    if (property->list && !read_type(draft, &property->count_type)) return false;
    if (!read_type(draft, &property->type)) return false;
    if (property->list && (element->kind == FACES || element->kind == STRIPS))
        property->use = take_one(draft, corners, 2) < 2 ? CORNERS : NO_USE;
    else if (!property->list && element->kind == VERTICES)
        property->use = take_one(draft, numbers, NUMBERS);
    if (element->kind == VERTICES && property->use == NUMBERS) property->use = NO_USE;
    return true;
}

static bool read_element(Ply *ply)
{
    static const char *const kinds[] = {"vertex", "face", "tristrips", "edge"};
    SmDraft *draft = ply->draft;
    if (ply->elements == MOST_ELEMENTS || !sm_draft_word(draft))
        return sm_draft_fail(draft, "an element of no name, or more than %d", MOST_ELEMENTS);
    Element *element = &ply->element[ply->elements++];
    int length = sm_draft_length(draft);
    *element = (Element){.first = ply->properties};
    memcpy(element->name, draft->at, (size_t)(length < 23 ? length : 23));
    element->kind = (Kind)take_one(draft, kinds, 4);
    sm_draft_skip(draft, element->kind == OTHERS);
    return sm_draft_count(draft, SM_U32, 0, &element->count);
}

static bool read_header(Ply *ply)
{
    static const char *const words[] = {"format",  "element",  "property",
                                        "comment", "obj_info", "end_header"};
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    SmDraft *draft = ply->draft;
    int format = 3;
    if (!sm_draft_word(draft) || !sm_draft_take(draft, "ply", false))
        return sm_draft_fail(draft, "a PLY file begins with 'ply', and this one does not");
    while (sm_draft_line(draft)) {
        if (!sm_draft_word(draft)) continue;
        int word = take_one(draft, words, 6);
        if (word == 0) format = take_one(draft, formats, 3);
        if ((word == 1 && !read_element(ply)) || (word == 2 && !read_property(ply))) return false;
        if (word == 6) return sm_draft_fail_word(draft, "a word of a PLY header");
        ply->ascii = format == 0;
        draft->big = format == 2;
        if (word == 5)
            return format < 3 ||
                   sm_draft_fail(draft, "the header has no format that is known" SM_AGAIN);
    }
    return sm_draft_fail(draft, "the header has no end" SM_AGAIN);
}

/* Binary data follow one line end, which is CR alone where it is so after the first line: the next
 * byte, if it is LF, is a number's then. */
static void begin_binary(SmDraft *draft)
{
    const char *first = draft->begin;
    while (*first != '\n' && *first != '\r') first++;
    bool alone = *first == '\r' && first[1] != '\n';
    while (draft->at < draft->end && *draft->at != '\n' && *draft->at != '\r') draft->at++;
    if (alone && draft->at < draft->end)
        draft->at++;
    else
        sm_draft_line(draft);
    draft->line = 0;
}

/* ---- body */

/* -1, which ends a strip, is no corner. Every other triangle of a strip is turned round. */
static bool add_ply_strip(SmDraft *draft, double vertex, long *length, double last[2])
{
    bool odd = ++*length % 2 == 0;
    if (vertex == -1) *length = 0;
    if (*length > 2 && !(sm_draft_corner(draft, last[odd]) && sm_draft_corner(draft, last[!odd]) &&
                         sm_draft_corner(draft, vertex) && sm_draft_face(draft)))
        return false;
    last[0] = last[1];
    last[1] = vertex;
    return true;
}

static bool read_ply_list(Ply *ply, const Element *element, const Property *property)
{
    SmDraft *draft = ply->draft;
    long count, length = 0;
    double vertex, last[2];
    int size = ply->ascii ? 2 : sm_number_size(property->type);
    bool used = property->use == CORNERS;
    if (!sm_draft_count(draft, property->count_type, size, &count)) return false;
    for (long i = 0; i < count; i++)
        if (!sm_draft_numbers(draft, property->type, 1, &vertex) ||
            (used && !(element->kind == FACES ? sm_draft_corner(draft, vertex)
                                              : add_ply_strip(draft, vertex, &length, last))))
            return false;
    return !used || element->kind == STRIPS || sm_draft_face(draft);
}

static bool read_ply_row(Ply *ply, const Element *element)
{
    double number[NUMBERS] = {0}, other;
    for (int p = element->first; p < element->first + element->properties; p++) {
        const Property *property = &ply->property[p];
        double *value = property->use == NO_USE || property->list ? &other : &number[property->use];
        if (property->list ? !read_ply_list(ply, element, property)
                           : !sm_draft_numbers(ply->draft, property->type, 1, value))
            return false;
    }
    ply->draft->left_out.lines += element->kind == EDGES;
    return element->kind != VERTICES || sm_draft_vertex(ply->draft, number, number + 3);
}

/* Checks that the element has what it needs, and that the file is large enough for its count. */
static bool check_element(Ply *ply, const Element *element)
{
    SmDraft *draft = ply->draft;
    int uses = 0;
    double least = 0;
    for (int p = element->first; p < element->first + element->properties; p++) {
        const Property *property = &ply->property[p];
        least +=
            ply->ascii ? 2 : sm_number_size(property->list ? property->count_type : property->type);
        uses |= property->use == NO_USE ? 0 : 1 << property->use;
    }
    if ((double)element->count * least > (double)(draft->end - draft->at) + ply->ascii)
        return sm_draft_fail(draft, "the file is too small for %ld of its element '%s'" SM_AGAIN,
                             element->count, element->name);
    if (element->kind == VERTICES && (uses & 7) != 7)
        return sm_draft_fail(draft,
                             "its vertices lack property x, y or z; export them with positions");
    if ((element->kind == FACES || element->kind == STRIPS) && element->count && !uses)
        return sm_draft_fail(draft, "its element '%s' lacks the list vertex_indices; export it so",
                             element->name);
    return true;
}

static bool read_ply_body(Ply *ply)
{
    SmDraft *draft = ply->draft;
    if (ply->ascii)
        sm_draft_trim(draft);
    else
        begin_binary(draft);
    for (int e = 0; e < ply->elements; e++) {
        const Element *element = &ply->element[e];
        if (!check_element(ply, element)) return false;
        sm_draft_reserve(draft, element->kind == VERTICES ? element->count : 0,
                         element->kind == FACES ? element->count : 0);
        for (long i = 0; i < element->count && element->properties; i++)
            if (!read_ply_row(ply, element)) return false;
    }
    return !ply->ascii || !sm_draft_find(draft) ||
           sm_draft_fail(draft, "there is more data than the header says" SM_AGAIN);
}

bool sm_read_ply(SmDraft *draft)
{
    Ply *ply = sm_alloc(1, sizeof *ply);
    ply->draft = draft;
    bool good = read_header(ply) && read_ply_body(ply);
    free(ply);
    return good;
}
