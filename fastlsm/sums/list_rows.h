/* list_rows.h - rows that lists (subsum_lists.h) name, for the forms that sum them. */
#ifndef LSM_LIST_ROWS_H
#define LSM_LIST_ROWS_H

#include <string.h>

#include "../../lib/simd/rows.h"
#include "../state.h"

/* Calls kernel(..., side), one body in which `side`, or whatever counts members, is a constant for
 * the usual widths: its loops are unrolled. */
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

/* Calls kernel(..., way, plain), one body in which both are constants. */
#define FOR_PASS(way, plain, kernel, ...)                                                          \
    do {                                                                                           \
        if ((way) && (plain))                                                                      \
            kernel(__VA_ARGS__, 1, true);                                                          \
        else if (way)                                                                              \
            kernel(__VA_ARGS__, 1, false);                                                         \
        else if (plain)                                                                            \
            kernel(__VA_ARGS__, 0, true);                                                          \
        else                                                                                       \
            kernel(__VA_ARGS__, 0, false);                                                         \
    } while (0)

/* The row of this name among `rows`, which are `width` values wide. */
SM_INLINE const real *named(const real *rows, uint64_t name, int width)
{
    return (const real *)((const char *)rows + name * ((size_t)width * sizeof(real) / LSM_NAME));
}

/* A kind of rows: where its members are, and where it takes their moments from and adds them to, in
 * vectors of four. */
typedef enum { NO_MOMENTS, UP, DOWN } Moments;
typedef struct {
    const real *in;
    int in_width, vectors; /* values apart, and vectors of four to read */
    real *out;
    int made; /* and to write, which is their width: 2 or 4 */
    Moments moments;
    int from, to;
} Level;

/* What is summed of members' rows, in the one of three widths that is read, and their moment. */
typedef struct {
    vec4 four, moment;
    HalfRow half;
    Row row;
} Sum;

/* A member's row, and the vector of it that moments are of. */
SM_INLINE Sum member_of(Level level, const real *member)
{
    Sum own = {0};
    if (level.vectors == 1) own.four = own.moment = load4(member);
    if (level.vectors == 2) own.moment = half_first(own.half = half_load(member));
    if (level.vectors == 4) own.moment = row_first(own.row = row_load(member));
    if (level.from) own.moment = load4(member + 4 * level.from);
    return own;
}

SM_INLINE Sum sum_of(Level level, Sum a, Sum b)
{
    if (level.vectors == 1) a.four += b.four;
    if (level.vectors == 2) a.half = half_add(a.half, b.half);
    if (level.vectors == 4) a.row = row_add(a.row, b.row);
    if (level.moments != NO_MOMENTS) a.moment += b.moment;
    return a;
}

/* a less b, and place_a times the moment of a less place_b times that of b */
SM_INLINE Sum difference(Level level, real place_a, Sum a, real place_b, Sum b)
{
    if (level.vectors == 1) a.four -= b.four;
    if (level.vectors == 2) a.half = half_less(a.half, b.half);
    if (level.vectors == 4) a.row = row_less(a.row, b.row);
    if (level.moments != NO_MOMENTS) a.moment = place_a * a.moment - place_b * b.moment;
    return a;
}

/* What was summed, in two vectors of four or in four. */
SM_INLINE HalfRow sum_half(Sum sum, Level level)
{
    vec4 moment = level.moments == DOWN ? -sum.moment : sum.moment;
    if (level.vectors == 1) return half_of(sum.four, moment);
    return level.moments == NO_MOMENTS ? sum.half : half_add_four(sum.half, level.to, moment);
}

SM_INLINE Row sum_row(Sum sum, Level level)
{
    Row row = level.vectors == 2 ? row_of_half(sum.half) : sum.row;
    vec4 moment = level.moments == DOWN ? -sum.moment : sum.moment;
    return level.moments == NO_MOMENTS ? row : row_add_four(row, level.to, moment);
}

/* Writes it, and its base, if any; what is large last: it is rounded once. */
SM_INLINE void sum_store(Sum sum, Level level, const real *base, real *out)
{
    if (level.made == 2) {
        HalfRow half = sum_half(sum, level);
        half_store(out, base ? half_add(half_load(base), half) : half);
    } else {
        Row row = sum_row(sum, level);
        row_store(out, base ? row_add(row_load(base), row) : row);
    }
}

/* Rows as narrow as what is made of them, in room for wide ones: row 0 is zero whatever their
 * width.
 */
SM_INLINE real *narrow(real *rows, int vectors)
{
    return rows + ROW_WIDTH - 4 * vectors;
}

/* The kinds of rows of a pass (sums.h), from the particles up (way 0) or down (1). */
SM_INLINE Level bar_level(const Rows *rows, int way, bool plain)
{
    Level level = {.in = rows->transform, .in_width = ROW_WIDTH, .vectors = 4, .made = 4};
    if (way == 0 && !plain)
        level = (Level){.in = rows->p, .in_width = ROW_P, .vectors = 1, .made = 2, .moments = UP};
    if (way && plain) level.vectors = level.made = 2;
    if (way && !plain) level.moments = DOWN;
    if (way && !plain) level.from = 3;
    level.out = narrow(rows->bar, level.made);
    return level;
}

/* `more`: with what rows made from it need. */
SM_INLINE Level plate_level(const Rows *rows, int way, bool plain, bool more)
{
    int made = bar_level(rows, way, plain).made;
    Level level = {.in = narrow(rows->bar, made), .in_width = 4 * made, .vectors = 2, .made = 2};
    if (way == 0) level.made = 4;
    if ((way == 0 && plain) || (way && !plain && more)) level.vectors = level.made = 4;
    level.out = narrow(rows->plate[way], level.made);
    if (plain) return level;
    level.moments = way ? DOWN : UP;
    *(way ? &level.from : &level.to) = 2;
    return level;
}

SM_INLINE Level region_level(const Rows *rows, int way, bool plain, bool more)
{
    int made = plate_level(rows, way, plain, more).made;
    Level level = {.in = narrow(rows->plate[way], made),
                   .in_width = 4 * made,
                   .vectors = way ? 2 : 4,
                   .made = way ? 2 : 4};
    level.out = narrow(rows->transform, level.made);
    if (plain) return level;
    level.moments = way ? DOWN : UP;
    level.from = way ? 1 : 0;
    level.to = way ? 0 : 3;
    return level;
}

SM_INLINE Sum member_at(Level level, uint64_t name)
{
    return member_of(level, named(level.in, name, level.in_width));
}

/* The `side` names of a list, two at a time: loads are what the sums wait for. */
SM_INLINE void read_names(const int *list, int side, uint64_t *name)
{
    const bool big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    if (side % 2 == 0) __builtin_unreachable(); /* it is 2 w + 1 */
    for (int i = 0; i + 1 < side; i += 2) {
        uint64_t two;
        memcpy(&two, list + i, sizeof two);
        name[i + big_endian] = two & UINT32_MAX;
        name[i + !big_endian] = two >> 32;
    }
    name[side - 1] = (uint64_t)list[side - 1];
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
