#include "lists.h"

#include <stdlib.h>

#include "../../lib/simd/rigid_lanes.h"
#include "../../lib/simd/rows.h"

/* Layers of about this size stay in the L2 cache. What is alike within one is computed once, so
 * they are the same whatever SM_LANES is. */
enum { LAYER_PARTICLES = 384 };

void lsm_lists_build_layers(Lsm *lsm)
{
    int planes = lsm->lattice.size[2];
    long *count = sm_alloc((size_t)planes, sizeof *count);
    for (long p = 0; p < lsm->lattice.count; p++) count[lsm->lattice.coord[p][2]]++;
    lsm->layer_plane = sm_alloc((size_t)planes + 1, sizeof(int));
    lsm->layers = 0;
    int least = lsm->sums->layer_planes; /* where lists run through a layer it reaches the next */
    if (least > 1 && least < lsm->w) least = lsm->w;
    long held = 0;
    for (int z = 0; z < planes; z++) {
        held += count[z];
        bool high = z + 1 - lsm->layer_plane[lsm->layers] >= least;
        if ((held >= LAYER_PARTICLES && high) || z == planes - 1) {
            lsm->layer_plane[++lsm->layers] = z + 1;
            held = 0;
        }
    }
    free(count);
    lsm->reach = 0;
    lsm->chapter = 1;
    for (int l = 0; l < lsm->layers; l++) {
        int reach = 0; /* layers until w planes below this one's first are covered */
        while (l - reach > 0 && lsm->layer_plane[l - reach] > lsm->layer_plane[l] - lsm->w) reach++;
        lsm->reach = reach > lsm->reach ? reach : lsm->reach;
    }
    if (lsm->layers > 1 && lsm->reach == 0) lsm->reach = 1;
}

void lsm_lists_lay_out(Lsm *lsm)
{
    long n = lsm->lattice.count, slot = 0, p = 0;
    lsm_lists_build_layers(lsm);
    lsm->slot = sm_alloc((size_t)n, sizeof(int));
    lsm->layer_block = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
    for (int l = 0; l < lsm->layers; l++) {
        slot = lsm_layer_begin(slot);
        lsm->layer_block[l] = slot / SM_LANES;
        while (p < n && lsm->lattice.coord[p][2] < lsm->layer_plane[l + 1])
            lsm->slot[p++] = (int)slot++;
    }
    lsm->blocks = (slot + SM_LANES - 1) / SM_LANES;
    lsm->layer_block[lsm->layers] = lsm->blocks;
    lsm->particle = sm_alloc((size_t)lsm->blocks * SM_LANES, sizeof(int));
    for (long s = 0; s < lsm->blocks * SM_LANES; s++) lsm->particle[s] = -1;
    for (p = 0; p < n; p++) lsm->particle[lsm->slot[p]] = (int)p;
}

void lsm_rows_free(Lsm *lsm)
{
    for (int t = 0; lsm->rows && t < lsm->threads; t++) {
        Rows *rows = &lsm->rows[t], *first = &lsm->rows[0];
        if (t == 0) sm_free_all(rows->plate[0], rows->plate[1]);
        if (t && rows->p != first->p) sm_free_all(rows->p, rows->transform);
        free(rows->bar);
    }
    if (lsm->rows) sm_free_all(lsm->rows->p, lsm->rows->transform);
    free(lsm->rows);
    lsm->rows = NULL;
}

/* Shifts (subsum_lists.h) to where a plane's rows are among those of its layer, or, `by_plane`, of
 * itself, which begin at places[layer] + 1. Returns the most of one. */
static long find_shifts(const Lsm *lsm, const long *plane, bool by_plane, const long *places,
                        int **shift)
{
    long most = 0;
    *shift = sm_alloc((size_t)lsm->lists.planes, sizeof(int));
    for (int l = 0; l < lsm->layers; l++)
        for (int z = lsm->layer_plane[l]; z < lsm->layer_plane[l + 1]; z++) {
            long first = plane[by_plane ? z : lsm->layer_plane[l]], own = plane[z + 1] - first;
            (*shift)[z] = (int)((places ? places[l] : 0) + 1 - first);
            most = own > most ? own : most;
        }
    return most;
}

/* Where each layer's plates begin: in turns of room for the largest. Returns how many places there
 * are. */
