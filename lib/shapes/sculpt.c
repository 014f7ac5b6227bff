#include "sculpt.h"

#include <math.h>
#include <stdlib.h>

#include "../error.h"

static SmPrimitive egg(SmPoint centre, SmPoint radii, double k)
{
    return sm_primitive(SM_ELLIPSOID, k, (double[]){centre.x, centre.y, centre.z},
                        (double[]){radii.x, radii.y, radii.z});
}

static SmPrimitive limb(SmPoint from, SmPoint to, double from_radius, double to_radius, double k)
{
    SmPrimitive made = sm_primitive(SM_CONE, k, (double[]){from.x, from.y, from.z},
                                    (double[]){from_radius, to_radius, 0});
    made.tip[0] = to.x, made.tip[1] = to.y, made.tip[2] = to.z;
    return made;
}

void sm_sculpt_pair(SmImplicit *solid, const SmPrimitive *primitive)
{
    SmPrimitive mirrored = *primitive;
    sm_implicit_add(solid, primitive);
    mirrored.centre[0] = -mirrored.centre[0];
    mirrored.tip[0] = -mirrored.tip[0];
    for (int row = 0; row < 3; row++) mirrored.axis[row][0] = -mirrored.axis[row][0];
    if (primitive->centre[0] != 0 || primitive->tip[0] != 0) sm_implicit_add(solid, &mirrored);
}

void sm_sculpt_egg(SmImplicit *solid, SmPoint centre, SmPoint radii, double k)
{
    SmPrimitive made = egg(centre, radii, k);
    sm_implicit_add(solid, &made);
}

void sm_sculpt_eggs(SmImplicit *solid, SmPoint centre, SmPoint radii, double k)
{
    SmPrimitive made = egg(centre, radii, k);
    sm_sculpt_pair(solid, &made);
}

void sm_sculpt_limb(SmImplicit *solid, SmPoint from, SmPoint to, double from_radius,
                    double to_radius, double k)
{
    SmPrimitive made = limb(from, to, from_radius, to_radius, k);
    sm_implicit_add(solid, &made);
}

void sm_sculpt_limbs(SmImplicit *solid, SmPoint from, SmPoint to, double from_radius,
                     double to_radius, double k)
{
    SmPrimitive made = limb(from, to, from_radius, to_radius, k);
    sm_sculpt_pair(solid, &made);
}

static double catmull_rom(double a, double b, double c, double d, double t)
{
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

SmPoint sm_sculpt_curve(int count, const SmPoint *point, double at)
{
    int i = (int)at < count - 2 ? (int)at : count - 2;
    const SmPoint *a = &point[i > 0 ? i - 1 : 0], *b = &point[i], *c = &point[i + 1];
    const SmPoint *d = &point[i + 2 < count ? i + 2 : count - 1];
    double t = at - i;
    return (SmPoint){catmull_rom(a->x, b->x, c->x, d->x, t), catmull_rom(a->y, b->y, c->y, d->y, t),
                     catmull_rom(a->z, b->z, c->z, d->z, t)};
}

void sm_sculpt_tube(SmImplicit *solid, int count, const SmPoint *point, double from_radius,
                    double to_radius, double k, int cut)
{
    int pieces = 3 * (count - 1), chain = solid->count + 1; /* no other chain starts there */
    SmPoint last = point[0];
    double last_radius = from_radius;
    for (int i = 1; i <= pieces; i++) {
        double share = (double)i / pieces, radius = from_radius + share * (to_radius - from_radius);
        SmPoint next = sm_sculpt_curve(count, point, share * (count - 1));
        SmPrimitive piece = limb(last, next, last_radius, radius, k);
        piece.cut = cut;
        piece.chain = chain;
        sm_implicit_add(solid, &piece);
        last = next, last_radius = radius;
    }
}

void sm_sculpt_relief(SmImplicit *solid, int base, int count, const SmPoint *point, SmPoint ray,
                      double radius, double k, int cut)
{
    int chain = solid->count + 1, pieces = 5 * (count - 1);
    SmPoint last = {0, 0, 0};
    for (int i = 0; i <= pieces; i++) {
        SmPoint from = sm_sculpt_curve(count, point, (double)i / 5);
        SmPoint to = {from.x + ray.x, from.y + ray.y, from.z + ray.z};
        SmPoint next = sm_sculpt_cast(solid, base, from, to);
        SmPrimitive piece = limb(last, next, radius, radius, k);
        piece.cut = cut;
        piece.chain = chain;
        if (i > 0) sm_implicit_add(solid, &piece);
        last = next;
    }
}

SmPoint sm_sculpt_cast(const SmImplicit *solid, int base, SmPoint from, SmPoint to)
{
    double d[3] = {to.x - from.x, to.y - from.y, to.z - from.z}, walked = 0;
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    int *active = sm_alloc((size_t)base, sizeof *active);
    double p[3] = {from.x, from.y, from.z}, away = length;
    for (int i = 0; i < base; i++) active[i] = i;
    for (int step = 0; step < 60 && walked < length && away > 1e-4; step++) {
        double share = walked / length;
        p[0] = from.x + share * d[0], p[1] = from.y + share * d[1], p[2] = from.z + share * d[2];
        away = sm_implicit_at(solid, active, base, p);
        walked += 0.9 * away;
    }
    free(active);
    return walked < length ? (SmPoint){p[0], p[1], p[2]} : to;
}
