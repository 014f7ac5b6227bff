/* sampled.h - the bodies that the octree's kernels are timed on: sampled, with graph and regions.
 *
 * The hand is that of the octree paper's table: 661 nodes from 28 base cells over the finest cells
 * of a lattice of 35,000 particles, regions of 0.75 of each node's edge, which gives about 6
 * summation nodes a region; or regular, 35,000 finest cells, regions of one edge. Cubes are
 * regular, a node in every cell, with regions of one edge. epsilon is 0.5 throughout. */
#ifndef BENCH_SAMPLED_H
#define BENCH_SAMPLED_H

#include "../../octree/region/region.h"
#include "../../octree/tree/sampling.h"

typedef struct {
    SmVoxels voxels;
    OctSampling sampling;
    double edges, epsilon; /* of every region */
    OctTree tree;
    int *w;       /* [leaves] half finest cells */
    double *mass; /* [leaves] */
    OctGraph graph;
    OctRegions regions;
} BenchSampled;

/* Bodies that are no cube, in place of a side. */
enum { BENCH_HAND = 0, BENCH_REGULAR_HAND = -1 };

/* Errors: those of making the shape, its voxels and its tree; of a cube SM_MEMORY (room.h); on
 * which `body` is zeroed. */
SmCode bench_sampled_hand(bool regular, BenchSampled *body, SmError *error);
SmCode bench_sampled_cube(int side, BenchSampled *body, SmError *error);
void bench_sampled_free(BenchSampled *body);

/* Widths and masses of a tree's nodes; the caller frees both. */
void bench_sampled_widths(const OctTree *tree, double edges, int **w, double **mass);

/* Leaves of all regions, each as often as it is in one. */
double bench_sampled_members(const BenchSampled *body);

#endif
