#include "pairs.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

RefPairs ref_pairs_begin(long nodes)
{
    return (RefPairs){.count = nodes,
                      .met = sm_alloc((size_t)nodes, sizeof(int *)),
                      .held = sm_alloc((size_t)nodes, sizeof(long))};
}

/* Adds `count` rising numbers to a rising list of `*held`. */
static int *merge(int *list, long *held, const int *number, int count)
{
    int *merged = sm_alloc((size_t)*held + (size_t)count, sizeof *merged);
    long kept = 0, n = 0;
    for (int b = 0; n < *held || b < count;) {
        int next = n < *held ? list[n] : INT_MAX, other = b < count ? number[b] : INT_MAX;
        merged[kept++] = next < other ? next : other;
        n += next <= other;
        b += other <= next;
    }
    free(list);
    *held = kept;
    return merged;
}

void ref_pairs_add(RefPairs *pairs, int i, int count, const int *partner)
{
    pairs->met[i] = merge(pairs->met[i], pairs->held + i, partner, count);
}

void ref_pairs_meet(RefPairs *pairs, int count, const int *node)
{
    for (int a = 0; a < count; a++) ref_pairs_add(pairs, node[a], count - a, node + a);
}

void ref_pairs_end(RefPairs *pairs)
{
    size_t count = (size_t)pairs->count;
    pairs->start = sm_alloc(count + 1, sizeof *pairs->start);
    for (size_t i = 0; i < count; i++) pairs->start[i + 1] = pairs->start[i] + pairs->held[i];
    size_t all = (size_t)pairs->start[count];
    pairs->partner = sm_alloc(all, sizeof *pairs->partner);
    pairs->mass = sm_alloc(all, sizeof *pairs->mass);
    pairs->block = sm_alloc(all, sizeof *pairs->block);
    for (size_t i = 0; i < count; i++) {
        if (pairs->held[i])
            memcpy(pairs->partner + pairs->start[i], pairs->met[i],
                   (size_t)pairs->held[i] * sizeof(int));
        free(pairs->met[i]);
    }
    sm_free_all(pairs->met, pairs->held);
    pairs->met = NULL;
    pairs->held = NULL;
}

void ref_pairs_free(RefPairs *pairs)
{
    sm_free_all(pairs->start, pairs->partner, pairs->mass, pairs->block);
    *pairs = (RefPairs){0};
}

long ref_pairs_at(const RefPairs *pairs, int i, int j)
{
    long low = pairs->start[i], high = pairs->start[i + 1] - 1;
    while (low < high) {
        long middle = (low + high) / 2;
        if (pairs->partner[middle] < j)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

SmCode ref_pairs_check(const RefPairs *pairs, SmError *error)
{
    if (9 * pairs->start[pairs->count] <= INT_MAX) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "%ld nodes with %ld pairs of covers are too many: give the body fewer nodes",
                   pairs->count, pairs->start[pairs->count]);
}

static RefSparse sparse_create(long columns, long entries)
{
    return (RefSparse){.columns = (int)columns,
                       .start = sm_alloc((size_t)columns + 1, sizeof(int)),
                       .row = sm_alloc((size_t)entries, sizeof(int)),
                       .value = sm_alloc((size_t)entries, sizeof(double))};
}

static void fill_mass(const RefPairs *pairs, double density, RefSparse *mass)
{
    long all = pairs->start[pairs->count];
    *mass = sparse_create(pairs->count, all);
    for (long i = 0; i <= pairs->count; i++) mass->start[i] = (int)pairs->start[i];
    for (long e = 0; e < all; e++) {
        mass->row[e] = pairs->partner[e];
        mass->value[e] = density * pairs->mass[e];
    }
}

static void fill_stiffness(const RefPairs *pairs, RefSparse *stiffness)
{
    *stiffness = sparse_create(3 * pairs->count, 9 * pairs->start[pairs->count] - 3 * pairs->count);
    int at = 0;
    for (long i = 0; i < pairs->count; i++)
        for (int a = 0; a < 3; a++) {
            stiffness->start[3 * i + a] = at;
            for (long e = pairs->start[i]; e < pairs->start[i + 1]; e++)
                for (int b = pairs->partner[e] == i ? a : 0; b < 3; b++) {
                    stiffness->row[at] = 3 * pairs->partner[e] + b;
                    stiffness->value[at++] = pairs->block[e][3 * a + b];
                }
        }
    stiffness->start[3 * pairs->count] = at;
}

void ref_pairs_matrices(const RefPairs *pairs, double density, RefMatrices *matrices)
{
    fill_mass(pairs, density, &matrices->mass);
    fill_stiffness(pairs, &matrices->stiffness);
}
