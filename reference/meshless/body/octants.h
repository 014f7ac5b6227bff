/* octants.h - the balanced octree of a meshless body, and its integration points (meshless section
 * 4.1).
 *
 * The octree of octree/tree/tree.h is another thing: its leaves are a regular lattice's material
 * cells, coarsened; these octants are cut by a smooth surface, and no two that touch at a face or
 * an edge differ by more than one level. Positions count in finest octants from `origin`. */
#ifndef REF_OCTANTS_H
#define REF_OCTANTS_H

#include "../../../lib/error.h"
#include "../surface/field.h"

typedef enum {
    REF_INTERIOR,     /* wholly inside */
    REF_BOUNDARY_IN,  /* cut, its centre inside */
    REF_BOUNDARY_OUT, /* cut, its centre outside */
    REF_EXTERIOR      /* wholly outside */
} RefOctantClass;

typedef struct {
    int corner[3], size; /* finest octants */
    int child;           /* first of eight, or -1: terminal */
    RefOctantClass kind; /* of a terminal one */
    double share;        /* of its volume that is inside, 0..1 */
    long first;          /* its integration points: first .. first of the next octant - 1 */
    long first_wall;     /* its walls, likewise */
} RefOctant;

typedef struct {
    double x[3], weight; /* weight: volume */
} RefPoint;

/* A point on what bounds the share of an octant that is inside: its faces, as far as they are, and
 * the surface in it. */
typedef struct {
    double x[3], area[3]; /* area: times the normal that points out of the share */
    bool surface;         /* of the body; otherwise shared with another octant */
} RefWall;

typedef struct {
    double origin[3], cell; /* cell: edge of a finest octant */
    long count, room;
    RefOctant *octant; /* [count]; 0 is the root, all children behind their parent */
    long points, point_room;
    RefPoint *point; /* [points], octant by octant */
    long walls, wall_room;
    RefWall *wall; /* [walls], octant by octant */
} RefOctants;

typedef struct {
    double cell; /* edge of the finest octants, which are those that the surface cuts */
    int coarser; /* levels by which octants farther in may be larger; 0: all are of one size */
    int split;   /* levels by which an octant is split for the integration; 0..3 */
    int gauss;   /* points a direction in each part, 1..4 */
    int clip;    /* further levels by which cut parts are split, 0..4 */
    bool rough;  /* for the octants alone: no walls, and no more levels where the body has edges */
} RefOctantOptions;

enum { REF_MOST_OCTANTS = 1 << 22 };

/* Covers the field's box, which lies in the octants' middle, so that the faces of a brick whose
 * edges are whole numbers of cells are octants' faces. Cut parts of the smallest size are clipped
 * by the plane that the field has there, so that volumes are right to second order. Errors
 * (SM_INPUT): more than REF_MOST_OCTANTS octants, or nothing inside. The caller frees. */
SmCode ref_octants_build(const RefField *field, const RefOctantOptions *options, RefOctants *tree,
                         SmError *error);
void ref_octants_free(RefOctants *tree);

/* The terminal octant that holds the finest octant at `place`; -1 outside the root. O(levels). */
int ref_octants_at(const RefOctants *tree, const int place[3]);

/* The centre of an octant. */
void ref_octants_centre(const RefOctants *tree, const RefOctant *octant, double centre[3]);

/* Volume of the body: the sum of the points' weights. */
double ref_octants_volume(const RefOctants *tree);

#endif
