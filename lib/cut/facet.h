/* facet.h - what is left of a face that others cut: its parts right of all segments. */
#ifndef SM_FACET_H
#define SM_FACET_H

#include "crossing.h"

/* The segments of every face, and working space. */
typedef struct {
    const SmCrossing *crossing;
    long *first;  /* [faces + 1] */
    int *segment; /* [first[faces]] */
    int *next;    /* [points] along the face in hand, or -1 */
    unsigned char *visited;
    double slack;
    /* outlines of the face in hand: rings of points in the shared numbering */
    int rings, ring_points, ring_room;
    int *ring_first, *ring_point;
    double (*at)[2]; /* [ring_points] seen along the face's largest normal component */
    bool *hole;
    long triangles, triangle_room;
    int (*triangle)[3]; /* what is left, of all faces so far, in the shared numbering */
} SmFacets;

typedef enum {
    SM_FACET_FILLED,
    SM_FACET_TORN,   /* segments end within the face, or meet more than two at a point */
    SM_FACET_FAILED, /* they cross, or rounding mixed up their order */
} SmFacetResult;

void sm_facets_init(const SmCrossing *crossing, double slack, SmFacets *facets);
void sm_facets_free(SmFacets *facets);

static inline bool sm_facets_crossed(const SmFacets *facets, long face)
{
    return facets->first[face] < facets->first[face + 1];
}

/* Appends the triangles that fill what is left of a crossed face, and says which of its corners
 * are left: kept[i]. */
SmFacetResult sm_facets_fill(SmFacets *facets, long face, bool kept[3]);

#endif
