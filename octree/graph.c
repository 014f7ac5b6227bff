#include "graph.h"

#include <stdlib.h>
#include <string.h>

#include "touch.h"

enum { SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

/* What has become of a leaf in the search around another one. */
enum {
    FOUND = 1,   /* reached over joined leaves near by */
    VISIBLE = 2, /* a neighbour by the definition */
    TRIED = 4,   /* reached in the box of the pair in hand */
};

/* Joined leaves of every leaf, rising. */
typedef struct {
    long *first;
    int *to;
} Rows;

typedef struct {
    int leaf, away; /* sum of the coordinates' differences */
} Candidate;

/* One thread's search for neighbours that are not joined. */
typedef struct {
    const OctTree *tree;
    const Rows *joined;
    unsigned char *mark;  /* [leaves] all 0 between searches */
    int *found, *tried;   /* [leaves] lists of the marked leaves */
    Candidate *candidate; /* [leaves] */
    int (*pair)[2];
    long count, room;
} Search;

static const int *centre(const Search *s, int leaf)
{
    return s->tree->centre[s->tree->node[leaf]];
}

static int size_of(const Search *s, int leaf)
{
    return s->tree->size[s->tree->node[leaf]];
}

/* Do the cell of a leaf, grown by `margin`, and the box spanned by a and b meet? */
static bool meets(const Search *s, int leaf, const int a[3], const int b[3], int margin)
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
static bool within(const Search *s, int leaf, const int a[3], const int b[3])
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

/* Every leaf that the box of a pair with leaf i could need, over joined leaves from i; those whose
 * centres are within its size become candidates, nearest first. */
static long find_candidates(Search *s, int i, long *found)
{
    const int *from = centre(s, i), wide = size_of(s, i);
    long candidates = 0;
    *found = 0;
    s->found[(*found)++] = i;
    s->mark[i] = FOUND | VISIBLE;
    for (long n = 0; n < *found; n++) {
        int k = s->found[n];
        for (long e = s->joined->first[k]; e < s->joined->first[k + 1]; e++) {
            int j = s->joined->to[e];
            if (s->mark[j] || !meets(s, j, from, from, wide)) continue;
            s->mark[j] = FOUND;
            s->found[(*found)++] = j;
        }
        int away = 0, most = 0;
        for (int d = 0; d < 3; d++) {
            int difference = abs(centre(s, k)[d] - from[d]);
            away += difference;
            if (difference > most) most = difference;
        }
        if (n > 0 && most <= wide) s->candidate[candidates++] = (Candidate){k, away};
    }
    qsort(s->candidate, (size_t)candidates, sizeof *s->candidate, compare_candidates);
    return candidates;
}

/* A leaf in the box of i and j to which i is visible: their box lies in this one, and the way on to
 * j is in hand. */
static bool leads_to(const Search *s, int leaf, int i, int j)
{
    return s->mark[leaf] & VISIBLE && within(s, leaf, centre(s, i), centre(s, j));
}

/* Searches the box of i and j from j until a leaf leads to i. */
static bool search_box(Search *s, int i, int j)
{
    long count = 1;
    bool reached = false;
    s->tried[0] = j;
    s->mark[j] |= TRIED;
    for (long n = 0; n < count && !reached; n++) {
        int k = s->tried[n];
        reached = leads_to(s, k, i, j);
        for (long e = s->joined->first[k]; e < s->joined->first[k + 1]; e++) {
            int next = s->joined->to[e];
            if (s->mark[next] & TRIED || !meets(s, next, centre(s, i), centre(s, j), 0)) continue;
            s->mark[next] |= TRIED;
            s->tried[count++] = next;
        }
    }
    for (long n = 0; n < count; n++) s->mark[s->tried[n]] &= (unsigned char)~TRIED;
    return reached;
}

static bool is_visible(Search *s, int i, int j)
{
    for (long e = s->joined->first[j]; e < s->joined->first[j + 1]; e++)
        if (leads_to(s, s->joined->to[e], i, j)) return true;
    return search_box(s, i, j);
}

static void add_pair(Search *s, int i, int j)
{
    if (s->count == s->room) {
        s->room = s->room ? 2 * s->room : 256;
        s->pair = sm_realloc(s->pair, (size_t)s->room, sizeof *s->pair);
    }
    s->pair[s->count][0] = i;
    s->pair[s->count++][1] = j;
}

/* Adds the neighbours of leaf i that are not joined to it, smaller ones and later ones of its size.
 * Candidates come nearest first: a leaf within the box of a pair has been decided before it. */
static void search_around(Search *s, int i)
{
    long found, candidates = find_candidates(s, i, &found);
    for (long e = s->joined->first[i]; e < s->joined->first[i + 1]; e++)
        s->mark[s->joined->to[e]] |= VISIBLE;
    for (long n = 0; n < candidates; n++) {
        int j = s->candidate[n].leaf;
        if (s->mark[j] & VISIBLE || !is_visible(s, i, j)) continue;
        s->mark[j] |= VISIBLE;
        if (size_of(s, j) < size_of(s, i) || j > i) add_pair(s, i, j);
    }
    for (long n = 0; n < found; n++) s->mark[s->found[n]] = 0;
}

/* Rows from pairs. Each pair is put into the rows of both; walking the rows in order and turning
 * them round once more sorts them. */
static void build_rows(long leaves, int (*pair)[2], long pairs, Rows *rows)
{
    long *first = sm_alloc((size_t)leaves + 1, sizeof *first);
    long *next = sm_alloc((size_t)leaves, sizeof *next);
    int *unsorted = sm_alloc(2 * (size_t)pairs, sizeof *unsorted);
    for (long p = 0; p < pairs; p++) {
        first[pair[p][0] + 1]++;
        first[pair[p][1] + 1]++;
    }
    for (long l = 0; l < leaves; l++) first[l + 1] += next[l] = first[l];
    for (long p = 0; p < pairs; p++) {
        unsorted[next[pair[p][0]]++] = pair[p][1];
        unsorted[next[pair[p][1]]++] = pair[p][0];
    }
    *rows = (Rows){first, sm_alloc(2 * (size_t)pairs, sizeof *rows->to)};
    memcpy(next, first, (size_t)leaves * sizeof *next);
    for (long l = 0; l < leaves; l++)
        for (long e = first[l]; e < first[l + 1]; e++) rows->to[next[unsorted[e]]++] = (int)l;
    free(unsorted);
    free(next);
}

static void free_rows(Rows *rows)
{
    free(rows->first);
    free(rows->to);
}

/* Appends to the joined pairs the neighbours that are not joined. */
static void add_unjoined(const OctTree *tree, OctTouch *touch)
{
    Rows joined;
    build_rows(tree->leaves, touch->pair, touch->count, &joined);
    size_t leaves = (size_t)tree->leaves;
#pragma omp parallel if (tree->leaves > SERIAL)
    {
        Search s = {.tree = tree, .joined = &joined, .mark = sm_alloc(leaves, 1)};
        s.found = sm_alloc(leaves, sizeof *s.found);
        s.tried = sm_alloc(leaves, sizeof *s.tried);
        s.candidate = sm_alloc(leaves, sizeof *s.candidate);
#pragma omp for schedule(dynamic, 64)
        for (long l = 0; l < tree->leaves; l++)
            if (touch->open[l]) search_around(&s, (int)l);
#pragma omp critical
        if (s.count > 0) {
            size_t count = (size_t)(touch->count + s.count);
            touch->pair = sm_realloc(touch->pair, count, sizeof *touch->pair);
            memcpy(touch->pair + touch->count, s.pair, (size_t)s.count * sizeof *s.pair);
            touch->count += s.count;
        }
        free(s.mark);
        free(s.found);
        free(s.tried);
        free(s.candidate);
        free(s.pair);
    }
    free_rows(&joined);
}

static void measure_edges(const OctTree *tree, OctGraph *graph)
{
    graph->length = sm_alloc((size_t)graph->first[graph->leaves], sizeof *graph->length);
    for (long l = 0; l < graph->leaves; l++)
        for (long e = graph->first[l]; e < graph->first[l + 1]; e++) {
            const int *a = tree->centre[tree->node[l]];
            const int *b = tree->centre[tree->node[graph->to[e]]];
            for (int d = 0; d < 3; d++) {
                int difference = abs(a[d] - b[d]);
                if (difference > graph->length[e]) graph->length[e] = difference;
            }
            if (graph->length[e] > graph->longest) graph->longest = graph->length[e];
        }
}

void oct_graph_build(const OctTree *tree, const SmVoxels *voxels, OctGraph *graph)
{
    OctTouch touch;
    Rows rows;
    oct_touch_find(tree, voxels, &touch);
    if (touch.any_open) add_unjoined(tree, &touch);
    build_rows(tree->leaves, touch.pair, touch.count, &rows);
    oct_touch_free(&touch);
    *graph = (OctGraph){.leaves = tree->leaves, .first = rows.first, .to = rows.to};
    measure_edges(tree, graph);
}

size_t oct_graph_bytes(const OctGraph *graph)
{
    size_t edge = sizeof *graph->to + sizeof *graph->length;
    return sizeof *graph + ((size_t)graph->leaves + 1) * sizeof *graph->first +
           (size_t)graph->first[graph->leaves] * edge;
}

void oct_graph_free(OctGraph *graph)
{
    free(graph->first);
    free(graph->to);
    free(graph->length);
    memset(graph, 0, sizeof *graph);
}
