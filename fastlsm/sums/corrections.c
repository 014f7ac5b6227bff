#include "corrections.h"

#include <stdlib.h>
#include <string.h>

#include "blocks.h"

/* Half a block is worked on at a time; halves are numbered through, two to a block. */
enum { HALF = SM_LANES / 2 };

/* Sites that a half's regions differ by on one way, by offset: row (c + w) * side + b + w holds
 * bits, lane by lane, of those to subtract and, from bit 16 on, of those to add. */
typedef struct {
    uint32_t *lanes; /* [side^3] */
    bool *touched;   /* [side^2] rows that are not zero */
    CorrectionList list;
    long count, room;
    uint32_t clear; /* CorrectionList */
} Way;

struct CorrectionsBuilder {
    const Lsm *lsm;
    long half; /* whose regions are being added */
    bool any;  /* have been */
    Way up, down;
};

enum { ADD = 16 };

static void open_way(const Lsm *lsm, Way *way)
{
    size_t side = (size_t)lsm->side;
    way->lanes = sm_alloc(side * side * side, sizeof *way->lanes);
    way->touched = sm_alloc(side * side, sizeof *way->touched);
    way->list.first = sm_alloc(2 * (size_t)lsm->blocks + 1, sizeof *way->list.first);
    way->list.clear = sm_alloc((size_t)lsm->blocks, sizeof *way->list.clear);
}

CorrectionsBuilder *lsm_corrections_open(const Lsm *lsm)
{
    CorrectionsBuilder *builder = sm_alloc(1, sizeof *builder);
    builder->lsm = lsm;
    open_way(lsm, &builder->up);
    open_way(lsm, &builder->down);
    return builder;
}

static void append(Way *way, Correction correction)
{
    if (way->count == way->room) {
        way->room = 2 * way->room + 256;
        way->list.of = sm_realloc(way->list.of, (size_t)way->room, sizeof(Correction));
    }
    way->list.of[way->count++] = correction;
}

/* The corrections of lanes at one offset: their sources are in the block `before` columns on and in
 * the next one. */
static void append_lanes(const Lsm *lsm, Way *way, const int corner[3], const int offset[3],
                         uint32_t lanes, real sign)
{
    int low = corner[0] + offset[0], column = (low + SM_LANES) / SM_LANES - 1,
        from = low - column * SM_LANES;
    uint32_t next = lanes & (~(uint32_t)0 << (SM_LANES - from));
    Correction correction = {.sign = sign};
    for (int d = 0; d < 3; d++) correction.offset[d] = (real)offset[d];
    for (int k = 0; k < 2; k++) {
        correction.lanes = (uint16_t)(k ? next : lanes & ~next);
        if (!correction.lanes) continue;
        correction.from = (int16_t)(from - k * SM_LANES);
        correction.source =
            lsm_blocks_at(lsm, column + k, corner[1] + offset[1], corner[2] + offset[2]);
        append(way, correction);
    }
}

static void append_half(const Lsm *lsm, Way *way, const int corner[3])
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

static void finish_half(CorrectionsBuilder *builder)
{
    const Lsm *lsm = builder->lsm;
    int corner[3] = {0, 0, 0}, lane = 0;
    const int *particle = lsm->particle + builder->half * HALF;
    while (builder->any && particle[lane] < 0) lane++;
    for (int d = 0; d < 3 && builder->any; d++)
        corner[d] = lsm->lattice.coord[particle[lane]][d] - (d ? 0 : lane);
    Way *ways[2] = {&builder->up, &builder->down};
    for (int i = 0; i < 2; i++) {
        if (builder->any) append_half(lsm, ways[i], corner);
        ways[i]->list.first[builder->half + 1] = ways[i]->count;
        ways[i]->list.clear[builder->half / 2] |=
            (uint16_t)(ways[i]->clear << builder->half % 2 * HALF);
        ways[i]->clear = 0;
    }
    builder->any = false;
    builder->half++;
}

