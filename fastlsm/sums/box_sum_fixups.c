#include "box_sum_fixups.h"

#include <stdlib.h>
#include <string.h>

#include "blocks.h"
#include "sums.h"

/* Part of a block is worked on at a time; parts are numbered through. */
enum { PARTS = SM_LANES / SM_PART };

/* Sites that a part's regions differ by on one way, by offset: row (c + w) * side + b + w holds
 * bits, lane by lane, of those to subtract and, from bit 16 on, of those to add. */
typedef struct {
    uint32_t *lanes; /* [side^3] */
    bool *touched;   /* [side^2] rows that are not zero */
    FixupList list;
    long count, room;
    uint32_t clear; /* FixupList */
} Way;

struct FixupsBuilder {
    const Lsm *lsm;
    long begin, part; /* of its share the first, and that whose regions are being added */
    bool any;         /* have been */
    Way way[2];       /* up, down; FixupList.first counts from the share's first for now */
};

enum { ADD = 16 };

FixupsBuilder *lsm_fixups_open(const Lsm *lsm, int shares)
{
    size_t blocks = (size_t)lsm->blocks;
    FixupsBuilder *builder = sm_alloc((size_t)shares, sizeof *builder);
    for (int i = 0; i < 2; i++) {
        FixupList list = {.first = sm_alloc(PARTS * blocks + 1, sizeof *list.first),
                          .clear = sm_alloc(blocks, sizeof *list.clear)};
        for (int s = 0; s < shares; s++) builder[s].way[i].list = list;
    }
    return builder;
}

FixupsBuilder *lsm_fixups_share(const Lsm *lsm, FixupsBuilder *builder, int share, long block)
{
    size_t side = (size_t)lsm->side;
    FixupsBuilder *own = builder + share;
    own->lsm = lsm;
    own->begin = own->part = PARTS * block;
    for (int i = 0; i < 2; i++) {
        own->way[i].lanes = sm_alloc(side * side * side, sizeof *own->way[i].lanes);
        own->way[i].touched = sm_alloc(side * side, sizeof *own->way[i].touched);
    }
    return own;
}

static void append(Way *way, Fixup fixup)
{
    if (way->count == way->room) {
        way->room = 2 * way->room + 256;
        way->list.of = sm_realloc(way->list.of, (size_t)way->room, sizeof(Fixup));
    }
    way->list.of[way->count++] = fixup;
}

/* The fix-ups of lanes at one offset: their sources are in the block `before` columns on and in
 * the next one. */
static void append_lanes(const Lsm *lsm, Way *way, const int corner[3], const int offset[3],
                         uint32_t lanes, real sign)
{
    int low = corner[0] + offset[0], column = (low < 0 ? low - SM_LANES + 1 : low) / SM_LANES,
        from = low - column * SM_LANES;
    uint32_t next = lanes & (~(uint32_t)0 << (SM_LANES - from));
    Fixup fixup = {.sign = sign};
    for (int d = 0; d < 3; d++) fixup.offset[d] = (real)offset[d];
    for (int k = 0; k < 2; k++) {
        fixup.lanes = (uint16_t)(k ? next : lanes & ~next);
        if (!fixup.lanes) continue;
        fixup.from = (int16_t)(from - k * SM_LANES);
        fixup.source = lsm_blocks_at(lsm, column + k, corner[1] + offset[1], corner[2] + offset[2]);
        append(way, fixup);
    }
}

static void append_part(const Lsm *lsm, Way *way, const int corner[3])
{
    int w = lsm->w, side = lsm->side;
    const uint32_t low = ((uint32_t)1 << ADD) - 1;
    for (int row = 0; row < side * side; row++) {
        if (!way->touched[row]) continue;
        uint32_t *at = way->lanes + (long)row * side;
        for (int i = 0; i < side; i++) {
            int offset[3] = {i - w, row % side - w, row / side - w};
            if (at[i] & low) append_lanes(lsm, way, corner, offset, at[i] & low, -1);
            if (at[i] >> ADD) append_lanes(lsm, way, corner, offset, at[i] >> ADD, 1);
            at[i] = 0;
        }
        way->touched[row] = false;
    }
}

