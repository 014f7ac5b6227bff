/* blocks_pass.h - the stages of a block pass (boxes.h), inline, so that the compiler can put a
 * pass's own work, `solve`, between the stages up and the stages down. */
#ifndef LSM_BLOCKS_PASS_H
#define LSM_BLOCKS_PASS_H

#include "../../lib/simd/rigid_lanes.h"
#include "../match.h"
#include "blocks_far.h"
#include "blocks_rows.h"
#include "window.h"

/* Value f of the y stage at a column, and its moment, number m, unless that is NULL. */
SM_INLINE vec window_y(const Around *in, long column, int w, bool moving, int f, int m, vec *moment)
{
    long at = column * BLOCK + f * SM_LANES;
    real *kept = in->window + at, *kept_moment = in->window + column * BLOCK + m * SM_LANES;
    vec sum;
    if (moving) {
        sum = lanes_load(kept);
        if (moment) *moment = lanes_load(kept_moment);
        window_move(lanes_load(in->row[0] + at), lanes_load(in->row[2 * w + 1] + at), w, &sum,
                    moment);
    } else {
        window_sum(in->row + 1, at, w, &sum, moment);
    }
    if (w >= RUNNING && in->running) {
        lanes_store(kept, sum);
        if (moment) lanes_store(kept_moment, *moment);
    }
    return sum;
}

/* Its adjoint: value f at a column less the moment of value m. */
SM_INLINE vec window_y_less(const Around *in, long column, int w, bool moving, int f, int m)
{
    long at = column * BLOCK + f * SM_LANES, weighed = column * BLOCK + m * SM_LANES;
    vec sum, rest;
    if (moving) {
        const real *leave = in->row[0], *enter = in->row[2 * w + 1];
        vec out[2] = {lanes_load(leave + at), lanes_load(leave + weighed)};
        vec join[2] = {lanes_load(enter + at), lanes_load(enter + weighed)};
        sum = lanes_load(in->window + at);
        rest = lanes_load(in->window + weighed);
        window_less_move(out, join, w, &sum, &rest);
    } else {
        window_less(in->row + 1, at, weighed, w, &sum, &rest);
    }
    if (w >= RUNNING && in->running) {
        lanes_store(in->window + at, sum);
        lanes_store(in->window + weighed, rest);
    }
    return sum;
}

/* Where sums pass through particles only, those of other sites are dropped (boxes.h). */
SM_INLINE vec through(const Lsm *lsm, long block, int w, vec sum)
{
    return w > 1 ? sum : lanes_keep(lsm->box->site[block], sum);
}

/* What the z stage up sums of a block: value d of m~ x, or of damping's four triples. */
SM_INLINE void source(const Lsm *lsm, long block, bool damping, int d, vec out[4])
{
    vec weight = lsm->particle_const[lsm->block_const[block]].weight;
    const real *x = lsm->x + block * 3 * SM_LANES;
    if (damping) {
        damping_products(weight, x, lsm->v + block * 3 * SM_LANES, d, out);
        return;
    }
    out[0] = lsm->pass == PASS_CONSTANTS ? weight : weight * lanes_load(x + d * SM_LANES);
}

/* The window of the z stage up of a block, from the one in `kept` of the block in the plane before.
 */
SM_INLINE void move_z_up(const Lsm *lsm, long block, int w, bool damping, int d, const real *kept,
                         vec sum[4])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    const int *along_before = lsm->box->along_z + along[w - 1] * (long)(2 * w + 1);
    vec leave[4], enter[4];
    source(lsm, along_before[0], damping, d, leave);
    source(lsm, along[2 * w], damping, d, enter);
    for (int k = 0; k < (damping ? 4 : 2); k++) sum[k] = lanes_load(kept + (3 * k + d) * SM_LANES);
    if (damping)
        for (int k = 0; k < 4; k++) window_move(leave[k], enter[k], w, &sum[k], NULL);
    else
        window_move(leave[0], enter[0], w, &sum[0], &sum[1]);
}

