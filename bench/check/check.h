/* check.h - are the goals of an engine's present state right? Held to brute force in double
 * precision: lattice engines to reference/brute.h, the octree to reference/octree_goals.h. A
 * plastic body's goals are those of the rest shapes that it has; whether they flow as they should
 * is a check of its own, over a step. And what all checks find (also step_check.h,
 * contact_check.h), with what of it is allowed. */
#ifndef BENCH_CHECK_H
#define BENCH_CHECK_H

#include "../../reference/brute.h"
#include "../../reference/octree_goals.h"
#include "../play/runner.h"

typedef struct {
    const BenchBody *body; /* the caller's, kept */
    long count;            /* particles that one body should have */
    long unique;           /* different regions; of an octree all */
    double *mass;          /* [count] */
    double *weight;        /* [count] what particles count in region sums */
    double (*rest)[3];     /* [count] rest positions, in cells */
    bool hierarchical;     /* an octree's */
    bool plain;            /* its weighting: momentum is measured, but need not be kept */
    RefRegions regions;    /* of a lattice, */
    long *sample, samples; /* or goals of so many particles alone are compared, */
    int w;                 /* whose regions these links make; 0: of all */
    RefLinks links;
    long parted;       /* and of its links those that are broken, */
    int (*pair)[2];    /* [parted]; */
    long parted_wrong; /* of these and those that were cut, what is only one of both */
    RefTreeBody octree;
} BenchCheck;

/* What rounding makes of the momenta of a body left alone, on planes, in contact and held at a
 * point (step_check.h); of the body where it is largest. */
typedef struct {
    long steps;      /* that it was left alone; 0: not tried */
    double linear;   /* change of its centre's velocity: cells a step, each step */
    double angular;  /* of its angular momentum over sum m r^2: radians a step, each step */
    double held;     /* of its centre's velocity along the scene's planes, when it falls on them: as
                      * linear; 0: there are none, or they leave no direction free */
    double touching; /* as held, of all bodies together, with contacts; 0: none collide */
    double hung;     /* as angular, about a particle of the first handle, which holds the body */
    double apart; /* how many times as wide it becomes, of a body in pieces, which fly apart; 1 of
                   * others */
} BenchDrift;

/* What was found, of all instances. */
typedef struct {
    bool finite; /* positions, velocities and goals */
    double
        goal_error; /* largest |g - brute force| over particles, in cells; infinite if not finite */
    double goal_tolerance; /* what is allowed */
    long sampled; /* particles whose goals were compared, without damping and contacts; 0: all */
    double momentum_error; /* |sum m g - sum m x| / sum m |x - centroid|, largest of all instances;
                            * with plain weighting, too */
    bool plain;            /* weighting, with which it need not be kept */
    BenchDrift drift;      /* of momenta, left alone over many steps; filled in by the caller */
    double damping_error;  /* |v - brute force| / largest |v| after damping, of the particle ... */
    double damping_tolerance; /* ... where it is largest of what is allowed there; 0: no damping */
    double motion_error;      /* bench_check_motion() of the step that was damped; 0: none was */
    long particles;           /* checked or left out */
    long tied;                /* left out: beyond goal_tolerance, in a region whose rotation is not
                               * unique */
    double tied_error;        /* of those; what they would add to goal_error */
    long unresolved; /* left out of damping's check: off by more than bench_check_step(), and
                      * tied or in a region of which rounding decides whether it is solid */
    double unresolved_error; /* of those, how far the step takes them elsewhere, in cells */
    long contact_nodes;      /* whose contacts were compared; 0: nothing collides */
    double deepest;          /* contact, in cells */
    long contact_all;        /* nodes at the surface of all bodies, which alone have any */
    long contacts;           /* of those compared, the engine's or brute force's */
    long contacts_wrong;     /* in one of the two only, or otherwise */
    double turn_error;       /* of an octree's colliding cells, largest |R - brute force| */
    bool obstacles;          /* a step against obstacles was compared: */
    long pushed;             /* particles that brute force pushes out of them, */
    long pushed_wrong;       /* and all that end it otherwise */
    long parted_wrong;       /* links of a lattice that are broken but not cut, or the other way */
} BenchDeviation;

/* Members of all regions of this body, at most: a window's, cut to the body's box. A check walks
 * through them some ten times, at thirty nanoseconds each. Beyond BENCH_MOST_MEMBERS goals are
 * checked of a sample of particles alone: of BENCH_SAMPLE_RUN that follow each other at as many
 * places as take that long, at least one. */
#define BENCH_MOST_MEMBERS 2e9
#define BENCH_MOST_SAMPLED 4e9
enum { BENCH_SAMPLE_RUN = 16 };
double bench_check_members(const BenchBody *body, int w);

