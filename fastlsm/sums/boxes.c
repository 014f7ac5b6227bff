/* boxes.c - sums over regions in block form: box sums over SM_LANES lattice sites at a time.
 *
 * As sums.h says, but bars, plates and cubes are taken over every site of the box
 * around a region's centre: first along z, then x, then y on the way up, and back in the order y,
 * x, z on the way down, so that all but the last stage happens within a plane, in rows that stay in
 * the L1 cache. From w = RUNNING on, sums along y and z are windows that move: O(1). They are
 * summed anew at every RESTART-th row and plane, or rounding would add up. Along x
 * lanes slide, and from w = FAR on prefixes are subtracted. Empty sites hold zero. A region whose
 * box sum is not its exact sum (a gap, a corner, a broken link within its box) is summed by its
 * lists instead, lane by lane. */
#include "blocks.h"

#include <string.h>

#include "../../lib/simd/rigid_lanes.h"
#include "lists.h"
#include "prefix_sums.h"
#include "window.h"

/* One body serves shape matching and damping. Values are numbered 3 k + d, d = 0..2 for x, y, z:
 * up, k counts (P, Pz, Px, Py) and down (Q, Rz, Rx, Ry) in the order in which the stages of the
 * sums add and use them; damping sums four plain triples up and two down. */
enum { BLOCK = TILE_DOWN, BLOCK_DOWN = 6 * SM_LANES };

/* Asks for x or v of the block AHEAD of `block`. */
enum { AHEAD = 8 };
SM_INLINE void prefetch_ahead(const Lsm *lsm, const real *of, long block)
{
    long ahead = block + AHEAD < lsm->blocks ? block + AHEAD : lsm->blocks;
    for (int d = 0; d < 3; d++) __builtin_prefetch(of + (ahead * 3 + d) * SM_LANES);
}

/* Scratch of a thread. Rings hold the last 2 w + 2 rows of a plane, each [width][BLOCK]. */
typedef struct {
    long pitch;         /* values in a row */
    int ring;           /* rows in a ring */
    real *above;        /* [ring] rows after the stages up along z and x */
    real *below;        /* [ring] rows after `solve` */
    BlockRow *held;     /* [2][ring] whose blocks the rows hold: elsewhere they are zero */
    real *window[2];    /* up, down: each column's window of the y stage, [BLOCK] */
    real *line;         /* a row of one run */
    Prefixes *prefixes; /* along x, of one value of a run */
    real *plane;        /* up: each place's window of the z stage, [BLOCK] */
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
    s.prefixes = (Prefixes *)(s.line + s.pitch);
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

/* 16 in place of 32. */
enum { FEW_REGISTERS = SM_VECTOR_BYTES < 64 };

/* From this width on. */
enum { FAR = SM_LANES >= 8 ? 8 : 5 };

/* The sums along x of `values` values of a run, in place, and their moments as prefix_sums_far()
 * has them. */
static __attribute__((noinline)) void far_sums(Prefixes *at, int w, real *value, int values,
                                               int count)
{
    for (int f = 0; f < values; f++, value += SM_LANES)
        if (w <= SM_LANES)
            prefix_sums_near(w, value, count, BLOCK, 0);
        else
            prefix_sums_far(at, w, value, count, BLOCK, 0);
}

static __attribute__((noinline)) void far_moments(Prefixes *at, int w, real *value, int count,
                                                  long moment)
{
    for (int d = 0; d < 3; d++, value += SM_LANES)
        if (w <= SM_LANES)
            prefix_sums_near(w, value, count, BLOCK, moment);
        else
            prefix_sums_far(at, w, value, count, BLOCK, moment);
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
    if (w >= RUNNING && (moving || in->running)) {
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
    if (w >= RUNNING && (moving || in->running)) {
        lanes_store(in->window + at, sum);
        lanes_store(in->window + weighed, rest);
    }
    return sum;
}

/* Where sums pass through particles only, those of other sites are dropped. */
SM_INLINE vec through(const Lsm *lsm, long block, int w, vec sum)
{
    return w > 1 ? sum : lanes_keep(lsm->live[block], sum);
}

/* What the z stage up sums of a block: value d of m~ x, or of damping's four triples. */
SM_INLINE void source(const Lsm *lsm, long block, bool plain, int d, vec out[4])
{
    vec weight = lsm->particle_const[lsm->block_const[block]].weight;
    const real *x = lsm->x + block * 3 * SM_LANES;
    if (plain) {
        damping_products(weight, x, lsm->v + block * 3 * SM_LANES, d, out);
        return;
    }
    out[0] = lanes_rounded(weight * lanes_load(x + d * SM_LANES));
}

/* The window of the z stage up of a block, from the one in `kept` of the block in the plane before.
 */
SM_INLINE void move_z_up(const Lsm *lsm, long block, int w, bool plain, int d, const real *kept,
                         vec sum[4])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    const int *along_before = lsm->box->along_z + along[w - 1] * (long)(2 * w + 1);
    vec leave[4], enter[4];
    source(lsm, along_before[0], plain, d, leave);
    source(lsm, along[2 * w], plain, d, enter);
    for (int k = 0; k < (plain ? 4 : 2); k++) sum[k] = lanes_load(kept + (3 * k + d) * SM_LANES);
    if (plain)
        for (int k = 0; k < 4; k++) window_move(leave[k], enter[k], w, &sum[k], NULL);
    else
        window_move(leave[0], enter[0], w, &sum[0], &sum[1]);
}

SM_INLINE void sum_z_up(const Lsm *lsm, long block, int w, bool plain, int d, vec sum[4])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    vec p[4];
    source(lsm, along[w], plain, d, sum);
    if (!plain) sum[1] = lanes_set(0);
    for (int c = 0; c <= 2 * w; c++) {
        if (c == w) continue;
        source(lsm, along[c], plain, d, p);
        for (int k = 0; k < (plain ? 4 : 1); k++) sum[k] += p[k];
        if (!plain) sum[1] += (real)(c - w) * p[0];
    }
}

