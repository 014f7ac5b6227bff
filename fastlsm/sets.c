#include "sets.h"

#include <stdlib.h>
#include <string.h>

/* A growing array of rows of ints, with a hash over their contents to store equal rows once. */
typedef struct {
    int width; /* ints in a row: `side` places and two of key */
    long count, room;
    int *row;       /* [room][width] */
    uint32_t *slot; /* [mask + 1] open addressing: row number, 0 for free */
    uint64_t mask;
} Pool;

uint64_t lsm_sets_hash(const int *row, int width)
{
    uint64_t h = 1469598103934665603ull;
    for (int i = 0; i < width; i++) {
        h = (h ^ (uint64_t)(uint32_t)row[i]) * 0x9e3779b97f4a7c15ull;
        h ^= h >> 29;
    }
    return h;
}

static void pool_rehash(Pool *pool, uint64_t mask)
{
    free(pool->slot);
    pool->mask = mask;
    pool->slot = sm_alloc(mask + 1, sizeof *pool->slot);
    for (long r = 1; r < pool->count; r++) {
        uint64_t at = lsm_sets_hash(pool->row + r * pool->width, pool->width) & mask;
        while (pool->slot[at]) at = (at + 1) & mask;
        pool->slot[at] = (uint32_t)r;
    }
}

/* Row 0 is all zeros: the absent member. */
static void pool_init(Pool *pool, int width, long guess)
{
    *pool = (Pool){.width = width, .count = 1, .room = guess + 16};
    pool->row = sm_alloc((size_t)pool->room * (size_t)width, sizeof(int));
    uint64_t mask = 63;
    while (mask < (uint64_t)guess * 2) mask = mask * 2 + 1;
    pool_rehash(pool, mask);
}

static void pool_free(Pool *pool)
{
    free(pool->row);
    free(pool->slot);
}

/* The number of this row, stored if it is new. */
static int pool_add(Pool *pool, const int *row)
{
    size_t bytes = (size_t)pool->width * sizeof(int);
    uint64_t at = lsm_sets_hash(row, pool->width) & pool->mask;
    for (; pool->slot[at]; at = (at + 1) & pool->mask)
        if (!memcmp(pool->row + (long)pool->slot[at] * pool->width, row, bytes))
            return (int)pool->slot[at];
    if (pool->count == pool->room) {
        pool->room *= 2;
        pool->row = sm_realloc(pool->row, (size_t)pool->room * (size_t)pool->width, sizeof(int));
    }
    long r = pool->count++;
    memcpy(pool->row + r * pool->width, row, bytes);
    pool->slot[at] = (uint32_t)r;
    if ((uint64_t)pool->count * 2 > pool->mask) pool_rehash(pool, pool->mask * 2 + 1);
    return (int)r;
}

typedef struct {
    const LsmLattice *lattice;
    const int *slot;
    int w, side;
    Pool bars, plates;
} Builder;

void lsm_sets_bar(const LsmLattice *l, const int *slot, int w, int x, int y, int z, uint64_t bits,
                  int *row)
{
    memset(row, 0, (size_t)(2 * w + 1) * sizeof *row);
    int last = __builtin_ctzll(bits);
    long p = lsm_lattice_find(l, x - w + last, y, z);
    for (uint64_t rest = bits; rest; rest &= rest - 1) {
        int a = __builtin_ctzll(rest);
        if (a != last + 1 && a != last)
            p = lsm_lattice_find(l, x - w + a, y, z);
        else
            p += a - last; /* particles of a run along x are numbered in a row */
        row[a] = slot[p] + 1;
        last = a;
    }
}

/* The same, stored; 0 when it has no members. */
static int add_bar(Builder *b, int x, int y, int z, uint64_t bits)
{
    int row[LSM_MAX_SIDE + 2];
    if (!bits) return 0;
    lsm_sets_bar(b->lattice, b->slot, b->w, x, y, z, bits, row);
    row[b->side] = x;
    row[b->side + 1] = z;
    return pool_add(&b->bars, row);
}

/* The plate of centre (x, y) in plane z. Its bars' keys tell centres apart along x; the place of a
 * bar tells them apart along y. */
static int add_plate(Builder *b, int x, int y, int z, const uint64_t *rows)
{
    int row[LSM_MAX_SIDE + 2] = {0}, any = 0;
    for (int i = 0; i < b->side; i++) any |= row[i] = add_bar(b, x, y + i - b->w, z, rows[i]);
    if (!any) return 0;
    row[b->side + 1] = z;
    return pool_add(&b->plates, row);
}

