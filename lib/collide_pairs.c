#include "collide_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "collide.h"
#include "error.h"
#include "vector.h"

void sm_collide_pairs_init(SmCollidePairs *w, const SmCollideParts *parts,
                           const SmCollideParams *params, long bodies)
{
    long all = bodies * parts->count;
    *w = (SmCollidePairs){.params = *params, .bodies = bodies, .parts = parts->count, .all = all};
    w->centre = sm_alloc((size_t)all, sizeof *w->centre);
    w->radius = sm_alloc((size_t)all, sizeof *w->radius);
    w->noted = sm_alloc((size_t)all, sizeof *w->noted);
    w->noted_radius = sm_alloc((size_t)all, sizeof *w->noted_radius);
    w->start = sm_alloc((size_t)all + 1, sizeof *w->start);
    w->close = sm_alloc((size_t)all, 1);
    w->part = sm_alloc((size_t)all, sizeof *w->part);
    w->mark = sm_alloc((size_t)parts->count, sizeof *w->mark);
    sm_collide_sweep_init(&w->sweep, bodies);
}

void sm_collide_pairs_free(SmCollidePairs *w)
{
    void *all[] = {w->pair, w->part,   w->centre, w->radius, w->noted, w->noted_radius,
                   w->near, w->sorted, w->start,  w->close,  w->mark};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    sm_collide_hash_free(&w->balls);
    sm_collide_sweep_free(&w->sweep);
    *w = (SmCollidePairs){0};
}

long sm_collide_pairs_bytes(const SmCollidePairs *w)
{
    return w->all * (long)(8 * sizeof(double) + 2 * sizeof(int) + 1) +
           w->parts * (long)sizeof(int) + (2 * w->near_room + w->room) * (long)sizeof *w->pair +
           sm_collide_hash_bytes(&w->balls);
}

/* Balls of the parts that can touch anything, which go into the hash; returns the largest radius.
 */
static double find_balls(SmCollidePairs *w, const SmCollideShape *shape,
                         const SmCollideParts *parts, const double (*x)[3])
{
    double largest = 0, most = SM_COLLIDE_LONGEST * parts->widest;
    if (w->params.bodies)
        sm_collide_sweep(&w->sweep, x, shape->nodes, parts->loosest + shape->thickest);
    sm_collide_hash_start(&w->balls, w->bodies * parts->count, 3 * shape->mean);
    for (long b = 0; b < w->bodies; b++) {
        if (!w->params.self && w->sweep.first[b] == w->sweep.first[b + 1]) continue;
        for (long p = 0; p < parts->count; p++) {
            long part = b * parts->count + p;
            double low[3], high[3], *centre = w->centre[part];
            double radius = sm_collide_parts_ball(parts, x + b * shape->nodes, p, centre);
            radius = radius < most ? radius : most;
            for (int d = 0; d < 3; d++) {
                low[d] = centre[d] - radius;
                high[d] = centre[d] + radius;
            }
            if (!w->params.self && !sm_collide_sweep_meets(&w->sweep, b, low, high)) continue;
            sm_collide_hash_add(&w->balls, part, centre);
            w->radius[part] = radius;
            largest = fmax(largest, radius);
        }
    }
    return largest;
}

/* Marks the parts that part p cannot collide with. */
static void mark_joined(SmCollidePairs *w, const SmCollideParts *parts, long p)
{
    for (long i = parts->joined_first[p]; i < parts->joined_first[p + 1]; i++)
        w->mark[parts->joined[i]] = (int)p + 1;
}

static void add_pair(int (**pair)[2], long *count, long *room, int a, int b)
{
    if (*count == *room) {
        *room = 2 * *room + 64;
        *pair = sm_realloc(*pair, (size_t)*room, sizeof **pair);
    }
    (*pair)[*count][0] = a < b ? a : b;
    (*pair)[(*count)++][1] = a < b ? b : a;
}

/* Of two parts that both find each other, is it the second's turn? */
static bool later(const SmCollideEntry *a, const SmCollideEntry *b)
{
    return a->x[2] != b->x[2] ? a->x[2] > b->x[2] : a->item > b->item;
}

/* Balls of up to the usual size look for such; larger ones, of which a stretched body has some,
 * look for all. */
