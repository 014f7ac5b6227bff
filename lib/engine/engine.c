#include "engine.h"

#include <math.h>
#include <string.h>

SmCode sm_engine_check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error)
{
    if (voxels->particle_count < 1)
        return sm_fail(error, SM_INPUT, "the body has no particles: choose a smaller cell");
    if (params->w < 1)
        return sm_fail(error, SM_INPUT, "w is %d: a region's half-width is 1 or more", params->w);
    if (!(params->h > 0 && isfinite(params->h)))
        return sm_fail(error, SM_INPUT, "h is %g: the time step is a positive number", params->h);
    if (!(params->damping >= 0 && params->damping <= 1))
        return sm_fail(error, SM_INPUT, "damping is %g: it is from 0 to 1", params->damping);
    if (params->strain_limit != 0 && !(params->strain_limit > 1)) /* 1: broken at rest */
        return sm_fail(
            error, SM_INPUT,
            "strain_limit is %g: it is 0 (never) or above 1 (times a link's rest length)",
            params->strain_limit);
    if (!(params->collide.friction >= 0 && params->collide.friction <= 1))
        return sm_fail(error, SM_INPUT, "the friction of collisions is %g: it is from 0 to 1",
                       params->collide.friction);
    for (int a = 0; a < 3; a++)
        if (!isfinite(params->gravity[a]))
            return sm_fail(error, SM_INPUT, "gravity is not finite: give three numbers");
    for (long p = 0; params->mass && p < voxels->particle_count; p++)
        if (!(params->mass[p] > 0 && isfinite(params->mass[p])))
            return sm_fail(error, SM_INPUT, "the mass of particle %ld is %g: it must be positive",
                           p, params->mass[p]);
    return SM_OK;
}

void sm_engine_pose(const SmEngineParams *params, long instance, double pose[3][4])
{
    static const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    memcpy(pose, params->instance_pose ? params->instance_pose[instance] : identity,
           sizeof identity);
}

const SmStages *sm_engine_stages(const SmEngineType *type)
{
    return type->stages ? type->stages : &sm_matching_stages;
}

const char *sm_engine_stage(const SmEngineType *type, SmStage stage)
{
    return sm_engine_stages(type)->of[stage].name;
}
