/* blocks.h - lattice sites in blocks of SM_LANES along x, in rows and planes, and what box sums
 * over them (boxes.c) need. */
#ifndef LSM_BLOCKS_H
#define LSM_BLOCKS_H

#include "../state.h"

#define lsm_blocks_build   SM_NAME(lsm_blocks_build)
#define lsm_blocks_regular SM_NAME(lsm_blocks_regular)
#define lsm_blocks_share   SM_NAME(lsm_blocks_share)
#define lsm_blocks_free    SM_NAME(lsm_blocks_free)

/* From which w on sums move along y and z, and after how many rows and planes they are summed anew.
 * After 32 rows a w of 5 is 3% faster, but rounding has added up to where large bodies at rest do
 * not stay there; and planes in between are one thread's. */
enum { RUNNING = 3, RESTART = 8 };

/* Blocks that touch along x. A row may have several runs. */
typedef struct {
    int y, column; /* of the first block; columns are in blocks */
    int first, count;
    bool moves_y, moves_z; /* windows of its blocks move on from the row or plane before */
} BlockRun;

/* The runs of a row of a plane. */
typedef struct {
    const BlockRun *run;
    int runs;
} BlockRow;

struct Blocks {
    int width;          /* blocks across the lattice's box along x */
    bool running;       /* sums along y and z are windows that move: O(1) */
    bool streams;       /* what a step goes through does not stay in cache: it is asked for ahead */
    int *plane_run;     /* [planes + 1] first run of each plane; runs rise in y, then x */
    int *row_run;       /* [planes * rows + 1] the same of each row */
    BlockRun *run;      /* and one more, where the blocks end */
    int *place;         /* [blocks] the same in every plane: y * width + column */
    int *along_z;       /* [blocks][side] the block at the same place in planes z - w .. z + w; the
                           empty block (number `blocks`) where there is none */
    uint64_t *passable; /* bitmap of the sites whose sums other sites' sums pass through */
    bool *mixed;        /* [blocks] some lanes are summed by their lists */
    real **down;        /* [planes] where a plane's (Q, Rz) sums are kept until phase 2 */
    real *down_memory;
    int threads;
    real **scratch;  /* [threads] rows of one plane, and windows */
    BlockRow **held; /* [threads] what is in these rows (boxes.c) */
    real **window;   /* [threads] up, down: the z windows of a plane's places, [12] and [6] blocks
                        each; none unless `running` */
};

/* Blocks, rows and neighbours of the lattice; sets lsm->blocks, slot, particle, layers. */
void lsm_blocks_build(Lsm *lsm);

/* Is the box sum of particle p, whose members are `rows` (region.h), its region's sum? O(w^2). */
bool lsm_blocks_regular(const Lsm *lsm, long p, const LsmRow *rows);

/* Scratch and plane stores for lsm->threads threads. */
void lsm_blocks_share(Lsm *lsm);

void lsm_blocks_free(Blocks *box);

#endif
