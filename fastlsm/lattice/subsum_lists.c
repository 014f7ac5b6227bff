#include "subsum_lists.h"

#include <limits.h>
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

uint64_t lsm_lists_hash(const int *row, int width)
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
        uint64_t at = lsm_lists_hash(pool->row + r * pool->width, pool->width) & mask;
        while (pool->slot[at]) at = (at + 1) & mask;
        pool->slot[at] = (uint32_t)r;
    }
}

/* Row 0 is all zeros: the absent member. */
static void pool_init(Pool *pool, int width)
{
    *pool = (Pool){.width = width, .count = 1, .room = 1024};
    pool->row = sm_alloc((size_t)pool->room * (size_t)width, sizeof(int));
    pool_rehash(pool, 2047);
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
    uint64_t at = lsm_lists_hash(row, pool->width) & pool->mask;
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

struct LsmListsBuilder {
    const LsmLattice *lattice;
    const int *slot;
    int w, side;
    Pool bars, plates;
    /* made when the first region is added: */
    int *full_plate;     /* [particles] the whole plate around it, 0: not met yet */
    int *recent_bar;     /* [particles] the last bar around it: neighbours mostly share it */
    LsmRow *recent_bits; /* [particles] its members, 0: none yet */
    int *region;         /* [region_room][side] */
    long region_count, region_room;
};

void lsm_lists_bar(const LsmLattice *l, const int *slot, int slot_shift, int w, int x, int y, int z,
                   LsmRow bits, int *row)
{
    memset(row, 0, (size_t)(2 * w + 1) * sizeof *row);
    int last = lsm_row_first(bits);
    long p = lsm_lattice_find(l, x - w + last, y, z);
    for (LsmRow rest = bits; rest; rest &= rest - 1) {
        int a = lsm_row_first(rest);
        if (a != last + 1 && a != last)
            p = lsm_lattice_find(l, x - w + a, y, z);
        else
            p += a - last; /* particles of a run along x are numbered in a row */
        row[a] = LSM_NAME * (slot[p] + slot_shift);
        last = a;
    }
}

/* The same, stored; 0 when it has no members. */
static int add_bar(LsmListsBuilder *b, int x, int y, int z, LsmRow bits)
{
    int row[LSM_MAX_SIDE + 2];
    if (!bits) return 0;
    long centre = lsm_lattice_find(b->lattice, x, y, z);
    if (centre >= 0 && b->recent_bits[centre] == bits) return b->recent_bar[centre];
    lsm_lists_bar(b->lattice, b->slot, 1, b->w, x, y, z, bits, row);
    row[b->side] = x;
    row[b->side + 1] = z;
    int r = pool_add(&b->bars, row);
    if (centre < 0) return r;
    b->recent_bits[centre] = bits;
    return b->recent_bar[centre] = r;
}

/* The plate of centre (x, y) in plane z. Its bars' keys tell centres apart along x; the place of a
 * bar tells them apart along y. */
static int add_plate(LsmListsBuilder *b, int x, int y, int z, const LsmRow *rows)
{
    int row[LSM_MAX_SIDE + 2] = {0}, *full = NULL;
    LsmRow any = 0, all = lsm_row_full(b->w);
    for (int i = 0; i < b->side; i++) {
        any |= rows[i];
        all &= rows[i];
    }
    if (!any) return 0;
    if (all == lsm_row_full(b->w)) full = &b->full_plate[lsm_lattice_find(b->lattice, x, y, z)];
    if (full && *full) return *full;
    for (int i = 0; i < b->side; i++) row[i] = add_bar(b, x, y + i - b->w, z, rows[i]);
    row[b->side] = y;
    row[b->side + 1] = z;
    int r = pool_add(&b->plates, row);
    if (full) *full = r;
    return r;
}

/* Sorts a pool's rows by plane and, within it, by their other key (0 .. keys - 1): a row comes
 * after those of the neighbour before it (running_lists.h). Writes the lists without keys, the
 * first row of each plane, and each old row's new number. */
static int *sort_rows(const Pool *pool, int side, int planes, int keys, long **first,
                      int **renumber)
{
    size_t cells = (size_t)planes * (size_t)keys;
    long *start = sm_alloc((size_t)planes + 1, sizeof *start);
    int *next = sm_alloc(cells + 1, sizeof *next);
    int *number = sm_alloc((size_t)pool->count, sizeof *number);
    int *out = sm_alloc((size_t)pool->count * (size_t)side, sizeof *out);
    for (long r = 1; r < pool->count; r++) {
        const int *key = pool->row + r * pool->width + side;
        next[(size_t)key[1] * (size_t)keys + (size_t)key[0] + 1]++;
    }
    next[0] = 1;
    for (size_t cell = 0; cell < cells; cell++) next[cell + 1] += next[cell];
    for (int z = 0; z <= planes; z++) start[z] = next[(size_t)z * (size_t)keys];
    for (long r = 1; r < pool->count; r++) {
        const int *row = pool->row + r * pool->width, *key = row + side;
        number[r] = next[(size_t)key[1] * (size_t)keys + (size_t)key[0]]++;
        memcpy(out + (long)number[r] * side, row, (size_t)side * sizeof(int));
    }
    free(next);
    *first = start;
    *renumber = number;
    return out;
}

/* From the numbers that rows had in their pool to the names of where they are now. */
static void name_rows(int *row, long count, const int *number)
{
    for (long i = 0; i < count; i++) row[i] = LSM_NAME * number[row[i]];
}

static long *copy_planes(const long *plane, int planes)
{
    long *copy = sm_alloc((size_t)planes + 1, sizeof *copy);
    return memcpy(copy, plane, ((size_t)planes + 1) * sizeof *copy);
}

LsmListsBuilder *lsm_lists_open(const LsmLattice *l, const int *slot, int w)
{
    LsmListsBuilder *b = sm_alloc(1, sizeof *b);
    *b = (LsmListsBuilder){.lattice = l, .slot = slot, .w = w, .side = 2 * w + 1};
    pool_init(&b->bars, b->side + 2);
    pool_init(&b->plates, b->side + 2);
    return b;
}

void lsm_lists_add(LsmListsBuilder *b, long p, const LsmRow *rows)
{
    if (!b->recent_bar) {
        b->recent_bar = sm_alloc((size_t)b->lattice->count, sizeof *b->recent_bar);
        b->recent_bits = sm_alloc((size_t)b->lattice->count, sizeof *b->recent_bits);
        b->full_plate = sm_alloc((size_t)b->lattice->count, sizeof *b->full_plate);
    }
    if (b->region_count == b->region_room) {
        b->region_room = 2 * b->region_room + 64;
        b->region = sm_realloc(b->region, (size_t)(b->region_room * b->side), sizeof(int));
    }
    const int *c = b->lattice->coord[p];
    int *region = b->region + b->region_count++ * b->side;
    for (int i = 0; i < b->side; i++)
        region[i] = add_plate(b, c[0], c[1], c[2] + i - b->w, rows + i * b->side);
}

void lsm_names_reach(long rows)
{
    if (rows > INT_MAX / LSM_NAME) free(sm_alloc(SIZE_MAX, LSM_NAME));
}

void lsm_lists_close(LsmListsBuilder *b, LsmLists *lists)
{
    lsm_names_reach(b->bars.count);
    lsm_names_reach(b->plates.count);
    int side = b->side, planes = b->lattice->size[2], *bar_number, *plate_number;
    *lists = (LsmLists){.w = b->w,
                        .side = side,
                        .bar_count = b->bars.count,
                        .plate_count = b->plates.count,
                        .region_count = b->region_count,
                        .region_room = b->region_count,
                        .planes = planes};
    const int *size = b->lattice->size;
    lists->bar = sort_rows(&b->bars, side, planes, size[0], &lists->bar_plane, &bar_number);
    pool_free(&b->bars);
    lists->plate = sort_rows(&b->plates, side, planes, size[1], &lists->plate_plane, &plate_number);
    pool_free(&b->plates);
    lists->bar_end = copy_planes(lists->bar_plane, planes);
    lists->plate_end = copy_planes(lists->plate_plane, planes);
    size_t places = (size_t)(b->region_count * side);
    lists->region = sm_realloc(b->region, places ? places : 1, sizeof(int));
    name_rows(lists->plate, lists->plate_count * side, bar_number);
    name_rows(lists->region, lists->region_count * side, plate_number);
    int **shift[] = {&lists->bar_shift, &lists->plate_shift, &lists->slot_shift};
    for (int i = 0; i < 3; i++) *shift[i] = sm_alloc((size_t)planes, sizeof(int));
    for (int z = 0; z < planes; z++) lists->slot_shift[z] = 1;
    free(bar_number);
    free(plate_number);
    free(b->recent_bar);
    free(b->recent_bits);
    free(b->full_plate);
    free(b);
}

static void shift_names(int *name, long count, int shift)
{
    for (long i = 0; i < count; i++)
        if (name[i]) name[i] += LSM_NAME * shift;
}

void lsm_lists_place(LsmLists *lists, int *bar_shift, int *plate_shift, int *slot_shift,
                     const int *region_plane)
{
    int side = lists->side;
    for (int z = 0; z < lists->planes; z++) {
        long bar = lists->bar_plane[z], plate = lists->plate_plane[z];
        shift_names(lists->bar + bar * side, (lists->bar_end[z + 1] - bar) * side,
                    slot_shift[z] - lists->slot_shift[z]);
        shift_names(lists->plate + plate * side, (lists->plate_end[z + 1] - plate) * side,
                    bar_shift[z] - lists->bar_shift[z]);
    }
    for (long i = 0; i < lists->region_count * side; i++) {
        int z = region_plane[i / side] + (int)(i % side) - lists->w;
        if (lists->region[i])
            shift_names(lists->region + i, 1, plate_shift[z] - lists->plate_shift[z]);
    }
    sm_free_all(lists->bar_shift, lists->plate_shift, lists->slot_shift);
    lists->bar_shift = bar_shift;
    lists->plate_shift = plate_shift;
    lists->slot_shift = slot_shift;
}

void lsm_lists_free(LsmLists *lists)
{
    free(lists->bar);
    free(lists->plate);
    free(lists->region);
    free(lists->bar_plane);
    free(lists->plate_plane);
    free(lists->bar_end);
    free(lists->plate_end);
    sm_free_all(lists->bar_shift, lists->plate_shift, lists->slot_shift);
    memset(lists, 0, sizeof *lists);
}
