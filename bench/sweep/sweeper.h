/* sweeper.h - measures the points of a sweep: the scene and body that they share, and for each
 * point its cost (measure.h), its stiffness (swing.h) and its gaps (gap.h). */
#ifndef BENCH_SWEEPER_H
#define BENCH_SWEEPER_H

#include "../scene/body.h"
#include "../system/progress.h"
#include "gap.h"
#include "plan.h"

typedef struct {
    BenchScene scene; /* without what is not swept */
    BenchBody body;
    BenchPush push;
    BenchPath full;     /* of the last full resolution */
    int full_w;         /* its half-width, 0: none yet */
    char left_out[160]; /* of the scene: "cuts, touches"; or empty */
} BenchSweeper;

/* Loads the scene that the plan's `file` names, or, where that is empty, the one of the mesh alone
 * (bench_scene_drop()), and its body. Then fills in of `plan` what is found: hashes, size, cell,
 * steps, and the scene's name.
 *
 * One body is swept, elastic and whole: what cuts, breaks, touches or looks at it, plasticity,
 * further instances and widths of places are left out, and `left_out` names them. */
SmCode bench_sweeper_create(BenchPlan *plan, BenchSweeper *sweeper, SmError *error);
void bench_sweeper_free(BenchSweeper *sweeper);

/* Measures a point. What cannot be had is said in the point. */
void bench_sweeper_measure(BenchSweeper *sweeper, const BenchPlan *plan, int index,
                           BenchProgress *progress, BenchPoint *point);

#endif
