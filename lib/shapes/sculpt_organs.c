#include "sculpt.h"
#include "sine.h"

/* A left hand seen from its palm (+z), the fingers along y. */
static void finger(SmImplicit *solid, SmPoint root, double length, double spread, double radius)
{
    double reach[4] = {-0.1 * length, 0.45 * length, 0.75 * length, length};
    double curl[4] = {0, 0.001, 0.005, 0.011};
    SmPoint joint[4];
    for (int i = 0; i < 4; i++)
        joint[i] = (SmPoint){root.x + sm_sin(spread) * reach[i], root.y + sm_cos(spread) * reach[i],
                             root.z + curl[i]};
    sm_sculpt_tube(solid, 4, joint, 1.05 * radius, 0.86 * radius, 0.0035, 0);
    SmPoint tip = joint[3];
    SmStroke nail = EGG(tip.x, tip.y - 0.1 * radius, tip.z - 0.72 * radius, 0.55 * radius,
                        0.75 * radius, 0.0018, 0.0008, .turn = {{2, -spread}});
    sm_sculpt(solid, 1, &nail);
}

static const SmStroke palm[] = {
    BRICK(0.001, 0.078, 0, 0.041, 0.041, 0.0125, 0, .rounding = 0.012),
    BRICK(0.0, 0.025, -0.001, 0.027, 0.04, 0.0175, 0.025, .rounding = 0.015),
    EGG(-0.022, 0.066, 0.008, 0.018, 0.031, 0.014, 0.012),
    EGG(0.026, 0.066, 0.006, 0.013, 0.034, 0.012, 0.010),
    EGG(0.002, 0.106, 0.005, 0.034, 0.011, 0.010, 0.008),
};

static const SmStroke thumb_and_lines[] = {
    LIMB(-0.026, 0.052, 0.008, -0.053, 0.080, 0.016, 0.0150, 0.0110, 0.010),
    LIMB(-0.053, 0.080, 0.016, -0.073, 0.107, 0.020, 0.0105, 0.0088, 0.003),
    EGG(-0.0725, 0.1062, 0.0130, 0.0050, 0.0060, 0.0018, 0.0008, .turn = {{2, 0.64}}),
    RELIEF(0.0013, 0.0013, 0.002, {-0.034, 0.098, 0.1}, {-0.012, 0.088, 0.1}, {-0.003, 0.068, 0.1},
           {-0.006, 0.042, 0.1}),
    RELIEF(0.0012, 0.0012, 0.002, {-0.034, 0.096, 0.1}, {0.0, 0.086, 0.1}, {0.028, 0.070, 0.1}),
    RELIEF(0.0012, 0.0012, 0.002, {0.036, 0.094, 0.1}, {0.022, 0.092, 0.1}, {0.002, 0.097, 0.1},
           {-0.012, 0.107, 0.1}),
};

void sm_sculpt_hand(SmImplicit *solid)
{
    SCULPT(solid, palm);
    finger(solid, (SmPoint){-0.0315, 0.112, 0}, 0.068, -0.16, 0.0088);
    finger(solid, (SmPoint){-0.0105, 0.117, 0}, 0.075, -0.045, 0.0091);
    finger(solid, (SmPoint){0.0110, 0.115, 0}, 0.069, 0.07, 0.0087);
    finger(solid, (SmPoint){0.0320, 0.108, 0}, 0.054, 0.20, 0.0076);
    SCULPT(solid, thumb_and_lines);
}

/* A liver seen from the front: the large right lobe on the left, the small one tapering off. */
static const SmStroke liver[] = {
    EGG(-0.036, 0.0, 0, 0.078, 0.080, 0.062, 0),
    EGG(0.048, 0.026, 0.012, 0.080, 0.040, 0.036, 0.02, .turn = {{2, -0.08}}),
    /* the flat underside looks down, back and to the small lobe: it leaves a wedge */
    STROKE(SM_ONE, SM_BRICK, 1, 0.064, -0.196, -0.064, 0.3, 0.2, 0.3, 0.008,
           .turn = {{0, 0.478}, {2, 0.442}}),
    /* the groove of the ligament between the lobes, to a notch in the lower border */
    RELIEF(0.004, 0.004, 0.008, {0.016, 0.07, 0.2}, {0.019, 0.035, 0.2}, {0.016, -0.02, 0.2}),
    LIMB(-0.034, -0.066, 0.036, -0.010, -0.022, 0.012, 0.0125, 0.008, 0.004), /* gall bladder */
};

void sm_sculpt_liver(SmImplicit *solid)
{
    SCULPT(solid, liver);
}

/* The upper end of a thigh bone, 0.2 tall: a ball on a slanted neck, two knobs for the tendons, a
 * shaft that widens into a lower end with a shallow socket. */
static const SmStroke balljoint[] = {
    TUBE(0.0185, 0.0215, 0, {-0.008, 0.040, 0.001}, {-0.011, 0.080, 0}, {-0.013, 0.125, -0.002}),
    LIMB(-0.018, 0.128, -0.002, 0.026, 0.156, 0.004, 0.0235, 0.0165, 0.018),
    EGG(0.041, 0.166, 0.006, 0.030, 0.030, 0.030, 0.007),
    EGG(-0.034, 0.146, -0.006, 0.017, 0.028, 0.021, 0.014),
    EGG(-0.002, 0.104, -0.015, 0.011, 0.014, 0.012, 0.010),
    TUBE(0.006, 0.005, 0.008, {-0.040, 0.152, -0.016}, {-0.030, 0.138, -0.022},
         {-0.016, 0.122, -0.024}, {-0.002, 0.104, -0.018}),
    PIT(0.068, 0.179, 0.008, 0.006, 0.006, 0.006, 0.003), /* of the ball's ligament */
    LIMB(-0.008, 0.050, 0.001, -0.006, 0.020, 0.002, 0.019, 0.026, 0.012),
    EGG(-0.006, 0.014, 0.002, 0.036, 0.020, 0.031, 0.012),
    PIT(-0.006, -0.012, 0.002, 0.026, 0.018, 0.022, 0.004),
};

void sm_sculpt_balljoint(SmImplicit *solid)
{
    SCULPT(solid, balljoint);
}
