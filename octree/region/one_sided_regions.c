#include "one_sided_regions.h"

#include <math.h>
#include <stdlib.h>

#include "../../lib/system/team.h"

void oct_pairs_free(OctPairs *pairs)
{
    free(pairs->item);
    free(pairs->distance);
    *pairs = (OctPairs){0};
}

static void grow(OctPairs *p)
{
    sm_make_room(p->item, p->room, p->count + 1);
    sm_make_room(p->distance, p->distance_room, p->distances + OCT_SOURCES);
}

void oct_pairs_add(OctPairs *p, const OctSearch *s, int first, const int *w)
{
    for (long at = 0; at < s->leaves; at++) {
        int leaf = s->leaf[at];
        unsigned lanes = s->held[at] & oct_search.beyond(&s->distance[at], w[leaf]);
        if (!lanes) continue;
        grow(p);
        p->item[p->count++] = (struct OctPair){leaf, first, lanes};
        for (; lanes; lanes &= lanes - 1)
            p->distance[p->distances++] = s->distance[at][__builtin_ctz(lanes)];
    }
}

typedef struct {
    const OctTree *tree;
    const OctGraph *graph;
    const int *w;
    double epsilon;
    const int *below;
    OctOneSided *one_sided;
} Build;

int oct_one_sided_reach(int w, double epsilon)
{
    double most = w + floor(epsilon * w);
    return most < OCT_FAR / 2 ? (int)most : OCT_FAR / 2;
}

/* The one-sided regions of `count` leaves from number `from` on. */
static void search(const Build *b, OctSearch *s, long from, int count, SmCsrParts *member,
                   OctPairs *pairs)
{
    int leaf[OCT_SOURCES], reaches[OCT_SOURCES];
    for (int lane = 0; lane < count; lane++) {
        leaf[lane] = (int)from + lane;
        reaches[lane] = oct_one_sided_reach(b->w[leaf[lane]], b->epsilon);
    }
    oct_search.find(s, count, leaf, b->w + from, reaches);
    oct_pairs_add(pairs, s, (int)from, b->w);
    for (int lane = 0; lane < count; lane++) {
        b->one_sided->width[leaf[lane]] = s->width[lane];
        sm_csr_parts_add(member, leaf[lane], oct_search_member(s, lane), s->members[lane]);
    }
}

/* Leaves that follow each other in number are near each other, but for where a level ends. */
static void search_block(const Build *b, OctSearch *s, long block, SmCsrParts *member,
                         OctPairs *pairs)
{
    long to = sm_csr_parts_to(member, block);
    for (long i = sm_csr_parts_from(block); i < to; i += OCT_SOURCES)
        search(b, s, i, (int)(to - i < OCT_SOURCES ? to - i : OCT_SOURCES), member, pairs + block);
}

static void search_all(const Build *b, SmCsrParts *member, OctPairs *pairs)
{
    OctReach reach;
    oct_reach_init(&reach, b->graph);
#pragma omp parallel num_threads(sm_team(0)) if (b->tree->leaves > OCT_SERIAL)
    {
        OctSearch s;
        oct_search_init(&s, b->tree, &reach);
        oct_search_grow(&s, b->tree->nodes, b->tree->leaves, b->below);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < member->blocks; block++)
            search_block(b, &s, block, member, pairs);
        oct_search_free(&s);
    }
    oct_reach_free(&reach);
}

bool oct_one_sided_holds(const OctOneSided *o, const OctTree *tree, long i, int leaf)
{
    const SmCsr *members = &o->members;
    long first = members->first[i], count = members->end[i] - first;
    return oct_cover_holds(tree, members->item + first, count, leaf);
}

