#include "tie.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/nearest_cell.h"

/* The search for the nearest leaf that a vertex sees. */
typedef struct {
    const OctCarrier *carrier;
    const double *X, *q;
    int best;        /* a tree node, or -1 */
    double distance; /* to its centre in the max norm, half finest cells; what is farther is no
                        use */
} Search;

static void centre_of(const OctCarrier *c, int node, double centre[3])
{
    for (int d = 0; d < 3; d++)
        centre[d] = c->voxels->origin[d] + 0.5 * c->voxels->cell * c->tree->centre[node][d];
}

static bool sees(const OctCarrier *c, const double X[3], int node)
{
    double centre[3];
    if (!c->cut) return true;
    centre_of(c, node, centre);
    return !sm_cut_crosses(c->cut, 0, X, centre);
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

static void search_cell(Search *s, int node)
{
    const OctTree *tree = s->carrier->tree;
    double distance = distance_to(tree, node, s->q);
    if (distance - 0.5 * tree->size[node] > s->distance) return;
    for (int i = 0; i < tree->children[node]; i++) search_cell(s, tree->child[node] + i);
    if (tree->leaf[node] < 0 || distance > s->distance) return;
    if (distance == s->distance && s->best >= 0 && !comes_before(tree, node, s->best)) return;
    if (!sees(s->carrier, s->X, node)) return;
    s->best = node;
    s->distance = distance;
}

/* All base cells within `distance`. */
static void search_around(Search *s, double distance)
{
    const OctTree *tree = s->carrier->tree;
    int low[3], high[3], at[3], wide = 1 << tree->levels;
    for (int d = 0; d < 3; d++) {
        low[d] = (int)floor(((s->q[d] - distance) / 2 - tree->corner[d]) / wide);
        high[d] = (int)floor(((s->q[d] + distance) / 2 - tree->corner[d]) / wide);
    }
    s->distance = distance;
    for (at[2] = low[2]; at[2] <= high[2]; at[2]++)
        for (at[1] = low[1]; at[1] <= high[1]; at[1]++)
            for (at[0] = low[0]; at[0] <= high[0]; at[0]++) {
                int root =
                    oct_tree_at(tree, 0, tree->corner[0] + at[0] * wide,
                                tree->corner[1] + at[1] * wide, tree->corner[2] + at[2] * wide);
                if (root >= 0) search_cell(s, root);
            }
}

/* The leaf that a vertex belongs to; returns how far it was looked for, half finest cells. */
static double find_own(const OctCarrier *c, const double X[3], OctTie *tie)
{
    int cell[3];
    for (int d = 0; d < 3; d++) tie->q[d] = (X[d] - c->voxels->origin[d]) / c->voxels->cell;
    sm_nearest_cell(c->voxels, tie->q, cell);
    for (int d = 0; d < 3; d++) tie->q[d] = 2 * fmin(fmax(tie->q[d], cell[d]), cell[d] + 1);
    int node = oct_tree_find(c->tree, cell[0], cell[1], cell[2]);
    tie->own = c->tree->leaf[node];
    if (sees(c, X, node)) return 0;
    int distance = c->tree->size[node];
    for (; distance <= 2 << c->tree->levels; distance *= 2) {
        Search s = {.carrier = c, .X = X, .q = tie->q, .best = -1};
        search_around(&s, distance);
        if (s.best >= 0) {
            tie->own = c->tree->leaf[s.best];
            return distance;
        }
    }
    return 0.5 * distance;
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

static void add(OctTie *tie, int leaf, double weight)
{
    if (tie->count == tie->room) {
        tie->room = 2 * tie->room + 32;
        tie->leaf = sm_realloc(tie->leaf, (size_t)tie->room, sizeof *tie->leaf);
        tie->weight = sm_realloc(tie->weight, (size_t)tie->room, sizeof *tie->weight);
    }
    tie->leaf[tie->count] = leaf;
    tie->weight[tie->count++] = (float)weight;
}

/* The sum of the neighbours' numbers, mixed (splitmix64, Steele et al. 2014): in any order. */
uint64_t oct_tie_edges(const OctGraph *graph, int leaf)
{
    uint64_t sum = 0;
    for (long e = graph->first[leaf]; e < oct_graph_end(graph, leaf); e++) {
        uint64_t z = ((uint64_t)graph->to[e] + 1) * 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        sum += z ^ z >> 31;
    }
    return sum;
}

/* How far X is from where it counts as, plus how far its leaf was looked for. */
static double find_reach(const OctCarrier *c, const double X[3], double searched, const double q[3])
{
    double outside = 0;
    for (int d = 0; d < 3; d++)
        outside = fmax(outside, fabs(2 * (X[d] - c->voxels->origin[d]) / c->voxels->cell - q[d]));
    return (outside + searched) * 0.5 * c->voxels->cell;
}

void oct_tie_find(const OctCarrier *c, const double X[3], OctTie *tie)
{
    double searched = find_own(c, X, tie), own = weigh(c->tree, tie->own, tie->q), sum = own;
    tie->count = 0;
    add(tie, tie->own, 0);
    for (long e = c->graph->first[tie->own]; e < oct_graph_end(c->graph, tie->own); e++) {
        int leaf = c->graph->to[e];
        double weight = weigh(c->tree, leaf, tie->q);
        if (!(weight > 1e-9 * own) || !sees(c, X, c->tree->node[leaf])) continue;
        add(tie, leaf, weight);
        sum += weight;
    }
    for (long n = 1; n < tie->count; n++) tie->weight[n] = (float)((double)tie->weight[n] / sum);
    tie->reach = searched > 0 ? find_reach(c, X, searched, tie->q) : 0;
}

void oct_tie_free(OctTie *tie)
{
    free(tie->leaf);
    free(tie->weight);
    *tie = (OctTie){0};
}
