#define _GNU_SOURCE
#include "mesh_text.h"

#include <ctype.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ELEMENTS = 16, PROPERTIES = 32 };

typedef struct {
    const char *lines, *lines_end; /* in the header */
    const char *data, *data_end;
    long count;
    int properties;
    int list[PROPERTIES]; /* bytes of a list's length; 0: not a list */
    int size[PROPERTIES]; /* bytes of a value */
} Element;

typedef struct {
    Element element[ELEMENTS];
    int count, vertices; /* elements, and which of them holds the vertices: -1 none */
    bool ascii, big_endian;
    bool words, lines; /* ASCII data are found by their words; they stand one of each line */
} Ply;

static const char blank[] = " \t\n\v\f\r";

static int size_of(const char *type)
{
    static const char *const names[4] = {" char uchar int8 uint8 ", " short ushort int16 uint16 ",
                                         " int uint int32 uint32 float float32 ",
                                         " double float64 "};
    char word[20];
    snprintf(word, sizeof word, " %s ", type);
    for (int s = 0; s < 4; s++)
        if (strstr(names[s], word)) return 1 << s;
    return 0;
}

static bool add_property(Ply *ply, const char *line)
{
    char length[16], type[16];
    if (ply->count == 0) return false;
    Element *e = &ply->element[ply->count - 1];
    if (e->properties == PROPERTIES) return false;
    bool list = sscanf(line, "property list %15s %15s", length, type) == 2;
    if (!list && sscanf(line, "property %15s", type) != 1) return false;
    e->list[e->properties] = list ? size_of(length) : 0;
    e->size[e->properties] = size_of(type);
    bool known = e->size[e->properties] && (!list || e->list[e->properties]);
    e->properties++;
    return known;
}

static bool add_element(Ply *ply, const char *line)
{
    char name[16];
    long count;
    if (ply->count == ELEMENTS || sscanf(line, "element %15s %ld", name, &count) != 2) return false;
    if (strcmp(name, "vertex") == 0 && ply->vertices < 0) ply->vertices = ply->count;
    ply->element[ply->count++] = (Element){.count = count};
    return count >= 0;
}

/* Returns where the data begin, or NULL. */
static const char *read_header(const char *text, const char *end, Ply *ply)
{
    const char *newline;
    *ply = (Ply){.vertices = -1};
    for (const char *at = text; (newline = memchr(at, '\n', (size_t)(end - at)));
         at = newline + 1) {
        char line[128];
        int before = ply->count;
        snprintf(line, sizeof line, "%.*s", (int)(newline - at < 127 ? newline - at : 127), at);
        if (at == text && strncmp(line, "ply", 3) != 0) return NULL;
        if (strncmp(line, "end_header", 10) == 0) return newline + 1;
        if (strncmp(line, "format", 6) == 0) {
            ply->ascii = strstr(line, "ascii");
            ply->big_endian = strstr(line, "big_endian");
        }
        if (strncmp(line, "element", 7) == 0 && !add_element(ply, line)) return NULL;
        if (strncmp(line, "property", 8) == 0 && !add_property(ply, line)) return NULL;
        if (ply->count > before) ply->element[before].lines = at;
        if (ply->count) ply->element[ply->count - 1].lines_end = newline + 1;
    }
    return NULL;
}

/* What follows so many words; NULL when the text ends before. */
static const char *skip_words(const char *at, long count)
{
    for (; count > 0; count--) {
        at += strspn(at, blank);
        if (!*at) return NULL;
        at += strcspn(at, blank);
    }
    return at;
}

static const char *skip_line_of_words(const Element *e, const char *at)
{
    for (int p = 0; p < e->properties && at; p++) {
        long values = e->list[p] ? strtol(at, NULL, 10) : 1;
        at = values < 0 || values >= INT_MAX ? NULL : skip_words(at, values + (e->list[p] > 0));
    }
    return at;
}

/* What follows one vertex, face or whatever it is; NULL when the file ends before. */
static const char *skip_one(const Ply *ply, const Element *e, const char *at, const char *end)
{
    if (ply->words) return skip_line_of_words(e, at);
    if (ply->ascii) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        return newline ? newline + 1 : at < end ? end : NULL;
    }
    for (int p = 0; p < e->properties; p++) {
        size_t values = e->list[p] ? 0 : 1;
        if (end - at < e->list[p]) return NULL;
        for (int b = 0; b < e->list[p]; b++)
            values = values << 8 | (unsigned char)at[ply->big_endian ? b : e->list[p] - 1 - b];
        at += e->list[p];
        if (values > (size_t)(end - at) / (size_t)e->size[p]) return NULL;
        at += values * (size_t)e->size[p];
    }
    return at;
}

static bool find_data(Ply *ply, const char *at, const char *end)
{
    for (int i = 0; i < ply->count; i++) {
        Element *e = &ply->element[i];
        e->data = at;
        if (e->properties == 0) return false;
        for (long n = 0; n < e->count; n++)
            if (!(at = skip_one(ply, e, at, end))) return false;
        e->data_end = at;
    }
    return true;
}

/* Are the data as many words as the header says, no less and no more? Notes whether each element
 * has a line of its own, and no other. */
