#include "patches.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../voxel/morton.h"

/* ---- the nodes of a body in groups that hang together, and upper bounds of the paths between them
 */

/* Ways are in half cells. A cluster's node `root` is its first. */
typedef struct {
    long count;
    int *of;         /* [nodes] a node's cluster */
    int *path;       /* [nodes] to it from the root, within the cluster */
    long *first;     /* [count + 1] */
    int *node;       /* [first[count]] */
    int *radius;     /* [count] longest path */
    SmBox *box;      /* [count] of the nodes */
    long *arc_first; /* [count + 1] */
    int *arc;        /* clusters that the graph joins a cluster to */
    int *length;     /* from root to root */
} Clusters;

enum {
    BITS = 21,        /* of a cube's coordinate */
    FAR = INT_MAX / 2 /* a path that has not been found */
};

/* A node and the cube that it is in. */
typedef struct {
    uint64_t cube;
    int node;
} Place;

/* Sorts by cubes, and leaves nodes of one in their order: by one byte after the other, the lowest
 * first, but for those that are the same in all. */
static Place *sort_places(Place *place, long count)
{
    Place *other = sm_alloc((size_t)count, sizeof *other);
    uint64_t differ = 0;
    for (long i = 0; i < count; i++) differ |= place[i].cube ^ place[0].cube;
    for (int shift = 0; shift < 64; shift += 8) {
        long start[257] = {0};
        if (!(differ >> shift & 255)) continue;
        for (long i = 0; i < count; i++) start[(place[i].cube >> shift & 255) + 1]++;
        for (int k = 0; k < 256; k++) start[k + 1] += start[k];
        for (long i = 0; i < count; i++) other[start[place[i].cube >> shift & 255]++] = place[i];
        Place *sorted = other;
        other = place;
        place = sorted;
    }
    free(other);
    return place;
}

static Place *sort_nodes(const SmCollideRest *rest, double width)
{
    Place *place = sm_alloc((size_t)rest->nodes, sizeof *place);
    for (long i = 0; i < rest->nodes; i++) {
        place[i].node = (int)i;
        for (int d = 0; d < 3; d++) {
            double at = floor(rest->x0[i][d] / width) + (1 << (BITS - 1));
            at = at < 0 ? 0 : at;
            uint64_t cube = (uint64_t)(at < (1 << BITS) - 1 ? at : (1 << BITS) - 1);
            place[i].cube |= sm_morton_apart(cube) << d;
        }
    }
    return sort_places(place, rest->nodes);
}

/* An edge between nodes of one cube. */
typedef struct {
    int from, to, length;
} Link;

/* Gives the nodes of a cube that its links join to its node `root` to a new cluster; paths of nodes
 * in none are FAR. Branches would cost more than they spare, here as below: what they depend on
 * follows no pattern. */
static void spread(const Place *place, long count, const Link *link, long links, int root,
                   Clusters *c)
{
    int p = (int)c->count++, changed = 1, *restrict best = c->path;
    best[root] = 0;
    while (changed) {
        changed = 0;
        for (long i = 0; i < links; i++) {
            int was = best[link[i].to], path = best[link[i].from] + link[i].length;
            changed |= path < was;
            best[link[i].to] = path < was ? path : was;
        }
    }
    for (long i = 0; i < count; i++)
        if (c->of[place[i].node] < 0 && c->path[place[i].node] < FAR) c->of[place[i].node] = p;
}

/* Links of the nodes of one cube; `cube` is [nodes]. There is room for one more. */
static long list_links(const SmCollideRest *rest, const Place *place, long count, const int *cube,
                       Link *restrict link)
{
    const int *restrict to = rest->to, *restrict length = rest->length;
    long links = 0;
    for (long i = 0; i < count; i++) {
        int a = place[i].node, own = cube[a];
        for (long e = rest->first[a], end = rest->first[a + 1]; e < end; e++) {
            link[links].from = a;
            link[links].to = to[e];
            link[links].length = length[e];
            links += cube[to[e]] == own;
        }
    }
    return links;
}

static void split(const SmCollideRest *rest, double width, Clusters *c)
{
    Place *place = sort_nodes(rest, width);
    int *cube = sm_alloc((size_t)rest->nodes, sizeof *cube);
    long room = 256;
    Link *link = sm_alloc((size_t)room, sizeof *link);
    for (long i = 1; i < rest->nodes; i++)
        cube[place[i].node] = cube[place[i - 1].node] + (place[i].cube != place[i - 1].cube);
    for (long i = 0, end; i < rest->nodes; i = end) {
        long most = 0;
        for (end = i; end < rest->nodes && place[end].cube == place[i].cube; end++)
            most += rest->first[place[end].node + 1] - rest->first[place[end].node];
        if (most >= room) {
            room = 2 * most;
            link = sm_realloc(link, (size_t)room, sizeof *link);
        }
        long links = list_links(rest, place + i, end - i, cube, link);
        for (long k = i; k < end; k++)
            if (c->of[place[k].node] < 0) spread(place + i, end - i, link, links, place[k].node, c);
    }
    sm_free_all(link, cube, place);
}

