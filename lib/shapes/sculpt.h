/* sculpt.h - the procedural models as implicit solids, and the strokes that they are made with.
 *
 * Sculptures stand on or near y = 0, look towards +z, and are metres apart from a final scaling by
 * shape.c. `k` is the blend with what is already there. */
#ifndef SM_SCULPT_H
#define SM_SCULPT_H

#include "implicit.h"

typedef void (*SmSculptor)(SmImplicit *solid);

void sm_sculpt_penguin(SmImplicit *solid);
void sm_sculpt_statue(SmImplicit *solid);
void sm_sculpt_infant(SmImplicit *solid);
void sm_sculpt_hand(SmImplicit *solid);
void sm_sculpt_liver(SmImplicit *solid);
void sm_sculpt_flower(SmImplicit *solid);
void sm_sculpt_balljoint(SmImplicit *solid);
void sm_sculpt_rabbit(SmImplicit *solid);
void sm_sculpt_santa(SmImplicit *solid);

typedef struct {
    double x, y, z;
} SmPoint;

/* Adds the primitive and, when it is off the plane x = 0, its mirror image. */
void sm_sculpt_pair(SmImplicit *solid, const SmPrimitive *primitive);

/* Ellipsoid with the given radii; the pair form adds its mirror image in x = 0 too. */
void sm_sculpt_egg(SmImplicit *solid, SmPoint centre, SmPoint radii, double k);
void sm_sculpt_eggs(SmImplicit *solid, SmPoint centre, SmPoint radii, double k);

/* A ball of radius `from_radius` swept to one of `to_radius`. */
void sm_sculpt_limb(SmImplicit *solid, SmPoint from, SmPoint to, double from_radius,
                    double to_radius, double k);
void sm_sculpt_limbs(SmImplicit *solid, SmPoint from, SmPoint to, double from_radius,
                     double to_radius, double k);

/* A tube through the points along a Catmull-Rom curve, its radius going from the first to the
 * second; cut: a groove instead. */
void sm_sculpt_tube(SmImplicit *solid, int count, const SmPoint *point, double from_radius,
                    double to_radius, double k, int cut);

/* A tube laid on the surface of the first `base` primitives: the points are cast along `ray`. */
void sm_sculpt_relief(SmImplicit *solid, int base, int count, const SmPoint *point, SmPoint ray,
                      double radius, double k, int cut);

/* First point of the solid's first `base` primitives on the ray from `from` towards `to`; `to` when
 * there is none. */
SmPoint sm_sculpt_cast(const SmImplicit *solid, int base, SmPoint from, SmPoint to);

/* The point at `at`, 0..count - 1, on the Catmull-Rom curve through `count` points. */
SmPoint sm_sculpt_curve(int count, const SmPoint *point, double at);

#endif
