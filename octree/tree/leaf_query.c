#include "leaf_query.h"

#include <math.h>
#include <stdlib.h>

#include "../../lib/predicates.h"

/* A place: a box, and perhaps a triangle in it, half finest cells. */
typedef struct {
    double low[3], high[3];
    const double (*corner)[3]; /* of the triangle, or NULL */
    double margin;             /* of the triangle */
    int least;                 /* leaves that are smaller do not count, half finest cells */
    OctLeafQueryKind kind;
} Place;

void oct_leaf_query_init(OctLeafQuery *query, const OctTree *tree, const SmVoxels *voxels)
{
    *query = (OctLeafQuery){.tree = tree};
    for (int d = 0; d < 3; d++)
        query->wide[d] = ((voxels->size[d] - tree->corner[d] - 1) >> tree->levels) + 1;
}

void oct_leaf_query_free(OctLeafQuery *query)
{
    free(query->node);
    *query = (OctLeafQuery){0};
}

static bool meets(const Place *place, const double centre[3], double half)
{
    for (int d = 0; d < 3; d++)
        if (centre[d] + half < place->low[d] || centre[d] - half > place->high[d]) return false;
    double grown = half + place->margin;
    return !place->corner ||
           sm_triangle_meets_box(place->corner, centre, (double[3]){grown, grown, grown});
}

/* Could a node's leaves, or does a leaf, count? A leaf below an inner node is half its size at the
 * most, and so reaches a quarter of it beyond. */
static bool node_meets(const OctTree *tree, const Place *place, int node)
{
    double size = tree->size[node], half = size / 2, centre[3];
    if (place->kind == OCT_REACHES) half += tree->children[node] ? size / 4 : size / 2;
    for (int d = 0; d < 3; d++) centre[d] = tree->centre[node][d];
    return meets(place, centre, half);
}

static void add(OctLeafQuery *query, int node)
{
    sm_make_room(query->node, query->room, query->count + 1);
    query->node[query->count++] = node;
}

static void visit(OctLeafQuery *query, const Place *place, int root)
{
    const OctTree *t = query->tree;
    OctStack stack;
    oct_stack_begin(&stack, root);
    while (stack.count > 0) {
        int node = oct_stack_take(&stack);
        if (t->size[node] < (t->children[node] ? 2 : 1) * place->least) continue;
        if (!node_meets(t, place, node)) continue;
        if (!t->children[node]) add(query, node);
        oct_stack_put(&stack, t->child[node], t->children[node]);
    }
}

/* Base cells along axis d whose reach meets the place: from[d] .. to[d]. */
static void find_bases(const OctLeafQuery *query, const Place *place, int from[3], int to[3])
{
    const OctTree *t = query->tree;
    double size = 2 << t->levels, more = place->kind == OCT_REACHES ? size / 2 : 0;
    for (int d = 0; d < 3; d++) {
        double corner = 2.0 * t->corner[d], last = query->wide[d] - 1;
        from[d] = (int)fmax(0, fmin(last + 1, ceil((place->low[d] - more - corner) / size) - 1));
        to[d] = (int)fmin(last, fmax(-1, floor((place->high[d] + more - corner) / size)));
    }
}

static void search(OctLeafQuery *query, const Place *place)
{
    const OctTree *t = query->tree;
    int from[3], to[3], at[3], wide = 1 << t->levels;
    double grown = place->kind == OCT_REACHES ? 2 * wide : wide;
    query->count = 0;
    find_bases(query, place, from, to);
    for (at[2] = from[2]; at[2] <= to[2]; at[2]++)
        for (at[1] = from[1]; at[1] <= to[1]; at[1]++)
            for (at[0] = from[0]; at[0] <= to[0]; at[0]++) {
                double centre[3];
                int low[3];
                for (int d = 0; d < 3; d++) {
                    low[d] = t->corner[d] + wide * at[d];
                    centre[d] = 2.0 * low[d] + wide;
                }
                if (!meets(place, centre, grown)) continue;
                int root = oct_tree_at(t, 0, low[0], low[1], low[2]);
                if (root >= 0) visit(query, place, root);
            }
}

void oct_leaf_query_cell(OctLeafQuery *query, int node, OctLeafQueryKind kind)
{
    const OctTree *t = query->tree;
    Place place = {.kind = kind};
    for (int d = 0; d < 3; d++) {
        place.low[d] = t->centre[node][d] - t->size[node] / 2;
        place.high[d] = place.low[d] + t->size[node];
    }
    search(query, &place);
}

void oct_leaf_query_triangle(OctLeafQuery *query, const double corner[3][3], double margin,
                             int level, OctLeafQueryKind kind)
{
    int levels = query->tree->levels;
    Place place = {.corner = corner, .margin = margin, .kind = kind};
    place.least = (4 << levels) >> (level <= levels ? level : levels + 1);
    for (int d = 0; d < 3; d++) {
        place.low[d] = fmin(corner[0][d], fmin(corner[1][d], corner[2][d])) - margin;
        place.high[d] = fmax(corner[0][d], fmax(corner[1][d], corner[2][d])) + margin;
    }
    search(query, &place);
}