static void list_nodes(const SmCollideRest *rest, Clusters *c)
{
    size_t count = (size_t)c->count;
    c->first = sm_alloc(count + 1, sizeof *c->first);
    c->node = sm_alloc((size_t)rest->nodes, sizeof *c->node);
    c->radius = sm_alloc(count, sizeof *c->radius);
    c->box = sm_alloc(count, sizeof *c->box);
    for (long p = 0; p < c->count; p++) c->box[p] = sm_no_box();
    for (long i = 0; i < rest->nodes; i++) {
        int p = c->of[i];
        c->first[p + 1]++;
        if (c->path[i] > c->radius[p]) c->radius[p] = c->path[i];
        sm_box_add(&c->box[p], rest->x0[i]);
    }
    for (size_t p = 0; p < count; p++) c->first[p + 1] += c->first[p];
    for (long i = rest->nodes; i-- > 0;) c->node[--c->first[c->of[i] + 1]] = (int)i;
    memmove(c->first, c->first + 1, count * sizeof *c->first);
    c->first[count] = rest->nodes;
}

/* Notes the arcs from cluster p from arc[at] on, of which there is room for all; returns their end.
 * best[p] is less than any length. */
static long note_arcs(const SmCollideRest *rest, const Clusters *c, long p, int *restrict best,
                      int *restrict arc, long at)
{
    const int *restrict to = rest->to, *restrict length = rest->length;
    const int *restrict of = c->of, *restrict from_root = c->path;
    for (long i = c->first[p]; i < c->first[p + 1]; i++) {
        int a = c->node[i], own = from_root[a];
        for (long e = rest->first[a], end = rest->first[a + 1]; e < end; e++) {
            int q = of[to[e]], was = best[q], path = own + length[e] + from_root[to[e]];
            arc[at] = q;
            best[q] = path < was ? path : was;
            at += was == FAR;
        }
    }
    return at;
}

static void list_arcs(const SmCollideRest *rest, Clusters *c)
{
    long room = 0, at = 0;
    int *best = sm_alloc((size_t)c->count, sizeof *best);
    for (long p = 0; p < c->count; p++) best[p] = FAR;
    c->arc_first = sm_alloc((size_t)c->count + 1, sizeof *c->arc_first);
    for (long p = 0; p < c->count; p++) {
        if (at + c->count > room) {
            room = 2 * at + c->count;
            c->arc = sm_realloc(c->arc, (size_t)room + 1, sizeof *c->arc);
            c->length = sm_realloc(c->length, (size_t)room + 1, sizeof *c->length);
        }
        best[p] = -1;
        at = note_arcs(rest, c, p, best, c->arc, at);
        best[p] = FAR;
        for (long i = c->arc_first[p]; i < at; i++) {
            c->length[i] = best[c->arc[i]];
            best[c->arc[i]] = FAR;
        }
        c->arc_first[p + 1] = at;
    }
    free(best);
}

/* Nodes within a cube of that width; clusters follow the Morton curve through the cubes. O(nodes
 * log nodes + edges). The caller frees. */
static void clusters_build(const SmCollideRest *rest, double width, Clusters *c)
{
    *c = (Clusters){.of = sm_alloc((size_t)rest->nodes, sizeof(int)),
                    .path = sm_alloc((size_t)rest->nodes, sizeof(int))};
    memset(c->of, -1, (size_t)rest->nodes * sizeof(int));
    for (long i = 0; i < rest->nodes; i++) c->path[i] = FAR;
    split(rest, width, c);
    list_nodes(rest, c);
    list_arcs(rest, c);
}

static void clusters_free(Clusters *c)
{
    sm_free_all(c->of, c->path, c->first, c->node, c->radius, c->box, c->arc_first, c->arc,
                c->length);
    *c = (Clusters){0};
}

/* ---- patches */

#define LOOSE 0.1 /* edges: how far a cell's axes reach beyond its bent corners */

