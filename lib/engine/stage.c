#include "stage.h"

#include <math.h>
#include <string.h>

const char *sm_stage_name(SmStage stage)
{
    static const char *const names[SM_STAGES] = {"fast_sum", "shape_matching", "polar", "damping",
                                                 "other"};
    return names[stage];
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
