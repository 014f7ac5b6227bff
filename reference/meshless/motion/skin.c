#include "skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "../body/covers.h"
#include "frame_sums.h"

enum { BLOCK = REF_SKIN_BLOCK, LANES = REF_SKIN_LANES };

/* Works on one block at a time. */
typedef struct {
    const RefSkinCarrier *carrier;
    RefShape shape;
    int *number; /* [nodes] in the block's list, or -1 */
    int *list;   /* [BLOCK functions] the block's nodes, and */
    float *row;  /* [like list][BLOCK] their weights at its points */
    float lift[BLOCK];
    RefSkinShares shares;
    long loose;
} Builder;

static Builder builder_of(const RefSkinCarrier *carrier)
{
    size_t most = BLOCK * (size_t)carrier->nodes->most;
    Builder builder = {.carrier = carrier,
                       .shape = ref_shape_create(carrier->nodes),
                       .number = sm_alloc((size_t)carrier->nodes->count, sizeof(int)),
                       .list = sm_alloc(most, sizeof(int)),
                       .row = sm_alloc(most + 1, BLOCK * sizeof(float))};
    for (long n = 0; n < carrier->nodes->count; n++) builder.number[n] = -1;
    return builder;
}

static void builder_free(Builder *builder)
{
    ref_shape_free(&builder->shape);
    sm_free_all(builder->number, builder->list, builder->row);
}

typedef struct {
    long cell, point;
    int place;
} Keyed;

static int by_cell(const void *a, const void *b)
{
    const Keyed *p = a, *q = b;
    if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
    if (p->place != q->place) return p->place < q->place ? -1 : 1;
    return (p->point > q->point) - (p->point < q->point);
}

static Keyed *sort_points(const RefSkinCarrier *carrier, long count)
{
    Keyed *key = sm_alloc((size_t)count, sizeof *key);
    for (long p = 0; p < count; p++)
        key[p] = (Keyed){carrier->cell(carrier->data, p), p,
                         carrier->place ? carrier->place(carrier->data, p) : 0};
    qsort(key, (size_t)count, sizeof *key, by_cell);
    return key;
}

/* Adds nodes to the block's list that are not in it. */
static void list_nodes(Builder *builder, RefSkinBlock *block, int count, const int *node)
{
    const int before = block->nodes;
    for (int n = 0; n < count; n++) {
        if (builder->number[node[n]] >= 0) continue;
        builder->number[node[n]] = block->nodes;
        builder->list[block->nodes++] = node[n];
    }
    memset(builder->row + (size_t)before * BLOCK, 0,
           (size_t)(block->nodes - before) * BLOCK * sizeof *builder->row);
}

/* The weights at point p of a block, or the nearest node alone. */
static void evaluate(Builder *builder, RefSkinBlock *block, int p, long point)
{
    const RefSkinCarrier *carrier = builder->carrier;
    const RefShape *shape = &builder->shape;
    double lift = 0;
    if (!carrier->weigh(carrier->data, point, &builder->shape, &lift)) {
        builder->loose++;
        builder->shape.count = 1;
        builder->shape.node[0] = carrier->nearest(carrier->data, point);
        builder->shape.value[0] = 1;
    }
    builder->lift[p] = (float)lift;
    list_nodes(builder, block, shape->count, shape->node);
    for (int n = 0; n < shape->count; n++)
        builder->row[builder->number[shape->node[n]] * BLOCK + p] += (float)shape->value[n];
}

/* The weights of points that share parts. */
static void evaluate_share(Builder *builder, RefSkinBlock *block, const RefSkinShare *share)
{
    list_nodes(builder, block, share->nodes, share->node);
    ref_frame_sums.weigh(share, (const double(*)[REF_SKIN_ROOM])builder->shares.times,
                         builder->number, builder->row);
    for (int p = share->first; p < share->first + share->points; p++)
        builder->lift[p] = (float)builder->shares.lift[p];
}

/* Behind all others. */
static void make_room(RefSkin *skin, RefSkinBlock *block)
{
    block->node = skin->nodes;
    block->weight = skin->weights;
    skin->nodes += block->nodes;
    skin->weights += (long)block->nodes * block->room;
    sm_make_room(skin->node, skin->node_room, skin->nodes);
    sm_make_room(skin->weight, skin->weight_room, skin->weights);
}

static void fill_weights(Builder *builder, RefSkin *skin, RefSkinBlock *block)
{
    const int nodes = block->nodes, room = block->room;
    float *weight = skin->weight + block->weight;
    memcpy(skin->node + block->node, builder->list, (size_t)nodes * sizeof *skin->node);
    for (int first = 0; first < room; first += LANES)
        for (int n = 0; n < nodes; n++, weight += LANES)
            memcpy(weight, builder->row + n * BLOCK + first, LANES * sizeof *weight);
    if (skin->lift)
        memcpy(skin->lift + block->first, builder->lift, (size_t)block->points * sizeof(float));
    for (int n = 0; n < block->nodes; n++) builder->number[builder->list[n]] = -1;
}

