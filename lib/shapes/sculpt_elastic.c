#include "sculpt.h"

/* The upper end of a thigh bone, 0.2 tall: a ball on a slanted neck, two knobs for the tendons, a
 * shaft that widens into a lower end with a shallow socket. */
static void bone_lower_end(SmImplicit *solid)
{
    sm_sculpt_limb(solid, (SmPoint){-0.008, 0.050, 0.001}, (SmPoint){-0.006, 0.020, 0.002}, 0.019,
                   0.026, 0.012);
    sm_sculpt_egg(solid, (SmPoint){-0.006, 0.014, 0.002}, (SmPoint){0.036, 0.020, 0.031}, 0.012);
    SmPrimitive socket = sm_primitive(SM_ELLIPSOID, 0.004, (double[]){-0.006, -0.012, 0.002},
                                      (double[]){0.026, 0.018, 0.022});
    socket.cut = 1;
    sm_implicit_add(solid, &socket);
}

void sm_sculpt_balljoint(SmImplicit *solid)
{
    static const SmPoint crest[4] = {{-0.040, 0.152, -0.016},
                                     {-0.030, 0.138, -0.022},
                                     {-0.016, 0.122, -0.024},
                                     {-0.002, 0.104, -0.018}};
    sm_sculpt_tube(solid, 3,
                   (SmPoint[]){{-0.008, 0.040, 0.001}, {-0.011, 0.080, 0}, {-0.013, 0.125, -0.002}},
                   0.0185, 0.0215, 0, 0);
    sm_sculpt_limb(solid, (SmPoint){-0.018, 0.128, -0.002}, (SmPoint){0.026, 0.156, 0.004}, 0.0235,
                   0.0165, 0.018);
    sm_sculpt_egg(solid, (SmPoint){0.041, 0.166, 0.006}, (SmPoint){0.030, 0.030, 0.030}, 0.007);
    sm_sculpt_egg(solid, (SmPoint){-0.034, 0.146, -0.006}, (SmPoint){0.017, 0.028, 0.021}, 0.014);
    sm_sculpt_egg(solid, (SmPoint){-0.002, 0.104, -0.015}, (SmPoint){0.011, 0.014, 0.012}, 0.010);
    sm_sculpt_tube(solid, 4, crest, 0.006, 0.005, 0.008, 0);
    SmPrimitive pit = sm_primitive(SM_ELLIPSOID, 0.003, (double[]){0.068, 0.179, 0.008},
                                   (double[]){0.006, 0.006, 0.006}); /* of the ball's ligament */
    pit.cut = 1;
    sm_implicit_add(solid, &pit);
    bone_lower_end(solid);
}

/* A rabbit that sits and looks ahead, 0.3 tall. */
static void rabbit_head(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){0, 0.180, 0.062}, (SmPoint){0.040, 0.040, 0.046}, 0.025);
    sm_sculpt_egg(solid, (SmPoint){0, 0.170, 0.095}, (SmPoint){0.026, 0.022, 0.024}, 0.016);
    sm_sculpt_eggs(solid, (SmPoint){0.012, 0.164, 0.108}, (SmPoint){0.013, 0.011, 0.011}, 0.004);
    sm_sculpt_egg(solid, (SmPoint){0, 0.176, 0.119}, (SmPoint){0.006, 0.0045, 0.005}, 0.002);
    sm_sculpt_egg(solid, (SmPoint){0, 0.151, 0.102}, (SmPoint){0.010, 0.007, 0.010}, 0.006);
    SmPrimitive socket = sm_primitive(SM_ELLIPSOID, 0.006, (double[]){0.034, 0.190, 0.086},
                                      (double[]){0.010, 0.011, 0.011});
    socket.cut = 1;
    sm_sculpt_pair(solid, &socket);
    sm_sculpt_eggs(solid, (SmPoint){0.0285, 0.190, 0.0825}, (SmPoint){0.0070, 0.0080, 0.0080},
                   0.001);
    SmPrimitive ear = sm_primitive(SM_ELLIPSOID, 0.010, (double[]){0.026, 0.252, 0.040},
                                   (double[]){0.017, 0.056, 0.0095});
    sm_primitive_turn(&ear, 2, -0.20);
    sm_primitive_turn(&ear, 0, -0.14);
    sm_sculpt_pair(solid, &ear);
    SmPrimitive cup = sm_primitive(SM_ELLIPSOID, 0.005, (double[]){0.0265, 0.252, 0.0505},
                                   (double[]){0.010, 0.043, 0.0065});
    cup.cut = 1;
    sm_primitive_turn(&cup, 2, -0.20);
    sm_primitive_turn(&cup, 0, -0.14);
    sm_sculpt_pair(solid, &cup);
}

