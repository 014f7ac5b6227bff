/* field_transfer.h - a shell's fields, such as displacements, from functions that it had to those
 * that it has. */
#ifndef REF_FIELD_TRANSFER_H
#define REF_FIELD_TRANSFER_H

#include "thin.h"

/* The functions of one place: nodes and parts as RefSamples has them, and the parameters that the
 * middle surface and a field have, [nodes][3]. */
typedef struct {
    int count;
    const int *node;
    const double (*part)[6];
    const double (*X)[3];
    const double (*u)[3];
} RefFieldPlace;

/* What a field is multiplied by when it is compared: the energy's law, and m times the mass. */
typedef struct {
    double thickness, mass_share;
    RefMaterial material;
} RefFieldNorm;

/* The middle surface at a place. */
RefFrame ref_field_frame(const RefFieldPlace *place);

/* A field's strains at a place (thin.h), whose surface the frame is. */
void ref_field_strains(const RefFieldPlace *place, const RefFrame *frame, double strain[6]);

/* A field's value at a place. */
void ref_field_value(const RefFieldPlace *place, double value[3]);

/* Of a sample: its area in the plane; on the surface before any crack; the trace (samples.h). */
typedef struct {
    double weight, area, trace;
} RefFieldSample;

/* Adds to `residual`, of the new nodes' parameters, the sum over one sample of
 *     B^T D (strains of the old field - of the new) + m rho t phi (old field - new),
 * B, phi and D those of the new functions; `frame` are both places'. Where the new ones leave the
 * surface without an area, the second part alone. */
void ref_field_residual(const RefFieldPlace *old, const RefFieldPlace *new, const RefFrame frame[2],
                        const RefFieldSample *sample, const RefFieldNorm *norm,
                        double (*residual)[3]);

#endif
