#include "nodes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double least_share = 1.0 / 64, least_distance = 0.25;
/* Bins of more members than FULL are halved, until they are a third of the smallest reach or
 * DEEPEST times; before that they are SHARE a node, of a solid SOLID_SHARE. */
enum { SHARE = 16, SOLID_SHARE = 128, FULL = 24, DEEPEST = 24 };

void ref_nodes_free(RefNodes *nodes)
{
    sm_free_all(nodes->position, nodes->reach, nodes->owner, nodes->bin, nodes->member, nodes->home,
                nodes->dimmed);
    *nodes = (RefNodes){0};
}

/* Bins halved so often that the cover of node n touches, low and high. A plane is one bin thick. */
static void touched(const RefNodes *nodes, long n, int halved, double low[3], double high[3])
{
    double times = ldexp(1, halved);
    low[2] = high[2] = 0;
    for (int d = 0; d < (nodes->plane ? 2 : 3); d++) {
        double at = nodes->position[n][d] - nodes->low[d];
        low[d] = floor(times * ((at - nodes->reach[n]) / nodes->edge));
        high[d] = floor(times * ((at + nodes->reach[n]) / nodes->edge));
    }
}

/* Calls for every bin that node n touches: counts it, or notes n there. */
static void enter(RefNodes *nodes, long n, bool count)
{
    double low[3], high[3];
    touched(nodes, n, 0, low, high);
    for (int d = 0; d < 3; d++) {
        low[d] = fmax(low[d], 0);
        high[d] = fmin(high[d], nodes->size[d] - 1);
    }
    for (int z = (int)low[2]; z <= (int)high[2]; z++)
        for (int y = (int)low[1]; y <= (int)high[1]; y++)
            for (int x = (int)low[0]; x <= (int)high[0]; x++) {
                RefNodesBin *bin = nodes->bin + ((long)z * nodes->size[1] + y) * nodes->size[0] + x;
                if (!count) nodes->member[bin->first + bin->count] = (int)n;
                bin->count++;
            }
}

/* What halves bins: room for more of them and for their members. */
typedef struct {
    RefNodes *nodes;
    long bin_room, member_room;
} Halving;

static void note_members(Halving *h, long bin, int count, const int *member)
{
    RefNodes *nodes = h->nodes;
    sm_make_room(nodes->member, h->member_room, nodes->members + count);
    if (count) memcpy(nodes->member + nodes->members, member, (size_t)count * sizeof *member);
    nodes->bin[bin] = (RefNodesBin){.count = count, .first = nodes->members};
    nodes->members += count;
    if (count > nodes->most) nodes->most = count;
}

static bool is_coarse(const RefNodes *nodes, int halved, int count, const int *member)
{
    double third = INFINITY;
    if (count <= FULL || halved >= nodes->depth) return false;
    for (int m = 0; m < count; m++) third = fmin(third, nodes->reach[member[m]] / 3);
    return ldexp(nodes->edge, -halved) > 1.01 * third;
}

/* Of a bin at `place` in edges of its own, and its members. */
static void settle(Halving *h, long bin, int halved, const double place[3], int count,
                   const int *member)
{
    RefNodes *nodes = h->nodes;
    int parts = nodes->plane ? 4 : 8;
    if (!is_coarse(nodes, halved, count, member)) {
        note_members(h, bin, count, member);
        return;
    }
    long first = nodes->bins;
    int *touching = sm_alloc((size_t)count, sizeof *touching);
    nodes->bins += parts;
    sm_make_room(nodes->bin, h->bin_room, nodes->bins);
    nodes->bin[bin].child = (int)first;
    for (int part = 0; part < parts; part++) {
        double at[3], low[3], high[3];
        int touch = 0;
        for (int d = 0; d < 3; d++) at[d] = 2 * place[d] + (part >> d & 1);
        for (int m = 0; m < count; m++) {
            bool inside = true;
            touched(nodes, member[m], halved + 1, low, high);
            for (int d = 0; d < (nodes->plane ? 2 : 3); d++)
                inside &= low[d] <= at[d] && at[d] <= high[d];
            if (inside) touching[touch++] = member[m];
        }
        settle(h, first + part, halved + 1, at, touch, touching);
    }
    free(touching);
}