/* The stage up along z for values 3 k + d of a block: 1 -> 2 of them, of damping 4. `kept` is its
 * place's window. */
SM_INLINE void stage_z_up(const Lsm *lsm, long block, int w, bool plain, bool moving, int d,
                          real *kept, vec sum[4])
{
    int n = plain ? 4 : 2;
    if (moving)
        move_z_up(lsm, block, w, plain, d, kept, sum);
    else
        sum_z_up(lsm, block, w, plain, d, sum);
    for (int k = 0; k < n && w >= RUNNING && (moving || lsm->box->running); k++)
        lanes_store(kept + (3 * k + d) * SM_LANES, sum[k]);
    for (int k = 0; k < n; k++) sum[k] = through(lsm, block, w, sum[k]);
}

/* The stages up along z and x for values 3 k + d of a run, d = first .. first + count - 1, into a
 * row of the ring `above`: 1 -> 2 -> 3 values of each d. `kept` are its windows. */
SM_INLINE void run_up(const Lsm *lsm, const BlockRun *run, int w, bool plain, bool moving,
                      int first, int count, real *kept, real *row)
{
    int n = plain ? 4 : 2, last = run->first + run->count - 1;
    real *out = row + run->column * (long)BLOCK + first * SM_LANES;
    vec before[3][4], here[3][4], after[3][4], moment = lanes_set(0);
    for (int d = 0; d < count; d++) {
        stage_z_up(lsm, run->first, w, plain, moving, first + d, kept, here[d]);
        for (int k = 0; k < n; k++) before[d][k] = after[d][k] = lanes_set(0);
    }
    for (int block = run->first; block <= last; block++, out += BLOCK) {
        if (w >= RUNNING) kept += BLOCK;
        for (int d = 0; d < count; d++) {
            if (block < last)
                stage_z_up(lsm, block + 1, w, plain, moving, first + d, kept, after[d]);
            else
                for (int k = 0; k < n; k++) after[d][k] = lanes_set(0);
            for (int k = 0; k < n; k++) {
                vec sum = window_sum_x(before[d][k], here[d][k], after[d][k], w,
                                       k || plain ? NULL : &moment);
                lanes_store(out + (3 * k + d) * SM_LANES, through(lsm, block, w, sum));
                before[d][k] = here[d][k];
                here[d][k] = after[d][k];
            }
            if (!plain) lanes_store(out + (6 + d) * SM_LANES, through(lsm, block, w, moment));
        }
    }
}

