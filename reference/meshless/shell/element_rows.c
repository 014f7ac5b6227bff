#include "element_rows.h"

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

/* The node's partners, rising; `number` is -1 of all before and their place afterwards. Nodes that
 * no sample of a cell sees together are none. */
static void find_partners(long n, const Uses *uses, const RefElement *const *element, int *number,
                          RefElementRow *row)
{
    int most = 1;
    for (long u = uses->start[n]; u < uses->start[n + 1]; u++)
        most += element[uses->element[u]]->count;
    if (most > row->room) {
        row->partner = sm_realloc(row->partner, (size_t)most, sizeof *row->partner);
        row->sum = sm_realloc(row->sum, (size_t)most, sizeof *row->sum);
        row->room = most;
    }
    row->partner[0] = (int)n;
    row->count = 1;
    number[n] = 0;
    for (long u = uses->start[n]; u < uses->start[n + 1]; u++) {
        const RefElement *of = element[uses->element[u]];
        long a = uses->place[u];
        if (u + 1 < uses->start[n + 1]) fetch(element[uses->element[u + 1]], uses->place[u + 1]);
        for (long b = a; b < of->count; b++) {
            if (number[of->node[b]] >= 0 || ref_element_sum(of, a, b)[0] == 0) continue;
            number[of->node[b]] = 0;
            row->partner[row->count++] = of->node[b];
        }
    }
    sm_sort_ints(row->partner, row->count);
    for (int b = 0; b < row->count; b++) number[row->partner[b]] = b;
}

static void sum_row(long n, const Uses *uses, const RefElement *const *element, int *number,
                    RefElementRow *row)
{
    find_partners(n, uses, element, number, row);
    memset(row->sum, 0, (size_t)row->count * sizeof *row->sum);
    for (long u = uses->start[n]; u < uses->start[n + 1]; u++) {
        const RefElement *of = element[uses->element[u]];
        long a = uses->place[u];
        for (long b = a; b < of->count; b++) {
            int place = number[of->node[b]];
            const double *sum = ref_element_sum(of, a, b);
            if (place < 0) continue;
            for (int k = 0; k < 10; k++) row->sum[place][k] += sum[k];
        }
    }
    for (int b = 0; b < row->count; b++) number[row->partner[b]] = -1;
}

void ref_element_rows_sum(RefElementRows *rows, long nodes, const unsigned char *touched,
                          long count, const RefElement *const *element)
{
    Uses uses = find_uses(nodes, count, element);
    int *number = sm_alloc((size_t)nodes, sizeof *number);
    for (long n = 0; n < nodes; n++) number[n] = -1;
    if (nodes > rows->count) {
        rows->row = sm_widen(rows->row, rows->count, nodes, sizeof *rows->row, 0);
        rows->count = nodes;
    }
    for (long n = 0; n < nodes; n++)
        if (touched[n]) sum_row(n, &uses, element, number, rows->row + n);
    sm_free_all(uses.start, uses.element, uses.place, number);
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
