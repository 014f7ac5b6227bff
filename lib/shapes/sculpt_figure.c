#include <math.h>

#include "sculpt.h"
#include "sine.h"

/* A cartoon penguin, 1.0 tall. */
static void penguin_feet(SmImplicit *solid)
{
    for (int toe = -1; toe <= 1; toe++)
        sm_sculpt_limbs(solid, (SmPoint){0.125, 0.035, 0.10},
                        (SmPoint){0.135 + 0.075 * toe, 0.024, 0.27 - 0.02 * toe * toe}, 0.045,
                        0.024, 0.025);
    sm_sculpt_eggs(solid, (SmPoint){0.125, 0.05, 0.06}, (SmPoint){0.085, 0.05, 0.09}, 0.04);
}

static void penguin_face(SmImplicit *solid)
{
    sm_sculpt_eggs(solid, (SmPoint){0.075, 0.835, 0.120}, (SmPoint){0.082, 0.100, 0.080}, 0.03);
    sm_sculpt_eggs(solid, (SmPoint){0.066, 0.855, 0.188}, (SmPoint){0.040, 0.052, 0.024}, 0.006);
    SmPrimitive rim =
        sm_primitive(SM_RING, 0.004, (double[]){0.066, 0.855, 0.196}, (double[]){0.044, 0.006, 0});
    rim.cut = 1;
    sm_primitive_turn(&rim, 0, 1.45);
    sm_sculpt_pair(solid, &rim);
    sm_sculpt_eggs(solid, (SmPoint){0.060, 0.852, 0.208}, (SmPoint){0.019, 0.026, 0.014}, 0.003);
    sm_sculpt_limb(solid, (SmPoint){0, 0.780, 0.18}, (SmPoint){0, 0.772, 0.395}, 0.058, 0.014,
                   0.012);
    sm_sculpt_egg(solid, (SmPoint){0, 0.750, 0.20}, (SmPoint){0.072, 0.028, 0.085}, 0.008);
    sm_sculpt_tube(solid, 3,
                   (SmPoint[]){{0.085, 0.765, 0.20}, {0, 0.755, 0.375}, {-0.085, 0.765, 0.20}},
                   0.006, 0.006, 0.006, 1);
    for (int i = -1; i <= 1; i++) /* tuft */
        sm_sculpt_limb(solid, (SmPoint){0, 0.975, 0.0},
                       (SmPoint){0.045 * i, 1.025 - 0.012 * i * i, -0.05}, 0.022, 0.009, 0.012);
}

/* The white front, with a groove around it. */
static void penguin_belly(SmImplicit *solid)
{
    SmPoint rim[13];
    sm_sculpt_egg(solid, (SmPoint){0, 0.370, 0.085}, (SmPoint){0.215, 0.285, 0.205}, 0.006);
    for (int i = 0; i < 13; i++) {
        double angle = 2 * M_PI * i / 12;
        rim[i] = (SmPoint){0.205 * sm_sin(angle), 0.375 + 0.265 * sm_cos(angle), 0.5};
    }
    int base = solid->count;
    sm_sculpt_relief(solid, base, 13, rim, (SmPoint){0, 0, -0.5}, 0.009, 0.008, 1);
}

void sm_sculpt_penguin(SmImplicit *solid)
{
    SmPrimitive flipper = sm_primitive(SM_ELLIPSOID, 0.06, (double[]){0.352, 0.45, 0},
                                       (double[]){0.042, 0.22, 0.105});
    sm_sculpt_egg(solid, (SmPoint){0, 0.37, 0}, (SmPoint){0.30, 0.35, 0.265}, 0);
    sm_sculpt_egg(solid, (SmPoint){0, 0.80, 0.01}, (SmPoint){0.205, 0.195, 0.19}, 0.14);
    penguin_belly(solid);
    sm_sculpt_limb(solid, (SmPoint){0, 0.15, -0.19}, (SmPoint){0, 0.075, -0.37}, 0.075, 0.02, 0.07);
    sm_primitive_turn(&flipper, 0, 0.15);
    sm_primitive_turn(&flipper, 2, 0.55);
    sm_sculpt_pair(solid, &flipper);
    penguin_face(solid);
    penguin_feet(solid);
}

