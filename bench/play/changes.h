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

typedef struct {
    BenchPart *part;       /* the caller's, kept */
    SmMesh surface;        /* of one body at rest, with all slits; points: no triangles */
    OctSurface carried;    /* what carries it: an octree's nodes, */
    SmEmbedding embedding; /* or a lattice's particles */
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

/* Ties the part's surface. The part's handles and forces follow its changes. */
void bench_changes_create(BenchPart *part, BenchChanges *changes);
void bench_changes_free(BenchChanges *changes);

/* Scratch for so many nodes. */
void bench_changes_room(BenchChanges *changes, long nodes);

/* Can the scene change this part at all? */
bool bench_changes_any(const BenchPart *part);

/* All that is due between two times, before the steps of that frame; fills `last`. */
SmCode bench_changes_frame(BenchChanges *changes, double from, double to, SmError *error);

/* The surfaces of the part's instances, one after the other, now: [instances * vertices][3]. With
 * `back` s the velocities of what carries them are followed so far back (not of given points). */
void bench_changes_surface(BenchChanges *changes, double back, double (*point)[3]);

bool bench_changes_is_octree(const BenchChanges *changes);

/* Of what carries each vertex of one body: the piece of material, and of an octree the leaf's
 * level, 0 of a base cell; into [surface.vertex_count]. Returns how many pieces there are. */
long bench_changes_pieces(const BenchChanges *changes, int *piece);
void bench_changes_levels(const BenchChanges *changes, int *level);

#endif
