/* boundary.h - what holds or stops particles: handles, pins, planes, obstacles.
 *
 * Engines call the precision-specific functions in nodes.h; this header is the description only.
 * Lengths in mesh units, times in seconds. */
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

#endif
