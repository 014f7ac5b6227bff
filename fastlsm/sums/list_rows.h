/* list_rows.h - rows that lists (subsum_lists.h) name. */
#ifndef LSM_LIST_ROWS_H
#define LSM_LIST_ROWS_H

#include "../state.h"

/* The row of this name among `rows`, which are `width` values wide. */
SM_INLINE const real *named(const real *rows, uint64_t name, int width)
{
    return (const real *)((const char *)rows + name * ((size_t)width * sizeof(real) / LSM_NAME));
}

#endif
