#include "build.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/system/team.h"
#include "match.h"
#include "step.h"
#include "sums/blocks.h"
#include "sums/lists.h"
#include "sums/sums.h"

enum { SPARE_LISTS = 16 }; /* rows to spare in a layer, in sides: a few broken links' worth */

typedef struct {
    LsmKey key;
    int region;
} KeyedRegion;

/* Counts the unique regions from the keys of the `count` that may have an equal, which rise, and
 * frees them; original[p] (unless NULL) = the lowest-numbered particle whose region holds the same
 * particles. */
static long collapse(KeyedRegion *keyed, long count, long particles, int *original)
{
    uint64_t mask = 63;
    while (mask < (uint64_t)count * 2) mask = mask * 2 + 1;
    int *table = sm_alloc(mask + 1, sizeof *table); /* places in `keyed` + 1 */
    long unique = particles;
    for (long p = 0; p < particles && original; p++) original[p] = (int)p;
    for (long i = 0; i < count; i++) {
        LsmKey key = keyed[i].key, *other = NULL;
        uint64_t at = key.low & mask;
        for (; table[at]; at = (at + 1) & mask) {
            other = &keyed[table[at] - 1].key;
            if (other->low == key.low && other->high == key.high) break;
        }
        if (!table[at]) {
            table[at] = (int)i + 1;
            continue;
        }
        if (original) original[keyed[i].region] = keyed[table[at] - 1].region;
        unique--;
    }
    free(table);
    free(keyed);
    return unique;
}

/* Particles and those of them whose regions are whole cubes, which have no equal, before a plane.
 */
typedef struct {
    long particles, whole;
} Before;

/* [planes + 1]; the caller frees. */
static Before *count_planes(const Lsm *lsm)
{
    const LsmLattice *l = &lsm->lattice;
    long words = (long)l->size[1] * l->words;
    Before *before = sm_alloc((size_t)l->size[2] + 1, sizeof *before);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(l->size[2] * words))
    for (int z = 0; z < l->size[2]; z++)
        for (long w = z * words; w < (z + 1) * words; w++) {
            before[z + 1].particles += sm_count_bits(l->bits[w]);
            before[z + 1].whole += sm_count_bits(lsm->interior.interior[w]);
        }
    for (int z = 0; z < l->size[2]; z++) {
        before[z + 1].particles += before[z].particles;
        before[z + 1].whole += before[z].whole;
    }
    return before;
}

/* Keys of the regions that may have an equal: those that are not whole cubes. */
static KeyedRegion *room_for_keys(const Lsm *lsm, const Before *before, long *count)
{
    const Before *all = &before[lsm->lattice.size[2]];
    *count = all->particles - all->whole;
    return sm_alloc((size_t)*count, sizeof(KeyedRegion));
}

/* The rows of p's region, unless it is a whole cube and `cubes` is false, and its key, unless it
 * is. Returns how many members it has. */
static int find_region(const Lsm *lsm, long p, bool cubes, LsmRow *rows, KeyedRegion *keyed,
                       bool *whole, bool *simple)
{
    const LsmLattice *l = &lsm->lattice;
    *whole = lsm_bit(l, lsm->interior.interior, l->coord[p]);
    *simple = true;
    if (*whole && !cubes) return lsm->side * lsm->side * lsm->side;
    int members = lsm_region_find(l, &lsm->interior, p, rows, simple);
    if (!*whole) *keyed = (KeyedRegion){lsm_region_key(l, lsm->w, p, rows), (int)p};
    return members;
}

long lsm_unique(Lsm *lsm)
{
    if (lsm->unique >= 0) return lsm->unique;
    long count;
    int planes = lsm->lattice.size[2];
    Before *before = count_planes(lsm);
    KeyedRegion *keyed = room_for_keys(lsm, before, &count);
#pragma omp parallel for schedule(dynamic) num_threads(sm_team_for(lsm->lattice.count))
    for (int z = 0; z < planes; z++) {
        KeyedRegion *own = keyed + before[z].particles - before[z].whole;
        LsmRow rows[LSM_MAX_SIDE * LSM_MAX_SIDE];
        bool whole, simple;
        for (long p = before[z].particles; p < before[z + 1].particles; p++) {
            find_region(lsm, p, false, rows, own, &whole, &simple);
            own += !whole;
        }
    }
    free(before);
    return lsm->unique = collapse(keyed, count, lsm->lattice.count, NULL);
}

