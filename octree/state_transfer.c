#include "state_transfer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/simd/rotate_lanes.h"
#include "region/fit.h"

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

/* What adds up a region: the leaves, from where the donor is. */
typedef struct {
    const Oct *oct;
    const int *slot;
    const OctDonor *donor;
    OctFit fit;
} Walk;

static void add_leaf(Walk *w, long leaf)
{
    double X[3], x[3], v[3];
    rest_of(w->oct, leaf, X);
    state_of(w->oct->body, leaf, x, v);
    for (int d = 0; d < 3; d++) {
        X[d] -= w->donor->X[d];
        x[d] -= w->donor->x[d];
        v[d] -= w->donor->v[d];
    }
    double mass = (double)w->oct->block[leaf / SM_LANES].mass[leaf % SM_LANES];
    oct_fit_add(&w->fit, mass, X, x, v);
}

static void add_node(Walk *w, int node)
{
    OctStack stack;
    oct_stack_begin(&stack, node);
    while (stack.count > 0) {
        node = oct_stack_take(&stack);
        if (w->slot[node] >= 0) add_leaf(w, w->slot[node]);
        oct_stack_put(&stack, w->oct->child[node], w->oct->children[node]);
    }
}

/* List t and those of its prefixes. */
static void add_list(Walk *w, long t)
{
    const OctSumLists *lists = &w->oct->lists;
    while (t >= 0) {
        long at = lists->rows.first[t], end = lists->rows.end[t];
        for (t = -1; at < end; at++) {
            int row = lists->rows.item[at];
            if (row >= lists->base)
                add_node(w, (int)(row - lists->base));
            else if (row >= OCT_PREFIX_ROW)
                t = row - OCT_PREFIX_ROW;
        }
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
static void fit(const Oct *oct, const OctTree *tree, const int *slot, const OctTransfer *t,
                OctDonor *donor)
{
    /* of the cell that is split or merged; middles of its eighths are a quarter of its edge away */
    int cell = donor->into < 0 ? donor->node : tree->node[donor->into];
    double least = 0.5 * tree->size[cell] / 8;
    Walk own = {.oct = oct, .donor = donor}, region = {.oct = oct, .slot = slot, .donor = donor};
    double last[9];
    unpack(donor->last, last);
    for (int n = donor->next; n >= 0; n = t->donor[n].next) add_leaf(&own, t->donor[n].leaf);
    if (donor->next >= 0) add_leaf(&own, donor->leaf);
    if (donor->next >= 0 && oct_fit_solve(&own.fit, least, last, donor->F, donor->L) == 3) return;
    add_list(&region, oct->lists.prefixes + donor->leaf);
    oct_fit_solve(&region.fit, least, last, donor->F, donor->L);
}

static void make_room(const Oct *oct, const OctChange *change, OctTransfer *t)
{
    sm_make_room(t->donor, t->room, change->removed_count);
    long leaves = oct->leaves;
    for (long n = 0; n < change->added_count; n++)
        if (change->added[n].leaf >= leaves) leaves = change->added[n].leaf + 1L;
    sm_make_room(t->of, t->leaves, leaves);
}

void oct_transfer_keep(const Oct *oct, const OctTree *tree, const OctChange *change,
                       const int *slot, const double *below, OctTransfer *t)
{
    make_room(oct, change, t);
    t->count = change->removed_count;
    for (long n = 0; n < change->added_count; n++) t->of[change->added[n].leaf] = -1;
    for (long n = 0; n < t->count; n++) {
        const OctRemoved *removed = &change->removed[n];
        OctDonor *donor = &t->donor[n];
        *donor = (OctDonor){.leaf = removed->leaf,
                            .node = removed->node,
                            .into = removed->into,
                            .fitted = (int)n,
                            .next = -1};
        t->of[donor->leaf] = (int)n;
        donor->mass = below[removed->node];
        rest_of(oct, donor->leaf, donor->X);
        state_of(oct->body, donor->leaf, donor->x, donor->v);
        for (int i = 0; i < 6; i++) donor->last[i] = oct->body->last[oct_field(donor->leaf, 6, i)];
        for (int i = 0; i < 9 && oct->spread; i++)
            donor->S[i] = (double)oct->body->plastic[oct_field(donor->leaf, 9, i)];
        int *first = donor->into >= 0 ? &t->of[donor->into] : NULL;
        if (first && *first >= 0) {
            donor->fitted = *first;
            donor->next = t->donor[*first].next;
            t->donor[*first].next = (int)n;
            continue;
        }
        if (first) *first = (int)n;
    }
    for (long n = 0; n < t->count; n++)
        if (t->donor[n].fitted == n) fit(oct, tree, slot, t, &t->donor[n]);
}

/* Where a donor's motion takes what is at rest in X, and how fast. */
static void carry(const OctTransfer *t, const OctDonor *donor, const double X[3], double x[3],
                  double v[3])
{
    const OctDonor *by = &t->donor[donor->fitted];
    for (int i = 0; i < 3; i++) {
        x[i] = donor->x[i];
        v[i] = donor->v[i];
        for (int j = 0; j < 3; j++) {
            x[i] += by->F[3 * i + j] * (X[j] - donor->X[j]);
            v[i] += by->L[3 * i + j] * (X[j] - donor->X[j]);
        }
    }
}

/* Puts a new leaf where the sums of masses times x, v and S are. */
static void put(Oct *oct, long leaf, const OctDonor *sum)
{
    OctState *body = oct->body;
    for (int d = 0; d < 3; d++) {
        body->x[oct_index(leaf, d)] = (real)(sum->x[d] / sum->mass);
        body->v[oct_index(leaf, d)] = (real)(sum->v[d] / sum->mass);
    }
    for (int i = 0; i < 6; i++) body->last[oct_field(leaf, 6, i)] = sum->last[i];
    if (!oct->spread) return;
    const double *S = sum->S;
    double det = S[0] * (S[4] * S[8] - S[5] * S[7]) - S[1] * (S[3] * S[8] - S[5] * S[6]) +
                 S[2] * (S[3] * S[7] - S[4] * S[6]);
    double root = cbrt(det); /* volume is kept (plastic.h) */
    for (int i = 0; i < 9; i++)
        body->plastic[oct_field(leaf, 9, i)] = (real)(det > 0 ? S[i] / root : i % 4 == 0);
}

static void add_donor(const OctTransfer *t, const OctDonor *donor, const double X[3], OctDonor *sum)
{
    double x[3], v[3];
    carry(t, donor, X, x, v);
    sum->mass += donor->mass;
    for (int d = 0; d < 3; d++) {
        sum->x[d] += donor->mass * x[d];
        sum->v[d] += donor->mass * v[d];
    }
    for (int i = 0; i < 9; i++) sum->S[i] += donor->mass * donor->S[i];
}

/* A new leaf takes the mean of what goes into it. */
static void start(Oct *oct, const OctTransfer *t, const OctAdded *added)
{
    double X[3];
    OctDonor sum = {0};
    int n = t->of[added->from >= 0 ? added->from : added->leaf];
    rest_of(oct, added->leaf, X);
    memcpy(sum.last, t->donor[n].last, sizeof sum.last);
    for (; n >= 0; n = t->donor[n].next) add_donor(t, &t->donor[n], X, &sum);
    put(oct, added->leaf, &sum);
}

void oct_transfer_start(Oct *oct, const OctChange *change, const double *below, double mass,
                        bool free, const OctTransfer *t)
{
    double place[3] = {0}, momentum[3] = {0}, x[3], v[3];
    for (long n = 0; n < change->added_count; n++) {
        const OctAdded *added = &change->added[n];
        start(oct, t, added);
        state_of(oct->body, added->leaf, x, v);
        for (int d = 0; d < 3; d++) {
            place[d] += below[added->node] * x[d];
            momentum[d] += below[added->node] * v[d];
        }
    }
    if (!free) return;
    for (long n = 0; n < t->count; n++)
        for (int d = 0; d < 3; d++) {
            place[d] -= t->donor[n].mass * t->donor[n].x[d];
            momentum[d] -= t->donor[n].mass * t->donor[n].v[d];
        }
    for (int d = 0; d < 3; d++) {
        oct->body->origin[0][d] -= place[d] / mass;
        oct->body->kick[d] -= momentum[d] / mass;
    }
}

void oct_transfer_free(OctTransfer *t)
{
    free(t->donor);
    free(t->of);
    *t = (OctTransfer){0};
}
