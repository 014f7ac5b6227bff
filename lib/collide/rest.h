/* rest.h - what collisions know of a body at rest: its cells, their outer faces, the depth
 * below them, and which nodes and cells are too near in the material to collide.
 *
 * Nodes carry cells: a lattice cell hangs on its eight corner nodes, an octree leaf on its own.
 * Lengths are cells (of the octree: finest cells), lengths in the graph half cells. */
#ifndef SM_COLLIDE_REST_H
#define SM_COLLIDE_REST_H

#include <stdbool.h>

#define SM_COLLIDE_SLACK 1e-9 /* cells: distances that differ by less are equal */

enum {
    SM_COLLIDE_LAYERS = 2, /* cells below the surface that nodes are tested against */
    SM_COLLIDE_APART = 5,  /* a node and a cell that many cells apart or nearer do not collide */
    SM_COLLIDE_AROUND = 2, /* unless the path through the material is over that many times as far */
    SM_COLLIDE_CORNERS = 8, /* carriers of a lattice cell; bit d of one's place: high along d */
    SM_COLLIDE_FACES = 6    /* 2 d is the low one along axis d, 2 d + 1 the high one */
};

/* A body as an engine describes it. Everything stays the caller's, and where it is. */
typedef struct {
    long nodes, cells;
    int carriers;              /* of a cell: SM_COLLIDE_CORNERS, or 1 */
    const int *carrier;        /* [cells][carriers] */
    const double (*x0)[3];     /* [nodes] */
    const double *size;        /* [nodes] edge of what a node stands for; NULL: 1 */
    const double *radius;      /* [nodes] a node is solid that far around it; NULL: 0 */
    const double *mass;        /* [nodes] in any unit; NULL: 1 */
    const double (*centre)[3]; /* [cells] */
    const double *edge;        /* [cells] */
    const int (*across)[6];    /* [cells] the cell across each face; -1: none, the face is outer */
    const long *first;         /* [nodes + 1] the rest graph */
    const int *to, *length;    /* [first[nodes]]; no edge is shorter than its nodes are apart along
                                  any axis */
} SmCollideRest;

/* An outer face: a square of half-width `half` across axis side / 2, material behind it. */
typedef struct {
    double centre[3], half;
    int side;
} SmCollideFace;

typedef struct {
    double centre[3], edge;
    int carrier[SM_COLLIDE_CORNERS];
    int number;          /* in the description */
    int level;           /* 0: has an outer face; 1: beside one that has */
    long face, face_end; /* faces that depth is measured to; of level 0 its own */
} SmCollideCell;

/* Made of it, for any number of instances of the body. */
typedef struct {
    SmCollideRest rest;
    long nodes, cell_count, face_count, surface_count;
    int carriers;
    SmCollideCell *cell; /* [cell_count] of levels below SM_COLLIDE_LAYERS, by rising number */
    SmCollideFace *face; /* [face_count] */
    int *surface;        /* [surface_count] nodes that carry an outer face, rising */
    double (*x0)[3];     /* [nodes] */
    double *size, *radius, *inverse_mass;
    double widest;   /* edge of a cell */
    double mean;     /* edge of a cell */
    double thickest; /* radius of a node */
} SmCollideShape;

/* Floods the depth from the outer faces: a cell without one takes, from the cells across its faces
 * that the flood has reached before it, the faces nearest to its centre. O(cells + nodes). */
void sm_collide_shape_build(const SmCollideRest *rest, SmCollideShape *shape);
void sm_collide_shape_free(SmCollideShape *shape);

/* Distance that node and cell must exceed to collide, in the max norm and through the material. */
static inline double sm_collide_apart(double size, double edge)
{
    return SM_COLLIDE_APART * 0.5 * (size + edge);
}

/* Whether a node and a cell are no farther apart at rest than that. */
bool sm_collide_beside(const SmCollideShape *shape, int node, const SmCollideCell *cell);

/* How deep the rest position q is below the faces of `cell`: positive inside. A node of radius r
 * is solid from q - r on: true if any of it is inside, and then `depth` is from there. `out` is the
 * unit direction to the nearest face. */
bool sm_collide_depth(const SmCollideShape *shape, const SmCollideCell *cell, const double q[3],
                      double radius, double *depth, double out[3]);

/* What the material holds together: a node and a cell that are near each other at
 * rest (sm_collide_beside()) collide only if the rest graph does not join them by a path of at most
 * SM_COLLIDE_AROUND times that length through nodes just as near, and they do not touch at rest.
 *
 * Searched for when it is asked for, and then known: a body of many nodes has few that ever meet
 * cells that are neither their neighbours' nor far off. A search goes only where a path to the cell
 * may still be short enough: no edge is shorter than its ends are apart in the max norm. */

typedef enum { SM_COLLIDE_MAY, SM_COLLIDE_MUST_NOT, SM_COLLIDE_UNKNOWN } SmCollideRelation;

/* A node and the place of a cell in SmCollideShape.cell, from 1 (0: none). */
typedef struct {
    int node, cell;
    bool may;
} SmCollideAnswer;

/* Zeroed to begin with. */
typedef struct {
    SmCollideAnswer *answer; /* [room] a hash table, at most half full */
    long answers, room;
    int *distance; /* [nodes] of the last search, half cells; INT32_MAX: not reached */
    int *queue;    /* [nodes] a ring */
    char *queued;  /* [nodes] */
    int *reached;  /* [reached_count] */
    long reached_count, node_room;
} SmCollidePaths;

/* For a shape, or another one. O(nodes + answers known). */
void sm_collide_paths_start(SmCollidePaths *paths, const SmCollideShape *shape);
void sm_collide_paths_free(SmCollidePaths *paths);

/* Whether they may collide, as far as it can be told without a search. O(edges of the node). */
SmCollideRelation sm_collide_relation(const SmCollideShape *shape, int node, long c);

/* Whether a node and the cell at place c may collide: the first question about the two searches
 * what lies between them, later ones cost O(1). */
bool sm_collide_may(SmCollidePaths *paths, const SmCollideShape *shape, int node, long c);

#endif
