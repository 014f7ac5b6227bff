/* ab_runner.h - scenes measured on two builds (A/B), in fresh processes, builds in turn.
 *
 * A round of a scene is four processes, old new new old, and the next one new old old new, so that
 * what drifts slowly hits both builds alike; a round beside a stored file is two of the new one.
 * Each process is `PROGRAM tables --scene NAME ...`, which checks the scene before it times it. The
 * state that is timed is the same in all of a build's: those after its first are told its hash and
 * do not check it again (`tables --checked`, unless the build is too old for it). After its
 * first process a build takes no more repeats than fit in BENCH_PROCESS_SECONDS, but 15. */
#ifndef BENCH_AB_RUNNER_H
#define BENCH_AB_RUNNER_H

#include "../store/draft.h"
#include "../system/machine.h"
#include "../system/progress.h"
#include "ab_samples.h"

/* What to run for one scene; NULL or 0: as the program does of itself. */
typedef struct {
    const char *scene; /* as `tables --scene` takes it: may stand for several */
    const char *engine, *precision;
    int threads, repeats;
    double block; /* ms */
} BenchTask;

typedef struct {
    const char *program[BENCH_BUILDS]; /* old: NULL where the old times are stored */
    const char *paper;
    const BenchTask *task;
    int tasks, rounds;
    unsigned long seed;
    bool by_cycles;     /* leave a scene for which a build has no cycles after that process */
    const char *folder; /* for scratch files */
    BenchProgress *progress;
} BenchAbRunner;

enum { BENCH_TURNS = 4 }; /* of a round */
#define BENCH_PROCESS_SECONDS 0.2

/* Whose turn it is. */
BenchBuild bench_ab_turn(int round, int turn);

/* Runs all rounds and adds what they measured. `machine` receives each build's environment, from
 * its first process. A scene that the old build does not have (its exit code says so, in the first
 * round) is left without old times, with the reason. Errors: SM_INPUT, SM_INVALID: a process that
 * fails or crashes, with its line; a file of it that cannot be read; interrupted. SM_OUTPUT: the
 * disk is full. */
SmCode bench_ab_run(const BenchAbRunner *runner, BenchAbSamples *all,
                    BenchMachine machine[BENCH_BUILDS], SmError *error);

#endif
