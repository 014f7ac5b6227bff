#include <stdlib.h>
#include <string.h>

#include "../pipeline.h"
#include "blocks.h"

/* Any particle at the lanes of block `column` of row (y, z)? */
static bool occupied(const LsmLattice *l, int column, int y, int z)
{
    for (int lane = 0; lane < SM_LANES; lane++)
        if (lsm_lattice_find(l, column * SM_LANES + lane, y, z) >= 0) return true;
    return false;
}

static void add_block(Lsm *lsm, int column, int y, int z)
{
    long block = lsm->blocks++;
    for (int lane = 0; lane < SM_LANES; lane++) {
        long p = lsm_lattice_find(&lsm->lattice, column * SM_LANES + lane, y, z);
        lsm->particle[block * SM_LANES + lane] = (int)p;
        if (p < 0) continue;
        lsm->slot[p] = (int)(block * SM_LANES + lane);
    }
}

/* The next occupied column of a row from `column` on, or that behind the last. */
static int next_occupied(const Lsm *lsm, int column, int y, int z)
{
    int width = lsm->box->width;
    while (column < width && !occupied(&lsm->lattice, column, y, z)) column++;
    return column;
}

/* The end of the run of blocks of a row that begins at `column`. Empty blocks are part of it where
 * a window reaches across them. */
static int run_end(const Lsm *lsm, int column, int y, int z)
{
    for (;;) {
        while (column < lsm->box->width && occupied(&lsm->lattice, column, y, z)) column++;
        int next = next_occupied(lsm, column, y, z);
        if (next == lsm->box->width || (next - column) * SM_LANES >= lsm->w) return column;
        column = next;
    }
}

/* How many blocks the lattice has. */
static long count_blocks(const Lsm *lsm)
{
    const int *size = lsm->lattice.size, width = lsm->box->width;
    long blocks = 0;
    for (long row = 0; row < (long)size[1] * size[2]; row++) {
        int y = (int)(row % size[1]), z = (int)(row / size[1]);
        for (int column = next_occupied(lsm, 0, y, z), end; column < width;
             column = next_occupied(lsm, end, y, z)) {
            end = run_end(lsm, column, y, z);
            blocks += end - column;
        }
    }
    return blocks;
}

static void add_row(Lsm *lsm, Blocks *box, int y, int z, int *runs)
{
    for (int column = next_occupied(lsm, 0, y, z); column < box->width;
         column = next_occupied(lsm, column, y, z)) {
        int end = run_end(lsm, column, y, z);
        box->run[(*runs)++] =
            (BlockRun){.y = y, .column = column, .first = (int)lsm->blocks, .count = end - column};
        while (column < end) add_block(lsm, column++, y, z);
    }
}

static void add_rows(Lsm *lsm, Blocks *box)
{
    int runs = 0;
    for (int z = 0; z < lsm->lattice.size[2]; z++) {
        box->plane_run[z] = runs;
        lsm->layer_block[z] = lsm->blocks;
        for (int y = 0; y < lsm->lattice.size[1]; y++) {
            box->row_run[z * (long)lsm->lattice.size[1] + y] = runs;
            add_row(lsm, box, y, z, &runs);
        }
    }
    box->plane_run[lsm->lattice.size[2]] = runs;
    lsm->layer_block[lsm->lattice.size[2]] = lsm->blocks;
    box->row_run[lsm->lattice.size[1] * (long)lsm->lattice.size[2]] = runs;
    box->run = sm_realloc(box->run, (size_t)runs + 1, sizeof(BlockRun));
    box->run[runs] = (BlockRun){.first = (int)lsm->blocks};
}

/* In the last run that does not begin after it. */
int lsm_blocks_at(const Lsm *lsm, int column, int y, int z)
{
    const Blocks *box = lsm->box;
    if (z < 0 || z >= lsm->lattice.size[2]) return (int)lsm->blocks;
    int low = box->plane_run[z], high = box->plane_run[z + 1];
    while (low < high) {
        int middle = (low + high) / 2;
        const BlockRun *run = &box->run[middle];
        if (run->y < y || (run->y == y && run->column <= column))
            low = middle + 1;
        else
            high = middle;
    }
    if (low == box->plane_run[z]) return (int)lsm->blocks;
    const BlockRun *run = &box->run[low - 1];
    int i = column - run->column;
    return run->y == y && i < run->count ? run->first + i : (int)lsm->blocks;
}

static void find_neighbours(Lsm *lsm, Blocks *box)
{
    box->along_z = sm_alloc((size_t)lsm->blocks * (size_t)lsm->side, sizeof(int));
    int *along = box->along_z;
    for (int z = 0; z < lsm->lattice.size[2]; z++)
        for (int r = box->plane_run[z]; r < box->plane_run[z + 1]; r++)
            for (int i = 0; i < box->run[r].count; i++)
                for (int c = -lsm->w; c <= lsm->w; c++)
                    *along++ = lsm_blocks_at(lsm, box->run[r].column + i, box->run[r].y, z + c);
}

