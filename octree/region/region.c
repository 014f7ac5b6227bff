#include "region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "one_sided_regions.h"

/* Puts the leaves below a node from `leaf` on; returns the end. */
static int *leaves_below(const OctTree *tree, int node, int *leaf)
{
    OctStack stack;
    oct_stack_begin(&stack, node);
    while (stack.count > 0) {
        node = oct_stack_take(&stack);
        if (!tree->children[node]) *leaf++ = tree->leaf[node];
        oct_stack_put(&stack, tree->child[node], tree->children[node]);
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

/* Of its one-sided region the leaves that hold it. */
static long intersect(Maker *m, long j, const int **member, int *width)
{
    const SmCsr *members = &m->one_sided->members;
    int *end = m->leaf;
    m->cover.count = 0;
    for (long n = members->first[j]; n < members->end[j]; n++)
        end = leaves_below(m->tree, members->item[n], end);
    oct_reach_from(&m->reach, (int)j, *width);
    *width = 0;
    for (const int *leaf = m->leaf; leaf < end; leaf++) {
        int distance = m->reach.distance[*leaf];
        if (distance > m->w[*leaf] && !oct_one_sided_holds(m->one_sided, m->tree, *leaf, (int)j))
            continue;
        oct_cover_put(&m->cover, m->tree->node[*leaf]);
        if (distance > *width) *width = distance;
    }
    oct_cover_finish(&m->cover);
    *member = m->cover.list;
    return m->cover.count;
}

static void make_regions(const OctTree *tree, const OctGraph *graph, const int *w,
                         OctSymmetry symmetry, const OctOneSided *o, OctRegions *regions)
{
    SmCsrParts members;
    sm_csr_parts_init(&members, tree->leaves);
#pragma omp parallel num_threads(sm_team(0)) if (tree->leaves > OCT_SERIAL)
    {
        Maker m = {.tree = tree, .one_sided = o, .w = w};
        oct_cover_init(&m.cover, tree, tree->nodes);
        if (symmetry == OCT_INTERSECTION) {
            oct_reach_init(&m.reach, graph);
            m.leaf = sm_alloc((size_t)tree->leaves, sizeof *m.leaf);
        }
#pragma omp for schedule(dynamic)
        for (long block = 0; block < members.blocks; block++)
            for (long j = sm_csr_parts_from(block); j < sm_csr_parts_to(&members, block); j++) {
                const int *member;
                int *width = &regions->width[j];
                long count = symmetry == OCT_UNION
                                 ? oct_one_sided_union(o, j, &m.cover, &member, width)
                                 : intersect(&m, j, &member, width);
                sm_csr_parts_add(&members, j, member, count);
            }
        oct_cover_free(&m.cover);
        oct_reach_free(&m.reach);
        free(m.leaf);
    }
    sm_csr_parts_join(&members, &regions->members, 0);
}

/* One-sided regions are symmetric already where there are no asymmetric pairs. */
static void make_symmetric(const OctTree *tree, const OctGraph *graph, const int *w,
                           OctSymmetry symmetry, OctOneSided *o, OctRegions *regions)
{
    regions->width = sm_alloc((size_t)tree->leaves, sizeof *regions->width);
    memcpy(regions->width, o->width, (size_t)tree->leaves * sizeof *regions->width);
    if (symmetry != OCT_ASYMMETRIC && o->reverse.live > 0) {
        make_regions(tree, graph, w, symmetry, o, regions);
    } else {
        regions->members = o->members;
        o->members = (SmCsr){0};
    }
}

void oct_regions_measure(OctRegions *r)
{
    long live = 0;
    r->most = 0;
    r->most_width = 0;
    r->mean_width = 0;
    for (long i = 0; i < r->members.rows; i++) {
        long members = r->members.end[i] - r->members.first[i];
        live += members > 0;
        if (members > r->most) r->most = members;
        if (r->width[i] > r->most_width) r->most_width = r->width[i];
        r->mean_width += (double)r->width[i];
    }
    r->mean_width = live ? r->mean_width / (double)live : 0;
    r->mean = live ? (double)r->members.live / (double)live : 0;
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
    regions->size = sm_alloc((size_t)tree->leaves, sizeof *regions->size);
    for (long i = 0; i < tree->leaves; i++)
        for (long n = regions->members.first[i]; n < regions->members.end[i]; n++)
            regions->size[i] += below[regions->members.item[n]];
    free(below);
    oct_regions_measure(regions);
    return SM_OK;
}

void oct_regions_free(OctRegions *regions)
{
    sm_csr_free(&regions->members);
    free(regions->width);
    free(regions->size);
    *regions = (OctRegions){0};
}

void oct_regions_leaves(const OctTree *tree, const OctRegions *regions, long i, int *leaf)
{
    for (long n = regions->members.first[i]; n < regions->members.end[i]; n++)
        leaf = leaves_below(tree, regions->members.item[n], leaf);
}
