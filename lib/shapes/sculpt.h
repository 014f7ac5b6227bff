/* sculpt.h - the procedural models as implicit solids: tables of strokes, and what these do.
 *
 * Sculptures stand on or near y = 0, look towards +z, and are metres apart from a final scaling by
 * shape.c. */
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
void sm_sculpt_rockerarm(SmImplicit *solid);
void sm_sculpt_gargoyle(SmImplicit *solid);
void sm_sculpt_bust(SmImplicit *solid);

typedef struct {
    double x, y, z;
} SmPoint;

typedef enum {
    SM_ONE,    /* a primitive */
    SM_PAIR,   /* and its mirror image in x = 0, when it is off that plane */
    SM_TUBE,   /* a tube through the points */
    SM_TUBES,  /* that of the points' mirror images, and then that */
    SM_RELIEF, /* a tube laid on what there was before the first of such strokes in a row: the
                  points are cast along z onto the plane z = 0 */
} SmStrokeForm;

/* A stroke: sizes as in SmPrimitive, of a tube its first and its last radius. */
typedef struct {
    SmStrokeForm form;
    SmPrimitiveKind kind;
    int cut;      /* taken away */
    double blend; /* with what is already there */
    double centre[3], size[3], tip[3], rounding;
    struct {
        int axis;
        double angle;
    } turn[2]; /* in this order */
    int count;
    const SmPoint *point; /* [count] */
} SmStroke;

/* Rows of a table: a place, radii or another size, a blend, and perhaps more members. */
#define STROKE(form_, kind_, cut_, x, y, z, a, b, c, k, ...)                                       \
    {                                                                                              \
        .form = (form_), .kind = (kind_), .cut = (cut_), .centre = {x, y, z}, .size = {a, b, c},   \
        .blend = (k), __VA_ARGS__                                                                  \
    }
#define EGG(...)                  STROKE(SM_ONE, SM_ELLIPSOID, 0, __VA_ARGS__, )
#define EGGS(...)                 STROKE(SM_PAIR, SM_ELLIPSOID, 0, __VA_ARGS__, )
#define PIT(...)                  STROKE(SM_ONE, SM_ELLIPSOID, 1, __VA_ARGS__, )
#define PITS(...)                 STROKE(SM_PAIR, SM_ELLIPSOID, 1, __VA_ARGS__, )
#define BRICK(...)                STROKE(SM_ONE, SM_BRICK, 0, __VA_ARGS__, )
#define RING(x, y, z, a, b, ...)  STROKE(SM_ONE, SM_RING, 0, x, y, z, a, b, 0, __VA_ARGS__, )
#define RINGS(x, y, z, a, b, ...) STROKE(SM_PAIR, SM_RING, 0, x, y, z, a, b, 0, __VA_ARGS__, )

/* A ball of radius `r` at (x, y, z) swept to one of radius `s` at (X, Y, Z). */
#define LIMB(x, y, z, X, Y, Z, r, s, k)                                                            \
    STROKE(SM_ONE, SM_CONE, 0, x, y, z, r, s, 0, k, .tip = {X, Y, Z})
#define LIMBS(x, y, z, X, Y, Z, r, s, k)                                                           \
    STROKE(SM_PAIR, SM_CONE, 0, x, y, z, r, s, 0, k, .tip = {X, Y, Z})

/* Points {x, y, z} follow the radii and the blend. */
#define PATH(form_, cut_, r, s, k, ...)                                                            \
    STROKE(form_, SM_CONE, cut_, 0, 0, 0, r, s, 0, k, .point = (const SmPoint[]){__VA_ARGS__},     \
           .count = sizeof((SmPoint[]){__VA_ARGS__}) / sizeof(SmPoint))
#define TUBE(...)    PATH(SM_TUBE, 0, __VA_ARGS__)
#define TUBES(...)   PATH(SM_TUBES, 0, __VA_ARGS__)
#define GROOVE(...)  PATH(SM_TUBE, 1, __VA_ARGS__)
#define GROOVES(...) PATH(SM_TUBES, 1, __VA_ARGS__)
#define RELIEF(...)  PATH(SM_RELIEF, 1, __VA_ARGS__)

/* Adds all strokes of a table. */
void sm_sculpt(SmImplicit *solid, int count, const SmStroke *stroke);
#define SCULPT(solid, table) sm_sculpt(solid, (int)(sizeof(table) / sizeof *(table)), table)

/* A tube through the points along a Catmull-Rom curve, its radius going from the first to the
 * second; cut: a groove instead. */
void sm_sculpt_tube(SmImplicit *solid, int count, const SmPoint *point, double from_radius,
                    double to_radius, double k, int cut);

/* A groove in the surface of the first `base` primitives: the points are cast along `ray`. */
void sm_sculpt_relief(SmImplicit *solid, int base, int count, const SmPoint *point, SmPoint ray,
                      double radius, double k);

/* First point of the solid's first `base` primitives on the ray from `from` towards `to`; `to` when
 * there is none. */
SmPoint sm_sculpt_cast(const SmImplicit *solid, int base, SmPoint from, SmPoint to);

/* The point at `at`, 0..count - 1, on the Catmull-Rom curve through `count` points. */
SmPoint sm_sculpt_curve(int count, const SmPoint *point, double at);

#endif