SM_INLINE void sum_z_up(const Lsm *lsm, long block, int w, bool damping, int d, vec sum[4])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    vec p[4];
    source(lsm, along[w], damping, d, sum);
    if (!damping) sum[1] = lanes_set(0);
    for (int c = 0; c <= 2 * w; c++) {
        if (c == w) continue;
        source(lsm, along[c], damping, d, p);
        for (int k = 0; k < (damping ? 4 : 1); k++) sum[k] += p[k];
        if (!damping) sum[1] += (real)(c - w) * p[0];
    }
}

/* The stage up along z for values 3 k + d of a block: 1 -> 2 of them, of damping 4. `kept` is its
 * place's window. */
SM_INLINE void stage_z_up(const Lsm *lsm, long block, int w, bool damping, bool moving, int d,
                          real *kept, vec sum[4])
{
    int n = damping ? 4 : 2;
    if (moving)
        move_z_up(lsm, block, w, damping, d, kept, sum);
    else
        sum_z_up(lsm, block, w, damping, d, sum);
    for (int k = 0; k < n && w >= RUNNING && lsm->box->running; k++)
        lanes_store(kept + (3 * k + d) * SM_LANES, sum[k]);
    for (int k = 0; k < n; k++) sum[k] = through(lsm, block, w, sum[k]);
}

/* The stages up along z and x for values 3 k + d of a run, d = first .. first + parts - 1, into a
 * row of the ring `above`: 1 -> 2 -> 3 values of each d. `kept` are the windows of its row. */
SM_INLINE void run_up(const Lsm *lsm, const BlockRun *run, int w, bool damping, bool moving,
                      int first, int parts, real *kept, real *row)
{
    int n = damping ? 4 : 2, last = run->first + run->count - 1;
    real *out = row + run->column * (long)BLOCK + first * SM_LANES;
    kept += run->column * (long)BLOCK;
    vec before[3][4], here[3][4], after[3][4], moment = lanes_set(0);
    for (int d = 0; d < parts; d++) {
        stage_z_up(lsm, run->first, w, damping, moving, first + d, kept, here[d]);
        for (int k = 0; k < n; k++) before[d][k] = after[d][k] = lanes_set(0);
    }
    for (int block = run->first; block <= last; block++, out += BLOCK) {
        kept += BLOCK;
        for (int d = 0; d < parts; d++) {
            if (block < last)
                stage_z_up(lsm, block + 1, w, damping, moving, first + d, kept, after[d]);
            else
                for (int k = 0; k < n; k++) after[d][k] = lanes_set(0);
            for (int k = 0; k < n; k++) {
                vec sum = window_sum_x(before[d][k], here[d][k], after[d][k], w,
                                       k || damping ? NULL : &moment);
                lanes_store(out + (3 * k + d) * SM_LANES, through(lsm, block, w, sum));
                before[d][k] = here[d][k];
                here[d][k] = after[d][k];
            }
            if (!damping) lanes_store(out + (6 + d) * SM_LANES, through(lsm, block, w, moment));
        }
    }
}

/* The same where w >= FAR, for all d. */
SM_INLINE void run_up_far(const Lsm *lsm, const BlockRun *run, int w, bool damping, bool moving,
                          real *kept, real *row)
{
    int n = damping ? 4 : 2;
    real *first = row + run->column * (long)BLOCK;
    kept += run->column * (long)BLOCK;
    for (int i = 0; i < run->count; i++)
        for (int d = 0; d < 3; d++) {
            vec sum[4];
            stage_z_up(lsm, run->first + i, w, damping, moving, d, kept + i * (long)BLOCK, sum);
            for (int k = 0; k < n; k++)
                lanes_store(first + i * (long)BLOCK + (3 * k + d) * SM_LANES, sum[k]);
        }
    for (int f = 0; f < 3 * n; f++)
        far_sum(first + f * SM_LANES, run->count, BLOCK, w, damping || f > 2 ? 0 : 6 * SM_LANES);
}

SM_INLINE void run_up_all(const Lsm *lsm, const BlockRun *run, int w, bool damping, bool moving,
                          real *kept, real *row)
{
    if (w >= FAR && lsm->box->running) {
        run_up_far(lsm, run, w, damping, moving, kept, row);
        return;
    }
    if (damping) /* in turn: all at once would not fit into registers */
        for (int d = 0; d < 3; d++) run_up(lsm, run, w, true, moving, d, 1, kept, row);
    else
        run_up(lsm, run, w, false, moving, 0, 3, kept, row);
}

