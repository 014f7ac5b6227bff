/* damping.c - region damping (fastlsm eq. 14): each region's rigid velocity, averaged over the
 * regions of a particle, pulls the particle's velocity towards it. */
#include "match.h"
#include "pipeline.h"
#include "step.h"
#include "sums/blocks_down.h"
#include "sums/box_sum_fixups.h"
#include "sums/list_sums.h"
#include "sums/running_sums.h"

static void weigh(Lsm *lsm, int layer)
{
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        if (lsm->box && (lsm->fixups || !lsm->box->listed[block])) continue;
        vec part[4], field[16] = {{0}};
        real *row[SM_LANES];
        for (int d = 0; d < 3; d++) {
            damping_products(lsm->particle_const[lsm->block_const[block]].weight,
                             lsm->x + block * 3 * SM_LANES, lsm->v + block * 3 * SM_LANES, d, part);
            for (int k = 0; k < 4; k++) field[3 * k + d] = part[k];
        }
        for (int lane = 0; lane < SM_LANES; lane++)
            row[lane] = lsm->rows.transform + (block * SM_LANES + lane + 1) * ROW_T;
        lanes_to_rows(field, row);
    }
}

static void sums_up(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    (void)thread;
    weigh(lsm, layer);
    if (lsm->running_lists) {
        lsm_running_sets_up(lsm, layer, true);
    } else {
        lsm_bars_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], true);
        lsm_plates_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], true);
    }
    sm_lap(laps, SM_DAMPING);
}

/* Rows of a tile's rigid velocities, for the lists. */
static void store_velocities(const Lsm *lsm, long tile, const vec out[6])
{
    vec field[8] = {out[0], out[1], out[2], lanes_set(0), out[3], out[4], out[5], lanes_set(0)};
    lanes_interleave(field, 8);
    const real *row = (const real *)field;
    for (int lane = 0; lane < SM_LANES; lane++) {
        int slot = lsm->tile_slot[tile * SM_LANES + lane];
        if (slot >= 0)
            store8(lsm->rows.transform + (slot + 1) * (long)ROW_T, load8(row + lane * 8));
    }
}

/* The list sums of SM_LANES regions, in lanes. */
static void region_sums(const Lsm *lsm, const int *region, vec field[16])
{
    vec16 sums[SM_LANES];
    const real *row[SM_LANES];
    lsm_regions_plain(lsm, region, sums);
    for (int lane = 0; lane < SM_LANES; lane++) row[lane] = (const real *)&sums[lane];
    lanes_from_rows(row, field);
}

static void solve_tile(Lsm *lsm, long tile)
{
    vec field[16], c[3], out[6];
    if (lsm->running_lists) {
        const real *row[SM_LANES];
        tile_rows(lsm, tile, row);
        lanes_from_rows(row, field);
    } else {
        int region[SM_LANES];
        tile_regions(lsm, tile, region);
        region_sums(lsm, region, field);
    }
    load3(lsm->centre + tile * 3 * SM_LANES, c);
    rigid_velocity(field, c, lsm->region_const[lsm->tile_const[tile]].inverse_mass, out);
    store_velocities(lsm, tile, out);
}

/* Where lists or fix-ups make a block's sums exact. */
static __attribute__((noinline)) void mend_sums(const Lsm *lsm, long block, vec *F)
{
    if (lsm->fixups) {
        lsm_fixup_products(lsm, block, F);
        return;
    }
    const int *region = lsm->block_region + block * SM_LANES;
    vec listed[16];
    region_sums(lsm, region, listed);
    ivec lanes = listed_lanes(region);
    for (int i = 0; i < 12; i++) F[i] = lanes_select(lanes, listed[i], F[i]);
}

/* Where lists or fix-ups read a block's rigid velocities. */
static __attribute__((noinline)) void keep_velocities(const Lsm *lsm, long block, const real *from)
{
    vec out[6];
    for (int i = 0; i < 6; i++) out[i] = lanes_load(from + i * SM_LANES);
    if (lsm->fixups)
        keep_solved(lsm, block, 6, out);
    else
        store_velocities(lsm, block, out);
}

