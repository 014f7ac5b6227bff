#include "lattice.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

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

/* Vertex row (y, z) from the four cell rows beside it; returns how many particles it has. */
static long vertex_row(const SmVoxels *v, int y, int z, int words, uint64_t *row)
{
    memset(row, 0, (size_t)words * sizeof *row);
    for (int corner = 0; corner < 4; corner++) {
        int j = y - (corner & 1), k = z - (corner >> 1);
        if (j < 0 || k < 0 || j >= v->size[1] || k >= v->size[2]) continue;
        const uint64_t *cells =
            v->bits + ((size_t)k * (size_t)v->size[1] + (size_t)j) * (size_t)v->words;
        for (int i = 0; i < words; i++) {
            uint64_t here = i < v->words ? cells[i] : 0, before = i > 0 ? cells[i - 1] : 0;
            row[i] |= here | here << 1 | before >> 63;
        }
    }
    long count = 0;
    for (int i = 0; i < words; i++) count += __builtin_popcountll(row[i]);
    return count;
}

/* The set of material cells at lattice vertex (x, y, z): bit dx + 2 dy + 4 dz for cell
 * (x - 1 + dx, ...). */
static int cells_at(const SmVoxels *v, int x, int y, int z)
{
    int set = 0;
    for (int cell = 0; cell < 8; cell++)
        if (sm_voxel_get(v, x - 1 + (cell & 1), y - 1 + (cell >> 1 & 1), z - 1 + (cell >> 2)))
            set |= 1 << cell;
    return set;
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
    size_t rows = (size_t)l->size[1] * (size_t)l->size[2];
    l->bits = sm_alloc(rows * (size_t)l->words, sizeof *l->bits);
    l->rank = sm_alloc(rows * (size_t)l->words, sizeof *l->rank);
    for (size_t row = 0; row < rows; row++) {
        size_t first = row * (size_t)l->words;
        int y = (int)(row % (size_t)l->size[1]), z = (int)(row / (size_t)l->size[1]);
        long before = l->count;
        l->count += vertex_row(voxels, y, z, l->words, l->bits + first);
        for (int i = 0; i < l->words; i++) {
            l->rank[first + (size_t)i] = (uint32_t)before;
            before += __builtin_popcountll(l->bits[first + (size_t)i]);
        }
    }
}

void lsm_lattice_build(const SmVoxels *voxels, LsmLattice *l)
{
    uint32_t table[256];
    link_table(table);
    lsm_lattice_sites(voxels, l);
    l->coord = sm_alloc((size_t)l->count, sizeof *l->coord);
    l->link = sm_alloc((size_t)l->count, sizeof *l->link);
    sm_voxels_particles(voxels, l->coord);
    for (long p = 0; p < l->count; p++)
        l->link[p] = table[cells_at(voxels, l->coord[p][0], l->coord[p][1], l->coord[p][2])];
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
    for (long p = 0; p < l->count; p++) both += __builtin_popcount(l->link[p]) - 1;
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
