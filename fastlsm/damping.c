/* damping.c - region damping (fastlsm eq. 14): each region's rigid velocity, averaged over the
 * regions of a particle, pulls the particle's velocity towards it. */
#include "blocks.h"
#include "match.h"
#include "pipeline.h"
#include "step.h"
#include "summation.h"

static void weigh(Lsm *lsm, int layer)
{
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        if (lsm->box && !lsm->box->listed[block]) continue;
        vec x[3], v[3], field[16] = {{0}};
        real *row[SM_LANES];
        load3(lsm->x + block * 3 * SM_LANES, x);
        load3(lsm->v + block * 3 * SM_LANES, v);
        damping_products(lsm->particle_const[lsm->block_const[block]].weight, x, v, field);
        for (int lane = 0; lane < SM_LANES; lane++)
            row[lane] = lsm->rows.transform + (block * SM_LANES + lane + 1) * ROW_T;
        lanes_to_rows(field, row);
    }
}

static void sums_up(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    (void)thread;
    weigh(lsm, layer);
    lsm_bars_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], true);
    lsm_plates_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], true);
    sm_lap(laps, SM_DAMPING);
}

/* omega = I^-1 L of a tile by the adjugate. I is the inertia tr(S) - S of the spread
 * S = sum m~ x x^T - M c c^T. A region on a line has no inertia about it: there (and where I is
 * below what its sums resolve) the inverse is damped towards zero, as a pseudo-inverse would. */
SM_INLINE void angular_velocity(const vec S[6], const vec L[3], vec size, vec omega[3])
{
    vec trace = S[0] + S[1] + S[2];
    vec floor = (real)1e-3 * trace + 64 * SM_EPSILON * size + (real)1e-30;
    vec xx = S[1] + S[2], yy = S[2] + S[0], zz = S[0] + S[1];
    /* twice the smallest inertia of a planar or solid spread is at least tr S: only lines are lifted */
    xx += lanes_max(floor - xx, lanes_set(0));
    yy += lanes_max(floor - yy, lanes_set(0));
    zz += lanes_max(floor - zz, lanes_set(0));
    vec yz = -S[3], zx = -S[4], xy = -S[5];
    vec Cxx = yy * zz - yz * yz, Cyy = zz * xx - zx * zx, Czz = xx * yy - xy * xy;
    vec Cxy = yz * zx - xy * zz, Cyz = zx * xy - yz * xx, Czx = xy * yz - zx * yy;
    vec determinant = xx * Cxx + xy * Cxy + zx * Czx;
    vec least = (real)1e-4 * xx * yy * zz;
    vec inverse = 1 / lanes_max(determinant, least);
    omega[0] = (Cxx * L[0] + Cxy * L[1] + Czx * L[2]) * inverse;
    omega[1] = (Cxy * L[0] + Cyy * L[1] + Cyz * L[2]) * inverse;
    omega[2] = (Czx * L[0] + Cyz * L[1] + Czz * L[2]) * inverse;
}

/* From a tile's sums to (omega, v_r - omega x c_r). */
SM_INLINE void rigid_velocity(const vec F[12], const vec c[3], vec inverse_mass, vec out[6])
{
    vec S[6], L[3], size = lanes_set(0);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        vec Mc_e = inverse_mass * F[e], Mc_f = inverse_mass * F[f]; /* v_r */
        L[d] = inverse_mass * F[3 + d] - (c[e] * Mc_f - c[f] * Mc_e);
        S[d] = inverse_mass * F[6 + d] - c[d] * c[d];
        S[3 + d] = inverse_mass * F[9 + d] - c[e] * c[f];
        size += c[d] * c[d];
    }
    angular_velocity(S, L, size, out);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        out[3 + d] = inverse_mass * F[d] - (out[e] * c[f] - out[f] * c[e]);
    }
}

/* Rows of a tile's rigid velocities, for the lists. */
static void store_velocities(Lsm *lsm, long tile, const vec out[6])
{
    real tile_rows[SM_LANES][16];
    real *row[SM_LANES];
    vec field[16];
    for (int lane = 0; lane < SM_LANES; lane++) row[lane] = tile_rows[lane];
    for (int i = 0; i < 16; i++)
        field[i] = i % 4 == 3 || i > 7 ? lanes_set(0) : out[i / 4 * 3 + i % 4];
    lanes_to_rows(field, row);
    for (int lane = 0; lane < SM_LANES; lane++) {
        int slot = lsm->tile_slot[tile * SM_LANES + lane];
        if (slot >= 0) store8(lsm->rows.p + (slot + 1) * (long)ROW_P, load8(tile_rows[lane]));
    }
}

