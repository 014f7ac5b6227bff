/* test_point.h - a point of a sweep as if it had been measured. */
#ifndef BENCH_TEST_POINT_H
#define BENCH_TEST_POINT_H

#include <math.h>
#include <string.h>

#include "point.h"

/* Point 0 is the lattice's with w 1, those after it the octree's with epsilon 0, 0.5 and 1, and so
 * on with w 2; times' quartiles are 5% to each side. Without a time (NaN) it is not valid. */
static BenchPoint make_point(int index, double ms, double path, double hz)
{
    BenchPoint point = bench_point_none();
    bool tree = index % 4 > 0;
    point.index = index;
    strcpy(point.engine, tree ? "octree" : "fastlsm");
    point.w = 1 + index / 4;
    point.epsilon = tree ? 0.5 * (index % 4 - 1) : 0;
    point.valid = isfinite(ms);
    point.particles = 295;
    point.total_ms = ms;
    point.total_low_ms = 0.95 * ms;
    point.total_high_ms = 1.05 * ms;
    point.path_rms = path;
    point.path_most = 2 * path;
    point.goal_rms = 0.02;
    point.frequency = hz;
    point.sag = 0.1;
    return point;
}

#endif
