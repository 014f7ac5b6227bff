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
    box->column[block] = column;
    for (int lane = 0; lane < SM_LANES; lane++) {
        long p = lsm_lattice_find(&lsm->lattice, column * SM_LANES + lane, y, z);
        lsm->particle[block * SM_LANES + lane] = (int)p;
        box->site[block][lane] = p >= 0 ? -1 : 0;
        if (p >= 0) lsm->slot[p] = (int)(block * SM_LANES + lane);
    }
    box->whole[block] = true;
    for (int lane = 0; lane < SM_LANES; lane++)
        if (!box->site[block][lane]) box->whole[block] = false;
}

/* How many blocks and rows the lattice has: every word of the bitmap is a few blocks. */
static void count_blocks(const LsmLattice *l, long *blocks, long *rows)
{
    const uint64_t lanes = ((uint64_t)1 << SM_LANES) - 1;
    *blocks = *rows = 0;
    for (long row = 0; row < (long)l->size[1] * l->size[2]; row++) {
        long before = *blocks;
        for (int word = 0; word < l->words; word++)
            for (uint64_t bits = l->bits[row * l->words + word]; bits; bits >>= SM_LANES)
                *blocks += (bits & lanes) != 0;
        *rows += *blocks > before;
    }
}

static void add_rows(Lsm *lsm, Blocks *box)
{
    int rows = 0;
    for (int z = 0; z < lsm->lattice.size[2]; z++) {
        box->plane_row[z] = rows;
        lsm->layer_block[z] = lsm->blocks;
        for (int y = 0; y < lsm->lattice.size[1]; y++) {
            int first = (int)lsm->blocks;
            for (int column = 0; column < box->width; column++)
                if (occupied(&lsm->lattice, column, y, z)) add_block(lsm, box, column, y, z);
            if (lsm->blocks > first)
                box->row[rows++] = (BlockRow){y, first, (int)lsm->blocks - first};
        }
    }
    box->plane_row[lsm->lattice.size[2]] = rows;
    lsm->layer_block[lsm->lattice.size[2]] = lsm->blocks;
}

/* The block of `column` in row y of plane z, or the empty block. */
static int block_at(const Lsm *lsm, const Blocks *box, int column, int y, int z)
{
    if (z < 0 || z >= lsm->lattice.size[2]) return (int)lsm->blocks;
    int low = box->plane_row[z], high = box->plane_row[z + 1];
    while (low < high) {
        int middle = (low + high) / 2;
        if (box->row[middle].y < y)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == box->plane_row[z + 1] || box->row[low].y != y) return (int)lsm->blocks;
    for (int i = 0; i < box->row[low].count; i++)
        if (box->column[box->row[low].first + i] == column) return box->row[low].first + i;
    return (int)lsm->blocks;
}

static void find_neighbours(Lsm *lsm, Blocks *box)
{
    box->along_z = sm_alloc((size_t)lsm->blocks * (size_t)lsm->side, sizeof(int));
    for (int z = 0; z < lsm->lattice.size[2]; z++)
        for (int row = box->plane_row[z]; row < box->plane_row[z + 1]; row++)
            for (int i = 0; i < box->row[row].count; i++)
                for (int c = 0; c < lsm->side; c++) {
                    int block = box->row[row].first + i;
                    box->along_z[(long)block * lsm->side + c] =
                        block_at(lsm, box, box->column[block], box->row[row].y, z + c - lsm->w);
                }
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
        for (int row = lsm->box->plane_row[z]; row < lsm->box->plane_row[z + 1]; row++)
            for (int i = 0; i < lsm->box->row[row].count; i++) {
                int x = lsm->box->column[lsm->box->row[row].first + i] * SM_LANES;
                size_t at = ((size_t)z * (size_t)l->size[1] + (size_t)lsm->box->row[row].y) *
                            (size_t)l->words;
                bits[at + (size_t)(x >> 6)] |= lanes << (x & 63);
            }
    return bits;
}

void lsm_blocks_build(Lsm *lsm)
{
    const LsmLattice *l = &lsm->lattice;
    Blocks *box = lsm->box = sm_alloc(1, sizeof *box);
    int planes = l->size[2];
    long blocks, rows;
    count_blocks(l, &blocks, &rows);
    box->width = (l->size[0] + SM_LANES - 1) / SM_LANES;
    box->column = sm_alloc((size_t)blocks, sizeof(int));
    box->plane_row = sm_alloc((size_t)planes + 1, sizeof(int));
    box->row = sm_alloc((size_t)rows, sizeof(BlockRow));
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

/* Up, a member passes through (x_i, y_i, z_r) and (x_i, y_r, z_r); down, region r passes through
 * (x_i, y_r, z_r) and (x_i, y_i, z_r). Sites between must be summed at all. */
bool lsm_blocks_regular(const Lsm *lsm, long p, const uint64_t *rows)
{
    const LsmLattice *l = &lsm->lattice;
    const uint64_t *site = lsm->box->passable;
    const int *at = l->coord[p];
    int w = lsm->w, side = lsm->side;
    uint64_t middle = lsm_window(l, site, at[0], at[1], at[2], w);
    for (int row = 0; row < side * side; row++) {
        int b = row % side - w, c = row / side - w;
        uint64_t box = lsm_window(l, l->bits, at[0], at[1] + b, at[2] + c, w);
        uint64_t up = box & lsm_window(l, site, at[0], at[1] + b, at[2], w) & middle;
        bool through = lsm_window(l, site, at[0], at[1] + b, at[2] + c, w) >> w & 1 &&
                       lsm_window(l, site, at[0], at[1], at[2] + c, w) >> w & 1;
        if (up != rows[row] || (through ? box : 0) != rows[row]) return false;
    }
    return true;
}

long lsm_blocks_irregular(const Lsm *lsm, bool *wanted)
{
    const LsmLattice *l = &lsm->lattice;
    uint64_t rows[LSM_MAX_SIDE * LSM_MAX_SIDE];
    long count = 0;
    for (long p = 0; p < l->count; p++) {
        wanted[p] = false;
        if (lsm_bit(l, lsm->interior.interior, l->coord[p])) continue;
        lsm_region_rows(l, &lsm->interior, p, rows);
        wanted[p] = !lsm_blocks_regular(lsm, p, rows);
        count += wanted[p];
    }
    return count;
}

/* Reals of scratch that one thread needs: see blocks.c. */
static size_t scratch_size(const Lsm *lsm)
{
    size_t width = (size_t)lsm->box->width + 2, side = (size_t)lsm->side;
    return width * SM_LANES * (2 * side + 6) * 12;
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
    long a_block =
        (1 + lsm->side) * (long)sizeof(int) + (long)sizeof(ivec) + 3 * (long)sizeof(bool);
    long rows = lsm->box->plane_row[lsm->layers] * (long)sizeof(BlockRow);
    const LsmLattice *l = &lsm->lattice;
    rows += (long)l->size[1] * l->size[2] * l->words * (long)sizeof(uint64_t);
    return lsm->blocks * a_block + rows + lsm->box->shared_bytes;
}

void lsm_blocks_free(Blocks *box)
{
    if (!box) return;
    free_shared(box);
    free(box->column);
    free(box->plane_row);
    free(box->row);
    free(box->along_z);
    free(box->site);
    free(box->passable);
    free(box->whole);
    free(box->listed);
    free(box->mixed);
    free(box);
}
