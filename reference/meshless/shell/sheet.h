/* sheet.h - a shell that moves: implicit steps (steps.h), warped (warp.h), under gravity, pushes
 * and constraints on position and orientation (meshless sections 5.2 and 5.3.3). */
#ifndef REF_SHEET_H
#define REF_SHEET_H

#include "steps.h"
#include "tension.h"
#include "warp.h"

typedef struct {
    RefShellOptions shell;
    RefDamping damping;
    double h; /* the step */
    double gravity[3];
} RefSheetOptions;

/* Points of the surface that move together. The first one says where, and unless `loose` the
 * surface's tangents there turn with it. */
typedef struct {
    int count; /* 1 or more; of a loose one 1 */
    double (*theta)[3];
    bool loose;
} RefSheetGrip;

/* What holds now. */
typedef struct {
    bool loose;
    int points;
    long row, cell;       /* its first row of the warp's: the points, then two slopes; the cell */
    double (*x)[3];       /* [points] at rest */
    double tangent[2][3]; /* at the first point */
    double pose[3][4];    /* where it is to be, by a turn and a shift of the place at rest */
    double turn[3];       /* the pose's rotation vector */
    int lead;             /* the first hold of the same piece, maybe itself, */
    double *reach;     /* beside which what tangents gain moves another one by so much, [nodes] */
    double (*flux)[2]; /* the first one's, at the warp's places */
} RefSheetHold;

typedef struct {
    RefSheetOptions options;
    RefShell shell;
    RefSteps steps;
    RefWarp warp;
    double (*weight)[3], (*force)[3]; /* [nodes] gravity; and with what pushes add to it */
    double (*impulse)[3];             /* [nodes] the next step's pushes */
    bool pushed, changed;             /* changed: forces have, since tension was found */
    RefTension tension;
    double (*tug)[2][3]; /* [places] of forces but for what holds need */
    int holds;
    RefSheetHold *hold;
    int followers, *follower; /* holds that others lead */
    /* [3][followers][3 nodes] the slopes of the three coordinates of followers' places by the
     * parameters, and what forces along these do. */
    double *slope, *answer;
    int next;            /* the coordinate whose turn it is to be found anew */
    double *need;        /* [3 followers] the forces there, but for what h G v took (tension.h), */
    double *judged;      /* and what they were when tension was found */
    double *gap, *yield; /* what the last step added, by h / (b + h); and [3 followers] square: how
                            far a force at each moves each */
    RefRows rows;        /* of the steps: what leading holds bind, and shapes and turns of others */
    double *aim;         /* [rows] their values */
} RefSheet;

/* At rest and free. `sheet` must not move in memory. The caller frees. Errors: those of shell.h and
 * steps.h. */
SmCode ref_sheet_create(const RefChart *chart, const RefSheetOptions *options, RefSheet *sheet,
                        SmError *error);
void ref_sheet_free(RefSheet *sheet);

/* Other grips than before, where they are; the motion goes on. Two factorisations; three where a
 * piece is held twice. Errors, and what held goes on to: solver.h's; SM_INPUT, a point that the
 * shell's functions do not cover. */
SmCode ref_sheet_hold(RefSheet *sheet, int grips, const RefSheetGrip *grip, SmError *error);

/* Where hold number k is to be after the next step: pose (x, 1), its left part a rotation, of x at
 * rest. */
void ref_sheet_aim(RefSheet *sheet, int k, const double pose[3][4]);

/* One step of h. Forces, and what a piece's holds beyond its first needed until now to be where
 * they are to be, act along the slopes that the surface's places have by the parameters; what holds
 * need more than that along the slopes of up to three steps ago: in turn those of one axis a step
 * are found anew, with a solve for each hold. What is left of the holds after the step is spread
 * over the surface, which meets them to rounding, and is taken up in the next step. */
void ref_sheet_step(RefSheet *sheet);

/* After u and v were changed from outside, and maybe by ref_tension_set() what steps bear: where
 * the surface is then, with all slopes; the next steps find these, and what holds need, as the
 * first steps do. */
void ref_sheet_pose(RefSheet *sheet);

/* After the shell has changed (cracked.h): its new nodes have these displacements, velocities and
 * places, [3 nodes] each, of which the first two are projected by their residuals. Nothing is held
 * then. Four factorisations. ref_sheet_anchor() is to follow. Errors, and nothing of the sheet
 * changed, but maybe `v`: solver.h's. */
SmCode ref_sheet_renew(RefSheet *sheet, double *u, double *v, const double *moved,
                       double *const residual[2], SmError *error);

/* Every piece's displacements are what its nodes move by on average, and the surface is posed; what
 * holds need and steps bear is found anew by the next steps. */
void ref_sheet_anchor(RefSheet *sheet);

/* How far a hold's points are off, and its tangents, these as turns. */
void ref_sheet_off(const RefSheet *sheet, int k, double *place, double *turn);

#endif
