#include "resample.h"

#include <stdlib.h>
#include <string.h>

#include "../region/lists.h"
#include "../region/region_change.h"
#include "../region/width.h"
#include "../tree/tree_change.h"

typedef struct OctResample {
    OctTreeChange tree;
    OctGraphChange graph;
    OctRegionChange region;
    OctNear near;
    int *coarse; /* [coarse_count] */
    long coarse_count, coarse_room;
    long leaf_space; /* of widths and masses */
} OctResample;

static void make_leaves(OctStructure *s, long to)
{
    long from = s->resample->leaf_space;
    s->w = oct_plots_widen(s->w, from, to, sizeof *s->w, 0);
    s->mass = oct_plots_widen(s->mass, from, to, sizeof *s->mass, 0);
    s->resample->leaf_space = to;
}

void oct_resample_prepare(OctStructure *s)
{
    if (s->resample) return;
    OctResample *r = sm_alloc(1, sizeof *r);
    oct_tree_change_init(&r->tree, &s->tree, &s->voxels);
    oct_graph_change_init(&r->graph, s);
    oct_region_change_init(&r->region, s, r->tree.below);
    oct_near_init(&r->near, &s->tree, &s->voxels);
    r->leaf_space = s->tree.leaves;
    s->resample = r;
    make_leaves(s, oct_plots_room(s->tree.leaves));
}

void oct_resample_free(OctStructure *s)
{
    OctResample *r = s->resample;
    if (!r) return;
    oct_tree_change_free(&r->tree);
    oct_graph_change_free(&r->graph);
    oct_region_change_free(&r->region);
    oct_near_free(&r->near);
    free(r->coarse);
    free(r);
    s->resample = NULL;
}

size_t oct_resample_bytes(const OctStructure *s)
{
    const OctResample *r = s->resample;
    if (!r) return 0;
    return sizeof *r + oct_tree_change_bytes(&r->tree) + oct_graph_change_bytes(&r->graph) +
           oct_region_change_bytes(&r->region);
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

/* Widths and masses of the leaves that a batch has removed and added. */
static void weigh(OctStructure *s, const OctChange *change)
{
    bool local;
    if (s->tree.leaves > s->resample->leaf_space) make_leaves(s, oct_plots_room(s->tree.leaves));
    for (long n = 0; n < change->removed_count; n++) {
        OctRemoved gone = change->removed[n];
        oct_width_of(s, gone.node, &local);
        s->local_leaves -= local;
        s->w[gone.leaf] = 0;
        s->mass[gone.leaf] = 0;
    }
    for (long n = 0; n < change->added_count; n++) {
        OctAdded come = change->added[n];
        s->w[come.leaf] = oct_width_of(s, come.node, &local);
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
    oct_region_change_grow(&r->region, r->tree.below);
    oct_region_change_note(&r->region, graph->gone, graph->gone_count);
    oct_region_change_mark(&r->region);
    oct_graph_change_apply(graph, reach);
    oct_region_change_note(&r->region, graph->come, graph->come_count);
    change->edge_count = graph->gone_count + graph->come_count;
    oct_graph_change_cut(graph, s->cut_known);
    change->edge_count += graph->gone_count;
    oct_region_change_note(&r->region, graph->gone, graph->gone_count);
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
    qsort(node, (size_t)count, sizeof *node, oct_lists_compare);
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
        oct_graph_change_corners(s, t, corner);
        oct_near_triangle(&r->near, (const double(*)[3])corner, 2 * distance / s->cell, level,
                          OCT_CELLS);
        if (r->coarse_count + r->near.count > r->coarse_room) {
            r->coarse_room = 2 * (r->coarse_count + r->near.count);
            r->coarse = sm_realloc(r->coarse, (size_t)r->coarse_room, sizeof *r->coarse);
        }
        if (r->near.count > 0)
            memcpy(r->coarse + r->coarse_count, r->near.node,
                   (size_t)r->near.count * sizeof *r->coarse);
        r->coarse_count += r->near.count;
    }
    r->coarse_count = r->coarse_count ? distinct(r->coarse, r->coarse_count) : 0;
    *node = r->coarse;
    return r->coarse_count;
}
