/* crack.h - cracks of a shell: curves in the plane of its parameters, which cut the covers that
 * they cross (meshless section 4.2).
 *
 * A crack is made of arms. An arm begins somewhere, alone, beside an arm that goes the other way,
 * or on another arm, from which it branches; its other end is a tip, which may go on, until the arm
 * meets a rim or another crack or is ended. Of a node's weight nothing gets across an arm but near
 * its tip: c(s / b), where s is the length of the arm from the crossing to the tip, c the weights'
 * spline and b a quarter of the node's reach (Organ, Fleming, Terry and Belytschko 1996, in the
 * plane as Pauly et al. 2005 have it; square covers have two arguments, so that the weight is
 * multiplied instead of its argument enlarged). An arm that goes beyond a seam goes on behind it,
 * and so does one that comes to a joint of cylinders: a piece of it lies in one of them, and its
 * images are where straight ways from others lead to it (chart.h). */
#ifndef REF_CRACK_H
#define REF_CRACK_H

#include "chart.h"

/* A straight piece of an arm, or an image of one. */
typedef struct {
    RefChartImage at;  /* its second end is nearer to the tip */
    double ahead;      /* length of the arm from there to the tip; infinite where there is no tip */
    int arm, previous; /* the piece of the arm that was made before this one, or -1 */
} RefCrackPiece;

typedef struct {
    double tip[2]; /* in the rectangle, but at a rim */
    double way[2]; /* the last piece's direction, of unit length; zero: no piece yet */
    double length;
    int last;   /* its newest piece, or -1 */
    int parent; /* the arm from which it branched, or -1 */
    bool open;  /* has a tip */
} RefCrackArm;

/* Pieces, rising, and their boxes' lower and upper ends. */
typedef struct {
    long count, room;
    int *piece;
    double (*box)[2][2];
} RefCracksNear;

typedef struct {
    const RefChart *chart; /* the caller's */
    double margin;         /* the largest reach of a cover */
    long pieces, piece_room, arms, arm_room;
    RefCrackPiece *piece;   /* [pieces] */
    RefCrackArm *arm;       /* [arms] */
    double low[2], high[2]; /* private, as is the rest: a box, and */
    RefCracksNear near;     /* all pieces whose boxes touch it */
    RefChartImages images;
} RefCracks;

/* Places at[0][i], at[1][j] of one rectangle. */
typedef struct {
    int count[2]; /* REF_GRID_SIDE at most */
    const double *at[2];
} RefGrid;

enum { REF_GRID_SIDE = 6 };

/* No cracks. No cover's reach is above `margin`. The caller frees. */
void ref_cracks_create(const RefChart *chart, double margin, RefCracks *cracks);
/* The caller frees. O(pieces). */
RefCracks ref_cracks_copy(const RefCracks *cracks);
void ref_cracks_free(RefCracks *cracks);

/* A new arm without a piece, from a place of the rectangle; returns its number. `parent` is an arm
 * that passes there, or -1. */
int ref_cracks_start(RefCracks *cracks, const double at[2], int parent);

/* Adds a piece, or one for every cylinder, from an arm's tip straight to `to`, which may be beyond
 * a seam or joints. Where it meets another crack or a rim, it stops, and the arm is ended. Zeros
 * are passed on one side. O(pieces). */
void ref_cracks_grow(RefCracks *cracks, int arm, const double to[2]);

/* Whether an arm would meet another crack or a rim if it went on straight for `far`. */
bool ref_cracks_end_ahead(const RefCracks *cracks, int arm, double far);

/* Ends an arm: nothing gets across any more near where its tip was. */
void ref_cracks_end(RefCracks *cracks, int arm);

/* What gets from `from` to x of a weight of this reach: RefCut's pass() for nodes.h. Not for
 * several threads at a time. O(pieces near; in another box than before, all pieces). */
bool ref_cracks_pass(const void *cracks, const double x[3], const double from[3], double reach,
                     double part[6]);

/* Whether a crack is between two places, the first in a rectangle and the second in its plane. */
bool ref_cracks_part(const RefCracks *cracks, const double x[2], const double from[2]);

/* Looks up the pieces whose boxes touch a box, which saves the next questions about ways in it from
 * doing so; whether there are any. */
bool ref_cracks_look(const RefCracks *cracks, const double low[2], const double high[2]);

/* What gets from `from` to the places of a grid, as ref_cracks_pass() has it, with zeros where
 * nothing does: part[grid->count[0] j + i]. False, and nothing written, where no crack is in the
 * way. */
bool ref_cracks_fan(const RefCracks *cracks, const RefGrid *grid, const double from[2],
                    double reach, double (*part)[6]);

/* How far the nearest piece is, at most `far`. */
double ref_cracks_distance(const RefCracks *cracks, const double x[2], double far);

#endif
