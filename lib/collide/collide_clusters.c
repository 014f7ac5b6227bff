#include "collide_clusters.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../voxel/morton.h"

enum {
    BITS = 21,        /* of a cube's coordinate */
    FAR = INT_MAX / 2 /* a way that has not been found */
};

/* A node and the cube that it is in. */
typedef struct {
    uint64_t cube;
    int node;
} Place;

/* Sorts by cubes, and leaves nodes of one in their order: by one byte after the other, the lowest
 * first, but for those that are the same in all. */
static Place *sort_places(Place *place, long count)
{
    Place *other = sm_alloc((size_t)count, sizeof *other);
    uint64_t differ = 0;
    for (long i = 0; i < count; i++) differ |= place[i].cube ^ place[0].cube;
    for (int shift = 0; shift < 64; shift += 8) {
        long start[257] = {0};
        if (!(differ >> shift & 255)) continue;
        for (long i = 0; i < count; i++) start[(place[i].cube >> shift & 255) + 1]++;
        for (int k = 0; k < 256; k++) start[k + 1] += start[k];
        for (long i = 0; i < count; i++) other[start[place[i].cube >> shift & 255]++] = place[i];
        Place *sorted = other;
        other = place;
        place = sorted;
    }
    free(other);
    return place;
}

static Place *sort_nodes(const SmCollideRest *rest, double width)
{
    Place *place = sm_alloc((size_t)rest->nodes, sizeof *place);
    for (long i = 0; i < rest->nodes; i++) {
        place[i].node = (int)i;
        for (int d = 0; d < 3; d++) {
            double at = floor(rest->x0[i][d] / width) + (1 << (BITS - 1));
            at = at < 0 ? 0 : at;
            uint64_t cube = (uint64_t)(at < (1 << BITS) - 1 ? at : (1 << BITS) - 1);
            place[i].cube |= sm_morton_apart(cube) << d;
        }
    }
    return sort_places(place, rest->nodes);
}

/* An edge between nodes of one cube. */
typedef struct {
    int from, to, length;
} Link;

/* Gives the nodes of a cube that its links join to its node `root` to a new cluster; ways of nodes
 * in none are FAR. Branches would cost more than they spare, here as below: what they depend on
 * follows no pattern. */
static void spread(const Place *place, long count, const Link *link, long links, int root,
                   SmCollideClusters *c)
{
    int p = (int)c->count++, changed = 1, *restrict best = c->way;
    best[root] = 0;
    while (changed) {
        changed = 0;
        for (long i = 0; i < links; i++) {
            int was = best[link[i].to], way = best[link[i].from] + link[i].length;
            changed |= way < was;
            best[link[i].to] = way < was ? way : was;
        }
    }
    for (long i = 0; i < count; i++)
        if (c->of[place[i].node] < 0 && c->way[place[i].node] < FAR) c->of[place[i].node] = p;
}

/* Links of the nodes of one cube; `cube` is [nodes]. There is room for one more. */
static long list_links(const SmCollideRest *rest, const Place *place, long count, const int *cube,
                       Link *restrict link)
{
    const int *restrict to = rest->to, *restrict length = rest->length;
    long links = 0;
    for (long i = 0; i < count; i++) {
        int a = place[i].node, own = cube[a];
        for (long e = rest->first[a], end = rest->first[a + 1]; e < end; e++) {
            link[links].from = a;
            link[links].to = to[e];
            link[links].length = length[e];
            links += cube[to[e]] == own;
        }
    }
    return links;
}

static void split(const SmCollideRest *rest, double width, SmCollideClusters *c)
{
    Place *place = sort_nodes(rest, width);
    int *cube = sm_alloc((size_t)rest->nodes, sizeof *cube);
    long room = 256;
    Link *link = sm_alloc((size_t)room, sizeof *link);
    for (long i = 1; i < rest->nodes; i++)
        cube[place[i].node] = cube[place[i - 1].node] + (place[i].cube != place[i - 1].cube);
    for (long i = 0, end; i < rest->nodes; i = end) {
        long most = 0;
        for (end = i; end < rest->nodes && place[end].cube == place[i].cube; end++)
            most += rest->first[place[end].node + 1] - rest->first[place[end].node];
        if (most >= room) {
            room = 2 * most;
            link = sm_realloc(link, (size_t)room, sizeof *link);
        }
        long links = list_links(rest, place + i, end - i, cube, link);
        for (long k = i; k < end; k++)
            if (c->of[place[k].node] < 0) spread(place + i, end - i, link, links, place[k].node, c);
    }
    free(link);
    free(cube);
    free(place);
}