/* Asks for what comes from far: the newest plane that the z stage reads; and constants of regions,
 * of which those that differ have their own: they are there when the row is solved. */
SM_INLINE void prefetch_run(const Lsm *lsm, const BlockRun *run, int w, bool damping)
{
    for (int block = run->first; block < run->first + run->count; block++) {
        if (lsm->box->streams) {
            int newest = lsm->box->along_z[block * (long)(2 * w + 1) + 2 * w];
            prefetch_ahead(lsm, lsm->x, newest);
            if (damping) prefetch_ahead(lsm, lsm->v, newest);
        }
        const RegionConst *k = lsm->region_const + lsm->tile_const[block];
        __builtin_prefetch(&k->inverse_mass);
        for (int d = 0; d < 3 && !damping; d++) __builtin_prefetch(&k->offset[d]);
    }
}

/* Rows have zeros where they have no blocks. */
SM_INLINE void row_up(const Lsm *lsm, const Scratch *s, BlockRow at, int slot, int w, bool damping)
{
    real *row = row_for(s, 0, slot, at);
    for (int i = 0; i < at.runs; i++) {
        const BlockRun *run = at.run + i;
        real *kept = w >= RUNNING ? s->plane + run->y * s->pitch : NULL;
        prefetch_run(lsm, run, w, damping);
        if (w >= RUNNING && run->moves_z)
            run_up_all(lsm, run, w, damping, true, kept, row);
        else
            run_up_all(lsm, run, w, damping, false, kept, row);
    }
}

/* The stage up along y, 9 -> 12 values, and `solve` for a group of blocks of a row, into the ring
 * `below`. */
SM_INLINE void solve_group(Lsm *lsm, const Around *in, const BlockRun *run, int i, int blocks,
                           int layer, int w, bool damping, bool moving, real *row,
                           BlockSolve *solve, SmLaps *laps)
{
    vec sums[BLOCK_GROUP][12];
    for (int k = 0; k < blocks; k++) {
        vec *sum = sums[k];
        for (int f = 0; f < (damping ? 12 : 9); f++) {
            vec *moment = damping || f > 2 ? NULL : &sum[chain_value(9 + f)];
            sum[damping ? f : chain_value(f)] =
                window_y(in, run->column + i + k, w, moving, f, 9 + f, moment);
        }
    }
    sm_lap(laps, damping ? SM_DAMPING : SM_FAST_SUM);
    solve(lsm, layer, run->first + i, blocks, sums, row + (run->column + i) * (long)BLOCK, laps);
}

SM_INLINE void run_solve(Lsm *lsm, const Around *in, const BlockRun *run, int layer, int w,
                         bool damping, bool moving, real *row, BlockSolve *solve, SmLaps *laps)
{
    int most = damping ? 1 : BLOCK_GROUP; /* matching alone gains from several at once */
    for (int i = 0, blocks; i < run->count; i += blocks) {
        int left = run->count - i;
        blocks = left < most ? left : most;
        if (most > 1 && left == most + 1) blocks--; /* no block is left for a group of its own */
        solve_group(lsm, in, run, i, blocks, layer, w, damping, moving, row, solve, laps);
    }
}

/* The stage up along y and `solve` for the row whose row y + w is in slot `newest` of the ring
 * `above`, into `slot` of the ring `below`. */
SM_INLINE void row_solve(Lsm *lsm, const Scratch *s, BlockRow at, int newest, int slot, int layer,
                         int w, bool damping, BlockSolve *solve, SmLaps *laps)
{
    real *row = row_for(s, 1, slot, at);
    Around in = rows_around(lsm, s, 0, newest, w);
    for (int i = 0; i < at.runs; i++) {
        if (w >= RUNNING && at.run[i].moves_y)
            run_solve(lsm, &in, at.run + i, layer, w, damping, true, row, solve, laps);
        else
            run_solve(lsm, &in, at.run + i, layer, w, damping, false, row, solve, laps);
    }
}

