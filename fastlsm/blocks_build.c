#include <stdlib.h>
#include <string.h>

#include "blocks.h"

/* Any particle at the lanes of block `column` of row (y, z)? */
static bool occupied(const LsmLattice *l, int column, int y, int z)
{
    for (int lane = 0; lane < SM_LANES; lane++)
        if (lsm_lattice_find(l, column * SM_LANES + lane, y, z) >= 0) return true;
    return false;
}

static void add_block(Lsm *lsm, Blocks *box, int column, int y, int z)
{
    long block = lsm->blocks++;
    box->whole[block] = true;
    for (int lane = 0; lane < SM_LANES; lane++) {
        long p = lsm_lattice_find(&lsm->lattice, column * SM_LANES + lane, y, z);
        lsm->particle[block * SM_LANES + lane] = (int)p;
        box->site[block][lane] = p >= 0 ? -1 : 0;
        if (p >= 0)
            lsm->slot[p] = (int)(block * SM_LANES + lane);
        else
            box->whole[block] = false;
    }
}

/* How many blocks the lattice has: every word of the bitmap is a few. */
static long count_blocks(const LsmLattice *l)
{
    const uint64_t lanes = ((uint64_t)1 << SM_LANES) - 1;
    long blocks = 0;
    for (long word = 0; word < (long)l->size[1] * l->size[2] * l->words; word++)
        for (uint64_t bits = l->bits[word]; bits; bits >>= SM_LANES) blocks += (bits & lanes) != 0;
    return blocks;
}

static void add_row(Lsm *lsm, Blocks *box, int y, int z, int *runs)
{
    BlockRun *run = NULL;
    for (int column = 0; column < box->width; column++) {
        if (!occupied(&lsm->lattice, column, y, z)) {
            run = NULL;
            continue;
        }
        if (!run) {
            run = &box->run[(*runs)++];
            *run = (BlockRun){y, column, (int)lsm->blocks, 0};
        }
        run->count++;
        add_block(lsm, box, column, y, z);
    }
}

static void add_rows(Lsm *lsm, Blocks *box)
{
    int runs = 0;
    for (int z = 0; z < lsm->lattice.size[2]; z++) {
        box->plane_run[z] = runs;
        lsm->layer_block[z] = lsm->blocks;
        for (int y = 0; y < lsm->lattice.size[1]; y++) add_row(lsm, box, y, z, &runs);
    }
    box->plane_run[lsm->lattice.size[2]] = runs;
    lsm->layer_block[lsm->lattice.size[2]] = lsm->blocks;
    box->run = sm_realloc(box->run, (size_t)runs, sizeof(BlockRun));
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

/* A bitmap of what sums along z and y may pass through: sites whose blocks exist, but at w = 1
 * particles only (`masked` in blocks.c). */
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
    long blocks = count_blocks(l);
    box->width = (l->size[0] + SM_LANES - 1) / SM_LANES;
    box->plane_run = sm_alloc((size_t)planes + 1, sizeof(int));
    box->run = sm_alloc((size_t)blocks, sizeof(BlockRun));
    box->site = sm_alloc((size_t)blocks + 1, sizeof(ivec));
    box->whole = sm_alloc((size_t)blocks, sizeof(bool));
    box->listed = sm_alloc((size_t)blocks, sizeof(bool));
    box->mixed = sm_alloc((size_t)blocks, sizeof(bool));
    lsm->layers = planes;
    lsm->reach = lsm->w;
    lsm->layer_plane = sm_alloc((size_t)planes + 1, sizeof(int));
    lsm->layer_block = sm_alloc((size_t)planes + 1, sizeof(long));
    lsm->slot = sm_alloc((size_t)l->count, sizeof(int));
    lsm->particle = sm_alloc((size_t)blocks * SM_LANES, sizeof(int));
    for (int z = 0; z <= planes; z++) lsm->layer_plane[z] = z;
    add_rows(lsm, box);
    find_neighbours(lsm, box);
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

/* Reals of scratch that one thread needs: see blocks.c. */
static size_t scratch_size(const Lsm *lsm)
{
    size_t width = (size_t)lsm->box->width, side = (size_t)lsm->side;
    return width * SM_LANES * (2 * (side + 1) * 12 + 2 * 16);
}

static void free_shared(Blocks *box)
{
    for (int t = 0; t < box->threads; t++) {
        free(box->scratch[t]);
        free(box->window_row[t]);
    }
    free(box->scratch);
    free(box->window_row);
    free(box->down);
    free(box->down_memory);
}

/* A plane's store is free for another plane once part 2 has passed w planes on: in the middle of a
 * thread's share planes take turns; near its ends, where part 2 waits for the other thread, each
 * has its own. */
void lsm_blocks_share(Lsm *lsm)
{
    Blocks *box = lsm->box;
    int planes = lsm->layers, side = lsm->side;
    long most = 0, stores = 0;
    free_shared(box);
    box->threads = lsm->threads;
    int *store = sm_alloc((size_t)planes, sizeof(int));
    for (int z = 0; z < planes; z++) {
        long blocks = lsm->layer_block[z + 1] - lsm->layer_block[z];
        most = blocks > most ? blocks : most;
    }
    for (int t = 0; t < lsm->threads; t++) {
        int first = lsm->thread_layer[t], last = lsm->thread_layer[t + 1];
        long ring = stores;
        stores += side;
        for (int z = first; z < last; z++) {
            bool shared = (t > 0 && z < first + 3 * lsm->w) ||
                          (t + 1 < lsm->threads && z >= last - 3 * lsm->w);
            store[z] = (int)(shared ? stores++ : ring + z % side);
        }
    }
    box->down = sm_alloc((size_t)planes, sizeof *box->down);
    box->down_memory = sm_alloc((size_t)stores * (size_t)most * 6 * SM_LANES, sizeof(real));
    for (int z = 0; z < planes; z++)
        box->down[z] = box->down_memory + store[z] * most * 6 * SM_LANES;
    free(store);
    box->scratch = sm_alloc((size_t)lsm->threads, sizeof *box->scratch);
    box->window_row = sm_alloc((size_t)lsm->threads, sizeof *box->window_row);
    for (int t = 0; t < lsm->threads; t++) {
        box->scratch[t] = sm_alloc(scratch_size(lsm), sizeof(real));
        box->window_row[t] = sm_alloc(2 * (size_t)box->width, sizeof(int));
    }
    box->shared_bytes = (stores * most * 6 * SM_LANES + lsm->threads * (long)scratch_size(lsm)) *
                        (long)sizeof(real);
}

long lsm_blocks_bytes(const Lsm *lsm)
{
    long a_block = lsm->side * (long)sizeof(int) + (long)sizeof(ivec) + 3 * (long)sizeof(bool);
    long rows = lsm->box->plane_run[lsm->layers] * (long)sizeof(BlockRun);
    const LsmLattice *l = &lsm->lattice;
    rows += (long)l->size[1] * l->size[2] * l->words * (long)sizeof(uint64_t);
    return lsm->blocks * a_block + rows + lsm->box->shared_bytes;
}

void lsm_blocks_free(Blocks *box)
{
    if (!box) return;
    free_shared(box);
    free(box->plane_run);
    free(box->run);
    free(box->along_z);
    free(box->site);
    free(box->passable);
    free(box->whole);
    free(box->listed);
    free(box->mixed);
    free(box);
}
