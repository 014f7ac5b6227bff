#include "rows.h"

#include <stdlib.h>

void ref_rows_free(RefRows *rows)
{
    free(rows->start);
    free(rows->column);
    free(rows->value);
    *rows = (RefRows){0};
}

void ref_rows_displacement(RefRows *rows, const RefShape *shape, int axis)
{
    long at = rows->count ? rows->start[rows->count] : 0, end = at + shape->count;
    rows->start = sm_realloc(rows->start, (size_t)rows->count + 2, sizeof *rows->start);
    rows->column = sm_realloc(rows->column, (size_t)end, sizeof *rows->column);
    rows->value = sm_realloc(rows->value, (size_t)end, sizeof *rows->value);
    rows->start[rows->count++] = at;
    rows->start[rows->count] = end;
    for (int n = 0; n < shape->count; n++, at++) {
        rows->column[at] = 3 * shape->node[n] + axis;
        rows->value[at] = shape->value[n];
    }
}