/* What tells whether two patches are joined. Sides are 2 d + 1 up along axis d, 2 d down. */
typedef struct {
    double node_reach[SM_COLLIDE_FACES]; /* of its nodes, less the size that keeps cells apart */
    double cell_reach[SM_COLLIDE_FACES]; /* of its cells' centres, less their edge's share of it; of
                                            the side across from each */
    double least_size, least_edge;
} Reach;

/* A patch is cluster patch_of^-1; those with nodes or cells come first. */
typedef struct {
    const SmCollideShape *shape;
    SmCollidePatches *patches;
    Clusters clusters;
    int *patch;    /* [clusters] -1: none */
    int *cluster;  /* [patches] rising */
    Reach *reach;  /* [patches] */
    double window; /* least distance in which paths lead from any node (rest.c) */
    int *path;     /* [clusters] shortest that was found, or INT_MAX */
    int *met;      /* [met_count] whose it is */
    long met_count;
    int (*pair)[2]; /* [pair_count] joined, by rising first one */
    long pair_count, pair_room;
} Build;

/* Patches are clusters that have surface nodes or cells. */
static void number_patches(Build *b)
{
    const SmCollideShape *shape = b->shape;
    size_t clusters = (size_t)b->clusters.count;
    b->patch = sm_alloc(clusters, sizeof(int));
    b->cluster = sm_alloc(clusters, sizeof(int));
    for (long i = 0; i < shape->surface_count; i++) b->patch[b->clusters.of[shape->surface[i]]] = 1;
    for (long k = 0; k < shape->cell_count; k++)
        b->patch[b->clusters.of[shape->cell[k].carrier[0]]] = 1;
    for (long c = 0; c < b->clusters.count; c++) {
        bool any = b->patch[c];
        b->patch[c] = any ? (int)b->patches->count : -1;
        if (any) b->cluster[b->patches->count++] = (int)c;
    }
}

static int patch_of(const Build *b, int node)
{
    return b->patch[b->clusters.of[node]];
}

/* Makes counts, in first[p + 1], the ends that lists get when they are filled from the back. */
static void add_up(long *first, long count)
{
    for (long p = 0; p < count; p++) first[p + 1] += first[p];
}

static void list_members(Build *b)
{
    const SmCollideShape *shape = b->shape;
    SmCollidePatches *patches = b->patches;
    size_t count = (size_t)patches->count;
    patches->cell_first = sm_alloc(count + 2, sizeof(long));
    patches->node_first = sm_alloc(count + 2, sizeof(long));
    patches->cell = sm_alloc((size_t)shape->cell_count, sizeof(int));
    patches->node = sm_alloc((size_t)shape->surface_count, sizeof(int));
    for (long k = 0; k < shape->cell_count; k++)
        patches->cell_first[patch_of(b, shape->cell[k].carrier[0]) + 2]++;
    for (long i = 0; i < shape->surface_count; i++)
        patches->node_first[patch_of(b, shape->surface[i]) + 2]++;
    add_up(patches->cell_first + 1, patches->count);
    add_up(patches->node_first + 1, patches->count);
    for (long k = 0; k < shape->cell_count; k++)
        patches->cell[patches->cell_first[patch_of(b, shape->cell[k].carrier[0]) + 1]++] = (int)k;
    for (long i = 0; i < shape->surface_count; i++)
        patches->node[patches->node_first[patch_of(b, shape->surface[i]) + 1]++] =
            shape->surface[i];
}

/* In place of fmin() and fmax(), which are calls. */
static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Carriers of the cells, and the surface nodes. */
static void list_carriers(Build *b)
{
    const SmCollideShape *shape = b->shape;
    SmCollidePatches *patches = b->patches;
    size_t most = (size_t)(shape->cell_count * shape->carriers + shape->surface_count);
    long *seen = sm_alloc((size_t)shape->nodes, sizeof *seen), at = 0; /* last patch, from 1 */
    patches->carrier = sm_alloc(most, sizeof *patches->carrier);
    patches->carrier_first = sm_alloc((size_t)patches->count + 1, sizeof(long));
    patches->margin = sm_alloc((size_t)patches->count, sizeof *patches->margin);
    for (long p = 0; p < patches->count; p++) {
        for (long i = patches->cell_first[p]; i < patches->cell_first[p + 1]; i++) {
            const SmCollideCell *cell = &shape->cell[patches->cell[i]];
            double out = shape->carriers == 1 ? sqrt(0.75) : LOOSE;
            patches->margin[p] = larger(patches->margin[p], out * cell->edge);
            for (int c = 0; c < shape->carriers; c++) {
                if (seen[cell->carrier[c]] == p + 1) continue;
                seen[cell->carrier[c]] = p + 1;
                patches->carrier[at++] = cell->carrier[c];
            }
        }
        for (long i = patches->node_first[p]; i < patches->node_first[p + 1]; i++) {
            patches->margin[p] = larger(patches->margin[p], shape->radius[patches->node[i]]);
            if (seen[patches->node[i]] != p + 1) patches->carrier[at++] = patches->node[i];
        }
        patches->loosest = larger(patches->loosest, patches->margin[p]);
        patches->carrier_first[p + 1] = at;
    }
    free(seen);
}

