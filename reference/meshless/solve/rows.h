/* rows.h - linear functions of the nodal parameters: what constraints bind (meshless
 * section 5.3.3).
 *
 * MLS shape functions are no Kronecker delta, so a displacement at a point is a sum over the nodes
 * that cover it. Parameter 3 I + d is node I's along axis d. */
#ifndef REF_ROWS_H
#define REF_ROWS_H

#include "../body/mls.h"

typedef struct {
    long count;    /* rows */
    long *start;   /* [count + 1] */
    int *column;   /* [start[count]] parameter */
    double *value; /* [start[count]] */
} RefRows;

/* Appends a row to `rows` (zeroed: empty): the displacement along an axis where the shape functions
 * were taken. */
void ref_rows_displacement(RefRows *rows, const RefShape *shape, int axis);
void ref_rows_free(RefRows *rows);

/* Row `row` applied to u. */
static inline double ref_rows_apply(const RefRows *rows, long row, const double *u)
{
    double sum = 0;
    for (long e = rows->start[row]; e < rows->start[row + 1]; e++)
        sum += rows->value[e] * u[rows->column[e]];
    return sum;
}

#endif