static void finish_part(FixupsBuilder *builder)
{
    const Lsm *lsm = builder->lsm;
    int corner[3] = {0, 0, 0}, lane = 0;
    const int *particle = lsm->particle + builder->part * SM_PART;
    while (builder->any && particle[lane] < 0) lane++;
    for (int d = 0; d < 3 && builder->any; d++)
        corner[d] = lsm->lattice.coord[particle[lane]][d] - (d ? 0 : lane);
    for (int i = 0; i < 2; i++) {
        Way *way = &builder->way[i];
        if (builder->any) append_part(lsm, way, corner);
        way->list.first[builder->part + 1] = way->count;
        way->list.clear[builder->part / PARTS] |=
            (uint16_t)(way->clear << builder->part % PARTS * SM_PART);
        way->clear = 0;
    }
    builder->any = false;
    builder->part++;
}

/* `taken`: what the box sum takes of a region with `members`. */
static void add_way(const Lsm *lsm, Way *way, int lane, const uint64_t *taken,
                    const uint64_t *members)
{
    int side = lsm->side, rows = side * side, wrong = 0, count = 0;
    for (int row = 0; row < rows; row++) {
        wrong += sm_count_bits(taken[row] ^ members[row]);
        count += sm_count_bits(members[row]);
    }
    bool clear = wrong > count;
    way->clear |= (uint32_t)clear << lane;
    for (int row = 0; row < rows && wrong; row++) {
        uint64_t rest = (clear ? 0 : taken[row]) ^ members[row];
        way->touched[row] |= rest != 0;
        for (; rest; rest &= rest - 1) {
            int i = __builtin_ctzll(rest);
            way->lanes[(long)row * side + i] |= (uint32_t)1
                                                << (lane + (members[row] >> i & 1 ? ADD : 0));
        }
    }
}

void lsm_fixups_add(FixupsBuilder *builder, long p, const uint64_t *rows)
{
    const Lsm *lsm = builder->lsm;
    int lane = lsm->slot[p] % SM_PART;
    while (builder->part < lsm->slot[p] / SM_PART) finish_part(builder);
    uint64_t up[LSM_MAX_SIDE * LSM_MAX_SIDE], down[LSM_MAX_SIDE * LSM_MAX_SIDE];
    lsm_blocks_taken(lsm, p, up, down);
    add_way(lsm, &builder->way[0], lane, up, rows);
    add_way(lsm, &builder->way[1], lane, down, rows);
    builder->any = true;
}

void lsm_fixups_finish(FixupsBuilder *own, long block)
{
    while (own->part < PARTS * block) finish_part(own);
    for (int i = 0; i < 2; i++) sm_free_all(own->way[i].lanes, own->way[i].touched);
}

/* The list of way `i`: those of all shares, one after the other. */
static FixupList join_shares(const FixupsBuilder *builder, int shares, int i)
{
    FixupList list = builder->way[i].list;
    long all = 0, at = 0;
    for (int s = 0; s < shares; s++) all += builder[s].way[i].count;
    list.of = sm_alloc((size_t)all, sizeof *list.of);
    for (int s = 0; s < shares; s++) {
        const Way *way = &builder[s].way[i];
        if (way->count) memcpy(list.of + at, way->list.of, (size_t)way->count * sizeof *list.of);
        for (long part = builder[s].begin; part < builder[s].part && at; part++)
            list.first[part + 1] += at;
        at += way->count;
        free(way->list.of);
    }
    return list;
}

/* Rows for the regions that fix-ups read on the way down. */
static void number_rows(const Lsm *lsm, Fixups *fixups)
{
    FixupList *down = &fixups->down;
    fixups->row = sm_alloc((size_t)lsm->blocks, sizeof(int));
    for (long block = 0; block < lsm->blocks; block++) fixups->row[block] = -1;
    for (long i = 0; i < down->first[PARTS * lsm->blocks]; i++) fixups->row[down->of[i].source] = 0;
    for (long block = 0; block < lsm->blocks; block++)
        if (!fixups->row[block]) fixups->row[block] = (int)fixups->rows++;
    for (long i = 0; i < down->first[PARTS * lsm->blocks]; i++)
        down->of[i].source = fixups->row[down->of[i].source];
    fixups->kept = sm_alloc((size_t)fixups->rows * 12 * SM_LANES, sizeof(real));
}

