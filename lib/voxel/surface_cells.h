/* surface_cells.h - the cells that a triangle surface touches. */
#ifndef SM_SURFACE_CELLS_H
#define SM_SURFACE_CELLS_H

#include "../mesh/mesh.h"
#include "voxel.h"

/* Sets every cell that a triangle comes nearer than a millionth of a cell to: closed cells against
 * closed triangles, so that a triangle in the plane between two layers marks both. `point` is
 * [mesh->vertex_count], in cells from the lattice's origin; what lies outside the lattice marks the
 * cells at its edge. Takes another 8 bytes a vertex. On all threads. O(triangles + rows of cells
 * touched + cells set / 64). */
void sm_surface_cells(const SmMesh *mesh, const double (*point)[3], SmVoxels *voxels);

#endif
