/* window_check.h - a step of a solid block of any size, held to brute force at some of its
 * particles.
 *
 * Goals and a damped step of a particle depend on what is within 5 w cells of it: on the goals of
 * its regions' members (2 w), for which their regions are matched (4 w) with masses shared among
 * the members' own (5 w). So the brute-force twin of that window alone, cut out of the block with
 * the positions and velocities that the engine has there, gives the particle the same goal and the
 * same step. */
#ifndef BENCH_WINDOW_CHECK_H
#define BENCH_WINDOW_CHECK_H

#include "../../lib/engine/engine.h"

typedef struct {
    int size[3];              /* particles a side, 2 or more; numbered as by solid_block.h */
    const SmEngineType *type; /* with get_some() and push(); without gravity */
    SmEngine *engine;         /* that has not been stepped; cells are 1 wide, and masses 1 */
    const SmEngineParams *params;
    int samples; /* particles to look at: every second one at a face, an edge or a corner */
    unsigned seed;
} BenchWindows;

typedef struct {
    double goal, limit; /* the largest difference of goals, in cells, and what it may be: as check.h
                         * says, or four roundings of the outermost coordinates if that is more */
    double step, share; /* the largest difference of positions and velocities after a step, in cells
                         * (per step), and the largest share of what may be: the same and what
                         * rounding makes of damping (step_check.h) */
} BenchWindowsFound;

/* Pushes the windows' particles anyhow by up to a tenth of a cell per step, steps twice, and holds
 * goals and the second step to brute force. False and a line in `reason` where they differ by more
 * than they may. O(samples (10 w)^3 (2 w)^3), and three passes of the engine. */
bool bench_windows_check(const BenchWindows *windows, BenchWindowsFound *found, size_t room,
                         char *reason);

#endif