/* The stage down along y for values 3 k + d of a block: 4 -> 3 of them, of damping 2. */
SM_INLINE void stage_y_down(const Lsm *lsm, const Around *in, const BlockRun *run, int i, int w,
                            bool damping, bool moving, int d, vec out[3])
{
    int n = damping ? 2 : 3;
    long column = run->column + i;
    out[0] = damping ? window_y(in, column, w, moving, d, 0, NULL)
                     : window_y_less(in, column, w, moving, d, 9 + d);
    for (int k = 1; k < n; k++) out[k] = window_y(in, column, w, moving, 3 * k + d, 0, NULL);
    for (int k = 0; k < n; k++) out[k] = through(lsm, run->first + i, w, out[k]);
}

/* The stages down along y and x for values 3 k + d of a run, d = first .. first + parts - 1: 4 -> 3
 * -> 2 of them, into the plane's store. */
SM_INLINE void run_down(const Lsm *lsm, const Around *in, const BlockRun *run, int w, bool damping,
                        bool moving, int first, int parts, real *out)
{
    int n = damping ? 2 : 3;
    vec before[3][3], here[3][3], after[3][3], sum[3], moment = lanes_set(0);
    for (int d = 0; d < parts; d++) {
        for (int k = 0; k < n; k++) before[d][k] = lanes_set(0);
        stage_y_down(lsm, in, run, 0, w, damping, moving, first + d, here[d]);
    }
    for (int i = 0; i < run->count; i++, out += BLOCK_DOWN)
        for (int d = 0; d < parts; d++) {
            if (i + 1 < run->count)
                stage_y_down(lsm, in, run, i + 1, w, damping, moving, first + d, after[d]);
            else
                for (int k = 0; k < n; k++) after[d][k] = lanes_set(0);
            for (int k = 0; k < n; k++) {
                sum[k] =
                    window_sum_x(before[d][k], here[d][k], after[d][k], w, k == 2 ? &moment : NULL);
                before[d][k] = here[d][k];
                here[d][k] = after[d][k];
            }
            if (!damping) sum[0] -= moment;
            for (int k = 0; k < 2; k++)
                lanes_store(out + (3 * k + first + d) * SM_LANES,
                            through(lsm, run->first + i, w, sum[k]));
        }
}

/* The same where w >= FAR, for all d; `line` is room for a row. */
SM_INLINE void run_down_far(const Lsm *lsm, const Around *in, const BlockRun *run, int w,
                            bool damping, bool moving, real *line, real *out)
{
    int n = damping ? 2 : 3;
    for (int i = 0; i < run->count; i++)
        for (int d = 0; d < 3; d++) {
            vec sum[3];
            stage_y_down(lsm, in, run, i, w, damping, moving, d, sum);
            for (int k = 0; k < n; k++)
                lanes_store(line + i * (long)BLOCK + (3 * k + d) * SM_LANES, sum[k]);
        }
    for (int f = 0; f < 3 * n; f++)
        far_sum(line + f * SM_LANES, run->count, BLOCK, w, f < 6 ? 0 : 3 * SM_LANES);
    for (int i = 0; i < run->count; i++, line += BLOCK, out += BLOCK_DOWN)
        for (int f = 0; f < 6; f++) {
            vec sum = lanes_load(line + f * SM_LANES);
            if (!damping && f < 3) sum -= lanes_load(line + (9 + f) * SM_LANES);
            lanes_store(out + f * SM_LANES, sum);
        }
}

/* The stages down along y and x for the row whose row y + w is in slot `newest` of `below`. */
SM_INLINE void row_down(const Lsm *lsm, const Scratch *s, BlockRow at, int newest, int plane, int w,
                        bool damping)
{
    Around in = rows_around(lsm, s, 1, newest, w);
    for (int i = 0; i < at.runs; i++) {
        const BlockRun *run = at.run + i;
        real *out = lsm->box->down[plane] + (run->first - lsm->layer_block[plane]) * BLOCK_DOWN;
        if (w >= FAR && in.running) {
            if (run->moves_y)
                run_down_far(lsm, &in, run, w, damping, true, s->line, out);
            else
                run_down_far(lsm, &in, run, w, damping, false, s->line, out);
            continue;
        }
        if (w < RUNNING)
            run_down(lsm, &in, run, w, damping, false, 0, 3, out);
        else
            for (int d = 0; d < 3; d++) {
                if (w >= RUNNING && run->moves_y)
                    run_down(lsm, &in, run, w, damping, true, d, 1, out);
                else
                    run_down(lsm, &in, run, w, damping, false, d, 1, out);
            }
    }
}

