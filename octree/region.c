#include "region.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interval.h"
#include "lists.h"

enum { SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

typedef struct {
    const OctTree *tree;
    const OctGraph *graph;
    const int *w;
    double epsilon;
    int *below;
    OctRegions *regions;
} Build;

/* How far the search for region i goes. */
static int farthest(const Build *b, long i)
{
    double most = b->w[i] + floor(b->epsilon * b->w[i]);
    return most < OCT_FAR / 2 ? (int)most : OCT_FAR / 2;
}

/* Region i by its own intervals into `member`, and into `doubtful` its leaves in whose regions i
 * may be missing, because the distance is more than their widths. A number below 0 there is the
 * distance, negated, of the leaves that follow. */
static void find_region(const Build *b, OctIntervals *s, long i, OctLists *member,
                        OctLists *doubtful)
{
    int w = b->w[i], listed = 0;
    oct_interval_find(s, (int)i, w, farthest(b, i));
    b->regions->width[i] = s->width;
    oct_lists_add(member, i, s->member, s->members);
    for (long n = 0; n < s->reach.count; n++) {
        int j = s->reach.reached[n], d = s->reach.distance[j];
        if (d <= b->w[j] || (d > w && !oct_interval_holds(s, j))) continue;
        int negated = -d;
        if (d != listed) oct_lists_add(doubtful, i, &negated, 1);
        listed = d;
        oct_lists_add(doubtful, i, &j, 1);
    }
}

/* Every region by its own intervals. */
static void find_regions(const Build *b, OctLists *doubtful)
{
    OctLists member;
    oct_lists_init(&member, b->tree->leaves);
#pragma omp parallel if (b->tree->leaves > SERIAL)
    {
        OctIntervals s;
        oct_interval_init(&s, b->tree, b->graph, b->below);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member.blocks; block++)
            for (long i = oct_lists_from(block); i < oct_lists_to(&member, block); i++)
                find_region(b, &s, i, &member, doubtful);
        oct_interval_free(&s);
    }
    oct_lists_pack(&member, &b->regions->first, &b->regions->member);
}

/* Is a leaf in the region of j? */
static bool region_holds(const Build *b, int j, int leaf)
{
    const OctRegions *r = b->regions;
    for (int node = b->tree->node[leaf]; node >= 0; node = b->tree->parent[node]) {
        long low = r->first[j], high = r->first[j + 1];
        while (low < high) {
            long middle = low + (high - low) / 2;
            if (r->member[middle] < node)
                low = middle + 1;
            else
                high = middle;
        }
        if (low < r->first[j + 1] && r->member[low] == node) return true;
    }
    return false;
}

/* Of the doubtful leaves keeps, in place, those in whose regions i is missing. */
static void keep_missing(const Build *b, long i, int *item, int *count)
{
    int kept = 0;
    for (int n = 0; n < *count; n++)
        if (item[n] < 0 || !region_holds(b, item[n], (int)i)) item[kept++] = item[n];
    *count = kept;
}

/* Leaves to be added to every region, as rows. */
typedef struct {
    long *first; /* [leaves + 1] */
    int *leaf;
} Added;

/* Turns "i is missing in j" round to "j gets i", and widens j to its distance. */
static void turn_round(const Build *b, const OctLists *missing, Added *added)
{
    long leaves = b->tree->leaves;
    long *next = sm_alloc((size_t)leaves, sizeof *next);
    added->first = sm_alloc((size_t)leaves + 1, sizeof *added->first);
    for (long i = 0; i < leaves; i++) {
        const int *item = oct_lists_item(missing, i);
        for (int n = 0, d = 0; n < missing->count[i]; n++) {
            if (item[n] < 0) {
                d = -item[n];
                continue;
            }
            added->first[item[n] + 1]++;
            int *width = b->regions->width + item[n];
            if (d > *width) *width = d;
        }
    }
    for (long j = 0; j < leaves; j++) added->first[j + 1] += next[j] = added->first[j];
    added->leaf = sm_alloc((size_t)added->first[leaves], sizeof *added->leaf);
    for (long i = 0; i < leaves; i++) {
        const int *item = oct_lists_item(missing, i);
        for (int n = 0; n < missing->count[i]; n++)
            if (item[n] >= 0) added->leaf[next[item[n]]++] = (int)i;
    }
    free(next);
}

/* Scratch of one thread for merging. */
typedef struct {
    const OctTree *tree;
    unsigned char *in; /* [nodes] children that are in, all 0 between merges */
    int *list;
    long count, room;
} Merge;

/* Puts a node on the list and, where it completes its siblings, their parent. */
static void put(Merge *m, int node)
{
    const OctTree *t = m->tree;
    for (bool complete = true; complete; node = t->parent[node]) {
        if (m->count == m->room) {
            m->room = m->room ? 2 * m->room : 256;
            m->list = sm_realloc(m->list, (size_t)m->room, sizeof *m->list);
        }
        m->list[m->count++] = node;
        int parent = t->parent[node];
        complete = parent >= 0 && ++m->in[parent] == t->children[parent];
    }
}

