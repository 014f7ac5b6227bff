#include "list_sums.h"

#include <string.h>

#include "window.h"

/* Each kernel is one body in which `side` is a constant for the usual widths. */
#define FOR_SIDE(side, call)                                                                       \
    switch (side) {                                                                                \
    case 3:                                                                                        \
        call(3);                                                                                   \
        break;                                                                                     \
    case 5:                                                                                        \
        call(5);                                                                                   \
        break;                                                                                     \
    case 7:                                                                                        \
        call(7);                                                                                   \
        break;                                                                                     \
    default:                                                                                       \
        call(side);                                                                                \
        break;                                                                                     \
    }

/* `v` in the first or last four lanes of sixteen, zero elsewhere; the compiler would go through
 * memory, and stall there. */
SM_INLINE vec16 widen_first(vec4 v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec16)_mm512_zextps128_ps512((__m128)v);
#else
    return __builtin_shufflevector(v, (vec4){0}, 0, 1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4);
#endif
}

SM_INLINE vec16 widen_last(vec4 v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec16)_mm512_maskz_broadcast_f32x4(0xf000, (__m128)v);
#else
    return __builtin_shufflevector(v, (vec4){0}, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 0, 1, 2, 3);
#endif
}

#define FIRST_FOUR(v) __builtin_shufflevector(v, v, 0, 1, 2, 3)

/* The names in row `row` of a list, two at a time: loads are what the sums wait for. */
SM_INLINE void read_names(const int *list, long row, int side, uint64_t *name)
{
    const bool big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    list += row * side;
    for (int i = 0; i + 1 < side; i += 2) {
        uint64_t two;
        memcpy(&two, list + i, sizeof two);
        name[i + big_endian] = two & UINT32_MAX;
        name[i + !big_endian] = two >> 32;
    }
    name[side - 1] = (uint64_t)list[side - 1];
}

/* The row of this name among `rows`, which are `width` values wide. */
SM_INLINE const real *named(const real *rows, uint64_t name, int width)
{
    return (const real *)((const char *)rows + name * ((size_t)width * sizeof(real) / LSM_NAME));
}

SM_INLINE void bars_up(const Lsm *lsm, long first, long last, int side)
{
    const real *p = lsm->rows.p;
    for (long bar = first; bar < last; bar++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.bar, bar, side, name);
        const uint64_t *centre = name + side / 2;
        vec4 sum = load4(named(p, *centre, ROW_P)), moment = {0};
        for (int o = 1; o <= side / 2; o++) {
            vec4 left = load4(named(p, centre[-o], ROW_P)),
                 right = load4(named(p, centre[o], ROW_P));
            sum += left + right;
            moment = WINDOW_MOMENT(moment, o, right - left);
        }
        real *out = lsm->rows.bar + bar * ROW_BAR;
        store8(out, __builtin_shufflevector(sum, moment, 0, 1, 2, 3, 4, 5, 6, 7));
    }
}

void lsm_bars_up(const Lsm *lsm, int first, int last){
#define CALL(side) bars_up(lsm, lsm->lists.bar_plane[first], lsm->lists.bar_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void plates_up(const Lsm *lsm, long first, long last, int side)
{
    const real *bar = lsm->rows.bar;
    for (long plate = first; plate < last; plate++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.plate, plate, side, name);
        const uint64_t *centre = name + side / 2;
        vec8 sum = load8(named(bar, *centre, ROW_BAR));
        vec4 moment = {0};
        for (int o = 1; o <= side / 2; o++) {
            vec8 left = load8(named(bar, centre[-o], ROW_BAR)),
                 right = load8(named(bar, centre[o], ROW_BAR));
            sum += left + right;
            moment = WINDOW_MOMENT(moment, o, FIRST_FOUR(right) - FIRST_FOUR(left));
        }
        real *out = lsm->rows.plate + plate * ROW_PLATE;
        store8(out, sum);
        store4(out + 8, moment);
    }
}

void lsm_plates_up(const Lsm *lsm, int first, int last){
#define CALL(side) plates_up(lsm, lsm->lists.plate_plane[first], lsm->lists.plate_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* The last four of a plate's row are never written: they stay zero. */
SM_INLINE vec16 region_up(const Lsm *lsm, int region, int side)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(lsm->lists.region, region, side, name);
    const uint64_t *centre = name + side / 2;
    const real *plate = lsm->rows.plate;
    vec16 sum = load16(named(plate, *centre, ROW_PLATE));
    vec4 moment = {0};
    for (int o = 1; o <= side / 2; o++) {
        vec16 left = load16(named(plate, centre[-o], ROW_PLATE)),
              right = load16(named(plate, centre[o], ROW_PLATE));
        sum += left + right;
        moment = WINDOW_MOMENT(moment, o, FIRST_FOUR(right) - FIRST_FOUR(left));
    }
    return sum + widen_last(moment);
}