void lsm_fixups_close(FixupsBuilder *builder, int shares, Lsm *lsm)
{
    Fixups *fixups = lsm->fixups = sm_alloc(1, sizeof *fixups);
    fixups->up = join_shares(builder, shares, 0);
    fixups->down = join_shares(builder, shares, 1);
    free(builder);
    number_rows(lsm, fixups);
}

enum { FIXUP_BATCH = 16 };

/* What one fix-up adds to the sums of part of a block. */
typedef void FixupOne(const Lsm *lsm, const Fixup *at, part_vec *sum);

/* m~ of the source, or less than nothing. */
SM_INLINE part_vec weight_of(const Lsm *lsm, const Fixup *at)
{
    const ParticleConst *k = &lsm->particle_const[lsm->block_const[at->source]];
    return at->sign * part_load((const real *)&k->weight + at->from, at->lanes);
}

/* Of the sums up of a block's regions (match.h). */
SM_INLINE void fixup_region(const Lsm *lsm, const Fixup *at, part_vec sum[12])
{
    const real *x = lsm->x + at->source * 3L * SM_LANES + at->from;
    part_vec weight = weight_of(lsm, at);
    for (int d = 0; d < 3; d++) {
        part_vec p = weight * part_load(x + d * SM_LANES, at->lanes);
        sum[d] += p;
        for (int k = 0; k < 3; k++) sum[3 + 3 * d + k] += at->offset[k] * p;
    }
}

/* Of damping's four triples of sums up. */
SM_INLINE void fixup_product(const Lsm *lsm, const Fixup *at, part_vec sum[12])
{
    const real *from_x = lsm->x + at->source * 3L * SM_LANES + at->from,
               *from_v = lsm->v + at->source * 3L * SM_LANES + at->from;
    part_vec weight = weight_of(lsm, at), x[3], v[3], p[3];
    for (int d = 0; d < 3; d++) {
        x[d] = part_load(from_x + d * SM_LANES, at->lanes);
        v[d] = part_load(from_v + d * SM_LANES, at->lanes);
        p[d] = weight * x[d];
    }
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        sum[d] += weight * v[d];
        sum[3 + d] += p[e] * v[f] - p[f] * v[e];
        sum[6 + d] += p[d] * x[d];
        sum[9 + d] += p[e] * x[f];
    }
}

/* Of the sums down of a block's particles: of transforms at the particles. */
SM_INLINE void fixup_goal(const Lsm *lsm, const Fixup *at, part_vec sum[3])
{
    const real *T = lsm->fixups->kept + at->source * 12L * SM_LANES + at->from;
    for (int f = 0; f < 3; f++) {
        part_vec value = part_load(T + f * SM_LANES, at->lanes);
        for (int k = 0; k < 3; k++)
            value -=
                at->offset[k] * part_load(T + (3 + 3 * ((k + 1) % 3) + f) * SM_LANES, at->lanes);
        sum[f] += at->sign * value;
    }
}

/* Of the sums down of rigid velocities. */
SM_INLINE void fixup_velocity(const Lsm *lsm, const Fixup *at, part_vec sum[6])
{
    const real *kept = lsm->fixups->kept + at->source * 12L * SM_LANES + at->from;
    for (int f = 0; f < 6; f++) sum[f] += at->sign * part_load(kept + f * SM_LANES, at->lanes);
}

/* What the fix-ups from `c` up to `end` come to. Loops are unrolled early, or the sums would
 * not stay in registers. */
