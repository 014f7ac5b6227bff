#define _GNU_SOURCE
#include "recentre.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef enum { OBJ, STL, PLY, OFF } Format;

/* Goes through the lines and says which are vertices. */
typedef struct {
    Format format;
    const char *line, *end;
    bool bad;
    bool header;   /* PLY, OFF: still in it */
    bool ascii;    /* PLY: the header says so */
    int element;   /* PLY: elements seen; vertices must be the first */
    int axes;      /* PLY: properties seen; x, y, z must be the first three */
    long vertices; /* PLY, OFF: still to come */
} Lines;

static bool starts(const char *line, const char *word)
{
    size_t length = strlen(word);
    return strncmp(line, word, length) == 0 && strchr(" \t\r\n", line[length]);
}

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

static void ply_header_line(Lines *lines)
{
    static const char *const axis[3] = {"x", "y", "z"};
    char type[16], name[16];
    const char *line = lines->line;
    if (starts(line, "format")) lines->ascii = starts(skip_blanks(line + 6), "ascii");
    if (starts(line, "element") && lines->element++ == 0)
        lines->bad |= sscanf(line, "element vertex %ld", &lines->vertices) != 1;
    if (starts(line, "property") && lines->element == 1 && lines->axes < 3) {
        lines->bad |= sscanf(line, "property %15s %15s", type, name) != 2 ||
                      strcmp(name, axis[lines->axes]) != 0;
        lines->axes++;
    }
    if (starts(line, "end_header")) {
        lines->header = false;
        lines->bad |= !lines->ascii || lines->axes < 3;
    }
}

static void off_header_line(Lines *lines)
{
    const char *line = skip_blanks(lines->line);
    if (starts(line, "OFF")) line = skip_blanks(line + 3);
    if (strchr("#\r\n", *line)) return;
    lines->bad |= sscanf(line, "%ld", &lines->vertices) != 1;
    lines->header = false;
}

/* The first coordinate's place in the present line if that is a vertex, or NULL. */
static const char *vertex_of(Lines *lines)
{
    const char *line = skip_blanks(lines->line);
    if (lines->format == OBJ) return starts(line, "v") ? line + 1 : NULL;
    if (lines->format == STL) return starts(line, "vertex") ? line + 6 : NULL;
    if (lines->header) {
        if (lines->format == PLY)
            ply_header_line(lines);
        else
            off_header_line(lines);
        return NULL;
    }
    if (lines->vertices < 1 || strchr("#\r\n", *line)) return NULL;
    lines->vertices--;
    return line;
}

/* Reads three coordinates that `place` begins and returns what follows them, or NULL. */
static const char *read_position(const Lines *lines, const char *place, double position[3])
{
    for (int a = 0; a < 3; a++) {
        char *after;
        place = skip_blanks(place);
        if (strchr("\r\n", *place)) return NULL;
        position[a] = strtod(place, &after);
        if (after == place || !isfinite(position[a])) return NULL;
        place = after;
    }
    if (place > lines->end) return NULL;
    /* A fourth and last number in OBJ is a weight, and shifting would need dividing by it. */
    const char *rest = skip_blanks(place);
    size_t token = strcspn(rest, " \t\r\n");
    if (lines->format == OBJ && token && strchr("\r\n", *skip_blanks(rest + token))) return NULL;
    return place;
}

static bool next_line(Lines *lines, const char *text_end)
{
    lines->line = lines->end;
    if (lines->line >= text_end) return false;
    const char *newline = memchr(lines->line, '\n', (size_t)(text_end - lines->line));
    lines->end = newline ? newline + 1 : text_end;
    return true;
}

static Lines start_lines(const char *text, Format format)
{
    return (Lines){.format = format, .end = text, .header = true};
}

static bool find_offset(const char *text, size_t size, Format format, double offset[3])
{
    Lines lines = start_lines(text, format);
    SmBox box = sm_no_box();
    while (next_line(&lines, text + size)) {
        double position[3];
        const char *place = vertex_of(&lines);
        if (lines.bad || (place && !read_position(&lines, place, position))) return false;
        if (place) sm_box_add(&box, position);
    }
    return sm_is_far(&box, offset);
}

static bool known_format(const char *text, const char *suffix, Format *format)
{
    static const char *const names[] = {"obj", "stl", "ply", "off"};
    for (int f = 0; f < 4; f++)
        if (strcasecmp(suffix, names[f]) == 0) {
            *format = (Format)f;
            return f != STL || strncasecmp(text, "solid", 5) == 0;
        }
    return false;
}

static void copy_moved(const char *text, size_t size, Format format, const double offset[3],
                       FILE *copy)
{
    Lines lines = start_lines(text, format);
    while (next_line(&lines, text + size)) {
        double p[3];
        const char *place = vertex_of(&lines), *rest = lines.line;
        if (place) {
            rest = read_position(&lines, place, p);
            fwrite(lines.line, 1, (size_t)(place - lines.line), copy);
            fprintf(copy, " %.9g %.9g %.9g", p[0] - offset[0], p[1] - offset[1], p[2] - offset[2]);
        }
        fwrite(rest, 1, (size_t)(lines.end - rest), copy);
    }
}

char *sm_recentre(const char *text, size_t size, const char *suffix, size_t *new_size,
                  double offset[3])
{
    Format format;
    char *copy = NULL;
    if (strlen(text) != size || !known_format(text, suffix, &format)) return NULL;
    if (!find_offset(text, size, format, offset)) return NULL;
    FILE *file = open_memstream(&copy, new_size);
    if (!file) return NULL;
    copy_moved(text, size, format, offset, file);
    bool failed = ferror(file);
    if (fclose(file) == 0 && !failed) return copy;
    free(copy);
    return NULL;
}
