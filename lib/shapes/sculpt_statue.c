#include <math.h>

#include "sculpt.h"
#include "sine.h"

/* A laughing monk in a robe, holding an ingot over his head, on a lotus plinth: 1.98 tall. */

/* A point of the first `base` primitives' surface seen from the axis at that angle (0: front). */
static SmPoint on_robe(const SmImplicit *solid, int base, double angle, double y)
{
    SmPoint from = {0.8 * sm_sin(angle), y, 0.8 * sm_cos(angle)}, to = {0, y, 0};
    return sm_sculpt_cast(solid, base, from, to);
}

enum { DRAPE = 6, SPANS = 3 }; /* most points of a drape; casts between two */

/* A fold of cloth over the surface through (angle, height) pairs. */
static void drape(SmImplicit *solid, int base, int count, const double (*path)[2],
                  double from_radius, double to_radius, double k)
{
    SmPoint turn[DRAPE], point[SPANS * DRAPE];
    int casts = SPANS * (count - 1) + 1;
    for (int i = 0; i < count; i++) turn[i] = (SmPoint){path[i][0], path[i][1], 0};
    for (int i = 0; i < casts; i++) {
        SmPoint at = sm_sculpt_curve(count, turn, (double)i / SPANS);
        point[i] = on_robe(solid, base, at.x, at.y);
    }
    sm_sculpt_tube(solid, casts, point, from_radius, to_radius, k, 0);
}

#define DRUM(y, radius, half, k)                                                                   \
    STROKE(SM_ONE, SM_DRUM, 0, 0, y, 0, radius, half, 0, k, .rounding = 0.4 * (half))

static const SmStroke plinth_drums[] = {
    DRUM(0.035, 0.400, 0.035, 0),
    DRUM(0.085, 0.365, 0.025, 0.01),
    DRUM(0.170, 0.325, 0.082, 0.02),
    DRUM(0.255, 0.345, 0.024, 0.02),
};

static void lotus_ring(SmImplicit *solid, int count, double phase, double radius, double y,
                       double lean, SmPoint size)
{
    for (int i = 0; i < count; i++) {
        double angle = 2 * M_PI * (i + phase) / count;
        SmStroke petal = EGG(radius * sm_sin(angle), y, radius * sm_cos(angle), size.x, size.y,
                             size.z, 0.014, .turn = {{0, lean}, {1, angle}});
        sm_sculpt(solid, 1, &petal);
    }
}

static void plinth(SmImplicit *solid)
{
    SCULPT(solid, plinth_drums);
    lotus_ring(solid, 18, 0.0, 0.325, 0.135, -0.5, (SmPoint){0.052, 0.055, 0.024});
    lotus_ring(solid, 18, 0.5, 0.325, 0.205, 0.5, (SmPoint){0.052, 0.055, 0.024});
    for (int i = 0; i < 60; i++) {
        double angle = 2 * M_PI * i / 60;
        SmStroke bead =
            EGG(0.384 * sm_sin(angle), 0.078, 0.384 * sm_cos(angle), 0.014, 0.014, 0.014, 0.004);
        sm_sculpt(solid, 1, &bead);
    }
}

static const SmStroke body[] = {
    LIMB(0, 0.40, 0, 0, 0.76, 0, 0.235, 0.255, 0.02),
    LIMBS(0.11, 0.40, 0.05, 0.12, 0.70, 0.05, 0.155, 0.16, 0.08),
    EGG(0, 0.295, 0.01, 0.305, 0.055, 0.265, 0.10),
    EGG(0, 0.93, 0.075, 0.290, 0.265, 0.255, 0.06),
    EGG(0, 1.17, 0.0, 0.245, 0.20, 0.18, 0.12),
    LIMBS(0.08, 1.30, -0.02, 0.225, 1.265, -0.01, 0.09, 0.085, 0.08),
};

static const SmStroke chest[] = {
    EGGS(0.095, 1.205, 0.135, 0.105, 0.075, 0.06, 0.03),
    EGGS(0.115, 1.185, 0.192, 0.012, 0.012, 0.012, 0.006),
    PIT(0, 0.90, 0.335, 0.022, 0.017, 0.03, 0.03),
    GROOVE(0.012, 0.012, 0.03, {0.14, 1.075, 0.26}, {0, 1.055, 0.295},
           {-0.14, 1.075, 0.26}), /* crease over the belly */
};

static const SmStroke feet[] = {
    LIMBS(0.10, 0.30, 0.20, 0.125, 0.292, 0.285, 0.042, 0.032, 0.01),
};

