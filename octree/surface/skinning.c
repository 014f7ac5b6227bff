#include "skinning.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/cut/cut.h"
#include "../../lib/voxel/voxel.h"

enum { HIDERS = 16 };

/* What a vertex at X sees. Triangles of the cut that have hidden something hide what is beyond it
 * as a rule: they are asked first, the last of them before all others. */
typedef struct {
    const OctCarrier *carrier;
    const double *X;
    long hider[HIDERS];
    int hiders;
} View;

/* The search for the nearest leaf that a vertex sees. */
typedef struct {
    View *view;
    const double *q;
    int best;        /* a tree node, or -1 */
    double distance; /* to its centre in the max norm, half finest cells; what is farther is no
                        use */
} Search;

/* Moves hider number `at` to the front. */
static void to_front(View *view, int at)
{
    long triangle = view->hider[at];
    memmove(view->hider + 1, view->hider, (size_t)at * sizeof *view->hider);
    view->hider[0] = triangle;
}

static bool sees(View *view, int node)
{
    const SmCut *cut = view->carrier->cut;
    double centre[3];
    if (!cut) return true;
    oct_tree_centre(view->carrier->tree, view->carrier->voxels, node, centre);
    for (int n = 0; n < view->hiders; n++)
        if (sm_cut_crosses_one(cut, view->hider[n], view->X, centre)) {
            to_front(view, n);
            return false;
        }
    long triangle = sm_cut_crossed(cut, 0, view->X, centre);
    if (triangle < 0) return true;
    if (view->hiders < HIDERS) view->hiders++;
    view->hider[view->hiders - 1] = triangle;
    to_front(view, view->hiders - 1);
    return false;
}

/* Is all that lies in a node hidden by one triangle? */
static bool is_hidden(View *view, int node)
{
    const OctCarrier *c = view->carrier;
    double centre[3], half = 0.25 * c->voxels->cell * c->tree->size[node];
    oct_tree_centre(c->tree, c->voxels, node, centre);
    for (int n = 0; n < view->hiders; n++)
        if (sm_cut_hides(c->cut, view->hider[n], view->X, centre, half)) {
            to_front(view, n);
            return true;
        }
    return false;
}

static double distance_to(const OctTree *tree, int node, const double q[3])
{
    double distance = 0;
    for (int d = 0; d < 3; d++) distance = fmax(distance, fabs(q[d] - tree->centre[node][d]));
    return distance;
}

/* Of two nodes as near, the one whose centre comes first, whatever their numbers. */
static bool comes_before(const OctTree *tree, int node, int other)
{
    for (int d = 0; d < 3; d++)
        if (tree->centre[node][d] != tree->centre[other][d])
            return tree->centre[node][d] < tree->centre[other][d];
    return false;
}

static void look_at(Search *s, int node, double distance)
{
    const OctTree *tree = s->view->carrier->tree;
    if (tree->leaf[node] < 0 || distance > s->distance) return;
    if (distance == s->distance && s->best >= 0 && !comes_before(tree, node, s->best)) return;
    if (!sees(s->view, node)) return;
    s->best = node;
    s->distance = distance;
}

/* Nearer children come first, so that what is found leaves little to search. */
static void search_cell(Search *s, int node)
{
    const OctTree *tree = s->view->carrier->tree;
    double distance = distance_to(tree, node, s->q), away[8];
    int child[8], children = tree->children[node];
    if (distance - 0.5 * tree->size[node] > s->distance) return;
    if (children && is_hidden(s->view, node)) return;
    for (int i = 0; i < children; i++) {
        double here = distance_to(tree, tree->child[node] + i, s->q);
        int at = i;
        for (; at > 0 && away[at - 1] > here; at--) {
            away[at] = away[at - 1];
            child[at] = child[at - 1];
        }
        away[at] = here;
        child[at] = tree->child[node] + i;
    }
    for (int i = 0; i < children; i++) search_cell(s, child[i]);
    look_at(s, node, distance);
}

/* The base cell that is so many base cells on from that of q, if anything in it may be of use. */
static void search_base(Search *s, const int base[3], const int on[3])
{
    const OctTree *tree = s->view->carrier->tree;
    int wide = 1 << tree->levels, low[3];
    for (int d = 0; d < 3; d++) {
        low[d] = tree->corner[d] + (base[d] + on[d]) * wide;
        if (fabs(s->q[d] - 2 * low[d] - wide) - wide > s->distance) return;
    }
    int root = oct_tree_at(tree, 0, low[0], low[1], low[2]);
    if (root >= 0) search_cell(s, root);
}

/* All base cells within `distance`, a base cell's size: those around that of q come first. */
static void search_around(Search *s, double distance)
{
    const OctTree *tree = s->view->carrier->tree;
    int base[3], on[3], wide = 1 << tree->levels;
    for (int d = 0; d < 3; d++) base[d] = (int)floor((s->q[d] / 2 - tree->corner[d]) / wide);
    s->distance = distance;
    for (int ring = 0; ring <= 2; ring++)
        for (on[2] = -ring; on[2] <= ring; on[2]++)
            for (on[1] = -ring; on[1] <= ring; on[1]++) {
                bool inner = abs(on[2]) < ring && abs(on[1]) < ring;
                for (on[0] = -ring; on[0] <= ring; on[0] += inner ? 2 * ring : 1)
                    search_base(s, base, on);
            }
}

