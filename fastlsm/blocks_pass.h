/* blocks_pass.h - the stages of a block pass (blocks.h), inline, so that the compiler can put a
 * pass's own work, `solve`, between the stages up and the stages down. */
#ifndef LSM_BLOCKS_PASS_H
#define LSM_BLOCKS_PASS_H

#include "../lib/rigid_lanes.h"
#include "blocks.h"
#include "match.h"
#include "window.h"

#include <limits.h>
#include <string.h>

/* One kernel body serves shape matching and damping: F is how many values arrive at a stage. With
 * `moment`, a stage up appends sum o * (first three) for offset o, and a stage down takes
 * sum o * (last three) off the first three. */
enum { UP = 12, MOST = 12 };

/* Scratch of a thread, rows of a plane, block by block: [width + 2][MOST][lanes], with an empty
 * block at each end for the x stages. Rings hold rows y - w - 1 .. y + w. */
enum { BLOCK = MOST * SM_LANES };

typedef struct {
    long pitch;      /* (width + 2) blocks */
    int ring;        /* rows in a ring */
    bool running;    /* y stages move a window instead of summing it anew */
    real *above;     /* [ring] rows after the z stage up */
    real *line;      /* the row after the y stage up */
    real *solved;    /* the row after `solve` */
    real *below;     /* [ring] rows after the x stage down */
    real *window[2]; /* up, down: each column's window of the y stage */
    int *row[2];     /* the row it is at */
} Scratch;

static Scratch scratch_of(const Lsm *lsm, int thread)
{
    int width = lsm->box->width;
    Scratch s = {.pitch = (width + 2) * (long)BLOCK, .ring = lsm->side + 1};
    s.running = lsm->w > 2 && lsm->params.summation == SM_SUM_FAST;
    s.above = lsm->box->scratch[thread] + BLOCK;
    s.line = s.above + s.ring * s.pitch;
    s.solved = s.line + s.pitch;
    s.below = s.solved + s.pitch;
    s.window[0] = s.below + s.ring * s.pitch;
    s.window[1] = s.window[0] + s.pitch;
    s.row[0] = lsm->box->window_row[thread];
    s.row[1] = s.row[0] + width;
    for (int i = 0; i < 2 * width; i++) s.row[0][i] = INT_MIN;
    return s;
}

SM_INLINE real *ring_row(const Scratch *s, real *ring, int y)
{
    return ring + ((y + s->ring) % s->ring) * s->pitch;
}

/* A window that has moved this far is summed anew, or rounding would add up. */
enum { RESTART = 16 };

/* One block of a y stage: the window around row y of `ring`, moved on from row y - 1 where that is
 * known. `F` values come in; moments of three of them, from `first` on, follow in sum[F ..]. */
SM_INLINE void stage_y(const Scratch *s, int way, real *ring, int y, int column, int w, int F,
                       int first, vec *sum)
{
    long at = column * (long)BLOCK;
    vec *kept = (vec *)(s->window[way] + at);
    int values = first < 0 ? F : F + 3;
    if (s->running && s->row[way][column] == y - 1 && y % RESTART) {
        for (int f = 0; f < values; f++) sum[f] = kept[f];
        window_move(ring_row(s, ring, y - w - 1) + at, ring_row(s, ring, y + w) + at, SM_LANES, w,
                    F, first, sum, sum + F);
    } else {
        const real *in[LSM_MAX_SIDE];
        for (int b = 2 * w; b > 0; b--) in[b] = ring_row(s, ring, y + b - w) + at;
        in[0] = ring_row(s, ring, y - w) + at;
        window_sum(in, SM_LANES, w, F, first, sum, sum + F);
    }
    if (!s->running) return;
    for (int f = 0; f < values; f++) kept[f] = sum[f];
    s->row[way][column] = y;
}

/* m~ x of a block, or the products that damping sums: what the z stage up takes. */
SM_INLINE void source(const Lsm *lsm, long block, bool damping, vec out[MOST])
{
    vec x[3], v[3], weight = lsm->particle_const[lsm->block_const[block]].weight;
    load3(lsm->x + block * 3 * SM_LANES, x);
    if (lsm->pass == PASS_CONSTANTS) x[0] = x[1] = x[2] = lanes_set(1);
    if (!damping) {
        for (int d = 0; d < 3; d++) out[d] = weight * x[d];
        return;
    }
    load3(lsm->v + block * 3 * SM_LANES, v);
    damping_products(weight, x, v, out);
}