/* The same where w >= FAR, for all d. */
SM_INLINE void run_up_far(const Lsm *lsm, const BlockRun *run, int w, bool plain, bool moving,
                          real *kept, Prefixes *at, real *row)
{
    int n = plain ? 4 : 2;
    real *first = row + run->column * (long)BLOCK;
    for (int i = 0; i < run->count; i++)
        for (int d = 0; d < 3; d++) {
            vec sum[4];
            stage_z_up(lsm, run->first + i, w, plain, moving, d, kept + i * (long)BLOCK, sum);
            for (int k = 0; k < n; k++)
                lanes_store(first + i * (long)BLOCK + (3 * k + d) * SM_LANES, sum[k]);
        }
    int summed = plain ? 0 : 3;
    if (!plain) far_moments(at, w, first, run->count, 6 * SM_LANES);
    far_sums(at, w, first + summed * SM_LANES, 3 * n - summed, run->count);
}

SM_INLINE void run_up_all(const Lsm *lsm, const BlockRun *run, int w, bool plain, bool moving,
                          real *kept, Prefixes *at, real *row)
{
    if (w >= FAR && lsm->box->running) {
        run_up_far(lsm, run, w, plain, moving, kept, at, row);
        return;
    }
    if (plain || FEW_REGISTERS) /* in turn: all at once would not fit into registers */
        for (int d = 0; d < 3; d++) run_up(lsm, run, w, plain, moving, d, 1, kept, row);
    else
        run_up(lsm, run, w, false, moving, 0, 3, kept, row);
}

/* Asks for what comes from far: the newest plane that the z stage reads; and constants of regions,
 * of which those that differ have their own: they are there when the row is solved. */
SM_INLINE void prefetch_run(const Lsm *lsm, const BlockRun *run, int w, bool plain)
{
    for (int block = run->first; block < run->first + run->count; block++) {
        if (lsm->box->streams) {
            int newest = lsm->box->along_z[block * (long)(2 * w + 1) + 2 * w];
            prefetch_ahead(lsm, lsm->x, newest);
            if (plain) prefetch_ahead(lsm, lsm->v, newest);
        }
        const RegionConst *k = lsm->region_const + lsm->tile_const[block];
        __builtin_prefetch(&k->inverse_mass);
        for (int d = 0; d < 3 && !plain; d++) __builtin_prefetch(&k->offset[d]);
    }
}

/* Rows have zeros where they have no blocks. */
SM_INLINE void row_up(const Lsm *lsm, const Scratch *s, BlockRow at, int slot, int w, bool plain)
{
    real *row = row_for(s, 0, slot, at);
    for (int i = 0; i < at.runs; i++) {
        const BlockRun *run = at.run + i;
        real *kept = w >= RUNNING ? s->plane + run->y * s->pitch + run->column * (long)BLOCK : NULL;
        prefetch_run(lsm, run, w, plain);
        if (w >= RUNNING && run->moves_z)
            run_up_all(lsm, run, w, plain, true, kept, s->prefixes, row);
        else
            run_up_all(lsm, run, w, plain, false, kept, s->prefixes, row);
    }
}

/* The sums of a block's regions where they have lists. */
static __attribute__((noinline)) void listed_regions(const Lsm *lsm, const Rows *rows, long block,
                                                     bool plain, vec *sum)
{
    const int *region = lsm->block_region + block * SM_LANES;
    vec listed[12];
    lsm_list_kernels_regions(lsm, rows, region, plain, listed);
    ivec lanes = listed_lanes(region);
    for (int i = 0; i < 12; i++) sum[i] = lanes_select(lanes, listed[i], sum[i]);
}

