#include "collide_pairs.h"

#include <math.h>
#include <stdlib.h>

#include "../error.h"

/* Mean edges that a wide box is wider on every side: twice as many where boxes have not been kept
 * for SOON steps, half as many where they have for LATE. */
#define LEAST_SLACK 0.5
#define MOST_SLACK  4.0

enum { SOON = 4, LATE = 64 };

/* A range of the parts of a body, and its place in the body's tree. */
typedef struct {
    long body, from, to, at;
} Range;

void sm_collide_pairs_init(SmCollidePairs *w, const SmCollideParts *parts,
                           const SmCollideParams *params, long bodies)
{
    size_t all = (size_t)(bodies * parts->count);
    *w = (SmCollidePairs){.params = *params,
                          .parts = parts,
                          .bodies = bodies,
                          .boxes = parts->count ? 2 * parts->count - 1 : 0};
    w->tree = sm_alloc((size_t)(bodies * w->boxes), sizeof *w->tree);
    w->box = sm_alloc(all, sizeof *w->box);
    w->known = sm_alloc(all, 1);
    w->part = sm_alloc(all, sizeof *w->part);
    w->near = sm_alloc((size_t)bodies, sizeof *w->near);
    w->wide = sm_alloc(params->self ? all : 1, sizeof *w->wide);
    sm_collide_sweep_init(&w->sweep, bodies);
}

void sm_collide_pairs_free(SmCollidePairs *w)
{
    sm_collide_sweep_free(&w->sweep);
    for (long b = 0; b < w->bodies; b++) free(w->near[b].pair);
    void *all[] = {w->pair, w->tree, w->box, w->known, w->part, w->near, w->wide};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *w = (SmCollidePairs){0};
}

long sm_collide_pairs_bytes(const SmCollidePairs *w)
{
    long pairs = w->room, part = (long)(sizeof *w->part + sizeof *w->box + 1);
    for (long b = 0; b < w->bodies; b++) pairs += w->near[b].room;
    if (w->params.self) part += (long)sizeof *w->wide;
    return w->bodies *
               (w->boxes * (long)sizeof *w->tree + w->parts->count * part + (long)sizeof *w->near) +
           pairs * (long)sizeof *w->pair;
}