/* Regions that are found at once, before they are listed one after the other. */
typedef struct {
    LsmRow *rows; /* [count][side^2] */
    KeyedRegion *keyed;
    bool *whole;
    long count;
} Batch;

static void open_batch(const Lsm *lsm, Batch *batch)
{
    const long rows = 1 << 16, area = (long)lsm->side * lsm->side;
    batch->count = rows / area > 64 ? rows / area : 64;
    batch->rows = sm_alloc((size_t)(batch->count * area), sizeof *batch->rows);
    batch->keyed = sm_alloc((size_t)batch->count, sizeof *batch->keyed);
    batch->whole = sm_alloc((size_t)batch->count, sizeof *batch->whole);
}

static void find_batch(Lsm *lsm, Batch *batch, long first, long end, bool *listed)
{
    long area = (long)lsm->side * lsm->side;
#pragma omp parallel for schedule(static) num_threads(sm_team_for((end - first) * area))
    for (long p = first; p < end; p++) {
        bool simple;
        LsmRow *rows = batch->rows + (p - first) * area;
        lsm->members[p] = find_region(lsm, p, !lsm->box, rows, &batch->keyed[p - first],
                                      &batch->whole[p - first], &simple);
        listed[p] = !lsm->box || (!simple && !lsm_blocks_regular(lsm, p, rows));
    }
}

/* The same, but lists regions, in block form only where box sums get them wrong, and finds their
 * originals. listed[p]: it has lists. */
static void list_regions(Lsm *lsm, int *original, bool *listed)
{
    long n = lsm->lattice.count, room, keys = 0;
    Batch batch;
    Before *before = count_planes(lsm);
    KeyedRegion *keyed = room_for_keys(lsm, before, &room);
    LsmListsBuilder *lists = lsm_lists_open(&lsm->lattice, lsm->slot, lsm->w);
    lsm_names_reach(lsm->blocks * SM_LANES + 1);
    open_batch(lsm, &batch);
    for (long first = 0, end; first < n; first = end) {
        end = first + batch.count < n ? first + batch.count : n;
        find_batch(lsm, &batch, first, end, listed);
        for (long p = first; p < end; p++) {
            if (!batch.whole[p - first]) keyed[keys++] = batch.keyed[p - first];
            if (listed[p])
                lsm_lists_add(lists, p, batch.rows + (p - first) * lsm->side * lsm->side);
        }
    }
    lsm_lists_close(lists, &lsm->lists);
    lsm->unique = collapse(keyed, keys, n, original);
    sm_free_all(before, batch.rows, batch.keyed, batch.whole);
}

/* Lists p among the copies if its region equals an earlier one of its layer, which begins with
 * `plane`. */
static bool add_copy(Lsm *lsm, const int *original, long p, int plane)
{
    int from = original[p];
    if (from == p || lsm->lattice.coord[from][2] < plane) return false;
    lsm->copy[lsm->copies][0] = lsm->slot[p];
    lsm->copy[lsm->copies++][1] = lsm->slot[from];
    return true;
}

/* Tiles of unique regions, each layer beginning a new tile; copies go to a list of their own. */
static void build_tiles(Lsm *lsm, const int *original)
{
    long n = lsm->lattice.count, room = n + (lsm->layers + 1) * MOMENTUM_WAYS, at = 0;
    lsm->tile_slot = sm_alloc((size_t)room, sizeof(int));
    lsm->layer_tile = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
    lsm->copy = sm_alloc((size_t)(n - lsm->unique), sizeof *lsm->copy);
    lsm->layer_copy = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
    for (long i = 0; i < room; i++) lsm->tile_slot[i] = -1;
    long p = 0;
    lsm->copies = 0;
    for (int l = 0; l < lsm->layers; l++) {
        at = lsm_layer_begin(at);
        lsm->layer_tile[l] = at / SM_LANES;
        lsm->layer_copy[l] = lsm->copies;
        for (; p < n && lsm->lattice.coord[p][2] < lsm->layer_plane[l + 1]; p++)
            if (!add_copy(lsm, original, p, lsm->layer_plane[l]))
                lsm->tile_slot[at++] = lsm->slot[p];
    }
    lsm->layer_copy[lsm->layers] = lsm->copies;
    lsm->tiles = (at + SM_LANES - 1) / SM_LANES;
    lsm->layer_tile[lsm->layers] = lsm->tiles;
}

