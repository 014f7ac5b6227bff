#include "collide_clusters.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

enum { BITS = 21 }; /* of a cube's coordinate */

/* Bits of a coordinate with two others' places between them: x, y, z in turn make the Morton
 * curve. */
static uint64_t apart(uint64_t bits)
{
    bits = (bits | bits << 32) & 0x1f00000000ffff;
    bits = (bits | bits << 16) & 0x1f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/* A node and the cube that it is in. */
typedef struct {
    uint64_t cube;
    int node;
} Place;

static int compare(const void *a, const void *b)
{
    const Place *x = a, *y = b;
    if (x->cube != y->cube) return x->cube < y->cube ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

static Place *sort_nodes(const SmCollideRest *rest, double width)
{
    Place *place = sm_alloc((size_t)rest->nodes, sizeof *place);
    for (long i = 0; i < rest->nodes; i++) {
        place[i].node = (int)i;
        for (int d = 0; d < 3; d++) {
            double at = floor(rest->x0[i][d] / width) + (1 << (BITS - 1));
            uint64_t cube = (uint64_t)fmin(fmax(at, 0), (1 << BITS) - 1);
            place[i].cube |= apart(cube) << d;
        }
    }
    qsort(place, (size_t)rest->nodes, sizeof *place, compare);
    return place;
}

/* Gives the nodes of a cube that hang together with its node `root` to a new cluster. `cube` is
 * [nodes]. */
static void spread(const SmCollideRest *rest, const Place *place, long count, const int *cube,
                   int root, SmCollideClusters *c)
{
    int p = (int)c->count++;
    bool changed = true;
    c->of[root] = p;
    while (changed) {
        changed = false;
        for (long i = 0; i < count; i++) {
            int a = place[i].node;
            if (c->of[a] != p) continue;
            for (long e = rest->first[a]; e < rest->first[a + 1]; e++) {
                int b = rest->to[e], way = c->way[a] + rest->length[e];
                if (cube[b] != cube[a] || (c->of[b] == p && c->way[b] <= way)) continue;
                c->of[b] = p;
                c->way[b] = way;
                changed = true;
            }
        }
    }
}

static void split(const SmCollideRest *rest, double width, SmCollideClusters *c)
{
    Place *place = sort_nodes(rest, width);
    int *cube = sm_alloc((size_t)rest->nodes, sizeof *cube);
    for (long i = 1; i < rest->nodes; i++)
        cube[place[i].node] = cube[place[i - 1].node] + (place[i].cube != place[i - 1].cube);
    for (long i = 0, end; i < rest->nodes; i = end) {
        for (end = i; end < rest->nodes && place[end].cube == place[i].cube;) end++;
        for (long k = i; k < end; k++)
            if (c->of[place[k].node] < 0) spread(rest, place + i, end - i, cube, place[k].node, c);
    }
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
            c->low[p][d] = fmin(c->low[p][d], rest->x0[i][d]);
            c->high[p][d] = fmax(c->high[p][d], rest->x0[i][d]);
        }
    }
    for (size_t p = 0; p < count; p++) c->first[p + 1] += c->first[p];
    for (long i = rest->nodes; i-- > 0;) c->node[--c->first[c->of[i] + 1]] = (int)i;
    memmove(c->first, c->first + 1, count * sizeof *c->first);
    c->first[count] = rest->nodes;
}

static void list_arcs(const SmCollideRest *rest, SmCollideClusters *c)
{
    long room = 0, at = 0;
    int *best = sm_alloc((size_t)c->count, sizeof *best);
    for (long p = 0; p < c->count; p++) best[p] = INT_MAX;
    c->arc_first = sm_alloc((size_t)c->count + 1, sizeof *c->arc_first);
    for (long p = 0; p < c->count; p++) {
        for (long i = c->first[p]; i < c->first[p + 1]; i++) {
            int a = c->node[i];
            for (long e = rest->first[a]; e < rest->first[a + 1]; e++) {
                int b = rest->to[e], q = c->of[b], way = c->way[a] + rest->length[e] + c->way[b];
                if (q == p || way >= best[q]) continue;
                if (at == room) {
                    room = 2 * room + 256;
                    c->arc = sm_realloc(c->arc, (size_t)room, sizeof *c->arc);
                }
                if (best[q] == INT_MAX) c->arc[at++] = q;
                best[q] = way;
            }
        }
        c->length = sm_realloc(c->length, (size_t)room + 1, sizeof *c->length);
        for (long i = c->arc_first[p]; i < at; i++) {
            c->length[i] = best[c->arc[i]];
            best[c->arc[i]] = INT_MAX;
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
