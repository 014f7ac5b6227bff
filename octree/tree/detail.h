/* detail.h - cells that are split for a while: where something touches the body, or near an eye
 * (octree section 5: resampling by interaction or view).
 *
 * A wish says which cells are to be split. What a detail has split for it, it merges again when the
 * wish has been gone for a time; cells that others have split (the sampling, a cut) stay. So a cell
 * at the edge of a wish does not flicker: it is asked about as one that is split already, for which
 * the wish may be wider, and it waits. */
#ifndef OCT_DETAIL_H
#define OCT_DETAIL_H

#include "../change/structure.h"

/* Is the cell of this level about `centre` (at rest, mesh units), `half` as wide each way, to be
 * split? `split`: it is already. A cell within another one may only be wished for if that one is.
 */
typedef bool OctWish(const void *what, const double centre[3], double half, int level, bool split);

/* Cells that meet the ball, down to `level`. */
typedef struct {
    double centre[3], radius; /* at rest, mesh units */
    int level;
} OctTouch;

/* Cells nearer to the eye than `near` down to `level`, to a level less with every doubling of the
 * distance; those that are split already also when they are farther by the share `slack`. */
typedef struct {
    double eye[3]; /* mesh units, from the body's rest position */
    double near, slack;
    int level;
} OctEye;

OctWish oct_touch_wish; /* of an OctTouch */
OctWish oct_eye_wish;   /* of an OctEye */

/* What one wish has split. All zero at first. */
typedef struct {
    long count, room;
    struct OctDetailCell {
        int node;
        double wished; /* when it last was */
    } * cell;          /* [count] parents before what is in them */
} OctDetail;

/* Would an update now change anything? O(roots + cells wished for + cells split). */
bool oct_detail_due(OctDetail *detail, const OctStructure *structure, OctWish *wish,
                    const void *what, double time, double hold);

/* Splits what is wished for, and merges what has not been for `hold`; in a batch of resample.h.
 * `wish` NULL: nothing is. Returns how many cells it has split and merged. The same cost. */
long oct_detail_update(OctDetail *detail, OctStructure *structure, OctWish *wish, const void *what,
                       double time, double hold);
void oct_detail_free(OctDetail *detail);

#endif
