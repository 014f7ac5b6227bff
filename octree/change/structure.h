/* structure.h - what the bodies of an octree engine share: tree, visibility graph, widths, regions
 * and masses, made of voxels by options; and its change while it runs: cells split and merged,
 * material cut (octree section 5).
 *
 * What comes out is what a build from scratch gives of the same split cells and the same cut
 * (oct_structure_of_tree()), whatever came before; only the numbers differ. A change costs what it
 * changes and what is around it: the searches of the regions that reach it, O(levels + log roots)
 * for a cell.
 *
 * Numbers. A tree node and a leaf keep theirs as long as they are there. Numbers of deleted ones
 * are used again, but not before the next batch; siblings follow each other. In OctTree `nodes` and
 * `leaves` count the numbers in use and those to be used again, `live` the leaves that there are;
 * of a deleted leaf node[] is -1, of a deleted node size[] is 0 (its centre stays until the number
 * is used again). Roots are never deleted. In a changed tree nodes are in no order and
 * level_first[] is not valid; the rows of graph and regions no longer follow each other
 * (lib/csr.h).
 *
 * A batch is any number of splits, merges and triangles added to the structure's cut, then one
 * oct_resample_update(). Between the first of them and the update only tree nodes, their sizes,
 * centres, parents, children and material are up to date. */
#ifndef OCT_STRUCTURE_H
#define OCT_STRUCTURE_H

#include "../../lib/cut/cut.h"
#include "../region/region.h"
#include "../tree/mass.h"
#include "../tree/tree_change.h"
#include "options.h"

typedef struct OctStructure {
    OctTree tree;
    OctGraph graph;
    OctRegions regions;
    OctWidth width;         /* as given or found; where no local one holds */
    long local_leaves;      /* where one does */
    int *w;                 /* [leaves] half finest cells */
    double *mass;           /* [leaves] kg */
    double origin[3], cell; /* of the voxels, in mesh units */
    OctSampleReport report;
    SmVoxels voxels;              /* its own */
    OctMass cell_mass;            /* of the voxels */
    OctOptions options;           /* as given */
    SmCut cut;                    /* edges that cross it are not in the graph */
    long cut_known;               /* triangles of it that the graph has been checked against */
    struct OctResample *resample; /* what changing it needs, or NULL */
} OctStructure;

/* `mass` is that of the lattice's vertices (lib/engine/engine.h): each gives equal shares of it to
 * the material cells around it, and a leaf weighs what its cells do; NULL: 1 a cell. Errors
 * (SM_INPUT), on which `structure` is zeroed: those of oct_sampling_tree(), and options out of
 * range. The caller frees. */
SmCode oct_structure_build(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                           OctStructure *structure, SmError *error);

/* The same of a tree over the voxels, which becomes the structure's, whatever the options say of
 * sampling, and of a cut, which is copied (NULL: none): what a changed structure must equal. */
SmCode oct_structure_of_tree(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                             OctTree *tree, const SmCut *cut, OctStructure *structure,
                             SmError *error);
void oct_structure_free(OctStructure *structure);

/* Groups of nodes that no region holds together: 1 for a body that holds together. O(nodes +
 * members). */
long oct_structure_parts(const OctStructure *structure);

/* Centre of a leaf in mesh units. */
void oct_structure_centre(const OctStructure *structure, long leaf, double centre[3]);

/* The structure of the same split cells, cut and widths; `mass` as it was given when `s` was built.
 * (*leaf)[i] is the leaf of `s` in the place of leaf i. The caller frees both. O(voxels + body).
 * Errors: those of building, which `s` has passed. */
SmCode oct_structure_rebuild(const OctStructure *s, const double *mass, OctStructure *fresh,
                             int **leaf, SmError *error);

/* Makes the structure ready to be changed, where it is not. O(body), once; the first split, merge
 * or update does it where the caller has not. */
void oct_resample_prepare(OctStructure *structure);

/* Splits a leaf, given as its tree node: those of its eight cells that hold material become leaves.
 * They are tree->child[node] and following, and may be split at once. Errors (SM_USAGE): no such
 * node, not a leaf, a finest cell. */
SmCode oct_resample_split(OctStructure *structure, int node, SmError *error);

/* Merges the children of a tree node, which must all be leaves, into one leaf. Errors (SM_USAGE):
 * no such node, or it has children that are not leaves, or none. */
SmCode oct_resample_merge(OctStructure *structure, int node, SmError *error);

/* Ends the batch: brings leaf numbers, graph, widths, regions and masses up to date with the tree
 * and with all triangles of structure->cut. regions.mean, most and the like are not: see
 * oct_regions_measure(). The result is valid until the next call of any function here. Allocates
 * nothing once the arrays have grown, but when gaps are closed (lib/csr.h). One thread. */
const OctChange *oct_resample_update(OctStructure *structure);

/* Tree nodes of leaves of a level below `level` whose cell is within `distance` (mesh units, max
 * norm) of a triangle of the cut from number `first` on. Each once. Works within a batch too, so
 * that splitting them and asking again refines the surroundings of a cut. Returns how many; *node
 * is valid until the next call of any function here. */
long oct_resample_near_cut(OctStructure *structure, long first, double distance, int level,
                           const int **node);

#endif
