/* interpolation.h - the vertices of a surface from its nodes (surface.h), of the instruction set in
 * use (lib/isa.h). */
#ifndef OCT_INTERPOLATION_H
#define OCT_INTERPOLATION_H

#include "surface.h"

typedef struct {
    /* What oct_surface_move() does once the gradients are known. */
    void (*vertices)(const OctSurface *surface, const double (*x)[3], double (*position)[3],
                     double (*normal)[3]);
} OctInterpolation;
extern OctInterpolation oct_interpolation;

#endif