SmBox sm_collide_patches_box(const SmCollidePatches *patches, const double (*x)[3], long p)
{
    SmBox box = sm_no_box();
    for (long i = patches->carrier_first[p]; i < patches->carrier_first[p + 1]; i++)
        sm_box_add(&box, x[patches->carrier[i]]);
    sm_box_widen(&box, patches->margin[p]);
    return box;
}

bool sm_collide_patches_joined(const SmCollidePatches *patches, long a, long b)
{
    long low = patches->joined_first[a], high = patches->joined_first[a + 1], end = high;
    while (low < high) {
        long middle = (low + high) / 2;
        if (patches->joined[middle] < b)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && patches->joined[low] == b;
}

/* All nodes of patch a are beside all cells of patch b where the nodes reach no farther beyond the
 * cells on any side: of |x - c| - edge / 2 - apart, the node's and the cell's shares (sizes and
 * edges in sm_collide_apart()) have their largest values apart from each other. */
static void find_reach(Build *b, long p)
{
    const SmCollideShape *shape = b->shape;
    const SmCollidePatches *patches = b->patches;
    Reach *reach = &b->reach[p];
    double of_size = sm_collide_apart(1, 0), of_edge = sm_collide_apart(0, 1) + 0.5;
    reach->least_size = reach->least_edge = INFINITY;
    for (int s = 0; s < SM_COLLIDE_FACES; s++)
        reach->node_reach[s] = reach->cell_reach[s] = -INFINITY;
    for (long i = patches->node_first[p]; i < patches->node_first[p + 1]; i++) {
        const double *x = shape->x0[patches->node[i]], size = shape->size[patches->node[i]];
        reach->least_size = smaller(reach->least_size, size);
        for (int s = 0; s < SM_COLLIDE_FACES; s++)
            reach->node_reach[s] =
                larger(reach->node_reach[s], (s % 2 ? 1 : -1) * x[s / 2] - of_size * size);
    }
    for (long i = patches->cell_first[p]; i < patches->cell_first[p + 1]; i++) {
        const SmCollideCell *cell = &shape->cell[patches->cell[i]];
        reach->least_edge = smaller(reach->least_edge, cell->edge);
        for (int s = 0; s < SM_COLLIDE_FACES; s++)
            reach->cell_reach[s] =
                larger(reach->cell_reach[s],
                       (s % 2 ? -1 : 1) * cell->centre[s / 2] - of_edge * cell->edge);
    }
}

/* Whether no node of a collides with a cell of b when no path between them is longer than `path`.
 */
static int held(const Reach *a, const Reach *b, double path)
{
    bool out = !(path <= SM_COLLIDE_AROUND * sm_collide_apart(a->least_size, b->least_edge));
    for (int s = 0; s < SM_COLLIDE_FACES; s++)
        out |= !(a->node_reach[s] + b->cell_reach[s] <= SM_COLLIDE_SLACK);
    return !out;
}

/* Whether the nodes of two clusters are in the window around each other's nodes. */
static int in_window(const Build *b, long p, long q)
{
    const SmBox *own = &b->clusters.box[p], *other = &b->clusters.box[q];
    bool out = false;
    for (int d = 0; d < 3; d++)
        out |= other->high[d] - own->low[d] > b->window || own->high[d] - other->low[d] > b->window;
    return !out;
}

/* Leaves out the arcs that lead out of the window. */
static void keep_arcs(Build *b)
{
    Clusters *c = &b->clusters;
    long at = 0;
    for (long p = 0, e = 0; p < c->count; p++) {
        for (; e < c->arc_first[p + 1]; e++) {
            if (!in_window(b, p, c->arc[e])) continue;
            c->arc[at] = c->arc[e];
            c->length[at++] = c->length[e];
        }
        c->arc_first[p + 1] = at;
    }
}

/* A path to a cluster; `met`, with room for one more, grows where it is the first. Without a
 * branch: whether it is follows no pattern. */
static inline long meet(int *restrict path, int *restrict met, long count, int cluster, int length)
{
    int was = path[cluster];
    met[count] = cluster;
    path[cluster] = length < was ? length : was;
    return count + (was == INT_MAX);
}

/* Ways from a cluster over at most two arcs. */
static void find_paths(Build *b, int own)
{
    const Clusters *c = &b->clusters;
    int *restrict path = b->path, *restrict met = b->met;
    const int *restrict arc = c->arc, *restrict length = c->length;
    for (long i = 0; i < b->met_count; i++) path[met[i]] = INT_MAX;
    long count = meet(path, met, 0, own, 0);
    for (long e = c->arc_first[own]; e < c->arc_first[own + 1]; e++) {
        long from = c->arc_first[arc[e]], end = c->arc_first[arc[e] + 1];
        count = meet(path, met, count, arc[e], length[e]);
        for (long f = from; f < end; f++)
            count = meet(path, met, count, arc[f], length[e] + length[f]);
    }
    b->met_count = count;
}

/* Adds the pairs of patch p with itself and later ones. */
static void find_joined(Build *b, int p)
{
    const Clusters *c = &b->clusters;
    int own = b->cluster[p];
    find_paths(b, own);
    for (long i = 0; i < b->met_count; i++) {
        int other = b->met[i], q = b->patch[other];
        if (q < p) continue;
        const Reach *a = &b->reach[p], *z = &b->reach[q];
        double path = 0.5 * ((double)b->path[other] + c->radius[own] + c->radius[other]);
        /* '&': all three are cheap, and which fails cannot be foreseen */
        if (!(held(a, z, path) & held(z, a, path) & in_window(b, own, other))) continue;
        sm_make_room(b->pair, b->pair_room, b->pair_count + 1);
        b->pair[b->pair_count][0] = p;
        b->pair[b->pair_count++][1] = q;
    }
}

/* Lists the other one of every pair with both: first, by rising first one, those that come before
 * a patch, then, by rising second one, those after it. */
static void list_pairs(Build *b)
{
    SmCollidePatches *patches = b->patches;
    size_t count = (size_t)patches->count;
    long *first = patches->joined_first = sm_alloc(count + 2, sizeof *first);
    long *at = sm_alloc(count + 1, sizeof *at);
    for (long i = 0; i < b->pair_count; i++) {
        first[b->pair[i][1] + 1]++;
        if (b->pair[i][0] != b->pair[i][1]) first[b->pair[i][0] + 1]++;
    }
    add_up(first, patches->count);
    patches->joined = sm_alloc((size_t)first[count], sizeof *patches->joined);
    for (size_t p = 0; p < count; p++) at[p] = first[p];
    for (long i = 0; i < b->pair_count; i++) patches->joined[at[b->pair[i][1]]++] = b->pair[i][0];
    for (long q = 0; q < patches->count; q++) {
        long end = at[q]; /* only then come later ones */
        for (long i = first[q]; i < end && patches->joined[i] < q; i++)
            patches->joined[at[patches->joined[i]]++] = (int)q;
    }
    free(at);
}

static void list_joined(Build *b)
{
    long patches = b->patches->count, clusters = b->clusters.count;
    double least = INFINITY;
    b->reach = sm_alloc((size_t)patches, sizeof *b->reach);
    b->path = sm_alloc((size_t)clusters, sizeof(int));
    b->met = sm_alloc((size_t)clusters + 1, sizeof(int));
    for (long c = 0; c < clusters; c++) b->path[c] = INT_MAX;
    for (long p = 0; p < patches; p++) {
        find_reach(b, p);
        least = smaller(least, b->reach[p].least_size);
    }
    b->window = sm_collide_apart(least, b->shape->widest) + b->shape->widest;
    keep_arcs(b);
    for (long p = 0; p < patches; p++) find_joined(b, (int)p);
    list_pairs(b);
}

void sm_collide_patches_build(const SmCollideShape *shape, SmCollidePatches *patches)
{
    Build b = {.shape = shape, .patches = patches};
    *patches = (SmCollidePatches){.edge = shape->mean};
    clusters_build(&shape->rest, (shape->carriers == 1 ? 2 : 3) * shape->mean, &b.clusters);
    number_patches(&b);
    list_members(&b);
    list_carriers(&b);
    list_joined(&b);
    clusters_free(&b.clusters);
    sm_free_all(b.patch, b.cluster, b.reach, b.path, b.met, b.pair);
}

void sm_collide_patches_free(SmCollidePatches *patches)
{
    sm_free_all(patches->cell_first, patches->node_first, patches->carrier_first,
                patches->joined_first, patches->cell, patches->node, patches->carrier,
                patches->joined, patches->margin);
    *patches = (SmCollidePatches){0};
}