static const SmStroke head_and_ingot[] = {
    EGG(0, 1.555, 0.02, 0.135, 0.150, 0.142, 0.03),
    LIMB(0, 1.30, 0.0, 0, 1.45, 0.015, 0.11, 0.10, 0.04),
    EGGS(0.066, 1.487, 0.085, 0.075, 0.065, 0.07, 0.03),
    EGG(0, 1.405, 0.075, 0.105, 0.042, 0.075, 0.02),
    EGG(0, 1.432, 0.125, 0.045, 0.032, 0.04, 0.02),
    EGG(0, 1.530, 0.172, 0.026, 0.032, 0.028, 0.015),
    EGGS(0.026, 1.518, 0.163, 0.017, 0.015, 0.018, 0.008),
    PITS(0.056, 1.576, 0.170, 0.030, 0.017, 0.020, 0.02),
    EGGS(0.054, 1.566, 0.132, 0.026, 0.017, 0.018, 0.005),
    /* lids and brows */
    GROOVES(0.005, 0.005, 0.004, {0.030, 1.566, 0.158}, {0.056, 1.578, 0.156},
            {0.082, 1.566, 0.140}),
    TUBES(0.010, 0.007, 0.010, {0.024, 1.606, 0.152}, {0.060, 1.622, 0.143}, {0.098, 1.590, 0.118}),
    /* smile and lip */
    GROOVE(0.011, 0.011, 0.008, {0.072, 1.497, 0.150}, {0.042, 1.472, 0.160}, {0, 1.464, 0.164},
           {-0.042, 1.472, 0.160}, {-0.072, 1.497, 0.150}),
    TUBE(0.010, 0.010, 0.008, {0.045, 1.453, 0.150}, {0, 1.443, 0.160}, {-0.045, 1.453, 0.150}),
    /* ears */
    EGGS(0.140, 1.545, 0.01, 0.018, 0.065, 0.040, 0.01, .turn = {{1, 0.35}}),
    PITS(0.158, 1.545, 0.022, 0.012, 0.042, 0.020, 0.006, .turn = {{1, 0.35}}),
    EGGS(0.146, 1.462, 0.018, 0.017, 0.045, 0.022, 0.012),
    /* ingot */
    EGG(0, 1.865, 0.04, 0.155, 0.045, 0.085, 0.006),
    EGG(0, 1.905, 0.04, 0.078, 0.075, 0.062, 0.012),
    LIMBS(0.09, 1.875, 0.04, 0.165, 1.925, 0.04, 0.045, 0.020, 0.02),
};

/* Hollow from below, as a cast statue is. The shell of a flat underside would be level and one cell
 * thick, so that a particle and the one above it had the same region; FastLSM's shell has no such
 * pairs (Table 1: 19,959 regions of as many particles). */
static const SmStroke hollow[] = {
    STROKE(SM_ONE, SM_CONE, 1, 0, -0.10, 0, 0.36, 0.05, 0, 0.01, .tip = {0, 0.50, 0}),
};

#define FINGER(z)                                                                                  \
    LIMBS(0.192, 1.845, z, 0.190, 1.890, (z) + 0.002, 0.0135, 0.0125, 0.005),                      \
        LIMBS(0.190, 1.890, (z) + 0.002, 0.150, 1.915, (z) + 0.004, 0.0135, 0.0125, 0.005)

static const SmStroke arm[] = {
    LIMBS(0.235, 1.27, 0.0, 0.328, 1.50, 0.01, 0.088, 0.070, 0.06),
    LIMBS(0.328, 1.50, 0.01, 0.205, 1.775, 0.035, 0.062, 0.044, 0.02),
    EGGS(0.185, 1.825, 0.035, 0.036, 0.058, 0.048, 0.02),
    FINGER(0.082),
    FINGER(0.082 - 0.028 * 1),
    FINGER(0.082 - 0.028 * 2),
    FINGER(0.082 - 0.028 * 3),
    LIMBS(0.175, 1.81, 0.07, 0.130, 1.845, 0.098, 0.017, 0.014, 0.008),
    /* wide sleeves, fallen back to the elbows */
    LIMBS(0.322, 1.505, 0.008, 0.305, 1.40, -0.005, 0.080, 0.088, 0.03),
    LIMBS(0.310, 1.44, -0.02, 0.300, 1.08, -0.04, 0.080, 0.045, 0.04),
};

static void arms(SmImplicit *solid)
{
    SCULPT(solid, arm);
    for (int i = 0; i < 6; i++) {
        double along = i / 5.0;
        SmStroke fold = RINGS(
            0.318 - 0.05 * along, 1.535 - 0.20 * along, 0.006 - 0.01 * along, 0.076 + 0.016 * along,
            0.011, 0.014, .turn = {{2, -0.45 + (i % 2 ? 0.12 : -0.08)}, {0, i % 2 ? 0.10 : -0.12}});
        sm_sculpt(solid, 1, &fold);
    }
}

