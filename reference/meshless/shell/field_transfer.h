/* field_transfer.h - how displacements and velocities of a cracked shell go on when its functions
 * change (cracked.h).
 *
 * They are projected onto the new functions: displacements so that strains are off by least, in the
 * norm of the elastic energy, velocities so that they themselves are, in that of the kinetic
 * energy. A projection is never longer than what is projected, so that neither energy grows (to a
 * thousandth: test_cracked.c), and constants being among the functions, momentum stays. Both norms
 * are sums over samples. Where a cell was split its samples are others: what they have of the old
 * fields is made to have the sums that the cell had. */
#ifndef REF_FIELD_TRANSFER_H
#define REF_FIELD_TRANSFER_H

#include "cracked.h"

/* The functions and fields that a shell had. */
typedef struct {
    RefNodes nodes;
    double (*X)[3];
    int fields;
    double (**field)[3];
    RefShape shape;
    double (*part)[6];   /* of `shape` */
    long cells;          /* of the tree as it became, */
    RefSamples *samples; /* [cells] and what cells had */
} RefFieldsBefore;

/* Before functions change, but after cracks were grown. `fields` may be NULL: none. The caller
 * frees. */
RefFieldsBefore ref_fields_before(const RefCracked *cracked, const RefCrackedFields *fields);
void ref_fields_before_free(RefFieldsBefore *before);

/* All fields' parameters at a new node of a cell. */
void ref_fields_place(const RefCracked *cracked, const RefCrackedCell *cell, int node,
                      RefFieldsBefore *before, const RefCrackedFields *fields);

/* Takes the cells' samples, after some were split. */
void ref_fields_take_samples(RefCracked *cracked, RefFieldsBefore *before);

/* The residuals, once all samples are those of the new functions. */
void ref_fields_residuals(const RefCracked *cracked, RefFieldsBefore *before,
                          const RefCrackedFields *fields);

#endif
