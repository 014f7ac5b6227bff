/* grip.h - handles that hold many points of a meshless body.
 *
 * A grip's points move rigidly: by the displacement of their middle and a rotation, six linear
 * functions of z. Modes that are free everywhere would need hundreds to bend at a grip as a clamp
 * makes them; those of grip_modes.h do with few. The nodes around a grip's points turn with it
 * alone, so that warping, too, moves these points rigidly, however far. */
#ifndef REF_GRIP_H
#define REF_GRIP_H

#include "motion.h"

typedef struct {
    int count;      /* points bound; below 3, or all on a line: each is bound alone */
    double (*x)[3]; /* [count] at rest */
    long *point;    /* [count] their numbers among the handle's */
    double middle[3];
    bool rigid; /* whether they say how they are turned */
    int hold;   /* its first constraint: of the middle's displacement, then the rotation; or of each
                 * point's position */
    int anchor; /* the grip that is the anchor of its piece of the body, of one that is rigid */
} RefGrip;

/* Chooses points of a handle, [count] at rest: those that are farthest from each other, as long as
 * they are `apart` from each other, at most `most`. The caller frees. O(count * most). */
RefGrip ref_grip_choose(long count, const double (*x)[3], double apart, int most);
void ref_grip_free(RefGrip *grip);

/* Binds the motion, which has those modes, by all grips, the first of which at each piece of the
 * body becomes its anchor.
 * Where two grips are closer than covers reach, the points between them are met less well. */
void ref_grip_bind(const RefBody *body, int grips, RefGrip *grip, RefMotion *motion);

/* Sets the constraints' targets: the points of grip number k, displaced by `shift`, move by
 * pose[k] (x, 1), whose left part is a rotation. */
void ref_grip_aim(int grips, const RefGrip *grip, const double shift[3], const double (*pose)[3][4],
                  RefMotion *motion);

#endif
