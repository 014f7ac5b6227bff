#include "halves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cover.h"

enum { SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

typedef struct {
    const OctTree *tree;
    const OctGraph *graph;
    const int *w;
    double epsilon;
    const int *below;
    OctHalves *halves;
} Build;

int oct_halves_reach(int w, double epsilon)
{
    double most = w + floor(epsilon * w);
    return most < OCT_FAR / 2 ? (int)most : OCT_FAR / 2;
}

/* What leaf i owns into `member`, and into `doubtful` its leaves that may not own i, because the
 * distance is more than their widths. A number below 0 there is the distance, negated, of the
 * leaves that follow. */
static void find_own(const Build *b, OctIntervals *s, long i, OctLists *member, OctLists *doubtful)
{
    int w = b->w[i], listed = 0;
    oct_interval_find(s, (int)i, w, oct_halves_reach(w, b->epsilon));
    b->halves->width[i] = s->width;
    oct_lists_add(member, i, s->member, s->members);
    for (long n = 0; n < s->reach.count; n++) {
        int j = s->reach.reached[n], d = s->reach.distance[j];
        if (d <= b->w[j] || (d > w && !oct_interval_holds(s, j))) continue;
        int negated = -d;
        if (d != listed) oct_lists_add(doubtful, i, &negated, 1);
        listed = d;
        oct_lists_add(doubtful, i, &j, 1);
    }
}

static void find_all(const Build *b, OctLists *doubtful)
{
    OctLists member;
    oct_lists_init(&member, b->tree->leaves);
#pragma omp parallel if (b->tree->leaves > SERIAL)
    {
        OctIntervals s;
        oct_interval_init(&s, b->tree, b->graph, b->below);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member.blocks; block++)
            for (long i = oct_lists_from(block); i < oct_lists_to(&member, block); i++)
                find_own(b, &s, i, &member, doubtful);
        oct_interval_free(&s);
    }
    oct_lists_pack(&member, &b->halves->first, &b->halves->member);
}

/* Of the doubtful leaves keeps, in place, those that do not own i. */
static void keep_missing(const Build *b, long i, int *item, int *count)
{
    const OctHalves *h = b->halves;
    int kept = 0;
    for (int n = 0; n < *count; n++) {
        int j = item[n];
        if (j < 0 || !oct_cover_holds(b->tree, h->member + h->first[j],
                                      h->first[j + 1] - h->first[j], (int)i))
            item[kept++] = j;
    }
    *count = kept;
}

/* Turns "j does not own i" round to "j takes i". */
static void turn_round(const OctLists *missing, OctHalves *h)
{
    long *next = sm_alloc((size_t)h->leaves, sizeof *next), *first = h->taken_first;
    for (long i = 0; i < h->leaves; i++) {
        const int *item = oct_lists_item(missing, i);
        for (int n = 0; n < missing->count[i]; n++)
            if (item[n] >= 0) first[item[n] + 1]++;
    }
    for (long j = 0; j < h->leaves; j++) first[j + 1] += next[j] = first[j];
    h->taken = sm_alloc((size_t)first[h->leaves], sizeof *h->taken);
    h->distance = sm_alloc((size_t)first[h->leaves], sizeof *h->distance);
    for (long i = 0; i < h->leaves; i++) {
        const int *item = oct_lists_item(missing, i);
        for (int n = 0, d = 0; n < missing->count[i]; n++) {
            if (item[n] < 0) {
                d = -item[n];
                continue;
            }
            h->distance[next[item[n]]] = d;
            h->taken[next[item[n]]++] = (int)i;
        }
    }
    free(next);
}

void oct_halves_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                      const int *below, OctHalves *halves)
{
    Build b = {tree, graph, w, epsilon, below, halves};
    OctLists doubtful;
    size_t leaves = (size_t)tree->leaves;
    *halves = (OctHalves){.leaves = tree->leaves};
    halves->width = sm_alloc(leaves, sizeof *halves->width);
    halves->taken_first = sm_alloc(leaves + 1, sizeof *halves->taken_first);
    oct_lists_init(&doubtful, tree->leaves);
    find_all(&b, &doubtful);
#pragma omp parallel for schedule(dynamic) if (tree->leaves > SERIAL)
    for (long block = 0; block < doubtful.blocks; block++)
        for (long i = oct_lists_from(block); i < oct_lists_to(&doubtful, block); i++)
            keep_missing(&b, i, oct_lists_item(&doubtful, i), doubtful.count + i);
    turn_round(&doubtful, halves);
    oct_lists_free(&doubtful);
}

void oct_halves_free(OctHalves *halves)
{
    free(halves->first);
    free(halves->member);
    free(halves->width);
    free(halves->taken_first);
    free(halves->taken);
    free(halves->distance);
    memset(halves, 0, sizeof *halves);
}
