/* state.h - what the octree engine holds, in one precision.
 *
 * Inside, lengths are finest cells from movable origins (frames.h) and velocities are finest cells
 * per step. Simulation nodes are stored in slots, slot = leaf number; SM_LANES slots are a block,
 * and a block's coordinates are stored as x[3][lanes]. A slot without a leaf, beyond the last one
 * or of a number not in use, has no mass and matches the unit row, so that no lane is a special
 * case; its sums go to a spare row, and it stays near the origin. Region r is that of simulation
 * node r.
 */
#ifndef OCT_STATE_H
#define OCT_STATE_H

#include "../lib/engine/engine.h"
#include "../lib/engine/integrate.h"
#include "../lib/simd/lanes.h"
#include "region/sum_lists.h"
#include "region/weights.h"
#include "tree/tree.h"

typedef struct {
    OctWeighting weighting;
    OctGoalForm form;
    SmPolarMethod polar;
    double damping; /* k in [0,1]; 0: none */
    int damping_every;
    double gravity[3]; /* finest cells per step and step */
    double yield;      /* |S - I| from which a region deforms for good; plasticity only if creep */
    double creep;      /* share of it that stays in each step: h times the creep rate; 0: elastic */
    double most;       /* largest |S_r - I| */
    int threads;       /* 0: OpenMP's number */
    long instances;    /* bodies that share the structure; 0 means 1 */
} OctParams;

/* Constants of a block. */
typedef struct {
    vec weight, inverse_reach;   /* of the simulation nodes: m~_i; 1 / M_i */
    vec mass;                    /* m_r */
    vec inverse_mass, offset[3]; /* of the regions: 1 / M'_r; c0_r - x0_r */
    vec centre[3];               /* x0, finest cells from the tree's first node */
} OctConst;

/* The collinear regions of a block (collinear_regions.h). */
typedef struct {
    ivec lanes;
    vec axis[3];
} OctCollinear;

/* The row of a tree node once more, about the origin of another frame (ghosts.h). */
typedef struct {
    int node, from, to;    /* the frames of its leaves and of the lists that name the ghost */
    real mass;             /* of its leaves */
    real weight, first[3]; /* sum m~; sum m~ (x0 - centre) */
} OctGhost;

/* A row holds what a tree node sums: four quarters of three values each and a fourth, `pad`.
 *     moments      sum m~ x            ; of m~ x (x0 - centre)^T the columns x, y, z
 *     transforms   value at the centre ; linear part, columns x, y, z
 *     damping      twelve sums
 * The pads of quarters 1 to 3 hold the node's centre (body_arrays.h), x, y, z; that of quarter 0 is
 * 0. Row numbers are those of sum_lists.h. */
enum { OCT_ROW = 16, OCT_ROW_VELOCITY = 8 };

/* Sums of one body while it is stepped. */
typedef struct {
    real *moment;    /* [rows][OCT_ROW] */
    real *transform; /* [rows][OCT_ROW] transforms, then what damping sums */
    real *velocity;  /* [rows][OCT_ROW_VELOCITY] rigid velocities: omega, 0, v - omega x c, 0 */
    real *centre;    /* [blocks][3][lanes] c_r, kept for damping */
} OctRows;

/* One body. */
typedef struct {
    double (*origin)[3]; /* [frames] finest cells: a leaf is at its frame's origin + x */
    double kick[3];  /* finest cells per step: its velocity is kick + v; the next step adds it */
    real *x, *v, *g; /* [blocks][3][lanes] */
    short *last;     /* [blocks][6][lanes] the regions' last rotations (rotate_lanes.h) */
    real *stretch;   /* [blocks][9][lanes] eigenvectors for Jacobi's method, or NULL */
    real *plastic;   /* [blocks][9][lanes] S_r, or NULL for an elastic body */
    real *inverse;   /* [blocks][9][lanes] Aqq_r, or NULL */
} OctState;

