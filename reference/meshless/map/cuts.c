#include "cuts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harmonic.h"

enum { CANDIDATES = 20 };

/* The way along the rim between two of its places. */
static double apart(double whole, double a, double b)
{
    double way = fabs(a - b);
    return fmin(way, whole - way);
}

/* By how much the rim turns at place n of `count`, over `window` of its length to both sides. */
static double turning(const double (*x)[3], const double *along, double whole, int count, int n,
                      double window)
{
    int end[2] = {n, n};
    double way[2][3], lengths = 1;
    for (int k = 0; k < 2; k++) {
        int step = k ? 1 : count - 1;
        do end[k] = (end[k] + step) % count;
        while (end[k] != n && apart(whole, along[end[k]], along[n]) < window);
        for (int d = 0; d < 3; d++) way[k][d] = (k ? 1 : -1) * (x[end[k]][d] - x[n][d]);
        lengths *= sqrt(sm_dot(way[k], way[k]));
    }
    return lengths > 0 ? acos(fmin(fmax(sm_dot(way[0], way[1]) / lengths, -1), 1)) : 0;
}

/* The place of the best score that is not taken. */
static int best_place(const double *score, const bool *taken, int count)
{
    int best = -1;
    for (int n = 0; n < count; n++)
        if (!taken[n] && (best < 0 || score[n] > score[best])) best = n;
    return best;
}

/* Four places of the rim, of so much length up to each; rising. */
static void choose(const double (*x)[3], const double *along, double whole, int count,
                   double window, int place[4])
{
    double *turn = sm_alloc((size_t)count, sizeof *turn);
    double *score = sm_alloc((size_t)count, sizeof *score);
    bool *taken = sm_alloc((size_t)count, sizeof *taken), *near = sm_alloc((size_t)count, 1);
    for (int n = 0; n < count; n++) turn[n] = turning(x, along, whole, count, n, window);
    for (int k = 0; k < 4; k++) {
        int best = best_place(turn, near, count);
        bool sharp = best >= 0 && turn[best] > M_PI / 4;
        for (int n = 0; n < count && !sharp; n++) {
            score[n] = INFINITY;
            for (int j = 0; j < k; j++)
                score[n] = fmin(score[n], apart(whole, along[n], along[place[j]]));
        }
        if (!sharp) best = best_place(score, taken, count);
        place[k] = best;
        taken[best] = true;
        for (int n = 0; n < count; n++) near[n] |= apart(whole, along[n], along[best]) < window;
    }
    for (int k = 1; k < 4; k++) /* in order */
        for (int j = k; j > 0 && place[j - 1] > place[j]; j--) {
            int other = place[j];
            place[j] = place[j - 1];
            place[j - 1] = other;
        }
    sm_free_all(turn, score, taken, near);
}

/* Four corners on a disk's rim, which has as many edges at least, in its order: where the rim turns
 * most, as seen over a share of it to both sides, by 45 degrees at least and as far apart; and
 * where there are fewer than four such places, those that are farthest along the rim from the
 * others. */
static void find_corners(const RefTriangulation *surface, double share, int corner[4])
{
    int first = 0, count = 0, place[4];
    while (surface->rim[first] < 0) first++;
    for (int at = first; count == 0 || at != first; at = ref_rim_next(surface, at)) count++;
    assert(count >= 4);
    int *rim = sm_alloc((size_t)count, sizeof *rim);
    double *along = sm_alloc((size_t)count, sizeof *along), whole = 0;
    double(*x)[3] = sm_alloc((size_t)count, sizeof *x);
    for (int n = 0, at = first; n < count; n++, at = ref_rim_next(surface, at)) {
        rim[n] = at;
        along[n] = whole;
        whole += surface->length[at];
        memcpy(x[n], surface->position[surface->vertex[at]], sizeof *x);
    }
    choose((const double(*)[3])x, along, whole, count, share * whole, place);
    for (int k = 0; k < 4; k++) corner[k] = rim[place[k]];
    sm_free_all(rim, along, x);
}

/* Dijkstra's search over a closed surface's edges, with a heap of vertices. */
typedef struct {
    const RefTriangulation *surface;
    double *distance; /* [vertices] */
    int *from;        /* [vertices] the corner whose edge leads there, or -1 */
    int *heap, *slot; /* [vertices]; slot: where in the heap, -1 before and after */
    int count;
} Search;

