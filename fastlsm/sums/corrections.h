/* corrections.h - what box sums get wrong (blocks.h), put right.
 *
 * Where a region's members differ from the sites that its box sum takes (a gap, a corner), each
 * particle too many is subtracted again and each one missing is added: on the way up from the
 * region's sum, on the way down the region from the particle's. Lanes of half a block that differ
 * at the same offset by lanes of the same block are one correction, so half vectors are read from
 * where their lanes begin, and masked: corrections have few lanes, seldom more than two, and a
 * whole vector takes twice the time. Where that takes more than the members themselves, the box sum
 * is dropped and they are all added: what is left of a sum is then never small beside what was
 * taken from it. The corrections of half a block follow each other in the order of their offsets
 * (c, b, a). */
#ifndef LSM_CORRECTIONS_H
#define LSM_CORRECTIONS_H

#include "../state.h"

#define lsm_corrections_open  SM_NAME(lsm_corrections_open)
#define lsm_corrections_add   SM_NAME(lsm_corrections_add)
#define lsm_corrections_close SM_NAME(lsm_corrections_close)
#define lsm_corrections_mark  SM_NAME(lsm_corrections_mark)
#define lsm_corrections_free  SM_NAME(lsm_corrections_free)
#define lsm_corrections_bytes SM_NAME(lsm_corrections_bytes)

typedef struct {
    int source;           /* up: block of the members; down: row of `kept` */
    uint16_t lanes;       /* bit i: lane i of the half is corrected .. */
    int16_t from;         /* .. by lane i + from of the source */
    real sign, offset[3]; /* 1 or -1; from the corrected lane to its source, in cells */
} Correction;

/* One way, up or down. */
typedef struct {
    Correction *of;  /* [first[2 * blocks]] */
    long *first;     /* [2 * blocks + 1] of each half */
    uint16_t *clear; /* [blocks] lanes whose box sum is dropped first */
} CorrectionList;

struct Corrections {
    CorrectionList up, down;
    int *row;   /* [blocks] row of `kept`, or -1: corrections down read this block's regions */
    real *kept; /* [rows][12][SM_LANES] what they bring down, until part 2 */
    long rows;
};

typedef struct CorrectionsBuilder CorrectionsBuilder;

/* To find lsm->corrections: open, add regions in the order of their particles (`rows`: region.h),
 * close, which frees the builder. Regions that are not added need none. O(w^2) a region, and O(w^3)
 * a block. */
CorrectionsBuilder *lsm_corrections_open(const Lsm *lsm);
void lsm_corrections_add(CorrectionsBuilder *builder, long p, const uint64_t *rows);
void lsm_corrections_close(CorrectionsBuilder *builder, Lsm *lsm);

/* Sets `mixed` and `listed` of the blocks (blocks.h) that corrections mend and read. */
void lsm_corrections_mark(const Lsm *lsm);

void lsm_corrections_free(Corrections *corrections);

long lsm_corrections_bytes(const Lsm *lsm);

/* Keeps what a block's regions bring down (BlockSolve), for corrections that read it. */
SM_INLINE void keep_solved(const Lsm *lsm, long block, int values, const vec *out)
{
    real *kept = lsm->corrections->kept + lsm->corrections->row[block] * 12L * SM_LANES;
#pragma GCC unroll 12
    for (int i = 0; i < values; i++) lanes_store(kept + i * SM_LANES, out[i]);
}

#endif
