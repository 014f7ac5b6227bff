/* body_group.h - bodies of a scene that share one structure and one engine: all that nothing
 * touches, or one that is touched, and so gets a structure of its own. What the scene does to them
 * while it runs: cuts them, and refines them where they are touched or looked at (octree section
 * 5); and the surface that follows. */
#ifndef BENCH_BODY_GROUP_H
#define BENCH_BODY_GROUP_H

#include "../../lib/public/skin.h"
#include "../../octree/change/refinement.h"
#include "runner.h"

/* What has changed since the last frame began, and the seconds that it took. */
typedef struct {
    bool resampled; /* cells were split or merged, or material cut */
    bool split;     /* the surface has other vertices or triangles */
    long nodes;     /* more than before */
    int levels;     /* by which a leaf of an octree was split, at most */
    double resample_seconds, follow_seconds;
} BenchChanged;

typedef struct {
    BenchBody body;     /* mesh, lattice and masses are the caller's body's */
    BenchRunner runner; /* of these instances */
    long *instance;     /* [body.instances] their numbers in the scene, from 0 */
    bool touched;       /* one body, which the scene touches */

    const struct BenchCarrier *carrier; /* its engine's */
    SmSkin skin; /* the surface of one body, with all cuts; points: no triangles, carried by none */
    SmBlade blade[BENCH_MAX];
    OctRefinement touch[BENCH_MAX], view;
    BenchChanged last;
} BenchGroup;

/* What carries a body's surface, and how it is changed: an octree's leaves, or a lattice's
 * particles (carrier.c). */
typedef struct BenchCarrier {
    /* The surface comes apart where the engine has broken the body since it last did; whether it
     * has. NULL: engines break nothing by themselves. */
    bool (*follow)(BenchGroup *group);

    /* All that the scene does between two times; fills group->last. NULL: it does nothing. */
    SmCode (*frame)(BenchGroup *group, double from, double to, SmError *error);

    /* Of each vertex of one body, into [skin.surface.vertex_count]: the leaf's level, 0 of a base
     * cell. NULL: there are none. */
    void (*levels)(const BenchGroup *group, int *level);

    /* What keeps the body from being changed, before anything runs; NULL: nothing. */
    SmCode (*may_change)(SmEngine *engine, SmError *error);
} BenchCarrier;

extern const BenchCarrier bench_octree_carrier, bench_lattice_carrier, bench_drawn_carrier;

/* These `count` instances of the body at rest, as bench_runner_create(); and SM_INPUT where the
 * scene would change what its engine cannot. The group may not move. After an error nothing is to
 * be freed. */
SmCode bench_group_create(const BenchScene *scene, const BenchBody *body, long count,
                          const long *instance, bool touched, const SmEngineType *type, int threads,
                          BenchGroup *group, SmError *error);
void bench_group_free(BenchGroup *group);

/* Can the scene change this group at all? */
bool bench_group_changes(const BenchGroup *group);

/* All that is due between two times, before the steps of that frame, what engines have broken
 * included; fills `last`. */
SmCode bench_group_frame(BenchGroup *group, double from, double to, SmError *error);

/* What the engine has broken alone, after steps; adds to `last`. Whether there was anything. */
bool bench_group_follow(BenchGroup *group);

/* The surfaces of the group's instances, one after the other, now: [instances * vertices][3]. With
 * `back` s the velocities of what carries them are followed so far back (not of given points). */
void bench_group_surface(BenchGroup *group, double back, double (*point)[3]);

/* Of what carries each vertex of one body, into [skin.surface.vertex_count]: the piece of material.
 * Returns how many there are. */
long bench_group_pieces(const BenchGroup *group, int *piece);

/* For carriers: moves the blades, by which the cut grows. */
void bench_group_sweep(BenchGroup *group, double from, double to, SmCut *cut);

#endif
