/* implicit.h - solids as blends of simple primitives: a signed function, negative inside.
 *
 * A solid is a list of primitives folded in order, each joined to (or cut out of) what came before
 * with a rounding of its own (quadratic smooth minimum). The function is close to the distance and
 * changes by at most SM_IMPLICIT_SLOPE per unit length, so that whole blocks of space can be
 * skipped after one sample, and the primitives that cannot matter in a block dropped exactly. */
#ifndef SM_IMPLICIT_H
#define SM_IMPLICIT_H

#include "../box.h"

#define SM_IMPLICIT_SLOPE 1.02

typedef enum {
    SM_ELLIPSOID, /* size: radii */
    SM_CONE,      /* a ball of radius size[0] at centre swept to one of radius size[1] at tip */
    SM_BRICK,     /* size: half edges, rounding included */
    SM_DRUM,      /* cylinder along local y; size: radius, half height */
    SM_RING,      /* torus around local y; size: large and small radius */
    SM_PETAL,     /* plate with an elliptic outline; size: half width (x), half thickness (y),
                     half length (z); bend lifts its border by bend x^2 and bend z^2 */
} SmPrimitiveKind;

typedef struct {
    SmPrimitiveKind kind;
    int cut;      /* 1: taken away instead of added */
    double blend; /* rounding of the seam, length */
    double centre[3];
    double tip[3];               /* SM_CONE only */
    double length, sine, cosine; /* of its axis and its side, by sm_implicit_add() */
    double size[3];
    int chain;       /* neighbours of one chain other than 0 are joined sharply, then blended once;
                        they share blend and cut */
    double rounding; /* of the edges of bricks and drums */
    double bend[2];  /* SM_PETAL: along x and along z, 1/length */
    double axis[3][3]; /* rows: the local axes x, y, z */
} SmPrimitive;

typedef struct {
    int count, room;
    SmPrimitive *primitive;
} SmImplicit;

/* A primitive of that kind with a centre, a size, a blend and no turn; change it, then add it. */
SmPrimitive sm_primitive(SmPrimitiveKind kind, double blend, const double centre[3],
                         const double size[3]);

/* Turns a primitive about its centre: by angle (radians) around global axis 0, 1 or 2. */
void sm_primitive_turn(SmPrimitive *primitive, int axis, double angle);

/* Appends; the copy's cost is amortised O(1). A zeroed SmImplicit is empty. */
void sm_implicit_add(SmImplicit *implicit, const SmPrimitive *primitive);

void sm_implicit_free(SmImplicit *implicit);

/* Value at point p of the `count` primitives listed in `active`, in rising order. */
double sm_implicit_at(const SmImplicit *implicit, const int *active, int count, const double p[3]);

/* Writes to `kept` those of `active` that can matter within `radius` of `centre`, returns the value
 * at centre. The kept ones give the same bits there as all of them. */
double sm_implicit_prune(const SmImplicit *implicit, const int *active, int count,
                         const double centre[3], double radius, int *kept, int *kept_count);

/* A box that holds the solid (cuts ignored; blends may bulge beyond it by a quarter of theirs). */
SmBox sm_implicit_bounds(const SmImplicit *implicit);

#endif
