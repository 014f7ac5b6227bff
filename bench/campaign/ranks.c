#include "ranks.h"

#include <stdio.h>
#include <stdlib.h>

/* What launchers tell their processes: Open MPI's, those of MPICH's kind, Slurm's. */
static long launcher_says(const char *const *names, long otherwise)
{
    for (; *names; names++) {
        const char *text = getenv(*names);
        if (text && *text) return strtol(text, NULL, 10);
    }
    return otherwise;
}

static const char *const counts[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", NULL};
static const char *const numbers[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", NULL};

static void be_silent(void)
{
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) exit(SM_OUTPUT);
}

static SmCode join(BenchRanks *ranks, long count, SmError *error);

SmCode bench_ranks_start(BenchRanks *ranks, SmError *error)
{
    *ranks = (BenchRanks){0, 1};
    long count = launcher_says(counts, 1), number = launcher_says(numbers, -1);
    if (number < 0 && count <= 1) return SM_OK;
    if (number > 0) be_silent();
    return join(ranks, count, error);
}

#ifdef SHAPEBENCH_MPI

#include <mpi.h>

static SmCode join(BenchRanks *ranks, long count, SmError *error)
{
    MPI_Init(NULL, NULL);
    MPI_Comm_rank(MPI_COMM_WORLD, &ranks->rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks->count);
    if (ranks->count == count || count == 1) return SM_OK;
    return sm_fail(error, SM_USAGE,
                   "started as one of %ld processes by another MPI than the one that it was built "
                   "with: use that one's mpirun",
                   count);
}

void bench_ranks_share(const BenchRanks *ranks, void *bytes, int size)
{
    if (ranks->count > 1) MPI_Bcast(bytes, size, MPI_BYTE, 0, MPI_COMM_WORLD);
}

void bench_ranks_send(const BenchRanks *ranks, BenchNoteKind kind, const void *bytes, size_t size)
{
    (void)ranks;
    MPI_Send(bytes, (int)size, MPI_BYTE, 0, (int)kind, MPI_COMM_WORLD);
}

bool bench_ranks_receive(const BenchRanks *ranks, bool wait, BenchNote *note)
{
    int there = wait, size;
    MPI_Status status;
    if (ranks->count == 1) return false;
    if (wait)
        MPI_Probe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &status);
    else
        MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (!there) return false;
    MPI_Get_count(&status, MPI_BYTE, &size);
    *note = (BenchNote){(BenchNoteKind)status.MPI_TAG, status.MPI_SOURCE, (size_t)size,
                        sm_alloc((size_t)size + 1, 1)};
    MPI_Recv(note->bytes, size, MPI_BYTE, note->rank, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    return true;
}

void bench_ranks_end(const BenchRanks *ranks, SmCode code)
{
    int begun = 0, over = 0;
    if (ranks->count > 1 && code == SM_OUTPUT) MPI_Abort(MPI_COMM_WORLD, (int)code);
    MPI_Initialized(&begun);
    MPI_Finalized(&over);
    if (begun && !over) MPI_Finalize();
}

#else

static SmCode join(BenchRanks *ranks, long count, SmError *error)
{
    (void)ranks;
    if (count <= 1) return SM_OK;
    return sm_fail(error, SM_USAGE,
                   "started as one of %ld processes, but built without MPI: install libopenmpi-dev "
                   "and build again",
                   count);
}

void bench_ranks_share(const BenchRanks *ranks, void *bytes, int size)
{
    (void)ranks, (void)bytes, (void)size;
}

void bench_ranks_send(const BenchRanks *ranks, BenchNoteKind kind, const void *bytes, size_t size)
{
    (void)ranks, (void)kind, (void)bytes, (void)size;
}

bool bench_ranks_receive(const BenchRanks *ranks, bool wait, BenchNote *note)
{
    (void)ranks, (void)wait, (void)note;
    return false;
}

void bench_ranks_end(const BenchRanks *ranks, SmCode code)
{
    (void)ranks, (void)code;
}

#endif