SM_INLINE void solve_blocks(Lsm *lsm, int layer, long block, int blocks, vec (*F)[12], real *to,
                            SmLaps *laps)
{
    (void)layer, (void)laps;
    for (int k = 0; k < blocks; k++, block++, to += BLOCK) {
        vec c[3], out[6];
        if (lsm->box->mixed[block]) mend_sums(lsm, block, F[k]);
        load3(lsm->centre + block * 3 * SM_LANES, c);
        rigid_velocity(F[k], c, lsm->region_const[lsm->tile_const[block]].inverse_mass, out);
        for (int i = 0; i < 6; i++)
            lanes_store(to + i * SM_LANES, lanes_keep(lsm->box->site[block], out[i]));
        if (lsm->box->listed[block]) keep_velocities(lsm, block, to);
    }
}

PLANE_PASSES(true, solve_blocks)

static void solve(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    if (lsm->running_lists) lsm_running_regions_up(lsm, layer, true);
    if (lsm->box)
        lsm_blocks_up(lsm, layer, thread, laps);
    else
        for (long tile = lsm->layer_tile[layer]; tile < lsm->layer_tile[layer + 1]; tile++)
            solve_tile(lsm, tile);
    for (long i = lsm->layer_copy[layer]; i < lsm->layer_copy[layer + 1]; i++)
        store8(lsm->rows.transform + (lsm->copy[i][0] + 1) * (long)ROW_T,
               load8(lsm->rows.transform + (lsm->copy[i][1] + 1) * (long)ROW_T));
    if (lsm->running_lists) {
        lsm_running_sets_down(lsm, layer, true);
    } else {
        lsm_bars_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], false);
        lsm_plates_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], false);
    }
    sm_lap(laps, SM_DAMPING);
}

SM_INLINE void slow_down(Lsm *lsm, long block, const vec sum[6])
{
    const ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
    vec x[3], v[3];
    load3(lsm->x + block * 3 * SM_LANES, x);
    load3(lsm->v + block * 3 * SM_LANES, v);
    pull(sum, k->inverse_count, (real)lsm->params.damping, x, v);
    integrate_position(lsm->obstacle, lsm->obstacle_count, lsm->shift, x, v);
    store3(lsm->v + block * 3 * SM_LANES, v);
    store3(lsm->x + block * 3 * SM_LANES, x);
}

/* What lists or fix-ups add to a block's sums. */
static __attribute__((noinline)) void add_mended(const Lsm *lsm, long block, vec *sum)
{
    if (lsm->fixups) {
        lsm_fixup_velocities(lsm, block, sum);
        return;
    }
    real sums[6][SM_LANES] __attribute__((aligned(64)));
    for (int f = 0; f < 6; f++) lanes_store(sums[f], sum[f]);
    if (lsm->running_lists)
        slot_values(lsm, block, 6, sums);
    else
        lsm_particles_plain(lsm, lsm->block_region + block * SM_LANES, sums);
    for (int f = 0; f < 6; f++) sum[f] = lanes_load(sums[f]);
}

SM_INLINE void slow_block(Lsm *lsm, long block, vec sum[6], SmLaps *laps)
{
    (void)laps;
    if (!lsm->box || lsm->box->mixed[block]) on_copy(add_mended, lsm, block, 6, sum);
    slow_down(lsm, block, sum);
}

PLANE_DOWNS(true, slow_block)

static void slow(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    if (lsm->running_lists) lsm_running_particles(lsm, layer, true);
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1] && !lsm->box;
         block++) {
        vec sum[6] = {{0}};
        slow_block(lsm, block, sum, laps);
    }
    if (lsm->box) lsm_blocks_down(lsm, layer, thread, laps);
    sm_lap(laps, SM_DAMPING);
}

void lsm_damp(Lsm *lsm)
{
    static LsmPart *const parts[3] = {sums_up, solve, slow};
    lsm_pipeline(lsm, parts);
}