static bool find_words(Ply *ply, const char *data, const char *end)
{
    ply->words = ply->lines = true;
    if (!find_data(ply, data, end)) return false;
    const Element *last = &ply->element[ply->count - 1];
    for (const Element *e = ply->element; e <= last && ply->lines; e++) {
        const char *at = e->data;
        for (long n = 0; n < e->count; n++) {
            const char *first = at + strspn(at, blank), *after = skip_line_of_words(e, first);
            const char *next = after + strspn(after, blank);
            bool ends = !*next || memchr(after, '\n', (size_t)(next - after));
            if (!ends || memchr(first, '\n', (size_t)(after - first))) ply->lines = false;
            at = after;
        }
    }
    return last->data_end + strspn(last->data_end, blank) == end;
}

/* A line of each. */
static void write_lines(const Element *e, FILE *copy)
{
    const char *at = e->data;
    for (long n = 0; n < e->count; n++) {
        const char *after = skip_line_of_words(e, at);
        for (at += strspn(at, blank); at < after; at++)
            fputc(*at == '\n' || *at == '\r' ? ' ' : *at, copy);
        fputc('\n', copy);
    }
}

static void write_data(const Ply *ply, const Element *e, FILE *copy)
{
    if (ply->words) {
        write_lines(e, copy);
        return;
    }
    size_t size = (size_t)(e->data_end - e->data);
    fwrite(e->data, 1, size, copy);
    if (ply->ascii && size && e->data_end[-1] != '\n') fputc('\n', copy);
}

static void write_copy(const Ply *ply, const char *text, const char *data, FILE *copy)
{
    const Element *vertices = &ply->element[ply->vertices], *last = &ply->element[ply->count - 1];
    fwrite(text, 1, (size_t)(ply->element[0].lines - text), copy);
    fwrite(vertices->lines, 1, (size_t)(vertices->lines_end - vertices->lines), copy);
    for (const Element *e = ply->element; e <= last; e++)
        if (e != vertices) fwrite(e->lines, 1, (size_t)(e->lines_end - e->lines), copy);
    fwrite(last->lines_end, 1, (size_t)(data - last->lines_end), copy);
    write_data(ply, vertices, copy);
    for (const Element *e = ply->element; e <= last; e++)
        if (e != vertices) write_data(ply, e, copy);
}

char *sm_ply_ordered(const char *text, size_t size, size_t *new_size)
{
    Ply ply;
    const char *data = read_header(text, text + size, &ply), *end = text + size;
    char *copy = NULL;
    if (!data || ply.vertices < 0) return NULL;
    bool whole = ply.ascii && find_words(&ply, data, end);
    if (!whole) ply.words = false;
    if (ply.vertices == 0 && (!whole || ply.lines)) return NULL;
    if (!whole && !find_data(&ply, data, end)) return NULL;
    FILE *file = open_memstream(&copy, new_size);
    if (!file) return NULL;
    write_copy(&ply, text, data, file);
    bool failed = ferror(file);
    if (fclose(file) == 0 && !failed) return copy;
    free(copy);
    return NULL;
}

bool sm_ply_lacks_lines(const char *text)
{
    const char *end = strstr(text, "\nend_header");
    const char *format = strstr(text, "\nformat ascii");
    double wanted = 0, lines = 0;
    if (!end || !format || format > end) return false;
    for (const char *at = text; (at = strstr(at, "\nelement ")) && at < end; at++) {
        const char *count = at + strlen("\nelement ");
        count += strcspn(count, " \n");
        wanted += strtod(count, NULL);
    }
    const char *line = end + 1;
    for (line += strcspn(line, "\r\n"); *line; line += strcspn(line, "\r\n")) {
        line += strspn(line, " \t\r\n");
        lines += *line != 0;
    }
    return lines < wanted;
}

/* Behind blanks, ends of lines and comments; NULL at the end. */
static const char *skip(const char *at)
{
    for (;;) {
        at += strspn(at, " \t\r\n");
        if (*at != '#') return *at ? at : NULL;
        at += strcspn(at, "\n");
    }
}

static const char *next_line(const char *at)
{
    return skip(at + strcspn(at, "\n"));
}

/* The counts, behind the keyword: on its line or on the next one. */
static const char *counts(const char *text)
{
    const char *at = skip(text);
    size_t length = at ? strcspn(at, " \t\r\n#") : 0;
    return length >= 3 && strncmp(at + length - 3, "OFF", 3) == 0 ? skip(at + length) : NULL;
}

/* A whole number of the line; false where there is none. */
static bool take(const char **at, long long *number)
{
    const char *from = *at + strspn(*at, " \t");
    char *end;
    if (isspace((unsigned char)*from)) return false;
    *number = strtoll(from, &end, 10);
    if (end == from || (*end && !isspace((unsigned char)*end))) return false;
    *at = end;
    return true;
}

bool sm_off_out_of_range(const char *text)
{
    long long vertices, faces, corners, index;
    const char *at = counts(text);
    if (!at || !take(&at, &vertices) || !take(&at, &faces)) return false;
    for (long long v = 0; v < vertices; v++)
        if (!(at = next_line(at))) return false;
    for (long long f = 0; f < faces && (at = next_line(at)); f++) {
        if (!take(&at, &corners)) return false;
        for (long long c = 0; c < corners; c++) {
            if (!take(&at, &index)) return false;
            if (index < 0 || index >= vertices) return true;
        }
    }
    return false;
}