/* What an engine's goals are held to: all particles' regions by the scene's w in cells, or a
 * tree's, leaf by leaf as the engine has them (reference/octree_regions.h is their twin, in tests).
 * `members` says how many region members, at most, that walks through. */
typedef struct BenchTwin {
    double (*members)(const BenchScene *scene, const BenchBody *body, const SmEngine *engine);
    void (*begin)(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                  SmEngine *engine, BenchCheck *check);
} BenchTwin;

extern const BenchTwin bench_lattice_twin, bench_octree_twin;

/* The members that a check walks through; INFINITY of an engine that has no twin. Beyond
 * BENCH_MOST_SAMPLED nothing is checked. */
double bench_twin_members(const BenchRunner *runner);

/* Builds the reference's regions for a lattice engine, of whose links these pairs are parted
 * (parted.h), which it takes over: O(particles (2w+1)^3) time, and memory for up to REF_KEPT
 * members. */
void bench_check_create(const BenchBody *body, int w, long parted, int (*pair)[2],
                        BenchCheck *check);

/* The same, but of a sample of particles, whatever it would take to check all. */
void bench_check_sample(const BenchBody *body, int w, BenchCheck *check);

/* For any engine on the scene's body that has a twin. */
void bench_check_begin(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       SmEngine *engine, BenchCheck *check);
void bench_check_free(BenchCheck *check);

/* Calls engine->goals() and compares; the state does not change.
 *
 * Particles of a region whose rotation is not unique to the precision are left out, and counted,
 * where their goals differ by more than the tolerance: there rounding decides, or what the rotation
 * was before. Of a region at rest goals are known to about epsilon D, D cells being the body's
 * largest distance from its middle; over the region's hold (reference/condition.h) they may differ
 * by as much as a turn by rounding moves them. Such are regions whose hold is below half of epsilon
 * D / tolerance, but none that is held to an eighth: where that would not do, the body is larger
 * than the precision resolves, and is INVALID.
 */
BenchDeviation bench_check_state(const BenchCheck *check, const SmEngineType *type,
                                 SmEngine *engine);

/* Momentum's error of one body's goals, and whether it is small enough; says so otherwise. */
double bench_check_momentum(const double (*x)[3], const double (*g)[3], const double *m,
                            long count);
bool bench_check_keeps(double momentum_error, size_t size, char *reason);

/* Rotations of the regions of all instances at x (mesh units), an octree's; ties go to the
 * identity. */
void bench_check_turns(const BenchCheck *check, const SmEngineType *type, SmEngine *engine,
                       const double (*x)[3], double (*R)[9]);

/* Runs one step of a plastic octree: the largest difference of a component of S from what eq. 10
 * makes of the state before it. Where a stretch is at the yield to within rounding, either side of
 * it is right. 0 of an elastic body, which is not stepped. */
double bench_check_flow(const BenchCheck *check, BenchRunner *runner);

/* Marks the particles of one body at x (mesh units) whose goals rest on a rotation that is not
 * unique to the precision; O(members). */
void bench_check_tied(const BenchCheck *check, const char *precision, const double (*x)[3],
                      bool *tied);

/* The regions' members, whichever engine's. */
const RefRegions *bench_check_regions(const BenchCheck *check);

/* Positions of one body, from mesh units to cells. */
void bench_check_cells(const BenchCheck *check, const double (*x)[3], double (*cells)[3]);

/* Rounding of the precision: the distance from 1 to the next number. */
double bench_check_epsilon(const char *precision);

/* The tolerance of goal_error: 5e-5 cells in "single", 1e-10 in "double" precision. */
double bench_check_tolerance(const char *precision);

/* What damping may move a particle otherwise in a step where its regions are not resolved, without
 * its being left out: 1e-4 cells in "single", 1e-9 in "double" precision. */
double bench_check_step(const char *precision);

/* Says in `reason` what is not finite or beyond its tolerance and returns false, or true; momentum
 * is the caller's to judge (BENCH_MOMENTUM_TOLERANCE). Invalid is also a state of which more than
 * BENCH_LEFT_OUT of the particles were left out of the check of goals. */
bool bench_check_verdict(const BenchDeviation *found, size_t size, char *reason);

/* Makes the worse of each of two findings `worst`, which is zero but for `finite` to begin with;
 * contacts add up. */
void bench_check_merge(const BenchDeviation *found, BenchDeviation *worst);

/* What was found for people: "goals within 2e-06 cells of brute force, ..." */
void bench_check_text(const BenchDeviation *found, size_t size, char *text);

#define BENCH_TURN_TOLERANCE     5e-4 /* engines keep rotations to 1/16384 */
#define BENCH_MOMENTUM_TOLERANCE 1e-6
#define BENCH_LEFT_OUT           0.25

#endif