/* A baby standing with its arms held out, 0.6 tall. */
static void infant_head(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){0, 0.495, -0.005}, (SmPoint){0.098, 0.102, 0.105}, 0.02);
    sm_sculpt_egg(solid, (SmPoint){0, 0.452, 0.02}, (SmPoint){0.082, 0.062, 0.078}, 0.03);
    sm_sculpt_eggs(solid, (SmPoint){0.045, 0.442, 0.058}, (SmPoint){0.036, 0.032, 0.034}, 0.02);
    sm_sculpt_egg(solid, (SmPoint){0, 0.412, 0.062}, (SmPoint){0.024, 0.016, 0.022}, 0.02);
    SmPrimitive socket = sm_primitive(SM_ELLIPSOID, 0.02, (double[]){0.037, 0.486, 0.112},
                                      (double[]){0.024, 0.014, 0.016});
    socket.cut = 1;
    sm_sculpt_pair(solid, &socket);
    sm_sculpt_eggs(solid, (SmPoint){0.037, 0.484, 0.083}, (SmPoint){0.019, 0.016, 0.016}, 0.003);
    sm_sculpt_egg(solid, (SmPoint){0, 0.462, 0.103}, (SmPoint){0.013, 0.012, 0.014}, 0.008);
    sm_sculpt_eggs(solid, (SmPoint){0.01, 0.459, 0.101}, (SmPoint){0.007, 0.006, 0.008}, 0.004);
    sm_sculpt_tube(solid, 3,
                   (SmPoint[]){{0.021, 0.4395, 0.098}, {0, 0.4345, 0.107}, {-0.021, 0.4395, 0.098}},
                   0.0028, 0.0028, 0.003, 1);
    for (int side = -1; side <= 1; side += 2) /* closed lids */
        sm_sculpt_tube(solid, 3,
                       (SmPoint[]){{side * 0.020, 0.481, 0.096},
                                   {side * 0.038, 0.4765, 0.0985},
                                   {side * 0.056, 0.482, 0.089}},
                       0.0022, 0.0022, 0.002, 1);
    SmPrimitive ear = sm_primitive(SM_ELLIPSOID, 0.006, (double[]){0.103, 0.468, 0.0},
                                   (double[]){0.010, 0.024, 0.017});
    sm_primitive_turn(&ear, 1, 0.5);
    sm_sculpt_pair(solid, &ear);
    ear = sm_primitive(SM_ELLIPSOID, 0.004, (double[]){0.114, 0.469, 0.006},
                       (double[]){0.006, 0.013, 0.008});
    ear.cut = 1;
    sm_sculpt_pair(solid, &ear);
    sm_sculpt_tube(
        solid, 4,
        (SmPoint[]){
            {0, 0.593, 0.02}, {0.012, 0.606, 0.035}, {0.005, 0.607, 0.055}, {-0.012, 0.597, 0.052}},
        0.010, 0.005, 0.006, 0); /* curl */
}

static void infant_arms(SmImplicit *solid)
{
    SmPoint shoulder = {0.072, 0.362, -0.002}, elbow = {0.142, 0.312, 0.004},
            wrist = {0.2, 0.292, 0.034};
    sm_sculpt_limbs(solid, shoulder, elbow, 0.035, 0.030, 0.025);
    sm_sculpt_limbs(solid, elbow, wrist, 0.031, 0.020, 0.006);
    sm_sculpt_eggs(solid, (SmPoint){0.222, 0.286, 0.045}, (SmPoint){0.024, 0.014, 0.022}, 0.008);
    static const SmPoint tip[4] = {
        {0.243, 0.281, 0.073}, {0.254, 0.279, 0.062}, {0.257, 0.278, 0.047}, {0.252, 0.278, 0.033}};
    static const SmPoint knuckle[4] = {
        {0.229, 0.285, 0.059}, {0.235, 0.285, 0.053}, {0.237, 0.284, 0.045}, {0.235, 0.284, 0.036}};
    for (int i = 0; i < 4; i++) sm_sculpt_limbs(solid, knuckle[i], tip[i], 0.0075, 0.006, 0.003);
    sm_sculpt_limbs(solid, (SmPoint){0.209, 0.287, 0.057}, (SmPoint){0.216, 0.283, 0.081}, 0.0085,
                    0.0065, 0.004);
}

static void infant_legs(SmImplicit *solid)
{
    sm_sculpt_limbs(solid, (SmPoint){0.053, 0.178, 0}, (SmPoint){0.063, 0.108, 0.012}, 0.044, 0.037,
                    0.010);
    sm_sculpt_limbs(solid, (SmPoint){0.063, 0.100, 0.010}, (SmPoint){0.066, 0.036, -0.004}, 0.037,
                    0.024, 0.004);
    sm_sculpt_limbs(solid, (SmPoint){0.064, 0.022, -0.008}, (SmPoint){0.073, 0.017, 0.043}, 0.023,
                    0.018, 0.012);
    for (int toe = 0; toe < 5; toe++) {
        double r = toe == 0 ? 0.0085 : 0.0065 - 0.0004 * toe;
        double across = -0.0165 + 0.0088 * toe + (toe == 0 ? -0.002 : 0);
        sm_sculpt_eggs(solid, (SmPoint){0.075 + across, 0.011, 0.062 - 0.00032 * toe * toe * 3},
                       (SmPoint){r, r, r + 0.003}, 0.003);
    }
}

void sm_sculpt_infant(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){0, 0.345, -0.002}, (SmPoint){0.082, 0.06, 0.058}, 0);
    sm_sculpt_egg(solid, (SmPoint){0, 0.265, 0.014}, (SmPoint){0.086, 0.085, 0.076}, 0.05);
    sm_sculpt_limb(solid, (SmPoint){0, 0.37, 0}, (SmPoint){0, 0.42, 0}, 0.042, 0.040, 0.02);
    infant_head(solid);
    sm_sculpt_egg(solid, (SmPoint){0, 0.195, 0.0}, (SmPoint){0.098, 0.058, 0.082},
                  0.006); /* nappy */
    sm_sculpt_eggs(solid, (SmPoint){0.036, 0.19, -0.045}, (SmPoint){0.05, 0.048, 0.05}, 0.015);
    SmPrimitive navel = sm_primitive(SM_ELLIPSOID, 0.008, (double[]){0, 0.272, 0.092},
                                     (double[]){0.006, 0.006, 0.008});
    navel.cut = 1;
    sm_implicit_add(solid, &navel);
    SmPrimitive band =
        sm_primitive(SM_RING, 0.006, (double[]){0, 0.236, 0.008}, (double[]){0.083, 0.0075, 0});
    sm_implicit_add(solid, &band);
    infant_arms(solid);
    infant_legs(solid);
}
