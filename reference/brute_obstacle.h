/* brute_obstacle.h - what an obstacle does to one particle; the readable twin of the engines'
 * kernels. */
#ifndef REF_BRUTE_OBSTACLE_H
#define REF_BRUTE_OBSTACLE_H

#include "../lib/engine/boundary.h"

/* A particle at x inside the obstacle moves to the nearest point of its surface; its velocity loses
 * what points inwards and `friction` of what is tangential. Where every direction is as near (the
 * centre of a sphere) it leaves along y; on a capsule's axis, across it; inside a box, of equally
 * near faces, by the first of -x, +x, -y, +y, -z, +z. Returns whether it was inside. */
bool ref_obstacle_push_out(const SmObstacle *obstacle, double x[3], double v[3]);

#endif