static void sift_up(Search *s, int at)
{
    int v = s->heap[at];
    for (; at > 0 && s->distance[s->heap[(at - 1) / 2]] > s->distance[v]; at = (at - 1) / 2) {
        s->heap[at] = s->heap[(at - 1) / 2];
        s->slot[s->heap[at]] = at;
    }
    s->heap[at] = v;
    s->slot[v] = at;
}

static int pop(Search *s)
{
    int top = s->heap[0], v = s->heap[--s->count], at = 0;
    for (;;) {
        int child = 2 * at + 1;
        if (child >= s->count) break;
        if (child + 1 < s->count && s->distance[s->heap[child + 1]] < s->distance[s->heap[child]])
            child++;
        if (!(s->distance[s->heap[child]] < s->distance[v])) break;
        s->heap[at] = s->heap[child];
        s->slot[s->heap[at]] = at;
        at = child;
    }
    s->heap[at] = v;
    s->slot[v] = at;
    s->slot[top] = -1;
    return top;
}

static void reach(Search *s, int vertex, double distance, int from)
{
    if (!(distance < s->distance[vertex])) return;
    s->distance[vertex] = distance;
    s->from[vertex] = from;
    if (s->slot[vertex] < 0) {
        s->slot[vertex] = s->count;
        s->heap[s->count++] = vertex;
    }
    sift_up(s, s->slot[vertex]);
}

/* Lowers distances to those from one more vertex; from[] leads back to it where they fell. */
static void search_from(Search *s, int root)
{
    const RefTriangulation *surface = s->surface;
    reach(s, root, 0, -1);
    while (s->count > 0) {
        int v = pop(s), first = surface->corner[v], at = first;
        do {
            reach(s, surface->vertex[ref_corner_next(at)], s->distance[v] + surface->length[at],
                  at);
            at = ref_corner_left(surface, at);
        } while (at >= 0 && at != first);
    }
}

static void forget(Search *s)
{
    for (long v = 0; v < s->surface->vertices; v++) {
        s->distance[v] = INFINITY;
        s->from[v] = s->slot[v] = -1;
    }
}

/* The vertex that is farthest of those that are not on a rim, or -1. */
static int farthest(const Search *s)
{
    const RefTriangulation *surface = s->surface;
    int best = -1;
    for (int v = 0; v < surface->vertices; v++)
        if (surface->rim[surface->corner[v]] < 0 && s->distance[v] > 0 &&
            (best < 0 || s->distance[v] > s->distance[best]))
            best = v;
    return best;
}

/* Cuts along the shortest way between two vertices; where that was cut, it is whole again. */
static void slit(Search *s, int from, int to, bool *cut)
{
    forget(s);
    search_from(s, from);
    for (int at = s->from[to]; at >= 0; at = s->from[s->surface->vertex[at]]) {
        int twin = s->surface->twin[at];
        if (twin >= 0) cut[at] = cut[twin] = !cut[at];
    }
}

static Search search_new(const RefTriangulation *surface)
{
    size_t size = (size_t)surface->vertices;
    Search s = {.surface = surface,
                .distance = sm_alloc(size, sizeof(double)),
                .from = sm_alloc(size, sizeof(int)),
                .heap = sm_alloc(size, sizeof(int)),
                .slot = sm_alloc(size, sizeof(int))};
    forget(&s);
    return s;
}

static void search_free(Search *s)
{
    sm_free_all(s->distance, s->from, s->heap, s->slot);
}

/* An edge that closes a loop with the ways from the root to its ends. */
typedef struct {
    double length; /* of the loop, without what both ways share */
    int corner;
} Loop;

static int longer(const void *a, const void *b)
{
    const Loop *p = a, *q = b;
    return (p->length < q->length) - (p->length > q->length);
}

/* Walks from an edge's ends towards the root until the ways meet; writes their corners unless
 * `loop` is NULL, and returns how many they and the edge are. */
static long walk_loop(const Search *s, int corner, double *length, int *loop)
{
    const RefTriangulation *surface = s->surface;
    int end[2] = {surface->vertex[corner], surface->vertex[ref_corner_next(corner)]};
    long count = 1;
    *length = surface->length[corner];
    if (loop) loop[0] = corner;
    while (end[0] != end[1]) {
        bool second = s->from[end[0]] < 0 ||
                      (s->from[end[1]] >= 0 && s->distance[end[1]] > s->distance[end[0]]);
        int step = s->from[end[second]];
        *length += surface->length[step];
        if (loop) loop[count] = step;
        count++;
        end[second] = surface->vertex[step];
    }
    return count;
}

