/* instances.c - the sums of many bodies that share a lattice: a lane of every vector is a body.
 *
 * All lists are the same for all of them, so that SM_LANES bodies are summed at once, with no
 * gathering and no empty lanes but in the last group. A group of SM_LANES bodies is a layer, which
 * waits for no other; a particle of them is a block and a region a tile. Bars, plates and
 * transforms are those of one group at a time, and stay in cache. */
#include <stdlib.h>

#include "list_rows.h"
#include "lists.h"
#include "window.h"

/* Vectors in a row of each kind. Rows keep their width whatever a pass stores in them, so that row
 * 0, the absent member, stays zero. */
enum { L = SM_LANES, ROW = 3, BAR = 12, PLATE = 12, TRANSFORM = TILE_DOWN / L };

/* Rows of one group, [row][values][lanes]. Particle p's and region p's are row p + 1. What comes
 * down takes the place of the bars and plates that went up. */
typedef struct {
    real *p, *bar, *plate, *transform;
} Group;

SM_INLINE Group group_of(const Lsm *lsm, int thread)
{
    long rows = lsm->lattice.count + 1;
    Group g = {.p = lsm->group_rows[thread]};
    g.transform = g.p + rows * ROW * L;
    g.bar = g.transform + rows * TRANSFORM * L;
    g.plate = g.bar + lsm->lists.bar_count * BAR * L;
    return g;
}

/* Where a stage takes its moments: of the triple from value `weighed` on, unless that is -1. */
typedef struct {
    int values, weighed;
    bool down;
} Stage;

/* The sums of a row's members, whose rows have `pitch` vectors: its values, and up, the moments
 * behind them; down, they are taken off the first triple. */
SM_INLINE void row_sums(const int *name, int side, const real *in, int pitch, Stage stage, vec *sum)
{
    const real *at[LSM_MAX_SIDE];
    int n = stage.values;
    for (int i = 0; i < side; i++) at[i] = named(in, (uint64_t)name[i], pitch * L);
    for (int f = 0; f < n; f++) {
        int d = f - stage.weighed;
        bool weighed = stage.weighed >= 0 && d >= 0 && d < 3;
        window_sum(at, f * L, side / 2, &sum[f], weighed ? &sum[n + d] : NULL);
    }
    for (int d = 0; d < 3 && stage.down && stage.weighed >= 0; d++) sum[d] -= sum[n + d];
}

/* All bars, or all plates. The triple whose moments are taken off goes no further. */
SM_INLINE void all_rows(const int *list, long rows, int side, const real *in, int pitch,
                        Stage stage, real *out, int out_pitch)
{
    int values = stage.values + (stage.weighed >= 0 && !stage.down ? 3 : 0);
    for (long row = 1; row < rows; row++) {
        vec sum[15];
        real *to = out + row * out_pitch * L;
        row_sums(list + row * side, side, in, pitch, stage, sum);
        for (int f = 0; f < values; f++) {
            if (stage.down && stage.weighed >= 0 && f >= stage.weighed && f < stage.weighed + 3)
                continue;
            lanes_store(to, sum[f]);
            to += L;
        }
    }
}

SM_INLINE void weigh(const Lsm *lsm, const Group *g, int layer, bool plain)
{
    for (long block = lsm->layer_block[layer], p = 1; block < lsm->layer_block[layer + 1];
         block++, p++) {
        vec weight = lsm->particle_const[lsm->block_const[block]].weight, part[4];
        const real *x = lsm->x + block * 3 * L, *v = lsm->v + block * 3 * L;
        for (int d = 0; d < 3; d++) {
            if (plain) damping_products(weight, x, v, d, part);
            for (int k = 0; k < 4 && plain; k++)
                lanes_store(g->transform + (p * TRANSFORM + 3 * k + d) * L, part[k]);
            if (!plain) lanes_store(g->p + (p * ROW + d) * L, weight * lanes_load(x + d * L));
        }
    }
}

SM_INLINE void subsums_of(Lsm *lsm, int layer, int thread, SmLaps *laps, bool plain, int side)
{
    const LsmLists *lists = &lsm->lists;
    const Group g = group_of(lsm, thread);
    const Stage bar = plain ? (Stage){12, -1, false} : (Stage){3, 0, false},
                plate = plain ? (Stage){12, -1, false} : (Stage){6, 0, false};
    weigh(lsm, &g, layer, plain);
    all_rows(lists->bar, lists->bar_count, side, plain ? g.transform : g.p, plain ? TRANSFORM : ROW,
             bar, g.bar, BAR);
    all_rows(lists->plate, lists->plate_count, side, g.bar, BAR, plate, g.plate, PLATE);
    sm_lap(laps, lsm->pass->stage);
}

