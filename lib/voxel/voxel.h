/* voxel.h - the conservative voxeliser that both engines share (fastlsm section 2, "Lattice
 * construction").
 *
 * Material is a set of cubic cells of one size on a lattice. Particles sit at the vertices of
 * material cells and are numbered canonically: lattice vertices in the order z, y, x with x
 * fastest. Every engine, reference and result file uses that numbering. */
#ifndef SM_VOXEL_H
#define SM_VOXEL_H

#include <stdbool.h>
#include <stdint.h>

#include "../mesh/mesh.h"

typedef struct {
    int size[3];         /* cells along x, y, z */
    double origin[3];    /* corner of cell (0,0,0) */
    double cell;         /* edge length of a cell, in the mesh's units */
    int words;           /* 64-bit words in a row along x */
    uint64_t *bits;      /* [size[2]][size[1]][words]; bit i & 63 of word i / 64 is cell i */
    long cell_count;     /* material cells */
    long particle_count; /* vertices of material cells */
} SmVoxels;

typedef enum { SM_SOLID, SM_SHELL } SmFill;

typedef struct {
    SmFill fill;
    double cell;    /* edge length of a cell; used when particles is 0 */
    long particles; /* wanted particle count, or 0 */
    bool fewer;     /* fewer particles will do where so many take too large a lattice */
} SmVoxelParams;

/* How the inside of a solid was found; see sm_voxelise(). */
typedef enum {
    SM_INSIDE_NONE,   /* a shell was asked for, or an open sheet that encloses nothing */
    SM_INSIDE_CLOSED, /* every edge has an even number of triangles: flood fill is exact */
    SM_INSIDE_TIGHT,  /* open, but its holes are narrower than a cell: flood fill */
    SM_INSIDE_VOTED,  /* wider holes: what the flood fill missed, rays have decided */
} SmInside;

typedef struct {
    SmInside inside;
    long shell_cells;  /* touched by a triangle */
    long flood_cells;  /* added because the outside cannot reach them */
    long vote_cells;   /* added by rays */
    int voxelisations; /* lattices made: 1, or more in search of a particle count */
} SmVoxelReport;

/* Marks every cell that a triangle touches (to a millionth of a cell) and, for SM_SOLID, fills the
 * interior.
 *
 * Lattice: the box of the triangles is centred in the fewest cells that cover it, so that faces
 * along the lattice's outer boundary belong to the cells inside and a flat mesh is one cell thick.
 *
 * Inside: what the outside cannot reach through faces of empty cells (flood fill, fastlsm section
 * 2). Orientation, doubled faces, crossing parts and holes narrower than a cell do not matter, and
 * a cavity is filled. Of an open mesh the flood may leak in through a wider hole; then a cell is
 * inside also where two of the three axis-parallel rays through its centre cross the surface an
 * odd number of times before it, not counting rays that pass through a hole (voxel_vote.h).
 * A body too thin for an inside at this cell size, a sheet included, is its own shell.
 *
 * With params->particles the cell size is searched whose particle count is nearest: by bracketing,
 * at most 12 lattices, and where the count jumps (few particles, flat faces) at most 47 more with
 * the lattice moved by a part of a cell; of at most 2^32 cells together.
 *
 * The mesh's equal positions must have been merged (sm_mesh_merge()). O(triangles + cells / 64) a
 * lattice; at most 7 times bits/8 bytes for a moment. On success the caller frees `voxels`.
 * `report` may be NULL. Errors (SM_INPUT), on which `voxels` is zeroed: what sm_mesh_check() says;
 * loose triangles without an inside for a solid; a lattice of more than 2^31 cells or 512 MiB; a
 * cell size or particle count out of range, or (unless `fewer`) one beyond those 2^32 cells. The
 * line begins with `name`. */
SmCode sm_voxelise_report(const SmMesh *mesh, const SmVoxelParams *params, const char *name,
                          SmVoxels *voxels, SmVoxelReport *report, SmError *error);

/* The same without the report. */
SmCode sm_voxelise(const SmMesh *mesh, const SmVoxelParams *params, const char *name,
                   SmVoxels *voxels, SmError *error);

/* What the report of a SM_SOLID tells a user about the surface: "closed", "open, but its holes are
 * narrower than a cell" and so on. All can be simulated. */
const char *sm_voxel_verdict(const SmVoxelReport *report);

/* An empty (no material) lattice of the given size; the caller sets cells and calls
 * sm_voxels_count(). For tests and procedural blocks. */
void sm_voxels_init(SmVoxels *voxels, int nx, int ny, int nz, double cell);

/* The same with material in every cell, counted. */
void sm_voxels_block(SmVoxels *voxels, int nx, int ny, int nz, double cell);

void sm_voxels_free(SmVoxels *voxels);

/* Fills in cell_count and particle_count from bits. O(words). */
void sm_voxels_count(SmVoxels *voxels);

/* Lattice coordinates of every particle in canonical order; rest position of particle p is
 * origin + cell * coordinate[p]. `coordinate` is [particle_count][3], the caller's. */
void sm_voxels_particles(const SmVoxels *voxels, int (*coordinate)[3]);

static inline bool sm_voxel_get(const SmVoxels *v, int i, int j, int k)
{
    if (i < 0 || j < 0 || k < 0 || i >= v->size[0] || j >= v->size[1] || k >= v->size[2])
        return false;
    size_t row = ((size_t)k * (size_t)v->size[1] + (size_t)j) * (size_t)v->words;
    return v->bits[row + (size_t)(i >> 6)] >> (i & 63) & 1;
}

static inline void sm_voxel_set(SmVoxels *v, int i, int j, int k)
{
    size_t row = ((size_t)k * (size_t)v->size[1] + (size_t)j) * (size_t)v->words;
    v->bits[row + (size_t)(i >> 6)] |= (uint64_t)1 << (i & 63);
}

#endif
