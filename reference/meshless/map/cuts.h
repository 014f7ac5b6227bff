/* cuts.h - where a surface is cut open for its map. */
#ifndef REF_CUTS_H
#define REF_CUTS_H

#include "triangulation.h"

/* Four corners on a disk's rim, in its order: where the rim turns most, as seen over a 24th of it
 * to both sides, by 45 degrees at least, an eighth of it apart; and where there are fewer than four
 * such places, those that are farthest along the rim from the others. O(rim). */
void ref_cuts_corners(const RefTriangulation *surface, int corner[4]);

/* Marks two slits of a closed surface of genus 0: shortest ways along edges between four vertices,
 * each the farthest from those before it, which so are at the ends of what sticks out. Returns a
 * corner of one of the four. `cut` is [3 * triangles] and zero. O(n log n). */
int ref_cuts_slits(const RefTriangulation *surface, bool *cut);

#endif
