#include "collide_ways.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

void sm_collide_ways_start(SmCollideWays *ways, const SmCollideShape *shape)
{
    size_t nodes = (size_t)shape->nodes;
    if (shape->nodes > ways->node_room) {
        void *all[] = {ways->row, ways->distance, ways->queue, ways->queued, ways->reached};
        for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
        ways->node_room = shape->nodes + shape->nodes / 4;
        size_t room = (size_t)ways->node_room;
        ways->row = sm_alloc(room, sizeof(int));
        ways->distance = sm_alloc(room, sizeof(int));
        ways->queue = sm_alloc(room, sizeof(int));
        ways->queued = sm_alloc(room, 1);
        ways->reached = sm_alloc(room, sizeof(int));
    }
    memset(ways->row, 0, nodes * sizeof(int));
    for (size_t i = 0; i < nodes; i++) ways->distance[i] = INT32_MAX;
    ways->rows = ways->reached_count = 0;
    sm_collide_hash_start(&ways->hash, 0, 2 * shape->mean);
}

void sm_collide_ways_free(SmCollideWays *ways)
{
    void *all[] = {ways->row,   ways->first,  ways->far,    ways->distance,
                   ways->queue, ways->queued, ways->reached};
    sm_collide_hash_free(&ways->hash);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *ways = (SmCollideWays){0};
}

long sm_collide_ways_bytes(const SmCollideWays *ways)
{
    return ways->node_room * (long)(4 * sizeof(int) + 1) + ways->row_room * (long)sizeof(long) +
           ways->far_room * (long)sizeof(int) + sm_collide_hash_bytes(&ways->hash);
}

static bool within(const SmCollideRest *rest, int from, int to, double window)
{
    const double *a = rest->x0[from], *b = rest->x0[to];
    return fabs(a[0] - b[0]) <= window && fabs(a[1] - b[1]) <= window &&
           fabs(a[2] - b[2]) <= window;
}

/* Shortest ways from one node through nodes in the window around it. Label-correcting search: what
 * comes out does not depend on the order. */
static void find_ways(SmCollideWays *ways, const SmCollideRest *rest, int from, double window,
                      int most)
{
    long head = 0, tail = 0, filled = 1;
    for (long i = 0; i < ways->reached_count; i++) ways->distance[ways->reached[i]] = INT32_MAX;
    ways->distance[from] = 0;
    ways->reached[0] = ways->queue[tail++] = from;
    ways->reached_count = 1;
    for (; filled; filled--) {
        int i = ways->queue[head];
        if (++head == rest->nodes) head = 0;
        ways->queued[i] = 0;
        for (long e = rest->first[i]; e < rest->first[i + 1]; e++) {
            int j = rest->to[e], d = ways->distance[i] + rest->length[e];
            if (d > most || d >= ways->distance[j] || !within(rest, from, j, window)) continue;
            if (ways->distance[j] == INT32_MAX) ways->reached[ways->reached_count++] = j;
            ways->distance[j] = d;
            if (ways->queued[j]) continue;
            ways->queued[j] = 1;
            if (tail == rest->nodes) tail = 0;
            ways->queue[tail++] = j;
            filled++;
        }
    }
}

/* A way in half cells that ends at a carrier of a cell. */
static double to_cell(const SmCollideShape *shape, const SmCollideCell *cell, int way)
{
    return 0.5 * way - (shape->carriers == 1 ? cell->edge / 2 : 0);
}

/* Way from the node searched from to a cell, cells. */
static double way_to(const SmCollideWays *ways, const SmCollideShape *shape,
                     const SmCollideCell *cell)
{
    int least = INT32_MAX;
    for (int c = 0; c < shape->carriers; c++) {
        int d = ways->distance[cell->carrier[c]];
        if (d < least) least = d;
    }
    return least == INT32_MAX ? DBL_MAX : to_cell(shape, cell, least);
}

static bool touches(const SmCollideShape *shape, int node, const SmCollideCell *cell)
{
    double depth, out[3];
    return sm_collide_depth(shape, cell, shape->x0[node], shape->radius[node], &depth, out);
}

