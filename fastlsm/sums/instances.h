/* instances.h - many bodies that share one lattice: a lane of every vector is a body.
 *
 * All lists are the same for all bodies, so the list form of the sums (sums.h) runs on
 * SM_LANES bodies at once, with no gathering and no empty lanes but in the last group. */
#ifndef LSM_INSTANCES_H
#define LSM_INSTANCES_H

#include "../../lib/simd/momentum.h"
#include "../state.h"

#define instances_build    SM_NAME(instances_build)
#define instances_free     SM_NAME(instances_free)
#define instances_step     SM_NAME(instances_step)
#define instances_goals    SM_NAME(instances_goals)
#define instances_recentre SM_NAME(instances_recentre)
#define instances_bytes    SM_NAME(instances_bytes)

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
} Instances;

/* At rest, all at the same place; lsm stays the caller's and must outlive the instances. */
Instances *instances_build(const Lsm *lsm, long bodies);
void instances_free(Instances *instances);

/* One step of every body, as lsm_step(). Laps are those of thread 0. */
void instances_step(Instances *instances, SmLaps *laps);
void instances_goals(Instances *instances);

/* Moves each body's origin to its middle, by whole cells. Returns the most that one was off along
 * an axis. */
double instances_recentre(Instances *instances, Momentum *momentum);

long instances_bytes(const Instances *instances);

#endif
