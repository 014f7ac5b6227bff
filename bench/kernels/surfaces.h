/* surfaces.h - the voxeliser, the embedding and the octree surface, on the statue of 200,000
 * triangles. */
#ifndef BENCH_SURFACES_H
#define BENCH_SURFACES_H

#include <stdbool.h>

#include "../../lib/error.h"
#include "../measure/moment.h"

/* BENCH_CARRY is the surface animation of the octree (octree/surface/surface.h), sampled by
 * features. */
typedef enum { BENCH_VOXELISE, BENCH_EMBED, BENCH_CARRY, BENCH_SURFACE_KERNELS } BenchSurfaceKernel;

typedef struct {
    long triangles, vertices, particles;
    long nodes;           /* of the octree that move the surface */
    double nodes_blended; /* a vertex, on average */
    struct BenchSurfaceTime {
        bool wanted; /* set by the caller */
        bool valid;
        char reason[128];
        BenchWatch watch; /* of the samples */
        double *ns; /* [repeats] a triangle, or a vertex, normal included; the caller's to free */
    } kernel[BENCH_SURFACE_KERNELS];
} BenchSurface;

/* Voxelises to about 57,626 particles (the search for the cell size is not timed) and embeds the
 * surface. Checks: every vertex and triangle centre lies in a material cell; a turned lattice
 * and a turned octree carry the vertices with them to 1e-4 of a cell. */
SmCode bench_surface_time(int threads, int repeats, BenchSurface *surface, SmError *error);

#endif
