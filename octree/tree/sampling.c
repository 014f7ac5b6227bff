#include "sampling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "place.h"
#include "split.h"

static const char *const KIND[] = {"uniform", "features", "surface", "box", "sphere"};

static SmCode check_region(const OctCriterion *c, SmError *error)
{
    bool finite = true, filled = true;
    if (c->kind == OCT_SPHERE) {
        for (int d = 0; d < 3; d++) finite = finite && isfinite(c->centre[d]);
        finite = finite && isfinite(c->radius);
        filled = c->radius > 0;
    } else if (c->kind == OCT_BOX) {
        for (int d = 0; d < 3; d++) {
            finite = finite && isfinite(c->low[d]) && isfinite(c->high[d]);
            filled = filled && c->low[d] < c->high[d];
        }
    }
    if (!finite)
        return sm_fail(error, SM_INPUT, "octree sampling: the %s is not finite", KIND[c->kind]);
    if (!filled)
        return sm_fail(error, SM_INPUT, "octree sampling: the %s is empty: %s", KIND[c->kind],
                       c->kind == OCT_BOX ? "low must be below high along every axis"
                                          : "its radius must be above 0");
    return SM_OK;
}

static SmCode check(const OctSampling *s, long cells, SmError *error)
{
    if (s->criteria_count < 0 || s->criteria_count > OCT_MAX_CRITERIA)
        return sm_fail(error, SM_INPUT, "octree sampling: %d criteria, but there can be 0 to %d",
                       s->criteria_count, OCT_MAX_CRITERIA);
    if (s->nodes < 0 || s->bases < 0)
        return sm_fail(error, SM_INPUT, "octree sampling: %ld %s wanted, but it cannot be below 0",
                       s->nodes < 0 ? s->nodes : s->bases, s->nodes < 0 ? "nodes" : "base cells");
    if (s->nodes > cells)
        return sm_fail(error, SM_INPUT,
                       "octree sampling: %ld nodes wanted, but there can be %ld, one of each finest "
                       "cell: give at most so many, or smaller cells",
                       s->nodes, cells);
    SmCode code = SM_OK;
    for (int c = 0; c < s->criteria_count && !code; c++) {
        const OctCriterion *criterion = &s->criteria[c];
        if (criterion->level < 0 || criterion->level > s->levels)
            return sm_fail(error, SM_INPUT,
                           "octree sampling: %s down to level %d, but levels go from 0 (base "
                           "cells) to %d (finest cells)",
                           KIND[criterion->kind], criterion->level, s->levels);
        code = check_region(criterion, error);
    }
    return code;
}

/* A region of interest without material is a mistake in its coordinates. */
static SmCode check_met(const OctSplitter *s, SmError *error)
{
    for (int c = 0; c < s->sampling->criteria_count; c++) {
        const OctCriterion *criterion = &s->sampling->criteria[c];
        if (criterion->kind != OCT_BOX && criterion->kind != OCT_SPHERE) continue;
        bool met = false;
        for (long n = s->whole->level_first[s->whole->levels]; n < s->whole->nodes && !met; n++)
            met = oct_split_meets(s, criterion, (int)n);
        if (met) continue;
        const SmVoxels *v = s->voxels;
        return sm_fail(error, SM_INPUT,
                       "octree sampling: the %s meets no material, which lies within (%g, %g, %g) "
                       "to (%g, %g, %g)",
                       KIND[criterion->kind], v->origin[0], v->origin[1], v->origin[2],
                       v->origin[0] + v->cell * v->size[0], v->origin[1] + v->cell * v->size[1],
                       v->origin[2] + v->cell * v->size[2]);
    }
    return SM_OK;
}

/* Splits as the criteria ask, and to the wanted number of nodes: counts only rise, so that the
 * nearest is the last below it or the first not below it. */
static void split_to(OctSplitter *s, long wanted)
{
    long splits = 0, leaves = s->leaves, balance = 0;
    while (!wanted || s->leaves < wanted) {
        splits = s->splits;
        leaves = s->leaves;
        balance = s->balance_splits;
        if (oct_split_needed(s)) continue;
        if (!wanted || !oct_split_other(s)) break;
        while (oct_split_needed(s)) continue;
    }
    if (!wanted || wanted - leaves >= labs(s->leaves - wanted)) return;
    oct_split_undo(s, splits);
    s->balance_splits = balance;
}

