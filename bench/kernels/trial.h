/* trial.h - something timed in samples, in turn with what it is compared with: one way for all
 * kernels. */
#ifndef BENCH_TRIAL_H
#define BENCH_TRIAL_H

#include "../measure/disturbance.h"
#include "../measure/step_timer.h"

typedef struct {
    /* the caller's */
    BenchTimed timed;    /* `restore` (or NULL), not timed, comes before every sample */
    int threads;         /* that it runs on */
    int runs;            /* in a sample; 0: as many as last long enough, at most 64 */
    bool stages;         /* also sampled with clocks inside */
    bool warm_up;        /* run once before the first sample */
    bool once;           /* a sample counts though others disturbed it: a run cannot be repeated */
    int most;            /* samples; 0: as many as asked for */
    double most_seconds; /* no sample is begun later; 0: whatever they take */
    bool (*finite)(void *subject); /* or NULL: are positions finite after the last sample? */
    bool valid;                    /* only then is it timed; see bench_trial_fail() */
    char reason[192];              /* why not */
    /* what is found */
    BenchWatch watch;
    int samples;
    double *seconds;    /* [samples] a run; NULL: not timed */
    double *cpu, *user; /* [samples] a run: processor time of the process, which other work hardly
                         * touches; of it the user's, without page faults, which are the system's */
    SmLaps *laps;       /* [samples] of all runs of a sample */
    double clock;       /* seconds that a lap takes to read the clock */
} BenchTrial;

/* It is not valid, and this is why, unless there has been a reason before. */
void bench_trial_fail(BenchTrial *trial, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Times the valid ones in turn, `repeats` samples each. */
void bench_trials_time(BenchTrial *const *trials, int count, int repeats);

/* Seconds a run in sample r of a stage, less the time that reading the clock took. */
double bench_trial_stage(const BenchTrial *trial, int r, SmStage stage);

void bench_trial_free(BenchTrial *trial);

#endif
