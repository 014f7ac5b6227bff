#include "pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

/* Mean edges that a wide box is wider on every side: twice as many where boxes have not been kept
 * for SOON steps, half as many where they have for LATE. */
#define LEAST_SLACK 0.5
#define MOST_SLACK  4.0

enum { SOON = 4, LATE = 64 };

/* A range of the patches of a body, and its place in the body's tree. */
typedef struct {
    long body, from, to, at;
} Range;

static void sweep_init(SmCollideSweep *sweep, long bodies)
{
    size_t n = (size_t)bodies;
    *sweep = (SmCollideSweep){.bodies = bodies,
                              .box = sm_alloc(n, sizeof *sweep->box),
                              .order = sm_alloc(n, sizeof *sweep->order),
                              .meets = sm_alloc(n, sizeof *sweep->meets)};
    for (long b = 0; b < bodies; b++) sweep->order[b] = (int)b;
}

static void sweep_free(SmCollideSweep *sweep)
{
    sm_free_all(sweep->box, sweep->order, sweep->pair, sweep->meets);
    *sweep = (SmCollideSweep){0};
}

static void find_body(SmCollideSweep *sweep, long b, const double (*x)[3], long nodes,
                      double margin)
{
    sweep->box[b] = sm_box_around(nodes, x + b * nodes);
    sm_box_widen(&sweep->box[b], margin);
}

static void sort_bodies(SmCollideSweep *sweep)
{
    for (long i = 1; i < sweep->bodies; i++) {
        int body = sweep->order[i];
        long at = i;
        for (; at > 0 && sweep->box[sweep->order[at - 1]].low[0] > sweep->box[body].low[0]; at--)
            sweep->order[at] = sweep->order[at - 1];
        sweep->order[at] = body;
    }
}

static void add_bodies(SmCollideSweep *sweep, int a, int b)
{
    sm_make_room(sweep->pair, sweep->room, sweep->pairs + 1);
    sweep->pair[sweep->pairs][0] = a;
    sweep->pair[sweep->pairs++][1] = b;
    sweep->meets[a] = sweep->meets[b] = true;
}

/* Boxes of the positions x [bodies * nodes][3], wider by `margin` on every side, and which
 * overlap. O(nodes + bodies + pairs that overlap along x). */
static void sweep_bodies(SmCollideSweep *sweep, const double (*x)[3], long nodes, double margin)
{
    for (long b = 0; b < sweep->bodies; b++) find_body(sweep, b, x, nodes, margin);
    sort_bodies(sweep);
    sweep->pairs = 0;
    memset(sweep->meets, 0, (size_t)sweep->bodies * sizeof *sweep->meets);
    for (long i = 0; i < sweep->bodies; i++) {
        int a = sweep->order[i];
        for (long j = i + 1; j < sweep->bodies; j++) {
            int b = sweep->order[j];
            if (!(sweep->box[b].low[0] <= sweep->box[a].high[0])) break;
            if (sm_boxes_meet(&sweep->box[a], &sweep->box[b])) add_bodies(sweep, a, b);
        }
    }
}

void sm_collide_pairs_init(SmCollidePairs *w, const SmCollidePatches *patches,
                           const SmCollideParams *params, long bodies)
{
    size_t all = (size_t)(bodies * patches->count);
    *w = (SmCollidePairs){.params = *params,
                          .patches = patches,
                          .bodies = bodies,
                          .boxes = patches->count ? 2 * patches->count - 1 : 0};
    w->tree = sm_alloc((size_t)(bodies * w->boxes), sizeof *w->tree);
    w->box = sm_alloc(all, sizeof *w->box);
    w->known = sm_alloc(all, 1);
    w->patch = sm_alloc(all, sizeof *w->patch);
    w->near = sm_alloc((size_t)bodies, sizeof *w->near);
    w->wide = sm_alloc(params->self ? all : 1, sizeof *w->wide);
    sweep_init(&w->sweep, bodies);
}