/* The stage up along y for a column: 9 -> 12 values, of damping 12. */
SM_INLINE void stage_y_up(const Around *in, long column, int w, bool plain, bool moving,
                          vec sum[12])
{
#pragma GCC unroll 12
    for (int f = 3; f < 12; f++)
        if (plain || f < 9)
            sum[plain ? f : stage_value(f)] = window_y(in, column, w, moving, f, 0, NULL);
#pragma GCC unroll 3
    for (int d = 0; d < 3; d++) {
        vec moment = lanes_set(0);
        sum[d] = window_y(in, column, w, moving, d, 9 + d, plain ? NULL : &moment);
        if (!plain) sum[stage_value(9 + d)] = moment;
    }
}

/* The stage up along y, and `solve` for a group of blocks of a row, into the ring `below`. */
SM_INLINE void solve_group(Lsm *lsm, const Rows *rows, const Around *in, const BlockRun *run, int i,
                           int blocks, int layer, int w, bool plain, bool moving, real *row,
                           SmLaps *laps)
{
    vec sums[POLAR_TILES][12];
    for (int k = 0; k < blocks; k++) stage_y_up(in, run->column + i + k, w, plain, moving, sums[k]);
    long block = run->first + i;
    real *down = row + (run->column + i) * (long)BLOCK;
    for (int k = 0; k < blocks; k++)
        if (lsm->box->mixed[block + k]) listed_regions(lsm, rows, block + k, plain, sums[k]);
    lsm_solve(lsm, plain, layer, block, blocks, sums, down, laps);
    for (int k = 0; k < blocks; k++)
        if (lsm->listed[block + k])
            lsm_lists_keep_down(lsm, rows, block + k, down + k * (long)BLOCK);
    lsm_solved(plain, laps);
}

SM_INLINE void run_solve(Lsm *lsm, const Rows *rows, const Around *in, const BlockRun *run,
                         int layer, int w, bool plain, bool moving, real *row, SmLaps *laps)
{
    int most = plain ? 1 : POLAR_TILES; /* matching alone gains from several at once */
    for (int i = 0, blocks; i < run->count; i += blocks) {
        int left = run->count - i;
        blocks = left < most ? left : most;
        if (most > 1 && left == most + 1) blocks--; /* no block is left for a group of its own */
        solve_group(lsm, rows, in, run, i, blocks, layer, w, plain, moving, row, laps);
    }
}

/* The stage up along y and `solve` for the row whose row y + w is in slot `newest` of the ring
 * `above`, into `slot` of the ring `below`. */
SM_INLINE void row_solve(Lsm *lsm, const Rows *rows, const Scratch *s, BlockRow at, int newest,
                         int slot, int layer, int w, bool plain, SmLaps *laps)
{
    real *row = row_for(s, 1, slot, at);
    Around in = rows_around(lsm, s, 0, newest, w);
    for (int i = 0; i < at.runs; i++) {
        if (w >= RUNNING && at.run[i].moves_y)
            run_solve(lsm, rows, &in, at.run + i, layer, w, plain, true, row, laps);
        else
            run_solve(lsm, rows, &in, at.run + i, layer, w, plain, false, row, laps);
    }
}

/* The stage down along y for values 3 k + d of a block: 4 -> 3 of them, of damping 2. */
SM_INLINE void stage_y_down(const Lsm *lsm, const Around *in, const BlockRun *run, int i, int w,
                            bool plain, bool moving, int d, vec out[3])
{
    int n = plain ? 2 : 3;
    long column = run->column + i;
    out[0] = plain ? window_y(in, column, w, moving, d, 0, NULL)
                   : window_y_less(in, column, w, moving, d, 9 + d);
    for (int k = 1; k < n; k++) out[k] = window_y(in, column, w, moving, 3 * k + d, 0, NULL);
    for (int k = 0; k < n; k++) out[k] = through(lsm, run->first + i, w, out[k]);
}

