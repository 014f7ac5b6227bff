#include "cell_components.h"

#include <stdlib.h>
#include <string.h>

static int step_along(int direction, int axis)
{
    static const int power[3] = {1, 3, 9};
    return direction / power[axis] % 3 - 1;
}

/* Children of a cell that lie at its border in a direction. */
static int facing(int direction)
{
    int mask = 0;
    for (int o = 0; o < 8; o++) {
        bool there = true;
        for (int a = 0; a < 3; a++) {
            int step = step_along(direction, a);
            there = there && (step == 0 || (step > 0) == (o >> a & 1));
        }
        mask |= there << o;
    }
    return mask;
}

/* The finest cells of a 2 x 2 x 2 cell all touch, and so do those that face each other across its
 * border: one component each, and contacts by masks. */
static void build_lowest(OctCellComponents *p, int level)
{
    const OctTree *t = p->tree;
    OctLayer *layer = &p->layer[level];
    long from = t->level_first[level], n = t->level_first[level + 1] - from;
    int face[OCT_DIRECTIONS];
    SmCsrParts contacts;
    layer->components = n;
    layer->first = sm_alloc((size_t)n + 1, sizeof *layer->first);
    layer->node = sm_alloc((size_t)n, sizeof *layer->node);
    sm_csr_parts_init(&contacts, n);
    for (int d = 0; d < OCT_DIRECTIONS; d++) face[d] = facing(d);
    for (long c = 0; c < n; c++) {
        int touching[OCT_DIRECTIONS], count = 0;
        layer->first[c] = (int)c;
        layer->node[c] = (int)(from + c);
        for (int d = 0; d < OCT_DIRECTIONS; d++) {
            int other = p->beside[from + c][d];
            if (d == OCT_HERE || other < 0) continue;
            if (p->octants[from + c] & face[d] && p->octants[other] & face[OCT_DIRECTIONS - 1 - d])
                touching[count++] = (int)(other - from);
        }
        sm_csr_parts_add(&contacts, c, touching, count);
    }
    layer->first[n] = (int)n;
    sm_csr_parts_join(&contacts, &layer->contacts, 0);
}

static int root_of(int *up, int i)
{
    while (up[i] != i) i = up[i] = up[up[i]];
    return i;
}

/* The lower index becomes the root, so that roots come before what they stand for. */
static void unite(int *up, int i, int j)
{
    i = root_of(up, i);
    j = root_of(up, j);
    up[i > j ? i : j] = i < j ? i : j;
}

/* Joins the components below that touch within one cell; numbers the cells' components. Returns the
 * owner of each one below: the component that it belongs to. */
static int *join_components(const OctTree *t, int level, const OctLayer *below, OctLayer *layer)
{
    long from = t->level_first[level], n = t->level_first[level + 1] - from;
    int *up = sm_alloc((size_t)below->components, sizeof *up);
    for (int i = 0; i < below->components; i++) up[i] = i;
    for (int i = 0; i < below->components; i++)
        for (long c = below->contacts.first[i]; c < below->contacts.end[i]; c++)
            if (t->parent[below->node[below->contacts.item[c]]] == t->parent[below->node[i]])
                unite(up, i, below->contacts.item[c]);
    layer->first = sm_alloc((size_t)n + 1, sizeof *layer->first);
    int *owner = sm_alloc((size_t)below->components, sizeof *owner);
    for (int i = 0; i < below->components; i++) {
        int root = root_of(up, i);
        owner[i] = root == i ? (int)layer->components++ : owner[root];
        layer->first[t->parent[below->node[i]] - from + 1] = (int)layer->components;
    }
    layer->node = sm_alloc((size_t)layer->components, sizeof *layer->node);
    for (int i = 0; i < below->components; i++) layer->node[owner[i]] = t->parent[below->node[i]];
    free(up);
    return owner;
}

/* Components below in the order of their owners. */
static int *members_of(const int *owner, const OctLayer *below, long owners, long *first)
{
    int *member = sm_alloc((size_t)below->components, sizeof *member);
    for (long i = 0; i < below->components; i++) first[owner[i] + 1]++;
    for (long q = 0; q < owners; q++) first[q + 1] += first[q];
    for (int i = 0; i < below->components; i++) member[first[owner[i]]++] = i;
    memmove(first + 1, first, (size_t)owners * sizeof *first);
    first[0] = 0;
    return member;
}