/* The leaf that holds a vertex, or the nearest material; its place becomes `skin->q`. */
static int find_home(const OctCarrier *c, const double X[3], OctSkin *skin)
{
    int cell[3];
    for (int d = 0; d < 3; d++) skin->q[d] = (X[d] - c->voxels->origin[d]) / c->voxels->cell;
    sm_nearest_cell(c->voxels, skin->q, cell);
    for (int d = 0; d < 3; d++) skin->q[d] = 2 * fmin(fmax(skin->q[d], cell[d]), cell[d] + 1);
    return oct_tree_find(c->tree, cell[0], cell[1], cell[2]);
}

static double farthest(const OctCarrier *c)
{
    return 2 << c->tree->levels;
}

/* How far X is from where it counts as, plus how far its leaf was looked for. */
static double find_reach(const OctCarrier *c, const double X[3], double searched, const double q[3])
{
    double outside = 0;
    for (int d = 0; d < 3; d++)
        outside = fmax(outside, fabs(2 * (X[d] - c->voxels->origin[d]) / c->voxels->cell - q[d]));
    return (outside + searched) * 0.5 * c->voxels->cell * (1 + 1e-6);
}

static void take(const Search *s, OctSkin *skin)
{
    const OctCarrier *c = s->view->carrier;
    double reach = find_reach(c, s->view->X, s->distance, skin->q);
    if (s->best >= 0) skin->own = c->tree->leaf[s->best];
    skin->reach = (float)(s->best >= 0 ? reach : -reach);
}

/* The leaf that a vertex belongs to, and how far it was looked for. */
static void find_own(View *view, int home, OctSkin *skin)
{
    const OctCarrier *c = view->carrier;
    skin->own = c->tree->leaf[home];
    skin->reach = 0;
    if (sees(view, home)) return;
    Search s = {.view = view, .q = skin->q, .best = -1};
    search_around(&s, farthest(c));
    take(&s, skin);
}

/* w_k at place q, not yet made to add up to 1: along each axis 1 at the node, 1/2 at its cell's
 * side, 0 at a cell's width, with slope 0 at both ends. */
static double weigh(const OctTree *tree, int leaf, const double q[3])
{
    int node = tree->node[leaf];
    double size = tree->size[node], weight = 1 / size;
    for (int d = 0; d < 3; d++) {
        double t = fmin(fabs(q[d] - tree->centre[node][d]) / size, 1);
        weight *= (1 - t) * (1 - t) * (1 + 2 * t);
    }
    return weight;
}

static void add(OctSkin *skin, int leaf, double weight)
{
    if (skin->count == skin->room) {
        skin->room = 2 * skin->room + 32;
        skin->leaf = sm_realloc(skin->leaf, (size_t)skin->room, sizeof *skin->leaf);
        skin->weight = sm_realloc(skin->weight, (size_t)skin->room, sizeof *skin->weight);
    }
    skin->leaf[skin->count] = leaf;
    skin->weight[skin->count++] = (float)weight;
}

/* The sum of the neighbours' numbers, mixed (splitmix64, Steele et al. 2014): in any order. */
uint64_t oct_skin_edges(const OctGraph *graph, int leaf)
{
    uint64_t sum = 0;
    for (long e = graph->edges.first[leaf]; e < graph->edges.end[leaf]; e++) {
        uint64_t z = ((uint64_t)graph->edges.item[e] + 1) * 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        sum += z ^ z >> 31;
    }
    return sum;
}

/* The neighbours that move the vertex beside its own leaf. */
static void find_others(View *view, OctSkin *skin)
{
    const OctCarrier *c = view->carrier;
    double own = weigh(c->tree, skin->own, skin->q), sum = own;
    skin->count = 0;
    add(skin, skin->own, 0);
    for (long e = c->graph->edges.first[skin->own]; e < c->graph->edges.end[skin->own]; e++) {
        int leaf = c->graph->edges.item[e];
        double weight = weigh(c->tree, leaf, skin->q);
        if (!(weight > 1e-9 * own) || !sees(view, c->tree->node[leaf])) continue;
        add(skin, leaf, weight);
        sum += weight;
    }
    for (long n = 1; n < skin->count; n++) skin->weight[n] = (float)((double)skin->weight[n] / sum);
}

void oct_skin_find(const OctCarrier *c, const double X[3], OctSkin *skin)
{
    View view = {.carrier = c, .X = X};
    find_own(&view, find_home(c, X, skin), skin);
    find_others(&view, skin);
}

/* Goes on from what a search has found where new leaves have come; false where it is not known what
 * it found. */
static bool look_again(View *view, int home, long count, const int *node, OctSkin *skin)
{
    const OctTree *tree = view->carrier->tree;
    int own = tree->node[skin->own];
    bool seen = skin->reach >= 0;
    if ((skin->reach <= 0) != (own == home)) return false;
    if (skin->reach == 0) return sees(view, home);
    Search s = {.view = view, .q = skin->q, .best = -1, .distance = farthest(view->carrier)};
    if (seen) {
        OctSkin known = *skin;
        s.best = own;
        s.distance = distance_to(tree, own, skin->q);
        take(&s, &known);
        if (known.reach != skin->reach) return false;
    }
    for (long n = 0; n < count; n++) {
        if (node[n] == home) return false;
        if (tree->size[node[n]] > 0) look_at(&s, node[n], distance_to(tree, node[n], skin->q));
    }
    take(&s, skin);
    return true;
}

void oct_skin_update(const OctCarrier *c, const double X[3], long count, const int *node,
                     OctSkin *skin)
{
    View view = {.carrier = c, .X = X};
    int home = find_home(c, X, skin);
    if (!look_again(&view, home, count, node, skin)) find_own(&view, home, skin);
    find_others(&view, skin);
}

void oct_skin_free(OctSkin *skin)
{
    free(skin->leaf);
    free(skin->weight);
    *skin = (OctSkin){0};
}
