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
    SmPrimitive nail = sm_primitive(SM_ELLIPSOID, 0.0008,
                                    (double[]){tip.x, tip.y - 0.1 * radius, tip.z - 0.72 * radius},
                                    (double[]){0.55 * radius, 0.75 * radius, 0.0018});
    sm_primitive_turn(&nail, 2, -spread);
    sm_implicit_add(solid, &nail);
}

void sm_sculpt_hand(SmImplicit *solid)
{
    SmPrimitive palm =
        sm_primitive(SM_BRICK, 0, (double[]){0.001, 0.078, 0}, (double[]){0.041, 0.041, 0.0125});
    palm.rounding = 0.012;
    sm_implicit_add(solid, &palm);
    SmPrimitive wrist = sm_primitive(SM_BRICK, 0.025, (double[]){0.0, 0.025, -0.001},
                                     (double[]){0.027, 0.04, 0.0175});
    wrist.rounding = 0.015;
    sm_implicit_add(solid, &wrist);
    sm_sculpt_egg(solid, (SmPoint){-0.022, 0.066, 0.008}, (SmPoint){0.018, 0.031, 0.014}, 0.012);
    sm_sculpt_egg(solid, (SmPoint){0.026, 0.066, 0.006}, (SmPoint){0.013, 0.034, 0.012}, 0.010);
    sm_sculpt_egg(solid, (SmPoint){0.002, 0.106, 0.005}, (SmPoint){0.034, 0.011, 0.010}, 0.008);
    finger(solid, (SmPoint){-0.0315, 0.112, 0}, 0.068, -0.16, 0.0088);
    finger(solid, (SmPoint){-0.0105, 0.117, 0}, 0.075, -0.045, 0.0091);
    finger(solid, (SmPoint){0.0110, 0.115, 0}, 0.069, 0.07, 0.0087);
    finger(solid, (SmPoint){0.0320, 0.108, 0}, 0.054, 0.20, 0.0076);
    sm_sculpt_limb(solid, (SmPoint){-0.026, 0.052, 0.008}, (SmPoint){-0.053, 0.080, 0.016}, 0.0150,
                   0.0110, 0.010);
    sm_sculpt_limb(solid, (SmPoint){-0.053, 0.080, 0.016}, (SmPoint){-0.073, 0.107, 0.020}, 0.0105,
                   0.0088, 0.003);
    SmPrimitive nail = sm_primitive(SM_ELLIPSOID, 0.0008, (double[]){-0.0725, 0.1062, 0.0130},
                                    (double[]){0.0050, 0.0060, 0.0018});
    sm_primitive_turn(&nail, 2, 0.64);
    sm_implicit_add(solid, &nail);
    static const SmPoint life[4] = {
        {-0.034, 0.098, 0.1}, {-0.012, 0.088, 0.1}, {-0.003, 0.068, 0.1}, {-0.006, 0.042, 0.1}};
    static const SmPoint head[3] = {{-0.034, 0.096, 0.1}, {0.0, 0.086, 0.1}, {0.028, 0.070, 0.1}};
    static const SmPoint heart[4] = {
        {0.036, 0.094, 0.1}, {0.022, 0.092, 0.1}, {0.002, 0.097, 0.1}, {-0.012, 0.107, 0.1}};
    int base = solid->count;
    SmPoint ray = {0, 0, -0.1};
    sm_sculpt_relief(solid, base, 4, life, ray, 0.0013, 0.002, 1);
    sm_sculpt_relief(solid, base, 3, head, ray, 0.0012, 0.002, 1);
    sm_sculpt_relief(solid, base, 4, heart, ray, 0.0012, 0.002, 1);
}

/* A liver seen from the front: the large right lobe on the left, the small one tapering off. */
void sm_sculpt_liver(SmImplicit *solid)
{
    sm_sculpt_egg(solid, (SmPoint){-0.036, 0.0, 0}, (SmPoint){0.078, 0.080, 0.062}, 0);
    SmPrimitive left = sm_primitive(SM_ELLIPSOID, 0.02, (double[]){0.048, 0.026, 0.012},
                                    (double[]){0.080, 0.040, 0.036});
    sm_primitive_turn(&left, 2, -0.08);
    sm_implicit_add(solid, &left);
    /* The flat underside looks down, back and to the small lobe: it leaves a wedge. */
    SmPrimitive under =
        sm_primitive(SM_BRICK, 0.008, (double[]){0.064, -0.196, -0.064}, (double[]){0.3, 0.2, 0.3});
    under.cut = 1;
    sm_primitive_turn(&under, 0, 0.478);
    sm_primitive_turn(&under, 2, 0.442);
    sm_implicit_add(solid, &under);
    /* The groove of the ligament between the lobes, to a notch in the lower border. */
    static const SmPoint ligament[3] = {
        {0.016, 0.07, 0.2}, {0.019, 0.035, 0.2}, {0.016, -0.02, 0.2}};
    int base = solid->count;
    sm_sculpt_relief(solid, base, 3, ligament, (SmPoint){0, 0, -0.2}, 0.004, 0.008, 1);
    sm_sculpt_limb(solid, (SmPoint){-0.034, -0.066, 0.036}, (SmPoint){-0.010, -0.022, 0.012},
                   0.0125, 0.008, 0.004); /* gall bladder */
}
