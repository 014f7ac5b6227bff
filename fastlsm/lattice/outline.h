/* outline.h - a lattice as collisions see it (lib/collide/rest.h): nodes are particles,
 * cells hang on their eight corners, the rest graph is the links. */
#ifndef LSM_OUTLINE_H
#define LSM_OUTLINE_H

#include "../../lib/collide/rest.h"
#include "lattice.h"

typedef struct {
    SmCollideRest rest;
    int *carrier, (*across)[6], *to, *length;
    double (*x0)[3], (*centre)[3], *edge;
    long *first;
} LsmOutline;

/* A cell whose corners are no longer linked along all its edges and through its middle is none;
 * what was behind it is then outer. Particles are numbered as in the lattice; x0 is their
 * coordinates there. `mass` [particles] or NULL is not copied. O(particles); the caller frees. */
void lsm_outline_build(const LsmLattice *lattice, const double *mass, LsmOutline *outline);
void lsm_outline_free(LsmOutline *outline);

#endif
