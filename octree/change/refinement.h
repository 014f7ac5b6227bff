/* refinement.h - cells that are split for a while: where something touches the body, or near a
 * viewer (octree section 5: resampling by interaction or view).
 *
 * A criterion says which cells are to be split. Cells that a refinement has split are merged again
 * when the criterion has not asked for them for a time; cells that others have split (the sampling,
 * a cut) stay. So a cell at the edge of a criterion does not flicker: the criterion knows that it
 * is split already and may be wider for it, and merging waits. */
#ifndef OCT_REFINEMENT_H
#define OCT_REFINEMENT_H

#include "structure.h"

/* Is the cell of this level about `centre` (at rest, mesh units), `half` as wide each way, to be
 * split? `split`: it is already. It may only ask for a cell within another one if it asks for that
 * one. */
typedef bool OctRefineCriterion(const void *what, const double centre[3], double half, int level,
                                bool split);

/* Cells that meet the ball, down to `level`. */
typedef struct {
    double centre[3], radius; /* at rest, mesh units */
    int level;
} OctBallRefinement;

/* Cells nearer to the viewer than `near` down to `level`, to a level less with every doubling of
 * the distance; those that are split already also when they are farther by the share `slack`. */
typedef struct {
    double eye[3]; /* mesh units, from the body's rest position */
    double near, slack;
    int level;
} OctViewRefinement;

OctRefineCriterion oct_ball_criterion; /* of an OctBallRefinement */
OctRefineCriterion oct_view_criterion; /* of an OctViewRefinement */

/* What one criterion has split. All zero at first. */
typedef struct {
    long count, room;
    struct OctRefinedCell {
        int node;
        double wanted; /* when it last was */
    } * cell;          /* [count] parents before what is in them */
} OctRefinement;

/* Would an update now change anything? O(roots + cells asked for + cells split). */
bool oct_refinement_due(OctRefinement *refinement, const OctStructure *structure,
                        OctRefineCriterion *criterion, const void *what, double time, double hold);

/* Splits what the criterion asks for, and merges what it has not asked for during `hold`; in a
 * batch of structure.h. `criterion` NULL: it asks for nothing. Returns how many cells it has split
 * and merged. The same cost. */
long oct_refinement_update(OctRefinement *refinement, OctStructure *structure,
                           OctRefineCriterion *criterion, const void *what, double time,
                           double hold);
void oct_refinement_free(OctRefinement *refinement);

#endif
