/* clip.h - Gauss points in what of an octant lies inside a body (meshless section 4.1.2). */
#ifndef REF_CLIP_H
#define REF_CLIP_H

#include "octants.h"

/* -1: a cube is surely inside, 1: surely outside, 0: it may be cut. */
int ref_clip_side(const RefField *field, const double centre[3], double edge);

/* Gauss points and weights of sum 1 on -1/2..1/2. */
void ref_clip_gauss(int order, double *at, double *weight);

/* Whether a smallest part is to be split all the same, up to REF_CLIP_SHARP times: the surface runs
 * otherwise at the points x, which are the outermost on the part's tangent plane, so that an edge
 * of the body is near. */
bool ref_clip_sharp(const RefField *field, int count, const double (*x)[3],
                    const double gradient[3]);

enum { REF_CLIP_SHARP = 3 };

/* Appends an octant's points to the tree's, and the walls of the surface in it, and returns their
 * volume. The octant is split `options->split` times into parts of gauss^3 points each; a part that
 * is cut is split up to `options->clip` times more and then has one point a piece: its middle, or,
 * of one that is cut, the middle of what lies below the field's tangent plane, whose part in it is
 * a wall. */
double ref_clip_cell(const RefField *field, const RefOctantOptions *options, const double centre[3],
                     double edge, RefOctants *tree);

#endif
