/* state.h - what a FastLSM body holds, in one precision.
 *
 * Inside, lengths are lattice cells from a movable origin and velocities are cells per step, so
 * that the kernels see the same scales for every mesh. Particles live in slots; SM_LANES slots are
 * a block, and a block's coordinates are stored as x[3][lanes]. Planes of the lattice are grouped
 * into layers, the unit of the pipeline (pipeline.h).
 *
 * Many bodies may share a lattice and its lists: a lane is a body then, a block one particle of
 * SM_LANES bodies, a layer all particles of these. A tile is one of their regions, and one body's
 * particle numbers stand for slots (sums/instances.c).
 *
 * Sums have several forms (sums/sums.h). In those over lists (lattice/subsum_lists.h) a body's
 * slots follow each other without holes and every region has its lists. Where they are box sums a
 * block is SM_LANES lattice sites along x, and only regions that a box sum gets wrong have lists.
 */
#ifndef LSM_STATE_H
#define LSM_STATE_H

#include "../lib/engine/engine.h"
#include "../lib/engine/integrate.h"
#include "../lib/simd/lanes.h"
#include "lattice/list_allocator.h"

typedef struct {
    vec inverse_mass, offset[3]; /* 1 / M_r; c0_r - x0_r in cells */
} RegionConst;

typedef struct {
    vec weight, inverse_count; /* m~_i = m_i / |R_i|; 1 / |R_i|; 0 for an empty slot */
} ParticleConst;

/* How many constant records there are. Equal ones are stored once; those from `shared` on belong to
 * one block or tile each, whose regions have changed. */
typedef struct {
    long shared, count, room;
} Records;

/* Rows of list sums, in vectors that are padded to four. What is made of fewer is less wide
 * (list_rows.h). */
enum { ROW_P = 4, ROW_WIDTH = 16 };

typedef struct {
    real *p;         /* [slots + 1][ROW_P]      m~ x */
    real *bar;       /* [bars][ROW_WIDTH]       sums of p and of a p; then the adjoint's (Q, R z,
                                                R y), as the plates are done with it */
    real *transform; /* [slots + 1][ROW_WIDTH]  (q_r, R z, R y, R x) */
    real *plate[2];  /* [plates][ROW_WIDTH]     up, .. and of b p; down, (Q, R z) */
    int shift;       /* from a slot to its row of p and transform */
} Rows;

/* Damping keeps its products in `transform`, and then (omega, v_r - omega x c_r) in their place; it
 * sums through the same bars and plates. */

/* Row 0 of every array is zero (the absent member). Memory is what
 * takes time here: a thread has rows of one layer, or its bars of one plane; plates, which are all
 * threads', take turns until the layers around are done with them (lists.c). */

typedef struct LsmPass LsmPass;       /* what is summed, and what for: sums.h */
typedef struct LsmSums LsmSums;       /* a form of the sums: sums.h */
typedef struct Blocks Blocks;         /* box sums: blocks.h */
typedef struct LsmRunning LsmRunning; /* running_sums.c */

