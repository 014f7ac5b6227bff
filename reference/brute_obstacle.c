#include "brute_obstacle.h"

#include <math.h>
#include <string.h>

#include "../lib/vector.h"

/* Depth of x below the plane through a with free side n. */
static double plane_depth(const SmObstacle *plane, const double x[3], double normal[3])
{
    memcpy(normal, plane->b, 3 * sizeof *normal);
    const double d[3] = {x[0] - plane->a[0], x[1] - plane->a[1], x[2] - plane->a[2]};
    return -sm_dot(d, normal);
}

/* Depth of x in the ball about `centre`; `spare` is the way out at the centre. */
static double ball_depth(const double centre[3], double radius, const double spare[3],
                         const double x[3], double normal[3])
{
    const double d[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
    double distance = hypot(hypot(d[0], d[1]), d[2]);
    for (int a = 0; a < 3; a++) normal[a] = distance > 0 ? d[a] / distance : spare[a];
    return radius - distance;
}

static double box_depth(const SmObstacle *box, const double x[3], double normal[3])
{
    double least = INFINITY;
    for (int face = 0; face < 6; face++) {
        int axis = face / 2;
        double depth = face % 2 ? box->b[axis] - x[axis] : x[axis] - box->a[axis];
        if (!(depth < least)) continue;
        least = depth;
        memset(normal, 0, 3 * sizeof *normal);
        normal[axis] = face % 2 ? 1 : -1;
    }
    return least;
}

/* The unit axis least along d, made perpendicular to it. */
static void across(const double d[3], double normal[3])
{
    int least = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(d[a]) < fabs(d[least])) least = a;
    double square = sm_dot(d, d), length;
    for (int a = 0; a < 3; a++) normal[a] = (a == least) - d[a] * d[least] / square;
    length = sqrt(sm_dot(normal, normal));
    for (int a = 0; a < 3; a++) normal[a] /= length;
}

static double capsule_depth(const SmObstacle *capsule, const double x[3], double normal[3])
{
    const double *a = capsule->a, *b = capsule->b;
    const double axis[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double d[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
    double square = sm_dot(axis, axis), spare[3] = {0, 1, 0};
    double along = square > 0 ? fmin(fmax(sm_dot(d, axis) / square, 0), 1) : 0;
    if (square > 0) across(axis, spare);
    const double nearest[3] = {a[0] + along * axis[0], a[1] + along * axis[1],
                               a[2] + along * axis[2]};
    return ball_depth(nearest, capsule->radius, spare, x, normal);
}

static double depth_of(const SmObstacle *obstacle, const double x[3], double normal[3])
{
    static const double up[3] = {0, 1, 0};
    switch (obstacle->kind) {
    case SM_PLANE:
        return plane_depth(obstacle, x, normal);
    case SM_SPHERE:
        return ball_depth(obstacle->a, obstacle->radius, up, x, normal);
    case SM_BOX:
        return box_depth(obstacle, x, normal);
    case SM_CAPSULE:
        return capsule_depth(obstacle, x, normal);
    }
    return 0;
}

bool ref_obstacle_push_out(const SmObstacle *obstacle, double x[3], double v[3])
{
    double normal[3];
    double depth = depth_of(obstacle, x, normal);
    if (!(depth > 0)) return false;
    double outwards = sm_dot(v, normal), kept = fmax(outwards, 0);
    for (int a = 0; a < 3; a++) {
        x[a] += depth * normal[a];
        v[a] = kept * normal[a] + (1 - obstacle->friction) * (v[a] - outwards * normal[a]);
    }
    return true;
}
