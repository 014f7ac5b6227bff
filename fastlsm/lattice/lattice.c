#include "lattice.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"

/* Ring offsets linked through each of the eight cells at a particle, for every set of cells. */
static void link_table(uint32_t table[256])
{
    for (int set = 0; set < 256; set++) {
        uint32_t links = 1u << LSM_SELF;
        for (int cell = 0; cell < 8; cell++) {
            if (!(set >> cell & 1)) continue;
            for (int corner = 0; corner < 8; corner++) {
                int dx = (cell & 1) + (corner & 1), dy = (cell >> 1 & 1) + (corner >> 1 & 1),
                    dz = (cell >> 2 & 1) + (corner >> 2 & 1); /* 0..2 */
                links |= 1u << (dz * 9 + dy * 3 + dx);
            }
        }
        table[set] = links;
    }
}

void lsm_lattice_sites(const SmVoxels *voxels, LsmLattice *l)
{
    memset(l, 0, sizeof *l);
    for (int d = 0; d < 3; d++) {
        l->size[d] = voxels->size[d] + 1;
        l->origin[d] = voxels->origin[d];
    }
    l->cell = voxels->cell;
    l->words = (l->size[0] + 63) / 64;
    l->count = voxels->particle_count;
    long rows = (long)l->size[1] * l->size[2], before = 0;
    l->bits = sm_alloc((size_t)(rows * l->words), sizeof *l->bits);
    l->rank = sm_alloc((size_t)(rows * l->words), sizeof *l->rank);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(rows * l->words))
    for (long row = 0; row < rows; row++) /* each row's number, for a moment */
        l->rank[row * l->words] = (uint32_t)sm_voxels_vertices(
            voxels, (int)(row % l->size[1]), (int)(row / l->size[1]), l->bits + row * l->words);
    for (long row = 0; row < rows; row++) {
        long count = l->rank[row * l->words];
        l->rank[row * l->words] = (uint32_t)before;
        before += count;
    }
    assert(before == l->count);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(rows * l->words))
    for (long row = 0; row < rows; row++)
        for (long w = row * l->words; w + 1 < (row + 1) * l->words; w++)
            l->rank[w + 1] = l->rank[w] + (uint32_t)sm_count_bits(l->bits[w]);
}

/* Word w of row (j, k) of cells, and the same a cell on, so that bit x of `at` holds cells x and of
 * `before` cells x - 1; zero outside the box. */
static void cell_words(const SmVoxels *v, int w, int j, int k, uint64_t *before, uint64_t *at)
{
    *before = *at = 0;
    if (j < 0 || k < 0 || j >= v->size[1] || k >= v->size[2]) return;
    const uint64_t *row = v->bits + sm_voxels_row(v, j, k);
    *at = w < v->words ? row[w] : 0;
    *before = *at << 1 | (w > 0 ? row[w - 1] >> 63 : 0);
}

/* Links of the particles of word w of row (y, z), from the set of cells at each: bit dx + 2 dy + 4
 * dz for cell (x - 1 + dx, ...). */
static void link_word(const SmVoxels *v, const uint32_t table[256], int w, int y, int z,
                      LsmLattice *l)
{
    uint64_t cells[8], whole = ~(uint64_t)0;
    size_t word = ((size_t)z * (size_t)l->size[1] + (size_t)y) * (size_t)l->words + (size_t)w;
    long p = l->rank[word];
    for (int row = 0; row < 4; row++) {
        uint64_t *of = cells + 2 * row;
        cell_words(v, w, y - 1 + (row & 1), z - 1 + (row >> 1), &of[0], &of[1]);
        whole &= of[0] & of[1];
    }
    for (uint64_t rest = l->bits[word]; rest; rest &= rest - 1, p++) {
        int bit = __builtin_ctzll(rest);
        unsigned set = 255;
        for (int cell = 0; cell < 8 && !(whole >> bit & 1); cell++)
            set ^= (unsigned)(~cells[cell] >> bit & 1) << cell;
        l->coord[p][0] = w * 64 + bit;
        l->coord[p][1] = y;
        l->coord[p][2] = z;
        l->link[p] = table[set];
    }
}

void lsm_lattice_build(const SmVoxels *voxels, LsmLattice *l)
{
    uint32_t table[256];
    link_table(table);
    lsm_lattice_sites(voxels, l);
    l->coord = sm_alloc((size_t)l->count, sizeof *l->coord);
    l->link = sm_alloc((size_t)l->count, sizeof *l->link);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(l->count))
    for (int z = 0; z < l->size[2]; z++)
        for (int y = 0; y < l->size[1]; y++)
            for (int w = 0; w < l->words; w++) link_word(voxels, table, w, y, z, l);
}

void lsm_lattice_free(LsmLattice *l)
{
    free(l->bits);
    free(l->rank);
    free(l->coord);
    free(l->link);
    memset(l, 0, sizeof *l);
}

long lsm_lattice_links(const LsmLattice *l)
{
    long both = 0;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(l->count)) reduction(+ : both)
    for (long p = 0; p < l->count; p++) both += sm_count_bits(l->link[p]) - 1;
    return both / 2;
}

void lsm_lattice_break(LsmLattice *l, long p, int bit)
{
    const int *c = l->coord[p];
    long q = lsm_lattice_find(l, c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1);
    assert(q >= 0 && bit != LSM_SELF);
    l->link[p] &= ~(1u << bit);
    l->link[q] &= ~(1u << (LSM_RING - 1 - bit));
}
