/* map.h - the conformal map of a surface and the nodes that a shell has in it, looked at and in
 * HDF5: what the shell engine makes of the same mesh or points, before it moves.
 *
 * The file: kind = "shapebench map", schema = 1; its groups are results/README.md's. */
#ifndef BENCH_MAP_H
#define BENCH_MAP_H

#include "../../reference/meshless/map/surface_map.h"
#include "../../reference/meshless/shell/shell.h"

typedef struct {
    RefSurfaceMap map;
    RefShell shell;
    double shell_seconds;
    double spread;                /* of cells' edges on the surface (bench_map_spread()) */
    double factors[3];            /* least, median and most L of the points */
    long least_covers, uncovered; /* how many nodes cover a point, of those that enough cover; of
                                     how many they are too few for shape functions */
    double mean_covers;
} BenchMap;

/* Maps the surface of a mesh or of points (bench_points_or_mesh()) and builds a shell of so many
 * nodes over it (0: REF_SHELL_NODES). `map` must not move in memory. The caller frees. Errors:
 * those of reading and those that the engine has (surface_map.h, shell.h). */
SmCode bench_map_make(const char *source, long nodes, BenchMap *map, SmError *error);
void bench_map_free(BenchMap *map);

/* How unevenly cells lie on the surface: the standard deviation of the lengths that their edges
 * have there, l by the root of the mean of L^2, over these lengths' mean. Cells that are halved
 * where a length is too long leave about a fifth. */
double bench_map_spread(const RefQuadtree *tree);

/* Errors: SM_OUTPUT. */
SmCode bench_map_write(const BenchMap *map, const char *source, const char *path, SmError *error);

#endif
