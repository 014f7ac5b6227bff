#include "skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "frame_sums.h"

enum { BLOCK = 64, LANES = REF_SKIN_LANES };

typedef struct {
    const RefSkinCarrier *carrier;
    RefShape shape;
    double lift;
    int *number;           /* [nodes] in the block's list, or -1 */
    long nodes, node_room; /* of all blocks */
    long weights, weight_room;
    long loose;
} Builder;

typedef struct {
    long cell, point;
} Keyed;

static int by_cell(const void *a, const void *b)
{
    const Keyed *p = a, *q = b;
    if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
    return (p->point > q->point) - (p->point < q->point);
}

static Keyed *sort_points(const RefSkinCarrier *carrier, long count)
{
    Keyed *key = sm_alloc((size_t)count, sizeof *key);
    for (long p = 0; p < count; p++) key[p] = (Keyed){carrier->cell(carrier->data, p), p};
    qsort(key, (size_t)count, sizeof *key, by_cell);
    return key;
}

/* The weights at a point, or the nearest node alone. */
static void evaluate(Builder *builder, long point)
{
    const RefSkinCarrier *carrier = builder->carrier;
    builder->lift = 0;
    if (carrier->weigh(carrier->data, point, &builder->shape, &builder->lift)) return;
    builder->loose++;
    builder->shape.count = 1;
    builder->shape.node[0] = carrier->nearest(carrier->data, point);
    builder->shape.value[0] = 1;
}

/* The block's nodes, behind those of the blocks before. */
static void list_nodes(Builder *builder, RefSkin *skin, RefSkinBlock *block)
{
    for (int p = 0; p < block->points; p++) {
        evaluate(builder, skin->order[block->first + p]);
        for (int n = 0; n < builder->shape.count; n++) {
            int node = builder->shape.node[n];
            if (builder->number[node] >= 0) continue;
            sm_make_room(skin->node, builder->node_room, builder->nodes + 1);
            builder->number[node] = block->nodes++;
            skin->node[builder->nodes++] = node;
        }
    }
}

static void fill_weights(Builder *builder, RefSkin *skin, RefSkinBlock *block)
{
    long size = (long)block->nodes * block->room, loose = builder->loose;
    sm_make_room(skin->weight, builder->weight_room, builder->weights + size);
    float *weight = skin->weight + builder->weights;
    memset(weight, 0, (size_t)size * sizeof *weight);
    builder->weights += size;
    for (int p = 0; p < block->points; p++) {
        evaluate(builder, skin->order[block->first + p]);
        for (int n = 0; n < builder->shape.count; n++)
            weight[(p / LANES * block->nodes + builder->number[builder->shape.node[n]]) * LANES +
                   p % LANES] += (float)builder->shape.value[n];
        if (skin->lift) skin->lift[block->first + p] = (float)builder->lift;
    }
    builder->loose = loose; /* counted while the nodes were listed */
    for (int n = 0; n < block->nodes; n++) builder->number[skin->node[block->node + n]] = -1;
}

static void add_block(Builder *builder, RefSkin *skin, long first, int points)
{
    RefSkinBlock *block = skin->block + skin->blocks++;
    *block = (RefSkinBlock){.points = points,
                            .room = (points + LANES - 1) / LANES * LANES,
                            .first = first,
                            .node = builder->nodes,
                            .weight = builder->weights};
    list_nodes(builder, skin, block);
    fill_weights(builder, skin, block);
}

void ref_skin_build(const RefSkinCarrier *carrier, bool lifted, long count, const double (*x)[3],
                    RefSkin *skin, long *loose)
{
    Keyed *key = sort_points(carrier, count);
    Builder builder = {.carrier = carrier, .shape = ref_shape_create(carrier->nodes)};
    builder.number = sm_alloc((size_t)carrier->nodes->count, sizeof *builder.number);
    for (long n = 0; n < carrier->nodes->count; n++) builder.number[n] = -1;
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
        add_block(&builder, skin, p, (int)(end - p));
    }
    if (loose) *loose = builder.loose;
    int most = 0;
    for (long b = 0; b < skin->blocks; b++)
        if (skin->block[b].nodes > most) most = skin->block[b].nodes;
    skin->near = sm_alloc(2 * (size_t)most, sizeof *skin->near);
    ref_shape_free(&builder.shape);
    free(builder.number);
    free(key);
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
    const RefNodes *nodes = &in->body->nodes;
    int best = 0;
    double least = INFINITY;
    for (long n = 0; n < nodes->count; n++) {
        double square = 0;
        for (int d = 0; d < 3; d++) square += pow(nodes->position[n][d] - in->x[point][d], 2);
        if (square < least) {
            least = square;
            best = (int)n;
        }
    }
    return best;
}

void ref_skin_create(const RefBody *body, long count, const double (*x)[3], RefSkin *skin,
                     long *loose)
{
    InBody in = {body, x};
    RefSkinCarrier carrier = {&in, &body->nodes, octant_of, weigh_in_body, nearest_in_body};
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

size_t ref_skin_bytes(const RefSkin *skin)
{
    size_t bytes = 0;
    for (long b = 0; b < skin->blocks; b++)
        bytes += (size_t)skin->block[b].nodes * (size_t)skin->block[b].room * sizeof(float);
    return bytes;
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
