/* blocks_rows.h - the rows of a plane that a block pass (blocks_pass.h) works on: scratch of a
 * thread that stays in cache. */
#ifndef LSM_BLOCKS_ROWS_H
#define LSM_BLOCKS_ROWS_H

#include <string.h>

#include "boxes.h"

/* One body serves shape matching and damping. Values are numbered 3 k + d, d = 0..2 for x, y, z:
 * up, k counts (P, Pz, Px, Py) and down (Q, Rz, Rx, Ry) in the order in which the chain's stages
 * add and use them; damping sums four plain triples up and two down. */
enum { BLOCK = 12 * SM_LANES, BLOCK_DOWN = 6 * SM_LANES };

/* Which of a region's sums (C, A) or of its transform (q, R) value f is: match.h. */
SM_INLINE int chain_value(int f)
{
    return f < 3 ? f : 3 + f % 3 * 3 + (f / 3 + 1) % 3;
}

/* Asks for x or v of the block AHEAD of `block`. */
enum { AHEAD = 8 };
SM_INLINE void prefetch_ahead(const Lsm *lsm, const real *of, long block)
{
    long ahead = block + AHEAD < lsm->blocks ? block + AHEAD : lsm->blocks;
    for (int d = 0; d < 3; d++) __builtin_prefetch(of + (ahead * 3 + d) * SM_LANES);
}

/* Scratch of a thread. Rings hold the last 2 w + 2 rows of a plane, each [width][BLOCK]. */
typedef struct {
    long pitch;      /* values in a row */
    int ring;        /* rows in a ring */
    real *above;     /* [ring] rows after the stages up along z and x */
    real *below;     /* [ring] rows after `solve` */
    BlockRow *held;  /* [2][ring] whose blocks the rows hold: elsewhere they are zero */
    real *window[2]; /* up, down: each column's window of the y stage, [BLOCK] */
    real *line;      /* a row of one run */
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
    s.line = s.window[1] + s.pitch;
    s.plane = lsm->box->window[thread];
    s.held = lsm->box->held[thread];
    return s;
}

SM_INLINE bool run_has(const BlockRun *run, int column)
{
    return column >= run->column && column < run->column + run->count;
}

static __attribute__((noinline)) void clear_row(real *row, BlockRow held, BlockRow now)
{
    for (int i = 0; i < held.runs; i++)
        for (int c = held.run[i].column; c < held.run[i].column + held.run[i].count; c++) {
            bool kept = false;
            for (int j = 0; j < now.runs; j++) kept |= run_has(now.run + j, c);
            if (!kept) memset(row + c * (long)BLOCK, 0, BLOCK * sizeof(real));
        }
}

/* The row in a slot of the ring `above` (way 0) or `below`, for the blocks of `now`, and zero where
 * it has none. */
SM_INLINE real *row_for(const Scratch *s, int way, int slot, BlockRow now)
{
    real *row = (way ? s->below : s->above) + slot * s->pitch;
    BlockRow *held = s->held + way * s->ring + slot;
    bool covered = held->runs == 1 && now.runs == 1 && run_has(now.run, held->run->column) &&
                   run_has(now.run, held->run->column + held->run->count - 1);
    if (!covered) clear_row(row, *held, now);
    *held = now;
    return row;
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
    const real *ring = way ? s->below : s->above;
    long end = s->ring * s->pitch, at = slot * s->pitch;
    for (int b = 0; b < 2 * w + 2; b++) {
        at += s->pitch;
        at = at == end ? 0 : at;
        around.row[b] = ring + at;
    }
    return around;
}

SM_INLINE BlockRow row_at(const Lsm *lsm, int plane, int y)
{
    const Blocks *box = lsm->box;
    if (y < 0 || y >= lsm->lattice.size[1]) return (BlockRow){NULL, 0};
    const int *first = box->row_run + plane * (long)lsm->lattice.size[1] + y;
    return (BlockRow){box->run + first[0], first[1] - first[0]};
}

#endif
