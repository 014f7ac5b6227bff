#include "structure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/csr.h"
#include "../region/frames.h"
#include "../region/region_change.h"
#include "width.h"

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
    OctWidths widths;
    SmCode code = oct_width_find(&s->options, tree, &s->graph, &s->voxels, &widths, error);
    s->width = widths.width;
    s->local_leaves = widths.local_leaves;
    s->w = widths.w;
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

static void start(const SmVoxels *voxels, const OctOptions *options, OctStructure *s)
{
    *s = (OctStructure){.cell = voxels->cell, .options = *options};
    for (int d = 0; d < 3; d++) s->origin[d] = voxels->origin[d];
    sm_voxels_copy(voxels, &s->voxels);
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

/* The node of another tree over the same cells in the place of `node`. */
static int same_node(const OctTree *from, int node, const OctTree *to)
{
    int found = oct_tree_at(to, oct_tree_level(from, node), oct_tree_low(from, node, 0),
                            oct_tree_low(from, node, 1), oct_tree_low(from, node, 2));
    assert(found >= 0 && to->size[found] == from->size[node]);
    return found;
}

static SmCode same_tree(const OctStructure *s, OctTree *tree, SmError *error)
{
    OctTree whole;
    SmCode code = oct_tree_build(&s->voxels, s->tree.levels, s->tree.corner, &whole, error);
    if (code) return code;
    unsigned char *split = sm_alloc((size_t)whole.nodes, 1);
    for (int n = 0; n < s->tree.nodes; n++)
        if (s->tree.size[n] > 0 && s->tree.children[n]) split[same_node(&s->tree, n, &whole)] = 1;
    oct_tree_prune(&whole, split, tree);
    free(split);
    oct_tree_free(&whole);
    return SM_OK;
}

SmCode oct_structure_rebuild(const OctStructure *s, const double *mass, OctStructure *fresh,
                             int **leaf, SmError *error)
{
    OctTree tree;
    OctOptions options = s->options;
    options.width = s->width; /* which may have been searched for */
    options.summation_nodes = 0;
    if (s->local_leaves == 0) options.local_count = 0; /* refused where it holds no leaf */
    SmCode code = same_tree(s, &tree, error);
    if (!code)
        code = oct_structure_of_tree(&s->voxels, &options, mass, &tree, &s->cut, fresh, error);
    if (code) return code;
    *leaf = sm_alloc((size_t)fresh->tree.leaves, sizeof **leaf);
    for (long i = 0; i < fresh->tree.leaves; i++)
        (*leaf)[i] = s->tree.leaf[same_node(&fresh->tree, fresh->tree.node[i], &s->tree)];
    return SM_OK;
}

/* ---- change while it runs */

typedef struct OctResample {
    OctTreeChange tree;
    OctGraphChange graph;
    OctRegionChange region;
    OctLeafQuery query;
    int *coarse; /* [coarse_count] */
    long coarse_count, coarse_room;
    long leaf_space; /* of widths and masses */
} OctResample;

static void make_leaves(OctStructure *s, long to)
{
    long from = s->resample->leaf_space;
    s->w = sm_widen(s->w, from, to, sizeof *s->w, 0);
    s->mass = sm_widen(s->mass, from, to, sizeof *s->mass, 0);
    s->resample->leaf_space = to;
}

void oct_resample_prepare(OctStructure *s)
{
    if (s->resample) return;
    OctResample *r = sm_alloc(1, sizeof *r);
    oct_tree_change_init(&r->tree, &s->tree, &s->voxels);
    oct_graph_change_init(&r->graph, &s->tree, &s->voxels, &s->cut, &s->graph);
    oct_region_change_init(&r->region, &s->tree, &s->graph, s->w, s->options.epsilon, r->tree.below,
                           &s->regions);
    oct_leaf_query_init(&r->query, &s->tree, &s->voxels);
    r->leaf_space = s->tree.leaves;
    s->resample = r;
    make_leaves(s, sm_room_for(s->tree.leaves));
}

static void free_resample(OctStructure *s)
{
    OctResample *r = s->resample;
    if (!r) return;
    oct_tree_change_free(&r->tree);
    oct_graph_change_free(&r->graph);
    oct_region_change_free(&r->region);
    oct_leaf_query_free(&r->query);
    free(r->coarse);
    free(r);
    s->resample = NULL;
}

SmCode oct_resample_split(OctStructure *s, int node, SmError *error)
{
    oct_resample_prepare(s);
    return oct_tree_change_split(&s->resample->tree, node, error);
}

SmCode oct_resample_merge(OctStructure *s, int node, SmError *error)
{
    oct_resample_prepare(s);
    return oct_tree_change_merge(&s->resample->tree, node, error);
}

static int width_of(const OctStructure *s, int node, bool *local)
{
    return oct_width_of(&s->options, &s->width, &s->tree, &s->voxels, node, local);
}

/* Widths and masses of the leaves that a batch has removed and added. */
static void weigh(OctStructure *s, const OctChange *change)
{
    bool local;
    if (s->tree.leaves > s->resample->leaf_space) make_leaves(s, sm_room_for(s->tree.leaves));
    for (long n = 0; n < change->removed_count; n++) {
        OctRemoved gone = change->removed[n];
        width_of(s, gone.node, &local);
        s->local_leaves -= local;
        s->w[gone.leaf] = 0;
        s->mass[gone.leaf] = 0;
    }
    for (long n = 0; n < change->added_count; n++) {
        OctAdded come = change->added[n];
        s->w[come.leaf] = width_of(s, come.node, &local);
        s->local_leaves += local;
        s->mass[come.leaf] = oct_mass_of(&s->cell_mass, &s->tree, &s->voxels, come.node);
    }
    s->report.nodes = s->tree.live;
}

const OctChange *oct_resample_update(OctStructure *s)
{
    oct_resample_prepare(s);
    OctResample *r = s->resample;
    OctGraphChange *graph = &r->graph;
    OctChange *change = &r->tree.change;
    OctReach *reach = &r->region.reach;
    oct_tree_change_settle(&r->tree);
    weigh(s, change);
    oct_graph_change_find(graph, change);
    oct_region_change_grow(&r->region, s->w, r->tree.below);
    oct_region_change_note(&r->region, &graph->gone);
    oct_region_change_mark(&r->region);
    oct_graph_change_apply(graph, reach);
    oct_region_change_note(&r->region, &graph->come);
    change->edge_count = graph->gone.count + graph->come.count;
    oct_graph_change_cut(graph, s->cut_known);
    change->edge_count += graph->gone.count;
    oct_region_change_note(&r->region, &graph->gone);
    oct_region_change_mark(&r->region);
    oct_graph_change_apply(graph, reach);
    s->cut_known = s->cut.triangles;
    oct_region_change_update(&r->region, change);
    return change;
}

/* Sorts nodes and drops what is there twice. */
static long distinct(int *node, long count)
{
    long kept = 0;
    qsort(node, (size_t)count, sizeof *node, sm_compare_ints);
    for (long n = 0; n < count; n++)
        if (kept == 0 || node[n] != node[kept - 1]) node[kept++] = node[n];
    return kept;
}

long oct_resample_near_cut(OctStructure *s, long first, double distance, int level,
                           const int **node)
{
    oct_resample_prepare(s);
    OctResample *r = s->resample;
    r->coarse_count = 0;
    for (long t = first; t < s->cut.triangles; t++) {
        double corner[3][3];
        oct_graph_change_corners(&s->voxels, &s->cut, t, corner);
        oct_leaf_query_triangle(&r->query, (const double(*)[3])corner, 2 * distance / s->cell,
                                level, OCT_CELLS);
        sm_make_room(r->coarse, r->coarse_room, r->coarse_count + r->query.count);
        if (r->query.count > 0)
            memcpy(r->coarse + r->coarse_count, r->query.node,
                   (size_t)r->query.count * sizeof *r->coarse);
        r->coarse_count += r->query.count;
    }
    r->coarse_count = r->coarse_count ? distinct(r->coarse, r->coarse_count) : 0;
    *node = r->coarse;
    return r->coarse_count;
}

/* ---- the end */

void oct_structure_free(OctStructure *structure)
{
    free_resample(structure);
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

long oct_structure_parts(const OctStructure *structure)
{
    int *group = sm_alloc((size_t)structure->tree.leaves, sizeof *group);
    long parts = oct_frames_groups(&structure->tree, &structure->regions, group);
    free(group);
    return parts;
}