/* `taken`: what the box sum takes of a region with `members`. */
static void add_way(const Lsm *lsm, Way *way, int lane, const uint64_t *taken,
                    const uint64_t *members)
{
    int side = lsm->side, rows = side * side, wrong = 0, count = 0;
    for (int row = 0; row < rows; row++) {
        wrong += __builtin_popcountll(taken[row] ^ members[row]);
        count += __builtin_popcountll(members[row]);
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

void lsm_corrections_add(CorrectionsBuilder *builder, long p, const uint64_t *rows)
{
    const Lsm *lsm = builder->lsm;
    int lane = lsm->slot[p] % HALF;
    while (builder->half < lsm->slot[p] / HALF) finish_half(builder);
    uint64_t up[LSM_MAX_SIDE * LSM_MAX_SIDE], down[LSM_MAX_SIDE * LSM_MAX_SIDE];
    lsm_blocks_taken(lsm, p, up, down);
    add_way(lsm, &builder->up, lane, up, rows);
    add_way(lsm, &builder->down, lane, down, rows);
    builder->any = true;
}

static CorrectionList close_way(Way *way)
{
    free(way->lanes);
    free(way->touched);
    way->list.of = sm_realloc(way->list.of, (size_t)way->count, sizeof(Correction));
    return way->list;
}

/* Rows for the regions that corrections read on the way down. */
static void number_rows(const Lsm *lsm, Corrections *corrections)
{
    CorrectionList *down = &corrections->down;
    corrections->row = sm_alloc((size_t)lsm->blocks, sizeof(int));
    for (long block = 0; block < lsm->blocks; block++) corrections->row[block] = -1;
    for (long i = 0; i < down->first[2 * lsm->blocks]; i++)
        corrections->row[down->of[i].source] = 0;
    for (long block = 0; block < lsm->blocks; block++)
        if (!corrections->row[block]) corrections->row[block] = (int)corrections->rows++;
    for (long i = 0; i < down->first[2 * lsm->blocks]; i++)
        down->of[i].source = corrections->row[down->of[i].source];
    corrections->kept = sm_alloc((size_t)corrections->rows * 12 * SM_LANES, sizeof(real));
}

void lsm_corrections_close(CorrectionsBuilder *builder, Lsm *lsm)
{
    while (builder->half < 2 * lsm->blocks) finish_half(builder);
    Corrections *corrections = lsm->corrections = sm_alloc(1, sizeof *corrections);
    corrections->up = close_way(&builder->up);
    corrections->down = close_way(&builder->down);
    free(builder);
    number_rows(lsm, corrections);
}

static bool mends(const CorrectionList *list, long block)
{
    return list->first[2 * block] < list->first[2 * block + 2] || list->clear[block];
}

void lsm_corrections_mark(const Lsm *lsm)
{
    const Corrections *c = lsm->corrections;
    for (long block = 0; block < lsm->blocks; block++) {
        lsm->box->mixed[block] = mends(&c->up, block) || mends(&c->down, block);
        lsm->box->listed[block] = c->row[block] >= 0;
    }
}

void lsm_corrections_free(Corrections *corrections)
{
    if (!corrections) return;
    free(corrections->up.of);
    free(corrections->up.first);
    free(corrections->up.clear);
    free(corrections->down.of);
    free(corrections->down.first);
    free(corrections->down.clear);
    free(corrections->row);
    free(corrections->kept);
    free(corrections);
}

long lsm_corrections_bytes(const Lsm *lsm)
{
    const Corrections *c = lsm->corrections;
    if (!c) return 0;
    long halves = 2 * lsm->blocks;
    return (c->up.first[halves] + c->down.first[halves]) * (long)sizeof(Correction) +
           lsm->blocks * (long)(4 * sizeof(long) + 2 * sizeof(uint16_t) + sizeof(int)) +
           c->rows * (long)(12 * SM_LANES * sizeof(real));
}