typedef struct {
    OctParams params;
    long leaves, nodes; /* numbers; of a fixed body all are in use */
    long alive;         /* leaves */
    long blocks;
    long block_room, node_room; /* there is place for as many */
    int levels, threads;
    double mass_unit;
    OctSumLists lists, goal_lists; /* goal_lists is zeroed where the same lists serve */
    OctLevels inner;               /* tree nodes with children; of a fixed body rising */
    int *child;                    /* [nodes] */
    unsigned char *children;       /* [nodes] */
    int *row;             /* [blocks * lanes] row of a slot, the spare one if it has no leaf */
    unsigned char *live;  /* [blocks] leaves in it */
    OctConst *block;      /* [blocks] */
    long collinear_count; /* blocks that have had collinear regions */
    long collinear_room;
    int *collinear_of;              /* [blocks] which of them, or -1 */
    OctCollinear *collinear;        /* [collinear_count] */
    real *spread;                   /* [blocks][6][lanes] rest moments of the regions, or NULL */
    long *share;                    /* [threads + 1] first block of each thread */
    struct OctDynamicBody *dynamic; /* what is kept to change the body (dynamic_body.h), or NULL */

    long frames;
    int *frame;             /* [slots] of every leaf; NULL: one for all */
    long ghosts, ghost_row; /* the first one's row */
    OctGhost *ghost;        /* [ghosts] */
    double (*middle)[4];    /* [frames] for oct_recentre() */

    int workers;   /* bodies that are stepped at the same time */
    OctRows *rows; /* [workers] */
    long instances;
    OctState *body; /* [instances] */
    bool damp_now;
    long steps;
    long recentred, recentre; /* `steps` when origins moved last, and are to move next */
    real gravity[3];
    real rounding, at_rest; /* square of what goals are off by rounding (integrate.h), of bodies at
                             * rest, else 0; and what it is then */
    Obstacles obstacles;    /* in finest cells from where origins count */
} Oct;

/* What one thread steps one body with. */
typedef struct {
    Oct *oct;
    OctState *body;
    OctRows *rows;
    const int *inner; /* of the level that oct_climb() is at */
    int me, team;
    bool goals;   /* goal positions only */
    bool alone;   /* the first thread has worked alone since all have met */
    SmLaps *laps; /* of the first thread of an instrumented step, or NULL */
} OctTask;

/* Where the coordinates of a leaf count from. */
static inline double *oct_origin(const Oct *oct, const OctState *body, long leaf)
{
    return body->origin[oct->frame ? oct->frame[leaf] : 0];
}

/* The same of a block's leaves, for obstacles. */
SM_INLINE void oct_shift(const Oct *oct, const OctState *body, long block, vec shift[3])
{
    for (int d = 0; d < 3; d++) shift[d] = lanes_set((real)body->origin[0][d]);
    for (int lane = 0; oct->frame && lane < SM_LANES; lane++)
        for (int d = 0; d < 3; d++)
            shift[d][lane] = (real)oct_origin(oct, body, block * SM_LANES + lane)[d];
}

/* Where number `field` of a simulation node's `fields` is in an array [blocks][fields][lanes]. */
static inline long oct_field(long leaf, int fields, int field)
{
    return (leaf / SM_LANES * fields + field) * SM_LANES + leaf % SM_LANES;
}

/* Where component d of a simulation node is in x, v and g of a body. */
static inline long oct_index(long leaf, int d)
{
    return oct_field(leaf, 3, d);
}

/* The number of a body's block among those of all. */
static inline long oct_block(const Oct *oct, const OctState *body, long block)
{
    return (body - oct->body) * oct->blocks + block;
}

/* What is about to be changed from outside. */
static inline void oct_moved_from(const Oct *oct, const OctState *body, long leaf,
                                  MomentumChange *change)
{
    for (int d = 0; d < 3; d++) {
        change->x[d] = oct_origin(oct, body, leaf)[d] + (double)body->x[oct_index(leaf, d)];
        change->v[d] = (double)body->v[oct_index(leaf, d)];
        change->dx[d] = change->dv[d] = 0;
    }
}

/* The lists that goal positions and damping sum over. */
static inline const OctSumLists *oct_goal_lists(const Oct *oct)
{
    return oct->goal_lists.rows.first ? &oct->goal_lists : &oct->lists;
}

#endif
