/* crowd.h - many bodies that share one lattice: a lane of every vector is a body.
 *
 * All lists are the same for all bodies, so the list form of the sums (summation.h) runs on
 * SM_LANES bodies at once, with no gathering and no empty lanes but in the last group. */
#ifndef LSM_CROWD_H
#define LSM_CROWD_H

#include "../../lib/simd/momentum.h"
#include "../state.h"

#define crowd_build    SM_NAME(crowd_build)
#define crowd_free     SM_NAME(crowd_free)
#define crowd_step     SM_NAME(crowd_step)
#define crowd_goals    SM_NAME(crowd_goals)
#define crowd_recentre SM_NAME(crowd_recentre)
#define crowd_bytes    SM_NAME(crowd_bytes)

typedef struct {
    const Lsm *lsm; /* lattice, lists and constants of one body, in list form */
    long bodies, groups;
    real *x, *v, *g;              /* [groups][particles][3][lanes] */
    short *last;                  /* [groups][particles][6][lanes] */
    double (*origin)[3];          /* [groups * lanes] */
    real *weight, *inverse_count; /* [particles] m~, 1 / |R| */
    real (*region)[4];            /* [particles] 1 / M_r, c0_r - x0_r */
    int *original;                /* [particles] particle whose region is the same */
    int threads;
    real **scratch; /* [threads] rows of one group */
} Crowd;

/* At rest, all at the same place; lsm stays the caller's and must outlive the crowd. */
Crowd *crowd_build(const Lsm *lsm, long bodies);
void crowd_free(Crowd *crowd);

/* One step of every body, as lsm_step(). Laps are those of thread 0. */
void crowd_step(Crowd *crowd, SmLaps *laps);
void crowd_goals(Crowd *crowd);

/* Moves each body's origin to its middle, by whole cells. Returns the most that one was off along
 * an axis. */
double crowd_recentre(Crowd *crowd, Momentum *momentum);

long crowd_bytes(const Crowd *crowd);

#endif
