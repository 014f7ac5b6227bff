#include "halves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../tree/cover.h"
#include "doubts.h"
#include "lists.h"

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

/* What `count` leaves from number `from` on own. */
static void find_own(const Build *b, OctSheaf *s, long from, int count, OctLists *member,
                     OctDoubts *doubts)
{
    int leaf[OCT_SHEAF], reaches[OCT_SHEAF];
    for (int lane = 0; lane < count; lane++) {
        leaf[lane] = (int)from + lane;
        reaches[lane] = oct_halves_reach(b->w[leaf[lane]], b->epsilon);
    }
    oct_sheaf_find(s, count, leaf, b->w + from, reaches);
    oct_doubts_add(doubts, s, (int)from, b->w);
    for (int lane = 0; lane < count; lane++) {
        b->halves->width[leaf[lane]] = s->width[lane];
        oct_lists_add(member, leaf[lane], oct_sheaf_member(s, lane), s->members[lane]);
    }
}

/* Leaves that follow each other in number are near each other, but for where a level ends. */
static void find_block(const Build *b, OctSheaf *s, long block, OctLists *member, OctDoubts *doubts)
{
    long to = oct_lists_to(member, block);
    for (long i = oct_lists_from(block); i < to; i += OCT_SHEAF)
        find_own(b, s, i, (int)(to - i < OCT_SHEAF ? to - i : OCT_SHEAF), member, doubts + block);
}

static void find_all(const Build *b, OctLists *member, OctDoubts *doubts)
{
    OctReach reach;
    oct_reach_init(&reach, b->graph);
#pragma omp parallel num_threads(sm_team(0)) if (b->tree->leaves > SERIAL)
    {
        OctSheaf s;
        oct_sheaf_init(&s, b->tree, &reach);
        oct_sheaf_grow(&s, b->tree->nodes, b->tree->leaves, b->below);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member->blocks; block++)
            find_block(b, &s, block, member, doubts);
        oct_sheaf_free(&s);
    }
    oct_reach_free(&reach);
}

/* Of the doubts keeps, in place, those where the leaf does not own its owner. */
static void keep_missing(const Build *b, OctDoubts *doubts)
{
    const OctHalves *h = b->halves;
    const int *distance = doubts->distance;
    long count = doubts->count;
    doubts->count = doubts->distances = 0;
    for (long n = 0; n < count; n++) {
        struct OctDoubt d = doubts->item[n];
        long first = h->first[d.leaf], members = h->first[d.leaf + 1] - first;
        unsigned missing = 0;
        for (; d.lanes; d.lanes &= d.lanes - 1, distance++) {
            int lane = __builtin_ctz(d.lanes);
            if (oct_cover_holds(b->tree, h->member + first, members, d.first + lane)) continue;
            missing |= 1u << lane;
            doubts->distance[doubts->distances++] = *distance;
        }
        if (missing) doubts->item[doubts->count++] = (struct OctDoubt){d.leaf, d.first, missing};
    }
}

/* Turns "leaf does not own its owner" round to "it takes it". */
static void turn_round(const OctDoubts *missing, long blocks, OctHalves *h)
{
    long *next = sm_alloc((size_t)h->leaves, sizeof *next), *first = h->taken_first;
    for (long b = 0; b < blocks; b++)
        for (long n = 0; n < missing[b].count; n++)
            first[missing[b].item[n].leaf + 1] += __builtin_popcount(missing[b].item[n].lanes);
    for (long j = 0; j < h->leaves; j++) first[j + 1] += next[j] = first[j];
    h->taken = sm_alloc((size_t)first[h->leaves], sizeof *h->taken);
    h->distance = sm_alloc((size_t)first[h->leaves], sizeof *h->distance);
    for (long b = 0; b < blocks; b++) {
        const int *distance = missing[b].distance;
        for (long n = 0; n < missing[b].count; n++) {
            struct OctDoubt d = missing[b].item[n];
            for (; d.lanes; d.lanes &= d.lanes - 1) {
                h->distance[next[d.leaf]] = *distance++;
                h->taken[next[d.leaf]++] = d.first + __builtin_ctz(d.lanes);
            }
        }
    }
    free(next);
}

void oct_halves_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                      const int *below, OctHalves *halves)
{
    Build b = {tree, graph, w, epsilon, below, halves};
    OctLists member;
    size_t leaves = (size_t)tree->leaves;
    *halves = (OctHalves){.leaves = tree->leaves};
    halves->width = sm_alloc(leaves, sizeof *halves->width);
    halves->taken_first = sm_alloc(leaves + 1, sizeof *halves->taken_first);
    oct_lists_init(&member, tree->leaves);
    long blocks = member.blocks;
    OctDoubts *doubts = sm_alloc((size_t)blocks, sizeof *doubts);
    find_all(&b, &member, doubts);
    oct_lists_pack(&member, &halves->first, &halves->member);
#pragma omp parallel for schedule(dynamic) num_threads(sm_team(0)) if (tree->leaves > SERIAL)
    for (long block = 0; block < blocks; block++) keep_missing(&b, doubts + block);
    turn_round(doubts, blocks, halves);
    for (long block = 0; block < blocks; block++) oct_doubts_free(doubts + block);
    free(doubts);
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
