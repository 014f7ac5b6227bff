/* engine_base.h - how an octree engine begins, in either precision, and what it offers beyond
 * lib/engine/engine.h: its structure, and resampling while it runs. */
#ifndef OCT_ENGINE_BASE_H
#define OCT_ENGINE_BASE_H

#include "../../lib/engine/engine.h"
#include "structure.h"

/* What an octree engine's bodies share (structure.h); it lives as long as the engine. */
const OctStructure *oct_engine_structure(const SmEngine *engine);

/* Resampling while it runs: oct_engine_begin(), then any number of oct_resample_split(), _merge()
 * and _near_cut() of structure.h and of triangles added to the structure's cut, then
 * oct_engine_end() in the place of oct_resample_update(): it brings everything up to date at the
 * cost of what has changed, and says what has. The first begin costs O(body), once.
 *
 * New nodes start where the body has carried their cells, with the velocity that it has there
 * (state_transfer.h). Where nothing is held, its linear momentum and its centre of mass stay; all
 * other nodes stay where they are but for one small translation of the whole body. They inherit
 * rotations and plastic shapes; children of a held node are held, and a node merged of any that
 * was.
 *
 * Particles are then renumbered: particle p is the p-th of the leaves that there are, in rising
 * order of their numbers, oct_engine_leaves()[p]; SM_REST, masses and region() follow. Handles that
 * are set again after a change must be given by the new numbers.
 *
 * Where nodes weigh as much as their cells' volume, a body's mass changes with its sampling, and
 * momentum and centre of mass are left to what new nodes start with.
 *
 * A body that changes counts all of its coordinates from one origin, no longer from one for every
 * group or 64 cells of it (frames.h). In single precision goals are so right up to 512 finest cells
 * across; groups that a cut leaves to drift further apart than that lose digits, and the check of
 * goals says so.
 *
 * Errors: several bodies share the engine; goal positions are summed by OCT_ADJOINT; regions are
 * not symmetric by union (SM_USAGE); in single precision a body more than 512 finest cells wide at
 * rest (SM_INPUT). */
SmCode oct_engine_begin(SmEngine *engine, OctStructure **structure, SmError *error);

/* The same errors, before anything runs. O(leaves). */
SmCode oct_engine_may_change(SmEngine *engine, SmError *error);
const OctChange *oct_engine_end(SmEngine *engine);

/* Leaf number of every particle of one body, rising. Valid until the next change. */
const int *oct_engine_leaves(SmEngine *engine);

/* The first member of every octree engine. */
typedef struct {
    OctStructure structure;
    SmCode (*may)(SmEngine *engine, SmError *error);
    SmCode (*begin)(SmEngine *engine, SmError *error);
    const OctChange *(*end)(SmEngine *engine);
    const int *(*leaves)(SmEngine *engine);
} OctEngineBase;

#endif
