/* list_sums.c - sums through bars and plates (fastlsm section 3.1): O(w), any shape. */
#include <string.h>

#include "list_rows.h"
#include "lists.h"
#include "window.h"

/* The names in row `row` of a list, two at a time: loads are what the sums wait for. */
SM_INLINE void read_names(const int *list, long row, int side, uint64_t *name)
{
    const bool big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    if (side % 2 == 0) __builtin_unreachable(); /* it is 2 w + 1 */
    list += row * side;
    for (int i = 0; i + 1 < side; i += 2) {
        uint64_t two;
        memcpy(&two, list + i, sizeof two);
        name[i + big_endian] = two & UINT32_MAX;
        name[i + !big_endian] = two >> 32;
    }
    name[side - 1] = (uint64_t)list[side - 1];
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
        half_store(lsm->rows.bar + bar * ROW_BAR, half_of(sum, moment));
    }
}

SM_INLINE void plates_up(const Lsm *lsm, long first, long last, int side)
{
    const real *bar = lsm->rows.bar;
    for (long plate = first; plate < last; plate++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.plate, plate, side, name);
        const uint64_t *centre = name + side / 2;
        HalfRow sum = half_load(named(bar, *centre, ROW_BAR));
        vec4 moment = {0};
        for (int o = 1; o <= side / 2; o++) {
            HalfRow left = half_load(named(bar, centre[-o], ROW_BAR)),
                    right = half_load(named(bar, centre[o], ROW_BAR));
            sum = half_add(sum, half_add(left, right));
            moment = WINDOW_MOMENT(moment, o, half_first(right) - half_first(left));
        }
        real *out = lsm->rows.plate + plate * ROW_PLATE;
        half_store(out, sum);
        store4(out + 8, moment);
    }
}

/* The last four of a plate's row are never written: they stay zero. */
SM_INLINE Row region_up(const Lsm *lsm, int region, int side)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(lsm->lists.region, region, side, name);
    const uint64_t *centre = name + side / 2;
    const real *plate = lsm->rows.plate;
    Row sum = row_load(named(plate, *centre, ROW_PLATE));
    vec4 moment = {0};
    for (int o = 1; o <= side / 2; o++) {
        Row left = row_load(named(plate, centre[-o], ROW_PLATE)),
            right = row_load(named(plate, centre[o], ROW_PLATE));
        sum = row_add(sum, row_add(left, right));
        moment = WINDOW_MOMENT(moment, o, row_first(right) - row_first(left));
    }
    return row_add_four(sum, 1, moment);
}

/* A transform's row is (q, Rz, Ry, Rx): each pass uses the last four up, and subtracts their moment
 * from the first. What a pass leaves in the last four is not read again. */
SM_INLINE void bars_down(const Lsm *lsm, long first, long last, int side)
{
    for (long bar = first; bar < last; bar++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.bar, bar, side, name);
        const uint64_t *centre = name + side / 2;
        const real *T = lsm->rows.transform;
        Row sum = row_load(named(T, *centre, ROW_T));
        vec4 less = {0};
        for (int o = 1; o <= side / 2; o++) {
            const real *left = named(T, centre[-o], ROW_T), *right = named(T, centre[o], ROW_T);
            sum = row_add(sum, row_add(row_load(left), row_load(right)));
            less = WINDOW_MOMENT(less, o, load4(left + 12) - load4(right + 12));
        }
        row_store(lsm->rows.bar + bar * ROW_BAR, row_add_four(sum, 0, less));
    }
}

SM_INLINE void plates_down(const Lsm *lsm, long first, long last, int side)
{
    for (long plate = first; plate < last; plate++) {
        uint64_t name[LSM_MAX_SIDE];
        read_names(lsm->lists.plate, plate, side, name);
        const uint64_t *centre = name + side / 2;
        const real *bar = lsm->rows.bar;
        HalfRow sum = half_load(named(bar, *centre, ROW_BAR));
        vec4 less = {0};
        for (int o = 1; o <= side / 2; o++) {
            const real *left = named(bar, centre[-o], ROW_BAR),
                       *right = named(bar, centre[o], ROW_BAR);
            sum = half_add(sum, half_add(half_load(left), half_load(right)));
            less = WINDOW_MOMENT(less, o, load4(left + 8) - load4(right + 8));
        }
        half_store(lsm->rows.plate_down + plate * ROW_PLATE_DOWN, half_add_four(sum, 0, less));
    }
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

/* Sums without moments, of all values of a row or of the first eight. */
SM_INLINE Row plain_row(const int *list, long row, int side, const real *in)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(list, row, side, name);
    Row sum = row_load(named(in, name[0], 16));
    for (int i = 1; i < side; i++) sum = row_add(sum, row_load(named(in, name[i], 16)));
    return sum;
}

SM_INLINE HalfRow plain_half_row(const int *list, long row, int side, const real *in, int width)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(list, row, side, name);
    HalfRow sum = half_load(named(in, name[0], width));
    for (int i = 1; i < side; i++) sum = half_add(sum, half_load(named(in, name[i], width)));
    return sum;
}

SM_INLINE void plain_up(const int *list, long first, long last, int side, const real *in, real *out)
{
    for (long row = first; row < last; row++)
        row_store(out + row * 16, plain_row(list, row, side, in));
}

