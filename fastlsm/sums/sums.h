/* sums.h - what every form of the fast summation offers (fastlsm section 3.1).
 *
 * A pass sums values of particles up to regions, solves something for each region, and sums what
 * comes of it down to particles again: shape matching (match.h) and damping (damping.h) are
 * passes. A form is a way to sum; every form runs every pass, in the three phases of pipeline.h.
 *
 *     naive.c          member by member, O(w^3)
 *     list_sums.c      through bars and plates, O(w), for any shape
 *     running_sums.c   bars, plates and regions made from their neighbours', O(1), for any shape
 *     boxes.c          windows over all sites of a box, O(1) but for whole blocks along x, for
 *                      solids; regions that are no boxes are summed through their lists
 *     instances.c      through bars and plates of SM_LANES bodies at once that share a lattice
 *
 * Shape matching sums p = m~ x and its moments about the region's own centre, in place of x x0^T
 * against a global origin. With lattice offsets (a, b, c) from the centre
 *     bar    B = sum p,   Bx = sum a p
 *     plate  P = sum B,   Px = sum Bx,  Py = sum b B
 *     region C = sum P,   Cx = sum Px,  Cy = sum Py,  Cz = sum c P.
 * The adjoint brings region transforms down to particles: with T = (q, Rx, Ry, Rz)
 *     |R_i| g_i = sum_r q_r + R_r (x0_i - x0_r) = sum q - a Rx - b Ry - c Rz,
 * where (a, b, c) is r's offset from i. Damping's sums are plain, without moments. All sums run
 * over fixed places in a fixed order. */
#ifndef LSM_SUMS_H
#define LSM_SUMS_H

#include "../damping.h"
#include "../match.h"
#include "../pipeline.h"

#define lsm_sums_naive     SM_NAME(lsm_sums_naive)
#define lsm_sums_lists     SM_NAME(lsm_sums_lists)
#define lsm_sums_running   SM_NAME(lsm_sums_running)
#define lsm_sums_boxes     SM_NAME(lsm_sums_boxes)
#define lsm_sums_instances SM_NAME(lsm_sums_instances)

struct LsmPass {
    bool plain;    /* sums damping's twelve products and brings six values down, without moments */
    SmStage stage; /* whose time the sums are */

    /* What comes of the sums of `tiles` tiles of regions from number `tile` on, POLAR_TILES at
     * most: `sum` are (C, A) of match.h, or damping's four triples; `down` receives, TILE_DOWN
     * values a tile, (q, Rz, Rx, Ry), or damping's two triples, all zero in lanes without a region.
     * NULL: what match.h or damping.h does with them. */
    void (*solve)(Lsm *lsm, int layer, long tile, int tiles, vec (*sum)[12], real *down,
                  SmLaps *laps);

    /* What is done with the sums over the regions of the particles of `blocks` blocks: three of
     * them, |R_i| g_i, or damping's six. NULL as above. */
    void (*end)(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps);
};

/* Sums over lists. */
typedef struct {
    /* Bars and plates of a layer, from the particles up (way 0) or from the regions down (1). */
    void (*subsums)(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain);

    /* The last stage, of a layer's regions (way 0) or particles (1), or NULL where it is done tile
     * by tile and block by block. */
    void (*last)(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain);

    /* The sums (LsmPass) of a tile, and over a block's particles that have lists. */
    void (*tile)(const Lsm *lsm, const Rows *rows, long tile, bool plain, vec sum[12]);
    void (*block)(const Lsm *lsm, const Rows *rows, long block, bool plain, vec sum[6]);
} LsmListKernels;

struct LsmSums {
    const char *name;
    bool (*applies)(const Lsm *lsm); /* to a body whose lattice and parameters are known */
    void (*lay_out)(Lsm *lsm);       /* blocks and layers */
    void (*share)(Lsm *lsm);         /* memory for lsm->threads threads, or NULL */
    void (*open)(Lsm *lsm);          /* what is made of lists and constants, or NULL */
    LsmPhase *phase[3];              /* of a pass: pipeline.h */
    const LsmListKernels *lists;     /* of the regions that have lists */
    bool by_plane;                   /* bars are kept of one plane at a time, not of a layer */
    bool whole;                      /* p and transforms are kept of all layers, not of one */
    int layer_planes;                /* least planes of a layer */
};

extern const LsmSums lsm_sums_naive, lsm_sums_lists, lsm_sums_running, lsm_sums_boxes,
    lsm_sums_instances;

/* A pass over the body. Instrumented by `laps` unless that is NULL. */
SM_INLINE void lsm_run(Lsm *lsm, const LsmPass *pass, SmLaps *laps)
{
    lsm->laps = laps;
    lsm->pass = pass;
    lsm_pipeline(lsm, lsm->sums->phase);
}

/* `sum` is copied for functions, so that it may stay in registers for what is compiled in. */
SM_INLINE void lsm_solve(Lsm *lsm, bool plain, int layer, long tile, int tiles, vec (*sum)[12],
                         real *down, SmLaps *laps)
{
    if (lsm->pass->solve) {
        vec copy[POLAR_TILES][12];
        for (int t = 0; t < tiles; t++) lanes_copy(12, sum[t], copy[t]);
        lsm->pass->solve(lsm, layer, tile, tiles, copy, down, laps);
    } else if (plain) {
        damp_tiles(lsm, tile, tiles, sum, down);
    } else {
        match_tiles(lsm, layer, tile, tiles, sum, down, laps);
    }
}

/* What lsm_solve() has brought down, or copies of it, are in their place. Damping's time is not
 * told apart from its sums'. */
SM_INLINE void lsm_solved(bool plain, SmLaps *laps)
{
    if (!plain) sm_lap(laps, SM_SHAPE_MATCHING);
}

SM_INLINE void lsm_end(Lsm *lsm, bool plain, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    if (lsm->pass->end) {
        vec copy[POLAR_TILES][6];
        for (int k = 0; k < blocks; k++) lanes_copy(plain ? 6 : 3, sum[k], copy[k]);
        lsm->pass->end(lsm, block, blocks, copy, laps);
    } else if (plain) {
        damp_blocks(lsm, block, blocks, sum);
    } else {
        move_blocks(lsm, block, blocks, sum, laps);
    }
}

#endif