/* How long a way may be that holds a node and a cell together. */
static double longest(const SmCollideShape *shape, int node, const SmCollideCell *cell)
{
    return SM_COLLIDE_AROUND * (sm_collide_apart(shape->size[node], cell->edge) + SM_COLLIDE_SLACK);
}

static int compare(const void *a, const void *b)
{
    const int *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void hash_cells(SmCollideWays *ways, const SmCollideShape *shape)
{
    sm_collide_hash_start(&ways->hash, shape->cell_count, 2 * shape->mean);
    for (long k = 0; k < shape->cell_count; k++)
        sm_collide_hash_add(&ways->hash, k, shape->cell[k].centre);
    sm_collide_hash_finish(&ways->hash);
}

/* The row of a node, which is the next one. */
static void search(SmCollideWays *ways, const SmCollideShape *shape, int node)
{
    double most = sm_collide_apart(shape->size[node], shape->widest) + SM_COLLIDE_SLACK;
    double low[3], high[3], window = most + shape->widest, span = most + shape->widest / 2;
    long at = ways->first[ways->rows], first = at;
    if (!ways->hash.count) hash_cells(ways, shape);
    for (int d = 0; d < 3; d++) {
        low[d] = shape->x0[node][d] - span;
        high[d] = shape->x0[node][d] + span;
    }
    find_ways(ways, &shape->rest, node, window,
              (int)(2 * (SM_COLLIDE_AROUND * most + shape->widest)) + 1);
    const SmCollideEntry *entry;
    SmCollideQuery query;
    for (sm_collide_hash_query(&ways->hash, low, high, &query);
         (entry = sm_collide_hash_next(&ways->hash, &query));) {
        const SmCollideCell *cell = &shape->cell[entry->item];
        if (!sm_collide_beside(shape, node, cell) ||
            way_to(ways, shape, cell) <= longest(shape, node, cell) || touches(shape, node, cell))
            continue;
        if (at == ways->far_room) {
            ways->far_room = 2 * ways->far_room + 256;
            ways->far = sm_realloc(ways->far, (size_t)ways->far_room, sizeof(int));
        }
        ways->far[at++] = entry->item;
    }
    if (at > first) qsort(ways->far + first, (size_t)(at - first), sizeof(int), compare);
    ways->first[++ways->rows] = at;
}

SmCollideRelation sm_collide_relation(const SmCollideShape *shape, int node, long c)
{
    const SmCollideCell *cell = &shape->cell[c];
    const SmCollideRest *rest = &shape->rest;
    if (!sm_collide_beside(shape, node, cell)) return SM_COLLIDE_MAY;
    for (int i = 0; i < shape->carriers; i++)
        if (cell->carrier[i] == node) return SM_COLLIDE_MUST_NOT;
    for (long e = rest->first[node]; shape->carriers == 1 && e < rest->first[node + 1]; e++)
        if (rest->to[e] == cell->carrier[0] &&
            to_cell(shape, cell, rest->length[e]) <= longest(shape, node, cell))
            return SM_COLLIDE_MUST_NOT;
    return SM_COLLIDE_UNKNOWN;
}

bool sm_collide_may(SmCollideWays *ways, const SmCollideShape *shape, int node, long c)
{
    if (!sm_collide_beside(shape, node, &shape->cell[c])) return true;
    if (!ways->row[node]) {
        if (ways->rows + 2 > ways->row_room) {
            ways->row_room = 2 * ways->row_room + 64;
            ways->first = sm_realloc(ways->first, (size_t)ways->row_room, sizeof(long));
        }
        if (!ways->rows) ways->first[0] = 0;
        search(ways, shape, node);
        ways->row[node] = (int)ways->rows;
    }
    long low = ways->first[ways->row[node] - 1], end = ways->first[ways->row[node]], high = end;
    while (low < high) {
        long middle = (low + high) / 2;
        if (ways->far[middle] < c)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && ways->far[low] == c;
}
