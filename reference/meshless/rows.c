#include "rows.h"

#include <stdlib.h>

void ref_rows_free(RefRows *rows)
{
    free(rows->start);
    free(rows->column);
    free(rows->value);
    *rows = (RefRows){0};
}

/* Room for one more row of `entries` entries; returns where they begin. */
static long append(RefRows *rows, long entries)
{
    long first = rows->count ? rows->start[rows->count] : 0;
    rows->start = sm_realloc(rows->start, (size_t)rows->count + 2, sizeof *rows->start);
    rows->column = sm_realloc(rows->column, (size_t)(first + entries), sizeof *rows->column);
    rows->value = sm_realloc(rows->value, (size_t)(first + entries), sizeof *rows->value);
    rows->start[rows->count++] = first;
    rows->start[rows->count] = first + entries;
    return first;
}

void ref_rows_displacement(RefRows *rows, const RefShape *shape, int axis)
{
    long at = append(rows, shape->count);
    for (int n = 0; n < shape->count; n++, at++) {
        rows->column[at] = 3 * shape->node[n] + axis;
        rows->value[at] = shape->value[n];
    }
}

/* (curl u)_a = d u_c / d x_b - d u_b / d x_c, with a, b, c in turn. */
void ref_rows_turn(RefRows *rows, const RefShape *shape, int axis)
{
    long at = append(rows, 2L * shape->count);
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (int n = 0; n < shape->count; n++, at += 2) {
        rows->column[at] = 3 * shape->node[n] + c;
        rows->value[at] = 0.5 * shape->gradient[n][b];
        rows->column[at + 1] = 3 * shape->node[n] + b;
        rows->value[at + 1] = -0.5 * shape->gradient[n][c];
    }
}
