/* blades.h - where the blades of a scene's cuts are. */
#ifndef BENCH_BLADES_H
#define BENCH_BLADES_H

#include "scene.h"

/* 0 to 1 from start to stop, and a place between two by such a share. */
double bench_share_of(double time, double start, double stop);
void bench_between(const double from[3], const double to[3], double share, double at[3]);

/* A blade at the beginning and the end of a frame: base, tip; base, tip. False while it is not in
 * use. */
bool bench_blade_moves(const BenchCut *cut, double from, double to, double blade[4][3]);

/* Is any of them in use? */
bool bench_blades_move(const BenchScene *scene, double from, double to);

#endif
