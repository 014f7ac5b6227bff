/* boundary.h - what holds or stops particles: handles, pins, planes, obstacles; and an engine's
 * copy of its handles. Lengths in mesh units, times in seconds. */
#ifndef SM_BOUNDARY_H
#define SM_BOUNDARY_H

#include <stdbool.h>

/* A group of particles that follow a rigid motion: the position of particle i is
 * pose * (x0_i, 1). A pin is a handle whose pose stays the identity. */
typedef struct {
    long count;
    const long *particle; /* [count], canonical numbers */
    double pose[3][4];
} SmHandle;

typedef enum { SM_PLANE, SM_SPHERE, SM_BOX, SM_CAPSULE } SmObstacleKind;

/* A static obstacle; material stays outside. */
typedef struct {
    SmObstacleKind kind;
    double a[3]; /* plane: a point; sphere: centre; box: low corner; capsule: one end */
    double
        b[3]; /* plane: unit normal towards the free side; box: high corner; capsule: other end */
    double radius;   /* sphere, capsule */
    double friction; /* share of the tangential velocity lost on contact, 0..1 */
} SmObstacle;

typedef struct {
    int handle_count;
    const SmHandle *handle;
    int obstacle_count;
    const SmObstacle *obstacle;
} SmBoundary;

/* An engine's own copy of the handles that it was given. */
typedef struct {
    int count;
    SmHandle *handle; /* [count] */
    long particles;   /* of all handles */
    /* [particles] for the engine: where they were before the step, handle by handle */
    double (*before)[3];
} SmHandles;

/* Copies the boundary's handles; their particles must be 0 .. particles - 1. Where they hold the
 * same particles as before, only the poses are copied: O(particles), and nothing is allocated.
 * Returns whether they hold others. `own` begins zeroed; sm_handles_free() ends it. */
bool sm_handles_set(SmHandles *own, const SmBoundary *boundary, long particles);
void sm_handles_free(SmHandles *own);

/* to = pose * (from, 1). */
void sm_pose_apply(const double pose[3][4], const double from[3], double to[3]);

#endif