/* The list of the row of this name. */
SM_INLINE const int *members(const int *list, int name, int side)
{
    return list + (long)(name / LSM_NAME) * side;
}

/* Without reuse, member by member: the O(w^3) form. Rows are summed on their own first, so that
 * single precision adds numbers of like size. */
static vec16 region_up_naive(const Lsm *lsm, int region)
{
    int side = lsm->side, w = lsm->w;
    const int *plate = lsm->lists.region + (long)region * side;
    vec4 C = {0}, X = {0}, Y = {0}, Z = {0};
    for (int c = -w; c <= w; c++)
        for (int b = -w; b <= w; b++) {
            const int *bar = members(lsm->lists.plate, plate[c + w], side),
                      *particle = members(lsm->lists.bar, bar[b + w], side);
            vec4 sum[4] = {{0}, {0}, {0}, {0}};
            for (int a = -w; a <= w; a++) {
                vec4 p = load4(named(lsm->rows.p, (uint64_t)particle[a + w], ROW_P));
                sum[0] += p;
                sum[1] += (real)a * p;
                sum[2] += (real)b * p;
                sum[3] += (real)c * p;
            }
            C += sum[0];
            X += sum[1];
            Y += sum[2];
            Z += sum[3];
        }
    vec8 low = __builtin_shufflevector(C, X, 0, 1, 2, 3, 4, 5, 6, 7);
    vec8 high = __builtin_shufflevector(Y, Z, 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

SM_INLINE void regions_up(const Lsm *lsm, const int *region, vec16 *out, int side)
{
    for (int lane = 0; lane < SM_LANES; lane++)
        out[lane] = region[lane] < 0 ? (vec16){0} : region_up(lsm, region[lane], side);
}

void lsm_regions_up(const Lsm *lsm, const int *region, vec16 *out)
{
    if (lsm->params.summation == SM_SUM_NAIVE) {
        for (int lane = 0; lane < SM_LANES; lane++)
            out[lane] = region[lane] < 0 ? (vec16){0} : region_up_naive(lsm, region[lane]);
        return;
    }
#define CALL(side) regions_up(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* A transform's row is (q, Rz, Ry, Rx): each pass uses the last vector up. What a pass leaves in
 * the last vector is not read again. */
SM_INLINE void bars_down(const Lsm *lsm, long first, long last, int side)
{
    for (long bar = first; bar < last; bar++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.bar, bar, side, name);
        const uint64_t *centre = name + side / 2;
        const real *T = lsm->rows.transform;
        vec16 sum = load16(named(T, *centre, ROW_T));
        vec4 moment = {0};
        for (int o = 1; o <= side / 2; o++) {
            const real *left = named(T, centre[-o], ROW_T), *right = named(T, centre[o], ROW_T);
            sum += load16(left) + load16(right);
            moment = WINDOW_MOMENT(moment, o, load4(right + 12) - load4(left + 12));
        }
        store16(lsm->rows.bar + bar * ROW_BAR, sum - widen_first(moment));
    }
}

void lsm_bars_down(const Lsm *lsm, int first, int last){
#define CALL(side) bars_down(lsm, lsm->lists.bar_plane[first], lsm->lists.bar_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void plates_down(const Lsm *lsm, long first, long last, int side)
{
    for (long plate = first; plate < last; plate++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.plate, plate, side, name);
        const uint64_t *centre = name + side / 2;
        const real *bar = lsm->rows.bar;
        vec8 sum = load8(named(bar, *centre, ROW_BAR));
        vec4 moment = {0};
        for (int o = 1; o <= side / 2; o++) {
            const real *left = named(bar, centre[-o], ROW_BAR),
                       *right = named(bar, centre[o], ROW_BAR);
            sum += load8(left) + load8(right);
            moment = WINDOW_MOMENT(moment, o, load4(right + 8) - load4(left + 8));
        }
        store8(lsm->rows.plate_down + plate * ROW_PLATE_DOWN,
               sum - __builtin_shufflevector(moment, (vec4){0}, 0, 1, 2, 3, 4, 4, 4, 4));
    }
}

void lsm_plates_down(const Lsm *lsm, int first, int last){
#define CALL(side) plates_down(lsm, lsm->lists.plate_plane[first], lsm->lists.plate_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE vec4 particle_down(const Lsm *lsm, int region, int side)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(lsm->lists.region, region, side, name);
    const uint64_t *centre = name + side / 2;
    const real *plate = lsm->rows.plate_down;
    vec4 sum = load4(named(plate, *centre, ROW_PLATE_DOWN));
    for (int o = 1; o <= side / 2; o++) {
        const real *left = named(plate, centre[-o], ROW_PLATE_DOWN),
                   *right = named(plate, centre[o], ROW_PLATE_DOWN);
        sum += load4(left) + load4(right);
        sum -= (real)o * (load4(right + 4) - load4(left + 4));
    }
    return sum;
}

static vec4 particle_down_naive(const Lsm *lsm, int region)
{
    int side = lsm->side, w = lsm->w;
    const int *plate = lsm->lists.region + (long)region * side;
    vec4 sum = {0};
    for (int c = -w; c <= w; c++)
        for (int b = -w; b <= w; b++) {
            const int *bar = members(lsm->lists.plate, plate[c + w], side),
                      *particle = members(lsm->lists.bar, bar[b + w], side);
            vec4 row = {0};
            for (int a = -w; a <= w; a++) {
                const real *T = named(lsm->rows.transform, (uint64_t)particle[a + w], ROW_T);
                row += load4(T) - (real)a * load4(T + 12) - (real)b * load4(T + 8) -
                       (real)c * load4(T + 4);
            }
            sum += row;
        }
    return sum;
}

SM_INLINE void particles_down(const Lsm *lsm, const int *region, real out[3][SM_LANES], int side)
{
    bool naive = lsm->params.summation == SM_SUM_NAIVE;
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        vec4 sum =
            naive ? particle_down_naive(lsm, region[lane]) : particle_down(lsm, region[lane], side);
        for (int d = 0; d < 3; d++) out[d][lane] = sum[d];
    }
}

void lsm_particles_down(const Lsm *lsm, const int *region, real out[3][SM_LANES]){
#define CALL(side) particles_down(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* Sums without moments, of all values of a row or of the first eight. */
SM_INLINE vec16 plain_row(const int *list, long row, int side, const real *in)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(list, row, side, name);
    vec16 sum = load16(named(in, name[0], 16));
    for (int i = 1; i < side; i++) sum += load16(named(in, name[i], 16));
    return sum;
}

SM_INLINE vec8 plain_half_row(const int *list, long row, int side, const real *in, int width)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(list, row, side, name);
    vec8 sum = load8(named(in, name[0], width));
    for (int i = 1; i < side; i++) sum += load8(named(in, name[i], width));
    return sum;
}

