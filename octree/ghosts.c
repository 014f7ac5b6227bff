#include "ghosts.h"

#include <stdlib.h>
#include <string.h>

#include "body_arrays.h"
#include "positions.h"
#include "region/frames.h"

/* ---- which rows need a ghost */

/* A place in a list that names a row of another frame. */
typedef struct {
    int row, frame; /* the row as a tree node, and the frame of the list */
    int *entry;
} Foreign;

typedef struct {
    const OctTree *tree;
    const int *frame; /* of leaves */
    Foreign *found;
    long count, room;
} Search;

static int frame_of(const Search *s, int node)
{
    while (s->tree->child[node] >= 0) node = s->tree->child[node];
    return s->frame[s->tree->leaf[node]];
}

static void search_list(Search *s, const OctSumLists *lists, long t, int frame)
{
    for (long at = lists->rows.first[t]; at < lists->rows.end[t]; at++) {
        int *entry = &lists->rows.item[at], node = (int)(*entry - lists->base);
        if (node < 0 || frame_of(s, node) == frame) continue;
        sm_make_room(s->found, s->room, s->count + 1);
        s->found[s->count++] = (Foreign){node, frame, entry};
    }
}

static void search_lists(Search *s, const OctSumLists *lists)
{
    for (long k = 0; k < lists->prefixes; k++)
        search_list(s, lists, k, frame_of(s, lists->prefix[k]));
    for (long leaf = 0; leaf < lists->leaves; leaf++)
        search_list(s, lists, lists->prefixes + leaf, s->frame[leaf]);
}

static int compare(const void *a, const void *b)
{
    const Foreign *p = a, *q = b;
    if (p->row != q->row) return p->row < q->row ? -1 : 1;
    return (p->frame > q->frame) - (p->frame < q->frame);
}

/* Numbers the ghosts, each once, and makes the lists name them; tree nodes' rows follow theirs. */
static void add_ghosts(Oct *oct, Search *s)
{
    qsort(s->found, (size_t)s->count, sizeof *s->found, compare);
    oct->ghost = sm_alloc((size_t)s->count, sizeof *oct->ghost);
    for (long i = 0; i < s->count; i++) {
        const Foreign *f = &s->found[i];
        if (i > 0 && compare(f, f - 1) == 0) continue;
        oct->ghost[oct->ghosts++] =
            (OctGhost){.node = f->row, .from = frame_of(s, f->row), .to = f->frame};
    }
    oct->ghost_row = oct->lists.base;
    oct_sum_lists_rebase(&oct->lists, oct->ghost_row + oct->ghosts);
    if (oct->goal_lists.rows.first) oct_sum_lists_rebase(&oct->goal_lists, oct->lists.base);
    long ghost = -1;
    for (long i = 0; i < s->count; i++) {
        if (i == 0 || compare(&s->found[i], &s->found[i - 1]) != 0) ghost++;
        *s->found[i].entry = (int)(oct->ghost_row + ghost);
    }
}

void oct_ghosts_build(Oct *oct, const OctTree *tree, const OctRegions *regions)
{
    int *frame = sm_alloc((size_t)oct_slots(tree->leaves), sizeof *frame);
    Search search = {.tree = tree, .frame = frame};
    oct->frames = oct_frames_find(tree, regions, frame);
    for (long i = 0; i < oct->instances; i++)
        oct->body[i].origin = sm_alloc((size_t)oct->frames, sizeof *oct->body->origin);
    oct->middle = sm_alloc((size_t)oct->frames, sizeof *oct->middle);
    oct->ghost_row = oct->lists.base;
    if (oct->frames == 1) {
        free(frame);
        return;
    }
    oct->frame = frame;
    search_lists(&search, &oct->lists);
    if (oct->goal_lists.rows.first) search_lists(&search, &oct->goal_lists);
    if (search.count) add_ghosts(oct, &search);
    free(search.found);
}

void oct_ghosts_fill(Oct *oct, const OctTree *tree, const OctWeights *w)
{
    double place[3];
    for (long i = 0; i < oct->ghosts; i++) {
        OctGhost *g = &oct->ghost[i];
        g->mass = (real)w->below[g->node];
        g->weight = (real)w->sum[g->node][0];
        oct_row_place(tree, g->node, place);
        for (int d = 0; d < 3; d++) {
            double to = 0.5 * (tree->centre[g->node][d] - tree->centre[0][d]) - place[d];
            g->first[d] = (real)(w->sum[g->node][1 + d] + w->sum[g->node][0] * to);
        }
    }
}

