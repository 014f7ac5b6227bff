/* tools.h - what hands do to a body beside pulling it: a blade, a finger and the wind.
 *
 * Blade and finger are a cut and a touch of the side's own scene beside those that its text has,
 * out of use until a hand brings them in, so that what they do is what the scene's own do. */
#ifndef BENCH_TOOLS_H
#define BENCH_TOOLS_H

#include "../play/playback.h"

/* What bodies must be made for before it can be done to them. */
typedef struct {
    bool cut;
    bool touched[BENCH_MAX]; /* bodies, by their number */
} ViewAllowed;

typedef struct {
    int blade;                           /* its number among the scene's cuts, or -1 */
    int first_finger, fingers, touching; /* among its touches: of each body allowed; -1: none */
    double wind[3];                      /* m/s^2 */
} ViewTools;

/* Adds to a scene what is allowed, as far as it can be done to its bodies: cuts of one alone, and
 * touches where `refines` says that the engine does. */
void view_tools_add(BenchScene *scene, const ViewAllowed *allowed, bool refines, ViewTools *tools);

/* Moves the blade to the segment from a to b at once, and cuts what it crosses on the way; the
 * first time it is only set down. O(particles), and what is cut. */
void view_tools_cut(ViewTools *tools, BenchScene *scene, BenchPlayback *play, const double a[3],
                    const double b[3]);
void view_tools_lift(ViewTools *tools, BenchPlayback *play);

bool view_tools_may_touch(const ViewTools *tools, const BenchScene *scene, long instance);

/* Touches a body that may be in a ball, at rest, from its next frame on: cells there are as fine as
 * the octree's finest. Others are left. */
void view_tools_touch(ViewTools *tools, BenchScene *scene, long instance, const double centre[3],
                      double radius);
void view_tools_leave(ViewTools *tools, BenchScene *scene);

/* What the wind adds to velocities in the next step. O(particles), nothing without wind. */
void view_tools_blow(const ViewTools *tools, BenchPlayback *play);

#endif
