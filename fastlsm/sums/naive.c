/* naive.c - the sums of shape matching member by member, without reuse: O(w^3). Damping goes
 * through bars and plates. */
#include "list_rows.h"
#include "lists.h"

/* The particles of the bar of plane z that `plate` names at place i. */
SM_INLINE const int *members(const LsmLists *lists, int z, int plate, int i)
{
    const int *row = lists->plate + (long)lsm_named(lists->plate_shift, z, plate) * lists->side;
    return lists->bar + (long)lsm_named(lists->bar_shift, z, row[i]) * lists->side;
}

/* Bars and plates are summed on their own first, so that single precision adds numbers of like
 * size: wide regions have thousands of members. */
static Row region_up(const Lsm *lsm, const Rows *rows, int region)
{
    int side = lsm->side, w = lsm->w, z = lsm->lattice.coord[region][2];
    const int *plate = lsm->lists.region + (long)region * side;
    vec4 four[4] = {{0}, {0}, {0}, {0}};
    for (int c = -w; c <= w; c++) {
        vec4 flat[4] = {{0}, {0}, {0}, {0}};
        for (int b = -w; b <= w; b++) {
            const int *particle = members(&lsm->lists, z + c, plate[c + w], b + w);
            vec4 sum[4] = {{0}, {0}, {0}, {0}};
            for (int a = -w; a <= w; a++) {
                vec4 p = load4(named(rows->p, (uint64_t)particle[a + w], ROW_P));
                sum[0] += p;
                sum[1] += (real)a * p;
                sum[2] += (real)b * p;
                sum[3] += (real)c * p;
            }
            for (int i = 0; i < 4; i++) flat[i] += sum[i];
        }
        for (int i = 0; i < 4; i++) four[i] += flat[i];
    }
    real row[16];
    for (int i = 0; i < 4; i++) store4(row + 4 * i, four[i]);
    return row_load(row);
}

static vec4 particle_down(const Lsm *lsm, const Rows *rows, int region)
{
    int side = lsm->side, w = lsm->w, z = lsm->lattice.coord[region][2];
    const int *plate = lsm->lists.region + (long)region * side;
    vec4 sum = {0};
    for (int c = -w; c <= w; c++) {
        vec4 flat = {0};
        for (int b = -w; b <= w; b++) {
            const int *particle = members(&lsm->lists, z + c, plate[c + w], b + w);
            vec4 row = {0};
            for (int a = -w; a <= w; a++) {
                const real *T = named(rows->transform, (uint64_t)particle[a + w], ROW_WIDTH);
                row += load4(T) - (real)a * load4(T + 12) - (real)b * load4(T + 8) -
                       (real)c * load4(T + 4);
            }
            flat += row;
        }
        sum += flat;
    }
    return sum;
}

static bool applies(const Lsm *lsm)
{
    return lsm->params.summation == SM_SUM_NAIVE;
}

static void subsums(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    if (plain) lsm_list_kernels.subsums(lsm, rows, layer, way, plain);
}

static void tile_sums(const Lsm *lsm, const Rows *rows, long tile, bool plain, vec sum[12])
{
    if (plain) {
        lsm_list_kernels.tile(lsm, rows, tile, plain, sum);
        return;
    }
    Row made[SM_LANES];
    const real *row[SM_LANES];
    int region[SM_LANES];
    tile_regions(lsm, tile, region);
    for (int lane = 0; lane < SM_LANES; lane++) {
        made[lane] = region[lane] < 0 ? (Row){0} : region_up(lsm, rows, region[lane]);
        row[lane] = (const real *)&made[lane];
    }
    sums_of_rows(row, false, sum);
}

static void block_sums(const Lsm *lsm, const Rows *rows, long block, bool plain, vec sum[6])
{
    if (plain) {
        lsm_list_kernels.block(lsm, rows, block, plain, sum);
        return;
    }
    const int *region = lsm->block_region + block * SM_LANES;
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        vec4 goal = particle_down(lsm, rows, region[lane]);
        for (int d = 0; d < 3; d++) sum[d][lane] = goal[d];
    }
}

static const LsmListKernels kernels = {.subsums = subsums, .tile = tile_sums, .block = block_sums};

const LsmSums lsm_sums_naive = {
    .name = "naive",
    .applies = applies,
    .lay_out = lsm_lists_lay_out,
    .phase = {lsm_lists_subsums, lsm_lists_solve, lsm_lists_end},
    .lists = &kernels,
    .whole = true,
    .layer_planes = 1,
};
