/* import.h - mesh files, through Assimp's C API in a child process.
 *
 * The importer parses untrusted input in C++; here it runs in a forked child with limits on time
 * and memory, and without a way to anything beyond the mesh's folder (importer.h), that hands
 * triangles back through a pipe, so that a crash, a hang or a memory blow-up in it is one error
 * line that names the file. */
#ifndef SM_IMPORT_H
#define SM_IMPORT_H

#include "mesh.h"

typedef struct {
    double seconds;   /* wall-clock limit of the child; 0: 20, and one for each MB of the file */
    double megabytes; /* memory limit of the child; 0: 4096 (child.h says what counts) */
} SmImportLimits;

/* Reads any format that Assimp reads. n-gons are triangulated, node transforms applied (a mirrored
 * part keeps its outside), equal positions merged, several components kept; points and lines are
 * dropped; skins and animations stay in their rest pose. `limits` may be NULL. On SM_OK the caller
 * frees `mesh` with sm_mesh_free(). Errors: SM_INPUT. */
SmCode sm_import(const char *path, const SmImportLimits *limits, SmMesh *mesh, SmError *error);

/* Reads the points of a file that has points and no faces (PLY, mostly), and their normals, which
 * are zero where it has none; parts with triangles are passed over. The caller frees both arrays.
 * Errors: SM_INPUT, which includes no points. */
SmCode sm_import_points(const char *path, const SmImportLimits *limits, long *count,
                        double (**position)[3], double (**normal)[3], SmError *error);

#endif