/* Of instances: those of one group, which all are like; copies stay within layers of planes. */
static void build_instance_tiles(Lsm *lsm, const int *original)
{
    long at = 0;
    lsm->tile_slot = sm_alloc((size_t)lsm->lattice.count, sizeof(int));
    lsm->copy = sm_alloc((size_t)(lsm->lattice.count - lsm->unique), sizeof *lsm->copy);
    lsm->copies = 0;
    for (int p = 0, layer = 0; p < lsm->lattice.count; p++) {
        while (lsm->lattice.coord[p][2] >= lsm->layer_plane[layer + 1]) layer++;
        if (!add_copy(lsm, original, p, lsm->layer_plane[layer])) lsm->tile_slot[at++] = p;
    }
    lsm->tiles = lsm->layers * at;
    lsm->layer_tile = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
    for (int l = 0; l <= lsm->layers; l++) lsm->layer_tile[l] = l * at;
}

/* Block form: tiles are blocks. */
static void tile_blocks(Lsm *lsm)
{
    size_t lanes = (size_t)lsm->blocks * SM_LANES;
    lsm->tiles = lsm->blocks;
    lsm->tile_slot = sm_alloc(lanes, sizeof(int));
#pragma omp parallel for schedule(static) num_threads(sm_team_for((long)lanes))
    for (size_t s = 0; s < lanes; s++) lsm->tile_slot[s] = lsm->particle[s] < 0 ? -1 : (int)s;
    lsm->layer_tile = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
    memcpy(lsm->layer_tile, lsm->layer_block, ((size_t)lsm->layers + 1) * sizeof(long));
    lsm->copies = 0;
    lsm->layer_copy = sm_alloc((size_t)lsm->layers + 1, sizeof(long));
}

/* Who is summed by which lists. */
static void place_lists(Lsm *lsm, const bool *listed)
{
    long n = lsm->lattice.count, region = 0;
    Blocks *box = lsm->box;
    lsm->block_region = lsm->particle;
    if (!box) return;
    lsm->block_region = sm_alloc((size_t)lsm->blocks * SM_LANES, sizeof(int));
    for (long s = 0; s < lsm->blocks * SM_LANES; s++) lsm->block_region[s] = -1;
    memset(box->mixed, 0, (size_t)lsm->blocks * sizeof(bool));
    memset(lsm->listed, 0, (size_t)lsm->blocks * sizeof(bool));
    for (long p = 0; p < n; p++) {
        if (!listed[p]) continue;
        lsm->block_region[lsm->slot[p]] = (int)region++;
        box->mixed[lsm->slot[p] / SM_LANES] = true;
    }
    for (long i = lsm->side; i < lsm->lists.bar_count * lsm->side; i++)
        if (lsm->lists.bar[i]) lsm->listed[(lsm->lists.bar[i] / LSM_NAME - 1) / SM_LANES] = true;
}

/* Moves the different ones of `count` records to the front, in the order in which they are first
 * met, and points `index` at them. Returns how many there are. */
static long keep_different(char *record, size_t size, long count, int *index)
{
    uint64_t mask = 63;
    while (mask < (uint64_t)count * 2) mask = mask * 2 + 1;
    int *table = sm_alloc(mask + 1, sizeof *table); /* record number + 1 */
    long kept = 0;
    for (long i = 0; i < count; i++) {
        uint64_t hash = 0, word;
        for (size_t at = 0; at < size; at += sizeof word) {
            memcpy(&word, record + (size_t)i * size + at, sizeof word);
            hash = (hash ^ word) * 0x9e3779b97f4a7c15ull;
            hash ^= hash >> 29;
        }
        uint64_t at = hash & mask;
        while (table[at] &&
               memcmp(record + (size_t)(table[at] - 1) * size, record + (size_t)i * size, size))
            at = (at + 1) & mask;
        if (!table[at]) {
            memmove(record + (size_t)kept * size, record + (size_t)i * size, size);
            table[at] = (int)++kept;
        }
        index[i] = table[at] - 1;
    }
    free(table);
    return kept;
}