SM_INLINE void fixup_batch(const Lsm *lsm, const Fixup *c, const Fixup *end, int count,
                           FixupOne *fixup_one, part_vec *sum)
{
    part_vec all[12];
#pragma GCC unroll 12
    for (int f = 0; f < count; f++) all[f] = (part_vec){0};
    for (; c < end; c++) fixup_one(lsm, c, all);
#pragma GCC unroll 12
    for (int f = 0; f < count; f++) sum[f] = all[f];
}

/* What all of part `at` come to. Of thousands of like numbers, one added after the
 * other, each would be rounded the same way; batches are summed on their own, and then batches of
 * batches. */
SM_INLINE void fixup_part(const Lsm *lsm, const FixupList *list, long at, int count,
                          FixupOne *fixup_one, part_vec *sum)
{
    const Fixup *c = list->of + list->first[at], *end = list->of + list->first[at + 1];
    if (end - c <= FIXUP_BATCH) {
        fixup_batch(lsm, c, end, count, fixup_one, sum);
        return;
    }
    part_vec batch[12], batches[12];
    for (int f = 0; f < count; f++) batches[f] = sum[f] = (part_vec){0};
    for (int i = 1; c < end; i++) {
        const Fixup *last = end - c < FIXUP_BATCH ? end : c + FIXUP_BATCH;
        fixup_batch(lsm, c, last, count, fixup_one, batch);
        for (int f = 0; f < count; f++) batches[f] += batch[f];
        c = last;
        if (i % FIXUP_BATCH && c < end) continue;
        for (int f = 0; f < count; f++) {
            sum[f] += batches[f];
            batches[f] = (part_vec){0};
        }
    }
}

/* Fixes up `count` sums of a block. */
SM_INLINE void fixup_block(const Lsm *lsm, const FixupList *list, long block, int count,
                           FixupOne *fixup_one, vec *sums)
{
    part_vec sum[PARTS][12];
    unsigned keep = ~(unsigned)list->clear[block] & LANES_ALL;
    for (int part = 0; part < PARTS; part++)
        fixup_part(lsm, list, PARTS * block + part, count, fixup_one, sum[part]);
#pragma GCC unroll 12
    for (int f = 0; f < count; f++) {
        part_vec one[PARTS];
        for (int part = 0; part < PARTS; part++) one[part] = sum[part][f];
        sums[f] = lanes_keep(keep, sums[f]) + lanes_join(one);
    }
}

void lsm_fixup_regions(const Lsm *lsm, long block, vec *sums)
{
    fixup_block(lsm, &lsm->fixups->up, block, 12, fixup_region, sums);
}

void lsm_fixup_products(const Lsm *lsm, long block, vec *sums)
{
    fixup_block(lsm, &lsm->fixups->up, block, 12, fixup_product, sums);
}

void lsm_fixup_goals(const Lsm *lsm, long block, vec *sums)
{
    fixup_block(lsm, &lsm->fixups->down, block, 3, fixup_goal, sums);
}

void lsm_fixup_velocities(const Lsm *lsm, long block, vec *sums)
{
    fixup_block(lsm, &lsm->fixups->down, block, 6, fixup_velocity, sums);
}

void lsm_fixups_keep(const Lsm *lsm, long block, const real *down)
{
    memcpy(lsm->fixups->kept + lsm->fixups->row[block] * (long)TILE_DOWN, down,
           TILE_DOWN * sizeof(real));
}

static bool mends(const FixupList *list, long block)
{
    return list->first[PARTS * block] < list->first[PARTS * (block + 1)] || list->clear[block];
}

void lsm_fixups_mark(const Lsm *lsm)
{
    const Fixups *c = lsm->fixups;
    for (long block = 0; block < lsm->blocks; block++) {
        lsm->box->mixed[block] = mends(&c->up, block) || mends(&c->down, block);
        lsm->listed[block] = c->row[block] >= 0;
    }
}

void lsm_fixups_free(Fixups *fixups)
{
    if (!fixups) return;
    free(fixups->up.of);
    free(fixups->up.first);
    free(fixups->up.clear);
    free(fixups->down.of);
    free(fixups->down.first);
    free(fixups->down.clear);
    free(fixups->row);
    free(fixups->kept);
    free(fixups);
}
