#include "collide_parts.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "../error.h"
#include "collide_clusters.h"

#define LOOSE 0.1 /* edges: how far a cell's axes reach beyond its bent corners */

/* What tells whether two parts are joined. Sides are 2 d + 1 up along axis d, 2 d down. */
typedef struct {
    double node_reach[SM_COLLIDE_FACES]; /* of its nodes, less the size that keeps cells apart */
    double cell_reach[SM_COLLIDE_FACES]; /* of its cells' centres, less their edge's share of it; of
                                            the side across from each */
    double least_size, least_edge;
} Reach;

/* A part is cluster part_of^-1; those with nodes or cells come first. */
typedef struct {
    const SmCollideShape *shape;
    SmCollideParts *parts;
    SmCollideClusters clusters;
    int *part;     /* [clusters] -1: none */
    int *cluster;  /* [parts] rising */
    Reach *reach;  /* [parts] */
    double window; /* least distance in which ways lead from any node (collide_ways.c) */
    int *way;      /* [clusters] shortest that was found, or INT_MAX */
    int *met;      /* [met_count] whose it is */
    long met_count;
    int (*pair)[2]; /* [pair_count] joined, by rising first one */
    long pair_count, pair_room;
} Build;

/* Parts are clusters that have surface nodes or cells. */
static void number_parts(Build *b)
{
    const SmCollideShape *shape = b->shape;
    size_t clusters = (size_t)b->clusters.count;
    b->part = sm_alloc(clusters, sizeof(int));
    b->cluster = sm_alloc(clusters, sizeof(int));
    for (long i = 0; i < shape->surface_count; i++) b->part[b->clusters.of[shape->surface[i]]] = 1;
    for (long k = 0; k < shape->cell_count; k++)
        b->part[b->clusters.of[shape->cell[k].carrier[0]]] = 1;
    for (long c = 0; c < b->clusters.count; c++) {
        bool any = b->part[c];
        b->part[c] = any ? (int)b->parts->count : -1;
        if (any) b->cluster[b->parts->count++] = (int)c;
    }
}

static int part_of(const Build *b, int node)
{
    return b->part[b->clusters.of[node]];
}

/* Makes counts, in first[p + 1], the ends that lists get when they are filled from the back. */
static void add_up(long *first, long count)
{
    for (long p = 0; p < count; p++) first[p + 1] += first[p];
}

static void list_members(Build *b)
{
    const SmCollideShape *shape = b->shape;
    SmCollideParts *parts = b->parts;
    size_t count = (size_t)parts->count;
    parts->cell_first = sm_alloc(count + 2, sizeof(long));
    parts->node_first = sm_alloc(count + 2, sizeof(long));
    parts->cell = sm_alloc((size_t)shape->cell_count, sizeof(int));
    parts->node = sm_alloc((size_t)shape->surface_count, sizeof(int));
    for (long k = 0; k < shape->cell_count; k++)
        parts->cell_first[part_of(b, shape->cell[k].carrier[0]) + 2]++;
    for (long i = 0; i < shape->surface_count; i++)
        parts->node_first[part_of(b, shape->surface[i]) + 2]++;
    add_up(parts->cell_first + 1, parts->count);
    add_up(parts->node_first + 1, parts->count);
    for (long k = 0; k < shape->cell_count; k++)
        parts->cell[parts->cell_first[part_of(b, shape->cell[k].carrier[0]) + 1]++] = (int)k;
    for (long i = 0; i < shape->surface_count; i++)
        parts->node[parts->node_first[part_of(b, shape->surface[i]) + 1]++] = shape->surface[i];
}

/* In place of fmin() and fmax(), which are calls. */
static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Carriers of the cells, and the surface nodes. */
static void list_carriers(Build *b)
{
    const SmCollideShape *shape = b->shape;
    SmCollideParts *parts = b->parts;
    size_t most = (size_t)(shape->cell_count * shape->carriers + shape->surface_count);
    long *seen = sm_alloc((size_t)shape->nodes, sizeof *seen), at = 0; /* last part, from 1 */
    parts->carrier = sm_alloc(most, sizeof *parts->carrier);
    parts->carrier_first = sm_alloc((size_t)parts->count + 1, sizeof(long));
    parts->margin = sm_alloc((size_t)parts->count, sizeof *parts->margin);
    for (long p = 0; p < parts->count; p++) {
        for (long i = parts->cell_first[p]; i < parts->cell_first[p + 1]; i++) {
            const SmCollideCell *cell = &shape->cell[parts->cell[i]];
            double out = shape->carriers == 1 ? sqrt(0.75) : LOOSE;
            parts->margin[p] = larger(parts->margin[p], out * cell->edge);
            for (int c = 0; c < shape->carriers; c++) {
                if (seen[cell->carrier[c]] == p + 1) continue;
                seen[cell->carrier[c]] = p + 1;
                parts->carrier[at++] = cell->carrier[c];
            }
        }
        for (long i = parts->node_first[p]; i < parts->node_first[p + 1]; i++) {
            parts->margin[p] = larger(parts->margin[p], shape->radius[parts->node[i]]);
            if (seen[parts->node[i]] != p + 1) parts->carrier[at++] = parts->node[i];
        }
        parts->loosest = larger(parts->loosest, parts->margin[p]);
        parts->carrier_first[p + 1] = at;
    }
    free(seen);
}