/* Bins of a third of the smallest reach, or so many times twice that as SHARE says. */
static long lay_out(RefNodes *nodes)
{
    long entries = nodes->count + nodes->images, all = 1;
    double high[3], least = INFINITY, bins = INFINITY;
    for (int d = 0; d < 3; d++) {
        nodes->low[d] = INFINITY;
        high[d] = -INFINITY;
    }
    for (long n = 0; n < entries; n++) {
        for (int d = 0; d < 3; d++) {
            nodes->low[d] = fmin(nodes->low[d], nodes->position[n][d] - nodes->reach[n]);
            high[d] = fmax(high[d], nodes->position[n][d] + nodes->reach[n]);
        }
        least = fmin(least, nodes->reach[n]);
    }
    int dims = nodes->plane ? 2 : 3, share = nodes->plane ? SHARE : SOLID_SHARE;
    for (nodes->depth = -1; bins > share * ((double)entries + 4); nodes->depth++) {
        bins = 1;
        nodes->edge = ldexp(least / 3, nodes->depth + 1);
        for (int d = 0; d < dims; d++) bins *= ceil((high[d] - nodes->low[d]) / nodes->edge);
    }
    if (nodes->plane) {
        nodes->low[2] = -nodes->edge / 2;
        nodes->size[2] = 1;
    }
    for (int d = 0; d < dims; d++) {
        nodes->size[d] = (int)ceil((high[d] - nodes->low[d]) / nodes->edge);
        all *= nodes->size[d];
    }
    if (nodes->depth > DEEPEST) nodes->depth = DEEPEST;
    return all;
}

/* Whether node n's cover, moved across a seam, reaches into what lies there by more than rounding.
 */
static bool crosses(const RefNodes *nodes, long n, const RefSeam *seam)
{
    double reach = nodes->reach[n] * (1 - 1e-9), at[2];
    ref_seam_cross(seam, nodes->position[n], at);
    for (int d = 0; d < 2; d++)
        if (at[d] + reach <= seam->low[d] || at[d] - reach >= seam->high[d]) return false;
    return true;
}

/* Appends an image of node n. */
static void add_image(RefNodes *nodes, long n, const double at[2], long *room)
{
    long end = nodes->count + nodes->images++;
    if (end == *room) {
        *room = 2 * *room + 62;
        nodes->owner = sm_realloc(nodes->owner, (size_t)*room, sizeof *nodes->owner);
        nodes->reach = sm_realloc(nodes->reach, (size_t)*room, sizeof *nodes->reach);
        nodes->position = sm_realloc(nodes->position, (size_t)*room, sizeof(double[3]));
    }
    nodes->owner[end] = (int)n;
    nodes->reach[end] = nodes->reach[n];
    memcpy(nodes->position[end], (double[3]){at[0], at[1], 0}, sizeof *nodes->position);
}

/* The images of node n in a plane of cylinders, and what is known of it and them. */
static void place_in_cylinders(RefNodes *nodes, long n, RefCylinderImages *images, long *room,
                               long *home_room, long *dimmed_room)
{
    double reach = nodes->reach[n], at[2] = {nodes->position[n][0], nodes->position[n][1]};
    const double low[2] = {-reach, -reach}, high[2] = {reach, reach};
    ref_cylinders_images(nodes->cylinders, at, low, high, reach / 4, images);
    for (int k = 0; k < images->count; k++) {
        long which = k == 0 ? n : nodes->count + nodes->images;
        const double there[2] = {at[0] + images->shift[k][0], at[1] + images->shift[k][1]};
        if (k > 0) add_image(nodes, n, there, room);
        sm_make_room(nodes->home, *home_room, which + 1);
        sm_make_room(nodes->dimmed, *dimmed_room, which + 1);
        nodes->home[which] = images->to[k];
        nodes->dimmed[which] = images->zero;
    }
}