static void forget_ghosts(Oct *oct, OctSumLists *lists)
{
    for (long at = 0; at < lists->rows.live; at++) { /* they still follow each other */
        long ghost = lists->rows.item[at] - oct->ghost_row;
        if (ghost >= 0 && ghost < oct->ghosts)
            lists->rows.item[at] = (int)(lists->base + oct->ghost[ghost].node);
    }
}

void oct_ghosts_merge(Oct *oct)
{
    if (!oct->frame) return;
    forget_ghosts(oct, &oct->lists);
    if (oct->goal_lists.rows.first) forget_ghosts(oct, &oct->goal_lists);
    for (long i = 0; i < oct->instances; i++) {
        OctState *body = &oct->body[i];
        for (long leaf = 0; leaf < oct->leaves; leaf++)
            for (int d = 0; d < 3 && oct_alive(oct, leaf); d++) {
                double shift = oct_origin(oct, body, leaf)[d] - body->origin[0][d];
                real *x = &body->x[oct_index(leaf, d)];
                *x = (real)((double)*x + shift);
            }
    }
    free(oct->frame);
    oct->frame = NULL;
    oct->frames = 1;
    oct->ghosts = 0;
    oct_recentre(oct);
}

void oct_ghosts_free(Oct *oct)
{
    sm_free_all(oct->frame, oct->ghost, oct->middle);
}

/* ---- their sums */

/* Copies the row that a ghost stands for, of `size` values; `by` is from its own origin to that of
 * what it stands for. */
static real *begin(const OctTask *task, real *rows, long g, long size, real by[3])
{
    const Oct *oct = task->oct;
    const OctGhost *ghost = &oct->ghost[g];
    const double *from = task->body->origin[ghost->from], *to = task->body->origin[ghost->to];
    real *row = rows + (oct->ghost_row + g) * size;
    memcpy(row, rows + (oct->lists.base + ghost->node) * size, (size_t)size * sizeof *row);
    for (int d = 0; d < 3; d++) by[d] = (real)(from[d] - to[d]);
    return row;
}

void oct_ghosts_moments(OctTask *task, long first, long last)
{
    real by[3];
    for (long g = first; g < last; g++) {
        const OctGhost *ghost = &task->oct->ghost[g];
        real *row = begin(task, task->rows->moment, g, OCT_ROW, by);
        for (int i = 0; i < 3; i++) {
            row[i] += ghost->weight * by[i];
            for (int d = 0; d < 3; d++) row[4 + 4 * d + i] += ghost->first[d] * by[i];
        }
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

void oct_ghosts_transforms(OctTask *task, long first, long last)
{
    real by[3];
    for (long g = first; g < last; g++) {
        real *row = begin(task, task->rows->transform, g, OCT_ROW, by);
        for (int i = 0; i < 3; i++) row[i] += task->oct->ghost[g].mass * by[i];
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

void oct_ghosts_products(OctTask *task, long first, long last)
{
    real by[3];
    for (long g = first; g < last; g++) {
        const OctGhost *ghost = &task->oct->ghost[g];
        const real *x = task->rows->moment + (task->oct->lists.base + ghost->node) * OCT_ROW;
        real *v = begin(task, task->rows->transform, g, OCT_ROW, by);
        for (int d = 0; d < 3; d++) {
            int e = (d + 1) % 3, f = (d + 2) % 3;
            v[4 + d] += by[e] * v[f] - by[f] * v[e];
            v[8 + d] += (2 * x[d] + ghost->weight * by[d]) * by[d];
            v[12 + d] += by[e] * x[f] + (x[e] + ghost->weight * by[e]) * by[f];
        }
    }
    sm_lap(task->laps, SM_DAMPING);
}

void oct_ghosts_velocities(OctTask *task, long first, long last)
{
    real by[3];
    for (long g = first; g < last; g++) {
        real *omega = begin(task, task->rows->velocity, g, OCT_ROW_VELOCITY, by), *v = omega + 4;
        for (int d = 0; d < 3; d++) {
            int e = (d + 1) % 3, f = (d + 2) % 3;
            v[d] -= omega[e] * by[f] - omega[f] * by[e];
        }
    }
    sm_lap(task->laps, SM_DAMPING);
}
