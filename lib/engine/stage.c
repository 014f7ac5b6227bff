#include "stage.h"

#include <math.h>
#include <string.h>

const SmStages sm_matching_stages = {
    .of = {[SM_FAST_SUM] = {"fast_sum", "fast sum", "sum", "sums over regions"},
           [SM_SHAPE_MATCHING] = {"shape_matching", "shape matching", "match",
                                  "fits of regions and goals"},
           [SM_POLAR] = {"polar", "polar", "polar", "rotations"},
           [SM_DAMPING] = {"damping", "damping", "damp", "damping"},
           [SM_OTHER] = {"other", "other", "other",
                         "integration, boundaries, collisions and what is left"}},
    .before = SM_OTHER};

const char *sm_stage_name(SmStage stage)
{
    return sm_matching_stages.of[stage].name;
}

SmStage sm_stage_of_ms(const char *name)
{
    for (int s = 0; s < SM_STAGES; s++) {
        const char *stage = sm_stage_name((SmStage)s);
        size_t length = strlen(stage);
        if (!strncmp(name, stage, length) && !strcmp(name + length, "_ms")) return (SmStage)s;
    }
    return SM_STAGES;
}

double sm_lap_seconds(void)
{
    enum { READS = 256, TRIES = 64 };
    double best = INFINITY;
    for (int t = 0; t < TRIES; t++) {
        double start = sm_now(), now = start;
        for (int i = 0; i < READS; i++) now = sm_now();
        best = fmin(best, (now - start) / READS);
    }
    return best;
}

void sm_laps_start(SmLaps *laps)
{
    memset(laps, 0, sizeof *laps);
    laps->last = sm_now();
}

void sm_lap_take(SmLaps *laps, SmStage stage)
{
    double now = sm_now();
    laps->seconds[stage] += now - laps->last;
    laps->count[stage]++;
    laps->last = now;
}
