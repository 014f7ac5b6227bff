/* ranks.h - the processes of an MPI launch (mpirun): which one this is, and notes from all of them
 * to rank 0. A program that was started alone is rank 0 of 1. Built without MPI there is no other.
 */
#ifndef BENCH_RANKS_H
#define BENCH_RANKS_H

#include <stdbool.h>

#include "../../lib/error.h"
#include "../sweep/point.h"

typedef struct {
    int rank, count;
} BenchRanks;

typedef enum { BENCH_NOTE_POINT, BENCH_NOTE_END, BENCH_NOTE_FAILED } BenchNoteKind;

typedef struct {
    BenchNoteKind kind;
    int rank;         /* who sends it; filled in */
    BenchPoint point; /* of a point */
    char line[512];   /* of a failure */
} BenchNote;

/* Finds out; ranks above 0 are silent from then on. Call it before anything is printed. SM_USAGE: a
 * launch of several processes, and this program was built without MPI or for another one. */
SmCode bench_ranks_start(BenchRanks *ranks, SmError *error);

/* Rank 0's bytes to all. All ranks call it. */
void bench_ranks_share(const BenchRanks *ranks, void *bytes, int size);

/* A note to rank 0, from another rank. */
void bench_ranks_send(const BenchRanks *ranks, BenchNote *note);

/* On rank 0: the next note; without `wait` only if there is one. */
bool bench_ranks_receive(const BenchRanks *ranks, bool wait, BenchNote *note);

/* All ranks call it in the end; or rank 0 alone when it fails, with the exit code for all: then it
 * does not return where there are others. */
void bench_ranks_stop(const BenchRanks *ranks);
void bench_ranks_abort(const BenchRanks *ranks, int code);

#endif
