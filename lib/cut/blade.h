/* blade.h - a straight blade that is moved through a deformed body, and the cut that it leaves.
 *
 * What the blade sweeps over in a frame, in the world, is taken back to where that material was at
 * rest by the inverse of the deformation nearby, and added to a cut (cut.h). The line where the
 * blade stands is kept as places of the material, not of the world, so that the next frame's sweep
 * joins on without a gap however the body has moved meanwhile. */
#ifndef SM_BLADE_H
#define SM_BLADE_H

#include "cut.h"

/* How nodes carry the material about them: X at rest is at position + F (X - rest). */
typedef struct {
    long nodes;
    const double (*rest)[3], (*position)[3]; /* [nodes] mesh units */
    const double (*F)[9];                    /* [nodes] by rows */
    const unsigned char *absent;             /* [nodes] not 0: no such node; NULL: all are there */
    void (*find)(void *of, long node);       /* fills in a node's F, each time that it is needed; */
    void *of;                                /* NULL: all are filled in */
    double cell;  /* finest cells' size: about the size of the triangles */
    double reach; /* a blade's point has material near it when a node is within this:
                     2 cells more than material is from its nearest node */
} SmCarriers;

typedef struct {
    double rest[3];
    double along;    /* the blade, 0 .. 1 */
    int number;      /* vertex of the cut, or -1 */
    bool known;      /* there is material near it */
    double ahead[3]; /* which way it last went, of unit length; 0 at first */
} SmBladePoint;

typedef struct {
    bool down;         /* in its place of the last sweep; else there is none */
    double end[2][3];  /* in the world */
    long points, room; /* of the line where it stands */
    SmBladePoint *point;
} SmBlade;

enum { SM_BLADE_CELLS = 4096 }; /* a blade longer than that is taken to be of so many parts */

/* A blade without a place yet. Free with sm_blade_free(). */
void sm_blade_init(SmBlade *blade);
void sm_blade_free(SmBlade *blade);

/* Takes it out: the next sweep puts it elsewhere, without cutting what lies between. */
void sm_blade_lift(SmBlade *blade);

/* Moves the blade to the segment from a to b, and adds to the cut what it sweeps over on the way;
 * the first time it is only set down. A point of it that goes back the way it came, no farther
 * aside than two cells, is left where it was until it comes past that again: a body that shakes,
 * or a blade that is drawn out, cuts nothing twice. Returns the number of triangles added: 0 while
 * it has moved, through the material, less than half a cell since it last cut anything,
 * and where there is none near it. A triangle of more than 4 cells' length joins places that are
 * not together in the material, and is left out. The blade's coordinates must be finite; it may be
 * of length 0. Nodes at NaN carry nothing. O(nodes) for a look at each, and what is
 * swept over.
 */
long sm_blade_sweep(SmBlade *blade, const double a[3], const double b[3],
                    const SmCarriers *carriers, SmCut *cut);

#endif