/* Stores equal records once, so that the constants of a solid's inside stay in cache. Threads have
 * a share each, whose different records are then made one by one. */
static void *share_records(void *records, size_t size, long count, int *index, Records *shared)
{
    char *record = records;
    int shares = sm_team_for(count * SM_LANES);
    long *kept = sm_alloc((size_t)shares + 1, sizeof *kept), all = 0;
#pragma omp parallel for schedule(static) num_threads(shares)
    for (int s = 0; s < shares; s++) {
        long first = count * s / shares, end = count * (s + 1) / shares;
        kept[s] = keep_different(record + (size_t)first * size, size, end - first, index + first);
    }
    for (int s = 0; s < shares; s++) {
        long own = kept[s], first = count * s / shares;
        memmove(record + (size_t)all * size, record + (size_t)first * size, (size_t)own * size);
        kept[s] = all; /* where they begin */
        all += own;
    }
    int *number = sm_alloc((size_t)all, sizeof *number);
    long different = keep_different(record, size, all, number);
#pragma omp parallel for schedule(static) num_threads(shares)
    for (int s = 0; s < shares; s++)
        for (long i = count * s / shares; i < count * (s + 1) / shares; i++)
            index[i] = number[kept[s] + index[i]];
    *shared = (Records){different, different, different};
    void *fitted = sm_alloc((size_t)different, size);
    memcpy(fitted, records, (size_t)different * size);
    sm_free_all(kept, number, records);
    return fitted;
}

static void block_constants(Lsm *lsm, long block)
{
    ParticleConst *k = &lsm->particle_const[block];
    lsm->block_const[block] = (int)block;
    for (int lane = 0; lane < SM_LANES; lane++) {
        long p =
            lsm->bodies > 1 ? block % lsm->lattice.count : lsm->particle[block * SM_LANES + lane];
        if (p < 0) continue;
        k->weight[lane] = (real)(mass_of(lsm, p) / lsm->members[p]);
        k->inverse_count[lane] = (real)(1.0 / lsm->members[p]);
    }
}

/* m~_i, 1/|R_i| of every block; then M_r and c0_r by the engine's own sums of m~ in place of m~ x.
 */
static void build_constants(Lsm *lsm)
{
    lsm->block_const = sm_alloc((size_t)lsm->blocks + 1, sizeof(int)); /* one for the empty block */
    lsm->particle_const = sm_alloc((size_t)lsm->blocks + 1, sizeof(ParticleConst));
    lsm->block_const[lsm->blocks] = (int)lsm->blocks;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lsm->blocks *SM_LANES))
    for (long block = 0; block < lsm->blocks; block++) block_constants(lsm, block);
    lsm->tile_const = sm_alloc((size_t)lsm->tiles, sizeof(int));
    lsm->region_const = sm_alloc((size_t)lsm->tiles, sizeof(RegionConst));
    for (long tile = 0; tile < lsm->tiles; tile++) lsm->tile_const[tile] = (int)tile;
    lsm_constants(lsm);
    lsm->particle_const = share_records(lsm->particle_const, sizeof(ParticleConst), lsm->blocks + 1,
                                        lsm->block_const, &lsm->particle_records);
    lsm->region_const = share_records(lsm->region_const, sizeof(RegionConst), lsm->tiles,
                                      lsm->tile_const, &lsm->region_records);
}

static void find_live(Lsm *lsm)
{
    lsm->live = sm_alloc((size_t)lsm->tiles, sizeof *lsm->live);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lsm->tiles *SM_LANES))
    for (long tile = 0; tile < lsm->tiles; tile++)
        for (int lane = 0; lane < SM_LANES; lane++)
            lsm->live[tile] |=
                (uint16_t)((lsm->bodies > 1 || lsm->tile_slot[tile * SM_LANES + lane] >= 0)
                           << lane);
}

