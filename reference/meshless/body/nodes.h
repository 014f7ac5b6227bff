/* nodes.h - a meshless body's nodes and their covers (meshless sections 4.1.1 and 4.2).
 *
 * A node's cover is the open cube of half-edge `reach` around it (less a billionth
 * of that: mls.c). Bins over the box of all covers say which nodes may cover a point; they are
 * halved where covers are small, as a shell's on its limbs are a thousandth of those beside. A
 * shell's nodes stand in the plane of its parameters, with a third coordinate of 0, and their
 * covers are squares, which go on across seams: where one does, an image of the node stands beyond
 * the seam. */
#ifndef REF_NODES_H
#define REF_NODES_H

#include "cylinders.h"
#include "octants.h"

/* A place in the plane is also the place + shift, or shift - place where the plane goes on turned
 * by half a turn, if that is in the rectangle low..high. */
typedef struct {
    double low[2], high[2], shift[2];
    bool turned;
} RefSeam;

/* Where a place is beyond a seam. */
static inline void ref_seam_cross(const RefSeam *seam, const double theta[2], double there[2])
{
    for (int d = 0; d < 2; d++) there[d] = seam->shift[d] + (seam->turned ? -theta[d] : theta[d]);
}

/* Cracks that cut covers: what of a node's weight gets from the node's place `from` to x. Writes
 * that share's value and slopes by x, in a plane also its second derivatives (11, 22, 12), and
 * returns true, or false where nothing does. `reach` is the node's. */
typedef struct {
    bool (*pass)(const void *cracks, const double x[3], const double from[3], double reach,
                 double part[6]);
    const void *cracks;
} RefCut;

/* A square or cube, or its quarters or eighths, which follow each other from `child` on. */
typedef struct {
    int child; /* 0: it is whole */
    int count; /* nodes and images whose covers touch it: member[first] and so on, rising */
    long first;
} RefNodesBin;

typedef struct {
    long count;
    double (*position)[3]; /* [count + images] */
    double *reach;         /* [count + images] half the cover's edge */
    long images;           /* ref_nodes_bin() makes them */
    int *owner; /* [count + images] the node that each is; NULL: each itself, no images */
    bool plane; /* of a shell */
    RefCut cut; /* pass is NULL where covers are whole */
    int seams;
    const RefSeam *seam; /* [seams] the caller's, as long as reaches change */
    /* Of a plane of cylinders, the caller's: images stand where these say; NULL: no such plane. */
    const RefCylinders *cylinders;
    int *home;           /* [count + images] in whose plane each stands, */
    bool *dimmed;        /* [count + images] and whether zeros may be between it and a place */
    double low[3], edge; /* the bins' corner and edge, */
    int size[3];         /* bins a direction, the first ones of */
    long bins, members;  /* how many bins, halved ones too; and their members */
    RefNodesBin *bin;
    int depth;   /* how often bins are halved where covers are smallest */
    int *member; /* what they say */
    int most;    /* members of the fullest bin */
} RefNodes;

/* A node at the centre of every octant that is inside or cut; those whose centre is outside move
 * onto the surface. `alpha` is the cover's edge in edges of the octant. Three kinds of octant get
 * no node, because it would say what another one says and make the mass matrix singular: cut ones
 * of which less than a 64th is inside; those whose centre does not find the surface within an
 * octant's diagonal; and those that find it within a quarter of a cell of another node (at a
 * corner many do). The caller frees. */
void ref_nodes_place(const RefField *field, const RefOctants *tree, double alpha, RefNodes *nodes);

void ref_nodes_free(RefNodes *nodes);

/* A copy with images and bins of its own, as they are: ref_nodes_bin() was called after the last
 * change. The caller frees. */
RefNodes ref_nodes_copy(const RefNodes *nodes);

/* Makes images and bins anew after reaches have changed. O((nodes + images) depth). */
void ref_nodes_bin(RefNodes *nodes);

/* The nodes and images that may cover x: `count` of them. NULL where there are none. O(depth). */
static inline const int *ref_nodes_near(const RefNodes *nodes, const double x[3], int *count)
{
    long at = 0;
    double place[3];
    *count = 0;
    for (int d = 2; d >= 0; d--) {
        place[d] = (x[d] - nodes->low[d]) / nodes->edge;
        if (!(place[d] >= 0 && place[d] < nodes->size[d])) return NULL;
        at = at * nodes->size[d] + (int)place[d];
    }
    const RefNodesBin *bin = nodes->bin + at;
    while (bin->child) {
        int part = 0;
        for (int d = 0; d < (nodes->plane ? 2 : 3); d++) {
            place[d] = 2 * (place[d] - (int)place[d]);
            part += (int)place[d] << d;
        }
        bin = nodes->bin + bin->child + part;
    }
    *count = bin->count;
    return nodes->member + bin->first;
}

/* Calls `each` with the members of every bin that the box from low to high touches; of some nodes
 * more than once. */
void ref_nodes_each(const RefNodes *nodes, const double low[3], const double high[3],
                    void (*each)(void *data, int count, const int *member), void *data);

#endif