typedef struct Lsm {
    /* the body */
    int w, side, threads;
    SmEngineParams params;
    long bodies;         /* above 1: instances */
    double (*origin)[3]; /* [bodies, in whole groups of lanes] */
    double cell;         /* position = origin + cell * x */
    LsmLattice lattice;
    LsmInterior interior;
    LsmLists lists;
    LsmListAllocator *allocator; /* NULL for a body that cannot break */
    LsmRunning *running;         /* in place of the lists of `lists`, or NULL */
    long spare;                  /* rows that its layers have left at least */
    char *mark;                  /* [particles] zero between breaks, or NULL */
    double *mass; /* [particles] in units of mass_unit kg, their mean; NULL: all are 1 */
    double mass_unit;
    int *members;  /* [particles] |R_i|, kept in a body that can break */
    int *slot;     /* [particles] */
    int *particle; /* [blocks * lanes], -1 for an empty slot; NULL of instances */
    long unique;   /* different regions, or -1: ask lsm_unique() */

    /* the state */
    long blocks;
    real *x, *v;      /* [blocks][3][SM_LANES] */
    real *g;          /* the same, in the memory of `centre`; NULL when no goals are held */
    int *block_const; /* [blocks] */
    ParticleConst *particle_const;
    int *block_region; /* [blocks * lanes] row of lists.region that sums over this particle, or -1;
                          in list form row p is particle p's, so this is `particle` */

    /* regions, SM_LANES to a tile; in block form, and in a body that can break, tile t is block t
     */
    long tiles;
    int *tile_slot;  /* [tiles * lanes] slot of the region's centre, or -1; [tiles of a layer] of
                        instances, all of whose layers have the same */
    int *tile_const; /* [tiles] */
    uint16_t *live;  /* [tiles] the lanes with a region, as bits */
    RegionConst *region_const;
    real *centre;   /* [tiles][3][lanes] c_r, kept for damping; room for g */
    short *last;    /* [tiles][6][lanes] two columns of the last rotation (rotate_lanes.h) */
    real *stretch;  /* [tiles][9][lanes] eigenvectors for the warm-started Jacobi method, or NULL */
    double *sweeps; /* [layers] Jacobi sweeps of the last step */
    long copies;    /* regions identical to another */
    int (*copy)[2]; /* [copies] (slot of the copy, slot of the original) in list form; of instances
                       those of every layer */
    long *layer_copy; /* [layers + 1] */

    /* layers */
    int layers, reach;              /* regions of layer l need layers l - reach .. l + reach */
    int chapter;                    /* layers that one thread runs in turn: pipeline.h */
    int *layer_plane;               /* [layers + 1] */
    long *layer_block, *layer_tile; /* [layers + 1] */
    int *thread_layer;              /* [threads + 1] first layer of each thread */

    Rows *rows;        /* [threads] */
    real **group_rows; /* [threads][group_size] of instances */
    size_t group_size;
    bool *listed; /* [blocks] lists read this block's particles and what it brings down: rows of
                     them are needed; NULL in list form: all are */
    Blocks *box;  /* NULL in list form */
    const LsmPass *pass;
    const LsmSums *sums;
    SmLaps *laps; /* of thread 0, or NULL */
    long steps;
    bool damp_now;

    real gravity[3]; /* cells per step and step */
    real rounding;   /* of a body at rest, square of what goals are off (integrate.h); else 0 */
    Obstacles obstacles;
    vec (*shift)[3]; /* (origin - home) / cell: from x to obstacle coordinates; [layers] of
                        instances */
    double home[3];
    long broken;
    Records particle_records, region_records;
} Lsm;

/* Where component 0 of a particle of a body is in x, v and g; the others follow at SM_LANES. */
static inline long place_of(const Lsm *lsm, long body, long p)
{
    bool one = lsm->bodies == 1;
    long block = one ? lsm->slot[p] / SM_LANES : body / SM_LANES * lsm->lattice.count + p;
    return block * 3 * SM_LANES + (one ? lsm->slot[p] : body) % SM_LANES;
}

/* What is about to be changed from outside, at place_of() a particle. */
static inline void lsm_moved_from(const Lsm *lsm, long at, MomentumChange *change)
{
    for (int d = 0; d < 3; d++) {
        change->x[d] = (double)lsm->x[at + d * SM_LANES];
        change->v[d] = (double)lsm->v[at + d * SM_LANES];
        change->dx[d] = change->dv[d] = 0;
    }
}

/* Of a block; only where there are obstacles: a division takes longer than it looks. */
SM_INLINE const vec *shift_of(const Lsm *lsm, long block)
{
    bool one = lsm->bodies == 1 || lsm->obstacles.count == 0;
    return lsm->shift[one ? 0 : block / lsm->lattice.count];
}

/* In units of mass_unit. */
static inline double mass_of(const Lsm *lsm, long p)
{
    return lsm->mass ? lsm->mass[p] : 1;
}

/* The lanes with a list row. */
SM_INLINE ivec listed_lanes(const int *region)
{
    typedef int narrow __attribute__((vector_size(SM_LANES * sizeof(int)), aligned(sizeof(int))));
    return __builtin_convertvector(*(const narrow *)region, ivec) >= 0;
}

/* List form: the rows of lists.region of a tile. */
SM_INLINE void tile_regions(const Lsm *lsm, long tile, int region[SM_LANES])
{
    const int *slot = lsm->tile_slot + tile * SM_LANES;
    for (int lane = 0; lane < SM_LANES; lane++)
        region[lane] = slot[lane] < 0 ? -1 : lsm->particle[slot[lane]];
}

#endif
