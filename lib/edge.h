/* edge.h - the edges of triangles, to be sorted: then those of the same vertices follow each other.
 */
#ifndef SM_EDGE_H
#define SM_EDGE_H

#include <stdbool.h>

typedef struct {
    int low, high; /* vertices */
    int corner;    /* whatever tells it from others between these: 3 * triangle + i, for instance */
    bool forth;    /* the triangle runs along it from low to high */
} SmEdge;

/* The edge from corner i of a triangle to the next one. */
static inline SmEdge sm_edge(const int triangle[3], int i, int corner)
{
    int u = triangle[i], v = triangle[(i + 1) % 3];
    return u < v ? (SmEdge){u, v, corner, true} : (SmEdge){v, u, corner, false};
}

static inline bool sm_edges_same(const SmEdge *a, const SmEdge *b)
{
    return a->low == b->low && a->high == b->high;
}

/* For qsort(): by the vertices, then by the corner. */
static inline int sm_compare_edges(const void *a, const void *b)
{
    const SmEdge *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->corner > q->corner) - (p->corner < q->corner);
}

#endif