/* Stage up along z for one block. */
SM_INLINE void stage_z_up(const Lsm *lsm, long block, int w, bool damping, real *out)
{
    int F = damping ? 12 : 3;
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    vec sum[MOST], moment[3], p[MOST];
    source(lsm, along[0], damping, p);
    for (int f = 0; f < F; f++) sum[f] = p[f];
    for (int d = 0; d < 3; d++) moment[d] = -(real)w * p[d];
    for (int c = 1; c <= 2 * w; c++) {
        source(lsm, along[c], damping, p);
        for (int f = 0; f < F; f++) sum[f] += p[f];
        if (!damping && c != w)
            for (int d = 0; d < 3; d++) moment[d] += (real)(c - w) * p[d];
    }
    for (int f = 0; f < F; f++) lanes_store(out + f * SM_LANES, sum[f]);
    if (!damping)
        for (int d = 0; d < 3; d++) lanes_store(out + (F + d) * SM_LANES, moment[d]);
}

/* Row y of the z stage up: absent blocks and rows hold zero. */
SM_INLINE void row_z_up(Lsm *lsm, const Scratch *s, const BlockRow *row, int y, int w, bool damping)
{
    int F = damping ? 12 : 6;
    real *ring = ring_row(s, s->above, y);
    int next = row ? row->first : 0, last = row ? row->first + row->count : 0;
    for (int column = 0; column < lsm->box->width; column++) {
        real *out = ring + column * (long)BLOCK;
        if (next >= last || lsm->box->column[next] != column) {
            memset(out, 0, (size_t)F * SM_LANES * sizeof(real));
            continue;
        }
        stage_z_up(lsm, next, w, damping, out);
        if (w == 1 && !lsm->box->whole[next]) /* masked: sums pass through particles only */
            for (int f = 0; f < F; f++)
                lanes_store(out + f * SM_LANES,
                            lanes_and(lanes_load(out + f * SM_LANES), lsm->box->site[next]));
        next++;
    }
}

/* Row y of the y stage up, into `line`. */
SM_INLINE void row_y_up(Lsm *lsm, const Scratch *s, const BlockRow *row, int w, bool damping)
{
    int F = damping ? 12 : 6, out_F = damping ? 12 : 9;
    int next = row->first, last = row->first + row->count;
    for (int column = 0; column < lsm->box->width; column++) {
        real *out = s->line + column * (long)BLOCK;
        vec sum[MOST + 3];
        if (next >= last || lsm->box->column[next] != column) {
            for (int f = 0; f < out_F; f++) lanes_store(out + f * SM_LANES, lanes_set(0));
            continue;
        }
        stage_y(s, 0, s->above, row->y, column, w, F, damping ? -1 : 0, sum);
        if (w == 1 && !lsm->box->whole[next])
            for (int f = 0; f < out_F; f++) sum[f] = lanes_and(sum[f], lsm->box->site[next]);
        for (int f = 0; f < out_F; f++) lanes_store(out + f * SM_LANES, sum[f]);
        next++;
    }
}

/* The x stage up and `solve`, into `solved`. */
SM_INLINE void row_solve(Lsm *lsm, const Scratch *s, const BlockRow *row, int layer, int w,
                         bool damping, BlockSolve *solve, SmLaps *laps)
{
    int F = damping ? 12 : 9, out_F = damping ? 6 : 12;
    int next = row->first, last = row->first + row->count;
    for (int column = 0; column < lsm->box->width; column++) {
        real *out = s->solved + column * (long)BLOCK;
        vec sum[MOST + 3];
        if (next >= last || lsm->box->column[next] != column) {
            for (int f = 0; f < out_F; f++) lanes_store(out + f * SM_LANES, lanes_set(0));
            continue;
        }
        window_sum_x(s->line + column * (long)BLOCK, BLOCK, w, F, damping ? -1 : 0, sum, sum + F);
        sm_lap(laps, damping ? SM_DAMPING : SM_FAST_SUM);
        solve(lsm, layer, next, sum, (vec *)out, laps);
        next++;
    }
}

/* Row y of the x stage down, into the ring `below`. */
SM_INLINE void row_x_down(Lsm *lsm, const Scratch *s, const BlockRow *row, int y, int w,
                          bool damping)
{
    int F = damping ? 6 : 12, out_F = damping ? 6 : 9;
    real *ring = ring_row(s, s->below, y);
    int next = row ? row->first : 0, last = row ? row->first + row->count : 0;
    for (int column = 0; column < lsm->box->width; column++) {
        real *out = ring + column * (long)BLOCK;
        if (next >= last || lsm->box->column[next] != column) {
            memset(out, 0, (size_t)out_F * SM_LANES * sizeof(real));
            continue;
        }
        vec sum[MOST], moment[3];
        window_sum_x(s->solved + column * (long)BLOCK, BLOCK, w, F, damping ? -1 : 9, sum, moment);
        finish_down(sum, moment, damping);
        if (w == 1 && !lsm->box->whole[next])
            for (int f = 0; f < out_F; f++) sum[f] = lanes_and(sum[f], lsm->box->site[next]);
        for (int f = 0; f < out_F; f++) lanes_store(out + f * SM_LANES, sum[f]);
        next++;
    }
}