/* Do all blocks of a run have one in the row (or plane) before, whose windows they go on from? */
static void find_moves(const Lsm *lsm, Blocks *box)
{
    for (int z = 0; z < lsm->lattice.size[2]; z++)
        for (int r = box->plane_run[z]; r < box->plane_run[z + 1]; r++) {
            BlockRun *run = &box->run[r];
            run->moves_y = box->running && run->y % RESTART;
            run->moves_z = box->running && z % RESTART;
            for (int column = run->column; column < run->column + run->count; column++) {
                if (lsm_blocks_at(lsm, column, run->y - 1, z) == lsm->blocks) run->moves_y = false;
                if (lsm_blocks_at(lsm, column, run->y, z - 1) == lsm->blocks) run->moves_z = false;
            }
        }
}

static void find_places(const Lsm *lsm, Blocks *box)
{
    box->place = sm_alloc((size_t)lsm->blocks, sizeof(int));
    for (int r = 0; r < box->plane_run[lsm->lattice.size[2]]; r++) {
        const BlockRun *run = &box->run[r];
        for (int i = 0; i < run->count; i++)
            box->place[run->first + i] = run->y * box->width + run->column + i;
    }
}

/* A bitmap of what sums along z and y may pass through: sites whose blocks exist, but at w = 1
 * particles only (`masked` in boxes.c). */
static uint64_t *passable_sites(const Lsm *lsm)
{
    const LsmLattice *l = &lsm->lattice;
    size_t words = (size_t)l->size[1] * (size_t)l->size[2] * (size_t)l->words;
    uint64_t *bits = sm_alloc(words, sizeof *bits);
    if (lsm->w == 1) return memcpy(bits, l->bits, words * sizeof *bits);
    const uint64_t lanes = ((uint64_t)1 << SM_LANES) - 1;
    for (int z = 0; z < l->size[2]; z++)
        for (int r = lsm->box->plane_run[z]; r < lsm->box->plane_run[z + 1]; r++) {
            const BlockRun *run = &lsm->box->run[r];
            size_t at = ((size_t)z * (size_t)l->size[1] + (size_t)run->y) * (size_t)l->words;
            for (int x = run->column * SM_LANES; x < (run->column + run->count) * SM_LANES;
                 x += SM_LANES)
                bits[at + (size_t)(x >> 6)] |= lanes << (x & 63);
        }
    return bits;
}

void lsm_blocks_build(Lsm *lsm)
{
    const LsmLattice *l = &lsm->lattice;
    Blocks *box = lsm->box = sm_alloc(1, sizeof *box);
    int planes = l->size[2];
    const long cache = 2 << 20;
    box->width = (l->size[0] + SM_LANES - 1) / SM_LANES;
    long blocks = count_blocks(lsm);
    box->streams = blocks * SM_LANES * (long)(6 * sizeof(real) + 6 * sizeof(short)) > cache;
    box->plane_run = sm_alloc((size_t)planes + 1, sizeof(int));
    box->row_run = sm_alloc((size_t)l->size[1] * (size_t)planes + 1, sizeof(int));
    box->run = sm_alloc((size_t)blocks + 1, sizeof(BlockRun));
    lsm->listed = sm_alloc((size_t)blocks, sizeof(bool));
    box->mixed = sm_alloc((size_t)blocks, sizeof(bool));
    lsm->layers = planes;
    /* a window that moves from plane z - 1 to z also reads what it leaves, plane z - 1 - w */
    box->running = lsm->w >= RUNNING && lsm->params.summation == SM_SUM_FAST;
    lsm->reach = box->running ? lsm->w + 1 : lsm->w;
    lsm->chapter = box->running ? RESTART : 1;
    lsm->layer_plane = sm_alloc((size_t)planes + 1, sizeof(int));
    lsm->layer_block = sm_alloc((size_t)planes + 1, sizeof(long));
    lsm->slot = sm_alloc((size_t)l->count, sizeof(int));
    lsm->particle = sm_alloc((size_t)blocks * SM_LANES, sizeof(int));
    for (int z = 0; z <= planes; z++) lsm->layer_plane[z] = z;
    add_rows(lsm, box);
    find_neighbours(lsm, box);
    find_moves(lsm, box);
    find_places(lsm, box);
    box->passable = passable_sites(lsm);
}

/* The sites of a window's row that sums from or to its centre pass through: all of it, if at all.
 */
static uint64_t way(const Lsm *lsm, const int *at, int b, int c)
{
    uint64_t row =
        lsm_window(&lsm->lattice, lsm->box->passable, at[0], at[1] + b, at[2] + c, lsm->w);
    return row >> lsm->w & 1 ? row : 0;
}

/* Up, member i passes through (x_i, y_i, z_r) and (x_r, y_i, z_r); down, region r passes through
 * (x_r, y_i, z_r) and (x_i, y_i, z_r). Sites between must be summed at all. */
