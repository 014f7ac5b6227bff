/* tie.h - which leaves move a vertex of a surface, and by how much (surface.h). */
#ifndef OCT_TIE_H
#define OCT_TIE_H

#include <stdint.h>

#include "surface.h"

/* A vertex on its way to being tied; `leaf` and `weight` have room for all leaves that can move
 * one. */
typedef struct {
    double q[3]; /* its place, or the nearest in the material, half finest cells */
    float reach; /* (surface.h) */
    int own;
    long count, room;
    int *leaf;
    float *weight;
} OctTie;

void oct_tie_free(OctTie *tie);

/* Finds the leaves that move a vertex at X, the one it belongs to first, and their weights. `tie`
 * is zeroed at first, and used for any number of vertices. */
void oct_tie_find(const OctCarrier *carrier, const double X[3], OctTie *tie);

/* The same of a vertex that belongs to leaf tie->own by its tie->reach, where only those leaves are
 * new whose tree nodes are among `node`, its own leaf is there and what is new of the cut does not
 * come between. What was found before is not looked for again. */
void oct_tie_again(const OctCarrier *carrier, const double X[3], long count, const int *node,
                   OctTie *tie);

/* A number that tells one set of edges of a leaf from another. */
uint64_t oct_tie_edges(const OctGraph *graph, int leaf);

/* Room in a surface for the tree's leaves, of which those of the nodes given are new, and for the
 * mesh's vertices; new ones have a place and a normal, but belong to no leaf yet. */
void oct_surface_grow(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier,
                      long count, const int *node);

#endif