static void list_nodes(const SmCollideRest *rest, SmCollideClusters *c)
{
    size_t count = (size_t)c->count;
    c->first = sm_alloc(count + 1, sizeof *c->first);
    c->node = sm_alloc((size_t)rest->nodes, sizeof *c->node);
    c->radius = sm_alloc(count, sizeof *c->radius);
    c->low = sm_alloc(count, sizeof *c->low);
    c->high = sm_alloc(count, sizeof *c->high);
    for (long p = 0; p < c->count; p++)
        for (int d = 0; d < 3; d++) {
            c->low[p][d] = INFINITY;
            c->high[p][d] = -INFINITY;
        }
    for (long i = 0; i < rest->nodes; i++) {
        int p = c->of[i];
        c->first[p + 1]++;
        if (c->way[i] > c->radius[p]) c->radius[p] = c->way[i];
        for (int d = 0; d < 3; d++) {
            double at = rest->x0[i][d];
            c->low[p][d] = at < c->low[p][d] ? at : c->low[p][d];
            c->high[p][d] = at > c->high[p][d] ? at : c->high[p][d];
        }
    }
    for (size_t p = 0; p < count; p++) c->first[p + 1] += c->first[p];
    for (long i = rest->nodes; i-- > 0;) c->node[--c->first[c->of[i] + 1]] = (int)i;
    memmove(c->first, c->first + 1, count * sizeof *c->first);
    c->first[count] = rest->nodes;
}

/* Notes the arcs from cluster p from arc[at] on, of which there is room for all; returns their end.
 * best[p] is less than any length. */
static long note_arcs(const SmCollideRest *rest, const SmCollideClusters *c, long p,
                      int *restrict best, int *restrict arc, long at)
{
    const int *restrict to = rest->to, *restrict length = rest->length;
    const int *restrict of = c->of, *restrict from_root = c->way;
    for (long i = c->first[p]; i < c->first[p + 1]; i++) {
        int a = c->node[i], own = from_root[a];
        for (long e = rest->first[a], end = rest->first[a + 1]; e < end; e++) {
            int q = of[to[e]], was = best[q], way = own + length[e] + from_root[to[e]];
            arc[at] = q;
            best[q] = way < was ? way : was;
            at += was == FAR;
        }
    }
    return at;
}

static void list_arcs(const SmCollideRest *rest, SmCollideClusters *c)
{
    long room = 0, at = 0;
    int *best = sm_alloc((size_t)c->count, sizeof *best);
    for (long p = 0; p < c->count; p++) best[p] = FAR;
    c->arc_first = sm_alloc((size_t)c->count + 1, sizeof *c->arc_first);
    for (long p = 0; p < c->count; p++) {
        if (at + c->count > room) {
            room = 2 * at + c->count;
            c->arc = sm_realloc(c->arc, (size_t)room + 1, sizeof *c->arc);
            c->length = sm_realloc(c->length, (size_t)room + 1, sizeof *c->length);
        }
        best[p] = -1;
        at = note_arcs(rest, c, p, best, c->arc, at);
        best[p] = FAR;
        for (long i = c->arc_first[p]; i < at; i++) {
            c->length[i] = best[c->arc[i]];
            best[c->arc[i]] = FAR;
        }
        c->arc_first[p + 1] = at;
    }
    free(best);
}

void sm_collide_clusters_build(const SmCollideRest *rest, double width, SmCollideClusters *c)
{
    *c = (SmCollideClusters){.of = sm_alloc((size_t)rest->nodes, sizeof(int)),
                             .way = sm_alloc((size_t)rest->nodes, sizeof(int))};
    memset(c->of, -1, (size_t)rest->nodes * sizeof(int));
    for (long i = 0; i < rest->nodes; i++) c->way[i] = FAR;
    split(rest, width, c);
    list_nodes(rest, c);
    list_arcs(rest, c);
}

void sm_collide_clusters_free(SmCollideClusters *c)
{
    void *all[] = {c->of,  c->way,  c->first,     c->node, c->radius,
                   c->low, c->high, c->arc_first, c->arc,  c->length};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *c = (SmCollideClusters){0};
}