static void skirt_folds(SmImplicit *solid, int base)
{
    for (int i = 0; i < 26; i++) {
        double angle = 2 * M_PI * (i + 0.5) / 26, sway = 0.07 * sm_sin(5.3 * i);
        int front = sm_cos(angle) > 0.72; /* the lap has swags instead */
        double top = front ? 0.42 : 0.66 - 0.05 * (sm_cos(angle) < 0) * sm_cos(angle), foot = 0.285;
        double path[4][2] = {{angle, top},
                             {angle + 0.4 * sway, 0.6 * top + 0.4 * foot},
                             {angle + sway, 0.3 * top + 0.7 * foot},
                             {angle + 1.4 * sway, foot}};
        drape(solid, base, 4, (const double(*)[2])path, front ? 0.004 : 0.009,
              0.021 + 0.005 * sm_sin(3.1 * i), 0.022);
    }
    for (int i = 0; i < 4; i++) { /* swags over the lap */
        double y = 0.62 - 0.055 * i, wide = 0.86 - 0.05 * i;
        double path[5][2] = {{-wide, y + 0.035},
                             {-0.55 * wide, y - 0.035},
                             {0, y - 0.075},
                             {0.55 * wide, y - 0.035},
                             {wide, y + 0.035}};
        drape(solid, base, 5, (const double(*)[2])path, 0.015, 0.015, 0.024);
    }
}

static void back_folds(SmImplicit *solid, int base)
{
    for (int i = 0; i < 7; i++) {
        double y = 1.27 - 0.085 * i, sag = 0.07 + 0.014 * i;
        double path[5][2] = {{M_PI - 1.15, y + 0.02},
                             {M_PI - 0.6, y - 0.6 * sag},
                             {M_PI, y - sag},
                             {M_PI + 0.6, y - 0.6 * sag},
                             {M_PI + 1.15, y + 0.02}};
        drape(solid, base, 5, (const double(*)[2])path, 0.014, 0.014, 0.024);
    }
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 5; i++) { /* from the sleeves down and forward */
            double angle = side * (1.05 + 0.22 * i);
            double path[4][2] = {{angle + 0.10 * side, 1.10},
                                 {angle, 0.96},
                                 {angle - 0.06 * side, 0.82},
                                 {angle - 0.10 * side, 0.69}};
            drape(solid, base, 4, (const double(*)[2])path, 0.010, 0.015, 0.02);
        }
}

/* The open robe's borders from the neck around the belly, and the sash with its knot. */
static void borders(SmImplicit *solid, int base)
{
    for (int side = -1; side <= 1; side += 2) {
        double path[6][2] = {{side * 0.75, 1.345}, {side * 0.88, 1.22}, {side * 0.86, 1.08},
                             {side * 0.92, 0.94},  {side * 0.86, 0.80}, {side * 0.62, 0.70}};
        drape(solid, base, 6, (const double(*)[2])path, 0.026, 0.024, 0.010);
    }
    for (int quarter = 0; quarter < 4; quarter++) {
        double path[5][2];
        for (int i = 0; i < 5; i++) {
            path[i][0] = 0.5 * M_PI * (quarter + i / 4.0);
            path[i][1] = 0.70 - 0.025 * sm_cos(path[i][0]);
        }
        drape(solid, base, 5, (const double(*)[2])path, 0.027, 0.027, 0.008);
    }
    SmPoint knot = on_robe(solid, base, 0, 0.672);
    SmStroke round = EGG(knot.x, knot.y, knot.z, 0.040, 0.036, 0.045, 0.008);
    sm_sculpt(solid, 1, &round);
    for (int side = -1; side <= 1; side += 2) {
        double path[4][2] = {{0.05 * side, 0.66},
                             {0.16 * side, 0.59},
                             {0.17 * side, 0.50},
                             {(0.20 + 0.04 * side) * side, 0.41}};
        drape(solid, base, 4, (const double(*)[2])path, 0.020, 0.027, 0.006);
        SmStroke loop =
            EGG(knot.x + 0.055 * side, knot.y + 0.012, knot.z - 0.01, 0.042, 0.024, 0.028, 0.006);
        sm_sculpt(solid, 1, &loop);
    }
}

/* Prayer beads hanging over the chest and belly. */
static void beads(SmImplicit *solid, int base)
{
    static const SmPoint string[7] = {
        {-0.125, 1.345, 0.8}, {-0.165, 1.240, 0.8}, {-0.125, 1.115, 0.8}, {0, 1.050, 0.8},
        {0.125, 1.115, 0.8},  {0.165, 1.240, 0.8},  {0.125, 1.345, 0.8}};
    for (int i = 0; i <= 30; i++) {
        SmPoint from = sm_sculpt_curve(7, string, i / 5.0), to = {from.x, from.y, 0};
        SmPoint at = sm_sculpt_cast(solid, base, from, to);
        double r = i == 15 ? 0.026 : 0.0165;
        SmStroke bead = EGG(at.x, at.y, at.z + 0.2 * r, r, r, r, 0.003);
        sm_sculpt(solid, 1, &bead);
    }
}

void sm_sculpt_statue(SmImplicit *solid)
{
    SCULPT(solid, body);
    int base = solid->count;
    SCULPT(solid, chest);
    int skin = solid->count;
    plinth(solid);
    skirt_folds(solid, base);
    back_folds(solid, base);
    borders(solid, base);
    SCULPT(solid, feet);
    arms(solid);
    SCULPT(solid, head_and_ingot);
    beads(solid, skin);
    SCULPT(solid, hollow);
}
