#include "collide_pairs.h"

#include <math.h>
#include <stdlib.h>

#include "error.h"

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
    w->known = sm_alloc(all, 1);
    w->part = sm_alloc(all, sizeof *w->part);
    sm_collide_sweep_init(&w->sweep, bodies);
}

void sm_collide_pairs_free(SmCollidePairs *w)
{
    sm_collide_sweep_free(&w->sweep);
    free(w->pair);
    free(w->tree);
    free(w->known);
    free(w->part);
    *w = (SmCollidePairs){0};
}

long sm_collide_pairs_bytes(const SmCollidePairs *w)
{
    return w->bodies *
               (w->boxes * (long)sizeof *w->tree + w->parts->count * (long)(sizeof *w->part + 1)) +
           w->room * (long)sizeof *w->pair;
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

/* Boxes of a range of parts of a body whose nodes are at x. */
static void find_boxes(SmCollidePairs *w, const double (*x)[3], Range r)
{
    SmCollideBox *box = &w->tree[r.body * w->boxes + r.at];
    if (r.to - r.from == 1) {
        sm_collide_parts_box(w->parts, x, r.from, box->low, box->high);
        return;
    }
    find_boxes(w, x, lower(r));
    find_boxes(w, x, upper(r));
    *box = w->tree[r.body * w->boxes + lower(r).at];
    const SmCollideBox *other = &w->tree[r.body * w->boxes + upper(r).at];
    sm_collide_widen(box, other->low, other->high);
}

static void add_part(SmCollidePairs *w, int part)
{
    if (!w->known[part]) w->part[w->part_count++] = part;
    w->known[part] = 1;
}

static void add_pair(SmCollidePairs *w, Range a, Range b)
{
    if (a.body == b.body && sm_collide_parts_joined(w->parts, a.from, b.from)) return;
    if (w->count == w->room) {
        w->room = 2 * w->room + 64;
        w->pair = sm_realloc(w->pair, (size_t)w->room, sizeof *w->pair);
    }
    int *pair = w->pair[w->count++];
    pair[0] = (int)(a.body * w->parts->count + a.from);
    pair[1] = (int)(b.body * w->parts->count + b.from);
    add_part(w, pair[0]);
    add_part(w, pair[1]);
}

/* Pairs of a part of one range and one of another. */
static void cross(SmCollidePairs *w, Range a, Range b)
{
    if (!sm_collide_overlap(&w->tree[a.body * w->boxes + a.at], &w->tree[b.body * w->boxes + b.at]))
        return;
    long wide = a.to - a.from, other = b.to - b.from;
    if (wide == 1 && other == 1) {
        add_pair(w, a, b);
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
        add_pair(w, r, r);
        return;
    }
    within(w, lower(r));
    within(w, upper(r));
    cross(w, lower(r), upper(r));
}

void sm_collide_pairs_find(SmCollidePairs *w, long nodes, const double (*x)[3])
{
    long count = w->parts->count;
    const SmCollideSweep *sweep = &w->sweep;
    w->count = w->part_count = 0;
    if (!count) return;
    if (w->params.bodies) sm_collide_sweep(&w->sweep, x, nodes, w->parts->loosest);
    for (long b = 0; b < w->bodies; b++)
        if (w->params.self || sweep->first[b] < sweep->first[b + 1])
            find_boxes(w, x + b * nodes, (Range){b, 0, count, 0});
    for (long b = 0; b < w->bodies && w->params.self; b++) within(w, (Range){b, 0, count, 0});
    for (long i = 0; w->params.bodies && i < sweep->pairs; i++)
        cross(w, (Range){sweep->pair[i][0], 0, count, 0}, (Range){sweep->pair[i][1], 0, count, 0});
    for (long i = 0; i < w->part_count; i++) w->known[w->part[i]] = 0;
}