static long turn_plates(const Lsm *lsm, long *places)
{
    const long *plane = lsm->lists.plate_plane;
    const int *layer = lsm->layer_plane;
    int *store = sm_alloc((size_t)lsm->layers, sizeof *store);
    int stores = lsm_pipeline_stores(lsm, 2, store);
    long *room = sm_alloc((size_t)stores + 1, sizeof *room);
    for (int l = 0; l < lsm->layers; l++) {
        long own = plane[layer[l + 1]] - plane[layer[l]], *most = &room[store[l] + 1];
        *most = own > *most ? own : *most;
    }
    for (int i = 0; i < stores; i++) room[i + 1] += room[i];
    for (int l = 0; l < lsm->layers; l++) places[l] = room[store[l]];
    long all = room[stores];
    sm_free_all(store, room);
    return all;
}

/* The first slot of each plane's layer, or, of all, 0; [planes + 1]. */
static long *first_slots(const Lsm *lsm, bool all)
{
    long *first = sm_alloc((size_t)lsm->lists.planes + 1, sizeof *first);
    for (int l = 0; l < lsm->layers; l++)
        for (int z = lsm->layer_plane[l]; z < lsm->layer_plane[l + 1] && !all; z++)
            first[z] = lsm->layer_block[l] * SM_LANES;
    first[lsm->lists.planes] = lsm->blocks * SM_LANES;
    return first;
}

void lsm_rows_place(Lsm *lsm, const int *region_plane)
{
    LsmLists *lists = &lsm->lists;
    int *bar, *plate, *slot;
    bool whole = lsm->sums->whole; /* all threads' then */
    lsm_rows_free(lsm);
    long *places = sm_alloc((size_t)lsm->layers, sizeof *places), *first = first_slots(lsm, whole);
    size_t plates = (size_t)turn_plates(lsm, places) + 1,
           slots = (size_t)find_shifts(lsm, first, false, NULL, &slot) + 1,
           bars = (size_t)find_shifts(lsm, lists->bar_plane, lsm->sums->by_plane, NULL, &bar) + 1;
    find_shifts(lsm, lists->plate_plane, false, places, &plate);
    lsm_lists_place(lists, bar, plate, slot, region_plane);
    sm_free_all(places, first);
    lsm->rows = sm_alloc((size_t)lsm->threads, sizeof *lsm->rows);
    real *up = sm_alloc(plates * ROW_WIDTH, sizeof(real)),
         *down = sm_alloc(plates * ROW_WIDTH, sizeof(real));
    for (int t = 0; t < lsm->threads; t++) {
        Rows *rows = &lsm->rows[t];
        if (t && whole)
            *rows = lsm->rows[0];
        else
            *rows = (Rows){.p = sm_alloc(slots * ROW_P, sizeof(real)),
                           .transform = sm_alloc(slots * ROW_WIDTH, sizeof(real)),
                           .plate = {up, down}};
        rows->bar = sm_alloc(bars * ROW_WIDTH, sizeof(real));
    }
}

Rows lsm_rows_of(const Lsm *lsm, int layer, int thread)
{
    Rows rows = lsm->rows[thread];
    rows.shift = lsm->lists.slot_shift[lsm->layer_plane[layer]];
    return rows;
}

/* Rows of m~ x. */
static void weigh(const Lsm *lsm, const Rows *rows, long block)
{
    vec weight = lsm->particle_const[lsm->block_const[block]].weight;
    vec p[4] = {[3] = lanes_set(0)};
    load3(lsm->x + block * 3 * SM_LANES, p);
    for (int d = 0; d < 3; d++) p[d] *= weight;
    lanes_interleave(p, 4);
    real *row = rows->p + slot_row(rows, block * SM_LANES) * ROW_P;
    for (int i = 0; i < 4; i++) lanes_store(row + i * SM_LANES, p[i]);
}

/* Rows of damping's products. */
static void weigh_products(const Lsm *lsm, const Rows *rows, long block)
{
    vec part[4], field[16] = {{0}};
    real *row[SM_LANES];
    for (int d = 0; d < 3; d++) {
        damping_products(lsm->particle_const[lsm->block_const[block]].weight,
                         lsm->x + block * 3 * SM_LANES, lsm->v + block * 3 * SM_LANES, d, part);
        for (int k = 0; k < 4; k++) field[3 * k + d] = part[k];
    }
    for (int lane = 0; lane < SM_LANES; lane++)
        row[lane] = rows->transform + slot_row(rows, block * SM_LANES + lane) * ROW_WIDTH;
    lanes_to_rows(field, row);
}

void lsm_lists_subsums(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    Rows rows = lsm_rows_of(lsm, layer, thread);
    bool plain = lsm->pass->plain;
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        if (lsm->listed && !lsm->listed[block]) continue;
        if (plain)
            weigh_products(lsm, &rows, block);
        else
            weigh(lsm, &rows, block);
    }
    lsm->sums->lists->subsums(lsm, &rows, layer, 0, plain);
    sm_lap(laps, lsm->pass->stage);
}