void lsm_blocks_taken(const Lsm *lsm, long p, uint64_t *up, uint64_t *down)
{
    const LsmLattice *l = &lsm->lattice;
    const int *at = l->coord[p];
    int w = lsm->w, side = lsm->side;
    for (int row = 0; row < side * side; row++) {
        int b = row % side - w, c = row / side - w;
        uint64_t box = lsm_window(l, l->bits, at[0], at[1] + b, at[2] + c, w);
        up[row] = box & way(lsm, at, b, 0);
        down[row] = box & way(lsm, at, 0, c);
    }
}

bool lsm_blocks_regular(const Lsm *lsm, long p, const uint64_t *rows)
{
    size_t size = (size_t)(lsm->side * lsm->side) * sizeof *rows;
    uint64_t up[LSM_MAX_SIDE * LSM_MAX_SIDE], down[LSM_MAX_SIDE * LSM_MAX_SIDE];
    lsm_blocks_taken(lsm, p, up, down);
    return !memcmp(up, rows, size) && !memcmp(down, rows, size);
}

/* Reals of scratch that one thread needs: see boxes.c. */
static size_t scratch_size(const Lsm *lsm)
{
    size_t width = (size_t)lsm->box->width, side = (size_t)lsm->side;
    return width * SM_LANES * (2 * (side + 1) * 12 + 3 * 12);
}

/* Reals of one thread's z windows, up and down. */
static size_t window_size(const Lsm *lsm)
{
    size_t places = (size_t)lsm->box->width * (size_t)lsm->lattice.size[1];
    return lsm->box->running ? places * SM_LANES * (12 + 6) : 0;
}

static void free_shared(Blocks *box)
{
    for (int t = 0; t < box->threads; t++) {
        free(box->scratch[t]);
        free(box->held[t]);
        free(box->window[t]);
    }
    free(box->scratch);
    free(box->held);
    free(box->window);
    free(box->down);
    free(box->down_memory);
}

/* A plane's store is free for another plane once phase 2 has passed `reach` planes on: in the
 * middle of a thread's share planes take turns; near its ends, where phase 2 waits for the other
 * thread, each has its own. */
void lsm_blocks_share(Lsm *lsm)
{
    Blocks *box = lsm->box;
    int planes = lsm->layers, turns = 2 * lsm->reach + 1;
    long most = 0, stores = 0;
    free_shared(box);
    box->threads = lsm->threads;
    int *store = sm_alloc((size_t)planes, sizeof(int));
    for (int z = 0; z < planes; z++) {
        long blocks = lsm->layer_block[z + 1] - lsm->layer_block[z];
        most = blocks > most ? blocks : most;
    }
    for (int t = 0; t < lsm->threads; t++) {
        int begin, end;
        lsm_pipeline_own(lsm, 2, t, &begin, &end);
        if (begin > 0) begin += lsm->reach;
        if (end < planes) end -= lsm->reach;
        long ring = stores;
        stores += turns;
        for (int z = lsm->thread_layer[t]; z < lsm->thread_layer[t + 1]; z++)
            store[z] = (int)(z < begin || z >= end ? stores++ : ring + z % turns);
    }
    box->down = sm_alloc((size_t)planes, sizeof *box->down);
    box->down_memory = sm_alloc((size_t)stores * (size_t)most * 6 * SM_LANES, sizeof(real));
    for (int z = 0; z < planes; z++)
        box->down[z] = box->down_memory + store[z] * most * 6 * SM_LANES;
    free(store);
    box->scratch = sm_alloc((size_t)lsm->threads, sizeof *box->scratch);
    box->held = sm_alloc((size_t)lsm->threads, sizeof *box->held);
    box->window = sm_alloc((size_t)lsm->threads, sizeof *box->window);
    for (int t = 0; t < lsm->threads; t++) {
        box->scratch[t] = sm_alloc(scratch_size(lsm), sizeof(real));
        box->held[t] = sm_alloc(2 * ((size_t)lsm->side + 1), sizeof(BlockRow));
        box->window[t] = sm_alloc(window_size(lsm), sizeof(real));
    }
    long own = (long)(scratch_size(lsm) + window_size(lsm));
    box->shared_bytes = (stores * most * 6 * SM_LANES + lsm->threads * own) * (long)sizeof(real);
}

long lsm_blocks_bytes(const Lsm *lsm)
{
    long a_block =
        (lsm->side + 1) * (long)sizeof(int) + (long)sizeof *lsm->live + 2 * (long)sizeof(bool);
    long rows = lsm->box->plane_run[lsm->layers] * (long)sizeof(BlockRun);
    const LsmLattice *l = &lsm->lattice;
    rows += (long)l->size[1] * l->size[2] * (l->words * (long)sizeof(uint64_t) + (long)sizeof(int));
    return lsm->blocks * a_block + rows + lsm->box->shared_bytes;
}

void lsm_blocks_free(Blocks *box)
{
    if (!box) return;
    free_shared(box);
    free(box->plane_run);
    free(box->row_run);
    free(box->run);
    free(box->place);
    free(box->along_z);
    free(box->passable);
    free(box->mixed);
    free(box);
}