static void join_contacts(const int *owner, const OctLayer *below, OctLayer *layer)
{
    size_t components = (size_t)layer->components;
    long *first = sm_alloc(components + 1, sizeof *first);
    int *member = members_of(owner, below, layer->components, first);
    int *seen = sm_alloc(components, sizeof *seen); /* by which one, from 1 */
    SmCsrParts contacts;
    sm_csr_parts_init(&contacts, layer->components);
    for (int q = 0; q < layer->components; q++) {
        seen[q] = q + 1;
        for (long m = first[q]; m < first[q + 1]; m++)
            for (long c = below->contacts.first[member[m]]; c < below->contacts.end[member[m]];
                 c++) {
                int other = owner[below->contacts.item[c]];
                if (seen[other] == q + 1) continue;
                seen[other] = q + 1;
                sm_csr_parts_add(&contacts, q, &other, 1);
            }
    }
    sm_csr_parts_join(&contacts, &layer->contacts, 0);
    sm_free_all(first, member, seen);
}

void oct_components_build(const OctTree *whole, OctCellComponents *components)
{
    size_t inner = (size_t)whole->level_first[whole->levels];
    *components = (OctCellComponents){.tree = whole};
    components->octants = oct_tree_octants(whole);
    components->beside = sm_alloc(inner, sizeof *components->beside);
    for (int n = 0; n < (int)inner; n++)
        if (n < whole->roots)
            oct_neighbours_of_root(whole, n, components->beside[n]);
        else
            oct_neighbours_of_child(whole, components->octants,
                                    components->beside[whole->parent[n]], n, components->beside[n]);
    build_lowest(components, whole->levels - 1);
    for (int l = whole->levels - 2; l >= 0; l--) {
        int *owner = join_components(whole, l, &components->layer[l + 1], &components->layer[l]);
        join_contacts(owner, &components->layer[l + 1], &components->layer[l]);
        free(owner);
    }
}

void oct_components_free(OctCellComponents *components)
{
    for (int l = 0; l < OCT_MAX_LEVELS; l++) {
        free(components->layer[l].first);
        free(components->layer[l].node);
        sm_csr_free(&components->layer[l].contacts);
    }
    free(components->octants);
    free(components->beside);
    memset(components, 0, sizeof *components);
}

/* The cells of a box of up to 2 x 2 x 2 cells, and where their components are in a list of them
 * all. */
typedef struct {
    int cells, node[8], first[8], offset[8];
    int components;
} Box;

static Box box_around(const OctCellComponents *p, const OctLayer *layer, long from, int node,
                      int direction)
{
    Box box = {0};
    for (int s = 0; s < 8; s++) {
        int to = OCT_HERE, power = 1;
        bool twice = false;
        for (int a = 0; a < 3; a++, power *= 3) {
            int step = (s >> a & 1) * step_along(direction, a);
            twice = twice || (s >> a & 1 && !step);
            to += step * power;
        }
        int cell = p->beside[node][to];
        if (twice || cell < 0) continue;
        box.node[box.cells] = cell;
        box.first[box.cells] = layer->first[cell - from];
        box.offset[box.cells++] = box.components;
        box.components += layer->first[cell - from + 1] - layer->first[cell - from];
    }
    return box;
}

static void unite_box(const OctLayer *layer, const Box *box, int *up)
{
    for (int i = 0; i < box->components; i++) up[i] = i;
    for (int b = 0; b < box->cells; b++) {
        int end = b + 1 < box->cells ? box->offset[b + 1] : box->components;
        for (int i = box->offset[b]; i < end; i++) {
            int component = box->first[b] + i - box->offset[b];
            for (long c = layer->contacts.first[component]; c < layer->contacts.end[component];
                 c++) {
                int other = layer->contacts.item[c];
                for (int o = 0; o < b; o++)
                    if (box->node[o] == layer->node[other])
                        unite(up, i, box->offset[o] + other - box->first[o]);
            }
        }
    }
}

static bool touch(const OctLayer *layer, int component, int other)
{
    for (long c = layer->contacts.first[component]; c < layer->contacts.end[component]; c++)
        if (layer->contacts.item[c] == other) return true;
    return false;
}

bool oct_components_weld(const OctCellComponents *p, int node, int direction)
{
    int level = oct_tree_level(p->tree, node), other = p->beside[node][direction];
    const OctLayer *layer = &p->layer[level];
    if (other < 0) return false;
    long from = p->tree->level_first[level];
    const int *mine = layer->first + (node - from), *theirs = layer->first + (other - from);
    if (direction == OCT_HERE) return mine[1] - mine[0] > 1;
    bool single = mine[1] - mine[0] == 1 && theirs[1] - theirs[0] == 1;
    if (single && touch(layer, mine[0], theirs[0])) return false;
    Box box = box_around(p, layer, from, node, direction);
    int *up = sm_alloc((size_t)box.components, sizeof *up), one = -1;
    unite_box(layer, &box, up);
    bool weld = false;
    for (int b = 0; b < box.cells; b++) {
        if (box.node[b] != node && box.node[b] != other) continue;
        int end = b + 1 < box.cells ? box.offset[b + 1] : box.components;
        for (int i = box.offset[b]; i < end; i++) {
            int root = root_of(up, i);
            weld = weld || (one >= 0 && root != one);
            one = root;
        }
    }
    free(up);
    return weld;
}
