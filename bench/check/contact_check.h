/* contact_check.h - are the contacts of an engine's present state right? Held to brute force in
 * double precision (reference/brute_collide.h). */
#ifndef BENCH_CONTACT_CHECK_H
#define BENCH_CONTACT_CHECK_H

#include "check.h"

#define BENCH_CONTACT_PAIRS     3e7
#define BENCH_CONTACT_TOLERANCE 1e-6 /* cells; engines find contacts in double precision */

/* Adds the check of contacts, of bodies with each other and with themselves, to `found`, if the
 * scene has any; calls engine->goals(). Cells are described anew, of an octree from the engine's
 * structure; its cells' turns are held to regions' rotations where these are unique. Every contact
 * of a node with a cell that either has must be the other's too, and alike in depth, direction and
 * weights, unless it is so for a node within the tolerance of this one; what lib/collide/collide.h
 * says may be missed may be. Of bodies of more than BENCH_CONTACT_PAIRS pairs of a node and a cell
 * as many nodes are compared as make that: half of those from nodes that the engine has contacts
 * of, the others spread over the surface. */
void bench_check_contacts(const BenchCheck *check, const BenchScene *scene,
                          const SmEngineType *type, SmEngine *engine, BenchDeviation *found);

#endif
