/* width.h - the widths of regions by the options (engine.h). */
#ifndef OCT_WIDTH_H
#define OCT_WIDTH_H

#include "../change/structure.h"

/* A width is searched in steps of 1 / OCT_WIDTH_STEPS edges up to OCT_WIDTH_EDGES: distances are
 * such fractions of the edges around. */
enum { OCT_WIDTH_STEPS = 16, OCT_WIDTH_EDGES = 4, OCT_WIDTH_TRIES = 10 };

/* Errors (SM_INPUT): a width, how many there are, or the wanted summation nodes out of range. */
SmCode oct_width_check(const OctOptions *options, SmError *error);

/* Fills in the structure's `w` and `width`; its tree and graph are there. With wanted summation
 * nodes regions are built for every width tried, at most OCT_WIDTH_TRIES times; where their mean
 * does not rise with the width, another width may come as near. Errors (SM_INPUT): a local width
 * without a leaf. */
SmCode oct_width_find(const OctOptions *options, OctStructure *structure, SmError *error);

/* The width of a leaf, given as its tree node, by the structure's options and `width`, and whether
 * it is a local one. */
int oct_width_of(const OctStructure *structure, int node, bool *is_local);

#endif
