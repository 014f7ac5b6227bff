/* checker.h - an engine's check of a measured row: of its states before and after it is timed. */
#ifndef BENCH_CHECKER_H
#define BENCH_CHECKER_H

#include "../play/playback.h"
#include "row.h"

typedef struct BenchChecker {
    size_t size; /* of `worst`: what was found of all states of a row, zeroed to begin with */

    /* SM_INPUT: the scene has what is not measured. Before anything is built. May be NULL. */
    SmCode (*takes)(const BenchScene *scene, SmError *error);

    /* Whether what the scene makes of its body cannot be put back: then it is played (burst.h), and
     * rest() is called before and state() in the end, both without a check. NULL: it can. */
    bool (*breaks)(const BenchScene *scene);

    /* SM_INPUT: the bodies contradict themselves, or their check would take too long. May be
     * NULL. */
    SmCode (*accepts)(const BenchPlayback *play, SmError *error);

    /* What the check needs of the bodies as they are now; begun anew when they have changed. NULL,
     * like free(): nothing. */
    void *(*begin)(BenchPlayback *play);

    /* Of the bodies at rest: do the engines have what they should? May be NULL. */
    void (*rest)(void *check, BenchPlayback *play, void *worst, BenchRow *row);

    /* Of the present state, which stays: row->found says what all states came to, and a row that is
     * wrong is made invalid. */
    void (*state)(void *check, BenchPlayback *play, void *worst, BenchRow *row);

    /* What takes steps, in the end. May be NULL. */
    void (*end)(void *check, BenchPlayback *play, void *worst, BenchRow *row);
    void (*free)(void *check);
} BenchChecker;

/* Goals, damping, contacts, obstacles, momentum, plastic flow (check.h): of engines with a twin. */
extern const BenchChecker bench_matching_checker;

#endif