/* Row y of the y stage down, into the plane's store. */
SM_INLINE void row_y_down(Lsm *lsm, const Scratch *s, const BlockRow *row, int plane, int w,
                          bool damping)
{
    int F = damping ? 6 : 9;
    for (int block = row->first; block < row->first + row->count; block++) {
        real *out = lsm->box->down[plane] + (block - lsm->layer_block[plane]) * 6 * SM_LANES;
        vec sum[MOST + 3];
        stage_y(s, 1, s->below, row->y, lsm->box->column[block], w, F, damping ? -1 : 6, sum);
        finish_down(sum, sum + F, damping);
        if (w == 1 && !lsm->box->whole[block])
            for (int f = 0; f < 6; f++) sum[f] = lanes_and(sum[f], lsm->box->site[block]);
        for (int f = 0; f < 6; f++) lanes_store(out + f * SM_LANES, sum[f]);
    }
}

/* The row of a plane at y, or NULL; `row` walks along with rising y. */
static const BlockRow *row_at(const Lsm *lsm, int plane, int *row, int y)
{
    const Blocks *box = lsm->box;
    while (*row < box->plane_row[plane + 1] && box->row[*row].y < y) ++*row;
    return *row < box->plane_row[plane + 1] && box->row[*row].y == y ? &box->row[*row] : NULL;
}

/* A plane's rows as a pipeline: row y goes up along z when row y - w is solved, and row y - 2w
 * comes down along y. */
SM_INLINE void plane_pass(Lsm *lsm, int plane, int thread, int w, bool damping, BlockSolve *solve,
                          SmLaps *laps)
{
    Blocks *box = lsm->box;
    if (box->plane_row[plane] == box->plane_row[plane + 1]) return;
    Scratch s = scratch_of(lsm, thread);
    int begin = box->plane_row[plane], first = box->row[begin].y;
    int last = box->row[box->plane_row[plane + 1] - 1].y, walk[3] = {begin, begin, begin};
    SmStage stage = damping ? SM_DAMPING : SM_FAST_SUM;
    for (int b = 1; b <= 2 * w; b++) { /* rows before the first */
        row_z_up(lsm, &s, NULL, first - b, w, damping);
        row_x_down(lsm, &s, NULL, first - b, w, damping);
    }
    for (int y = first; y <= last + 2 * w; y++) {
        row_z_up(lsm, &s, row_at(lsm, plane, &walk[0], y), y, w, damping);
        const BlockRow *row = row_at(lsm, plane, &walk[1], y - w);
        if (row) {
            row_y_up(lsm, &s, row, w, damping);
            sm_lap(laps, stage);
            row_solve(lsm, &s, row, plane, w, damping, solve, laps);
        }
        row_x_down(lsm, &s, row, y - w, w, damping);
        row = row_at(lsm, plane, &walk[2], y - 2 * w);
        if (row) row_y_down(lsm, &s, row, plane, w, damping);
        sm_lap(laps, stage);
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
    default:
        WIDTH(lsm->w);
    }
#undef WIDTH
}

SM_INLINE void stage_z_down(const Lsm *lsm, int plane, long block, int w, bool damping, vec *sum)
{
    int F = damping ? 6 : 3;
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    for (int f = 0; f < F; f++) sum[f] = lanes_set(0);
    for (int c = 0; c <= 2 * w; c++) {
        if (along[c] == lsm->blocks) continue;
        int z = plane + c - w;
        const real *in = lsm->box->down[z] + (along[c] - lsm->layer_block[z]) * 6 * SM_LANES;
        for (int f = 0; f < F; f++) sum[f] += lanes_load(in + f * SM_LANES);
        if (!damping && c != w)
            for (int d = 0; d < 3; d++)
                sum[d] -= (real)(c - w) * lanes_load(in + (3 + d) * SM_LANES);
    }
}

/* The last stage down, along z, for one block of `plane`: 3 or 6 values. */
SM_INLINE void lsm_blocks_down(const Lsm *lsm, int plane, long block, bool damping, vec *sum)
{
#define WIDTH(w)                                                                                   \
    if (damping)                                                                                   \
        stage_z_down(lsm, plane, block, w, true, sum);                                             \
    else                                                                                           \
        stage_z_down(lsm, plane, block, w, false, sum);                                            \
    break
    switch (lsm->w) {
    case 1:
        WIDTH(1);
    case 2:
        WIDTH(2);
    case 5:
        WIDTH(5);
    default:
        WIDTH(lsm->w);
    }
#undef WIDTH
}

#endif
