#include "visibility.h"

#include <stdlib.h>

/* What has become of a leaf in the search around another one. */
enum {
    FOUND = 1,   /* reached over joined leaves near by */
    OUTSIDE = 8, /* reached, but beyond what any box could need */
    VISIBLE = 2, /* a neighbour by the definition */
    TRIED = 4,   /* reached in the box of the pair in hand */
};

typedef struct OctCandidate Candidate;

void oct_visibility_init(OctVisibility *search, const OctTree *tree, const SmCsr *joined,
                         long leaves)
{
    *search = (OctVisibility){.tree = tree, .joined = joined};
    search->mark = sm_alloc((size_t)leaves, 1);
}

void oct_visibility_free(OctVisibility *search)
{
    sm_free_all(search->mark, search->leaf, search->found, search->outside, search->tried,
                search->candidate);
    *search = (OctVisibility){0};
}

/* Every list holds leaves that were found. */
static void make_room(OctVisibility *s, long count)
{
    if (count <= s->room) return;
    s->room = 2 * count + 64;
    s->leaf = sm_realloc(s->leaf, (size_t)s->room, sizeof *s->leaf);
    s->found = sm_realloc(s->found, (size_t)s->room, sizeof *s->found);
    s->outside = sm_realloc(s->outside, (size_t)s->room, sizeof *s->outside);
    s->tried = sm_realloc(s->tried, (size_t)s->room, sizeof *s->tried);
    s->candidate = sm_realloc(s->candidate, (size_t)s->room, sizeof *s->candidate);
}

static const int *centre(const OctVisibility *s, int leaf)
{
    return s->tree->centre[s->tree->node[leaf]];
}

static int size_of(const OctVisibility *s, int leaf)
{
    return s->tree->size[s->tree->node[leaf]];
}

/* Do the cell of a leaf, grown by `margin`, and the box spanned by a and b meet? */
static bool meets(const OctVisibility *s, int leaf, const int a[3], const int b[3], int margin)
{
    const int *c = centre(s, leaf);
    int reach = size_of(s, leaf) / 2 + margin;
    for (int d = 0; d < 3; d++) {
        int low = a[d] < b[d] ? a[d] : b[d], high = a[d] < b[d] ? b[d] : a[d];
        if (c[d] + reach < low || c[d] - reach > high) return false;
    }
    return true;
}

/* Is the centre of a leaf in the box spanned by a and b? */
static bool within(const OctVisibility *s, int leaf, const int a[3], const int b[3])
{
    const int *c = centre(s, leaf);
    for (int d = 0; d < 3; d++)
        if ((c[d] < a[d] && c[d] < b[d]) || (c[d] > a[d] && c[d] > b[d])) return false;
    return true;
}

static int compare_candidates(const void *a, const void *b)
{
    const Candidate *p = a, *q = b;
    if (p->away != q->away) return p->away < q->away ? -1 : 1;
    return (p->leaf > q->leaf) - (p->leaf < q->leaf);
}

/* Adds leaf k as a candidate, if its centre is within the size of leaf i. */
static long add_candidate(OctVisibility *s, int i, int k, long candidates)
{
    const int *from = centre(s, i), *to = centre(s, k);
    int away = 0, most = 0;
    for (int d = 0; d < 3; d++) {
        int difference = abs(to[d] - from[d]);
        away += difference;
        if (difference > most) most = difference;
    }
    if (most <= size_of(s, i)) s->candidate[candidates++] = (Candidate){k, away};
    return candidates;
}

/* Every leaf that the box of a pair with leaf i could need, over joined leaves from i, into
 * `found`; those that are joined to them, but beyond, into `outside`. */
static long find_around(OctVisibility *s, int i)
{
    const int *from = centre(s, i), wide = size_of(s, i);
    long found = 1;
    make_room(s, 1);
    s->outside_count = 0;
    s->found[0] = i;
    s->mark[i] = FOUND | VISIBLE;
    for (long n = 0; n < found; n++) {
        int k = s->found[n];
        make_room(s, found + s->outside_count + s->joined->end[k] - s->joined->first[k]);
        const int *restrict item = s->joined->item;
        int *restrict list = s->found, *restrict outside = s->outside;
        unsigned char *restrict mark = s->mark;
        long beyond = s->outside_count;
        for (long e = s->joined->first[k], end = s->joined->end[k]; e < end; e++) {
            int j = item[e];
            if (mark[j]) continue;
            bool near = meets(s, j, from, from, wide);
            mark[j] = near ? FOUND : OUTSIDE;
            if (near)
                list[found++] = j;
            else
                outside[beyond++] = j;
        }
        s->outside_count = beyond;
    }
    return found;
}

/* A leaf in the box of i and j to which i is visible: their box lies in this one, and the way on to
 * j is in hand. */
static bool leads_to(const OctVisibility *s, int leaf, int i, int j)
{
    return s->mark[leaf] & VISIBLE && within(s, leaf, centre(s, i), centre(s, j));
}

/* Searches the box of i and j from j until a leaf leads to i. */
static bool search_box(OctVisibility *s, int i, int j)
{
    long count = 1;
    bool reached = false;
    s->tried[0] = j;
    s->mark[j] |= TRIED;
    for (long n = 0; n < count && !reached; n++) {
        int k = s->tried[n];
        reached = leads_to(s, k, i, j);
        for (long e = s->joined->first[k]; e < s->joined->end[k]; e++) {
            int next = s->joined->item[e];
            if (s->mark[next] & (TRIED | OUTSIDE)) continue;
            if (!meets(s, next, centre(s, i), centre(s, j), 0)) continue;
            s->mark[next] |= TRIED;
            s->tried[count++] = next;
        }
    }
    for (long n = 0; n < count; n++) s->mark[s->tried[n]] &= (unsigned char)~TRIED;
    return reached;
}

static bool is_visible(OctVisibility *s, int i, int j)
{
    for (long e = s->joined->first[j]; e < s->joined->end[j]; e++)
        if (leads_to(s, s->joined->item[e], i, j)) return true;
    return search_box(s, i, j);
}

/* Candidates come nearest first: a leaf within the box of a pair has been decided before it. */
static void find_unjoined(OctVisibility *s, int i, long found)
{
    long candidates = 0;
    for (long n = 1; n < found; n++)
        if (!(s->mark[s->found[n]] & VISIBLE))
            candidates = add_candidate(s, i, s->found[n], candidates);
    qsort(s->candidate, (size_t)candidates, sizeof *s->candidate, compare_candidates);
    for (long n = 0; n < candidates; n++) {
        int j = s->candidate[n].leaf;
        if (!is_visible(s, i, j)) continue;
        s->mark[j] |= VISIBLE;
        if (size_of(s, j) <= size_of(s, i)) s->leaf[s->count++] = j;
    }
}

void oct_visibility_find(OctVisibility *s, int i)
{
    long found = find_around(s, i);
    s->count = 0;
    for (long e = s->joined->first[i]; e < s->joined->end[i]; e++) {
        int j = s->joined->item[e];
        s->mark[j] |= VISIBLE;
        if (size_of(s, j) <= size_of(s, i)) s->leaf[s->count++] = j;
    }
    s->joined_count = s->count;
    find_unjoined(s, i, found);
    for (long n = 0; n < found; n++) s->mark[s->found[n]] = 0;
    for (long n = 0; n < s->outside_count; n++) s->mark[s->outside[n]] = 0;
}
