/* cylinders.h - the plane of a holomorphic one-form whose horizontal leaves are closed: cylinders
 * that are joined along intervals of their sides (Strebel 1984; Zorich 2006, sections 4.1 and 5.3).
 *
 * Leaves through the form's zeros cut a closed surface of genus g into 3 g - 3 cylinders at most.
 * In the plane of the form's integral each is a rectangle whose left and right sides are one line.
 * A side is a rim of the surface, or its intervals go on elsewhere: an interval of its upper side
 * between zeros goes on, moved by a constant, as one of some cylinder's lower side. Around a zero
 * the plane has two whole turns, so that what is beyond it differs by the side on which a straight
 * line passes. */
#ifndef REF_CYLINDERS_H
#define REF_CYLINDERS_H

#include <stdbool.h>

typedef struct {
    double low[2], high[2];
} RefCylinder;

/* An interval of a side. Both its ends are zeros of the form. */
typedef struct {
    int from, to;      /* cylinders; `to` -1: a rim, on which both zeros are */
    bool up;           /* of the upper side of `from`, the lower one of `to`; or the other way */
    double begin, end; /* begin in low[0]..high[0]; an end beyond goes on at the left */
    double shift[2];   /* what is to be added to a place beyond to have it in `to`, or so many
                          widths beside */
} RefJoint;

typedef struct {
    int count, joints;
    RefCylinder *cylinder; /* [count] from left to right in the plane, apart from one another */
    RefJoint *joint;       /* [joints] every interval from both sides */
} RefCylinders;

void ref_cylinders_free(RefCylinders *cylinders);

/* The cylinder of a place of its rectangle, or near that. */
int ref_cylinders_at(const RefCylinders *cylinders, const double theta[2]);

/* Whether a box, whose middle is in a rectangle, has a zero on that's sides. O(joints). */
bool ref_cylinders_zero(const RefCylinders *cylinders, const double low[2], const double high[2]);

/* Goes straight from a place of a rectangle: theta becomes the place where that ends, in its
 * rectangle. A way that meets a zero passes it on one side. False, and theta there, where it meets
 * a rim. O(joints passed). */
bool ref_cylinders_walk(const RefCylinders *cylinders, double theta[2], const double way[2]);

/* The same up to the next joint, which is true: theta becomes the place behind that. False where
 * none is met. `way` becomes what is left: nothing, but of one that meets a rim. `moved` receives
 * by how much the plane behind is off, theta less where the way itself leads to. */
bool ref_cylinders_hop(const RefCylinders *cylinders, double theta[2], double way[2],
                       double moved[2]);

/* Whether a way ends at `to`, a place of the cylinder `in`, or some widths beside it. */
bool ref_cylinders_lead(const RefCylinders *cylinders, const double theta[2], const double way[2],
                        int in, const double to[2]);

/* Where straight lines from a place of a rectangle, and from places beside it in that, lead to in a
 * box around it: shifts by which the place gets into the planes of cylinders there, the first one
 * zero. Those whose second part is zero are of the place's own cylinder, some widths beside. Behind
 * zeros there may be some that no line leads to. */
typedef struct {
    int count, room, *to;
    double (*shift)[2];
    bool zero; /* there may be one in the box, enlarged by so much to all sides */
} RefCylinderImages;

/* `low` and `high` say how far the box reaches from the place, low being negative; images of an
 * earlier call are overwritten, and freed by the caller. O(joints * images). */
void ref_cylinders_images(const RefCylinders *cylinders, const double theta[2], const double low[2],
                          const double high[2], double enlarged, RefCylinderImages *images);
void ref_cylinder_images_free(RefCylinderImages *images);

/* What of a cover gets from a node, whose image `from` is in the plane of x's cylinder, straight to
 * x: false where the line from x to the image does not lead to the node itself, whose place is
 * `node`. Otherwise value, slopes and second derivatives by x of the product over zeros that are
 * nearer than b to the line of 1 - c(distance / b), c the weights' spline and b a quarter of the
 * node's reach: weights fall to 0 towards the line behind a zero, on both of its sides, so that
 * functions are as smooth there as elsewhere. At a zero itself they are not: derivatives grow as
 * the distance falls. Of more than 16 zeros the first 16 count. */
bool ref_cylinders_pass(const RefCylinders *cylinders, const double x[2], const double from[2],
                        const double node[2], double reach, double part[6]);

#endif