SM_INLINE void plain_up(const int *list, long first, long last, int side, const real *in, real *out)
{
    for (long row = first; row < last; row++)
        store16(out + row * 16, plain_row(list, row, side, in));
}

SM_INLINE void plain_down(const int *list, long first, long last, int side, const real *in,
                          int in_width, real *out, int out_width)
{
    for (long row = first; row < last; row++)
        store8(out + row * out_width, plain_half_row(list, row, side, in, in_width));
}

void lsm_bars_plain(const Lsm *lsm, int first, int last, bool up)
{
    const Rows *rows = &lsm->rows;
    const int *list = lsm->lists.bar;
    long from = lsm->lists.bar_plane[first], to = lsm->lists.bar_end[last];
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain_up(list, from, to, side, rows->transform, rows->bar);                                \
    else                                                                                           \
        plain_down(list, from, to, side, rows->transform, ROW_T, rows->bar, ROW_BAR)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* The last four values stay zero on the way up, as region_up() wants to find them. */
void lsm_plates_plain(const Lsm *lsm, int first, int last, bool up)
{
    const Rows *rows = &lsm->rows;
    const int *list = lsm->lists.plate;
    long from = lsm->lists.plate_plane[first], to = lsm->lists.plate_end[last];
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain_up(list, from, to, side, rows->bar, rows->plate);                                    \
    else                                                                                           \
        plain_down(list, from, to, side, rows->bar, ROW_BAR, rows->plate_down, ROW_PLATE_DOWN)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void regions_plain(const Lsm *lsm, const int *region, vec16 *out, int side)
{
    for (int lane = 0; lane < SM_LANES; lane++)
        out[lane] = region[lane] < 0
                        ? (vec16){0}
                        : plain_row(lsm->lists.region, region[lane], side, lsm->rows.plate);
}

void lsm_regions_plain(const Lsm *lsm, const int *region, vec16 *out){
#define CALL(side) regions_plain(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void particles_plain(const Lsm *lsm, const int *region, real out[6][SM_LANES], int side)
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        vec8 sum = plain_half_row(lsm->lists.region, region[lane], side, lsm->rows.plate_down,
                                  ROW_PLATE_DOWN);
        for (int i = 0; i < 6; i++) out[i][lane] = sum[i / 3 * 4 + i % 3];
    }
}

void lsm_particles_plain(const Lsm *lsm, const int *region, real out[6][SM_LANES])
{
#define CALL(side) particles_plain(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}
