/* voxelise.h - the conservative voxeliser that both engines share (fastlsm section 2, "Lattice
 * construction"). */
#ifndef SM_VOXELISE_H
#define SM_VOXELISE_H

#include "../mesh/mesh.h"
#include "voxel.h"

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
 * odd number of times before it, not counting rays that pass through a hole (ray_vote.h).
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

#endif
