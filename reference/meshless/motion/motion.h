/* motion.h - a meshless body that moves: modal warping, the implicit step, constraints (meshless
 * section 5.3).
 *
 * The state is the modes' amplitudes z and their velocities. The body as a whole, or each piece of
 * one that cracks have parted (body.h), is displaced by `drift` z, the displacement of its anchor:
 * its centre of mass, or a grip (grip.h). What a node moves beside that is turned by the rotation
 * integrated up to half the modes' curl there. Small motions are exact, and so is a rotation of the
 * whole about one axis, of any size, with any translation; a free piece's centre of mass moves as
 * its drift does, whatever its shape.
 *
 * Every node turns along a path of its own, straight in z, and so bending shortens: what eq. 28
 * says of an arc of constant curvature k is x(s) = s cos(k s / 2) (cos(k s / 2), sin(k s / 2)),
 * whose length is 4.8% less than s where it has turned by 45 degrees, and 16% where by 90. A
 * cantilever in its first mode, which bends at its root most, loses 3% and 12%. To have the arc,
 * displacements would have to be integrated along the body from strains and rotations: a solve with
 * a stiffness for all nodes every frame (Huang, Tong, Zhou, Bao and Desbrun 2011), more than a
 * frame of 64 modes takes here altogether. */
#ifndef REF_MOTION_H
#define REF_MOTION_H

#include "../body/body.h"
#include "../solve/modes.h"

typedef struct {
    double mass_damping;      /* a, 1/s, of Rayleigh's a + b lambda */
    double stiffness_damping; /* b, s */
} RefDamping;

/* What a constraint binds: where a point is, how the body is turned there, or any three linear
 * functions of z. */
typedef enum { REF_HOLD_POSITION, REF_HOLD_ROTATION, REF_HOLD_ROWS } RefHoldKind;

typedef struct {
    RefHoldKind kind;
    int piece;        /* of the body */
    double target[3]; /* the point's displacement, the rotation vector, or the functions' values */
    int count;        /* nodes that cover the point; 0 of rows */
    int *node;
    double *value; /* [count] phi */
    double *row;   /* [3][modes] the functions; of a rotation half the modes' curl */
} RefHold;

typedef struct {
    long nodes;
    int modes;
    RefDamping damping;
    double size;    /* the nodes' longest extent */
    double *lambda; /* [modes] */
    double *row;    /* [nodes][6][modes]: the modes' displacement at a node, and half their curl */
    int pieces;
    int *piece;               /* [nodes] */
    bool *held;               /* [pieces] a constraint binds it */
    double *anchor;           /* [nodes] weights of sum 1 a piece: what is displaced by the drift */
    double *drift;            /* [pieces][3][modes] */
    double *z, *speed, *load; /* [modes] amplitudes, velocities, modal force */
    double (*rotation)[3];    /* [nodes] w */
    double (*local)[3];       /* [nodes] Psi z */
    double (*moved)[3];       /* [nodes] displacement */
    double (*force)[3];       /* [nodes] N, the caller's to fill in; kept from step to step */
    double (*sums)[3];        /* [4 pieces] of a pose */
    int holds;
    RefHold *hold;
} RefMotion;

/* A body at rest, each piece anchored at its centre of mass where its translations are among the
 * modes, and nowhere where they are not: then its drift is 0. Copies what it needs. */
void ref_motion_create(const RefBody *body, const RefModes *modes, const RefDamping *damping,
                       RefMotion *motion);
void ref_motion_free(RefMotion *motion);

/* Fills `force` with gravity: the nodes' shares of the mass, times g. */
void ref_motion_gravity(const RefBody *body, const double g[3], RefMotion *motion);

/* Binds the body at x (of the rest state), in three directions; returns the constraint's number,
 * whose target may be changed before every step, or -1 where no nodes cover x. The target is where
 * it is. */
int ref_motion_hold(const RefBody *body, RefHoldKind kind, const double x[3], RefMotion *motion);

/* Binds three linear functions of z, [3][modes], of a piece, where they are; returns the
 * constraint's number. */
int ref_motion_hold_rows(const double *rows, int piece, RefMotion *motion);

/* Anchors a piece at other weights, [nodes], of sum 1 over its nodes. */
void ref_motion_anchor(const double *weight, int piece, RefMotion *motion);

/* From z: rotations, displacements, and the modal force Psi^T R^T F. O(nodes * modes). */
void ref_motion_pose(RefMotion *motion);

/* Adds what impulses at the nodes, [nodes][3], do to the speeds, in the body's present pose. */
void ref_motion_push(const double (*impulse)[3], RefMotion *motion);

/* Takes over where another motion of the same body is and how fast it goes, as well as these modes
 * can, by the body's mass: displacements that were turned by rotations are turned back by the same.
 * O(nodes * modes).
 */
void ref_motion_take(const RefBody *body, RefMotion *from, double h, RefMotion *motion);

/* One step of h: eq. 31, bordered by the constraints (eq. 33) with the stabilisation 2 eta = 1 / h,
 * gamma^2 = 1 / h^2, which is met after one step where C is linear; what warping makes of it is
 * corrected by Newton's method. Constraints that contradict each other, or are more than the modes
 * can meet, are met as well as possible. Poses before it returns. O((nodes + rows^2) modes). */
void ref_motion_step(RefMotion *motion, double h);

/* Takes amplitudes and speeds back by one share where a node is turned by more than `most`, so that
 * none is; poses then. Hands that pull a body to many times its size turn it so, and the rotations
 * of warping mean nothing there: a turn of w moves its surroundings by w times their distance, and
 * amplitudes would grow each time that another hand takes hold. What is not finite is put to rest.
 */
void ref_motion_confine(RefMotion *motion, double most);

/* Kinetic and elastic energy of the modes: (z'^2 + lambda z^2) / 2. */
double ref_motion_energy(const RefMotion *motion);

/* Where constraint `hold` is off its target. */
void ref_motion_off(const RefMotion *motion, int hold, double off[3]);

#endif
