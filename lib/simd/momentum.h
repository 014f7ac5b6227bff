/* momentum.h - bodies keep their momenta, whatever rounding adds to them.
 *
 * Shape matching conserves linear and angular momentum: the impulses m (g - x) of a region add up
 * to zero, and so do their moments. Rounded they do not quite, and since a body that moves little
 * is rounded the same way in every step, what is left adds up: a body at rest in empty space would
 * fly away, ever faster. So every few steps the momenta of each piece of a body are measured and
 * compared with what they should be, which is what they were at first and what gravity has added.
 * At the next measurement the difference is taken from the piece's particles as a rigid velocity,
 * and the distance of its centre from its parabola as a displacement. The error then stays what a
 * few steps make of it, for any number of steps.
 *
 * Pieces are measured apart, because each keeps its own momentum. What handles, obstacles, contacts
 * and forces add to it is counted as they add it. Whoever sets positions or velocities says so by
 * momentum_forget(), and begins anew; so does a body that is torn about so that its spread is
 * another one a step later, because what is too much is taken from it some steps after it was
 * measured.
 *
 * Lengths are cells, velocities cells per step, as inside an engine. */
#ifndef SM_MOMENTUM_H
#define SM_MOMENTUM_H

#include "lanes.h"

#define Momentum        SM_NAME(SmMomentum)
#define momentum_build  SM_NAME(sm_momentum_build)
#define momentum_room   SM_NAME(sm_momentum_room)
#define momentum_frames SM_NAME(sm_momentum_frames)
#define momentum_divide SM_NAME(sm_momentum_divide)
#define momentum_forget SM_NAME(sm_momentum_forget)
#define momentum_begin  SM_NAME(sm_momentum_begin)
#define momentum_pushed SM_NAME(sm_momentum_pushed)
#define momentum_settle SM_NAME(sm_momentum_settle)
#define momentum_notes  SM_NAME(sm_momentum_notes)
#define momentum_keep   SM_NAME(sm_momentum_keep)
#define momentum_shift  SM_NAME(sm_momentum_shift)
#define momentum_free   SM_NAME(sm_momentum_free)

/* Sums over slots go as many ways side by side whatever SM_LANES is, so that rounding does not
 * depend on it where slots do not. In blocks of a lattice they do. */
enum { MOMENTUM_SUMS = 16, MOMENTUM_WAYS = 16 };

/* One piece of one body. Places count from where the origins do (momentum_keep()). */
typedef struct {
    double mass, about[3];                 /* what sums are taken about; whole cells */
    double place[3], velocity[3], spin[3]; /* where its centre should be, and its momenta */
    double shift[3], push[3], turn[3];     /* too far, too fast, turning about `about` */
    double drift[3], twist[3];             /* what rounding adds from one time to the next */
    double widest;                         /* largest trace of its spread lately */
    double struck;                         /* m (dx^2 + dv^2) of what has been moved from outside */
    double sum[MOMENTUM_SUMS];             /* of its particles, while they are measured; of changes
                                            * from outside, while they are counted */
    long since;                            /* the `age` in which these were measured */
} MomentumPiece;

/* Blocks whose lanes are of the same pieces and frames; of one piece where it is not -1. */
typedef struct {
    long first, piece;
} MomentumRun;

/* Blocks that obstacles have pushed in this step. */
typedef struct {
    bool *noted;  /* [blocks of all bodies], or NULL: there are no obstacles */
    real *before; /* [blocks of all bodies][6][SM_LANES] x and v before the push */
} MomentumNotes;

typedef struct {
    /* the caller's to fill in before momentum_divide(): */
    real *mass; /* [slots] 0 in empty ones; abreast, slots are particles */
    int *label; /* [slots] the piece, from 0; -1 in empty slots */
    int *frame; /* [slots] which origin x counts from; NULL, as built: 0 (momentum_frames()) */
    /* its own: */
    long blocks; /* of SM_LANES slots, of one body; abreast: its particles */
    long bodies;
    bool abreast; /* lane l of group k is body k SM_LANES + l */
    int threads;
    long pieces, piece_room;
    MomentumPiece *piece; /* [bodies][pieces] */
    long runs;
    MomentumRun *run; /* [runs + 1] */
    void *sum;        /* of the runs that are summed at once */
    MomentumNotes notes;
    bool begun, moving; /* momenta are known; and something has moved since they were forgotten */
    long age;           /* how often momenta were forgotten, and once more */
    long every, steps;  /* steps from one measurement to the next, and since the last one */
} Momentum;

