#include "region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/csr.h"
#include "../../lib/system/team.h"
#include "../graph/distance.h"
#include "../tree/cover.h"
#include "one_sided_regions.h"

enum { SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

/* Puts the leaves below a node from `leaf` on; returns the end. A node is smaller than its children
 * and a level has at most 8 siblings on the stack, so the stack is as deep as the levels. */
static int *leaves_below(const OctTree *tree, int node, int *leaf)
{
    int stack[8 * (OCT_MAX_LEVELS + 1)], count = 1;
    stack[0] = node;
    while (count > 0) {
        node = stack[--count];
        if (!tree->children[node]) *leaf++ = tree->leaf[node];
        for (int c = 0; c < tree->children[node]; c++) stack[count++] = tree->child[node] + c;
    }
    return leaf;
}

/* What a thread makes regions symmetric with. */
typedef struct {
    const OctTree *tree;
    const OctOneSided *one_sided;
    const int *w;
    OctCover cover;
    OctReach reach;
    int *leaf; /* [leaves] */
} Maker;

/* Its one-sided region and its reverse list. */
static void unite(Maker *m, long j, int *width)
{
    const OctOneSided *o = m->one_sided;
    for (long n = o->first[j]; n < o->first[j + 1]; n++) oct_cover_put(&m->cover, o->member[n]);
    for (long n = o->reverse_first[j]; n < o->reverse_first[j + 1]; n++) {
        oct_cover_put(&m->cover, m->tree->node[o->reverse[n]]);
        if (o->distance[n] > *width) *width = o->distance[n];
    }
}

static bool holds(const Maker *m, int i, int leaf)
{
    long first = m->one_sided->first[i], count = m->one_sided->first[i + 1] - first;
    return oct_cover_holds(m->tree, m->one_sided->member + first, count, leaf);
}

/* Of its one-sided region the leaves that hold it. */
static void intersect(Maker *m, long j, int *width)
{
    const OctOneSided *o = m->one_sided;
    int *end = m->leaf;
    for (long n = o->first[j]; n < o->first[j + 1]; n++)
        end = leaves_below(m->tree, o->member[n], end);
    oct_reach_from(&m->reach, (int)j, *width);
    *width = 0;
    for (const int *leaf = m->leaf; leaf < end; leaf++) {
        int distance = m->reach.distance[*leaf];
        if (distance > m->w[*leaf] && !holds(m, *leaf, (int)j)) continue;
        oct_cover_put(&m->cover, m->tree->node[*leaf]);
        if (distance > *width) *width = distance;
    }
}

static void make_region(Maker *m, OctSymmetry symmetry, long j, int *width, SmCsrParts *member)
{
    const OctOneSided *o = m->one_sided;
    if (symmetry == OCT_UNION && o->reverse_first[j] == o->reverse_first[j + 1]) {
        sm_csr_parts_add(member, j, o->member + o->first[j], o->first[j + 1] - o->first[j]);
        return;
    }
    m->cover.count = 0;
    if (symmetry == OCT_UNION)
        unite(m, j, width);
    else
        intersect(m, j, width);
    oct_cover_finish(&m->cover);
    sm_csr_parts_add(member, j, m->cover.list, m->cover.count);
}

static void make_regions(const OctTree *tree, const OctGraph *graph, const int *w,
                         OctSymmetry symmetry, const OctOneSided *o, OctRegions *regions)
{
    SmCsrParts member;
    sm_csr_parts_init(&member, tree->leaves);
#pragma omp parallel num_threads(sm_team(0)) if (tree->leaves > SERIAL)
    {
        Maker m = {.tree = tree, .one_sided = o, .w = w};
        oct_cover_init(&m.cover, tree, tree->nodes);
        if (symmetry == OCT_INTERSECTION) {
            oct_reach_init(&m.reach, graph);
            m.leaf = sm_alloc((size_t)tree->leaves, sizeof *m.leaf);
        }
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member.blocks; block++)
            for (long j = sm_csr_parts_from(block); j < sm_csr_parts_to(&member, block); j++)
                make_region(&m, symmetry, j, &regions->width[j], &member);
        oct_cover_free(&m.cover);
        oct_reach_free(&m.reach);
        free(m.leaf);
    }
    sm_csr_parts_join(&member, &regions->first, &regions->member);
}

