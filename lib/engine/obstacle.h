/* obstacle.h - static obstacles push particles out, SM_LANES at a time.
 *
 * A particle inside goes to the nearest point of the surface, loses the velocity that leads inwards
 * and the share `friction` of the tangential one. One that moves by less than half an obstacle's
 * thickness in a step does not get through it; a plane has no far side (collide.h has the speed of
 * a body). Twin: reference/brute_obstacle.c. */
#ifndef SM_OBSTACLE_H
#define SM_OBSTACLE_H

#include "../simd/lanes.h"
#include "boundary.h"

/* A static obstacle in an engine's own units: lattice cells from its home origin. */
typedef struct {
    SmObstacleKind kind;
    real a[3], b[3], radius, friction;
    real inverse; /* capsule: 1 / |b - a|^2, or 0 */
} Obstacle;

/* From mesh units. */
SM_INLINE Obstacle obstacle_in_cells(const SmObstacle *from, const double home[3], double cell)
{
    Obstacle to = {.kind = from->kind,
                   .radius = (real)(from->radius / cell),
                   .friction = (real)from->friction};
    for (int d = 0; d < 3; d++) {
        to.a[d] = (real)((from->a[d] - home[d]) / cell);
        to.b[d] = from->kind == SM_PLANE ? (real)from->b[d] : (real)((from->b[d] - home[d]) / cell);
    }
    real square = 0;
    for (int d = 0; d < 3; d++) square += (to.b[d] - to.a[d]) * (to.b[d] - to.a[d]);
    to.inverse = square > 0 ? 1 / square : 0;
    return to;
}

SM_INLINE vec lanes_dot(const vec a[3], const vec b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Depth in the ball about `centre`; where x is the centre itself, `spare` is the way out. */
SM_INLINE vec ball_depth(const vec centre[3], real radius, const real spare[3], const vec x[3],
                         vec normal[3])
{
    vec d[3];
    for (int i = 0; i < 3; i++) d[i] = x[i] - centre[i];
    vec distance = lanes_sqrt(lanes_dot(d, d));
    ivec away = distance > 0;
    vec inverse = 1 / lanes_select(away, distance, lanes_set(1));
    for (int i = 0; i < 3; i++) normal[i] = lanes_select(away, d[i] * inverse, lanes_set(spare[i]));
    return radius - distance;
}

SM_INLINE vec box_depth(const Obstacle *o, const vec x[3], vec normal[3])
{
    vec least = lanes_set((real)1e30);
    for (int i = 0; i < 3; i++) normal[i] = lanes_set(0);
    for (int face = 0; face < 6; face++) {
        int axis = face / 2;
        vec depth = face % 2 ? o->b[axis] - x[axis] : x[axis] - o->a[axis];
        ivec nearer = depth < least;
        least = lanes_select(nearer, depth, least);
        for (int i = 0; i < 3; i++)
            normal[i] = lanes_select(nearer,
                                     lanes_set(i != axis  ? 0
                                               : face % 2 ? 1
                                                          : -1),
                                     normal[i]);
    }
    return least;
}

/* The unit axis least along d, made perpendicular to it; +y where d is zero. */
SM_INLINE void across(const real d[3], real normal[3])
{
    int least = 0;
    real square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], length = 0;
    for (int i = 1; i < 3; i++)
        if (fabs((double)d[i]) < fabs((double)d[least])) least = i;
    if (!(square > 0)) least = 1;
    for (int i = 0; i < 3; i++) {
        normal[i] = (real)(i == least) - (square > 0 ? d[i] * d[least] / square : 0);
        length += normal[i] * normal[i];
    }
    for (int i = 0; i < 3; i++) normal[i] /= (real)sqrt((double)length);
}

SM_INLINE vec capsule_depth(const Obstacle *o, const vec x[3], vec normal[3])
{
    real axis[3], spare[3], square = 0;
    vec along = lanes_set(0), nearest[3];
    for (int i = 0; i < 3; i++) {
        axis[i] = o->b[i] - o->a[i];
        square += axis[i] * axis[i];
        along += (x[i] - o->a[i]) * axis[i];
    }
    across(axis, spare);
    along = square > 0 ? along / square : lanes_set(0);
    along = lanes_max(lanes_select(along > 1, lanes_set(1), along), lanes_set(0));
    for (int i = 0; i < 3; i++) nearest[i] = o->a[i] + along * axis[i];
    return ball_depth(nearest, o->radius, spare, x, normal);
}

SM_INLINE vec obstacle_depth(const Obstacle *o, const vec x[3], vec normal[3])
{
    static const real up[3] = {0, 1, 0};
    vec a[3], d[3];
    for (int i = 0; i < 3; i++) {
        a[i] = lanes_set(o->a[i]);
        d[i] = x[i] - a[i];
        normal[i] = lanes_set(o->b[i]);
    }
    switch (o->kind) {
    case SM_SPHERE:
        return ball_depth(a, o->radius, up, x, normal);
    case SM_BOX:
        return box_depth(o, x, normal);
    case SM_CAPSULE:
        return capsule_depth(o, x, normal);
    default:
        return -lanes_dot(d, normal); /* plane */
    }
}

/* Nearly always: every particle is outside, farther than rounding. */
SM_INLINE bool obstacle_missed(const Obstacle *o, const vec x[3])
{
    vec d[3], along = lanes_set(0);
    if (o->kind == SM_PLANE) return false;
    for (int i = 0; i < 3; i++) d[i] = x[i] - o->a[i];
    if (o->kind == SM_BOX) {
        ivec out = d[0] < 0;
        for (int i = 0; i < 3; i++) out = out | (d[i] < 0) | (x[i] > o->b[i]);
        return !lanes_any(~out);
    }
    if (o->kind == SM_CAPSULE) {
        for (int i = 0; i < 3; i++) along += d[i] * (o->b[i] - o->a[i]);
        along *= o->inverse;
        along = lanes_max(lanes_select(along > 1, lanes_set(1), along), lanes_set(0));
        for (int i = 0; i < 3; i++) d[i] -= along * (o->b[i] - o->a[i]);
    }
    return !lanes_any(~(lanes_dot(d, d) > (real)1.01 * o->radius * o->radius));
}

/* All obstacles in turn on the particles at x + shift; whether any is pushed. */
SM_INLINE bool obstacles_push(const Obstacle *obstacle, int count, const vec shift[3], vec x[3],
                              vec v[3])
{
    bool pushed = false;
    for (int n = 0; n < count; n++) {
        vec at[3], normal[3];
        for (int i = 0; i < 3; i++) at[i] = x[i] + shift[i];
        if (obstacle_missed(&obstacle[n], at)) continue;
        vec depth = obstacle_depth(&obstacle[n], at, normal);
        ivec inside = depth > 0;
        if (!lanes_any(inside)) continue;
        pushed = true;
        vec outwards = lanes_dot(v, normal), kept = lanes_max(outwards, lanes_set(0));
        real slip = 1 - obstacle[n].friction;
        for (int i = 0; i < 3; i++) {
            vec slowed = kept * normal[i] + slip * (v[i] - outwards * normal[i]);
            v[i] = lanes_select(inside, slowed, v[i]);
            x[i] = lanes_select(inside, x[i] + depth * normal[i], x[i]);
        }
    }
    return pushed;
}

#endif
