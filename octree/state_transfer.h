/* state_transfer.h - what new leaves of a running body take over from those they replace (octree
 * section 5).
 *
 * A leaf that splits hands its motion to its children as its region moves: F = dx/dX and L = dv/dX
 * are the affine motion of the leaves of its region (fit.h), and a child starts in
 * x + F (X_c - X), with v + L (X_c - X). Merged leaves do the reverse: each says where their motion
 * takes the middle of the new cell, and the mean of that, by mass, is where the new leaf starts;
 * their motion is that of them alone if they span space, or else of the first one's region. So a
 * body that moves rigidly goes on moving rigidly, and a split and a merge give back what was: of a
 * cell that is full whatever its motion, of others where it is rigid.
 *
 * Cells that are not full have their mass beside their middle, which makes the sampled centre of
 * mass another one and with it, where the body turns, the momentum. What is missing is given to the
 * whole body as one translation and one velocity: its linear momentum and its centre of mass stay,
 * to the rounding of double precision. Its angular momentum becomes that of the new sampling
 * turning as fast: the eighths of a full cell of edge s have s^2 / 8 of their mass about its
 * middle, where one node had none, and the inertia of cells that are not full comes nearer to the
 * material's. */
#ifndef OCT_STATE_TRANSFER_H
#define OCT_STATE_TRANSFER_H

#include "state.h"
#include "tree/tree_change.h"

#define oct_transfer_keep  SM_NAME(oct_transfer_keep)
#define oct_transfer_start SM_NAME(oct_transfer_start)
#define oct_transfer_free  SM_NAME(oct_transfer_free)

/* One removed leaf; lengths in finest cells, those at rest from the tree's first node. */
typedef struct {
    int leaf, node, into; /* as in OctRemoved */
    int fitted; /* which donor has F and L: itself, or the first that goes into the same leaf */
    int next;   /* donor that goes into the same leaf, or -1 */
    double mass, X[3], x[3], v[3];
    double F[9], L[9], S[9];
    short last[6]; /* its region's last rotation (rotate_lanes.h) */
} OctDonor;

/* Begins zeroed. */
typedef struct {
    OctDonor *donor; /* [count] */
    long count, room;
    int *of;     /* [leaves] of a removed leaf, or of a new leaf that was merged: the first donor */
    long leaves; /* that there is place for */
} OctTransfer;

/* Keeps what the removed leaves hand on; `tree` has changed, the body must still be as it was.
 * `slot` says which leaf a tree node of it is, or -1, and `below` the masses of tree nodes.
 * O(leaves of their regions). */
void oct_transfer_keep(const Oct *oct, const OctTree *tree, const OctChange *change,
                       const int *slot, const double *below, OctTransfer *transfer);

/* Starts the new leaves, whose slots are filled; `below` are the masses now and `mass` is the
 * body's. Where `free` is false, nothing is done for momentum. O(removed and new leaves). */
void oct_transfer_start(Oct *oct, const OctChange *change, const double *below, double mass,
                        bool free, const OctTransfer *transfer);

void oct_transfer_free(OctTransfer *transfer);

#endif
