/* edges.h - how the triangles of a mesh meet along edges. */
#ifndef SM_EDGES_H
#define SM_EDGES_H

#include "mesh.h"

typedef struct {
    long open;        /* used by one triangle */
    long nonmanifold; /* used by more than two */
    long flipped;     /* used by two that run along it the same way */
    long unbalanced;  /* used more often one way than the other, as are all of the first and third
                       * kind: where there is none, the triangles bound a volume */
} SmEdgeCounts;

/* Counts the edges of each kind; an edge from a vertex to itself is not counted. `boundary`
 * ([vertex_count], or NULL) gets true for the ends of open edges and is left alone elsewhere.
 * O(triangles), but n log n in the triangles around one vertex. */
SmEdgeCounts sm_edges_count(const SmMesh *mesh, bool *boundary);

/* Triangles whose three corners an earlier one has too, in any order. Same cost. */
long sm_edges_duplicates(const SmMesh *mesh);

#endif
