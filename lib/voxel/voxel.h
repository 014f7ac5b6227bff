/* voxel.h - bodies as material on a lattice; voxelise.h makes them of meshes.
 *
 * Material is a set of cubic cells of one size on a lattice. Particles sit at the vertices of
 * material cells and are numbered canonically: lattice vertices in the order z, y, x with x
 * fastest. Every engine, reference and result file uses that numbering. */
#ifndef SM_VOXEL_H
#define SM_VOXEL_H

#include <stdbool.h>
#include <stdint.h>

#include "../error.h"

typedef struct {
    int size[3];         /* cells along x, y, z */
    double origin[3];    /* corner of cell (0,0,0) */
    double cell;         /* edge length of a cell, in the mesh's units */
    int words;           /* 64-bit words in a row along x */
    uint64_t *bits;      /* [size[2]][size[1]][words]; bit i & 63 of word i / 64 is cell i */
    long cell_count;     /* material cells */
    long particle_count; /* vertices of material cells */
} SmVoxels;

/* An empty (no material) lattice of the given size; the caller sets cells and calls
 * sm_voxels_count(). For tests and procedural blocks. */
void sm_voxels_init(SmVoxels *voxels, int nx, int ny, int nz, double cell);

/* Material in every cell, not counted. */
void sm_voxels_fill(SmVoxels *voxels);

/* A lattice with material in every cell, counted. */
void sm_voxels_block(SmVoxels *voxels, int nx, int ny, int nz, double cell);

/* The caller frees the copy. */
void sm_voxels_copy(const SmVoxels *from, SmVoxels *to);
void sm_voxels_free(SmVoxels *voxels);

/* How many cells of the bits have material. O(words). */
long sm_voxels_cells(const SmVoxels *voxels);

/* Fills in cell_count and particle_count from bits. O(words). */
void sm_voxels_count(SmVoxels *voxels);

/* Row (y, z) of lattice vertices, size[0] / 64 + 1 words: bit x & 63 of word x / 64 is set where
 * there is a particle at x. Returns how many there are. */
int sm_voxels_vertices(const SmVoxels *voxels, int y, int z, uint64_t *vertex);

/* Lattice coordinates of every particle in canonical order; `coordinate` is [particle_count][3],
 * the caller's. */
void sm_voxels_particles(const SmVoxels *voxels, int (*coordinate)[3]);

/* Rest positions of all particles in canonical order, into position[particle_count]. */
void sm_voxels_rest(const SmVoxels *voxels, double (*position)[3]);

/* First word of the row of cells (j, k). */
static inline size_t sm_voxels_row(const SmVoxels *v, int j, int k)
{
    return ((size_t)k * (size_t)v->size[1] + (size_t)j) * (size_t)v->words;
}

/* Words of all rows. */
static inline size_t sm_voxels_words(const SmVoxels *v)
{
    return sm_voxels_row(v, 0, v->size[2]);
}

static inline bool sm_voxel_get(const SmVoxels *v, int i, int j, int k)
{
    if (i < 0 || j < 0 || k < 0 || i >= v->size[0] || j >= v->size[1] || k >= v->size[2])
        return false;
    return v->bits[sm_voxels_row(v, j, k) + (size_t)(i >> 6)] >> (i & 63) & 1;
}

static inline void sm_voxel_set(SmVoxels *v, int i, int j, int k)
{
    v->bits[sm_voxels_row(v, j, k) + (size_t)(i >> 6)] |= (uint64_t)1 << (i & 63);
}

/* The material cell that holds lattice position q (cells from the corner of voxel (0,0,0)), or the
 * nearest one if none does. `voxels` must have a material cell. O(1), but O(box) for a position
 * more than a cell away from material. */
void sm_nearest_cell(const SmVoxels *voxels, const double q[3], int cell[3]);

/* Mass of every particle in canonical order, an eighth of every material cell around it, into
 * mass[particle_count]; `density` in kg per unit of volume. O(particles). */
void sm_voxels_weigh(const SmVoxels *voxels, double density, double *mass);

#endif