/* Puts the images behind the nodes. */
static void place_images(RefNodes *nodes)
{
    long room = nodes->count, home_room = 0, dimmed_room = 0;
    RefCylinderImages images = {.count = 0};
    if (nodes->seams == 0 && !nodes->cylinders) return;
    sm_free_all(nodes->home, nodes->dimmed);
    nodes->home = NULL;
    nodes->dimmed = NULL;
    nodes->owner = sm_realloc(nodes->owner, (size_t)room, sizeof *nodes->owner);
    if (nodes->cylinders) {
        sm_make_room(nodes->home, home_room, nodes->count);
        sm_make_room(nodes->dimmed, dimmed_room, nodes->count);
    }
    for (long n = 0; n < nodes->count; n++) nodes->owner[n] = (int)n;
    for (long n = 0; n < nodes->count; n++) {
        for (int s = 0; s < nodes->seams; s++) {
            double at[2];
            if (!crosses(nodes, n, nodes->seam + s)) continue;
            ref_seam_cross(nodes->seam + s, nodes->position[n], at);
            add_image(nodes, n, at, &room);
        }
        if (nodes->cylinders)
            place_in_cylinders(nodes, n, &images, &room, &home_room, &dimmed_room);
    }
    ref_cylinder_images_free(&images);
}

/* Members of bins that nothing has halved yet. */
static void fill(RefNodes *nodes, long bins)
{
    long entries = nodes->count + nodes->images, all = 0;
    for (long n = 0; n < entries; n++) enter(nodes, n, true);
    for (long b = 0; b < bins; b++) {
        nodes->bin[b].first = all;
        all += nodes->bin[b].count;
        nodes->bin[b].count = 0;
    }
    nodes->member = sm_alloc((size_t)all, sizeof *nodes->member);
    for (long n = 0; n < entries; n++) enter(nodes, n, false);
}

void ref_nodes_bin(RefNodes *nodes)
{
    sm_free_all(nodes->bin, nodes->member);
    nodes->bin = NULL;
    nodes->member = NULL;
    nodes->most = 0;
    nodes->images = nodes->bins = nodes->members = 0;
    if (nodes->count == 0) return;
    place_images(nodes);
    long bins = lay_out(nodes);
    nodes->bin = sm_alloc((size_t)bins, sizeof *nodes->bin);
    fill(nodes, bins);
    Halving halving = {.nodes = nodes, .bin_room = bins};
    nodes->bins = bins;
    int *coarse = nodes->member;
    nodes->member = NULL;
    for (long b = 0; b < bins; b++) {
        RefNodesBin bin = nodes->bin[b];
        long rest = b / nodes->size[0];
        double place[3] = {(double)(b % nodes->size[0]), (double)(rest % nodes->size[1]),
                           (double)(rest / nodes->size[1])};
        settle(&halving, b, 0, place, bin.count, coarse + bin.first);
    }
    free(coarse);
}

/* A box in edges of bins, and what is called. */
typedef struct {
    const RefNodes *nodes;
    double low[3], high[3];
    void (*each)(void *data, int count, const int *member);
    void *data;
} Walk;

static void walk(const Walk *w, const RefNodesBin *bin, int halved, const double place[3])
{
    int dims = w->nodes->plane ? 2 : 3;
    if (!bin->child) w->each(w->data, bin->count, w->nodes->member + bin->first);
    for (int part = 0; bin->child && part < 1 << dims; part++) {
        double at[3] = {0};
        bool inside = true;
        for (int d = 0; d < dims; d++) {
            at[d] = 2 * place[d] + (part >> d & 1);
            inside &= at[d] >= floor(ldexp(w->low[d], halved + 1)) &&
                      at[d] <= floor(ldexp(w->high[d], halved + 1));
        }
        if (inside) walk(w, w->nodes->bin + bin->child + part, halved + 1, at);
    }
}