static void solve_tile(Lsm *lsm, long tile)
{
    real sums[SM_LANES][16] = {{0}};
    const real *row[SM_LANES];
    vec field[16], c[3], out[6];
    for (int lane = 0; lane < SM_LANES; lane++) {
        int region = lsm->tile_region[tile * SM_LANES + lane];
        if (region >= 0) lsm_region_plain(lsm, region, true, sums[lane]);
        row[lane] = sums[lane];
    }
    lanes_from_rows(row, field);
    load3(lsm->centre + tile * 3 * SM_LANES, c);
    rigid_velocity(field, c, lsm->region_const[lsm->tile_const[tile]].inverse_mass, out);
    store_velocities(lsm, tile, out);
}

static void solve_block(Lsm *lsm, int layer, long block, const vec *sum, vec *out, SmLaps *laps)
{
    (void)layer, (void)laps;
    vec F[12], c[3];
    for (int i = 0; i < 12; i++) F[i] = sum[i];
    for (int lane = 0; lane < SM_LANES && lsm->box->mixed[block]; lane++) {
        int region = lsm->block_region[block * SM_LANES + lane];
        if (region < 0) continue;
        real row[16];
        lsm_region_plain(lsm, region, true, row);
        for (int i = 0; i < 12; i++) F[i][lane] = row[i];
    }
    load3(lsm->centre + block * 3 * SM_LANES, c);
    rigid_velocity(F, c, lsm->region_const[lsm->tile_const[block]].inverse_mass, out);
    for (int i = 0; i < 6; i++) out[i] = lanes_and(out[i], lsm->box->site[block]);
    if (lsm->box->listed[block]) store_velocities(lsm, block, out);
}

static void solve(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    if (lsm->box) lsm_blocks_up(lsm, layer, thread, true, solve_block, laps);
    else
        for (long tile = lsm->layer_tile[layer]; tile < lsm->layer_tile[layer + 1]; tile++)
            solve_tile(lsm, tile);
    for (long i = lsm->layer_copy[layer]; i < lsm->layer_copy[layer + 1]; i++)
        store8(lsm->rows.p + (lsm->copy[i][0] + 1) * (long)ROW_P,
               load8(lsm->rows.p + (lsm->copy[i][1] + 1) * (long)ROW_P));
    lsm_bars_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], false);
    lsm_plates_plain(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1], false);
    sm_lap(laps, SM_DAMPING);
}

/* v += k (u - v) with u = (1/|R_i|) sum of omega x x_i + (v_r - omega x c_r); x += v. */
SM_INLINE void slow_down(Lsm *lsm, long block, const vec sum[6])
{
    const ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
    vec x[3], v[3], u[3];
    load3(lsm->x + block * 3 * SM_LANES, x);
    load3(lsm->v + block * 3 * SM_LANES, v);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        u[d] = k->inverse_count * (sum[e] * x[f] - sum[f] * x[e] + sum[3 + d]);
    }
    for (int d = 0; d < 3; d++) {
        v[d] += (real)lsm->params.damping * (u[d] - v[d]);
        x[d] += v[d];
    }
    store3(lsm->v + block * 3 * SM_LANES, v);
    store3(lsm->x + block * 3 * SM_LANES, x);
}

static void slow(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    (void)thread;
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        vec sum[6] = {{0}};
        if (lsm->box) lsm_blocks_down(lsm, layer, block, true, sum);
        for (int lane = 0; lane < SM_LANES && (!lsm->box || lsm->box->mixed[block]); lane++) {
            int region = lsm->block_region[block * SM_LANES + lane];
            if (region < 0) continue;
            real row[16];
            lsm_region_plain(lsm, region, false, row);
            for (int i = 0; i < 6; i++) sum[i][lane] = row[i / 3 * 4 + i % 3];
        }
        slow_down(lsm, block, sum);
    }
    sm_lap(laps, SM_DAMPING);
}

void lsm_damp(Lsm *lsm)
{
    static LsmPart *const parts[3] = {sums_up, solve, slow};
    lsm_pipeline(lsm, parts);
}
