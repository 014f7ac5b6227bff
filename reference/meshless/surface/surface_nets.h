/* surface_nets.h - the surface of a field as a closed mesh, to be seen and to be made into cells.
 */
#ifndef REF_SURFACE_NETS_H
#define REF_SURFACE_NETS_H

#include "../../../lib/mesh/mesh.h"
#include "field.h"

/* Surface nets (Gibson 1998) on `cells` cells along the box's longest side, 4 to 512: one vertex in
 * every cell that the surface crosses, moved onto it, and a square across every crossed edge.
 * Closed; where two sheets share a cell they touch. Where the field is farther from 0 than its
 * distance could say it is not looked at, so time goes with the surface. Errors (SM_INPUT): nothing
 * inside. The caller frees. */
SmCode ref_surface_nets(const RefField *field, int cells, SmMesh *mesh, SmError *error);

#endif
