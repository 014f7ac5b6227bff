/* condition.h - how well a region's rotation and its angular velocity are determined.
 *
 * Where a crushed or folded region could as well be turned another way, or where a thin one has
 * hardly any inertia about its axis, rounding decides, and two right engines may differ by
 * anything. These numbers say so, in double precision. */
#ifndef REF_CONDITION_H
#define REF_CONDITION_H

#include "brute.h"

typedef struct {
    double hold;      /* how firmly the match holds the rotation: its pull back from a small turn
                       * over that at rest, least of the principal turns; 1 at rest, 0 where the
                       * rotation is not unique. Infinite where no turn moves anything */
    double centre[3]; /* c_r */
    double spread;    /* sum m~ |x - c_r|^2 / M_r */
    double inertia;   /* 1 / sum of the reciprocal principal moments of inertia, over M_r: between a
                       * third of the least of them and that; 0 on a line */
} RefCondition;

/* Of region r; `weight` is what particles count (m~), lengths are those of x0 and x. Turns that at
 * rest move the region by less than `negligible` (root mean square, lengths) do not count.
 * O(members). */
void ref_condition(const RefRegions *regions, const double *weight, const double (*x0)[3],
                   const double (*x)[3], long r, double negligible, RefCondition *condition);

#endif
