#include "off.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

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

bool sm_off_astray(const char *text)
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
