/* blocks_pass.h - the stages of a block pass (blocks.h), inline, so that the compiler can put a
 * pass's own work, `solve`, between the stages up and the stages down. */
#ifndef LSM_BLOCKS_PASS_H
#define LSM_BLOCKS_PASS_H

#include "../lib/rigid_lanes.h"
#include "blocks.h"
#include "match.h"
#include "window.h"

#include <string.h>

/* One body serves shape matching and damping. Values are numbered 3 k + d, d = 0..2 for x, y, z:
 * up, k counts (P, Pz, Px, Py) and down (Q, Rz, Rx, Ry) in the order in which the chain's stages
 * add and use them; damping sums four plain triples up and two down. */
enum { BLOCK = 12 * SM_LANES, BLOCK_DOWN = 6 * SM_LANES };

/* Scratch of a thread. Rings hold the last 2 w + 2 rows of a plane, each [width][BLOCK]. */
typedef struct {
    long pitch;      /* values in a row */
    int ring;        /* rows in a ring */
    real *above;     /* [ring] rows after the stages up along z and x */
    real *below;     /* [ring] rows after `solve` */
    real *window[2]; /* up, down: each column's window of the y stage, [BLOCK] */
    real *plane;     /* up: each place's window of the z stage, [BLOCK] */
} Scratch;

static Scratch scratch_of(const Lsm *lsm, int thread)
{
    int width = lsm->box->width;
    Scratch s = {.pitch = width * (long)BLOCK, .ring = lsm->side + 1};
    s.above = lsm->box->scratch[thread];
    s.below = s.above + s.ring * s.pitch;
    s.window[0] = s.below + s.ring * s.pitch;
    s.window[1] = s.window[0] + s.pitch;
    s.plane = lsm->box->window[thread];
    return s;
}

/* Where the y stage of a row reads: rows y - w - 1 .. y + w of a ring, and the windows. */
typedef struct {
    const real *row[LSM_MAX_SIDE + 1];
    real *window;
    bool running;
} Around;

/* `slot` of the ring holds row y + w. */
SM_INLINE Around rows_around(const Lsm *lsm, const Scratch *s, int way, int slot, int w)
{
    Around around = {.window = s->window[way], .running = lsm->box->running};
    for (int b = 0; b < 2 * w + 2; b++) {
        slot = slot + 1 == s->ring ? 0 : slot + 1;
        around.row[b] = (way ? s->below : s->above) + slot * s->pitch;
    }
    return around;
}

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

