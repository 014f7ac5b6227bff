#include "element_rows.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"

void ref_element_rows_free(RefElementRows *rows)
{
    for (long n = 0; n < rows->count; n++) sm_free_all(rows->row[n].partner, rows->row[n].sum);
    free(rows->row);
    *rows = (RefElementRows){.count = 0};
}

/* A node's elements, and its place in each. */
typedef struct {
    long *start; /* [nodes + 1] */
    int *element, *place;
} Uses;

static Uses find_uses(long nodes, long count, const RefElement *const *element)
{
    Uses uses = {.start = sm_alloc((size_t)nodes + 2, sizeof(long))};
    for (long e = 0; e < count; e++)
        for (int a = 0; element[e] && a < element[e]->count; a++)
            uses.start[element[e]->node[a] + 2]++;
    for (long n = 0; n < nodes; n++) uses.start[n + 2] += uses.start[n + 1];
    uses.element = sm_alloc((size_t)uses.start[nodes + 1], sizeof(int));
    uses.place = sm_alloc((size_t)uses.start[nodes + 1], sizeof(int));
    for (long e = 0; e < count; e++)
        for (int a = 0; element[e] && a < element[e]->count; a++) {
            long at = uses.start[element[e]->node[a] + 1]++;
            uses.element[at] = (int)e;
            uses.place[at] = a;
        }
    return uses;
}

/* A node's sums in an element, which are in no cache: all elements are larger than that. */
static void fetch(const RefElement *of, long a)
{
    const char *from = (const char *)ref_element_sum(of, a, a),
               *to = from + (size_t)(of->count - a) * sizeof *of->sum;
    for (; from < to; from += 64) __builtin_prefetch(from);
}

/* A row as it is added up, of all nodes: which are its partners, a bit each, and their sums. All
 * are zero between rows. */
typedef struct {
    uint64_t *is;
    double (*sum)[10];
} Gathered;

/* Nodes that no sample of a cell sees together have no mass there, and are no partners by it. */
static void add_element(const RefElement *of, long a, Gathered *gathered)
{
    for (long b = a; b < of->count; b++) {
        const int other = of->node[b];
        const double *from = ref_element_sum(of, a, b);
        double *restrict to = gathered->sum[other];
        if (from[0] == 0) continue;
        gathered->is[other / 64] |= 1ULL << other % 64;
        for (int k = 0; k < 10; k++) to[k] += from[k];
    }
}

static void make_room(int count, RefElementRow *row)
{
    row->count = count;
    if (count <= row->room) return;
    row->room = count + count / 4;
    sm_free_all(row->partner, row->sum);
    row->partner = sm_alloc((size_t)row->room, sizeof *row->partner);
    row->sum = sm_alloc((size_t)row->room, sizeof *row->sum);
}

/* Takes the row's partners, rising, from words first .. last. */
static void take_row(long first, long last, Gathered *gathered, RefElementRow *row)
{
    int count = 0, b = 0;
    for (long w = first; w <= last; w++) count += __builtin_popcountll(gathered->is[w]);
    make_room(count, row);
    for (long w = first; w <= last; w++) {
        for (uint64_t left = gathered->is[w]; left; left &= left - 1, b++) {
            double *sum = gathered->sum[row->partner[b] = (int)(64 * w) + __builtin_ctzll(left)];
            memcpy(row->sum[b], sum, sizeof *row->sum);
            memset(sum, 0, sizeof *row->sum);
        }
        gathered->is[w] = 0;
    }
}

static void sum_row(long n, const Uses *uses, const RefElement *const *element, Gathered *gathered,
                    RefElementRow *row)
{
    long last = n;
    gathered->is[n / 64] |= 1ULL << n % 64;
    for (long u = uses->start[n]; u < uses->start[n + 1]; u++) {
        const RefElement *of = element[uses->element[u]];
        if (u + 1 < uses->start[n + 1]) fetch(element[uses->element[u + 1]], uses->place[u + 1]);
        add_element(of, uses->place[u], gathered);
        if (of->node[of->count - 1] > last) last = of->node[of->count - 1];
    }
    take_row(n / 64, last / 64, gathered, row);
}

void ref_element_rows_sum(RefElementRows *rows, long nodes, const unsigned char *touched,
                          long count, const RefElement *const *element)
{
    Uses uses = find_uses(nodes, count, element);
    Gathered gathered = {sm_alloc((size_t)nodes / 64 + 1, sizeof *gathered.is),
                         sm_alloc((size_t)nodes, sizeof *gathered.sum)};
    if (nodes > rows->count) {
        rows->row = sm_widen(rows->row, rows->count, nodes, sizeof *rows->row, 0);
        rows->count = nodes;
    }
    for (long n = 0; n < nodes; n++)
        if (touched[n]) sum_row(n, &uses, element, &gathered, rows->row + n);
    sm_free_all(uses.start, uses.element, uses.place, gathered.is, gathered.sum);
}

void ref_element_rows_matrices(const RefElementRows *rows, double density, RefMatrices *matrices)
{
    RefPairs pairs = {.count = rows->count,
                      .start = sm_alloc((size_t)rows->count + 1, sizeof(long))};
    double mass = 0, stiffness = 0;
    for (long n = 0; n < rows->count; n++) {
        pairs.start[n + 1] = pairs.start[n] + rows->row[n].count;
        mass += rows->row[n].sum[0][0] / (double)rows->count;
        stiffness += rows->row[n].sum[0][1] / (double)rows->count;
    }
    size_t all = (size_t)pairs.start[rows->count];
    pairs.partner = sm_alloc(all, sizeof *pairs.partner);
    pairs.mass = sm_alloc(all, sizeof *pairs.mass);
    pairs.block = sm_alloc(all, sizeof *pairs.block);
    for (long n = 0; n < rows->count; n++) {
        const RefElementRow *row = rows->row + n;
        long at = pairs.start[n];
        for (int b = 0; b < row->count; b++) {
            pairs.partner[at + b] = row->partner[b];
            pairs.mass[at + b] = row->sum[b][0];
            memcpy(pairs.block[at + b], row->sum[b] + 1, sizeof pairs.block[0]);
        }
        if (pairs.mass[at] > 0) continue;
        pairs.mass[at] = mass;
        for (int d = 0; d < 3; d++) pairs.block[at][4 * d] += stiffness;
    }
    ref_pairs_matrices(&pairs, density, matrices);
    ref_pairs_free(&pairs);
}
