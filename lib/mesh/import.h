/* import.h - mesh files: formats of reader.h, and others through Assimp where it is built in.
 *
 * Assimp parses untrusted input in C++ and in single precision; it runs in a child process with
 * limits on time and memory, which can open no file, so that a crash, a hang or a memory blow-up in
 * it is one line of error that names the file. */
#ifndef SM_IMPORT_H
#define SM_IMPORT_H

#include "reader.h"

typedef struct {
    double seconds;   /* wall-clock limit of the child; 0: 20, and one for each MB of the file */
    double megabytes; /* memory limit of the child; 0: 4096 (child.h says what counts) */
} SmImportLimits;

/* Reads a mesh as sm_mesh_read() does: n-gons are cut into triangles, node transforms applied (a
 * mirrored part keeps its outside), equal positions merged, several components kept; skins and
 * animations stay in their bind pose. Files that it names are read from its folder and those
 * within. `limits` are Assimp's, and may be NULL as may `left_out`. On SM_OK the caller frees
 * `mesh` with sm_mesh_free(). Errors: SM_INPUT. */
SmCode sm_import(const char *path, const SmImportLimits *limits, SmMesh *mesh,
                 SmMeshLeftOut *left_out, SmError *error);

/* Reads the points of a file that has points and no triangles as sm_mesh_read_points() does. The
 * caller frees both arrays. Errors: SM_INPUT, which includes no points. */
SmCode sm_import_points(const char *path, long *count, double (**position)[3], double (**normal)[3],
                        SmError *error);

/* Reads a file of another format through Assimp; an error in a library without Assimp. */
SmCode sm_import_other(const SmMeshFile *file, const SmImportLimits *limits, SmMesh *mesh,
                       SmMeshLeftOut *left_out, SmError *error);

#endif
