/* sampling.h - which cells of the octrees are split (octree section 4.1).
 *
 * The whole tree has every cell with material split down to the finest cells; a sampling chooses
 * the tree within it whose leaves become simulation nodes. Splits are made in one order, which
 * depends on nothing but the voxels and the sampling: those that a criterion asks for, coarse cells
 * first, among cells of a size those with most material, then along the tree; and if more nodes are
 * wanted than that gives, every other cell, coarse cells first, among cells of a size those with
 * most surface. A wanted number of nodes stops where the number is nearest. */
#ifndef OCT_SAMPLING_H
#define OCT_SAMPLING_H

#include "tree.h"

typedef enum {
    OCT_UNIFORM,  /* all cells: regular sampling at the criterion's level */
    OCT_FEATURES, /* cells that would weld material that does not connect there: see below */
    OCT_SURFACE,  /* cells that hold a finest cell with an empty face: a skin of fine cells */
    OCT_BOX,      /* cells that meet a box */
    OCT_SPHERE,   /* cells that meet a ball */
} OctCriterionKind;

/* Of OCT_FEATURES a cell is split if its material does not connect within it, or if its material
 * and that of a touching tree node of its size (a leaf or not) do not connect within the box around
 * both (cell_components.h). Then every leaf above the finest level is connected, and so are any two
 * touching leaves, within the box around the larger and the cell of its size that holds the
 * smaller. Fine gaps get fine cells, and material that only bends, swells or tapers gets none. */
typedef struct {
    OctCriterionKind kind;
    int level; /* the deepest that it splits to: 0 (base cells) to levels (finest cells) */
    double low[3], high[3];   /* OCT_BOX, in the mesh's units */
    double centre[3], radius; /* OCT_SPHERE, in the mesh's units */
} OctCriterion;

enum { OCT_MAX_CRITERIA = 16, OCT_PLACES = 64, OCT_PLACE_CELLS = 1 << 22 };

typedef struct {
    int levels;    /* a base cell is 2^levels finest cells wide */
    int corner[3]; /* of the base lattice, in finest cells; not used if bases is given */
    long bases;    /* wanted base cells: the lattice is put where there are nearest to that many
                    * (base_grid.h), of such places where the criteria give nearest to `nodes`; or 0 */
    OctCriterion criteria[OCT_MAX_CRITERIA]; /* a cell is split if one of them asks for it */
    int criteria_count;
    bool balance; /* cells of leaves that touch differ by one level at most */
    long nodes;   /* wanted simulation nodes, or 0 for what the criteria give */
} OctSampling;

typedef struct {
    int corner[3];       /* of the base lattice */
    long bases, nodes;   /* base cells and simulation nodes there are */
    long wanted_bases;   /* as the sampling says, or 0 */
    long wanted_nodes;   /* as the sampling says, or 0 */
    long welded_cells;   /* leaves above the finest level whose material has several components */
    long welded_pairs;   /* leaves above the finest level and touching tree nodes of the same size
                          * that do not connect within the box around both */
    long splits;         /* in all */
    long balance_splits; /* made for balance alone */
    long unasked_splits; /* made for as many nodes as are wanted: no criterion asks for them */
} OctSampleReport;

/* Makes the tree. The caller frees it. `report` may be NULL. O(nodes of the whole tree * log), some
 * 150 ns and 100 bytes for a moment per finest cell of a solid, and with `bases` and `nodes` that
 * time again for every place tried, at most 64 and fewer if there are more than OCT_PLACE_CELLS /
 * 64 cells. Errors (SM_INPUT), on which `tree` is zeroed: what oct_tree_build() says; a criterion's
 * level beyond 0..levels; a box or ball that is not finite, empty, or meets no material; wanted
 * numbers below 0, nodes more than cells; too many criteria. */
SmCode oct_sampling_tree(const OctSampling *sampling, const SmVoxels *voxels, OctTree *tree,
                         OctSampleReport *report, SmError *error);

#endif