static void rabbit_paws(SmImplicit *solid)
{
    sm_sculpt_limbs(solid, (SmPoint){0.030, 0.090, 0.052}, (SmPoint){0.026, 0.018, 0.074}, 0.020,
                    0.0125, 0.012);
    sm_sculpt_eggs(solid, (SmPoint){0.026, 0.012, 0.084}, (SmPoint){0.0145, 0.012, 0.021}, 0.006);
    sm_sculpt_eggs(solid, (SmPoint){0.056, 0.058, -0.030}, (SmPoint){0.031, 0.050, 0.052}, 0.010);
    sm_sculpt_eggs(solid, (SmPoint){0.062, 0.013, 0.012}, (SmPoint){0.019, 0.013, 0.050}, 0.008);
    for (int toe = -1; toe <= 1; toe += 2) /* grooves between the toes */
        for (int side = -1; side <= 1; side += 2)
            sm_sculpt_tube(solid, 2,
                           (SmPoint[]){{side * (0.062 + 0.006 * toe), 0.027, 0.044},
                                       {side * (0.062 + 0.006 * toe), 0.006, 0.064}},
                           0.002, 0.002, 0.002, 1);
}

void sm_sculpt_rabbit(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){0, 0.072, -0.030}, (SmPoint){0.062, 0.070, 0.072}, 0);
    sm_sculpt_egg(solid, (SmPoint){0, 0.108, 0.022}, (SmPoint){0.050, 0.066, 0.050}, 0.030);
    rabbit_paws(solid);
    rabbit_head(solid);
    sm_sculpt_egg(solid, (SmPoint){0, 0.052, -0.108}, (SmPoint){0.022, 0.022, 0.020}, 0.006);
    for (int tuft = -1; tuft <= 1; tuft++)
        sm_sculpt_limb(solid, (SmPoint){0, 0.054, -0.110},
                       (SmPoint){0.013 * tuft, 0.072 - 0.006 * tuft * tuft, -0.124}, 0.013, 0.007,
                       0.006);
}

/* A santa with a sack over his shoulder, 0.3 tall. */
static void santa_head(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){0, 0.213, 0.004}, (SmPoint){0.033, 0.034, 0.033}, 0.010);
    static const SmPoint beard[5] = {{-0.030, 0.205, 0.012},
                                     {-0.020, 0.180, 0.036},
                                     {0, 0.160, 0.048},
                                     {0.020, 0.180, 0.036},
                                     {0.030, 0.205, 0.012}};
    sm_sculpt_tube(solid, 5, beard, 0.010, 0.010, 0.006, 0);
    sm_sculpt_egg(solid, (SmPoint){0, 0.178, 0.034}, (SmPoint){0.026, 0.026, 0.020}, 0.008);
    sm_sculpt_limb(solid, (SmPoint){0, 0.176, 0.042}, (SmPoint){0, 0.142, 0.052}, 0.018, 0.006,
                   0.008);
    for (int side = -1; side <= 1; side += 2)
        sm_sculpt_tube(solid, 3,
                       (SmPoint[]){{side * 0.002, 0.200, 0.042},
                                   {side * 0.012, 0.199, 0.044},
                                   {side * 0.024, 0.203, 0.034}},
                       0.007, 0.0035, 0.004, 0); /* moustache */
    sm_sculpt_egg(solid, (SmPoint){0, 0.210, 0.040}, (SmPoint){0.0075, 0.007, 0.0075}, 0.002);
    sm_sculpt_eggs(solid, (SmPoint){0.018, 0.209, 0.031}, (SmPoint){0.009, 0.008, 0.006}, 0.003);
    SmPrimitive socket = sm_primitive(SM_ELLIPSOID, 0.002, (double[]){0.0125, 0.2205, 0.0355},
                                      (double[]){0.0055, 0.0045, 0.0050});
    socket.cut = 1;
    sm_sculpt_pair(solid, &socket);
    sm_sculpt_eggs(solid, (SmPoint){0.0125, 0.2200, 0.0315}, (SmPoint){0.0038, 0.0038, 0.0038},
                   0.0005);
    sm_sculpt_tube(solid, 4,
                   (SmPoint[]){{0, 0.240, 0.002},
                               {0, 0.268, -0.002},
                               {-0.012, 0.290, -0.006},
                               {-0.036, 0.288, -0.006}},
                   0.031, 0.009, 0.004, 0); /* cap */
    sm_sculpt_egg(solid, (SmPoint){-0.045, 0.279, -0.006}, (SmPoint){0.0125, 0.0125, 0.0125},
                  0.002);
    SmPrimitive brim =
        sm_primitive(SM_RING, 0.002, (double[]){0, 0.2385, 0.002}, (double[]){0.0300, 0.0085, 0});
    sm_primitive_turn(&brim, 0, -0.12);
    sm_implicit_add(solid, &brim);
}