/* Sorts a pool's rows by plane, keeping their order within a plane. Writes the lists without keys,
 * the first row of each plane, and each old row's new number. */
static int *sort_by_plane(const Pool *pool, int side, int planes, long **first, int **renumber)
{
    long *start = sm_alloc((size_t)planes + 1, sizeof *start);
    int *number = sm_alloc((size_t)pool->count, sizeof *number);
    int *out = sm_alloc((size_t)pool->count * (size_t)side, sizeof *out);
    for (long r = 1; r < pool->count; r++) start[pool->row[r * pool->width + side + 1] + 1]++;
    start[0] = 1;
    for (int z = 0; z < planes; z++) start[z + 1] += start[z];
    long *next = sm_alloc((size_t)planes + 1, sizeof *next);
    memcpy(next, start, ((size_t)planes + 1) * sizeof *next);
    for (long r = 1; r < pool->count; r++) {
        const int *row = pool->row + r * pool->width;
        number[r] = (int)next[row[side + 1]]++;
        memcpy(out + (long)number[r] * side, row, (size_t)side * sizeof(int));
    }
    free(next);
    *first = start;
    *renumber = number;
    return out;
}

static void renumber_rows(int *row, long count, const int *number)
{
    for (long i = 0; i < count; i++) row[i] = number[row[i]];
}

static void build_regions(Builder *b, const LsmInterior *interior, const bool *wanted,
                          LsmSets *sets)
{
    const LsmLattice *l = b->lattice;
    uint64_t rows[LSM_MAX_SIDE * LSM_MAX_SIDE];
    for (long p = 0; p < l->count; p++) {
        if (!wanted[p]) continue;
        lsm_region_rows(l, interior, p, rows);
        const int *c = l->coord[p];
        int *region = sets->region + sets->region_count * b->side;
        for (int i = 0; i < b->side; i++)
            region[i] = add_plate(b, c[0], c[1], c[2] + i - b->w, rows + i * b->side);
        sets->region_particle[sets->region_count++] = (int)p;
    }
}

static long *copy_planes(const long *plane, int planes)
{
    long *copy = sm_alloc((size_t)planes + 1, sizeof *copy);
    return memcpy(copy, plane, ((size_t)planes + 1) * sizeof *copy);
}

void lsm_sets_build(const LsmLattice *l, const LsmInterior *interior, const bool *wanted,
                    const int *slot, LsmSets *sets)
{
    long count = 0;
    for (long p = 0; p < l->count; p++) count += wanted[p];
    int w = interior->w, side = 2 * w + 1;
    *sets = (LsmSets){.w = w, .side = side, .region_room = count, .planes = l->size[2]};
    sets->region = sm_alloc((size_t)count * (size_t)side, sizeof(int));
    sets->region_particle = sm_alloc((size_t)count, sizeof(int));
    Builder b = {.lattice = l, .slot = slot, .w = w, .side = side};
    pool_init(&b.bars, side + 2, 2 * count);
    pool_init(&b.plates, side + 2, 2 * count);
    build_regions(&b, interior, wanted, sets);

    int *bar_number, *plate_number;
    sets->bar = sort_by_plane(&b.bars, side, sets->planes, &sets->bar_plane, &bar_number);
    sets->plate = sort_by_plane(&b.plates, side, sets->planes, &sets->plate_plane, &plate_number);
    sets->bar_end = copy_planes(sets->bar_plane, sets->planes);
    sets->plate_end = copy_planes(sets->plate_plane, sets->planes);
    sets->bar_count = b.bars.count;
    sets->plate_count = b.plates.count;
    renumber_rows(sets->plate, sets->plate_count * side, bar_number);
    renumber_rows(sets->region, sets->region_count * side, plate_number);
    free(bar_number);
    free(plate_number);
    pool_free(&b.bars);
    pool_free(&b.plates);
}

void lsm_sets_free(LsmSets *sets)
{
    free(sets->bar);
    free(sets->plate);
    free(sets->region);
    free(sets->region_particle);
    free(sets->bar_plane);
    free(sets->plate_plane);
    free(sets->bar_end);
    free(sets->plate_end);
    memset(sets, 0, sizeof *sets);
}
