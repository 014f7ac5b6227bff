#include "structure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../graph/frames.h"
#include "../region/width.h"
#include "resample.h"

/* Levels of splitting with which base cells are at most an eighth of the longest side. */
static int default_levels(const SmVoxels *voxels)
{
    int longest = 0, levels = 1;
    for (int d = 0; d < 3; d++)
        if (voxels->size[d] > longest) longest = voxels->size[d];
    while (levels < OCT_DEFAULT_LEVELS && longest >> (levels + 1) >= 8) levels++;
    return levels;
}

static void complete_sampling(const SmVoxels *voxels, OctSampling *sampling)
{
    if (sampling->levels == 0) sampling->levels = default_levels(voxels);
    if (sampling->criteria_count == 0)
        sampling->criteria[sampling->criteria_count++] = (OctCriterion){.kind = OCT_FEATURES};
    for (int i = 0; i < sampling->criteria_count && i < OCT_MAX_CRITERIA; i++)
        if (sampling->criteria[i].level == 0) sampling->criteria[i].level = sampling->levels;
}

/* The tree; where levels are free and fewer nodes are wanted than there are base cells, these are
 * made larger. */
static SmCode sample(const SmVoxels *voxels, const OctSampling *wanted, OctStructure *s,
                     SmError *error)
{
    OctSampling sampling = *wanted;
    for (;;) {
        complete_sampling(voxels, &sampling);
        SmCode code = oct_sampling_tree(&sampling, voxels, &s->tree, &s->report, error);
        bool free_levels = wanted->levels == 0 && wanted->bases == 0 && wanted->nodes > 0;
        if (code || !free_levels || s->report.bases <= wanted->nodes) return code;
        int levels = sampling.levels + 1;
        if (levels > OCT_MAX_LEVELS) return SM_OK;
        oct_tree_free(&s->tree);
        sampling = *wanted;
        sampling.levels = levels;
    }
}

static SmCode check_options(const OctOptions *o, SmError *error)
{
    if (!(o->epsilon >= 0 && o->epsilon <= 1e6))
        return sm_fail(error, SM_INPUT, "epsilon is %g: it is 0 or more", o->epsilon);
    bool flows = o->yield >= 0 && o->creep >= 0 && o->most >= 0 && isfinite(o->yield) &&
                 isfinite(o->creep) && isfinite(o->most);
    if (!flows)
        return sm_fail(error, SM_INPUT,
                       "octree: plasticity of yield %g, creep %g, most %g: all are 0 or more",
                       o->yield, o->creep, o->most);
    if (o->symmetry == OCT_ASYMMETRIC && o->form != OCT_ADJOINT)
        return sm_fail(error, SM_INPUT,
                       "octree: regions that are not symmetric (symmetry 'none') need goals "
                       "'adjoint': 'gather' sums over a node's own region, where it is to sum over "
                       "those that hold the node");
    return SM_OK;
}

void oct_structure_centre(const OctStructure *structure, long leaf, double centre[3])
{
    const OctTree *tree = &structure->tree;
    oct_tree_centre(tree, &structure->voxels, tree->node[leaf], centre);
}

static void copy_cut(const SmCut *from, double cube, SmCut *to)
{
    sm_cut_init(to, from ? from->cube : cube);
    if (!from) return;
    for (long v = 0; v < from->vertices; v++) sm_cut_vertex(to, from->vertex[v]);
    for (long t = 0; t < from->triangles; t++) sm_cut_triangle(to, from->triangle[t]);
}

/* All that a tree and a cut leave to be found. */
static SmCode complete(const double *mass, const SmCut *cut, OctStructure *s, SmError *error)
{
    const OctTree *tree = &s->tree;
    copy_cut(cut, 4 * s->cell, &s->cut); /* twice an edge of fine leaves */
    oct_graph_build(tree, &s->voxels, &s->graph);
    oct_graph_cut(tree, &s->voxels, &s->cut, &s->graph);
    s->cut_known = s->cut.triangles;
    SmCode code = oct_width_find(&s->options, s, error);
    if (!code)
        code = oct_regions_build(tree, &s->graph, s->w, s->options.epsilon, s->options.symmetry,
                                 &s->regions, error);
    if (code) return code;
    oct_mass_init(&s->cell_mass, &s->voxels, mass, s->options.masses);
    s->mass = sm_alloc((size_t)tree->leaves, sizeof *s->mass);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        s->mass[leaf] = oct_mass_of(&s->cell_mass, tree, &s->voxels, tree->node[leaf]);
    return SM_OK;
}

static void copy_voxels(const SmVoxels *from, SmVoxels *to)
{
    size_t words = (size_t)from->words * (size_t)from->size[1] * (size_t)from->size[2];
    *to = *from;
    to->bits = sm_alloc(words, sizeof *to->bits);
    memcpy(to->bits, from->bits, words * sizeof *to->bits);
}

static void start(const SmVoxels *voxels, const OctOptions *options, OctStructure *s)
{
    *s = (OctStructure){.cell = voxels->cell, .options = *options};
    for (int d = 0; d < 3; d++) s->origin[d] = voxels->origin[d];
    copy_voxels(voxels, &s->voxels);
}

SmCode oct_structure_build(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                           OctStructure *structure, SmError *error)
{
    start(voxels, options, structure);
    SmCode code = check_options(options, error);
    if (!code) code = oct_width_check(options, error);
    if (!code) code = sample(voxels, &options->sampling, structure, error);
    if (!code) code = complete(mass, NULL, structure, error);
    if (code) oct_structure_free(structure);
    return code;
}

SmCode oct_structure_of_tree(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                             OctTree *tree, const SmCut *cut, OctStructure *structure,
                             SmError *error)
{
    start(voxels, options, structure);
    structure->tree = *tree;
    *tree = (OctTree){0};
    structure->report.bases = structure->tree.roots;
    structure->report.nodes = structure->tree.leaves;
    SmCode code = check_options(options, error);
    if (!code) code = oct_width_check(options, error);
    if (!code) code = complete(mass, cut, structure, error);
    if (code) oct_structure_free(structure);
    return code;
}

void oct_structure_free(OctStructure *structure)
{
    oct_resample_free(structure);
    oct_tree_free(&structure->tree);
    oct_graph_free(&structure->graph);
    oct_regions_free(&structure->regions);
    free(structure->w);
    free(structure->mass);
    sm_voxels_free(&structure->voxels);
    oct_mass_free(&structure->cell_mass);
    sm_cut_free(&structure->cut);
    *structure = (OctStructure){0};
}

size_t oct_structure_bytes(const OctStructure *structure)
{
    const SmVoxels *v = &structure->voxels;
    return oct_resample_bytes(structure) + oct_tree_bytes(&structure->tree) +
           oct_graph_bytes(&structure->graph) + oct_regions_bytes(&structure->regions) +
           oct_mass_bytes(&structure->cell_mass, v) +
           (size_t)v->words * (size_t)v->size[1] * (size_t)v->size[2] * sizeof *v->bits +
           (size_t)structure->tree.leaves * (sizeof *structure->w + sizeof *structure->mass);
}

long oct_structure_parts(const OctStructure *structure)
{
    int *group = sm_alloc((size_t)structure->tree.leaves, sizeof *group);
    long parts = oct_frames_groups(&structure->tree, &structure->regions, group);
    free(group);
    return parts;
}

/* The structure is the first member of every octree engine. */
const OctStructure *oct_engine_structure(const SmEngine *engine)
{
    return (const OctStructure *)engine;
}
