/* structure.h - what the bodies of an octree engine share: tree, visibility graph, widths, regions
 * and masses, made of voxels by options. */
#ifndef OCT_STRUCTURE_H
#define OCT_STRUCTURE_H

#include "../../lib/cut/cut.h"
#include "../engine.h"
#include "../region/region.h"
#include "../tree/mass.h"

struct OctResample; /* what is kept to change the structure while it runs (resample.c) */

struct OctStructure {
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
    long cut_known;               /* triangles of it that the graph has been held against */
    struct OctResample *resample; /* or NULL */
};

/* `mass` is that of the lattice's vertices (engine.h): each gives equal parts of it to the material
 * cells around it, and a leaf weighs what its cells do; NULL: 1 a cell. Errors (SM_INPUT), on which
 * `structure` is zeroed: those of oct_sampling_tree(), and options out of range. The caller
 * frees. */
SmCode oct_structure_build(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                           OctStructure *structure, SmError *error);

/* The same of a tree over the voxels, which becomes the structure's, whatever the options say of
 * sampling, and of a cut, which is copied (NULL: none): what a changed structure must equal. */
SmCode oct_structure_of_tree(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                             OctTree *tree, const SmCut *cut, OctStructure *structure,
                             SmError *error);
void oct_structure_free(OctStructure *structure);
size_t oct_structure_bytes(const OctStructure *structure);

/* Groups of nodes that no region holds together: 1 for a body that holds together. O(nodes +
 * members). */
long oct_structure_parts(const OctStructure *structure);

/* Centre of a leaf in mesh units. */
void oct_structure_centre(const OctStructure *structure, long leaf, double centre[3]);

#endif