/* Room for bodies of so many blocks each, without masses or pieces, whose momenta are kept in every
 * `every`-th step. The caller frees. */
Momentum *momentum_build(long blocks, long bodies, bool abreast, int every, int threads);

/* Bodies have as many blocks from now on. Allocates. */
void momentum_room(Momentum *m, long blocks);

/* Room for frames, all 0, if there is none. Allocates. */
void momentum_frames(Momentum *m);

/* Takes up masses, labels of `pieces` pieces, and frames. Forgets. Allocates only where there are
 * more pieces than ever before. O(slots). */
void momentum_divide(Momentum *m, long pieces);

/* Something from outside has changed positions or velocities, or may have. NULL: does nothing. */
void momentum_forget(Momentum *m);

/* Before a step of a body that is free: takes its momenta for what they should be, unless they are
 * known. Of one body, or all of them if they are abreast. A particle is at x + origin[its frame];
 * origins count by whole cells, or are one that stays; NULL: 0. O(slots) when they are not known.
 */
void momentum_begin(Momentum *m, long body, const double (*origin)[3], real *x, real *v);

/* Is all of it known to rest? */
static inline bool momentum_rests(const Momentum *m)
{
    return m->begun && !m->moving;
}

/* Counts a step, if momenta are known. Is it time to keep them? */
static inline bool momentum_due(Momentum *m)
{
    return m->begun && ++m->steps >= m->every;
}

/* Measures one body (all of them if they are abreast), and takes from its particles what was found
 * too much the last time. `gravity` in cells per step and step. The same bits for any number of
 * threads. O(slots): some 40 operations a block, and reads 28 bytes a slot. */
void momentum_keep(Momentum *m, long body, const double (*origin)[3], real *x, real *v,
                   const real gravity[3]);

/* After all bodies were measured. */
static inline void momentum_kept(Momentum *m)
{
    m->steps = 0;
}

/* Something outside of the body has moved a slot (abreast: particle) at x, origin included, by dx,
 * and its velocity v by dv. `gravity` in cells per step and step; `ahead`: steps that were taken
 * and are not counted yet. Where momenta are not known: only that something moves; NULL: nothing.
 */
typedef struct {
    double x[3], v[3], dx[3], dv[3];
} MomentumChange;
void momentum_pushed(Momentum *m, long body, long slot, const MomentumChange *change,
                     const real gravity[3], long ahead);

/* Room for notes, before there are obstacles. Allocates. */
void momentum_notes(Momentum *m);

/* Of a block of all bodies that an obstacle is about to push, so that x and v change. */
SM_INLINE void momentum_note(const MomentumNotes *notes, long block, const vec x[3], const vec v[3])
{
    if (!notes || !notes->noted) return;
    notes->noted[block] = true;
    store3(notes->before + block * 6 * SM_LANES, x);
    store3(notes->before + (block * 6 + 3) * SM_LANES, v);
}

/* Counts what was noted of a body (of all if they are abreast) in the step that is not counted yet;
 * x and v are as obstacles have left them. O(blocks), and some 60 operations a slot of those that
 * were pushed. */
void momentum_settle(Momentum *m, long body, const double (*origin)[3], const real *x,
                     const real *v, const real gravity[3]);

/* x of a body counts from a place farther on by `by`, which no `origin` tells. */
void momentum_shift(Momentum *m, long body, const double by[3]);

void momentum_free(Momentum *m);

/* In how many steps origins are to go to their bodies' middles again, when in the last `since`
 * steps one has come `far` cells off: in 16, or as soon as one may be some eight cells off, because
 * in single precision a coordinate has the fewer digits behind the point the larger it is. */
static inline long sm_recentre_after(long since, double far)
{
    double enough = 8, steps = (double)since * enough / (far > enough / 2 ? far : enough / 2);
    return steps < 15 ? 1 + (long)steps : 16;
}

#endif