SM_INLINE void plain_down(const int *list, long first, long last, int side, const real *in,
                          int in_width, real *out, int out_width)
{
    for (long row = first; row < last; row++)
        half_store(out + row * out_width, plain_half_row(list, row, side, in, in_width));
}

SM_INLINE void subsums_up_of(const Lsm *lsm, int layer, bool plain, int side)
{
    const LsmLists *lists = &lsm->lists;
    const Rows *rows = &lsm->rows;
    int first = lsm->layer_plane[layer], last = lsm->layer_plane[layer + 1];
    long bar = lists->bar_plane[first], bars = lists->bar_end[last];
    long plate = lists->plate_plane[first], plates = lists->plate_end[last];
    if (plain) { /* the last four values stay zero, as region_up() wants to find them */
        plain_up(lists->bar, bar, bars, side, rows->transform, rows->bar);
        plain_up(lists->plate, plate, plates, side, rows->bar, rows->plate);
    } else {
        bars_up(lsm, bar, bars, side);
        plates_up(lsm, plate, plates, side);
    }
}

static void subsums_up(const Lsm *lsm, int layer, bool plain)
{
    FOR_SIDE(lsm->side, subsums_up_of, lsm, layer, plain);
}

SM_INLINE void subsums_down_of(const Lsm *lsm, int layer, bool plain, int side)
{
    const LsmLists *lists = &lsm->lists;
    const Rows *rows = &lsm->rows;
    int first = lsm->layer_plane[layer], last = lsm->layer_plane[layer + 1];
    long bar = lists->bar_plane[first], bars = lists->bar_end[last];
    long plate = lists->plate_plane[first], plates = lists->plate_end[last];
    if (plain) {
        plain_down(lists->bar, bar, bars, side, rows->transform, ROW_T, rows->bar, ROW_BAR);
        plain_down(lists->plate, plate, plates, side, rows->bar, ROW_BAR, rows->plate_down,
                   ROW_PLATE_DOWN);
    } else {
        bars_down(lsm, bar, bars, side);
        plates_down(lsm, plate, plates, side);
    }
}

static void subsums_down(const Lsm *lsm, int layer, bool plain)
{
    FOR_SIDE(lsm->side, subsums_down_of, lsm, layer, plain);
}

SM_INLINE void regions_of(const Lsm *lsm, const int *region, bool plain, Row *out, int side)
{
    for (int lane = 0; lane < SM_LANES; lane++)
        out[lane] = region[lane] < 0 ? (Row){0}
                    : plain ? plain_row(lsm->lists.region, region[lane], side, lsm->rows.plate)
                            : region_up(lsm, region[lane], side);
}

void lsm_list_kernels_regions(const Lsm *lsm, const int *region, bool plain, vec sum[12])
{
    Row rows[SM_LANES];
    const real *row[SM_LANES];
    if (plain)
        FOR_SIDE(lsm->side, regions_of, lsm, region, true, rows);
    else
        FOR_SIDE(lsm->side, regions_of, lsm, region, false, rows);
    for (int lane = 0; lane < SM_LANES; lane++) row[lane] = (const real *)&rows[lane];
    sums_of_rows(row, plain, sum);
}

static void tile_sums(const Lsm *lsm, long tile, bool plain, vec sum[12])
{
    int region[SM_LANES];
    tile_regions(lsm, tile, region);
    lsm_list_kernels_regions(lsm, region, plain, sum);
}

/* Scalars go where their lanes are: an insert into a vector would wait for the others. */
SM_INLINE void particles_of(const Lsm *lsm, const int *region, bool plain, real (*out)[SM_LANES],
                            int side)
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        if (plain) {
            real sum[8];
            half_store(sum, plain_half_row(lsm->lists.region, region[lane], side,
                                           lsm->rows.plate_down, ROW_PLATE_DOWN));
            for (int i = 0; i < 6; i++) out[i][lane] = sum[i / 3 * 4 + i % 3];
        } else {
            vec4 sum = particle_down(lsm, region[lane], side);
            for (int d = 0; d < 3; d++) out[d][lane] = sum[d];
        }
    }
}

static void block_sums(const Lsm *lsm, long block, bool plain, vec sum[6])
{
    const int *region = lsm->block_region + block * SM_LANES;
    real(*out)[SM_LANES] = (real(*)[SM_LANES])sum;
    if (plain)
        FOR_SIDE(lsm->side, particles_of, lsm, region, true, out);
    else
        FOR_SIDE(lsm->side, particles_of, lsm, region, false, out);
}

const LsmListKernels lsm_list_kernels = {
    .subsums_up = subsums_up, .subsums_down = subsums_down, .tile = tile_sums, .block = block_sums};

static bool applies(const Lsm *lsm)
{
    (void)lsm;
    return true;
}

const LsmSums lsm_sums_lists = {
    .name = "lists",
    .applies = applies,
    .lay_out = lsm_lists_lay_out,
    .phase = {lsm_lists_subsums, lsm_lists_solve, lsm_lists_end},
    .lists = &lsm_list_kernels,
    .layer_planes = 1,
    .plate_down = ROW_PLATE_DOWN,
};