/* Leaves on the list, rising, what has no parent there; clears `in`. */
static void finish(Merge *m)
{
    const OctTree *t = m->tree;
    long kept = 0;
    for (long n = 0; n < m->count; n++) {
        int node = m->list[n], parent = t->parent[node];
        if (parent >= 0 && m->in[parent] == t->children[parent]) continue;
        m->list[n] = m->list[kept];
        m->list[kept++] = node;
    }
    for (long n = 0; n < m->count; n++) {
        int parent = t->parent[m->list[n]];
        if (parent >= 0) m->in[parent] = 0;
    }
    m->count = kept;
    qsort(m->list, (size_t)kept, sizeof *m->list, oct_lists_compare);
}

/* Region j with what is added to it, into `member`. */
static void merge_region(const Build *b, Merge *m, const Added *added, long j, OctLists *member)
{
    const OctRegions *r = b->regions;
    long first = r->first[j], count = r->first[j + 1] - first;
    if (added->first[j] == added->first[j + 1]) {
        oct_lists_add(member, j, r->member + first, count);
        return;
    }
    m->count = 0;
    for (long n = 0; n < count; n++) put(m, r->member[first + n]);
    for (long n = added->first[j]; n < added->first[j + 1]; n++)
        put(m, b->tree->node[added->leaf[n]]);
    finish(m);
    oct_lists_add(member, j, m->list, m->count);
}

/* Replaces the regions by those with what is added to them. */
static void merge_regions(const Build *b, const Added *added)
{
    OctLists member;
    oct_lists_init(&member, b->tree->leaves);
#pragma omp parallel if (b->tree->leaves > SERIAL)
    {
        Merge m = {.tree = b->tree, .in = sm_alloc((size_t)b->tree->nodes, 1)};
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member.blocks; block++)
            for (long j = oct_lists_from(block); j < oct_lists_to(&member, block); j++)
                merge_region(b, &m, added, j, &member);
        free(m.in);
        free(m.list);
    }
    free(b->regions->first);
    free(b->regions->member);
    oct_lists_pack(&member, &b->regions->first, &b->regions->member);
}

static void make_symmetric(const Build *b, OctLists *doubtful)
{
    Added added;
#pragma omp parallel for schedule(dynamic) if (b->tree->leaves > SERIAL)
    for (long block = 0; block < doubtful->blocks; block++)
        for (long i = oct_lists_from(block); i < oct_lists_to(doubtful, block); i++)
            keep_missing(b, i, oct_lists_item(doubtful, i), doubtful->count + i);
    turn_round(b, doubtful, &added);
    if (added.first[b->tree->leaves] > 0) merge_regions(b, &added);
    free(added.first);
    free(added.leaf);
}

static void measure(const Build *b)
{
    OctRegions *r = b->regions;
    for (long i = 0; i < r->leaves; i++) {
        long members = r->first[i + 1] - r->first[i];
        if (members > r->most) r->most = members;
        if (r->width[i] > r->most_width) r->most_width = r->width[i];
        r->mean_width += (double)r->width[i] / (double)r->leaves;
        for (long n = r->first[i]; n < r->first[i + 1]; n++) r->size[i] += b->below[r->member[n]];
    }
    r->mean = r->leaves ? (double)r->first[r->leaves] / (double)r->leaves : 0;
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
    regions->leaves = tree->leaves;
    regions->width = sm_alloc((size_t)tree->leaves, sizeof *regions->width);
    regions->size = sm_alloc((size_t)tree->leaves, sizeof *regions->size);
    Build b = {tree, graph, w, epsilon, oct_interval_below(tree), regions};
    OctLists doubtful;
    oct_lists_init(&doubtful, tree->leaves);
    find_regions(&b, &doubtful);
    make_symmetric(&b, &doubtful);
    oct_lists_free(&doubtful);
    measure(&b);
    free(b.below);
    return SM_OK;
}

void oct_regions_free(OctRegions *regions)
{
    free(regions->first);
    free(regions->member);
    free(regions->width);
    free(regions->size);
    memset(regions, 0, sizeof *regions);
}

size_t oct_regions_bytes(const OctRegions *regions)
{
    return sizeof *regions + ((size_t)regions->leaves + 1) * sizeof *regions->first +
           (size_t)regions->leaves * (sizeof *regions->width + sizeof *regions->size) +
           (size_t)regions->first[regions->leaves] * sizeof *regions->member;
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
    for (long n = regions->first[i]; n < regions->first[i + 1]; n++)
        leaf = leaves_below(tree, regions->member[n], leaf);
}
