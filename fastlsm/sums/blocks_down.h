/* blocks_down.h - the last stage of a block pass (boxes.h): down along z to the particles. */
#ifndef LSM_BLOCKS_DOWN_H
#define LSM_BLOCKS_DOWN_H

#include "blocks_pass.h"

/* Where part 1 has left the sums down along y and x of planes plane - w - 1 .. plane + w, and their
 * first blocks. */
typedef struct {
    const real *plane[LSM_MAX_SIDE + 1];
    long first[LSM_MAX_SIDE + 1];
} Downs;

SM_INLINE Downs downs_around(const Lsm *lsm, int plane, int w)
{
    Downs downs;
    for (int c = 0; c < 2 * w + 2; c++) {
        int z = plane + c - w - 1;
        bool there = z >= 0 && z < lsm->layers;
        downs.plane[c] = there ? lsm->box->down[z] : NULL;
        downs.first[c] = there ? lsm->layer_block[z] : 0;
    }
    return downs;
}

/* What the empty block brings down. */
static const real nothing_down[BLOCK_DOWN] __attribute__((aligned(64)));

SM_INLINE const real *down_at(const Lsm *lsm, const Downs *downs, int c, int block)
{
    return block == lsm->blocks ? nothing_down
                                : downs->plane[c] + (block - downs->first[c]) * BLOCK_DOWN;
}

SM_INLINE void sum_z_down(const Lsm *lsm, const Downs *downs, long block, int w, bool damping,
                          vec sum[6])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    for (int f = 0; f < 6; f++) sum[f] = lanes_set(0);
    for (int c = 0; c <= 2 * w; c++) {
        const real *in = down_at(lsm, downs, c + 1, along[c]);
        for (int f = 0; f < 6; f++) {
            if (f < 3 || damping || w >= RUNNING) sum[f] += lanes_load(in + f * SM_LANES);
            if (f >= 3 && !damping && c != w)
                sum[f - 3] -= (real)(c - w) * lanes_load(in + f * SM_LANES);
        }
    }
}

/* The same from the window of the block in the plane before. */
SM_INLINE void move_z_down(const Lsm *lsm, const Downs *downs, long block, int w, bool damping,
                           vec sum[6])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    const int *along_before = lsm->box->along_z + along[w - 1] * (long)(2 * w + 1);
    const real *leave = down_at(lsm, downs, 0, along_before[0]);
    const real *enter = down_at(lsm, downs, 2 * w + 1, along[2 * w]);
    for (int d = 0; d < 3; d++) {
        vec out[2], join[2];
        for (int k = 0; k < 2; k++) {
            out[k] = lanes_load(leave + (3 * k + d) * SM_LANES);
            join[k] = lanes_load(enter + (3 * k + d) * SM_LANES);
        }
        if (damping)
            for (int k = 0; k < 2; k++) window_move(out[k], join[k], w, &sum[3 * k + d], NULL);
        else
            window_less_move(out, join, w, &sum[d], &sum[3 + d]);
    }
}

/* The last stage down, along z, for one block of `plane`: 3 or 6 values. */
SM_INLINE void stage_z_down(const Lsm *lsm, const Downs *downs, long block, bool moving, int thread,
                            int w, bool damping, vec sum[6])
{
    if (w < RUNNING || !lsm->box->running) {
        sum_z_down(lsm, downs, block, w, damping, sum);
        return;
    }
    real *kept = lsm->box->window[thread] + lsm->box->width * (long)lsm->lattice.size[1] * BLOCK +
                 lsm->box->place[block] * (long)BLOCK_DOWN;
    if (moving) {
        for (int f = 0; f < 6; f++) sum[f] = lanes_load(kept + f * SM_LANES);
        move_z_down(lsm, downs, block, w, damping, sum);
    } else {
        sum_z_down(lsm, downs, block, w, damping, sum);
    }
    for (int f = 0; f < 6; f++) lanes_store(kept + f * SM_LANES, sum[f]);
}

/* What a pass does at the end with a block's 3 or 6 sums. */
typedef void BlockEnd(Lsm *lsm, long block, vec sum[6], SmLaps *laps);

SM_INLINE void plane_down(Lsm *lsm, int plane, int thread, int w, bool damping, BlockEnd *end,
                          SmLaps *laps)
{
    const Blocks *box = lsm->box;
    Downs downs = downs_around(lsm, plane, w);
    for (int r = box->plane_run[plane]; r < box->plane_run[plane + 1]; r++) {
        const BlockRun *run = &box->run[r];
        for (long block = run->first; block < run->first + run->count; block++) {
            vec sum[6];
            if (!damping && box->streams) prefetch_ahead(lsm, lsm->v, block);
            stage_z_down(lsm, &downs, block, run->moves_z, thread, w, damping, sum);
            end(lsm, block, sum, laps);
        }
    }
}

/* Part 2 of a pass for one plane: the last stage down, along z, and what the pass ends with.
 * PLANE_DOWNS(damping, end) makes lsm_blocks_down() of them. */
#define PLANE_DOWN(name, width, damping, end)                                                      \
    static __attribute__((noinline)) void name(Lsm *lsm, int plane, int thread, SmLaps *laps)      \
    {                                                                                              \
        plane_down(lsm, plane, thread, width, damping, end, laps);                                 \
    }
#define PLANE_DOWNS(damping, end)                                                                  \
    PLANE_DOWN(plane_down_any, lsm->w, damping, end)                                               \
    PLANE_DOWN(plane_down_1, 1, damping, end)                                                      \
    PLANE_DOWN(plane_down_2, 2, damping, end)                                                      \
    static void lsm_blocks_down(Lsm *lsm, int plane, int thread, SmLaps *laps)                     \
    {                                                                                              \
        static PlanePass *const pass[] = {plane_down_any, plane_down_1, plane_down_2};             \
        pass[lsm->w < 3 ? lsm->w : 0](lsm, plane, thread, laps);                                   \
    }

#endif
