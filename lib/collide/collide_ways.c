#include "collide_ways.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

void sm_collide_ways_start(SmCollideWays *ways, const SmCollideShape *shape)
{
    if (shape->nodes > ways->node_room) {
        void *all[] = {ways->distance, ways->queue, ways->queued, ways->reached};
        for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
        ways->node_room = shape->nodes + shape->nodes / 4;
        size_t room = (size_t)ways->node_room;
        ways->distance = sm_alloc(room, sizeof(int));
        ways->queue = sm_alloc(room, sizeof(int));
        ways->queued = sm_alloc(room, 1);
        ways->reached = sm_alloc(room, sizeof(int));
    }
    for (long i = 0; i < shape->nodes; i++) ways->distance[i] = INT32_MAX;
    if (ways->answers) memset(ways->answer, 0, (size_t)ways->room * sizeof *ways->answer);
    ways->answers = ways->reached_count = 0;
}

void sm_collide_ways_free(SmCollideWays *ways)
{
    void *all[] = {ways->answer, ways->distance, ways->queue, ways->queued, ways->reached};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *ways = (SmCollideWays){0};
}

long sm_collide_ways_bytes(const SmCollideWays *ways)
{
    return ways->node_room * (long)(3 * sizeof(int) + 1) + ways->room * (long)sizeof *ways->answer;
}

static double apart(const double a[3], const double b[3])
{
    double x = fabs(a[0] - b[0]), y = fabs(a[1] - b[1]), z = fabs(a[2] - b[2]);
    double most = x > y ? x : y;
    return most > z ? most : z;
}

/* A way in half cells that ends at a carrier of a cell. */
static double to_cell(const SmCollideShape *shape, const SmCollideCell *cell, int way)
{
    return 0.5 * way - (shape->carriers == 1 ? cell->edge / 2 : 0);
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

/* What one search needs. */
typedef struct {
    const SmCollideShape *shape;
    const SmCollideCell *cell;
    int from;
    double window;  /* ways lead through nodes that near */
    double most;    /* longest way to a carrier that counts, half cells */
    double nearest; /* cells by which a carrier may be nearer than the cell's centre */
} Search;

static bool carries(const Search *s, int node)
{
    for (int c = 0; c < s->shape->carriers; c++)
        if (s->cell->carrier[c] == node) return true;
    return false;
}

/* Whether the way to a node is part of one that may be short enough. */
static bool leads(const Search *s, int node, int way)
{
    const double(*x)[3] = s->shape->rest.x0;
    return way + 2 * (apart(x[node], s->cell->centre) - s->nearest) <= s->most &&
           apart(x[s->from], x[node]) <= s->window;
}

static void forget(SmCollideWays *ways)
{
    for (long i = 0; i < ways->reached_count; i++) {
        ways->distance[ways->reached[i]] = INT32_MAX;
        ways->queued[ways->reached[i]] = 0;
    }
    ways->reached_count = 0;
}

/* Whether a way is short enough. Label-correcting search: whether there is one does not depend on
 * the order. */
static bool find_way(SmCollideWays *ways, const Search *s)
{
    const SmCollideRest *rest = &s->shape->rest;
    long head = 0, tail = 0, filled = 1;
    forget(ways);
    if (!leads(s, s->from, 0)) return false;
    ways->distance[s->from] = 0;
    ways->reached[ways->reached_count++] = ways->queue[tail++] = s->from;
    for (; filled; filled--) {
        int i = ways->queue[head];
        if (++head == rest->nodes) head = 0;
        ways->queued[i] = 0;
        for (long e = rest->first[i]; e < rest->first[i + 1]; e++) {
            int j = rest->to[e], d = ways->distance[i] + rest->length[e];
            if (d >= ways->distance[j] || !leads(s, j, d)) continue;
            if (carries(s, j)) return true;
            if (ways->distance[j] == INT32_MAX) ways->reached[ways->reached_count++] = j;
            ways->distance[j] = d;
            if (ways->queued[j]) continue;
            ways->queued[j] = 1;
            if (tail == rest->nodes) tail = 0;
            ways->queue[tail++] = j;
            filled++;
        }
    }
    return false;
}

/* Whether a node and a cell beside it, which it does not carry, may collide. */
static bool far_apart(SmCollideWays *ways, const SmCollideShape *shape, int node,
                      const SmCollideCell *cell)
{
    double window = sm_collide_apart(shape->size[node], shape->widest) + SM_COLLIDE_SLACK;
    double least = to_cell(shape, cell, 0);
    Search s = {.shape = shape,
                .cell = cell,
                .from = node,
                .window = window + shape->widest,
                .most = 2 * (longest(shape, node, cell) - least),
                .nearest = shape->carriers == 1 ? 0 : cell->edge / 2};
    return !find_way(ways, &s) && !touches(shape, node, cell);
}

/* Where the answer about a node and a cell (from 1) is in the table, or would be. */
static SmCollideAnswer *look_up(const SmCollideWays *ways, int node, int cell)
{
    uint64_t key = ((uint64_t)(uint32_t)node << 32 | (uint32_t)cell) * 0x9e3779b97f4a7c15u;
    long at = (long)(key >> 32) & (ways->room - 1);
    while (ways->answer[at].cell &&
           (ways->answer[at].cell != cell || ways->answer[at].node != node))
        at = (at + 1) & (ways->room - 1);
    return &ways->answer[at];
}

/* Makes room for another answer. */
static void make_room(SmCollideWays *ways)
{
    SmCollideAnswer *old = ways->answer;
    long room = ways->room;
    if (2 * (ways->answers + 1) <= room) return;
    ways->room = room ? 2 * room : 256;
    ways->answer = sm_alloc((size_t)ways->room, sizeof *ways->answer);
    for (long i = 0; i < room; i++)
        if (old[i].cell) *look_up(ways, old[i].node, old[i].cell) = old[i];
    free(old);
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
    SmCollideRelation known = sm_collide_relation(shape, node, c);
    if (known != SM_COLLIDE_UNKNOWN) return known == SM_COLLIDE_MAY;
    make_room(ways);
    SmCollideAnswer *answer = look_up(ways, node, (int)c + 1);
    if (!answer->cell) {
        *answer =
            (SmCollideAnswer){node, (int)c + 1, far_apart(ways, shape, node, &shape->cell[c])};
        ways->answers++;
    }
    return answer->may;
}