void ref_nodes_each(const RefNodes *nodes, const double low[3], const double high[3],
                    void (*each)(void *data, int count, const int *member), void *data)
{
    Walk w = {.nodes = nodes, .each = each, .data = data};
    int first[3], last[3];
    for (int d = 0; d < 3; d++) {
        w.low[d] = (low[d] - nodes->low[d]) / nodes->edge;
        w.high[d] = (high[d] - nodes->low[d]) / nodes->edge;
        first[d] = (int)fmin(fmax(floor(w.low[d]), 0), nodes->size[d]);
        last[d] = (int)fmax(fmin(floor(w.high[d]), nodes->size[d] - 1), -1);
    }
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++)
                walk(&w, nodes->bin + ((long)z * nodes->size[1] + y) * nodes->size[0] + x, 0,
                     (const double[]){x, y, z});
}

/* Whether a node stands within `distance` of x. */
static bool taken(const RefNodes *nodes, const double x[3], double distance)
{
    for (long n = 0; n < nodes->count; n++) {
        double square = 0;
        for (int d = 0; d < 3; d++)
            square += (nodes->position[n][d] - x[d]) * (nodes->position[n][d] - x[d]);
        if (square < distance * distance) return true;
    }
    return false;
}

static void add(RefNodes *nodes, const double x[3], double reach)
{
    memcpy(nodes->position[nodes->count], x, sizeof nodes->position[0]);
    nodes->reach[nodes->count++] = reach;
}

void ref_nodes_place(const RefField *field, const RefOctants *tree, double alpha, RefNodes *nodes)
{
    size_t most = 0;
    for (long o = 0; o < tree->count; o++)
        most += tree->octant[o].child < 0 && tree->octant[o].kind != REF_EXTERIOR;
    *nodes = (RefNodes){0};
    nodes->position = sm_alloc(most, sizeof *nodes->position);
    nodes->reach = sm_alloc(most, sizeof *nodes->reach);
    for (int outside = 0; outside < 2; outside++)
        for (long o = 0; o < tree->count; o++) {
            const RefOctant *octant = tree->octant + o;
            if (octant->child >= 0 || octant->kind == REF_EXTERIOR ||
                outside != (octant->kind == REF_BOUNDARY_OUT))
                continue;
            double x[3], edge = tree->cell * octant->size;
            ref_octants_centre(tree, octant, x);
            if (outside && (octant->share < least_share ||
                            !ref_field_project(field, sqrt(3) * edge, 1e-6 * edge, x) ||
                            taken(nodes, x, least_distance * tree->cell)))
                continue;
            add(nodes, x, alpha * edge / 2);
        }
    ref_nodes_bin(nodes);
}

RefNodes ref_nodes_copy(const RefNodes *nodes)
{
    size_t entries = (size_t)(nodes->count + nodes->images);
    RefNodes copy = *nodes;
    copy.position = sm_copy(nodes->position, entries, sizeof *nodes->position);
    copy.reach = sm_copy(nodes->reach, entries, sizeof *nodes->reach);
    if (nodes->owner) copy.owner = sm_copy(nodes->owner, entries, sizeof *nodes->owner);
    if (nodes->home) copy.home = sm_copy(nodes->home, entries, sizeof *nodes->home);
    if (nodes->dimmed) copy.dimmed = sm_copy(nodes->dimmed, entries, sizeof *nodes->dimmed);
    copy.bin = sm_copy(nodes->bin, (size_t)nodes->bins, sizeof *nodes->bin);
    copy.member = sm_copy(nodes->member, (size_t)nodes->members, sizeof *nodes->member);
    return copy;
}