/* Edges that are not in the tree, with the loops that they close, longest first. */
static long find_loops(const Search *s, Loop *loop)
{
    const RefTriangulation *surface = s->surface;
    long count = 0;
    for (int c = 0; c < 3 * surface->triangles; c++) {
        int twin = surface->twin[c], to = surface->vertex[ref_corner_next(c)];
        if (twin > c || s->from[to] == c) continue;
        if (twin >= 0 && s->from[surface->vertex[c]] == twin) continue;
        walk_loop(s, c, &loop[count].length, NULL);
        loop[count++].corner = c;
    }
    qsort(loop, (size_t)count, sizeof *loop, longer);
    return count;
}

/* Whether a loop meets a rim, where it cannot be cut. */
static bool meets_rim(const RefTriangulation *surface, long count, const int *loop)
{
    for (long n = 0; n < count; n++)
        for (int k = 0; k < 2; k++) {
            int corner = k ? ref_corner_next(loop[n]) : loop[n];
            if (surface->rim[surface->corner[surface->vertex[corner]]] >= 0) return true;
        }
    return false;
}

long ref_cuts_handle(const RefTriangulation *surface, double limit, int *loop)
{
    Search s = search_new(surface);
    Loop *all = sm_alloc(3 * (size_t)surface->triangles, sizeof *all), best = {INFINITY, -1};
    search_from(&s, 0);
    long count = find_loops(&s, all), found = 0;
    SmPieces pieces; /* of triangles, and of rims as such, joined across edges */
    sm_pieces_init(surface->triangles + surface->rims, &pieces);
    for (long n = 0; n < count; n++) {
        int c = all[n].corner, twin = surface->twin[c];
        long other = twin < 0 ? surface->triangles + surface->rim[c] : twin / 3;
        bool independent = sm_pieces_first(&pieces, c / 3) == sm_pieces_first(&pieces, other) &&
                           !meets_rim(surface, walk_loop(&s, c, &all[n].length, loop), loop);
        if (independent) best = all[n];
        sm_pieces_link(&pieces, c / 3, other);
    }
    if (best.length <= limit * sqrt(ref_triangulation_area(surface)))
        found = walk_loop(&s, best.corner, &best.length, loop);
    sm_pieces_free(&pieces);
    search_free(&s);
    free(all);
    return found;
}

/* What the angles at every vertex lack to 2 pi, on a rim to pi, and the vertices' shares of the
 * area. */
static void bend(const RefTriangulation *surface, double *curvature, double *share)
{
    double whole = ref_triangulation_area(surface), cotangent[3];
    for (long v = 0; v < surface->vertices; v++)
        curvature[v] = surface->rim[surface->corner[v]] < 0 ? 2 * M_PI : M_PI;
    for (long t = 0; t < surface->triangles; t++) {
        double area = ref_triangle_shape(surface->length + 3 * t, cotangent) / 2;
        for (int i = 0; i < 3; i++) {
            curvature[surface->vertex[3 * t + i]] -= atan2(1, cotangent[i]);
            share[surface->vertex[3 * t + i]] += area / 3 / whole;
        }
    }
}

/* Moves a function to the mean 0 over the area. */
static void centre(long count, const double *share, double *u)
{
    double mean = 0;
    for (long v = 0; v < count; v++) mean += share[v] * u[v];
    for (long v = 0; v < count; v++) u[v] -= mean;
}

/* The mean squares and products of functions: those of candidates, and behind them that of the
 * curvature and, for a disk, those of some choices of four corners. */
enum { CORNERS = 3, MOST_FUNCTIONS = CANDIDATES + 1 + CORNERS };
typedef double Products[MOST_FUNCTIONS][MOST_FUNCTIONS];

/* The variance of log L with these branch points, the curvature's function being number `count`. */
static double variance(const Products product, int count, int wanted, const int *pick)
{
    double sum = product[count][count];
    for (int i = 0; i < wanted; i++) {
        sum -= 2 * product[pick[i]][count];
        for (int j = 0; j < wanted; j++) sum += product[pick[i]][pick[j]];
    }
    return sum;
}

