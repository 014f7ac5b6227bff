/* cut_solid.h - the thin solid that a blade takes away: triangles of a cut, made a little thick. */
#ifndef SM_CUT_SOLID_H
#define SM_CUT_SOLID_H

#include "../mesh/mesh.h"
#include "cut.h"

typedef struct {
    double thickness; /* rest position, mesh units */
    unsigned seed;    /* of what moves every vertex by up to a twentieth of the thickness, so that
                         nothing lies exactly in or on anything else */
} SmCutSolidOptions;

/* The solid around triangles `first` .. `last` - 1 of the cut: two copies of them, half a thickness
 * either way, and walls along their border. The border is pushed out by a thickness; where it is
 * shared with earlier triangles it is pushed into their gap, and is thinner than that: the walls
 * that stood there are opened without touching the gap's sides. Every cut's triangles with an area
 * make one. False, with `solid` zeroed and nothing to free, where there are none, or where they do
 * not form a surface with two sides (edges of more than two triangles, turned-over neighbours,
 * folds). O(triangles). The caller frees. */
bool sm_cut_solid_make(const SmCut *cut, long first, long last, const SmCutSolidOptions *options,
                       SmMesh *solid);

#endif
