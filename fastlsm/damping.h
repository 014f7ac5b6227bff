/* damping.h - region damping (fastlsm eq. 14): each region's rigid velocity, averaged over the
 * regions of a particle, pulls the particle's velocity towards it. */
#ifndef LSM_DAMPING_H
#define LSM_DAMPING_H

#include "../lib/simd/rigid_lanes.h"
#include "match.h"

/* (omega, v_r - omega x c_r) of `tiles` tiles. */
SM_INLINE void damp_tiles(const Lsm *lsm, long tile, int tiles, vec (*sum)[12], real *down)
{
    for (int t = 0; t < tiles; t++, tile++, down += TILE_DOWN) {
        vec c[3], out[6];
        load3(lsm->centre + tile * 3 * SM_LANES, c);
        rigid_velocity(sum[t], c, lsm->region_const[lsm->tile_const[tile]].inverse_mass, out);
        for (int i = 0; i < 6; i++)
            lanes_store(down + i * SM_LANES, lanes_keep(lsm->live[tile], out[i]));
    }
}

/* v += k (u - v), x += v. */
SM_INLINE void damp_blocks(Lsm *lsm, long block, int blocks, vec (*sum)[6])
{
    for (int i = 0; i < blocks; i++, block++) {
        const ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
        vec x[3], v[3];
        load3(lsm->x + block * 3 * SM_LANES, x);
        load3(lsm->v + block * 3 * SM_LANES, v);
        pull(sum[i], k->inverse_count, (real)lsm->params.damping, x, v);
        integrate_position(&lsm->obstacles, shift_of(lsm, block), block, x, v);
        store3(lsm->v + block * 3 * SM_LANES, v);
        store3(lsm->x + block * 3 * SM_LANES, x);
    }
}

#endif