/* The stages down along y and x for values 3 k + d of a run, d = first .. first + count - 1: 4 -> 3
 * -> 2 of them, into the plane's store. */
SM_INLINE void run_down(const Lsm *lsm, const Around *in, const BlockRun *run, int w, bool plain,
                        bool moving, int first, int count, real *out)
{
    int n = plain ? 2 : 3;
    vec before[3][3], here[3][3], after[3][3], sum[3], moment = lanes_set(0);
    for (int d = 0; d < count; d++) {
        for (int k = 0; k < n; k++) before[d][k] = lanes_set(0);
        stage_y_down(lsm, in, run, 0, w, plain, moving, first + d, here[d]);
    }
    for (int i = 0; i < run->count; i++, out += BLOCK_DOWN)
        for (int d = 0; d < count; d++) {
            if (i + 1 < run->count)
                stage_y_down(lsm, in, run, i + 1, w, plain, moving, first + d, after[d]);
            else
                for (int k = 0; k < n; k++) after[d][k] = lanes_set(0);
            for (int k = 0; k < n; k++) {
                sum[k] =
                    window_sum_x(before[d][k], here[d][k], after[d][k], w, k == 2 ? &moment : NULL);
                before[d][k] = here[d][k];
                here[d][k] = after[d][k];
            }
            if (!plain) sum[0] -= moment;
            for (int k = 0; k < 2; k++)
                lanes_store(out + (3 * k + first + d) * SM_LANES,
                            through(lsm, run->first + i, w, sum[k]));
        }
}

/* The same where w >= FAR, for all d; `line` is room for a row. */
SM_INLINE void run_down_far(const Lsm *lsm, const Around *in, const BlockRun *run, int w,
                            bool plain, bool moving, real *line, Prefixes *at, real *out)
{
    int n = plain ? 2 : 3;
    for (int i = 0; i < run->count; i++)
        for (int d = 0; d < 3; d++) {
            vec sum[3];
            stage_y_down(lsm, in, run, i, w, plain, moving, d, sum);
            for (int k = 0; k < n; k++)
                lanes_store(line + i * (long)BLOCK + (3 * k + d) * SM_LANES, sum[k]);
        }
    far_sums(at, w, line, 6, run->count);
    if (!plain) far_moments(at, w, line + 6 * SM_LANES, run->count, 3 * SM_LANES);
    for (int i = 0; i < run->count; i++, line += BLOCK, out += BLOCK_DOWN)
        for (int f = 0; f < 6; f++) {
            vec sum = lanes_load(line + f * SM_LANES);
            if (!plain && f < 3) sum -= lanes_load(line + (9 + f) * SM_LANES);
            lanes_store(out + f * SM_LANES, sum);
        }
}

/* The stages down along y and x for the row whose row y + w is in slot `newest` of `below`. */
SM_INLINE void row_down(const Lsm *lsm, const Scratch *s, BlockRow at, int newest, int plane, int w,
                        bool plain)
{
    Around in = rows_around(lsm, s, 1, newest, w);
    for (int i = 0; i < at.runs; i++) {
        const BlockRun *run = at.run + i;
        real *out = lsm->box->down[plane] + (run->first - lsm->layer_block[plane]) * BLOCK_DOWN;
        if (w >= FAR && in.running) {
            if (run->moves_y)
                run_down_far(lsm, &in, run, w, plain, true, s->line, s->prefixes, out);
            else
                run_down_far(lsm, &in, run, w, plain, false, s->line, s->prefixes, out);
            continue;
        }
        if (w < RUNNING && !FEW_REGISTERS)
            run_down(lsm, &in, run, w, plain, false, 0, 3, out);
        else
            for (int d = 0; d < 3; d++) {
                if (w >= RUNNING && run->moves_y)
                    run_down(lsm, &in, run, w, plain, true, d, 1, out);
                else
                    run_down(lsm, &in, run, w, plain, false, d, 1, out);
            }
    }
}