long oct_one_sided_union(const OctOneSided *o, long i, OctCover *cover, const int **member,
                         int *width)
{
    const SmCsr *members = &o->members, *reverse = &o->reverse;
    const int *distance = reverse->value;
    *member = members->item + members->first[i];
    *width = o->width[i];
    if (reverse->first[i] == reverse->end[i]) return members->end[i] - members->first[i];
    cover->count = 0;
    for (long n = members->first[i]; n < members->end[i]; n++)
        oct_cover_put(cover, members->item[n]);
    for (long n = reverse->first[i]; n < reverse->end[i]; n++) {
        oct_cover_put(cover, cover->tree->node[reverse->item[n]]);
        if (distance[n] > *width) *width = distance[n];
    }
    oct_cover_finish(cover);
    *member = cover->list;
    return cover->count;
}

/* Keeps, in place, the pairs that are asymmetric: those whose leaf does not hold the source. */
static void keep_asymmetric(const Build *b, OctPairs *pairs)
{
    const int *distance = pairs->distance;
    long count = pairs->count;
    pairs->count = pairs->distances = 0;
    for (long n = 0; n < count; n++) {
        struct OctPair p = pairs->item[n];
        unsigned kept = 0;
        for (; p.lanes; p.lanes &= p.lanes - 1, distance++) {
            int lane = __builtin_ctz(p.lanes);
            if (oct_one_sided_holds(b->one_sided, b->tree, p.leaf, p.first + lane)) continue;
            kept |= 1u << lane;
            pairs->distance[pairs->distances++] = *distance;
        }
        if (kept) pairs->item[pairs->count++] = (struct OctPair){p.leaf, p.first, kept};
    }
}

/* Lists the asymmetric pairs, which were found by their sources, by the leaves that are held. */
static void list_reverse(const OctPairs *pairs, long blocks, long leaves, SmCsr *reverse)
{
    long *first = sm_alloc((size_t)leaves + 1, sizeof *first);
    long *next = sm_alloc((size_t)leaves, sizeof *next);
    for (long b = 0; b < blocks; b++)
        for (long n = 0; n < pairs[b].count; n++)
            first[pairs[b].item[n].leaf + 1] += __builtin_popcount(pairs[b].item[n].lanes);
    for (long j = 0; j < leaves; j++) first[j + 1] += next[j] = first[j];
    int *item = sm_alloc((size_t)first[leaves], sizeof *item);
    int *away = sm_alloc((size_t)first[leaves], sizeof *away);
    for (long b = 0; b < blocks; b++) {
        const int *distance = pairs[b].distance;
        for (long n = 0; n < pairs[b].count; n++) {
            struct OctPair p = pairs[b].item[n];
            for (; p.lanes; p.lanes &= p.lanes - 1) {
                away[next[p.leaf]] = *distance++;
                item[next[p.leaf]++] = p.first + __builtin_ctz(p.lanes);
            }
        }
    }
    sm_csr_adopt(reverse, leaves, first, item, away, sizeof *away);
    free(next);
}

void oct_one_sided_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                         const int *below, OctOneSided *one_sided)
{
    Build b = {tree, graph, w, epsilon, below, one_sided};
    SmCsrParts member;
    *one_sided = (OctOneSided){.width = sm_alloc((size_t)tree->leaves, sizeof(int))};
    sm_csr_parts_init(&member, tree->leaves);
    long blocks = member.blocks;
    OctPairs *pairs = sm_alloc((size_t)blocks, sizeof *pairs);
    search_all(&b, &member, pairs);
    sm_csr_parts_join(&member, &one_sided->members, 0);
#pragma omp parallel for schedule(dynamic) num_threads(sm_team(0)) if (tree->leaves > OCT_SERIAL)
    for (long block = 0; block < blocks; block++) keep_asymmetric(&b, pairs + block);
    list_reverse(pairs, blocks, tree->leaves, &one_sided->reverse);
    for (long block = 0; block < blocks; block++) oct_pairs_free(pairs + block);
    free(pairs);
}

void oct_one_sided_free(OctOneSided *one_sided)
{
    sm_csr_free(&one_sided->members);
    sm_csr_free(&one_sided->reverse);
    free(one_sided->width);
    *one_sided = (OctOneSided){0};
}