static void pair_up(SmCollidePairs *w, const SmCollideParts *parts, const SmCollideEntry *part,
                    double usual, double largest, double slack)
{
    double radius = w->radius[part->item], low[3], high[3];
    int first = part->item - part->item % (int)w->parts, own = part->item - first;
    bool large = radius > usual;
    for (int d = 0; d < 3; d++) {
        low[d] = part->x[d] - radius - slack - (large ? largest : usual);
        high[d] = part->x[d] + radius + slack + (large ? largest : usual);
    }
    if (!large) low[2] = part->x[2]; /* every pair once */
    if (w->params.self) mark_joined(w, parts, own);
    const SmCollideEntry *other;
    SmCollideQuery query;
    for (sm_collide_hash_query(&w->balls, low, high, &query);
         (other = sm_collide_hash_next(&w->balls, &query));) {
        bool same = other->item >= first && other->item - first < w->parts;
        if (same ? !w->params.self || w->mark[other->item - first] == own + 1 : !w->params.bodies)
            continue;
        double off[3], reach = radius + w->radius[other->item] + slack;
        bool other_large = w->radius[other->item] > usual;
        if (large != other_large ? other_large : later(part, other)) continue;
        for (int d = 0; d < 3; d++) off[d] = other->x[d] - part->x[d];
        if (sm_dot(off, off) <= reach * reach)
            add_pair(&w->near, &w->near_count, &w->near_room, part->item, other->item);
    }
}

/* Sorts pairs by one of their parts; those with the same one stay in order. */
static void sort_pairs(SmCollidePairs *w, int by)
{
    int(*other)[2] = w->near;
    memset(w->start, 0, ((size_t)w->all + 1) * sizeof *w->start);
    for (long i = 0; i < w->near_count; i++) w->start[w->near[i][by] + 1]++;
    for (long p = 0; p < w->all; p++) w->start[p + 1] += w->start[p];
    for (long i = 0; i < w->near_count; i++)
        memcpy(w->sorted[w->start[w->near[i][by]]++], w->near[i], sizeof *w->sorted);
    w->near = w->sorted;
    w->sorted = other;
}

/* Whether no two parts have come nearer to each other by SLACK since pairs were listed, but for
 * what all have moved together. */
static bool still_listed(const SmCollidePairs *w, double slack)
{
    long all = w->all;
    double shift[3] = {0}, most = 0;
    if (!w->listed || !(slack > 0)) return false;
    for (long i = 0; i < all; i++)
        for (int d = 0; d < 3; d++) shift[d] += (w->centre[i][d] - w->noted[i][d]) / (double)all;
    for (long i = 0; i < all; i++) {
        double square = 0, grown = fmax(w->radius[i] - w->noted_radius[i], 0);
        for (int d = 0; d < 3; d++) {
            double moved = w->centre[i][d] - w->noted[i][d] - shift[d];
            square += moved * moved;
        }
        double left = slack / 2 - grown;
        if (!(left >= 0 && square <= left * left)) return false;
        most = square > most ? square : most;
    }
    return most < INFINITY;
}

/* Pairs of parts that are near each other, by rising numbers. */
static void list_near(SmCollidePairs *w, const SmCollideParts *parts, double largest, double slack)
{
    long room = w->near_room;
    double usual = fmin(1.25 * parts->widest, largest);
    sm_collide_hash_finish(&w->balls);
    w->near_count = 0;
    for (long i = 0; i < w->balls.count; i++)
        pair_up(w, parts, &w->balls.entry[i], usual, largest, slack);
    if (w->near_room > room) {
        free(w->sorted);
        w->sorted = sm_alloc((size_t)w->near_room, sizeof *w->sorted);
    }
    sort_pairs(w, 1);
    sort_pairs(w, 0);
    memcpy(w->noted, w->centre, (size_t)w->all * sizeof *w->noted);
    memcpy(w->noted_radius, w->radius, (size_t)w->all * sizeof *w->radius);
    w->listed = true;
}

static void be_active(SmCollidePairs *w, int part)
{
    if (!w->close[part]) w->part[w->part_count++] = part;
    w->close[part] = 1;
}

void sm_collide_pairs_find(SmCollidePairs *w, const SmCollideShape *shape,
                           const SmCollideParts *parts, const double (*x)[3])
{
    double slack = w->params.self ? SM_COLLIDE_SLACK_EDGES * shape->mean : 0;
    double largest = find_balls(w, shape, parts, x);
    if (!still_listed(w, slack)) list_near(w, parts, largest, slack);
    w->count = w->part_count = 0;
    for (long i = 0; i < w->near_count; i++) {
        int a = w->near[i][0], b = w->near[i][1];
        double off[3], reach = w->radius[a] + w->radius[b];
        for (int d = 0; d < 3; d++) off[d] = w->centre[b][d] - w->centre[a][d];
        if (!(sm_dot(off, off) <= reach * reach)) continue;
        add_pair(&w->pair, &w->count, &w->room, a, b);
        be_active(w, a);
        be_active(w, b);
    }
    for (long i = 0; i < w->part_count; i++) w->close[w->part[i]] = 0;
}