/* Where sums pass through particles only, those of other sites are dropped (blocks.h). */
SM_INLINE vec through(const Lsm *lsm, long block, int w, vec sum)
{
    return w > 1 ? sum : lanes_and(sum, lsm->box->site[block]);
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

/* The runs of a row of a plane. */
typedef struct {
    const BlockRun *run;
    int runs;
    bool full; /* blocks all the way */
} Row;

SM_INLINE Row row_at(const Lsm *lsm, int plane, int y)
{
    const Blocks *box = lsm->box;
    if (y < 0 || y >= lsm->lattice.size[1]) return (Row){NULL, 0, false};
    const int *first = box->row_run + plane * (long)lsm->lattice.size[1] + y;
    const BlockRun *run = box->run + first[0];
    int runs = first[1] - first[0];
    return (Row){run, runs, run[runs].first - run->first == box->width};
}

SM_INLINE void run_up_all(const Lsm *lsm, const BlockRun *run, int w, bool damping, bool moving,
                          real *kept, real *row)
{
    if (damping) /* in turn: all at once would not fit into registers */
        for (int d = 0; d < 3; d++) run_up(lsm, run, w, true, moving, d, 1, kept, row);
    else
        run_up(lsm, run, w, false, moving, 0, 3, kept, row);
}

/* Rows have zeros where they have no blocks. */
SM_INLINE void row_up(const Lsm *lsm, const Scratch *s, Row at, int slot, int w, bool damping)
{
    real *row = s->above + slot * s->pitch;
    if (!at.full) memset(row, 0, (size_t)s->pitch * sizeof(real));
    for (int i = 0; i < at.runs; i++) {
        const BlockRun *run = at.run + i;
        real *kept = w >= RUNNING ? s->plane + run->y * s->pitch : NULL;
        if (w >= RUNNING && run->moves_z)
            run_up_all(lsm, run, w, damping, true, kept, row);
        else
            run_up_all(lsm, run, w, damping, false, kept, row);
    }
}

/* The stage up along y, 9 -> 12 values, and `solve` for one or two blocks of a row, into the ring
 * `below`. `solve` has its moments in the order z, y, x. */
SM_INLINE void solve_some(Lsm *lsm, const Around *in, const BlockRun *run, int i, int blocks,
                          int layer, int w, bool damping, bool moving, real *row, BlockSolve *solve,
                          SmLaps *laps)
{
    vec sum[2][12], out[2][12];
    for (int k = 0; k < blocks; k++)
        for (int f = 0; f < (damping ? 12 : 9); f++) {
            int to = damping || f < 6 ? f : f + 3;
            vec *moment = damping || f > 2 ? NULL : &sum[k][6 + f];
            sum[k][to] = window_y(in, run->column + i + k, w, moving, f, 9 + f, moment);
        }
    sm_lap(laps, damping ? SM_DAMPING : SM_FAST_SUM);
    solve(lsm, layer, run->first + i, blocks, sum, out, laps);
    for (int k = 0; k < blocks; k++)
        for (int f = 0; f < (damping ? 6 : 12); f++) {
            int from = damping || f < 6 ? f : f < 9 ? f + 3 : f - 3;
            lanes_store(row + (run->column + i + k) * (long)BLOCK + f * SM_LANES, out[k][from]);
        }
}

SM_INLINE void run_solve(Lsm *lsm, const Around *in, const BlockRun *run, int layer, int w,
                         bool damping, bool moving, real *row, BlockSolve *solve, SmLaps *laps)
{
    int i = 0;
    for (; i + 1 < run->count; i += 2)
        solve_some(lsm, in, run, i, 2, layer, w, damping, moving, row, solve, laps);
    if (i < run->count) solve_some(lsm, in, run, i, 1, layer, w, damping, moving, row, solve, laps);
}

/* The stage up along y and `solve` for the row whose row y + w is in slot `newest` of the ring
 * `above`, into `slot` of the ring `below`. */
SM_INLINE void row_solve(Lsm *lsm, const Scratch *s, Row at, int newest, int slot, int layer, int w,
                         bool damping, BlockSolve *solve, SmLaps *laps)
{
    real *row = s->below + slot * s->pitch;
    Around in = rows_around(lsm, s, 0, newest, w);
    if (!at.full) memset(row, 0, (size_t)s->pitch * sizeof(real));
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

/* The stages down along y and x for values 3 k + d of a run: 4 -> 3 -> 2 of them, into the plane's
 * store. */
SM_INLINE void run_down(const Lsm *lsm, const Around *in, const BlockRun *run, int w, bool damping,
                        bool moving, int d, real *out)
{
    int n = damping ? 2 : 3;
    vec before[3], here[3], after[3], sum[3], moment = lanes_set(0);
    for (int k = 0; k < n; k++) before[k] = lanes_set(0);
    stage_y_down(lsm, in, run, 0, w, damping, moving, d, here);
    for (int i = 0; i < run->count; i++, out += BLOCK_DOWN) {
        for (int k = 0; k < n; k++) after[k] = lanes_set(0);
        if (i + 1 < run->count) stage_y_down(lsm, in, run, i + 1, w, damping, moving, d, after);
        for (int k = 0; k < n; k++) {
            sum[k] = window_sum_x(before[k], here[k], after[k], w, k == 2 ? &moment : NULL);
            before[k] = here[k];
            here[k] = after[k];
        }
        if (!damping) sum[0] -= moment;
        for (int k = 0; k < 2; k++)
            lanes_store(out + (3 * k + d) * SM_LANES, through(lsm, run->first + i, w, sum[k]));
    }
}

/* The stages down along y and x for the row whose row y + w is in slot `newest` of `below`. */
SM_INLINE void row_down(const Lsm *lsm, const Scratch *s, Row at, int newest, int plane, int w,
                        bool damping)
{
    Around in = rows_around(lsm, s, 1, newest, w);
    for (int i = 0; i < at.runs; i++) {
        const BlockRun *run = at.run + i;
        real *out = lsm->box->down[plane] + (run->first - lsm->layer_block[plane]) * BLOCK_DOWN;
        for (int d = 0; d < 3; d++) {
            if (w >= RUNNING && run->moves_y)
                run_down(lsm, &in, run, w, damping, true, d, out);
            else
                run_down(lsm, &in, run, w, damping, false, d, out);
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
    memset(s.above + (s.ring - w) * s.pitch, 0,
           (size_t)(w * s.pitch) * sizeof(real)); /* above `first` */
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

/* Part 1 of a pass for one plane: sums up, `solve` at every block, sums down along x and y. */
SM_INLINE void lsm_blocks_up(Lsm *lsm, int plane, int thread, bool damping, BlockSolve *solve,
                             SmLaps *laps)
{
#define WIDTH(w)                                                                                   \
    if (damping)                                                                                   \
        plane_pass(lsm, plane, thread, w, true, solve, laps);                                      \
    else                                                                                           \
        plane_pass(lsm, plane, thread, w, false, solve, laps);                                     \
    break
    switch (lsm->w) { /* constants for the usual widths */
#ifdef __AVX512F__    /* elsewhere a vector is many instructions, and compiling takes too long */
    case 1:
        WIDTH(1);
    case 2:
        WIDTH(2);
    case 3:
        WIDTH(3);
    case 4:
        WIDTH(4);
    case 5:
        WIDTH(5);
#endif
    default:
        WIDTH(lsm->w);
    }
#undef WIDTH
}

/* Where part 1 has left a block's sums down along y and x; NULL for the empty block. */
SM_INLINE const real *down_at(const Lsm *lsm, int plane, int block)
{
    if (block == lsm->blocks) return NULL;
    return lsm->box->down[plane] + (block - lsm->layer_block[plane]) * BLOCK_DOWN;
}

SM_INLINE void sum_z_down(const Lsm *lsm, int plane, long block, int w, bool damping, vec sum[6])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    for (int f = 0; f < 6; f++) sum[f] = lanes_set(0);
    for (int c = 0; c <= 2 * w; c++) {
        const real *in = down_at(lsm, plane + c - w, along[c]);
        if (!in) continue;
        for (int f = 0; f < 6; f++) {
            if (f < 3 || damping || w >= RUNNING) sum[f] += lanes_load(in + f * SM_LANES);
            if (f >= 3 && !damping && c != w)
                sum[f - 3] -= (real)(c - w) * lanes_load(in + f * SM_LANES);
        }
    }
}

/* The same from the window of the block in the plane before. */
SM_INLINE void move_z_down(const Lsm *lsm, int plane, long block, int w, bool damping, vec sum[6])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    const int *along_before = lsm->box->along_z + along[w - 1] * (long)(2 * w + 1);
    const real *leave = down_at(lsm, plane - w - 1, along_before[0]);
    const real *enter = down_at(lsm, plane + w, along[2 * w]);
    for (int d = 0; d < 3; d++) {
        vec out[2] = {{0}}, join[2] = {{0}};
        for (int k = 0; k < 2; k++) {
            if (leave) out[k] = lanes_load(leave + (3 * k + d) * SM_LANES);
            if (enter) join[k] = lanes_load(enter + (3 * k + d) * SM_LANES);
        }
        if (damping)
            for (int k = 0; k < 2; k++) window_move(out[k], join[k], w, &sum[3 * k + d], NULL);
        else
            window_less_move(out, join, w, &sum[d], &sum[3 + d]);
    }
}

/* The last stage down, along z, for one block of `plane`: 3 or 6 values. */
SM_INLINE void stage_z_down(const Lsm *lsm, int plane, long block, bool moving, int thread, int w,
                            bool damping, vec sum[6])
{
    if (w < RUNNING || !lsm->box->running) {
        sum_z_down(lsm, plane, block, w, damping, sum);
        return;
    }
    real *kept = lsm->box->window[thread] + lsm->box->width * (long)lsm->lattice.size[1] * BLOCK +
                 lsm->box->place[block] * (long)BLOCK_DOWN;
    if (moving) {
        for (int f = 0; f < 6; f++) sum[f] = lanes_load(kept + f * SM_LANES);
        move_z_down(lsm, plane, block, w, damping, sum);
    } else {
        sum_z_down(lsm, plane, block, w, damping, sum);
    }
    for (int f = 0; f < 6; f++) lanes_store(kept + f * SM_LANES, sum[f]);
}

/* What a pass does at the end with a block's 3 or 6 sums. */
typedef void BlockEnd(Lsm *lsm, long block, vec sum[6], SmLaps *laps);

SM_INLINE void plane_down(Lsm *lsm, int plane, int thread, int w, bool damping, BlockEnd *end,
                          SmLaps *laps)
{
    const Blocks *box = lsm->box;
    for (int r = box->plane_run[plane]; r < box->plane_run[plane + 1]; r++) {
        const BlockRun *run = &box->run[r];
        for (long block = run->first; block < run->first + run->count; block++) {
            vec sum[6];
            stage_z_down(lsm, plane, block, run->moves_z, thread, w, damping, sum);
            end(lsm, block, sum, laps);
        }
    }
}

/* Part 2 of a pass for one plane: the last stage down, along z, and what the pass ends with. */
SM_INLINE void lsm_blocks_down(Lsm *lsm, int plane, int thread, bool damping, BlockEnd *end,
                               SmLaps *laps)
{
    switch (lsm->w) {
    case 1:
        plane_down(lsm, plane, thread, 1, damping, end, laps);
        break;
    case 2:
        plane_down(lsm, plane, thread, 2, damping, end, laps);
        break;
    default:
        plane_down(lsm, plane, thread, lsm->w, damping, end, laps);
    }
}

#endif