SmCollideBox sm_collide_no_box(void)
{
    return (SmCollideBox){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static Range lower(Range r)
{
    return (Range){r.body, r.from, (r.from + r.to) / 2, r.at + 1};
}

static Range upper(Range r)
{
    long middle = (r.from + r.to) / 2;
    return (Range){r.body, middle, r.to, r.at + 2 * (middle - r.from)};
}

/* Boxes of a range of parts of a body, from those of the parts. */
static void fill_tree(SmCollidePairs *w, const SmCollideBox *part, Range r)
{
    SmCollideBox *box = &w->tree[r.body * w->boxes + r.at];
    if (r.to - r.from == 1) {
        *box = part[r.from];
        return;
    }
    fill_tree(w, part, lower(r));
    fill_tree(w, part, upper(r));
    *box = w->tree[r.body * w->boxes + lower(r).at];
    const SmCollideBox *other = &w->tree[r.body * w->boxes + upper(r).at];
    sm_collide_widen(box, other->low, other->high);
}

static void add_part(SmCollidePairs *w, int part)
{
    if (!w->known[part]) w->part[w->part_count++] = part;
    w->known[part] = 1;
}

static void add_pair(SmCollidePairs *w, long a, long b)
{
    if (w->count == w->room) {
        w->room = 2 * w->room + 64;
        w->pair = sm_realloc(w->pair, (size_t)w->room, sizeof *w->pair);
    }
    int *pair = w->pair[w->count++];
    pair[0] = (int)a;
    pair[1] = (int)b;
    add_part(w, pair[0]);
    add_part(w, pair[1]);
}

static void add_near(SmCollidePairs *w, Range a, Range b)
{
    SmCollideNear *near = &w->near[a.body];
    if (sm_collide_parts_joined(w->parts, a.from, b.from)) return;
    if (near->count == near->room) {
        near->room = 2 * near->room + 64;
        near->pair = sm_realloc(near->pair, (size_t)near->room, sizeof *near->pair);
    }
    int *pair = near->pair[near->count++];
    pair[0] = (int)a.from;
    pair[1] = (int)b.from;
}

/* Pairs of a part of one range and one of another. */
static void cross(SmCollidePairs *w, Range a, Range b)
{
    if (!sm_collide_overlap(&w->tree[a.body * w->boxes + a.at], &w->tree[b.body * w->boxes + b.at]))
        return;
    long wide = a.to - a.from, other = b.to - b.from, parts = w->parts->count;
    if (wide == 1 && other == 1) {
        if (a.body == b.body)
            add_near(w, a, b);
        else
            add_pair(w, a.body * parts + a.from, b.body * parts + b.from);
    } else if (wide >= other) {
        cross(w, lower(a), b);
        cross(w, upper(a), b);
    } else {
        cross(w, a, lower(b));
        cross(w, a, upper(b));
    }
}

/* Pairs of parts of one range, of a part with itself too. */
static void within(SmCollidePairs *w, Range r)
{
    if (r.to - r.from == 1) {
        add_near(w, r, r);
        return;
    }
    within(w, lower(r));
    within(w, upper(r));
    cross(w, lower(r), upper(r));
}

/* Fills the boxes of the parts of body b, and the middle of them all. */
static void find_boxes(SmCollidePairs *w, long b, const double (*x)[3], double middle[3])
{
    SmCollideBox *box = w->box + b * w->parts->count, all = sm_collide_no_box();
    for (long p = 0; p < w->parts->count; p++) {
        sm_collide_parts_box(w->parts, x, p, box[p].low, box[p].high);
        sm_collide_widen(&all, box[p].low, box[p].high);
    }
    for (int d = 0; d < 3; d++) middle[d] = 0.5 * (all.low[d] + all.high[d]);
}

/* Rounding keeps the order of what is subtracted from: if two boxes overlap, so do they less the
 * middle, and the wide ones that hold these. */
static bool left(const SmCollideBox *box, const SmCollideBox *wide, const double middle[3])
{
    bool out = false;
    for (int d = 0; d < 3; d++)
        out |=
            !(box->low[d] - middle[d] >= wide->low[d] && box->high[d] - middle[d] <= wide->high[d]);
    return out;
}

/* Whether every part of body b is in its wide box. */
static bool settled(const SmCollidePairs *w, long b, const double middle[3])
{
    long count = w->parts->count;
    if (!w->near[b].fresh) return false;
    for (long p = b * count; p < (b + 1) * count; p++)
        if (left(&w->box[p], &w->wide[p], middle)) return false;
    return true;
}

static void renew(SmCollidePairs *w, long b, const double middle[3])
{
    SmCollideNear *near = &w->near[b];
    long count = w->parts->count;
    if (near->steps < SOON) near->slack = fmin(2 * near->slack, MOST_SLACK);
    if (near->steps > LATE) near->slack /= 2;
    near->slack = fmax(near->slack, LEAST_SLACK);
    double slack = near->slack * w->parts->edge;
    for (long p = b * count; p < (b + 1) * count; p++)
        for (int d = 0; d < 3; d++) {
            w->wide[p].low[d] = w->box[p].low[d] - middle[d] - slack;
            w->wide[p].high[d] = w->box[p].high[d] - middle[d] + slack;
        }
    near->count = near->steps = 0;
    near->fresh = true;
    fill_tree(w, w->wide + b * count, (Range){b, 0, count, 0});
    within(w, (Range){b, 0, count, 0});
}

/* Pairs of parts of body b. */
static void find_own(SmCollidePairs *w, long b, const double middle[3])
{
    SmCollideNear *near = &w->near[b];
    long first = b * w->parts->count;
    if (!settled(w, b, middle)) renew(w, b, middle);
    near->steps++;
    for (long i = 0; i < near->count; i++) {
        long p = first + near->pair[i][0], q = first + near->pair[i][1];
        if (p == q || sm_collide_overlap(&w->box[p], &w->box[q])) add_pair(w, p, q);
    }
}

void sm_collide_pairs_find(SmCollidePairs *w, long nodes, const double (*x)[3])
{
    long count = w->parts->count;
    double middle[3];
    const SmCollideSweep *sweep = &w->sweep;
    w->count = w->part_count = 0;
    if (!count) return;
    if (w->params.bodies) sm_collide_sweep(&w->sweep, x, nodes, w->parts->loosest);
    for (long b = 0; b < w->bodies; b++) {
        if (w->params.self || sweep->meets[b]) find_boxes(w, b, x + b * nodes, middle);
        if (w->params.self) find_own(w, b, middle);
        if (sweep->meets[b]) fill_tree(w, w->box + b * count, (Range){b, 0, count, 0});
    }
    for (long i = 0; w->params.bodies && i < sweep->pairs; i++)
        cross(w, (Range){sweep->pair[i][0], 0, count, 0}, (Range){sweep->pair[i][1], 0, count, 0});
    for (long i = 0; i < w->part_count; i++) w->known[w->part[i]] = 0;
}