/* A plane's rows as a pipeline: row y goes up along z and x when row y - w is solved, and row
 * y - 2w comes down along y and x. */
SM_INLINE void plane_pass(Lsm *lsm, int plane, int thread, int w, bool damping, BlockSolve *solve,
                          SmLaps *laps)
{
    const Blocks *box = lsm->box;
    int begin = box->plane_run[plane], end = box->plane_run[plane + 1];
    if (begin == end) return;
    Scratch s = scratch_of(lsm, thread);
    int first = box->run[begin].y, last = box->run[end - 1].y;
    SmStage stage = damping ? SM_DAMPING : SM_FAST_SUM;
    for (int slot = s.ring - w; slot < s.ring; slot++) /* above `first` */
        row_for(&s, 0, slot, (BlockRow){NULL, 0});
    for (int y = first, slot = 0; y <= last + 2 * w; y++) {
        int behind = slot < w ? slot - w + s.ring : slot - w; /* of row y - w */
        row_up(lsm, &s, row_at(lsm, plane, y), slot, w, damping);
        sm_lap(laps, stage);
        row_solve(lsm, &s, row_at(lsm, plane, y - w), slot, behind, plane, w, damping, solve, laps);
        row_down(lsm, &s, row_at(lsm, plane, y - 2 * w), behind, plane, w, damping);
        sm_lap(laps, stage);
        slot = slot + 1 == s.ring ? 0 : slot + 1;
    }
}

/* Part 1 of a pass for one plane: sums up, `solve` at every block, sums down along x and y.
 * PLANE_PASSES(damping, solve) makes lsm_blocks_up() of them, with a function for each of the usual
 * widths: in one together the compiler runs out of registers. */
typedef void PlanePass(Lsm *lsm, int plane, int thread, SmLaps *laps);

#define PLANE_PASS(name, width, damping, solve)                                                    \
    static __attribute__((noinline)) void name(Lsm *lsm, int plane, int thread, SmLaps *laps)      \
    {                                                                                              \
        plane_pass(lsm, plane, thread, width, damping, solve, laps);                               \
    }
#ifdef __AVX512F__
#define PLANE_PASSES(damping, solve)                                                               \
    PLANE_PASS(plane_pass_any, lsm->w, damping, solve)                                             \
    PLANE_PASS(plane_pass_1, 1, damping, solve)                                                    \
    PLANE_PASS(plane_pass_2, 2, damping, solve)                                                    \
    PLANE_PASS(plane_pass_3, 3, damping, solve)                                                    \
    PLANE_PASS(plane_pass_4, 4, damping, solve)                                                    \
    PLANE_PASS(plane_pass_5, 5, damping, solve)                                                    \
    PLANE_PASS(plane_pass_6, 6, damping, solve)                                                    \
    PLANE_PASS(plane_pass_7, 7, damping, solve)                                                    \
    static void lsm_blocks_up(Lsm *lsm, int plane, int thread, SmLaps *laps)                       \
    {                                                                                              \
        static PlanePass *const pass[] = {                                                         \
            plane_pass_any, plane_pass_1, plane_pass_2, plane_pass_3,                              \
            plane_pass_4,   plane_pass_5, plane_pass_6, plane_pass_7};                             \
        pass[lsm->w < 8 ? lsm->w : 0](lsm, plane, thread, laps);                                   \
    }
#else /* a vector is many instructions, and compiling them for each width takes too long */
#define PLANE_PASSES(damping, solve) PLANE_PASS(lsm_blocks_up, lsm->w, damping, solve)
#endif

#endif
