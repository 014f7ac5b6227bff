#include "stage.h"

#include <string.h>
#include <time.h>

const char *sm_stage_name(SmStage stage)
{
    static const char *const names[SM_STAGES] = {"fast_sum", "shape_matching", "polar", "damping",
                                                 "other"};
    return names[stage];
}

double sm_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void sm_laps_start(SmLaps *laps)
{
    memset(laps, 0, sizeof *laps);
    laps->last = sm_now();
}
