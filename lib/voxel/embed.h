/* embed.h - a surface carried by its lattice (fastlsm section 4, eqs. 15-17). */
#ifndef SM_EMBED_H
#define SM_EMBED_H

#include "../mesh/mesh.h"
#include "sites.h"

/* A vertex beside a cut whose particles lie in a plane, on a line or in one place (embed_cut.h): to
 * where its weights put it comes an offset that turns with these particles: rigidly about a plane,
 * by the smallest rotation about a line, and not at all with one particle. */
typedef struct {
    long vertex;
    double share[8][3]; /* sum of (x_i - x_0) share_i^T has the rotation that it turns by */
    double offset[3], normal[3]; /* at rest */
} SmFlat;

/* Weights are taken of position differences from corner 0, so that their rounding is relative to
 * the cell's size and not to the distance from the origin. */
typedef struct {
    long vertex_count;
    int (*corner)[8];      /* particles of each vertex's cell, x fastest, then y, then z; beside a
                              cut those that carry it, the nearest first */
    float (*weight)[8];    /* phi_i(X), trilinear, eq. 15 */
    float (*tangent_u)[8]; /* cell * U . grad phi_i, eq. 17; zero without a rest normal */
    float (*tangent_v)[8]; /* the same of V; U x V is the rest normal */
    long flat_count;
    SmFlat *flat; /* [flat_count] */
} SmEmbedding;

/* Embeds every vertex of `mesh` in the material cell that holds it (the nearest one for a vertex
 * outside: by rounding, usually; its weights then extrapolate). Normals of the rest surface are
 * area weighted. `voxels` must have a material cell. Frees nothing and keeps neither argument.
 * O(vertices log cells-in-a-row), but O(box) for a vertex more than a cell away from material. */
void sm_embed_create(const SmMesh *mesh, const SmVoxels *voxels, SmEmbedding *embedding);
/* Embeds the vertices that the mesh has more than the embedding. `normal` is [vertex_count],
 * of any length. */
void sm_embed_grow(SmEmbedding *embedding, const SmMesh *mesh, const SmSites *sites,
                   const double (*normal)[3]);
void sm_embed_free(SmEmbedding *embedding);

/* Deformed vertex positions (and unit normals, unless NULL) from particle positions x.
 * A normal whose tangents are parallel comes out zero, never NaN (while x is finite and within
 * 1e60). OpenMP's number of threads share the vertices; any gives the same bits. */
void sm_embed_apply(const SmEmbedding *embedding, const double (*x)[3], double (*position)[3],
                    double (*normal)[3]);

/* U and V, orthonormal, U x V along the normal; zero where that is. */
void sm_embed_tangents(const double normal[3], double u[3], double v[3]);

#endif
