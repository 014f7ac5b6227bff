/* list_rows.h - rows that lists (subsum_lists.h) name, for the forms that sum them. */
#ifndef LSM_LIST_ROWS_H
#define LSM_LIST_ROWS_H

#include "../../lib/simd/rows.h"
#include "../state.h"

/* Calls kernel(..., side), one body in which `side` is a constant for the usual widths: its loops
 * are unrolled. */
#define WITH_SIDE(side, kernel, ...) kernel(__VA_ARGS__, side)
#define AT_SIDE(number, ...)                                                                       \
    case number:                                                                                   \
        WITH_SIDE(number, __VA_ARGS__);                                                            \
        break
#define FOR_SIDE(side, ...)                                                                        \
    do {                                                                                           \
        switch (side) {                                                                            \
            AT_SIDE(3, __VA_ARGS__);                                                               \
            AT_SIDE(5, __VA_ARGS__);                                                               \
            AT_SIDE(7, __VA_ARGS__);                                                               \
            AT_SIDE(9, __VA_ARGS__);                                                               \
            AT_SIDE(11, __VA_ARGS__);                                                              \
            AT_SIDE(13, __VA_ARGS__);                                                              \
            AT_SIDE(15, __VA_ARGS__);                                                              \
            AT_SIDE(17, __VA_ARGS__);                                                              \
        default:                                                                                   \
            WITH_SIDE(side, __VA_ARGS__);                                                          \
        }                                                                                          \
    } while (0)

/* The row of this name among `rows`, which are `width` values wide. */
SM_INLINE const real *named(const real *rows, uint64_t name, int width)
{
    return (const real *)((const char *)rows + name * ((size_t)width * sizeof(real) / LSM_NAME));
}

/* The sums of a tile from a row for each lane: (C, Cx, Cy, Cz), each padded to four, or the twelve
 * plain ones. */
SM_INLINE void sums_of_rows(const real *const row[SM_LANES], bool plain, vec sum[12])
{
    vec field[16];
    lanes_from_rows(row, field);
    if (plain) {
        lanes_copy(12, field, sum);
        return;
    }
    for (int i = 0; i < 3; i++) {
        sum[i] = field[i];
        for (int d = 0; d < 3; d++) sum[3 + 3 * i + d] = field[4 * (d + 1) + i];
    }
}

#endif
