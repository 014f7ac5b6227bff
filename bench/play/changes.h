/* changes.h - what a scene does to one part's body while it runs: cuts it, and refines it where it
 * is touched or looked at (octree section 5); and the surface that follows. */
#ifndef BENCH_CHANGES_H
#define BENCH_CHANGES_H

#include "../../lib/cut/blade.h"
#include "../../lib/cut/slit.h"
#include "../../lib/mesh/embed.h"
#include "../../octree/change/refinement.h"
#include "../../octree/surface/surface.h"
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
    SmMesh surface;              /* of one body at rest, with all slits; points: no triangles */
    OctSurface carried;          /* what carries it: an octree's nodes, */
    SmEmbedding embedding;       /* or a lattice's particles */
    SmBlade blade[BENCH_MAX];
    OctRefinement touch[BENCH_MAX], view;
    SmCut cut;     /* of a lattice; an octree's structure has it */
    SmSites sites; /* of a lattice that is cut */
    bool left;     /* a cut did not split the surface: it could not be done cleanly */
    BenchChanged last;
    /* scratch: nodes as the engine counts them; by leaf or
     * particle number */
    double (*node)[3];
    double (*rest)[3], (*x)[3], (*F)[9];
    unsigned char *found, *absent;
    long room;
    OctReach search;
} BenchChanges;

/* What carries a body's surface, and how it is changed: an octree's leaves (octree_changes.c), a
 * lattice's particles (lattice_changes.c). */
struct BenchCarrier {
    void (*tie)(BenchChanges *changes); /* the surface, at rest */

    /* What carries the material near a blade, which is between two places in this frame (blades.h);
     * until the body changes. */
    SmCarriers (*near)(BenchChanges *changes, const double blade[4][3]);

    /* All that is due between two times; fills changes->last. */
    SmCode (*frame)(BenchChanges *changes, double from, double to, SmError *error);

    /* Where an instance's surface is, of what bench_changes_nodes() has found. */
    void (*move)(BenchChanges *changes, long instance, double (*point)[3]);

    /* The leaf or particle that a vertex belongs to; and the pieces that these are in, which are
     * left alone where they hang together. */
    int (*at)(const BenchChanges *changes, long vertex);
    void (*pieces)(const BenchRunner *runner, SmPieces *pieces);

    /* Of each vertex of one body, into [surface.vertex_count]: the leaf's level, 0 of a base cell.
     * NULL: there are none. */
    void (*levels)(const BenchChanges *changes, int *level);

    /* What keeps the body from being changed, before anything runs; NULL: nothing. */
    SmCode (*may_change)(SmEngine *engine, SmError *error);
};

extern const BenchCarrier bench_octree_carrier, bench_lattice_carrier;

/* Ties the part's surface. The part's handles and forces follow its changes. */
void bench_changes_create(BenchPart *part, BenchChanges *changes);
void bench_changes_free(BenchChanges *changes);

/* Scratch for so many nodes. */
void bench_changes_room(BenchChanges *changes, long nodes);

/* Can the scene change this part at all? */
bool bench_changes_any(const BenchPart *part);

/* If it can, does the engine let it? To be asked before anything runs. */
SmCode bench_changes_check(const BenchPart *part, SmError *error);

/* All that is due between two times, before the steps of that frame; fills `last`. */
SmCode bench_changes_frame(BenchChanges *changes, double from, double to, SmError *error);

/* The surfaces of the part's instances, one after the other, now: [instances * vertices][3]. With
 * `back` s the velocities of what carries them are followed so far back (not of given points). */
void bench_changes_surface(BenchChanges *changes, double back, double (*point)[3]);

/* Of what carries each vertex of one body, into [surface.vertex_count]: the piece of material.
 * Returns how many there are. */
long bench_changes_pieces(const BenchChanges *changes, int *piece);

/* For carriers: into changes->node the places of the nodes of all instances, or where their
 * velocities had them `back` s ago; and the blades moved, by which the cut grows. */
void bench_changes_nodes(BenchChanges *changes, double back);
void bench_changes_sweep(BenchChanges *changes, double from, double to, SmCut *cut);

#endif
