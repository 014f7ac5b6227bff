#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../pipeline.h"
#include "blocks.h"
#include "prefix_sums.h"

/* The lanes of block `column` of row (y, z) with a particle, as bits. */
static uint64_t occupied(const LsmLattice *l, int column, long row)
{
    const uint64_t lanes = ((uint64_t)1 << SM_LANES) - 1;
    int x = column * SM_LANES;
    return l->bits[row * l->words + (x >> 6)] >> (x & 63) & lanes;
}

static void fill_block(Lsm *lsm, long block, int column, long row)
{
    const LsmLattice *l = &lsm->lattice;
    int x = column * SM_LANES, *particle = lsm->particle + block * SM_LANES;
    uint64_t there = occupied(l, column, row),
             before = l->bits[row * l->words + (x >> 6)] & (((uint64_t)1 << (x & 63)) - 1);
    long p = l->rank[row * l->words + (x >> 6)] + (long)sm_count_bits(before);
    for (int lane = 0; lane < SM_LANES; lane++) {
        particle[lane] = there >> lane & 1 ? (int)p : -1;
        if (there >> lane & 1) lsm->slot[p++] = (int)(block * SM_LANES + lane);
    }
}

/* The next occupied column of a row from `column` on, or that behind the last. */
static int next_occupied(const Lsm *lsm, int column, long row)
{
    int width = lsm->box->width;
    while (column < width && !occupied(&lsm->lattice, column, row)) column++;
    return column;
}

/* The end of the run of blocks of a row that begins at `column`. Empty blocks are part of it where
 * a window reaches across them. */
static int run_end(const Lsm *lsm, int column, long row)
{
    for (;;) {
        while (column < lsm->box->width && occupied(&lsm->lattice, column, row)) column++;
        int next = next_occupied(lsm, column, row);
        if (next == lsm->box->width || (next - column) * SM_LANES >= lsm->w) return column;
        column = next;
    }
}

/* Counts the runs of a row and their blocks, on from *runs and *blocks, and lists them in `run`
 * unless that is NULL. */
static void add_row(const Lsm *lsm, long row, int *runs, long *blocks, BlockRun *run)
{
    for (int column = next_occupied(lsm, 0, row), end; column < lsm->box->width;
         column = next_occupied(lsm, end, row)) {
        end = run_end(lsm, column, row);
        if (run)
            run[*runs] = (BlockRun){.y = (int)(row % lsm->lattice.size[1]),
                                    .column = column,
                                    .first = (int)*blocks,
                                    .count = end - column};
        *blocks += end - column;
        ++*runs;
    }
}

/* The first run of each row and the first block of each plane; how many there are behind. */
static void count_blocks(Lsm *lsm, Blocks *box)
{
    int ny = lsm->lattice.size[1], planes = lsm->lattice.size[2], runs = 0;
    long blocks = 0;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lsm->lattice.count))
    for (int z = 0; z < planes; z++)
        for (long row = z * (long)ny; row < (z + 1) * (long)ny; row++)
            add_row(lsm, row, &box->row_run[row], &lsm->layer_block[z], NULL);
    for (int z = 0; z <= planes; z++) {
        long own = lsm->layer_block[z];
        lsm->layer_block[z] = blocks;
        blocks += own;
        box->plane_run[z] = runs;
        for (long row = z * (long)ny; row < (z + 1) * (long)ny && z < planes; row++) {
            int own_runs = box->row_run[row];
            box->row_run[row] = runs;
            runs += own_runs;
        }
    }
    box->row_run[ny * (long)planes] = runs;
    lsm->blocks = blocks;
}

static void fill_blocks(Lsm *lsm, Blocks *box)
{
    int ny = lsm->lattice.size[1], planes = lsm->lattice.size[2];
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lsm->lattice.count))
    for (int z = 0; z < planes; z++) {
        long block = lsm->layer_block[z];
        for (long row = z * (long)ny; row < (z + 1) * (long)ny; row++) {
            int runs = box->row_run[row];
            add_row(lsm, row, &runs, &block, box->run);
            for (int r = box->row_run[row]; r < runs; r++)
                for (int i = 0; i < box->run[r].count; i++)
                    fill_block(lsm, box->run[r].first + i, box->run[r].column + i, row);
        }
    }
    box->run[box->plane_run[planes]] = (BlockRun){.first = (int)lsm->blocks};
}

/* The block of `column` in row y of plane z, or the empty block: of the last run of the row that
 * does not begin after it. */
static int block_at(const Lsm *lsm, int column, int y, int z)
{
    const Blocks *box = lsm->box;
    const int *size = lsm->lattice.size;
    if (y < 0 || z < 0 || y >= size[1] || z >= size[2]) return (int)lsm->blocks;
    const int *row = box->row_run + z * (long)size[1] + y;
    int low = row[0], high = row[1];
    while (low < high) {
        int middle = (low + high) / 2;
        if (box->run[middle].column <= column)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == row[0]) return (int)lsm->blocks;
    const BlockRun *run = &box->run[low - 1];
    int i = column - run->column;
    return i < run->count ? run->first + i : (int)lsm->blocks;
}

/* Of the blocks of a run: those at their places in other planes, and whether all have one in the
 * row (or plane) before, whose windows they go on from. */
