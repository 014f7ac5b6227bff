/* surfaces.h - the voxeliser and the embedding, on the statue of 200,000 triangles. */
#ifndef BENCH_SURFACES_H
#define BENCH_SURFACES_H

#include <stdbool.h>

#include "../lib/error.h"

typedef struct {
    bool voxelise, embed; /* wanted; set by the caller */
    long triangles, vertices, particles;
    bool voxelise_valid, embed_valid;
    char voxelise_reason[128], embed_reason[128];
    double *voxelise_ns; /* [repeats] a triangle; the caller's to free, as the next */
    double *embed_ns;    /* [repeats] a vertex, normal included */
} BenchSurface;

/* Voxelises to about 57,626 particles (the search for the cell size is not timed) and embeds the
 * surface. Checks: every vertex and triangle centre lies in a material cell; a turned lattice
 * carries the vertices with it to 1e-4 of a cell. */
SmCode bench_surface_time(int threads, int repeats, BenchSurface *surface, SmError *error);

#endif
