/* ranks.h - the processes of an MPI launch (mpirun): which one this is, and notes from all of them
 * to rank 0. A program that was started alone is rank 0 of 1. Built without MPI there is no other.
 */
#ifndef BENCH_RANKS_H
#define BENCH_RANKS_H

#include <stdbool.h>
#include <stddef.h>

#include "../../lib/error.h"

typedef struct {
    int rank, count;
} BenchRanks;

typedef enum { BENCH_NOTE_POINT = 1, BENCH_NOTE_END, BENCH_NOTE_FAILED } BenchNoteKind;

/* A note as it comes. */
typedef struct {
    BenchNoteKind kind;
    int rank; /* who sends it */
    size_t size;
    char *bytes; /* [size] of a point, or the text of a failure; the caller frees them */
} BenchNote;

/* Finds out; ranks above 0 are silent from then on. Call it before anything is printed. SM_USAGE: a
 * launch of several processes, and this program was built without MPI or for another one. */
SmCode bench_ranks_start(BenchRanks *ranks, SmError *error);

/* Rank 0's bytes to all. All ranks call it. */
void bench_ranks_share(const BenchRanks *ranks, void *bytes, int size);

/* A note to rank 0, from another rank. */
void bench_ranks_send(const BenchRanks *ranks, BenchNoteKind kind, const void *bytes, size_t size);

/* On rank 0: the next note; without `wait` only if there is one. */
bool bench_ranks_receive(const BenchRanks *ranks, bool wait, BenchNote *note);

/* All ranks call it in the end, with their exit code; or rank 0 alone when what the others send
 * cannot be written (SM_OUTPUT): then that is the code of all, and it does not return. */
void bench_ranks_end(const BenchRanks *ranks, SmCode code);

#endif
