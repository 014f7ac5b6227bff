#include "inherit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/simd/rotate_lanes.h"
#include "octree.h"

static void rest_of(const Oct *oct, long leaf, double X[3])
{
    for (int d = 0; d < 3; d++)
        X[d] = (double)oct->block[leaf / SM_LANES].centre[d][leaf % SM_LANES];
}

static void state_of(const OctState *body, long leaf, double x[3], double v[3])
{
    for (int d = 0; d < 3; d++) {
        x[d] = (double)body->x[oct_index(leaf, d)];
        v[d] = (double)body->v[oct_index(leaf, d)];
    }
}

/* What adds up a region: the leaves, from where the kin is. */
typedef struct {
    const Oct *oct;
    const int *slot;
    const OctKin *kin;
    OctFit fit;
} Walk;

static void add_leaf(Walk *w, long leaf)
{
    double X[3], x[3], v[3];
    rest_of(w->oct, leaf, X);
    state_of(w->oct->body, leaf, x, v);
    for (int d = 0; d < 3; d++) {
        X[d] -= w->kin->X[d];
        x[d] -= w->kin->x[d];
        v[d] -= w->kin->v[d];
    }
    double mass = (double)w->oct->block[leaf / SM_LANES].mass[leaf % SM_LANES];
    oct_fit_add(&w->fit, mass, X, x, v);
}

/* A node has at most 8 children, and those of one node of every level wait. */
static void add_node(Walk *w, int node)
{
    int stack[8 * (OCT_MAX_LEVELS + 1)], count = 0;
    stack[count++] = node;
    while (count) {
        node = stack[--count];
        if (w->slot[node] >= 0) add_leaf(w, w->slot[node]);
        for (int i = 0; i < w->oct->children[node]; i++) stack[count++] = w->oct->child[node] + i;
    }
}

/* List t and those of its carriers. */
static void add_list(Walk *w, long t)
{
    const OctBreadth *lists = &w->oct->lists;
    while (t >= 0) {
        const int *row = lists->row + lists->span[t].first, *end = row + lists->span[t].count;
        t = -1;
        for (; row < end; row++)
            if (*row >= lists->base)
                add_node(w, (int)(*row - lists->base));
            else if (*row >= OCT_CARRIER_ROW)
                t = *row - OCT_CARRIER_ROW;
    }
}

/* The last rotation, orthonormal (rotate_lanes.h). */
static void unpack(const short last[6], double R[9])
{
    double column[2][3], along = 0;
    for (int c = 0; c < 2; c++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            column[c][i] = last[c * 3 + i] * LAST_UNIT - (c ? along * column[0][i] : 0);
            square += column[c][i] * column[c][i];
        }
        for (int i = 0; i < 3; i++) column[c][i] /= sqrt(square);
        for (int i = 0; i < 3 && !c; i++) along += column[0][i] * last[3 + i] * LAST_UNIT;
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        R[i * 3] = column[0][i];
        R[i * 3 + 1] = column[1][i];
        R[i * 3 + 2] = column[0][j] * column[1][k] - column[0][k] * column[1][j];
    }
}

/* Of merged leaves that span space the motion is their own, so that a merge takes back a split. */
static void fit(const Oct *oct, const OctTree *tree, const int *slot, const OctHeirloom *h,
                OctKin *kin)
{
    /* of the cell that is split or merged; middles of its parts are a quarter of its edge away */
    int cell = kin->into < 0 ? kin->node : tree->node[kin->into];
    double least = 0.5 * tree->size[cell] / 8;
    Walk own = {.oct = oct, .kin = kin}, region = {.oct = oct, .slot = slot, .kin = kin};
    double last[9];
    unpack(kin->last, last);
    for (int n = kin->next; n >= 0; n = h->kin[n].next) add_leaf(&own, h->kin[n].leaf);
    if (kin->next >= 0) add_leaf(&own, kin->leaf);
    if (kin->next >= 0 && oct_fit_solve(&own.fit, least, last, kin->F, kin->L) == 3) return;
    add_list(&region, oct->lists.carriers + kin->leaf);
    oct_fit_solve(&region.fit, least, last, kin->F, kin->L);
}

/* Lane `leaf` of a row of `fields` of blocks. */
static long field_at(long leaf, int fields, int field)
{
    return (leaf / SM_LANES * fields + field) * SM_LANES + leaf % SM_LANES;
}

static void make_room(const Oct *oct, const OctChange *change, OctHeirloom *h)
{
    if (change->removed_count > h->room) {
        h->room = 2 * change->removed_count;
        h->kin = sm_realloc(h->kin, (size_t)h->room, sizeof *h->kin);
    }
    long leaves = oct->leaves;
    for (long n = 0; n < change->added_count; n++)
        if (change->added[n].leaf >= leaves) leaves = change->added[n].leaf + 1L;
    if (leaves > h->leaves) {
        h->leaves = 2 * leaves;
        h->of = sm_realloc(h->of, (size_t)h->leaves, sizeof *h->of);
    }
}

