/* embed.h - a surface carried by its lattice (fastlsm section 4, eqs. 15-17). */
#ifndef SM_EMBED_H
#define SM_EMBED_H

#include "mesh.h"
#include "voxel.h"

typedef struct {
    long vertex_count;
    int (*corner)[8];        /* particles of each vertex's cell */
    float (*weight)[8];      /* phi_i(X), trilinear, eq. 15 */
    float (*tangent_u)[8];   /* U . grad phi_i, eq. 17 */
    float (*tangent_v)[8];
} SmEmbedding;

/* Ties every vertex of `mesh` to the material cell that holds it (the nearest one for a vertex
 * outside by rounding). Normals of the rest surface are area weighted. O(vertices). */
void sm_embed_create(const SmMesh *mesh, const SmVoxels *voxels, SmEmbedding *embedding);
void sm_embed_free(SmEmbedding *embedding);

/* Deformed vertex positions (and unit normals, unless NULL) from particle positions x.
 * A normal whose tangents are parallel comes out zero, never NaN. */
void sm_embed_apply(const SmEmbedding *embedding, const double (*x)[3], double (*position)[3],
                    double (*normal)[3]);

#endif
