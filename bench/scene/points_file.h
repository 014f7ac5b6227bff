/* points_file.h - what a meshless body can be made of: a mesh, or points with normals. */
#ifndef BENCH_POINTS_FILE_H
#define BENCH_POINTS_FILE_H

#include "../../reference/meshless/surface/points.h"

/* Reads points from text (x y z nx ny nz) or a PLY file without faces, into `points`; from anything
 * else a mesh, as bench_mesh_load(), into `mesh`. The other one is zeroed, so that both can be
 * freed. Errors: those of reading either. */
SmCode bench_points_or_mesh(const char *path, RefPoints *points, SmMesh *mesh, SmError *error);

#endif