static void build_memory(Lsm *lsm)
{
    size_t tiles = (size_t)lsm->tiles;
    lsm->centre = sm_alloc((size_t)(lsm->blocks + 1) * 3 * SM_LANES, sizeof(real));
    lsm->g = NULL;
    lsm->last = sm_alloc(tiles * 6 * SM_LANES, sizeof(short));
    vec identity[9];
    for (int i = 0; i < 9; i++) identity[i] = lanes_set(i % 4 == 0);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lsm->tiles *SM_LANES))
    for (long tile = 0; tile < lsm->tiles; tile++)
        last_store(lsm->last + tile * 6 * SM_LANES, identity);
    lsm->sweeps = sm_alloc((size_t)lsm->layers, sizeof(double));
    if (lsm->params.polar != SM_POLAR_JACOBI) return;
    lsm->stretch = sm_alloc(tiles * 9 * SM_LANES, sizeof(real));
    for (size_t i = 0; i < tiles * 9 * SM_LANES; i++) lsm->stretch[i] = i / SM_LANES % 9 % 4 == 0;
}

/* Lists, by which the constants of regions are made, too. */
static void open_lists(Lsm *lsm, const bool *listed)
{
    LsmLists *lists = &lsm->lists;
    const LsmSums *sums = lsm->sums;
    int *region_plane = sm_alloc((size_t)lists->region_count, sizeof(int));
    bool breaks = lsm->params.strain_limit > 0;
    for (long p = 0, region = 0; p < lsm->lattice.count; p++)
        if (listed[p]) region_plane[region++] = lsm->lattice.coord[p][2];
    if (breaks) lsm_allocator_make_room(lists, lsm->layers, lsm->layer_plane, lsm->spare);
    if (sums->open) lsm->sums = &lsm_sums_lists; /* until it is opened */
    lsm_rows_place(lsm, region_plane);
    build_constants(lsm);
    lsm->sums = sums;
    if (sums->open) {
        lsm_rows_place(lsm, region_plane);
        sums->open(lsm);
    }
    if (breaks) {
        lsm->allocator = sm_alloc(1, sizeof *lsm->allocator);
        lsm_allocator_open(lists, lsm->layers, lsm->layer_plane, region_plane, lsm->allocator);
    }
    free(region_plane);
}

static void build_regions(Lsm *lsm)
{
    long n = lsm->lattice.count;
    int *original = sm_alloc((size_t)n, sizeof *original);
    bool *listed = sm_alloc((size_t)n, sizeof *listed);
    lsm->members = sm_alloc((size_t)n, sizeof(int));
    lsm_interior_build(&lsm->lattice, lsm->w, &lsm->interior);
    list_regions(lsm, original, listed);
    for (long p = 0; p < n && lsm->params.strain_limit > 0; p++)
        original[p] = (int)p; /* equal regions may part: each has its own tile lane */
    if (lsm->box)
        tile_blocks(lsm);
    else if (lsm->bodies > 1)
        build_instance_tiles(lsm, original);
    else
        build_tiles(lsm, original);
    place_lists(lsm, listed);
    find_live(lsm);
    lsm_pipeline_split(lsm);
    if (lsm->sums->share) lsm->sums->share(lsm);
    build_memory(lsm);
    if (lsm->bodies > 1)
        build_constants(lsm);
    else
        open_lists(lsm, listed);
    sm_free_all(original, listed);
    if (lsm->params.strain_limit > 0) return;
    free(lsm->members);
    lsm->members = NULL;
}

SmCode lsm_check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error)
{
    SmCode code = sm_engine_check(voxels, params, error);
    if (code) return code;
    if (params->w > LSM_MAX_W)
        return sm_fail(error, SM_INPUT, "region half-width w = %d: must be 1 to %d", params->w,
                       LSM_MAX_W);
    if (voxels->particle_count > 500000000)
        return sm_fail(error, SM_INPUT, "%ld particles: at most 500 million; use larger cells",
                       voxels->particle_count);
    return SM_OK;
}

/* Masses in units of their mean: goals and damping do not depend on the unit, and single precision
 * then sees the same scales for a grain and for a mountain. */
static void take_masses(Lsm *lsm, const double *mass)
{
    long n = lsm->lattice.count;
    lsm->mass_unit = 1;
    if (!mass) return;
    lsm->mass = sm_alloc((size_t)n, sizeof(double));
    lsm->mass_unit = 0;
    for (long p = 0; p < n; p++) lsm->mass_unit += mass[p] / (double)n;
    for (long p = 0; p < n; p++) lsm->mass[p] = mass[p] / lsm->mass_unit;
}

