/* polygonise.h - the surface of an implicit solid as a closed mesh, by marching tetrahedra.
 *
 * The tetrahedra are those of the body-centred cubic lattice, all alike; their surface is closed,
 * 2-manifold and oriented for any signs at the nodes (A. Doi and A. Koide 1991; the lattice as in
 * F. Labelle and J. Shewchuk, "Isosurface Stuffing", 2007). */
#ifndef SM_POLYGONISE_H
#define SM_POLYGONISE_H

#include "../mesh/mesh.h"
#include "implicit.h"

/* Makes the surface of `implicit` within the box, which must hold it with a cell to spare. `cell`
 * is the lattice's cube edge. Vertices lie on the surface to about 1e-4 cell. Takes about 20 bytes
 * per cell of the box; time goes with the surface only. Same bits for any number of threads. The
 * caller frees the mesh. */
void sm_polygonise(const SmImplicit *implicit, const SmBox *box, double cell, SmMesh *mesh);

#endif
