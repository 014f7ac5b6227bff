#include "collide_parts.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "collide_clusters.h"
#include "error.h"

#define LOOSE 0.1 /* edges: how far a cell's axes reach beyond its bent corners */

/* What tells whether two parts are joined. Sides are 2 d + 1 up along axis d, 2 d down. */
typedef struct {
    double node_reach[SM_COLLIDE_FACES]; /* of its nodes, less the size that keeps cells apart */
    double cell_reach[SM_COLLIDE_FACES]; /* of its cells' centres, less their edge's share of it */
    double least_size, least_edge;
} Reach;

/* A part is cluster part_of^-1; those with nodes or cells come first. */
typedef struct {
    const SmCollideShape *shape;
    SmCollideParts *parts;
    SmCollideClusters clusters;
    int *part;    /* [clusters] -1: none */
    int *cluster; /* [parts] */
    Reach *reach; /* [parts] */
    int *way;     /* [clusters] shortest that was found, or INT_MAX */
    int *met;     /* [met_count] whose it is */
    long met_count;
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
            parts->margin[p] = fmax(parts->margin[p], out * cell->edge);
            for (int c = 0; c < shape->carriers; c++) {
                if (seen[cell->carrier[c]] == p + 1) continue;
                seen[cell->carrier[c]] = p + 1;
                parts->carrier[at++] = cell->carrier[c];
            }
        }
        for (long i = parts->node_first[p]; i < parts->node_first[p + 1]; i++) {
            parts->margin[p] = fmax(parts->margin[p], shape->radius[parts->node[i]]);
            if (seen[parts->node[i]] != p + 1) parts->carrier[at++] = parts->node[i];
        }
        parts->loosest = fmax(parts->loosest, parts->margin[p]);
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
        int node = parts->node[i];
        reach->least_size = fmin(reach->least_size, shape->size[node]);
        for (int s = 0; s < SM_COLLIDE_FACES; s++)
            reach->node_reach[s] =
                fmax(reach->node_reach[s],
                     (s % 2 ? 1 : -1) * shape->x0[node][s / 2] - of_size * shape->size[node]);
    }
    for (long i = parts->cell_first[p]; i < parts->cell_first[p + 1]; i++) {
        const SmCollideCell *cell = &shape->cell[parts->cell[i]];
        reach->least_edge = fmin(reach->least_edge, cell->edge);
        for (int s = 0; s < SM_COLLIDE_FACES; s++)
            reach->cell_reach[s] =
                fmax(reach->cell_reach[s],
                     (s % 2 ? 1 : -1) * cell->centre[s / 2] - of_edge * cell->edge);
    }
}

/* Whether no node of a collides with a cell of b when no way between them is longer than `way`. */
static bool held(const Build *b, long p, long q, double way)
{
    const Reach *a = &b->reach[p], *c = &b->reach[q];
    if (!(way <= SM_COLLIDE_AROUND * sm_collide_apart(a->least_size, c->least_edge))) return false;
    for (int s = 0; s < SM_COLLIDE_FACES; s++)
        if (!(a->node_reach[s] + c->cell_reach[s ^ 1] <= SM_COLLIDE_SLACK)) return false;
    return true;
}

/* Whether the nodes of cluster q are in the window around every node of part p that ways from there
 * lead through (collide_ways.c). */
static bool in_window(const Build *b, long p, long q)
{
    const SmCollideClusters *c = &b->clusters;
    long own = b->cluster[p];
    double widest = b->shape->widest;
    double window = sm_collide_apart(b->reach[p].least_size, widest) + widest;
    for (int d = 0; d < 3; d++)
        if (c->high[q][d] - c->low[own][d] > window || c->high[own][d] - c->low[q][d] > window)
            return false;
    return true;
}

static void meet(Build *b, int cluster, int way)
{
    if (b->way[cluster] == INT_MAX) b->met[b->met_count++] = cluster;
    if (way < b->way[cluster]) b->way[cluster] = way;
}

/* Ways from part p over at most two arcs. */
static void find_ways(Build *b, long p)
{
    const SmCollideClusters *c = &b->clusters;
    int own = b->cluster[p];
    for (long i = 0; i < b->met_count; i++) b->way[b->met[i]] = INT_MAX;
    b->met_count = 0;
    meet(b, own, 0);
    for (long e = c->arc_first[own]; e < c->arc_first[own + 1]; e++) {
        int over = c->arc[e];
        if (!in_window(b, p, over)) continue;
        meet(b, over, c->length[e]);
        for (long f = c->arc_first[over]; f < c->arc_first[over + 1]; f++)
            meet(b, c->arc[f], c->length[e] + c->length[f]);
    }
}

/* Parts that p is joined to one way: nodes of p, cells of the other. Fills `list`. */
static long list_held(Build *b, long p, int *list)
{
    const SmCollideClusters *c = &b->clusters;
    long count = 0;
    find_ways(b, p);
    for (long i = 0; i < b->met_count; i++) {
        int cluster = b->met[i], q = b->part[cluster];
        double way =
            0.5 * ((double)b->way[cluster] + c->radius[b->cluster[p]] + c->radius[cluster]);
        if (q >= 0 && in_window(b, p, cluster) && held(b, p, q, way)) list[count++] = q;
    }
    return count;
}

/* Keeps of the lists what is held both ways. */
static void keep_mutual(SmCollideParts *parts)
{
    long total = parts->joined_first[parts->count], at = 0;
    long *first = sm_alloc((size_t)parts->count + 2, sizeof *first);
    int *back = sm_alloc((size_t)total, sizeof *back);
    int *mark = sm_alloc((size_t)parts->count, sizeof *mark);
    for (long i = 0; i < total; i++) first[parts->joined[i] + 2]++;
    add_up(first + 1, parts->count);
    for (long p = 0; p < parts->count; p++)
        for (long i = parts->joined_first[p]; i < parts->joined_first[p + 1]; i++)
            back[first[parts->joined[i] + 1]++] = (int)p;
    for (long p = 0, i = 0; p < parts->count; p++) {
        for (; i < parts->joined_first[p + 1]; i++) mark[parts->joined[i]] = (int)p + 1;
        parts->joined_first[p] = at;
        for (long k = first[p]; k < first[p + 1]; k++)
            if (mark[back[k]] == p + 1) parts->joined[at++] = back[k];
    }
    parts->joined_first[parts->count] = at;
    free(first);
    free(back);
    free(mark);
}

static void list_joined(Build *b)
{
    SmCollideParts *parts = b->parts;
    long at = 0, room = 0;
    b->reach = sm_alloc((size_t)parts->count, sizeof *b->reach);
    b->way = sm_alloc((size_t)b->clusters.count, sizeof(int));
    b->met = sm_alloc((size_t)b->clusters.count, sizeof(int));
    for (long c = 0; c < b->clusters.count; c++) b->way[c] = INT_MAX;
    for (long p = 0; p < parts->count; p++) find_reach(b, p);
    parts->joined_first = sm_alloc((size_t)parts->count + 1, sizeof(long));
    for (long p = 0; p < parts->count; p++) {
        if (room < at + parts->count) {
            room = 2 * at + parts->count;
            parts->joined = sm_realloc(parts->joined, (size_t)room, sizeof(int));
        }
        parts->joined_first[p + 1] = at += list_held(b, p, parts->joined + at);
    }
    keep_mutual(parts);
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