/* Tries all choices of `wanted` candidates behind the first `from`. */
static void choose_from(const Products product, int count, int wanted, int level, int *pick,
                        double *least, int *best)
{
    if (level == wanted) {
        double found = variance(product, count, wanted, pick);
        if (!(found < *least)) return;
        *least = found;
        memcpy(best, pick, (size_t)wanted * sizeof *pick);
        return;
    }
    for (pick[level] = level ? pick[level - 1] + 1 : 0; pick[level] < count; pick[level]++)
        choose_from(product, count, wanted, level + 1, pick, least, best);
}

/* Functions of all that may turn the plane, and their products. */
static SmCode multiply(const RefTriangulation *surface, const double *weight, int count,
                       const int *candidate, int choices, int (*corner)[4], Products product,
                       SmError *error)
{
    double *u[MOST_FUNCTIONS], *share = sm_alloc((size_t)surface->vertices, sizeof *share);
    int functions = count + 1 + choices;
    for (int k = 0; k < functions; k++) u[k] = sm_alloc((size_t)surface->vertices, sizeof **u);
    for (int k = 0; k < count; k++) u[k][candidate[k]] = M_PI;
    bend(surface, u[count], share);
    for (int n = 0; n < choices; n++)
        for (int k = 0; k < 4; k++) u[count + 1 + n][surface->vertex[corner[n][k]]] = M_PI / 2;
    SmCode code = ref_harmonic_potentials(surface, weight, functions, u, u, error);
    for (int k = 0; k < functions && code == SM_OK; k++) centre(surface->vertices, share, u[k]);
    for (int i = 0; i < functions && code == SM_OK; i++)
        for (int j = 0; j <= i; j++) {
            for (long v = 0; v < surface->vertices; v++)
                product[i][j] += share[v] * u[i][v] * u[j][v];
            product[j][i] = product[i][j];
        }
    for (int k = 0; k < functions; k++) free(u[k]);
    free(share);
    return code;
}

/* Of the candidates, the `wanted` ones that let log L vary least, unless the best four corners of a
 * disk, which are simpler, let it vary as little or nearly so. */
static SmCode choose_tips(const RefTriangulation *surface, const double *weight, int count,
                          const int *candidate, int wanted, int tip[4], bool *found, int corner[4],
                          SmError *error)
{
    int pick[5], best[4] = {0}, corners[CORNERS][4] = {{0}}, choices = wanted == 2 ? CORNERS : 0;
    double least = INFINITY, least_flat = INFINITY, share = 1.0 / 48;
    Products product = {{0}};
    for (int n = 0; n < choices; n++, share /= 4) find_corners(surface, share, corners[n]);
    SmCode code = multiply(surface, weight, count, candidate, choices, corners, product, error);
    const double(*products)[MOST_FUNCTIONS] = (const double(*)[MOST_FUNCTIONS])product;
    choose_from(products, count, wanted, 0, pick, &least, best);
    for (int k = 0; k < wanted; k++) tip[k] = candidate[best[k]];
    for (int n = 0; n < choices; n++) {
        int one = count + 1 + n;
        double flat = variance(products, count, 1, &one);
        if (!(flat < least_flat)) continue;
        least_flat = flat;
        memcpy(corner, corners[n], sizeof corners[n]);
    }
    *found = least < 0.5 * least_flat;
    return code;
}

SmCode ref_cuts_slits(const RefTriangulation *surface, const double *weight, bool *cut, int *tip,
                      int corner[4], SmError *error)
{
    Search s = search_new(surface);
    int candidate[CANDIDATES] = {0}, tips[4], count = 0, wanted = surface->rims ? 2 : 4;
    bool found = false;
    search_from(&s, 0);
    int next = farthest(&s);
    forget(&s);
    for (; next >= 0 && count < CANDIDATES; count++) {
        candidate[count] = next;
        search_from(&s, next);
        next = farthest(&s);
    }
    SmCode code =
        choose_tips(surface, weight, count, candidate, wanted, tips, &found, corner, error);
    *tip = -1;
    if (code == SM_OK && found) {
        for (int k = 0; k < wanted; k += 2) slit(&s, tips[k], tips[k + 1], cut);
        *tip = surface->corner[tips[0]];
    }
    search_free(&s);
    return code;
}