/* A plane's rows as a pipeline: row y goes up along z and x when row y - w is solved, and row
 * y - 2w comes down along y and x. */
SM_INLINE void plane_pass(Lsm *lsm, int plane, int thread, int w, bool plain, SmLaps *laps)
{
    const Blocks *box = lsm->box;
    int begin = box->plane_run[plane], end = box->plane_run[plane + 1];
    if (begin == end) return;
    Scratch s = scratch_of(lsm, thread);
    Rows rows = lsm_rows_of(lsm, plane, thread);
    int first = box->run[begin].y, last = box->run[end - 1].y;
    SmStage stage = lsm->pass->stage;
    for (int slot = s.ring - w; slot < s.ring; slot++) /* above `first` */
        row_for(&s, 0, slot, (BlockRow){NULL, 0});
    for (int y = first, slot = 0; y <= last + 2 * w; y++) {
        int behind = slot < w ? slot - w + s.ring : slot - w; /* of row y - w */
        row_up(lsm, &s, row_at(lsm, plane, y), slot, w, plain);
        sm_lap(laps, stage);
        row_solve(lsm, &rows, &s, row_at(lsm, plane, y - w), slot, behind, plane, w, plain, laps);
        row_down(lsm, &s, row_at(lsm, plane, y - 2 * w), behind, plane, w, plain);
        sm_lap(laps, stage);
        slot = slot + 1 == s.ring ? 0 : slot + 1;
    }
}

/* Where phase 1 has left the sums down along y and x of planes plane - w - 1 .. plane + w, and
 * their first blocks. */
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

SM_INLINE void sum_z_down(const Lsm *lsm, const Downs *downs, long block, int w, bool plain,
                          vec sum[6])
{
    const int *along = lsm->box->along_z + block * (2 * w + 1);
    for (int f = 0; f < 6; f++) sum[f] = lanes_set(0);
    for (int c = 0; c <= 2 * w; c++) {
        const real *in = down_at(lsm, downs, c + 1, along[c]);
        for (int f = 0; f < 6; f++) {
            if (f < 3 || plain || w >= RUNNING) sum[f] += lanes_load(in + f * SM_LANES);
            if (f >= 3 && !plain && c != w)
                sum[f - 3] -= (real)(c - w) * lanes_load(in + f * SM_LANES);
        }
    }
}

/* The same from the window of the block in the plane before. */
SM_INLINE void move_z_down(const Lsm *lsm, const Downs *downs, long block, int w, bool plain,
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
        if (plain)
            for (int k = 0; k < 2; k++) window_move(out[k], join[k], w, &sum[3 * k + d], NULL);
        else
            window_less_move(out, join, w, &sum[d], &sum[3 + d]);
    }
}

/* The last stage down, along z, for one block of `plane`: 3 or 6 values. */
SM_INLINE void stage_z_down(const Lsm *lsm, const Downs *downs, long block, bool moving, int thread,
                            int w, bool plain, vec sum[6])
{
    if (w < RUNNING || !lsm->box->running) {
        sum_z_down(lsm, downs, block, w, plain, sum);
        return;
    }
    real *kept = lsm->box->window[thread] + lsm->box->width * (long)lsm->lattice.size[1] * BLOCK +
                 lsm->box->place[block] * (long)BLOCK_DOWN;
    if (moving) {
        for (int f = 0; f < 6; f++) sum[f] = lanes_load(kept + f * SM_LANES);
        move_z_down(lsm, downs, block, w, plain, sum);
    } else {
        sum_z_down(lsm, downs, block, w, plain, sum);
    }
    for (int f = 0; f < 6; f++) lanes_store(kept + f * SM_LANES, sum[f]);
}

