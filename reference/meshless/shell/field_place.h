/* field_place.h - a shell's fields, such as displacements, at places: what energies are sums of
 * squares of, and the forces that belong to it. */
#ifndef REF_FIELD_PLACE_H
#define REF_FIELD_PLACE_H

#include "thin.h"

/* The functions of one place: nodes and parts as RefSamples has them, and the parameters that a
 * field has, [nodes][3]. */
typedef struct {
    int count;
    const int *node;
    const double (*part)[6];
    const double (*u)[3];
} RefFieldPlace;

/* Of a sample. */
RefFieldPlace ref_field_sample(const RefSamples *samples, long p, const double (*u)[3]);

/* A field's strains at a place (thin.h), whose surface the frame is. */
void ref_field_strains(const RefFieldPlace *place, const RefFrame *frame, double strain[6]);

/* A field's value at a place. */
void ref_field_value(const RefFieldPlace *place, double value[3]);

/* Strains of membrane and bending as numbers whose squares are twice the elastic energy of an area
 * of 1. */
void ref_field_root(const RefFieldPlace *place, const RefFrame *frame, double thickness,
                    const RefMaterial *material, double root[6]);

/* Adds to `force` the slope by a field's parameters of the product of its root and `root`, times
 * `area`. */
void ref_field_pull(const RefFieldPlace *place, const RefFrame *frame, double thickness,
                    const RefMaterial *material, const double root[6], double area,
                    double (*force)[3]);

#endif
