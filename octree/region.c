#include "region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cover.h"
#include "halves.h"
#include "lists.h"

enum { SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

/* What leaf j owns and what it takes, into `member`. */
static void merge_region(const OctHalves *h, OctCover *cover, long j, OctLists *member)
{
    long first = h->first[j], count = h->first[j + 1] - first;
    if (h->taken_first[j] == h->taken_first[j + 1]) {
        oct_lists_add(member, j, h->member + first, count);
        return;
    }
    cover->count = 0;
    for (long n = 0; n < count; n++) oct_cover_put(cover, h->member[first + n]);
    for (long n = h->taken_first[j]; n < h->taken_first[j + 1]; n++)
        oct_cover_put(cover, cover->tree->node[h->taken[n]]);
    oct_cover_finish(cover);
    oct_lists_add(member, j, cover->list, cover->count);
}

static void merge_halves(const OctTree *tree, const OctHalves *h, OctRegions *regions)
{
    OctLists member;
    oct_lists_init(&member, tree->leaves);
#pragma omp parallel if (tree->leaves > SERIAL)
    {
        OctCover cover;
        oct_cover_init(&cover, tree, tree->nodes);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member.blocks; block++)
            for (long j = oct_lists_from(block); j < oct_lists_to(&member, block); j++)
                merge_region(h, &cover, j, &member);
        oct_cover_free(&cover);
    }
    oct_lists_pack(&member, &regions->first, &regions->member);
}

/* What is owned is all there is where nobody takes anything. */
static void join_halves(const OctTree *tree, OctHalves *h, OctRegions *regions)
{
    regions->width = h->width;
    h->width = NULL;
    for (long j = 0; j < tree->leaves; j++)
        for (long n = h->taken_first[j]; n < h->taken_first[j + 1]; n++)
            if (h->distance[n] > regions->width[j]) regions->width[j] = h->distance[n];
    if (h->taken_first[tree->leaves] > 0) {
        merge_halves(tree, h, regions);
    } else {
        regions->first = h->first;
        regions->member = h->member;
        h->first = NULL;
        h->member = NULL;
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
                         OctRegions *regions, SmError *error)
{
    *regions = (OctRegions){0};
    SmCode code = check(tree, w, epsilon, error);
    if (code) return code;
    OctHalves halves;
    int *below = oct_tree_below(tree);
    oct_halves_build(tree, graph, w, epsilon, below, &halves);
    join_halves(tree, &halves, regions);
    oct_halves_free(&halves);
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

/* Puts the leaves below a node from `leaf` on; returns the end. A node is smaller than its children
 * and a level has at most 8 siblings waiting, so the stack is as deep as the levels. */
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

void oct_regions_leaves(const OctTree *tree, const OctRegions *regions, long i, int *leaf)
{
    for (long n = regions->first[i]; n < oct_regions_end(regions, i); n++)
        leaf = leaves_below(tree, regions->member[n], leaf);
}
