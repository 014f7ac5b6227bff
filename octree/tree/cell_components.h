/* cell_components.h - how material connects inside cells of every size: where coarse cells would
 * weld it.
 *
 * Finest cells connect where they share a face, an edge or a corner (FastLSM's rule: they share a
 * particle). A component is as much of a cell's material as connects within the cell. */
#ifndef OCT_CELL_COMPONENTS_H
#define OCT_CELL_COMPONENTS_H

#include "../../lib/csr.h"
#include "neighbours.h"

/* The components of one level's cells and which of them touch across the cells' borders. */
typedef struct {
    long components;
    int *first;     /* [cells of the level + 1] first component of every cell */
    int *node;      /* [components] tree node */
    SmCsr contacts; /* of every component: those of other cells that touch it */
} OctLayer;

typedef struct {
    const OctTree *tree;
    unsigned char *octants;        /* oct_tree_octants() */
    int (*beside)[OCT_DIRECTIONS]; /* the nodes of the same level around those not of the finest */
    OctLayer layer[OCT_MAX_LEVELS];
} OctCellComponents;

/* For the cells of all levels but the finest of a whole tree (oct_tree_build()), which must stay.
 * O(nodes + contacts). The caller frees. */
void oct_components_build(const OctTree *whole, OctCellComponents *components);
void oct_components_free(OctCellComponents *components);

/* Whether a cell as a leaf welds what does not connect there: for OCT_HERE, whether the cell has
 * several components; else whether the material of the cell and of the cell of its size in that
 * direction does not connect within the box around both. A convex body is never welded. False
 * where there is no cell in that direction. O(components and contacts of the cells in the box). */
bool oct_components_weld(const OctCellComponents *components, int node, int direction);

#endif