static bool is_leaf(const OctSplitter *s, int node)
{
    return oct_split_exists(s, node) && !s->split[node];
}

static void count_welds(const OctSplitter *s, OctSampleReport *report)
{
    for (int n = 0; n < s->whole->level_first[s->whole->levels]; n++) {
        if (!is_leaf(s, n)) continue;
        report->welded_cells += oct_parts_weld(&s->parts, n, OCT_HERE);
        for (int d = 0; d < OCT_DIRECTIONS; d++) {
            int other = s->parts.beside[n][d];
            if (d == OCT_HERE || other < 0 || !oct_split_exists(s, other)) continue;
            if (other < n && !s->split[other]) continue; /* counted from the other side */
            report->welded_pairs += oct_parts_weld(&s->parts, n, d);
        }
    }
}

static void fill_report(const OctSplitter *s, OctSampleReport *report)
{
    *report = (OctSampleReport){
        .bases = s->whole->roots,
        .nodes = s->leaves,
        .wanted_bases = s->sampling->bases,
        .wanted_nodes = s->sampling->nodes,
        .splits = s->splits,
        .balance_splits = s->balance_splits,
        .unasked_splits = -s->balance_splits,
    };
    for (long i = 0; i < s->splits; i++) report->unasked_splits += !s->asked[s->order[i]];
    memcpy(report->corner, s->whole->corner, sizeof report->corner);
    count_welds(s, report);
}

/* Nodes that the criteria alone give with the base lattice at `corner`. */
static SmCode count_nodes(const OctSampling *sampling, const SmVoxels *voxels, const int corner[3],
                          long *nodes, SmError *error)
{
    OctTree whole;
    SmCode code = oct_tree_build(voxels, sampling->levels, corner, &whole, error);
    if (code) return code;
    OctSplitter splitter;
    oct_splitter_init(&splitter, sampling, voxels, &whole);
    while (oct_split_needed(&splitter)) continue;
    *nodes = splitter.leaves;
    oct_splitter_free(&splitter);
    oct_tree_free(&whole);
    return SM_OK;
}

/* Where the base lattice stands. */
static SmCode place(const OctSampling *sampling, const SmVoxels *voxels, int corner[3],
                    SmError *error)
{
    memcpy(corner, sampling->corner, sizeof sampling->corner);
    if (!sampling->bases) return SM_OK;
    long most = OCT_PLACE_CELLS / voxels->cell_count, best = 0;
    most = !sampling->nodes || most < 1 ? 1 : most > OCT_PLACES ? OCT_PLACES : most;
    int places[OCT_PLACES][3];
    int count = oct_place(voxels, sampling->levels, sampling->bases, (int)most, places);
    for (int p = 0; p < count && sampling->nodes; p++) {
        long nodes = 0;
        SmCode code = count_nodes(sampling, voxels, places[p], &nodes, error);
        if (code) return code;
        if (p > 0 && labs(nodes - sampling->nodes) >= labs(best - sampling->nodes)) continue;
        best = nodes;
        memcpy(corner, places[p], sizeof places[p]);
    }
    if (!sampling->nodes) memcpy(corner, places[0], sizeof places[0]);
    return SM_OK;
}

SmCode oct_sampling_tree(const OctSampling *sampling, const SmVoxels *voxels, OctTree *tree,
                         OctSampleReport *report, SmError *error)
{
    int corner[3];
    OctTree whole;
    *tree = (OctTree){0};
    SmCode code = oct_tree_check(voxels, sampling->levels, error);
    if (!code) code = check(sampling, voxels->cell_count, error);
    if (code) return code;
    code = place(sampling, voxels, corner, error);
    if (code) return code;
    code = oct_tree_build(voxels, sampling->levels, corner, &whole, error);
    if (code) return code;
    OctSplitter splitter;
    oct_splitter_init(&splitter, sampling, voxels, &whole);
    code = check_met(&splitter, error);
    if (!code) {
        split_to(&splitter, sampling->nodes);
        oct_tree_prune(&whole, splitter.split, tree);
        if (report) fill_report(&splitter, report);
    }
    oct_splitter_free(&splitter);
    oct_tree_free(&whole);
    return code;
}