static void santa_arms(SmImplicit *solid)
{
    /* The left hand rests on the belly, the right one holds the sack's neck. */
    sm_sculpt_limb(solid, (SmPoint){0.050, 0.165, 0}, (SmPoint){0.074, 0.124, 0.016}, 0.020, 0.017,
                   0.008);
    sm_sculpt_limb(solid, (SmPoint){0.074, 0.124, 0.016}, (SmPoint){0.050, 0.112, 0.062}, 0.017,
                   0.0145, 0.003);
    sm_sculpt_egg(solid, (SmPoint){0.040, 0.110, 0.072}, (SmPoint){0.015, 0.012, 0.012}, 0.003);
    sm_sculpt_limb(solid, (SmPoint){-0.050, 0.165, 0}, (SmPoint){-0.082, 0.136, 0.022}, 0.020,
                   0.017, 0.008);
    sm_sculpt_limb(solid, (SmPoint){-0.082, 0.136, 0.022}, (SmPoint){-0.060, 0.172, 0.036}, 0.017,
                   0.0140, 0.003);
    sm_sculpt_egg(solid, (SmPoint){-0.055, 0.183, 0.034}, (SmPoint){0.0135, 0.0125, 0.0135}, 0.003);
    sm_sculpt_tube(
        solid, 3,
        (SmPoint[]){{-0.055, 0.186, 0.030}, {-0.056, 0.196, -0.004}, {-0.050, 0.176, -0.044}},
        0.010, 0.024, 0.004, 0);
    sm_sculpt_egg(solid, (SmPoint){-0.036, 0.118, -0.074}, (SmPoint){0.052, 0.066, 0.042}, 0.010);
}

static void santa_legs(SmImplicit *solid)
{
    sm_sculpt_limbs(solid, (SmPoint){0.027, 0.075, 0}, (SmPoint){0.030, 0.040, 0}, 0.026, 0.021,
                    0.008);
    sm_sculpt_limbs(solid, (SmPoint){0.030, 0.044, 0}, (SmPoint){0.031, 0.018, -0.002}, 0.022,
                    0.018, 0.002);
    sm_sculpt_eggs(solid, (SmPoint){0.033, 0.014, 0.018}, (SmPoint){0.020, 0.0155, 0.034}, 0.006);
    SmPrimitive top =
        sm_primitive(SM_RING, 0.001, (double[]){0.030, 0.046, 0}, (double[]){0.0190, 0.0070, 0});
    sm_sculpt_pair(solid, &top);
}

void sm_sculpt_santa(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){0, 0.116, 0.004}, (SmPoint){0.066, 0.066, 0.060}, 0);
    sm_sculpt_egg(solid, (SmPoint){0, 0.162, 0}, (SmPoint){0.052, 0.034, 0.038}, 0.020);
    sm_sculpt_limb(solid, (SmPoint){0, 0.086, 0}, (SmPoint){0, 0.072, 0}, 0.056, 0.058, 0.012);
    SmPrimitive hem =
        sm_primitive(SM_RING, 0.002, (double[]){0, 0.062, 0}, (double[]){0.0540, 0.0095, 0});
    sm_implicit_add(solid, &hem);
    santa_legs(solid);
    SmPrimitive belt =
        sm_primitive(SM_RING, 0.001, (double[]){0, 0.104, 0.004}, (double[]){0.0615, 0.0085, 0});
    sm_implicit_add(solid, &belt);
    SmPrimitive buckle =
        sm_primitive(SM_BRICK, 0.001, (double[]){0, 0.104, 0.071}, (double[]){0.014, 0.011, 0.004});
    buckle.rounding = 0.002;
    sm_implicit_add(solid, &buckle);
    for (int button = 0; button < 2; button++)
        sm_sculpt_egg(solid, (SmPoint){0, 0.128 + 0.0165 * button, 0.0615 - 0.0085 * button},
                      (SmPoint){0.0055, 0.0055, 0.0045}, 0.001);
    santa_arms(solid);
    santa_head(solid);
}