/* The first form that applies. */
static void choose_sums(Lsm *lsm)
{
    static const LsmSums *const forms[] = {&lsm_sums_instances, &lsm_sums_naive, &lsm_sums_boxes,
                                           &lsm_sums_running, &lsm_sums_lists};
    int i = 0;
    while (!forms[i]->applies(lsm)) i++;
    lsm->sums = forms[i];
}

Lsm *lsm_build(const SmVoxels *voxels, const SmEngineParams *params)
{
    Lsm *lsm = sm_alloc(1, sizeof *lsm);
    lsm->params = *params;
    lsm->w = params->w;
    lsm->side = 2 * params->w + 1;
    lsm->cell = voxels->cell;
    lsm->bodies = params->instances > 1 ? params->instances : 1;
    size_t groups = (size_t)(lsm->bodies + SM_LANES - 1) / SM_LANES;
    lsm->origin = sm_alloc(groups * SM_LANES, sizeof *lsm->origin);
    lsm->shift = sm_alloc(groups, sizeof *lsm->shift);
    lsm_lattice_build(voxels, &lsm->lattice);
    long n = lsm->lattice.count;
    take_masses(lsm, params->mass);
    if (params->strain_limit > 0) lsm->mark = sm_alloc((size_t)n, 1);
    lsm->spare = SPARE_LISTS * lsm->side;
    choose_sums(lsm);
    lsm->sums->lay_out(lsm);
    build_regions(lsm);
    lsm->x = sm_alloc((size_t)(lsm->blocks + 1) * 3 * SM_LANES, sizeof(real));
    lsm->v = sm_alloc((size_t)(lsm->blocks + 1) * 3 * SM_LANES, sizeof(real));
    lsm->params.mass = NULL; /* the caller's, as is what follows */
    lsm->params.instance_pose = NULL;
    return lsm;
}

static void free_regions(Lsm *lsm)
{
    lsm_interior_free(&lsm->interior);
    lsm_lists_free(&lsm->lists);
    if (lsm->allocator) lsm_allocator_free(lsm->allocator);
    lsm_running_free(lsm->running);
    lsm->running = NULL;
    if (lsm->box) free(lsm->block_region);
    lsm_rows_free(lsm);
    for (int t = 0; lsm->group_rows && t < lsm->threads; t++) free(lsm->group_rows[t]);
    sm_free_all(lsm->allocator, lsm->tile_slot, lsm->layer_tile, lsm->copy, lsm->layer_copy,
                lsm->members, lsm->block_const, lsm->particle_const, lsm->tile_const,
                lsm->region_const, lsm->centre, lsm->last, lsm->sweeps, lsm->stretch, lsm->live,
                lsm->group_rows);
}

/* The last rotation of every region, by the slot of its centre. */
static short (*save_last(const Lsm *lsm))[6]
{
    short(*last)[6] = sm_alloc((size_t)lsm->blocks * SM_LANES, sizeof *last);
    for (long s = 0; s < lsm->tiles * SM_LANES; s++)
        for (int i = 0; i < 6 && lsm->tile_slot[s] >= 0; i++)
            last[lsm->tile_slot[s]][i] =
                lsm->last[(s / SM_LANES * 6 + i) * SM_LANES + s % SM_LANES];
    for (long c = 0; c < lsm->copies; c++)
        memcpy(last[lsm->copy[c][0]], last[lsm->copy[c][1]], sizeof *last);
    return last;
}

void lsm_rebuild_regions(Lsm *lsm)
{
    short(*last)[6] = save_last(lsm);
    free_regions(lsm);
    build_regions(lsm);
    for (long s = 0; s < lsm->tiles * SM_LANES; s++)
        for (int i = 0; i < 6 && lsm->tile_slot[s] >= 0; i++)
            lsm->last[(s / SM_LANES * 6 + i) * SM_LANES + s % SM_LANES] =
                last[lsm->tile_slot[s]][i];
    free(last);
}

void lsm_free(Lsm *lsm)
{
    free_regions(lsm);
    lsm_blocks_free(lsm->box);
    lsm_lattice_free(&lsm->lattice);
    sm_free_all(lsm->mass, lsm->slot, lsm->particle, lsm->x, lsm->v, lsm->layer_plane,
                lsm->layer_block, lsm->thread_layer, lsm->obstacles.obstacle, lsm->mark,
                lsm->listed, lsm->origin, lsm->shift, lsm);
}
