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

/* The widths of all leaves by the options, with `width` where no local one holds. Counts in `held`
 * the leaves of every local one. */
static void fill_widths(const OctOptions *options, const OctWidth *width, OctStructure *s,
                        long held[OCT_MAX_WIDTHS])
{
    memset(held, 0, OCT_MAX_WIDTHS * sizeof *held);
    s->local_leaves = 0;
    for (long leaf = 0; leaf < s->tree.leaves; leaf++) {
        const OctWidth *own = width;
        double centre[3];
        oct_structure_centre(s, leaf, centre);
        for (int i = 0; i < options->local_count; i++)
            if (holds(&options->local[i], centre)) {
                own = &options->local[i].width;
                held[i]++;
            }
        s->local_leaves += own != width;
        s->w[leaf] = width_of(own, s->tree.size[s->tree.node[leaf]]);
    }
}

static double mean_summation_nodes(const OctStructure *s, double epsilon)
{
    OctRegions regions;
    if (oct_regions_build(&s->tree, &s->graph, s->w, epsilon, &regions, NULL)) return INFINITY;
    double mean = regions.mean;
    oct_regions_free(&regions);
    return mean;
}

/* The number of edges whose regions have nearest to as many summation nodes as wanted. */
static double search_edges(const OctOptions *options, OctStructure *s)
{
    size_t bytes = (size_t)s->tree.leaves * sizeof *s->w;
    int *before = sm_alloc(1, bytes);
    double best = 1, nearest = INFINITY;
    for (int step = 1; step <= OCT_WIDTH_STEPS * OCT_WIDTH_EDGES; step++) {
        OctWidth width = {.edges = (double)step / OCT_WIDTH_STEPS};
        long held[OCT_MAX_WIDTHS];
        fill_widths(options, &width, s, held);
        if (!memcmp(before, s->w, bytes)) continue;
        memcpy(before, s->w, bytes);
        double off = fabs(mean_summation_nodes(s, options->epsilon) - options->summation_nodes);
        if (off >= nearest) continue;
        nearest = off;
        best = width.edges;
    }
    free(before);
    return best;
}

SmCode oct_width_find(const OctOptions *options, OctStructure *s, SmError *error)
{
    long held[OCT_MAX_WIDTHS];
    s->w = sm_alloc((size_t)s->tree.leaves, sizeof *s->w);
    s->width = options->width;
    if (options->summation_nodes > 0)
        s->width = (OctWidth){.edges = search_edges(options, s)};
    else if (!(s->width.cells > 0 || s->width.edges > 0))
        s->width.edges = 1;
    fill_widths(options, &s->width, s, held);
    for (int i = 0; i < options->local_count; i++)
        if (!held[i])
            return sm_fail(error, SM_INPUT,
                           "octree: no node's centre lies in the box or sphere of width %d: "
                           "enlarge it",
                           i + 1);
    return SM_OK;
}
