/* harmonic.h - harmonic one-forms on a triangulation.
 *
 * A closed one-form is a number for every edge, by corners: form[c] along the edge of corner c, and
 * -form[c] at its twin; around a triangle they add up to 0. It is harmonic where it has the least
 * energy of all that differ from it by a function's differences: 1/2 sum_ij w_ij form_ij^2 over the
 * edges, w the cotangents of the angles across, halved (Pinkall and Polthier 1993; Gu and Yau
 * 2003). */
#ifndef REF_HARMONIC_H
#define REF_HARMONIC_H

#include "triangulation.h"

/* Weights of edges by corners. With `least` above 0, those that are below it are set to it, so that
 * maps of harmonic forms have no triangle that is turned over (Gortler, Gotsman and Thurston 2006).
 * After ref_triangulation_delaunay() only edges on rims across from wide angles, and few others,
 * are below 0. 0: as they are. The caller frees. */
double *ref_harmonic_weights(const RefTriangulation *surface, double least);

/* Makes `count` forms harmonic: adds differences of functions that are 0 at vertices that are
 * `held` ([vertices], or NULL: none). One factorisation for all. Errors: solver.h's. */
SmCode ref_harmonic_solve(const RefTriangulation *surface, const double *weight, const bool *held,
                          int count, double *const *form, SmError *error);

/* Functions u of sources that add up to 0 over a closed surface: sum_j w_ij (u_i - u_j) = source_i,
 * 0 at the first vertex, which also takes what is left where they do not add up. `source` and `u`
 * are `count` times [vertices], and may be the same. Errors: solver.h's. */
SmCode ref_harmonic_potentials(const RefTriangulation *surface, const double *weight, int count,
                               double *const *source, double *const *u, SmError *error);

/* sum_ij w_ij a_ij b_ij over the edges. */
double ref_harmonic_product(const RefTriangulation *surface, const double *weight, const double *a,
                            const double *b);

/* The integral of a wedge b, the forms taken as linear in triangles. */
double ref_harmonic_wedge(const RefTriangulation *surface, const double *a, const double *b);

/* Closed forms of whole numbers, one for each of 2 genus independent loops that are no rims: 1 for
 * edges that a loop of triangles crosses one way. The loops are those of a tree of edges, in which
 * all of a rim but one is, and a tree of triangles that crosses none of them (Eppstein 2003).
 * `form` has room for 2 genus; the caller frees each. O(triangles). */
void ref_harmonic_loops(const RefTriangulation *surface, double **form);

/* A closed form of whole numbers: 1 for edges that a row of triangles from one rim to another
 * crosses. The caller frees. */
double *ref_harmonic_crossing(const RefTriangulation *surface, int from, int to);

/* The function of which a form is the differences, from 0 at vertex `root`: along a tree of edges,
 * so that it leaps elsewhere where the form has periods. The caller frees. */
double *ref_harmonic_integral(const RefTriangulation *surface, int root, const double *form);

#endif