static void find_neighbours(const Lsm *lsm, Blocks *box, int z, BlockRun *run)
{
    int none = (int)lsm->blocks, w = lsm->w;
    run->moves_y = box->running && run->y % RESTART;
    run->moves_z = box->running && z % RESTART;
    for (int i = 0; i < run->count; i++) {
        int column = run->column + i, *along = box->along_z + (run->first + i) * (long)lsm->side;
        for (int c = -w; c <= w; c++) along[c + w] = block_at(lsm, column, run->y, z + c);
        box->place[run->first + i] = run->y * box->width + column;
        if (run->moves_y) run->moves_y = block_at(lsm, column, run->y - 1, z) != none;
        if (run->moves_z) run->moves_z = along[w - 1] != none;
    }
}

static void find_all_neighbours(const Lsm *lsm, Blocks *box)
{
    box->along_z = sm_alloc((size_t)lsm->blocks * (size_t)lsm->side, sizeof(int));
    box->place = sm_alloc((size_t)lsm->blocks, sizeof(int));
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lsm->lattice.count))
    for (int z = 0; z < lsm->lattice.size[2]; z++)
        for (int r = box->plane_run[z]; r < box->plane_run[z + 1]; r++)
            find_neighbours(lsm, box, z, &box->run[r]);
}

/* A bitmap of what sums along z and y may pass through: sites whose blocks exist, but at w = 1
 * particles only (through() in boxes.c). */
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
    box->plane_run = sm_alloc((size_t)planes + 1, sizeof(int));
    box->row_run = sm_alloc((size_t)l->size[1] * (size_t)planes + 1, sizeof(int));
    lsm->layer_block = sm_alloc((size_t)planes + 1, sizeof(long));
    count_blocks(lsm, box);
    long blocks = lsm->blocks;
    box->streams = blocks * SM_LANES * (long)(6 * sizeof(real) + 6 * sizeof(short)) > cache;
    box->run = sm_alloc((size_t)box->plane_run[planes] + 1, sizeof(BlockRun));
    lsm->listed = sm_alloc((size_t)blocks, sizeof(bool));
    box->mixed = sm_alloc((size_t)blocks, sizeof(bool));
    lsm->layers = planes;
    /* a window that moves from plane z - 1 to z also reads what it leaves, plane z - 1 - w */
    box->running = lsm->w >= RUNNING && lsm->params.summation == SM_SUM_FAST;
    lsm->reach = box->running ? lsm->w + 1 : lsm->w;
    lsm->chapter = box->running ? RESTART : 1;
    lsm->layer_plane = sm_alloc((size_t)planes + 1, sizeof(int));
    lsm->slot = sm_alloc((size_t)l->count, sizeof(int));
    lsm->particle = sm_alloc((size_t)blocks * SM_LANES, sizeof(int));
    for (int z = 0; z <= planes; z++) lsm->layer_plane[z] = z;
    fill_blocks(lsm, box);
    find_all_neighbours(lsm, box);
    box->passable = passable_sites(lsm);
}

/* The sites of a window's row that sums from or to its centre pass through: all of it, if at all.
 */
static LsmRow way(const Lsm *lsm, const int *at, int b, int c)
{
    LsmRow row = lsm_window(&lsm->lattice, lsm->box->passable, at[0], at[1] + b, at[2] + c, lsm->w);
    return row >> lsm->w & 1 ? row : 0;
}

/* Up, member i passes through (x_i, y_i, z_r) and (x_r, y_i, z_r); down, region r passes through
 * (x_r, y_i, z_r) and (x_i, y_i, z_r). Sites between must be summed at all. */
bool lsm_blocks_regular(const Lsm *lsm, long p, const LsmRow *rows)
{
    const LsmLattice *l = &lsm->lattice;
    const int *at = l->coord[p];
    int w = lsm->w, side = lsm->side;
    for (int row = 0; row < side * side; row++) {
        int b = row % side - w, c = row / side - w;
        LsmRow box = lsm_window(l, l->bits, at[0], at[1] + b, at[2] + c, w);
        if ((box & way(lsm, at, b, 0)) != rows[row] || (box & way(lsm, at, 0, c)) != rows[row])
            return false;
    }
    return true;
}

/* Reals of scratch that one thread needs: see boxes.c. */
static size_t scratch_size(const Lsm *lsm)
{
    size_t width = (size_t)lsm->box->width, side = (size_t)lsm->side;
    return width * SM_LANES * (2 * (side + 1) * 12 + 3 * 12) +
           (width + 2 * PREFIX_AROUND((size_t)lsm->w)) * (sizeof(Prefixes) / sizeof(real));
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

void lsm_blocks_share(Lsm *lsm)
{
    Blocks *box = lsm->box;
    int planes = lsm->layers;
    long most = 0;
    free_shared(box);
    box->threads = lsm->threads;
    int *store = sm_alloc((size_t)planes, sizeof(int));
    for (int z = 0; z < planes; z++) {
        long blocks = lsm->layer_block[z + 1] - lsm->layer_block[z];
        most = blocks > most ? blocks : most;
    }
    int stores = lsm_pipeline_stores(lsm, 2, store);
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
