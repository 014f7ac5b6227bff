/* lattice_changes.h - cuts through a lattice's body, for changes.c: what carries the material about
 * a blade, and how engine and surface follow. */
#ifndef BENCH_LATTICE_CHANGES_H
#define BENCH_LATTICE_CHANGES_H

#include "changes.h"

/* Ties the surface to the part's lattice. */
void bench_lattice_tie(BenchChanges *changes);

/* The particles near a blade, which is between two places in this frame (blades.h). Their gradients
 * are the least-squares fit to the neighbours that no cut parts them from. Valid until the next
 * call. O(particles) for a look at each. */
SmCarriers bench_lattice_carriers(BenchChanges *changes, const double blade[4][3]);

/* Cuts the engine's body and the surface by the triangles of changes->cut from number `first` on,
 * of which there are some; fills changes->last. `start` is when the frame's change began. */
SmCode bench_lattice_cut(BenchChanges *changes, long first, double start, SmError *error);

#endif