void sm_collide_pairs_free(SmCollidePairs *w)
{
    sweep_free(&w->sweep);
    for (long b = 0; b < w->bodies; b++) free(w->near[b].pair);
    sm_free_all(w->pair, w->tree, w->box, w->known, w->patch, w->near, w->wide);
    *w = (SmCollidePairs){0};
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

/* Boxes of a range of patches of a body, from those of the patches. */
static void fill_tree(SmCollidePairs *w, const SmBox *patch, Range r)
{
    SmBox *box = &w->tree[r.body * w->boxes + r.at];
    if (r.to - r.from == 1) {
        *box = patch[r.from];
        return;
    }
    fill_tree(w, patch, lower(r));
    fill_tree(w, patch, upper(r));
    *box = w->tree[r.body * w->boxes + lower(r).at];
    const SmBox *other = &w->tree[r.body * w->boxes + upper(r).at];
    sm_box_join(box, other->low, other->high);
}

static void add_patch(SmCollidePairs *w, int patch)
{
    if (!w->known[patch]) w->patch[w->patch_count++] = patch;
    w->known[patch] = 1;
}

static void add_pair(SmCollidePairs *w, long a, long b)
{
    sm_make_room(w->pair, w->room, w->count + 1);
    int *pair = w->pair[w->count++];
    pair[0] = (int)a;
    pair[1] = (int)b;
    add_patch(w, pair[0]);
    add_patch(w, pair[1]);
}

static void add_near(SmCollidePairs *w, Range a, Range b)
{
    SmCollideNear *near = &w->near[a.body];
    if (sm_collide_patches_joined(w->patches, a.from, b.from)) return;
    sm_make_room(near->pair, near->room, near->count + 1);
    int *pair = near->pair[near->count++];
    pair[0] = (int)a.from;
    pair[1] = (int)b.from;
}

/* Pairs of a patch of one range and one of another. */
static void cross(SmCollidePairs *w, Range a, Range b)
{
    if (!sm_boxes_meet(&w->tree[a.body * w->boxes + a.at], &w->tree[b.body * w->boxes + b.at]))
        return;
    long wide = a.to - a.from, other = b.to - b.from, patches = w->patches->count;
    if (wide == 1 && other == 1) {
        if (a.body == b.body)
            add_near(w, a, b);
        else
            add_pair(w, a.body * patches + a.from, b.body * patches + b.from);
    } else if (wide >= other) {
        cross(w, lower(a), b);
        cross(w, upper(a), b);
    } else {
        cross(w, a, lower(b));
        cross(w, a, upper(b));
    }
}

/* Pairs of patches of one range, of a patch with itself too. */
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

/* Fills the boxes of the patches of body b, and the middle of them all. */
static void find_boxes(SmCollidePairs *w, long b, const double (*x)[3], double middle[3])
{
    SmBox *box = w->box + b * w->patches->count, all = sm_no_box();
    for (long p = 0; p < w->patches->count; p++) {
        box[p] = sm_collide_patches_box(w->patches, x, p);
        sm_box_join(&all, box[p].low, box[p].high);
    }
    for (int d = 0; d < 3; d++) middle[d] = 0.5 * (all.low[d] + all.high[d]);
}

/* Rounding keeps the order of what is subtracted from: if two boxes overlap, so do they less the
 * middle, and the wide ones that hold these. */
static bool left(const SmBox *box, const SmBox *wide, const double middle[3])
{
    bool out = false;
    for (int d = 0; d < 3; d++)
        out |=
            !(box->low[d] - middle[d] >= wide->low[d] && box->high[d] - middle[d] <= wide->high[d]);
    return out;
}

/* Whether every patch of body b is in its wide box. */
static bool settled(const SmCollidePairs *w, long b, const double middle[3])
{
    long count = w->patches->count;
    if (!w->near[b].fresh) return false;
    for (long p = b * count; p < (b + 1) * count; p++)
        if (left(&w->box[p], &w->wide[p], middle)) return false;
    return true;
}

static void renew(SmCollidePairs *w, long b, const double middle[3])
{
    SmCollideNear *near = &w->near[b];
    long count = w->patches->count;
    if (near->steps < SOON) near->slack = fmin(2 * near->slack, MOST_SLACK);
    if (near->steps > LATE) near->slack /= 2;
    near->slack = fmax(near->slack, LEAST_SLACK);
    double slack = near->slack * w->patches->edge;
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

/* Pairs of patches of body b. */
static void find_own(SmCollidePairs *w, long b, const double middle[3])
{
    SmCollideNear *near = &w->near[b];
    long first = b * w->patches->count;
    if (!settled(w, b, middle)) renew(w, b, middle);
    near->steps++;
    for (long i = 0; i < near->count; i++) {
        long p = first + near->pair[i][0], q = first + near->pair[i][1];
        if (p == q || sm_boxes_meet(&w->box[p], &w->box[q])) add_pair(w, p, q);
    }
}

void sm_collide_pairs_find(SmCollidePairs *w, long nodes, const double (*x)[3])
{
    long count = w->patches->count;
    double middle[3];
    const SmCollideSweep *sweep = &w->sweep;
    w->count = w->patch_count = 0;
    if (!count) return;
    if (w->params.bodies) sweep_bodies(&w->sweep, x, nodes, w->patches->loosest);
    for (long b = 0; b < w->bodies; b++) {
        if (w->params.self || sweep->meets[b]) find_boxes(w, b, x + b * nodes, middle);
        if (w->params.self) find_own(w, b, middle);
        if (sweep->meets[b]) fill_tree(w, w->box + b * count, (Range){b, 0, count, 0});
    }
    for (long i = 0; w->params.bodies && i < sweep->pairs; i++)
        cross(w, (Range){sweep->pair[i][0], 0, count, 0}, (Range){sweep->pair[i][1], 0, count, 0});
    for (long i = 0; i < w->patch_count; i++) w->known[w->patch[i]] = 0;
}
