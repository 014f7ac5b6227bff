/* embed_cut.h - a surface carried by a lattice that has been cut. */
#ifndef SM_EMBED_CUT_H
#define SM_EMBED_CUT_H

#include "../voxel/embed.h"
#include "cut.h"

/* Brings an embedding up to date with a cut's triangles from number `first` on, and with the mesh
 * that they have split (cut_surface.h): vertices keep their numbers and places, new ones follow. A
 * vertex with a particle of its cell beyond the cut, seen from it at rest, or whose cell's
 * particles are no longer of one piece, is carried by up to eight of the nearest particles that it
 * sees instead, and that see the first of them. Their weights are those of a least-squares fit,
 * exact for affine motions where they span space; SmFlat says how the rest move. A few vertices
 * next to the cut that see its wrong side follow their neighbours on the surface
 * (side_consistency.h). All others keep their weights bit by bit. O(vertices + triangles) for a
 * look at each, and what is near new triangles. `piece` is [particles], which piece of the material
 * each is in (pieces.h). */
void sm_embed_cut(SmEmbedding *embedding, const SmMesh *mesh, const SmSites *sites,
                  const SmCut *cut, long first, const int *piece);

#endif
