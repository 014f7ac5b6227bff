/* list_sums.c - sums through bars and plates (fastlsm section 3.1): O(w), any shape. */
#include "list_rows.h"
#include "lists.h"

/* What the members of a list, around its centre, sum to. */
SM_INLINE Sum list_sum(const int *list, Level level, int side)
{
    uint64_t name[LSM_MAX_SIDE];
    read_names(list, side, name);
    const uint64_t *centre = name + side / 2;
    Sum sum = member_at(level, *centre);
    sum.moment = (vec4){0};
    for (int o = 1; o <= side / 2; o++) {
        Sum left = member_at(level, centre[-o]), right = member_at(level, centre[o]),
            pair = sum_of(level, left, right);
        pair.moment = (real)o * (right.moment - left.moment);
        sum = sum_of(level, sum, pair);
    }
    return sum;
}

/* Rows `first` .. `last` - 1. */
SM_INLINE void list_sums(const int *list, long first, long last, int shift, Level level, int side)
{
    for (long row = first; row < last; row++)
        sum_store(list_sum(list + row * side, level, side), level, NULL,
                  level.out + (row + shift) * 4 * level.made);
}

/* Bars and plates of a layer. */
SM_INLINE void subsums_of(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain,
                          int side)
{
    const LsmLists *lists = &lsm->lists;
    int first = lsm->layer_plane[layer], last = lsm->layer_plane[layer + 1];
    list_sums(lists->bar, lists->bar_plane[first], lists->bar_end[last], lists->bar_shift[first],
              bar_level(rows, way, plain), side);
    list_sums(lists->plate, lists->plate_plane[first], lists->plate_end[last],
              lists->plate_shift[first], plate_level(rows, way, plain, false), side);
}

SM_INLINE void subsums_pass(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    FOR_SIDE(lsm->side, subsums_of, lsm, rows, layer, way, plain);
}

static void subsums(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    FOR_PASS(way, plain, subsums_pass, lsm, rows, layer);
}

SM_INLINE void regions_of(const Lsm *lsm, const Rows *rows, const int *region, bool plain, Row *out,
                          int side)
{
    Level level = region_level(rows, 0, plain, false);
    for (int lane = 0; lane < SM_LANES; lane++) {
        const int *list = lsm->lists.region + (long)region[lane] * side;
        out[lane] = region[lane] < 0 ? (Row){0} : sum_row(list_sum(list, level, side), level);
    }
}

void lsm_list_kernels_regions(const Lsm *lsm, const Rows *rows, const int *region, bool plain,
                              vec sum[12])
{
    Row made[SM_LANES];
    const real *row[SM_LANES];
    if (plain)
        FOR_SIDE(lsm->side, regions_of, lsm, rows, region, true, made);
    else
        FOR_SIDE(lsm->side, regions_of, lsm, rows, region, false, made);
    for (int lane = 0; lane < SM_LANES; lane++) row[lane] = (const real *)&made[lane];
    sums_of_rows(row, plain, sum);
}

static void tile_sums(const Lsm *lsm, const Rows *rows, long tile, bool plain, vec sum[12])
{
    int region[SM_LANES];
    tile_regions(lsm, tile, region);
    lsm_list_kernels_regions(lsm, rows, region, plain, sum);
}

/* Scalars go where their lanes are: an insert into a vector would wait for the others. */
SM_INLINE void particles_of(const Lsm *lsm, const Rows *rows, const int *region, bool plain,
                            real (*out)[SM_LANES], int side)
{
    Level level = region_level(rows, 1, plain, false);
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        real sum[8];
        half_store(
            sum,
            sum_half(list_sum(lsm->lists.region + (long)region[lane] * side, level, side), level));
        for (int i = 0; i < (plain ? 6 : 3); i++) out[i][lane] = sum[i / 3 * 4 + i % 3];
    }
}

static void block_sums(const Lsm *lsm, const Rows *rows, long block, bool plain, vec sum[6])
{
    const int *region = lsm->block_region + block * SM_LANES;
    real(*out)[SM_LANES] = (real(*)[SM_LANES])sum;
    if (plain)
        FOR_SIDE(lsm->side, particles_of, lsm, rows, region, true, out);
    else
        FOR_SIDE(lsm->side, particles_of, lsm, rows, region, false, out);
}

const LsmListKernels lsm_list_kernels = {
    .subsums = subsums, .tile = tile_sums, .block = block_sums};

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
};