void oct_inherit_keep(const Oct *oct, const OctTree *tree, const OctChange *change, const int *slot,
                      const double *below, OctHeirloom *h)
{
    make_room(oct, change, h);
    h->count = change->removed_count;
    for (long n = 0; n < change->added_count; n++) h->of[change->added[n].leaf] = -1;
    for (long n = 0; n < h->count; n++) {
        const OctRemoved *removed = &change->removed[n];
        OctKin *kin = &h->kin[n];
        *kin = (OctKin){.leaf = removed->leaf,
                        .node = removed->node,
                        .into = removed->into,
                        .fitted = (int)n,
                        .next = -1};
        h->of[kin->leaf] = (int)n;
        kin->mass = below[removed->node];
        rest_of(oct, kin->leaf, kin->X);
        state_of(oct->body, kin->leaf, kin->x, kin->v);
        for (int i = 0; i < 6; i++) kin->last[i] = oct->body->last[field_at(kin->leaf, 6, i)];
        for (int i = 0; i < 9 && oct->spread; i++)
            kin->S[i] = (double)oct->body->plastic[field_at(kin->leaf, 9, i)];
        int *first = kin->into >= 0 ? &h->of[kin->into] : NULL;
        if (first && *first >= 0) {
            kin->fitted = *first;
            kin->next = h->kin[*first].next;
            h->kin[*first].next = (int)n;
            continue;
        }
        if (first) *first = (int)n;
    }
    for (long n = 0; n < h->count; n++)
        if (h->kin[n].fitted == n) fit(oct, tree, slot, h, &h->kin[n]);
}

/* Where a kin's motion takes what is at rest in X, and how fast. */
static void carry(const OctHeirloom *h, const OctKin *kin, const double X[3], double x[3],
                  double v[3])
{
    const OctKin *by = &h->kin[kin->fitted];
    for (int i = 0; i < 3; i++) {
        x[i] = kin->x[i];
        v[i] = kin->v[i];
        for (int j = 0; j < 3; j++) {
            x[i] += by->F[3 * i + j] * (X[j] - kin->X[j]);
            v[i] += by->L[3 * i + j] * (X[j] - kin->X[j]);
        }
    }
}

/* Puts a new leaf where the sums of masses times x, v and S are. */
static void put(Oct *oct, long leaf, const OctKin *sum)
{
    OctState *body = oct->body;
    for (int d = 0; d < 3; d++) {
        body->x[oct_index(leaf, d)] = (real)(sum->x[d] / sum->mass);
        body->v[oct_index(leaf, d)] = (real)(sum->v[d] / sum->mass);
    }
    for (int i = 0; i < 6; i++) body->last[field_at(leaf, 6, i)] = sum->last[i];
    if (!oct->spread) return;
    const double *S = sum->S;
    double det = S[0] * (S[4] * S[8] - S[5] * S[7]) - S[1] * (S[3] * S[8] - S[5] * S[6]) +
                 S[2] * (S[3] * S[7] - S[4] * S[6]);
    double root = cbrt(det); /* volume is kept (plastic.h) */
    for (int i = 0; i < 9; i++)
        body->plastic[field_at(leaf, 9, i)] = (real)(det > 0 ? S[i] / root : i % 4 == 0);
}

static void add_kin(const OctHeirloom *h, const OctKin *kin, const double X[3], OctKin *sum)
{
    double x[3], v[3];
    carry(h, kin, X, x, v);
    sum->mass += kin->mass;
    for (int d = 0; d < 3; d++) {
        sum->x[d] += kin->mass * x[d];
        sum->v[d] += kin->mass * v[d];
    }
    for (int i = 0; i < 9; i++) sum->S[i] += kin->mass * kin->S[i];
}

/* A new leaf takes the mean of what goes into it. */
static void start(Oct *oct, const OctHeirloom *h, const OctAdded *added)
{
    double X[3];
    OctKin sum = {0};
    int n = h->of[added->from >= 0 ? added->from : added->leaf];
    rest_of(oct, added->leaf, X);
    memcpy(sum.last, h->kin[n].last, sizeof sum.last);
    for (; n >= 0; n = h->kin[n].next) add_kin(h, &h->kin[n], X, &sum);
    put(oct, added->leaf, &sum);
}

void oct_inherit_start(Oct *oct, const OctChange *change, const double *below, double mass,
                       bool free, const OctHeirloom *h)
{
    double place[3] = {0}, momentum[3] = {0}, x[3], v[3];
    for (long n = 0; n < change->added_count; n++) {
        const OctAdded *added = &change->added[n];
        start(oct, h, added);
        state_of(oct->body, added->leaf, x, v);
        for (int d = 0; d < 3; d++) {
            place[d] += below[added->node] * x[d];
            momentum[d] += below[added->node] * v[d];
        }
    }
    if (!free) return;
    for (long n = 0; n < h->count; n++)
        for (int d = 0; d < 3; d++) {
            place[d] -= h->kin[n].mass * h->kin[n].x[d];
            momentum[d] -= h->kin[n].mass * h->kin[n].v[d];
        }
    for (int d = 0; d < 3; d++) {
        oct->body->origin[0][d] -= place[d] / mass;
        oct->body->kick[d] -= momentum[d] / mass;
    }
}

void oct_inherit_free(OctHeirloom *h)
{
    free(h->kin);
    free(h->of);
    *h = (OctHeirloom){0};
}

size_t oct_inherit_bytes(const OctHeirloom *h)
{
    return (size_t)h->room * sizeof *h->kin + (size_t)h->leaves * sizeof *h->of;
}
