/* cracked.h - a thin shell with cracks (meshless section 4.2): when cracks change, all functions
 * and matrices are made anew.
 *
 * Cells whose node gets too little from its own cover are split into four, with a node each, and
 * others to keep the tree balanced; those whose covers reach a zero of a plane of cylinders are
 * not. What is made depends on where cracks are and not on how they came there.
 *
 * A sample is stiff where its functions leave the surface what a conformal map would have of it
 * (thin.h): a shell that cracks is soft where its map draws it out more than fourfold, before any
 * crack, too. With the stiffness that whole shells have there, a bust that is blown up gained
 * energy by orders of magnitude in a few steps. */
#ifndef REF_CRACKED_H
#define REF_CRACKED_H

#include <stdint.h>

#include "crack.h"
#include "shell.h"
#include "thin.h"

typedef struct {
    double least_share; /* of a node's weight, below which its cell is split */
    int most_splits;    /* of a cell of the whole shell, one after the other */
} RefCrackedOptions;

/* A cell of the tree; terminal ones alone have all this. */
typedef struct {
    RefSamples samples; /* of this cell alone */
    RefElement element;
    int nodes, node[REF_MOST_CELL_NODES]; /* those that stand in it, in the middle first */
    int whole;                            /* the terminal cell of the whole shell it is part of */
    int splits;                           /* from there */
    int from;                             /* a new cell: that of its ancestors which was terminal */
    double reach;                         /* of its nodes */
    uint64_t bears;                       /* samples whose functions leave the surface its shape, so
                                             that places beside them may have them: these are stiff
                                             and have not much more area than before any crack */
    int soft;                             /* samples without stiffness */
} RefCrackedCell;

typedef struct {
    long split;       /* cells, by the last update */
    long blind, soft; /* of all samples: those that see no node; those without stiffness */
} RefCrackedCounts;

typedef struct {
    RefShell *shell; /* the caller's; its tree, nodes, X, up and matrices change */
    RefShellOptions options;
    RefCrackedOptions cracked;
    RefCracks cracks, cracks_before; /* these at the last update */
    RefCrackedCell *cell;            /* [shell->tree.count] */
    long cell_room;
    bool *seen; /* [nodes] by samples */
    RefCrackedCounts counts;
    RefNodes whole;           /* nodes of the whole shell, and */
    double (*whole_X)[3];     /* its middle surface */
    double (*whole_above)[3]; /* how far its parameters are from it, at nodes */
} RefCracked;

/* Takes a shell that was built with these options and has no cracks. `cracked` must not move in
 * memory: the shell's nodes know its cracks. The caller frees it before the shell. */
void ref_cracked_create(RefShell *shell, const RefShellOptions *options,
                        const RefCrackedOptions *cracked_options, RefCracked *cracked);
void ref_cracked_free(RefCracked *cracked);

/* Fields of the shell, [3 nodes] each, that go on when its functions change. */
typedef struct {
    int count;         /* 2 or more */
    double **field;    /* [count] the caller's, allocated with sm_alloc(): displacements,
                          velocities, and others */
    double **residual; /* [2] of the first two, likewise, or NULL at first */
} RefCrackedFields;

/* After cracks were grown: makes all functions and matrices anew. A field's nodes
 * keep their parameters, and new ones have what the field was there; what is left of the old field
 * is written to `residual`, so that displacements + K^-1 residual and velocities + M^-1 residual
 * are its projections in the norms of both energies, which are no longer than the field was
 * (field_transfer.h): energies do not grow and momentum stays, but for samples that see no node
 * any more, whose mass is gone. To a thousandth: samples of a split cell have a little other areas.
 * `fields` may be NULL. */
void ref_cracked_update(RefCracked *cracked, const RefCrackedFields *fields);

/* What an update changes. */
typedef struct {
    long cells, leaves;
    RefCell *tree;        /* [cells] */
    RefCrackedCell *cell; /* [cells] without samples and elements */
    RefNodes nodes;
    double (*X)[3], (*up)[3];
    RefCracks cracks;
} RefCrackedSaved;

/* Taken after cracks were grown and before the update, to go back to the shell without that growth.
 * ref_cracked_restore() frees it, or ref_cracked_saved_free(). Going back makes all again, with the
 * same bits. */
RefCrackedSaved ref_cracked_save(const RefCracked *cracked);
void ref_cracked_restore(RefCracked *cracked, RefCrackedSaved *saved);
void ref_cracked_saved_free(RefCrackedSaved *saved);

/* The functions at a place, in the plane of `eye` beside it, as that sees it, which may be on the
 * other side of a crack; false where no sample is seen. */
bool ref_cracked_side(const RefCracked *cracked, const double theta[2], const double eye[2],
                      RefShape *shape);

/* Whether one of a terminal cell's samples bears places beside it. */
static inline bool ref_cracked_bears(const RefCracked *cracked, long cell, int sample)
{
    return cracked->cell[cell].bears >> sample & 1;
}

/* Of a terminal cell's samples the one whose functions are those of a place in it: the nearest that
 * no crack parts from it, of those that bear it, if there are any; -1: none is. */
int ref_cracked_sample(const RefCracked *cracked, long cell, const double theta[2]);

/* Whether any sample sees a node; others are tied to where they are by a stiffness of their own. */
bool ref_cracked_seen(const RefCracked *cracked, long node);

/* One of the nodes that move a place; -1: none does. */
int ref_cracked_node(const RefCracked *cracked, const double theta[2]);

/* ref_middle_press(), on areas that cracks do not change. */
void ref_cracked_press(const RefCracked *cracked, double pressure, double (*force)[3]);

#endif