static void weigh_block(Builder *builder, RefSkin *skin, RefSkinBlock *block)
{
    const RefSkinCarrier *carrier = builder->carrier;
    const long *point = skin->order + block->first;
    RefSkinShares *shares = &builder->shares;
    block->nodes = shares->count = 0;
    if (carrier->share)
        carrier->share(carrier->data, block->points, point,
                       (const double(*)[3])(skin->rest + block->first), shares);
    for (int p = 0, s = 0; p < block->points;) {
        const RefSkinShare *share = shares->share + s;
        if (s < shares->count && share->first == p) {
            evaluate_share(builder, block, share);
            p += share->points;
            s++;
        } else {
            evaluate(builder, block, p, point[p]);
            p++;
        }
    }
    make_room(skin, block);
    fill_weights(builder, skin, block);
}

/* Scratch for the fullest block. */
static void make_near(RefSkin *skin)
{
    int most = 0;
    for (long b = 0; b < skin->blocks; b++)
        if (skin->block[b].nodes > most) most = skin->block[b].nodes;
    skin->near = sm_realloc(skin->near, 2 * (size_t)most, sizeof *skin->near);
}

void ref_skin_renew(const RefSkinCarrier *carrier, RefSkin *skin, long *loose)
{
    Builder builder = builder_of(carrier);
    skin->nodes = skin->weights = 0;
    for (long b = 0; b < skin->blocks; b++) weigh_block(&builder, skin, skin->block + b);
    make_near(skin);
    if (loose) *loose = builder.loose;
    builder_free(&builder);
}

void ref_skin_build(const RefSkinCarrier *carrier, bool lifted, long count, const double (*x)[3],
                    RefSkin *skin, long *loose)
{
    Keyed *key = sort_points(carrier, count);
    *skin = (RefSkin){.count = count};
    skin->order = sm_alloc((size_t)count, sizeof *skin->order);
    skin->rest = sm_alloc((size_t)count, sizeof *skin->rest);
    skin->block = sm_alloc((size_t)count, sizeof *skin->block);
    if (lifted) skin->lift = sm_alloc((size_t)count + LANES, sizeof *skin->lift);
    for (long p = 0; p < count; p++) {
        skin->order[p] = key[p].point;
        memcpy(skin->rest[p], x[key[p].point], sizeof skin->rest[p]);
    }
    for (long p = 0, end; p < count; p = end) {
        for (end = p + 1; end < count && end - p < BLOCK && key[end].cell == key[p].cell;) end++;
        skin->block[skin->blocks++] =
            (RefSkinBlock){.points = (int)(end - p),
                           .room = (int)(end - p + LANES - 1) / LANES * LANES,
                           .first = p};
    }
    free(key);
    ref_skin_renew(carrier, skin, loose);
}

/* Points in a body. */
typedef struct {
    const RefBody *body;
    const double (*x)[3];
} InBody;

static long octant_of(const void *data, long point)
{
    const InBody *in = data;
    const RefOctants *octants = &in->body->octants;
    int place[3];
    for (int d = 0; d < 3; d++) {
        double at = floor((in->x[point][d] - octants->origin[d]) / octants->cell);
        place[d] = (int)fmin(fmax(at, 0), octants->octant[0].size - 1);
    }
    return ref_octants_at(octants, place);
}

static bool weigh_in_body(const void *data, long point, RefShape *shape, double *lift)
{
    const InBody *in = data;
    (void)lift;
    return ref_mls_at(&in->body->nodes, in->body->basis, in->x[point], shape);
}

static int nearest_in_body(const void *data, long point)
{
    const InBody *in = data;
    return (int)ref_mls_nearest(&in->body->nodes, in->x[point]);
}

void ref_skin_create(const RefBody *body, long count, const double (*x)[3], RefSkin *skin,
                     long *loose)
{
    InBody in = {body, x};
    RefSkinCarrier carrier = {&in,  &body->nodes, octant_of, weigh_in_body, nearest_in_body,
                              NULL, NULL};
    ref_skin_build(&carrier, false, count, x, skin, loose);
}

void ref_skin_free(RefSkin *skin)
{
    sm_free_all(skin->order, skin->rest, skin->block, skin->node, skin->weight, skin->lift,
                skin->near);
    *skin = (RefSkin){0};
}

void ref_skin_place(const RefSkin *skin, const double (*moved)[3], const double (*turned)[3],
                    double (*position)[3])
{
    for (long b = 0; b < skin->blocks; b++)
        ref_frame_sums.place(skin, skin->block + b, moved, turned, position);
}

void ref_skin_push(const RefSkin *skin, long place, const double push[3], double (*nodes)[3])
{
    long low = 0, high = skin->blocks;
    while (high - low > 1) {
        long middle = (low + high) / 2;
        *(skin->block[middle].first <= place ? &low : &high) = middle;
    }
    const RefSkinBlock *block = skin->block + low;
    int p = (int)(place - block->first);
    const float *weight =
        skin->weight + block->weight + p / LANES * block->nodes * LANES + p % LANES;
    for (int n = 0; n < block->nodes; n++)
        for (int d = 0; d < 3; d++)
            nodes[skin->node[block->node + n]][d] += (double)weight[n * LANES] * push[d];
}
