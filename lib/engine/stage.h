/* stage.h - laps without gaps, so that a step's stages add up to the step.
 *
 * The stages are those of fastlsm Table 1; an engine that has others says what it books in the
 * place of which (SmStages). */
#ifndef SM_STAGE_H
#define SM_STAGE_H

#include <stddef.h>

#include "../system/clock.h"

typedef enum {
    SM_FAST_SUM,       /* summation over regions, both directions */
    SM_SHAPE_MATCHING, /* c_r, A_r, T_r, goal positions */
    SM_POLAR,          /* polar decomposition of A_r */
    SM_DAMPING,        /* region damping, its sums included */
    SM_OTHER,          /* integration, boundaries, collisions, fracture, bookkeeping */
    SM_STAGES
} SmStage;

typedef struct {
    double seconds[SM_STAGES];
    long count[SM_STAGES]; /* laps: each reads the clock, which takes time of its own */
    double last;           /* time of the last lap, seconds */
} SmLaps;

/* What an engine calls a stage: in files, where "_ms" may follow; as the heading of a table's
 * column; the same where there is little room; and what it is, in a few words. */
typedef struct {
    const char *name, *title, *terse, *meaning;
} SmStageName;

/* The stages of an engine. */
typedef struct {
    SmStageName of[SM_STAGES]; /* name NULL: it has none in that place */
    SmStage before;            /* that of setting handles and pushes before a step */
} SmStages;

/* Those of shape matching: "fast_sum", "shape_matching", "polar", "damping", "other". */
extern const SmStages sm_matching_stages;

/* Their names. */
const char *sm_stage_name(SmStage stage);

/* The one whose name followed by "_ms" this is; SM_STAGES where there is none. */
SmStage sm_stage_of_ms(const char *name);

/* Seconds that reading the clock takes at best: what a lap adds to its stage, at least. */
double sm_lap_seconds(void);

/* Zeroes the laps and starts the clock. */
void sm_laps_start(SmLaps *laps);

/* Gives the time since the last lap (or start) to `stage`. */
void sm_lap_take(SmLaps *laps, SmStage stage);

/* The same; NULL laps, as nearly always: does nothing. */
static inline void sm_lap(SmLaps *laps, SmStage stage)
{
    if (__builtin_expect(laps != NULL, 0)) sm_lap_take(laps, stage);
}

#endif
