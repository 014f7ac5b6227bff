/* nodes.h - an octree in the group /nodes of a trajectory: all that distances, regions and a step
 * can be recomputed from. */
#ifndef BENCH_NODES_H
#define BENCH_NODES_H

#include "../store/h5.h"
#include "trajectory.h"

/* Writes parameters, tree, leaves, visibility edges and regions. */
void bench_nodes_write(BenchH5 *h5, hid_t group, const BenchTrajectoryParams *params);

#endif
