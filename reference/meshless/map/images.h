/* images.h - triangles of a plane in the rectangles of a chart, and beyond their seams. */
#ifndef REF_IMAGES_H
#define REF_IMAGES_H

#include "../shell/chart.h"
#include "locate.h"

enum { REF_MOST_IMAGES = 32 };

/* Writes a triangle, whose first corner is in the chart's rectangle or whose middle is in one of
 * several, and its images that reach into rectangles; returns how many, REF_MOST_IMAGES at most.
 * `scratch` is kept from one call to the next and freed by the caller. */
long ref_images_of(const RefChart *chart, const RefPlaced *placed, RefCylinderImages *scratch,
                   RefPlaced *image);

/* Moves a place of such a triangle into the rectangle that it is in. */
void ref_images_enter(const RefChart *chart, const RefPlaced *in, double theta[2]);

#endif