void sm_collide_parts_box(const SmCollideParts *parts, const double (*x)[3], long p, double low[3],
                          double high[3])
{
    for (int d = 0; d < 3; d++) {
        low[d] = INFINITY;
        high[d] = -INFINITY;
    }
    for (long i = parts->carrier_first[p]; i < parts->carrier_first[p + 1]; i++) {
        const double *at = x[parts->carrier[i]];
        for (int d = 0; d < 3; d++) {
            low[d] = at[d] < low[d] ? at[d] : low[d];
            high[d] = at[d] > high[d] ? at[d] : high[d];
        }
    }
    for (int d = 0; d < 3; d++) {
        low[d] -= parts->margin[p];
        high[d] += parts->margin[p];
    }
}

bool sm_collide_parts_joined(const SmCollideParts *parts, long a, long b)
{
    long low = parts->joined_first[a], high = parts->joined_first[a + 1], end = high;
    while (low < high) {
        long middle = (low + high) / 2;
        if (parts->joined[middle] < b)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && parts->joined[low] == b;
}

/* All nodes of part a are beside all cells of part b where the nodes reach no farther beyond the
 * cells on any side: of |x - c| - edge / 2 - apart, the node's and the cell's shares (sizes and
 * edges in sm_collide_apart()) have their largest values apart from each other. */
static void find_reach(Build *b, long p)
{
    const SmCollideShape *shape = b->shape;
    const SmCollideParts *parts = b->parts;
    Reach *reach = &b->reach[p];
    double of_size = sm_collide_apart(1, 0), of_edge = sm_collide_apart(0, 1) + 0.5;
    reach->least_size = reach->least_edge = INFINITY;
    for (int s = 0; s < SM_COLLIDE_FACES; s++)
        reach->node_reach[s] = reach->cell_reach[s] = -INFINITY;
    for (long i = parts->node_first[p]; i < parts->node_first[p + 1]; i++) {
        const double *x = shape->x0[parts->node[i]], size = shape->size[parts->node[i]];
        reach->least_size = smaller(reach->least_size, size);
        for (int s = 0; s < SM_COLLIDE_FACES; s++)
            reach->node_reach[s] =
                larger(reach->node_reach[s], (s % 2 ? 1 : -1) * x[s / 2] - of_size * size);
    }
    for (long i = parts->cell_first[p]; i < parts->cell_first[p + 1]; i++) {
        const SmCollideCell *cell = &shape->cell[parts->cell[i]];
        reach->least_edge = smaller(reach->least_edge, cell->edge);
        for (int s = 0; s < SM_COLLIDE_FACES; s++)
            reach->cell_reach[s] =
                larger(reach->cell_reach[s],
                       (s % 2 ? -1 : 1) * cell->centre[s / 2] - of_edge * cell->edge);
    }
}

/* Whether no node of a collides with a cell of b when no way between them is longer than `way`. */
static int held(const Reach *a, const Reach *b, double way)
{
    bool out = !(way <= SM_COLLIDE_AROUND * sm_collide_apart(a->least_size, b->least_edge));
    for (int s = 0; s < SM_COLLIDE_FACES; s++)
        out |= !(a->node_reach[s] + b->cell_reach[s] <= SM_COLLIDE_SLACK);
    return !out;
}

/* Whether the nodes of two clusters are in the window around each other's nodes. */
static int in_window(const Build *b, long p, long q)
{
    const SmCollideClusters *c = &b->clusters;
    bool out = false;
    for (int d = 0; d < 3; d++)
        out |= c->high[q][d] - c->low[p][d] > b->window || c->high[p][d] - c->low[q][d] > b->window;
    return !out;
}

/* Leaves out the arcs that lead out of the window. */
static void keep_arcs(Build *b)
{
    SmCollideClusters *c = &b->clusters;
    long at = 0;
    for (long p = 0, e = 0; p < c->count; p++) {
        for (; e < c->arc_first[p + 1]; e++) {
            if (!in_window(b, p, c->arc[e])) continue;
            c->arc[at] = c->arc[e];
            c->length[at++] = c->length[e];
        }
        c->arc_first[p + 1] = at;
    }
}

/* A way to a cluster; `met`, with room for one more, grows where it is the first. Without a branch:
 * whether it is follows no pattern. */
static inline long meet(int *restrict way, int *restrict met, long count, int cluster, int length)
{
    int was = way[cluster];
    met[count] = cluster;
    way[cluster] = length < was ? length : was;
    return count + (was == INT_MAX);
}

/* Ways from a cluster over at most two arcs. */
static void find_ways(Build *b, int own)
{
    const SmCollideClusters *c = &b->clusters;
    int *restrict way = b->way, *restrict met = b->met;
    const int *restrict arc = c->arc, *restrict length = c->length;
    for (long i = 0; i < b->met_count; i++) way[met[i]] = INT_MAX;
    long count = meet(way, met, 0, own, 0);
    for (long e = c->arc_first[own]; e < c->arc_first[own + 1]; e++) {
        long from = c->arc_first[arc[e]], end = c->arc_first[arc[e] + 1];
        count = meet(way, met, count, arc[e], length[e]);
        for (long f = from; f < end; f++)
            count = meet(way, met, count, arc[f], length[e] + length[f]);
    }
    b->met_count = count;
}

/* Adds the pairs of part p with itself and later ones. */
static void find_joined(Build *b, int p)
{
    const SmCollideClusters *c = &b->clusters;
    int own = b->cluster[p];
    find_ways(b, own);
    for (long i = 0; i < b->met_count; i++) {
        int other = b->met[i], q = b->part[other];
        if (q < p) continue;
        const Reach *a = &b->reach[p], *z = &b->reach[q];
        double way = 0.5 * ((double)b->way[other] + c->radius[own] + c->radius[other]);
        /* '&': all three are cheap, and which fails cannot be foreseen */
        if (!(held(a, z, way) & held(z, a, way) & in_window(b, own, other))) continue;
        if (b->pair_count == b->pair_room) {
            b->pair_room = 2 * b->pair_room + 1024;
            b->pair = sm_realloc(b->pair, (size_t)b->pair_room, sizeof *b->pair);
        }
        b->pair[b->pair_count][0] = p;
        b->pair[b->pair_count++][1] = q;
    }
}

/* Lists the other one of every pair with both: first, by rising first one, those that come before
 * a part, then, by rising second one, those after it. */
static void list_pairs(Build *b)
{
    SmCollideParts *parts = b->parts;
    size_t count = (size_t)parts->count;
    long *first = parts->joined_first = sm_alloc(count + 2, sizeof *first);
    long *at = sm_alloc(count + 1, sizeof *at);
    for (long i = 0; i < b->pair_count; i++) {
        first[b->pair[i][1] + 1]++;
        if (b->pair[i][0] != b->pair[i][1]) first[b->pair[i][0] + 1]++;
    }
    add_up(first, parts->count);
    parts->joined = sm_alloc((size_t)first[count], sizeof *parts->joined);
    for (size_t p = 0; p < count; p++) at[p] = first[p];
    for (long i = 0; i < b->pair_count; i++) parts->joined[at[b->pair[i][1]]++] = b->pair[i][0];
    for (long q = 0; q < parts->count; q++) {
        long end = at[q]; /* only then come later ones */
        for (long i = first[q]; i < end && parts->joined[i] < q; i++)
            parts->joined[at[parts->joined[i]]++] = (int)q;
    }
    free(at);
}

static void list_joined(Build *b)
{
    long parts = b->parts->count, clusters = b->clusters.count;
    double least = INFINITY;
    b->reach = sm_alloc((size_t)parts, sizeof *b->reach);
    b->way = sm_alloc((size_t)clusters, sizeof(int));
    b->met = sm_alloc((size_t)clusters + 1, sizeof(int));
    for (long c = 0; c < clusters; c++) b->way[c] = INT_MAX;
    for (long p = 0; p < parts; p++) {
        find_reach(b, p);
        least = smaller(least, b->reach[p].least_size);
    }
    b->window = sm_collide_apart(least, b->shape->widest) + b->shape->widest;
    keep_arcs(b);
    for (long p = 0; p < parts; p++) find_joined(b, (int)p);
    list_pairs(b);
}

void sm_collide_parts_build(const SmCollideShape *shape, SmCollideParts *parts)
{
    Build b = {.shape = shape, .parts = parts};
    *parts = (SmCollideParts){.edge = shape->mean};
    sm_collide_clusters_build(&shape->rest, (shape->carriers == 1 ? 2 : 3) * shape->mean,
                              &b.clusters);
    number_parts(&b);
    list_members(&b);
    list_carriers(&b);
    list_joined(&b);
    sm_collide_clusters_free(&b.clusters);
    free(b.part);
    free(b.cluster);
    free(b.reach);
    free(b.way);
    free(b.met);
    free(b.pair);
}

void sm_collide_parts_free(SmCollideParts *parts)
{
    void *all[] = {parts->cell_first,   parts->node_first, parts->carrier_first,
                   parts->joined_first, parts->cell,       parts->node,
                   parts->carrier,      parts->joined,     parts->margin};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *parts = (SmCollideParts){0};
}

long sm_collide_parts_bytes(const SmCollideParts *parts)
{
    long n = parts->count;
    long ints = parts->cell_first[n] + parts->node_first[n] + parts->carrier_first[n] +
                parts->joined_first[n];
    return ints * (long)sizeof(int) + n * (long)(4 * sizeof(long) + sizeof(double));
}
