/* box_sum_fixups.h - what box sums get wrong (boxes.c), put right.
 *
 * Where a region's members differ from the sites that its box sum takes (a gap, a corner), each
 * particle too many is subtracted again and each one missing is added: on the way up from the
 * region's sum, on the way down the region from the particle's. Lanes of part of a block
 * (SM_PART) that differ at the same offset by lanes of the same block are one fix-up, so parts of
 * vectors are read from where their lanes begin, and masked: fix-ups have few lanes, seldom more
 * than two, and 64 bytes take twice the time of 32. Where that takes more than the members
 * themselves, the box sum is dropped and they are all added: what is left of a sum is then never
 * small beside what was taken from it. The fix-ups of a part follow each other in the order of
 * their offsets (c, b, a). */
#ifndef LSM_BOX_SUM_FIXUPS_H
#define LSM_BOX_SUM_FIXUPS_H

#include "../state.h"

#define lsm_fixups_open      SM_NAME(lsm_fixups_open)
#define lsm_fixups_share     SM_NAME(lsm_fixups_share)
#define lsm_fixups_add       SM_NAME(lsm_fixups_add)
#define lsm_fixups_finish    SM_NAME(lsm_fixups_finish)
#define lsm_fixups_close     SM_NAME(lsm_fixups_close)
#define lsm_fixups_mark      SM_NAME(lsm_fixups_mark)
#define lsm_fixups_free      SM_NAME(lsm_fixups_free)
#define lsm_fixups_keep      SM_NAME(lsm_fixups_keep)
#define lsm_fixup_regions    SM_NAME(lsm_fixup_regions)
#define lsm_fixup_products   SM_NAME(lsm_fixup_products)
#define lsm_fixup_goals      SM_NAME(lsm_fixup_goals)
#define lsm_fixup_velocities SM_NAME(lsm_fixup_velocities)

typedef struct {
    int source;           /* up: block of the members; down: row of `kept` */
    uint16_t lanes;       /* bit i: lane i of the part is corrected .. */
    int16_t from;         /* .. by lane i + from of the source */
    real sign, offset[3]; /* 1 or -1; from the corrected lane to its source, in cells */
} Fixup;

/* One way, up or down. */
typedef struct {
    Fixup *of;       /* [first[parts]] */
    long *first;     /* [parts + 1] */
    uint16_t *clear; /* [blocks] lanes whose box sum is dropped first */
} FixupList;

struct Fixups {
    FixupList up, down;
    int *row;   /* [blocks] row of `kept`, or -1: fix-ups down read this block's regions */
    real *kept; /* [rows][12][SM_LANES] what they bring down, until phase 2 */
    long rows;
};

typedef struct FixupsBuilder FixupsBuilder;

/* To find lsm->fixups: open for so many shares, which several threads may have; of each share, of
 * blocks on from those of the share before, add regions in the order of their particles (`rows`:
 * region.h), and finish it before block `block`; close, which frees the builder. Regions that are
 * not added need none. O(w^2) a region, and O(w^3) a block. */
FixupsBuilder *lsm_fixups_open(const Lsm *lsm, int shares);
FixupsBuilder *lsm_fixups_share(const Lsm *lsm, FixupsBuilder *builder, int share, long block);
void lsm_fixups_add(FixupsBuilder *own, long p, const uint64_t *rows);
void lsm_fixups_finish(FixupsBuilder *own, long block);
void lsm_fixups_close(FixupsBuilder *builder, int shares, Lsm *lsm);

/* Sets `mixed` and `listed` of the blocks (blocks.h) that fix-ups mend and read. */
void lsm_fixups_mark(const Lsm *lsm);

void lsm_fixups_free(Fixups *fixups);

/* Fix up the 12 sums of a block's regions, or their 12 products for damping; the 3 or 6 sums of its
 * particles. */
void lsm_fixup_regions(const Lsm *lsm, long block, vec *sums);
void lsm_fixup_products(const Lsm *lsm, long block, vec *sums);
void lsm_fixup_goals(const Lsm *lsm, long block, vec *sums);
void lsm_fixup_velocities(const Lsm *lsm, long block, vec *sums);

/* Keeps what a block's regions bring down (LsmPass), for fix-ups that read it. */
void lsm_fixups_keep(const Lsm *lsm, long block, const real *down);

#endif
