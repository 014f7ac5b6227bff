#include <math.h>

#include "sculpt.h"
#include "sine.h"

static const double head[3] = {0.012, 0.325, 0.012};
static const double tilt = 0.85; /* of the head, from looking up towards looking ahead */

/* Adds a primitive given relative to the head looking up, turned with the head. */
static void add_to_head(SmImplicit *solid, SmPrimitive made)
{
    double c = sm_cos(tilt), s = sm_sin(tilt), y = made.centre[1], z = made.centre[2];
    made.centre[0] += head[0];
    made.centre[1] = head[1] + c * y - s * z;
    made.centre[2] = head[2] + s * y + c * z;
    sm_primitive_turn(&made, 0, tilt);
    sm_implicit_add(solid, &made);
}

static void petals(SmImplicit *solid, int count, double out, const double size[3], double lift,
                   double bend, double height)
{
    for (int i = 0; i < count; i++) {
        double angle = 2 * M_PI * i / count, c = sm_cos(angle), s = sm_sin(angle);
        SmPrimitive petal =
            sm_primitive(SM_PETAL, 0.003, (double[]){out * s, height, out * c}, size);
        petal.bend[0] = 4;
        petal.bend[1] = bend;
        sm_primitive_turn(&petal, 0, -lift);
        sm_primitive_turn(&petal, 1, angle);
        add_to_head(solid, petal);
    }
}

static void leaf(SmImplicit *solid, const double centre[3], double turn, double rise)
{
    SmPrimitive blade = sm_primitive(SM_PETAL, 0.003, centre, (double[]){0.021, 0.0021, 0.056});
    blade.bend[0] = 8;
    blade.bend[1] = -4;
    sm_primitive_turn(&blade, 0, -rise);
    sm_primitive_turn(&blade, 1, turn);
    sm_implicit_add(solid, &blade);
}

/* A daisy with eight thin petals, a thin stem and two leaves, 0.4 tall. */
void sm_sculpt_flower(SmImplicit *solid)
{
    static const SmPoint stem[5] = {{0, 0.004, 0},
                                    {-0.006, 0.09, 0.002},
                                    {-0.002, 0.19, -0.004},
                                    {0.008, 0.27, -0.006},
                                    {0.012, 0.32, 0.006}};
    sm_sculpt_tube(solid, 5, stem, 0.0062, 0.0050, 0.001, 0);
    add_to_head(solid, sm_primitive(SM_ELLIPSOID, 0.004, (double[]){0, 0.003, 0},
                                    (double[]){0.034, 0.015, 0.034}));
    petals(solid, 8, 0.066, (double[]){0.0225, 0.0021, 0.046}, 0.12, -3.0, 0.004);
    for (int i = 0; i < 13; i++) { /* florets, in the spiral of the golden angle */
        double r = 0.0074 * sqrt(i + 0.2), angle = 2.399963 * i;
        add_to_head(solid, sm_primitive(
                               SM_ELLIPSOID, 0.001,
                               (double[]){r * sm_sin(angle), 0.0165 - 9 * r * r, r * sm_cos(angle)},
                               (double[]){0.0056, 0.0052, 0.0056}));
    }
    leaf(solid, (double[]){0.038, 0.120, 0.012}, 1.35, 0.65);
    leaf(solid, (double[]){-0.042, 0.172, 0.002}, -1.5, 0.7);
}