/* The stage down along z for the blocks of a plane, and the end of the pass. */
SM_INLINE void plane_end(Lsm *lsm, int plane, int thread, int w, bool plain, SmLaps *laps)
{
    const Blocks *box = lsm->box;
    Downs downs = downs_around(lsm, plane, w);
    Rows rows = lsm_rows_of(lsm, plane, thread);
    for (int r = box->plane_run[plane]; r < box->plane_run[plane + 1]; r++) {
        const BlockRun *run = &box->run[r];
        for (int i = 0; i < run->count; i += POLAR_TILES) {
            vec sum[POLAR_TILES][6];
            long block = run->first + i;
            int blocks = run->count - i < POLAR_TILES ? run->count - i : POLAR_TILES;
            for (int k = 0; k < blocks; k++) {
                if (!plain && box->streams) prefetch_ahead(lsm, lsm->v, block + k);
                vec here[6]; /* in registers, which `sum` cannot be */
                stage_z_down(lsm, &downs, block + k, run->moves_z, thread, w, plain, here);
                lanes_copy(plain ? 6 : 3, here, sum[k]);
                if (box->mixed[block + k])
                    lsm_list_kernels.block(lsm, &rows, block + k, plain, sum[k]);
            }
            lsm_end(lsm, plain, block, blocks, sum, laps);
        }
    }
}

/* Each of the usual widths has functions of its own: in one together the compiler runs out of
 * registers. */
#define AT_WIDTH(name, width, plain, stages)                                                       \
    static __attribute__((noinline)) void name(Lsm *lsm, int plane, int thread, SmLaps *laps)      \
    {                                                                                              \
        stages(lsm, plane, thread, width, plain, laps);                                            \
    }
#define FROM_WIDTH_1(name, plain, stages)                                                          \
    AT_WIDTH(name##_any, lsm->w, plain, stages)                                                    \
    AT_WIDTH(name##_1, 1, plain, stages)                                                           \
    AT_WIDTH(name##_2, 2, plain, stages)

FROM_WIDTH_1(end_moments, false, plane_end)
FROM_WIDTH_1(end_plain, true, plane_end)
#define TO_WIDTH_7(name, plain, stages)                                                            \
    FROM_WIDTH_1(name, plain, stages)                                                              \
    AT_WIDTH(name##_3, 3, plain, stages)                                                           \
    AT_WIDTH(name##_4, 4, plain, stages)                                                           \
    AT_WIDTH(name##_5, 5, plain, stages)                                                           \
    AT_WIDTH(name##_6, 6, plain, stages)                                                           \
    AT_WIDTH(name##_7, 7, plain, stages)
TO_WIDTH_7(solve_moments, false, plane_pass)
TO_WIDTH_7(solve_plain, true, plane_pass)
#define SOLVE(name)                                                                                \
    {                                                                                              \
        name##_any, name##_1, name##_2, name##_3, name##_4, name##_5, name##_6, name##_7           \
    }
enum { WIDTHS = 8 };

static void solve(Lsm *lsm, int plane, int thread, SmLaps *laps)
{
    static LsmPhase *const by_width[2][WIDTHS] = {SOLVE(solve_moments), SOLVE(solve_plain)};
    by_width[lsm->pass->plain][lsm->w < WIDTHS ? lsm->w : 0](lsm, plane, thread, laps);
    Rows rows = lsm_rows_of(lsm, plane, thread);
    lsm_list_kernels.subsums(lsm, &rows, plane, 1, lsm->pass->plain);
    sm_lap(laps, lsm->pass->stage);
}

static void end(Lsm *lsm, int plane, int thread, SmLaps *laps)
{
    static LsmPhase *const by_width[2][3] = {{end_moments_any, end_moments_1, end_moments_2},
                                             {end_plain_any, end_plain_1, end_plain_2}};
    by_width[lsm->pass->plain][lsm->w < 3 ? lsm->w : 0](lsm, plane, thread, laps);
    sm_lap(laps, lsm->pass->stage);
}

static bool applies(const Lsm *lsm)
{
    return lsm->params.layout == SM_LAYOUT_BLOCKS;
}

const LsmSums lsm_sums_boxes = {
    .name = "boxes",
    .applies = applies,
    .lay_out = lsm_blocks_build,
    .share = lsm_blocks_share,
    .phase = {lsm_lists_subsums, solve, end},
    .lists = &lsm_list_kernels,
};