/* A region that equals another turns, or moves, as that does; of a transform the centre differs. */
static void copy_regions(const Lsm *lsm, const Group *g, bool plain)
{
    for (long i = 0; i < lsm->copies; i++) {
        int p = lsm->copy[i][0], from = lsm->copy[i][1];
        const real *in = g->transform + (from + 1) * (long)TILE_DOWN;
        real *out = g->transform + (p + 1) * (long)TILE_DOWN;
        for (int f = 0; f < (plain ? 6 : TRANSFORM); f++)
            lanes_store(out + f * L, lanes_load(in + f * L));
        for (int k = 0; k < 3 && !plain; k++) {
            vec q = lanes_load(in + k * L);
            for (int d = 0; d < 3; d++) /* column d of R is triple 2, 3, 1 of the row */
                q += (real)(lsm->lattice.coord[p][d] - lsm->lattice.coord[from][d]) *
                     lanes_load(in + (3 * (1 + (d + 1) % 3) + k) * L);
            lanes_store(out + k * L, q);
        }
    }
}

SM_INLINE void solve_of(Lsm *lsm, int layer, int thread, SmLaps *laps, bool plain, int side)
{
    const LsmLists *lists = &lsm->lists;
    const Group g = group_of(lsm, thread);
    const Stage up = plain ? (Stage){12, -1, false} : (Stage){9, 0, false},
                bar = plain ? (Stage){6, -1, true} : (Stage){12, 6, true},
                plate = plain ? (Stage){6, -1, true} : (Stage){9, 6, true};
    const long first = lsm->layer_tile[layer], end = lsm->layer_tile[layer + 1];
    int tiles;
    for (long tile = first; tile < end; tile += tiles) {
        const int *slot = lsm->tile_slot + (tile - first);
        vec sum[POLAR_TILES][12];
        /* neighbours are solved together */
        for (tiles = 0; tiles < POLAR_TILES && tile + tiles < end; tiles++) {
            vec row[15];
            if (slot[tiles] != slot[0] + tiles) break;
            row_sums(lists->region + (long)slot[tiles] * side, side, g.plate, PLATE, up, row);
            for (int f = 0; f < 12; f++) /* of (C, Cx, Cy, Cz) */
                sum[tiles][f] = row[plain || f < 3 ? f : 3 * (f % 3 + 1) + f / 3 - 1];
        }
        real *down = g.transform + (slot[0] + 1) * (long)TILE_DOWN;
        lsm_solve(lsm, plain, layer, tile, tiles, sum, down, laps);
        lsm_solved(plain, laps);
    }
    copy_regions(lsm, &g, plain);
    lsm_solved(plain, laps);
    all_rows(lists->bar, lists->bar_count, side, g.transform, TRANSFORM, bar, g.bar, BAR);
    all_rows(lists->plate, lists->plate_count, side, g.bar, BAR, plate, g.plate, PLATE);
    sm_lap(laps, lsm->pass->stage);
}

SM_INLINE void end_of(Lsm *lsm, int layer, int thread, SmLaps *laps, bool plain, int side)
{
    const Group g = group_of(lsm, thread);
    const Stage down = plain ? (Stage){6, -1, true} : (Stage){6, 3, true};
    const int *name = lsm->lists.region;
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1];
         block++, name += side) {
        vec row[15], sum[1][6];
        row_sums(name, side, g.plate, PLATE, down, row);
        lanes_copy(plain ? 6 : 3, row, sum[0]);
        lsm_end(lsm, plain, block, 1, sum, NULL);
    }
    sm_lap(laps, lsm->pass->stage);
}

/* A phase of a pass, for each of the usual widths. */
#define PHASE(name)                                                                                \
    static void name(Lsm *lsm, int layer, int thread, SmLaps *laps)                                \
    {                                                                                              \
        if (lsm->pass->plain)                                                                      \
            FOR_SIDE(lsm->side, name##_of, lsm, layer, thread, laps, true);                        \
        else                                                                                       \
            FOR_SIDE(lsm->side, name##_of, lsm, layer, thread, laps, false);                       \
    }
PHASE(subsums)
PHASE(solve)
PHASE(end)

static bool applies(const Lsm *lsm)
{
    return lsm->bodies > 1;
}

static void lay_out(Lsm *lsm)
{
    long n = lsm->lattice.count;
    lsm_lists_build_layers(lsm); /* of the planes, within which regions that are equal are copied */
    lsm->layers = (int)((lsm->bodies + L - 1) / L);
    lsm->reach = 0;
    lsm->blocks = lsm->layers * n;
    lsm->layer_block = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
    for (int l = 0; l <= lsm->layers; l++) lsm->layer_block[l] = l * n;
    lsm->slot = sm_alloc((size_t)n, sizeof(int));
    for (long p = 0; p < n; p++) lsm->slot[p] = (int)p;
}

static void share(Lsm *lsm)
{
    long rows = lsm->lattice.count + 1;
    const LsmLists *lists = &lsm->lists;
    lsm->group_size =
        (size_t)(rows * (ROW + TRANSFORM) + lists->bar_count * BAR + lists->plate_count * PLATE) *
        L;
    lsm->group_rows = sm_alloc((size_t)lsm->threads, sizeof *lsm->group_rows);
    for (int t = 0; t < lsm->threads; t++)
        lsm->group_rows[t] = sm_alloc(lsm->group_size, sizeof(real));
}

const LsmSums lsm_sums_instances = {
    .name = "instances",
    .applies = applies,
    .lay_out = lay_out,
    .share = share,
    .phase = {subsums, solve, end},
    .layer_planes = 1,
};
