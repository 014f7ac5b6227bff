/* cuts.h - where a surface is cut open for its map. */
#ifndef REF_CUTS_H
#define REF_CUTS_H

#include "triangulation.h"

/* A short closed line of edges around a handle or a tunnel, which does not part the surface: the
 * shortest of 2 genus independent ones, of which each goes along shortest ways from one vertex
 * (Erickson and Whittlesey 2005). Writes the corners into `loop`, [vertices]; returns how many, or
 * 0 where it would be longer than `limit` times the root of the area. O(n log n). */
long ref_cuts_handle(const RefTriangulation *surface, double limit, int *loop);

/* Marks two slits of a closed surface of genus 0, or one of a disk: each a shortest way along edges
 * between two vertices, about which the plane gets half a turn. They are those of a few, far from
 * one another, that let log L vary least over the surface's area, as the conformal factor of a flat
 * metric says that has so much of a turn there and nowhere else: sum_j w_ij (u_i - u_j) = target_i
 * - curvature_i for u = -log L (Ben-Chen, Gotsman and Bunin 2008). `tip` becomes a corner of one of
 * them, or -1 where a disk has no slit because four corners of its rim do as well: where they give
 * less than twice the variance. These are written into `corner`, in the rim's order: where the rim,
 * of four edges at least, turns most, by 45 degrees at least, as seen over a 48th of it to both
 * sides, or a 192nd or 768th, and where there are fewer than four such places, those that are
 * farthest along the rim from the others. `cut` is [3 * triangles] and zero. One factorisation of
 * [vertices]. Errors: solver.h's. */
SmCode ref_cuts_slits(const RefTriangulation *surface, const double *weight, bool *cut, int *tip,
                      int corner[4], SmError *error);

#endif
