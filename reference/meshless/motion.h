/* motion.h - a meshless body that moves: modal warping, the implicit step, constraints (meshless
 * section 5.3).
 *
 * The state is the modes' amplitudes z and their velocities. A node's displacement is that of the
 * modes, turned by the rotation integrated up to half the modes' curl there. Small motions
 * are exact, and so is a rotation of the whole about one axis, of any size, but a translation
 * beside it is turned, too. Since every node turns along a path of its own, bending shortens: a
 * cantilever in its first mode by 3% when its end turns by 45 degrees and by 12% at 90 degrees. */
#ifndef REF_MOTION_H
#define REF_MOTION_H

#include "body.h"
#include "modes.h"

typedef struct {
    double mass_damping;      /* a, 1/s, of Rayleigh's a + b lambda */
    double stiffness_damping; /* b, s */
} RefDamping;

/* What a constraint binds: where a point is, or how the body is turned there. */
typedef enum { REF_HOLD_POSITION, REF_HOLD_ROTATION } RefHoldKind;

typedef struct {
    RefHoldKind kind;
    double target[3]; /* the point's displacement, or the rotation vector */
    int count;        /* nodes that cover the point */
    int *node;
    double *value; /* [count] phi */
    double *turn;  /* [3][modes] of a rotation: half the modes' curl */
} RefHold;

typedef struct {
    long nodes;
    int modes;
    RefDamping damping;
    double size;    /* the nodes' longest extent */
    double *lambda; /* [modes] */
    double *row;    /* [nodes][6][modes]: the modes' displacement at a node, and half their curl */
    double *z, *speed, *load; /* [modes] amplitudes, velocities, modal force */
    double (*rotation)[3];    /* [nodes] w */
    double (*local)[3];       /* [nodes] Psi z */
    double (*moved)[3];       /* [nodes] displacement */
    double (*force)[3];       /* [nodes] N, the caller's to fill in; kept from step to step */
    int holds;
    RefHold *hold;
} RefMotion;

/* A body at rest. Copies what it needs. */
void ref_motion_create(const RefBody *body, const RefModes *modes, const RefDamping *damping,
                       RefMotion *motion);
void ref_motion_free(RefMotion *motion);

/* Fills `force` with gravity: the nodes' shares of the mass, times g. */
void ref_motion_gravity(const RefBody *body, const double g[3], RefMotion *motion);

/* Binds the body at x (of the rest state), in three directions; returns the constraint's number,
 * whose target may be changed before every step, or -1 where no nodes cover x. The target is where
 * it is. */
int ref_motion_hold(const RefBody *body, RefHoldKind kind, const double x[3], RefMotion *motion);
void ref_motion_release(RefMotion *motion); /* all constraints */

/* From z: rotations, displacements, and the modal force Psi^T R^T F. O(nodes * modes). */
void ref_motion_pose(RefMotion *motion);

/* One step of h: eq. 31, bordered by the constraints (eq. 33) with the stabilisation 2 eta = 1 / h,
 * gamma^2 = 1 / h^2, which is met after one step where C is linear; what warping makes of it is
 * corrected by Newton's method. Constraints that contradict each other, or are more than the modes
 * can meet, are met as well as possible. Poses before it returns. O((nodes + rows^2) modes). */
void ref_motion_step(RefMotion *motion, double h);

/* Kinetic and elastic energy of the modes: (z'^2 + lambda z^2) / 2. */
double ref_motion_energy(const RefMotion *motion);

/* Where constraint `hold` is off its target. */
void ref_motion_off(const RefMotion *motion, int hold, double off[3]);

#endif
