#include "sculpt.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

static SmPrimitive limb(SmPoint from, SmPoint to, double from_radius, double to_radius, double k)
{
    SmPrimitive made = sm_primitive(SM_CONE, k, (double[]){from.x, from.y, from.z},
                                    (double[]){from_radius, to_radius, 0});
    made.tip[0] = to.x, made.tip[1] = to.y, made.tip[2] = to.z;
    return made;
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
                      double radius, double k)
{
    int chain = solid->count + 1, pieces = 5 * (count - 1);
    SmPoint last = {0, 0, 0};
    for (int i = 0; i <= pieces; i++) {
        SmPoint from = sm_sculpt_curve(count, point, (double)i / 5);
        SmPoint to = {from.x + ray.x, from.y + ray.y, from.z + ray.z};
        SmPoint next = sm_sculpt_cast(solid, base, from, to);
        SmPrimitive piece = limb(last, next, radius, radius, k);
        piece.cut = 1;
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

static void add_primitive(SmImplicit *solid, const SmStroke *s)
{
    SmPrimitive made = sm_primitive(s->kind, s->blend, s->centre, s->size);
    made.cut = s->cut;
    made.rounding = s->rounding;
    memcpy(made.tip, s->tip, sizeof made.tip);
    for (int n = 0; n < 2; n++)
        if (s->turn[n].angle != 0) sm_primitive_turn(&made, s->turn[n].axis, s->turn[n].angle);
    sm_implicit_add(solid, &made);
    if (s->form != SM_PAIR || (made.centre[0] == 0 && made.tip[0] == 0)) return;
    made.centre[0] = -made.centre[0];
    made.tip[0] = -made.tip[0];
    for (int row = 0; row < 3; row++) made.axis[row][0] = -made.axis[row][0];
    sm_implicit_add(solid, &made);
}

enum { MOST_POINTS = 8 };

static void add_mirrored_tube(SmImplicit *solid, const SmStroke *s)
{
    SmPoint mirrored[MOST_POINTS] = {{0}};
    assert(s->count > 1 && s->count <= MOST_POINTS);
    for (int i = 0; i < s->count; i++)
        mirrored[i] = (SmPoint){-s->point[i].x, s->point[i].y, s->point[i].z};
    sm_sculpt_tube(solid, s->count, mirrored, s->size[0], s->size[1], s->blend, s->cut);
}

void sm_sculpt(SmImplicit *solid, int count, const SmStroke *stroke)
{
    int base = solid->count;
    for (const SmStroke *s = stroke; s < stroke + count; s++) {
        if (s->form != SM_RELIEF || s == stroke || s[-1].form != SM_RELIEF) base = solid->count;
        if (s->form == SM_TUBES) add_mirrored_tube(solid, s);
        if (s->form == SM_RELIEF)
            sm_sculpt_relief(solid, base, s->count, s->point, (SmPoint){0, 0, -s->point->z},
                             s->size[0], s->blend);
        else if (s->form == SM_TUBE || s->form == SM_TUBES)
            sm_sculpt_tube(solid, s->count, s->point, s->size[0], s->size[1], s->blend, s->cut);
        else
            add_primitive(solid, s);
    }
}