/* (q, R z, R y, R x), padded to four. */
static void keep_transforms(const Lsm *lsm, const Rows *rows, long tile, const real *down)
{
    static const int triple[4] = {0, 1, 3, 2};
    vec field[16];
    real *row[SM_LANES], nobodys[ROW_WIDTH];
    for (int i = 0; i < 16; i++)
        field[i] =
            i % 4 < 3 ? lanes_load(down + (3 * triple[i / 4] + i % 4) * SM_LANES) : lanes_set(0);
    for (int lane = 0; lane < SM_LANES; lane++) {
        int slot = lsm->tile_slot[tile * SM_LANES + lane];
        row[lane] = slot < 0 ? nobodys : rows->transform + slot_row(rows, slot) * ROW_WIDTH;
    }
    lanes_to_rows(field, row);
}

/* (omega, v_r - omega x c_r), padded to four. */
static void keep_velocities(const Lsm *lsm, const Rows *rows, long tile, const real *down)
{
    vec field[8];
    for (int i = 0; i < 8; i++)
        field[i] = i % 4 < 3 ? lanes_load(down + (i / 4 * 3 + i % 4) * SM_LANES) : lanes_set(0);
    lanes_interleave(field, 8);
    const real *row = (const real *)field;
    for (int lane = 0; lane < SM_LANES; lane++) {
        int slot = lsm->tile_slot[tile * SM_LANES + lane];
        if (slot >= 0)
            half_store(rows->transform + slot_row(rows, slot) * ROW_WIDTH,
                       half_load(row + lane * 8));
    }
}

void lsm_lists_keep_down(const Lsm *lsm, const Rows *rows, long tile, const real *down)
{
    if (lsm->pass->plain)
        keep_velocities(lsm, rows, tile, down);
    else
        keep_transforms(lsm, rows, tile, down);
}

/* A region identical to another has its rotation, or its rigid velocity; of a transform the centre
 * differs. */
static void copy_regions(const Lsm *lsm, const Rows *rows, int layer, bool plain)
{
    for (long i = lsm->layer_copy[layer]; i < lsm->layer_copy[layer + 1]; i++) {
        int to = lsm->copy[i][0], from = lsm->copy[i][1];
        const int *a = lsm->lattice.coord[lsm->particle[to]],
                  *b = lsm->lattice.coord[lsm->particle[from]];
        real *out = rows->transform + slot_row(rows, to) * ROW_WIDTH;
        const real *in = rows->transform + slot_row(rows, from) * ROW_WIDTH;
        if (plain) {
            half_store(out, half_load(in));
            continue;
        }
        row_store(out, row_load(in));
        for (int d = 0; d < 3; d++) /* column d of R is vector 3 - d of the row */
            store4(out, load4(out) + (real)(a[d] - b[d]) * load4(in + 4 * (3 - d)));
    }
}

void lsm_lists_solve(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    Rows rows = lsm_rows_of(lsm, layer, thread);
    const LsmListKernels *lists = lsm->sums->lists;
    const LsmPass *pass = lsm->pass;
    vec sum[POLAR_TILES][12];
    real down[POLAR_TILES * TILE_DOWN] __attribute__((aligned(64)));
    if (lists->last) lists->last(lsm, &rows, layer, 0, pass->plain);
    long tile = lsm->layer_tile[layer], end = lsm->layer_tile[layer + 1];
    for (; tile < end; tile += POLAR_TILES) {
        int tiles = end - tile < POLAR_TILES ? (int)(end - tile) : POLAR_TILES;
        for (int t = 0; t < tiles; t++) lists->tile(lsm, &rows, tile + t, pass->plain, sum[t]);
        lsm_solve(lsm, pass->plain, layer, tile, tiles, sum, down, laps);
        for (int t = 0; t < tiles; t++)
            lsm_lists_keep_down(lsm, &rows, tile + t, down + t * TILE_DOWN);
        lsm_solved(pass->plain, laps);
    }
    copy_regions(lsm, &rows, layer, pass->plain);
    lsm_solved(pass->plain, laps);
    lists->subsums(lsm, &rows, layer, 1, pass->plain);
    sm_lap(laps, pass->stage);
}

void lsm_lists_end(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    Rows rows = lsm_rows_of(lsm, layer, thread);
    const LsmListKernels *lists = lsm->sums->lists;
    const LsmPass *pass = lsm->pass;
    if (lists->last) lists->last(lsm, &rows, layer, 1, pass->plain);
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        vec sum[1][6] = {{{0}}};
        lists->block(lsm, &rows, block, pass->plain, sum[0]);
        lsm_end(lsm, pass->plain, block, 1, sum, laps);
    }
    sm_lap(laps, pass->stage);
}
