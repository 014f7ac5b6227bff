/* middle.h - a shell's middle surface in rest, x = sum phi_I X_I: a combination of the functions
 * that displacements are of, so that rigid motions of it are displacements, too. */
#ifndef REF_MIDDLE_H
#define REF_MIDDLE_H

#include "samples.h"

/* X that fit the chart's surface by least squares over the samples, each with its area on the
 * surface as the weight. One factorisation of [nodes]^2. The caller frees `X`, [nodes]. Errors:
 * SM_INPUT, functions that depend on one another; solver.h's. */
SmCode ref_middle_fit(const RefChart *chart, const RefSamples *samples, long nodes, double (**X)[3],
                      SmError *error);

/* The surface where `count` functions are not zero: their nodes and parts as in RefSamples. */
RefFrame ref_middle_at(const double (*X)[3], int count, const int *node, const double (*part)[6]);

RefFrame ref_middle_of(const double (*X)[3], const RefShape *shape);

/* Adds what a pressure along the normals does to the parameters: over the samples and areas that
 * the mass is of, so that it gives that no more energy than it would give to loose dust. O(samples
 * covers). */
void ref_middle_press(const RefSamples *samples, double pressure, double (*force)[3]);

/* Fills in the samples' frames. */
void ref_middle_frames(const double (*X)[3], RefSamples *samples);

/* The same, and areas and traces; returns the whole area. */
double ref_middle_areas(const double (*X)[3], RefSamples *samples);

#endif
