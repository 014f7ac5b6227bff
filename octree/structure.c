#include "structure.h"

#include <math.h>
#include <stdlib.h>

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
    return SM_OK;
}

void oct_structure_centre(const OctStructure *structure, long leaf, double centre[3])
{
    const OctTree *tree = &structure->tree;
    for (int d = 0; d < 3; d++)
        centre[d] =
            structure->origin[d] + 0.5 * structure->cell * tree->centre[tree->node[leaf]][d];
}

/* A vertex's mass in equal parts to the leaves of the material cells around it. */
static void share_mass(const SmVoxels *voxels, const int at[3], double mass, OctStructure *s)
{
    int node[8], count = 0;
    for (int corner = 0; corner < 8; corner++) {
        int i = at[0] - (corner & 1), j = at[1] - (corner >> 1 & 1), k = at[2] - (corner >> 2);
        if (sm_voxel_get(voxels, i, j, k)) node[count++] = oct_tree_find(&s->tree, i, j, k);
    }
    for (int n = 0; n < count; n++) s->mass[s->tree.leaf[node[n]]] += mass / count;
}

static void find_masses(const SmVoxels *voxels, const double *mass, OctStructure *s)
{
    s->mass = sm_alloc((size_t)s->tree.leaves, sizeof *s->mass);
    for (long leaf = 0; leaf < s->tree.leaves && !mass; leaf++)
        s->mass[leaf] = (double)s->tree.material[s->tree.node[leaf]];
    if (!mass) return;
    int(*at)[3] = sm_alloc((size_t)voxels->particle_count, sizeof *at);
    sm_voxels_particles(voxels, at);
    for (long p = 0; p < voxels->particle_count; p++) share_mass(voxels, at[p], mass[p], s);
    free(at);
}

SmCode oct_structure_build(const SmVoxels *voxels, const OctOptions *options, const double *mass,
                           OctStructure *structure, SmError *error)
{
    *structure = (OctStructure){.cell = voxels->cell};
    for (int d = 0; d < 3; d++) structure->origin[d] = voxels->origin[d];
    SmCode code = check_options(options, error);
    if (!code) code = oct_width_check(options, error);
    if (!code) code = sample(voxels, &options->sampling, structure, error);
    if (!code) {
        oct_graph_build(&structure->tree, voxels, &structure->graph);
        code = oct_width_find(options, structure, error);
    }
    if (!code)
        code = oct_regions_build(&structure->tree, &structure->graph, structure->w,
                                 options->epsilon, &structure->regions, error);
    if (!code)
        find_masses(voxels, mass, structure);
    else
        oct_structure_free(structure);
    return code;
}

void oct_structure_free(OctStructure *structure)
{
    oct_tree_free(&structure->tree);
    oct_graph_free(&structure->graph);
    oct_regions_free(&structure->regions);
    free(structure->w);
    free(structure->mass);
    *structure = (OctStructure){0};
}

size_t oct_structure_bytes(const OctStructure *structure)
{
    return oct_tree_bytes(&structure->tree) + oct_graph_bytes(&structure->graph) +
           oct_regions_bytes(&structure->regions) +
           (size_t)structure->tree.leaves * (sizeof *structure->w + sizeof *structure->mass);
}

static int group_of(int *next, int i)
{
    while (next[i] != i) i = next[i] = next[next[i]];
    return i;
}

long oct_structure_parts(const OctStructure *structure)
{
    long leaves = structure->tree.leaves, parts = leaves;
    int *next = sm_alloc((size_t)leaves, sizeof *next);
    int *leaf = sm_alloc((size_t)leaves, sizeof *leaf);
    for (int i = 0; i < leaves; i++) next[i] = i;
    for (int i = 0; i < leaves && parts > 1; i++) {
        oct_regions_leaves(&structure->tree, &structure->regions, i, leaf);
        for (int k = 0; k < structure->regions.size[i]; k++) {
            int a = group_of(next, i), b = group_of(next, leaf[k]);
            parts -= a != b;
            next[a] = b;
        }
    }
    free(next);
    free(leaf);
    return parts;
}

/* The structure is the first member of every octree engine. */
const OctStructure *oct_engine_structure(const SmEngine *engine)
{
    return (const OctStructure *)engine;
}
