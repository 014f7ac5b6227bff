/* mesh.h - closed or open triangle meshes.
 *
 * Lengths are the file's own units; nothing below this header scales them. */
#ifndef SM_MESH_H
#define SM_MESH_H

#include <stdbool.h>
#include <stdio.h>

#include "../pieces.h"
#include "../vector.h"

typedef struct {
    long vertex_count, triangle_count;
    double (*position)[3]; /* [vertex_count] */
    int (*triangle)[3];    /* [triangle_count], counter-clockwise seen from outside */
} SmMesh;

typedef struct {
    long triangles, vertices; /* after equal positions were merged */
    long components;          /* connected through shared vertices */
    long open_edges;          /* used by one triangle */
    long nonmanifold_edges;   /* used by more than two */
    long flipped_edges;       /* used by two triangles of opposite orientation */
    long degenerate;          /* triangles of no area */
    long duplicates;          /* triangles whose three corners an earlier one has too */
    long cavities;            /* components turned the other way, within the largest one's box, */
    double cavity_volume;     /* and theirs together: a lattice fills them */
    bool watertight;          /* no open and no non-manifold edge */
    double low[3], high[3];   /* bounding box */
    double volume;            /* signed: negative for a mesh that is inside out; NaN where edges are
                               * used more often one way than the other: such a mesh bounds none,
                               * and the sum would depend on where the mesh lies */
} SmMeshInfo;

/* A mesh of zeros, for the caller to fill in and to free. */
SmMesh sm_mesh_new(long vertices, long triangles);

/* The caller frees the copy. */
SmMesh sm_mesh_copy(const SmMesh *mesh);

/* Frees the arrays and zeroes the struct; a zeroed mesh is allowed. */
void sm_mesh_free(SmMesh *mesh);

/* Merges vertices at equal positions (0 and -0 are equal), drops triangles that then repeat a
 * vertex and vertices that no triangle uses. Keeps the order of what stays. The mesh must have
 * passed sm_mesh_check(); afterwards it may have no triangle left. O(vertices).
 * Where open edges remain, vertices on them within 1e-7 of the box's longest side of one another
 * are merged too, but only if that closes every open edge and makes no non-manifold one: files
 * whose writer rounded the same corner in two ways become closed, all others stay as they are. */
void sm_mesh_merge(SmMesh *mesh);

/* Counts what `shapebench info` reports. A triangle has no area when its height is below 1e-14 of
 * its longest edge. The mesh must have passed sm_mesh_check(). O(triangles). */
SmMeshInfo sm_mesh_info(const SmMesh *mesh);

/* Checks what every later stage relies on: at least one triangle, indices in range, finite
 * coordinates, a longest side of the box between 1e-30 and 1e30. `name` is the file for the
 * message. SM_INPUT. */
SmCode sm_mesh_check(const SmMesh *mesh, const char *name, SmError *error);

/* What becomes of a mesh that comes from outside: it is checked and merged. Freed where that fails:
 * the errors of sm_mesh_check(), or SM_INPUT where no triangle is left. */
SmCode sm_mesh_prepare(SmMesh *mesh, const char *name, SmError *error);

/* Area-weighted vertex normals, not of unit length, [vertex_count][3]; the caller frees them. Areas
 * are in `unit` squared: give a length of the mesh's scale, so that nothing overflows. */
double (*sm_mesh_normals(const SmMesh *mesh, double unit))[3];

/* Six times the volume between a triangle and a point: over all triangles of a closed mesh that of
 * the mesh, and negative where it is inside out. */
static inline double sm_mesh_six_volumes(const SmMesh *mesh, long triangle, const double from[3])
{
    const int *corner = mesh->triangle[triangle];
    return sm_six_volumes(from, mesh->position[corner[0]], mesh->position[corner[1]],
                          mesh->position[corner[2]]);
}

/* A name for the mesh: FNV-1a of its coordinates and its indices, bit for bit. */
unsigned long long sm_mesh_hash(const SmMesh *mesh);

/* Prints Wavefront OBJ with all digits; ask ferror() whether the file took it. */
void sm_mesh_print_obj(const SmMesh *mesh, FILE *file);

/* Pieces of the surface by triangle: those that share vertices. The caller frees. */
void sm_mesh_pieces(const SmMesh *mesh, SmPieces *pieces);

#endif
