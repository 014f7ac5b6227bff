#include "width.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool good_width(const OctWidth *width)
{
    return width->cells >= 0 && width->cells <= 1e6 && width->edges >= 0 && width->edges <= 1e6;
}

SmCode oct_width_check(const OctOptions *o, SmError *error)
{
    if (!good_width(&o->width))
        return sm_fail(error, SM_INPUT,
                       "octree: a width of %g cells and %g edges: both are from 0 to 1e6",
                       o->width.cells, o->width.edges);
    if (o->local_count < 0 || o->local_count > OCT_MAX_WIDTHS)
        return sm_fail(error, SM_INPUT, "octree: %d widths: at most %d can be given",
                       o->local_count, OCT_MAX_WIDTHS);
    for (int i = 0; i < o->local_count; i++)
        if (!good_width(&o->local[i].width))
            return sm_fail(error, SM_INPUT,
                           "octree: width %d is %g cells and %g edges: both are from 0 to 1e6",
                           i + 1, o->local[i].width.cells, o->local[i].width.edges);
    if (!(o->summation_nodes >= 0 && o->summation_nodes <= 1e6))
        return sm_fail(error, SM_INPUT,
                       "octree: %g summation nodes wanted: give a number above 0, or 0 for none",
                       o->summation_nodes);
    return SM_OK;
}

static bool holds(const OctLocalWidth *local, const double centre[3])
{
    double square = 0;
    bool inside = true;
    for (int d = 0; d < 3; d++) {
        square += pow(centre[d] - local->centre[d], 2);
        inside &= centre[d] >= local->low[d] && centre[d] <= local->high[d];
    }
    return local->radius > 0 ? square <= local->radius * local->radius : inside;
}

/* Half finest cells of a leaf that is `size` of them wide. */
static int width_of(const OctWidth *width, int size)
{
    static const double slack = 1e-9; /* 0.1 * 30 is 3 */
    double w = floor(2 * width->cells + width->edges * size + slack);
    return (int)fmin(w, 1 << 28);
}

/* Which local width holds the centre of a tree node, or -1. */
static int local_of(const OctOptions *options, const OctTree *tree, const SmVoxels *voxels,
                    int node)
{
    double centre[3];
    int local = options->local_count - 1;
    oct_tree_centre(tree, voxels, node, centre);
    while (local >= 0 && !holds(&options->local[local], centre)) local--;
    return local;
}

int oct_width_of(const OctOptions *options, const OctWidth *width, const OctTree *tree,
                 const SmVoxels *voxels, int node, bool *is_local)
{
    int local = local_of(options, tree, voxels, node);
    *is_local = local >= 0;
    return width_of(*is_local ? &options->local[local].width : width, tree->size[node]);
}

typedef struct {
    const OctOptions *options;
    const OctTree *tree;
    const OctGraph *graph;
    const SmVoxels *voxels;
    OctWidths *to;
    double off; /* of the nearest so far */
    int step;   /* its width, in steps */
} Search;

/* The widths of all leaves, with `width` where no local one holds. Counts in `held` the leaves of
 * every local one. */
static void fill_widths(const Search *s, const OctWidth *width, long held[OCT_MAX_WIDTHS])
{
    memset(held, 0, OCT_MAX_WIDTHS * sizeof *held);
    s->to->local_leaves = 0;
    for (long leaf = 0; leaf < s->tree->leaves; leaf++) {
        double centre[3];
        bool local;
        int node = s->tree->node[leaf];
        oct_tree_centre(s->tree, s->voxels, node, centre);
        for (int i = 0; i < s->options->local_count; i++)
            held[i] += holds(&s->options->local[i], centre);
        s->to->w[leaf] = oct_width_of(s->options, width, s->tree, s->voxels, node, &local);
        s->to->local_leaves += local;
    }
}

static double mean_summation_nodes(const Search *s)
{
    OctRegions regions;
    if (oct_regions_build(s->tree, s->graph, s->to->w, s->options->epsilon, s->options->symmetry,
                          &regions, NULL))
        return INFINITY;
    double mean = regions.mean;
    oct_regions_free(&regions);
    return mean;
}

/* How many summation nodes more than wanted a width of so many steps gives on average. */
static double beyond(Search *search, int step)
{
    long held[OCT_MAX_WIDTHS];
    OctWidth width = {.edges = (double)step / OCT_WIDTH_STEPS};
    fill_widths(search, &width, held);
    double off = mean_summation_nodes(search) - search->options->summation_nodes;
    if (fabs(off) < search->off) {
        search->off = fabs(off);
        search->step = step;
    }
    return off;
}

/* The number of edges with as many summation nodes as wanted, by doubling and then halving: of the
 * two neighbouring steps between which they pass the number, the nearer. */
static double search_edges(Search *search)
{
    int low = 0, high = 4, widest = OCT_WIDTH_STEPS * OCT_WIDTH_EDGES;
    for (; beyond(search, high) < 0; high *= 2) {
        if (high == widest) return (double)search->step / OCT_WIDTH_STEPS;
        low = high;
    }
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (beyond(search, middle) < 0)
            low = middle;
        else
            high = middle;
    }
    return (double)search->step / OCT_WIDTH_STEPS;
}

SmCode oct_width_find(const OctOptions *options, const OctTree *tree, const OctGraph *graph,
                      const SmVoxels *voxels, OctWidths *widths, SmError *error)
{
    long held[OCT_MAX_WIDTHS];
    Search search = {options, tree, graph, voxels, widths, INFINITY, 0};
    *widths = (OctWidths){.width = options->width};
    widths->w = sm_alloc((size_t)tree->leaves, sizeof *widths->w);
    if (options->summation_nodes > 0)
        widths->width = (OctWidth){.edges = search_edges(&search)};
    else if (!(widths->width.cells > 0 || widths->width.edges > 0))
        widths->width.edges = 1;
    fill_widths(&search, &widths->width, held);
    for (int i = 0; i < options->local_count; i++)
        if (!held[i])
            return sm_fail(error, SM_INPUT,
                           "octree: no node's centre lies in the box or sphere of width %d: "
                           "enlarge it",
                           i + 1);
    return SM_OK;
}
