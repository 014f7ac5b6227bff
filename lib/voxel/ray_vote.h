/* ray_vote.h - the inside of a surface with holes that are wider than a cell. */
#ifndef SM_RAY_VOTE_H
#define SM_RAY_VOTE_H

#include "../mesh/mesh.h"
#include "voxel.h"

/* Sets the cells that lie inside by the votes of three rays through their centre, one along each
 * axis. Returns how many axes had a vote. A ray says inside where it has crossed
 * the surface an odd number of times. A ray that has not left again at its far end went through a
 * hole and has no vote; when that happens to more than a quarter of an axis's rays that meet the
 * surface, none of that axis has. Two votes decide, so that the rays that miss an open tube or
 * leave through its mouth are outvoted, and a sheet, or triangles that do not join, have no inside.
 *
 * `point` as for sm_surface_cells(). Takes another 3 bits/8 bytes. O(triangles + rays crossed +
 * words). */
int sm_ray_vote(const SmMesh *mesh, const double (*point)[3], SmVoxels *voxels);

#endif
