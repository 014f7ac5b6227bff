/* changes.h - what a scene does to one part's body while it runs: cuts it, and refines it where it
 * is touched or looked at (octree section 5); and the surface that follows. */
#ifndef BENCH_CHANGES_H
#define BENCH_CHANGES_H

#include "../../lib/public/skin.h"
#include "../../octree/change/refinement.h"
#include "cast.h"

/* What the last frame has changed, and the seconds that it took. */
typedef struct {
    bool resampled; /* cells were split or merged, or material cut */
    bool slit;      /* the surface has other vertices or triangles */
    long nodes;     /* more than before */
    double resample_seconds, follow_seconds;
} BenchChanged;

typedef struct BenchCarrier BenchCarrier;

typedef struct {
    BenchPart *part;             /* the caller's, kept */
    const BenchCarrier *carrier; /* its engine's */
    SmSkin skin; /* the surface of one body, with all cuts; points: no triangles, carried by none */
    SmBlade blade[BENCH_MAX];
    OctRefinement touch[BENCH_MAX], view;
    BenchChanged last;
} BenchChanges;

/* What carries a body's surface, and how it is changed: an octree's leaves (octree_changes.c), a
 * lattice's particles (lattice_changes.c). */
struct BenchCarrier {
    /* All that is due between two times; fills changes->last. */
    SmCode (*frame)(BenchChanges *changes, double from, double to, SmError *error);

    /* Of each vertex of one body, into [skin.surface.vertex_count]: the leaf's level, 0 of a base
     * cell. NULL: there are none. */
    void (*levels)(const BenchChanges *changes, int *level);

    /* What keeps the body from being changed, before anything runs; NULL: nothing. */
    SmCode (*may_change)(SmEngine *engine, SmError *error);
};

extern const BenchCarrier bench_octree_carrier, bench_lattice_carrier;

/* Ties the part's surface. The part's handles and forces follow its changes. */
void bench_changes_create(BenchPart *part, BenchChanges *changes);
void bench_changes_free(BenchChanges *changes);

/* Can the scene change this part at all? */
bool bench_changes_any(const BenchPart *part);

/* If it can, does the engine let it? To be asked before anything runs. */
SmCode bench_changes_check(const BenchPart *part, SmError *error);

/* All that is due between two times, before the steps of that frame; fills `last`. */
SmCode bench_changes_frame(BenchChanges *changes, double from, double to, SmError *error);

/* The surfaces of the part's instances, one after the other, now: [instances * vertices][3]. With
 * `back` s the velocities of what carries them are followed so far back (not of given points). */
void bench_changes_surface(BenchChanges *changes, double back, double (*point)[3]);

/* Of what carries each vertex of one body, into [skin.surface.vertex_count]: the piece of material.
 * Returns how many there are. */
long bench_changes_pieces(const BenchChanges *changes, int *piece);

/* For carriers: moves the blades, by which the cut grows. */
void bench_changes_sweep(BenchChanges *changes, double from, double to, SmCut *cut);

#endif