/* One-sided regions are symmetric already where there are no asymmetric pairs. */
static void make_symmetric(const OctTree *tree, const OctGraph *graph, const int *w,
                           OctSymmetry symmetry, OctOneSided *o, OctRegions *regions)
{
    regions->width = o->width;
    o->width = NULL;
    if (symmetry != OCT_ASYMMETRIC && o->reverse_first[tree->leaves] > 0) {
        make_regions(tree, graph, w, symmetry, o, regions);
    } else {
        regions->first = o->first;
        regions->member = o->member;
        o->first = NULL;
        o->member = NULL;
    }
}

void oct_regions_measure(OctRegions *r)
{
    long live = 0;
    r->members = r->most = 0;
    r->most_width = 0;
    r->mean_width = 0;
    for (long i = 0; i < r->leaves; i++) {
        long members = oct_regions_end(r, i) - r->first[i];
        live += members > 0;
        r->members += members;
        if (members > r->most) r->most = members;
        if (r->width[i] > r->most_width) r->most_width = r->width[i];
        r->mean_width += (double)r->width[i];
    }
    r->mean_width = live ? r->mean_width / (double)live : 0;
    r->mean = live ? (double)r->members / (double)live : 0;
}

static SmCode check(const OctTree *tree, const int *w, double epsilon, SmError *error)
{
    if (!(epsilon >= 0) || !isfinite(epsilon))
        return sm_fail(error, SM_USAGE, "octree regions: epsilon = %g, but it must be 0 or more",
                       epsilon);
    for (long i = 0; i < tree->leaves; i++)
        if (w[i] < 0)
            return sm_fail(error, SM_USAGE,
                           "octree regions: node %ld has width %d, but it must be 0 or more", i,
                           w[i]);
    return SM_OK;
}

SmCode oct_regions_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                         OctSymmetry symmetry, OctRegions *regions, SmError *error)
{
    *regions = (OctRegions){0};
    SmCode code = check(tree, w, epsilon, error);
    if (code) return code;
    OctOneSided one_sided;
    int *below = oct_tree_below(tree);
    oct_one_sided_build(tree, graph, w, epsilon, below, &one_sided);
    make_symmetric(tree, graph, w, symmetry, &one_sided, regions);
    oct_one_sided_free(&one_sided);
    regions->leaves = tree->leaves;
    regions->size = sm_alloc((size_t)tree->leaves, sizeof *regions->size);
    for (long i = 0; i < tree->leaves; i++)
        for (long n = regions->first[i]; n < regions->first[i + 1]; n++)
            regions->size[i] += below[regions->member[n]];
    free(below);
    oct_regions_measure(regions);
    return SM_OK;
}

void oct_regions_free(OctRegions *regions)
{
    free(regions->first);
    free(regions->end);
    free(regions->member);
    free(regions->width);
    free(regions->size);
    memset(regions, 0, sizeof *regions);
}

size_t oct_regions_bytes(const OctRegions *regions)
{
    return sizeof *regions + ((size_t)regions->leaves + 1) * sizeof *regions->first +
           (size_t)regions->leaves * (sizeof *regions->width + sizeof *regions->size) +
           (size_t)regions->members * sizeof *regions->member;
}

void oct_regions_leaves(const OctTree *tree, const OctRegions *regions, long i, int *leaf)
{
    for (long n = regions->first[i]; n < oct_regions_end(regions, i); n++)
        leaf = leaves_below(tree, regions->member[n], leaf);
}
