/* quadtree.h - the balanced quadtree of a shell's parameters (meshless section 4.2).
 *
 * Its roots are a grid over each of the chart's rectangles, as close to squares as whole numbers
 * allow, so that no cell is cut by a rim and seams lie on cells' edges. Positions count in finest
 * cells of the grid. */
#ifndef REF_QUADTREE_H
#define REF_QUADTREE_H

#include "../body/octants.h"
#include "chart.h"

typedef struct {
    int corner[2], size; /* finest cells */
    int child;           /* first of four, or -1: terminal */
    int grid;
} RefCell;

/* The roots of a rectangle. */
typedef struct {
    double low[2], unit[2]; /* its corner; edges of a finest cell */
    int roots[2], first;    /* the first one's cell */
} RefRootGrid;

typedef struct {
    const RefChart *chart; /* the caller's */
    int grids;
    RefRootGrid *grid;  /* [grids] one, or one for each cylinder of the chart */
    long count, leaves; /* cells, terminal ones */
    long room;
    RefCell *cell; /* [count] the roots, grid by grid and row by row, then children behind their
                      parents */
} RefQuadtree;

enum { REF_QUADTREE_LEVELS = 14, REF_MOST_CELLS = 1 << 20 };

/* Splits cells while L times their longer edge is above `threshold`, L the chart's mean in the cell
 * (the largest of a five by five grid where it has none), and then until cells that share a piece
 * of an edge, also across seams, differ by one level at most. The mean makes nodes more even than
 * the largest: a spread of 21% beside 27% on a bunny. `across`: roots along a rectangle's shorter
 * side. Across joints of cylinders, whose cells are of other sizes, none is more than twice as long
 * as another. The caller frees. Errors: SM_USAGE, a rectangle without area or `across` below 1;
 * SM_INPUT, more than REF_MOST_CELLS cells. */
SmCode ref_quadtree_build(const RefChart *chart, int across, double threshold, RefQuadtree *tree,
                          SmError *error);

/* How many roots along shorter sides make cells squares as nearly as a sixteenth of the wanted
 * cells can: covers are squares of longer edges, and reach one node in four more where these are a
 * third longer. */
int ref_quadtree_across(const RefChart *chart, long wanted);

/* ref_quadtree_build() with a threshold that makes as nearly the wanted number of nodes
 * (ref_quadtree_nodes()) as bisection finds. `across` may be 0: as ref_quadtree_across() says, or
 * where that misses by over 5%, as on sheets all of whose cells are split at once, more that make
 * cells nearly as square. */
SmCode ref_quadtree_of(const RefChart *chart, int across, long wanted, RefQuadtree *tree,
                       SmError *error);
void ref_quadtree_free(RefQuadtree *tree);

/* The terminal cell at a place of the rectangle. O(levels). */
int ref_quadtree_at(const RefQuadtree *tree, const double theta[2]);

/* A cell's middle and edges. */
void ref_quadtree_cell(const RefQuadtree *tree, const RefCell *cell, double middle[2],
                       double edge[2]);

/* The longer one of its edges: the one that covers are so many times as wide as. */
double ref_quadtree_edge(const RefQuadtree *tree, const RefCell *cell);

/* Splits a terminal cell, and then others until the tree is balanced again. Four cells behind all
 * others are its own. O(cells). False where it cannot be any smaller. */
bool ref_quadtree_split(RefQuadtree *tree, long cell);

/* A node in the middle of every terminal cell, its cover a square of `eta` times the cell's longer
 * edge; and, with the same cover, nodes on rims: in the middle of every cell's side that lies there
 * and in corners between two. Without these a plate that rows clamp is held
 * as if its edges lay farther in: of twenty by twenty cells with linear functions it keeps 71% of
 * its deflection, with them 94%. The caller frees; the chart has to live as long. */
void ref_quadtree_nodes(const RefQuadtree *tree, double eta, RefNodes *nodes);

/* Appends one terminal cell's nodes, REF_MOST_CELL_NODES at most, the one in the middle first, to
 * arrays that have room for them. Bins stay as they are. */
void ref_quadtree_add_nodes(const RefQuadtree *tree, const RefCell *cell, double eta,
                            RefNodes *nodes);

enum { REF_MOST_CELL_NODES = 9 };

#endif
