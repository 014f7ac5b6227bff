#include "list_allocator.h"

#include <stdlib.h>
#include <string.h>

/* Moves the rows of each layer behind the spare rows of the layer before. Returns old row -> new.
 */
static int *make_room(int **rows, int side, long *count, long *plane, long *end, int layers,
                      const int *layer_plane, long spare)
{
    long room = *count + (*count) / 4 + layers * spare;
    lsm_names_reach(room);
    int *number = sm_alloc((size_t)*count, sizeof *number);
    int *out = sm_alloc((size_t)room * (size_t)side, sizeof *out);
    long from = 1, to = 1;
    for (int l = 0; l < layers; l++) {
        long n = plane[layer_plane[l + 1]] - from;
        memcpy(out + to * side, *rows + from * side, (size_t)(n * side) * sizeof(int));
        for (long i = 0; i < n; i++) number[from + i] = (int)(to + i);
        for (int z = layer_plane[l]; z < layer_plane[l + 1]; z++) {
            plane[z] += to - from;
            end[z + 1] = plane[z + 1] + to - from;
        }
        from += n;
        to += n + n / 4 + spare;
    }
    plane[layer_plane[layers]] = *count = to;
    free(*rows);
    *rows = out;
    return number;
}

static void rename_rows(int *name, long count, const int *number)
{
    for (long i = 0; i < count; i++) name[i] = LSM_NAME * number[name[i] / LSM_NAME];
}

/* Rows of different layers may be alike. */
static int *bucket_of(const LsmRowStore *store, int layer, const int *row)
{
    uint64_t hash = lsm_lists_hash(row, store->side) + (uint64_t)layer * 0x9e3779b97f4a7c15ull;
    return &store->bucket[hash & store->mask];
}

static void enter(LsmRowStore *store, int layer, long r)
{
    int *bucket = bucket_of(store, layer, store->row + r * store->side);
    store->next[r] = *bucket;
    *bucket = (int)r;
}

static void open_store(LsmRowStore *store, long count, int layers)
{
    size_t rows = (size_t)count;
    store->mask = 63;
    while (store->mask < rows) store->mask = store->mask * 2 + 1;
    store->uses = sm_alloc(rows, sizeof(int));
    store->next = sm_alloc(rows, sizeof(int));
    store->bucket = sm_alloc(store->mask + 1, sizeof(int));
    store->free_row = sm_alloc((size_t)layers, sizeof(int));
}

static void enter_used(LsmRowStore *store, int planes, const int *layer)
{
    for (int z = 0; z < planes; z++)
        for (long r = store->limit[z]; r < store->end[z + 1]; r++)
            if (store->uses[r]) enter(store, layer[z], r);
}

/* Counts how often rows of the next kind name each row, and enters those in use. */
static void count_uses(LsmListAllocator *allocator, const LsmLists *lists, const int *region_plane)
{
    LsmRowStore *bars = &allocator->bars, *plates = &allocator->plates;
    int side = lists->side;
    for (int z = 0; z < lists->planes; z++)
        for (long i = lists->plate_plane[z] * side; i < lists->plate_end[z + 1] * side; i++)
            bars->uses[lsm_named(bars->shift, z, lists->plate[i])]++;
    for (long i = 0; i < lists->region_count * side; i++)
        plates->uses[lsm_named(plates->shift, region_plane[i / side] + (int)(i % side) - lists->w,
                               lists->region[i])]++;
    enter_used(bars, lists->planes, allocator->layer);
    enter_used(plates, lists->planes, allocator->layer);
}

void lsm_allocator_make_room(LsmLists *lists, int layers, const int *layer_plane, long spare)
{
    int side = lists->side;
    int *number = make_room(&lists->bar, side, &lists->bar_count, lists->bar_plane, lists->bar_end,
                            layers, layer_plane, spare);
    rename_rows(lists->plate, lists->plate_count * side, number);
    free(number);
    number = make_room(&lists->plate, side, &lists->plate_count, lists->plate_plane,
                       lists->plate_end, layers, layer_plane, spare);
    rename_rows(lists->region, lists->region_count * side, number);
    free(number);
}

void lsm_allocator_open(LsmLists *lists, int layers, const int *layer_plane,
                        const int *region_plane, LsmListAllocator *allocator)
{
    int side = lists->side;
    *allocator = (LsmListAllocator){.bars = {.side = side,
                                             .row = lists->bar,
                                             .shift = lists->bar_shift,
                                             .layer_plane = layer_plane,
                                             .limit = lists->bar_plane,
                                             .end = lists->bar_end},
                                    .plates = {.side = side,
                                               .row = lists->plate,
                                               .shift = lists->plate_shift,
                                               .layer_plane = layer_plane,
                                               .limit = lists->plate_plane,
                                               .end = lists->plate_end}};
    open_store(&allocator->bars, lists->bar_count, layers);
    open_store(&allocator->plates, lists->plate_count, layers);
    allocator->layer = sm_alloc((size_t)lists->planes, sizeof(int));
    for (int l = 0; l < layers; l++)
        for (int z = layer_plane[l]; z < layer_plane[l + 1]; z++) allocator->layer[z] = l;
    count_uses(allocator, lists, region_plane);
}

static void free_store(LsmRowStore *store)
{
    free(store->uses);
    free(store->next);
    free(store->bucket);
    free(store->free_row);
}

void lsm_allocator_free(LsmListAllocator *allocator)
{
    free_store(&allocator->bars);
    free_store(&allocator->plates);
    free(allocator->layer);
    memset(allocator, 0, sizeof *allocator);
}

/* The number of a row of the layer with these members, a new one when there is none (uses 0 then);
 * -1 when the layer is full. */
static int find_or_add(LsmRowStore *store, int layer, const int *row)
{
    size_t bytes = (size_t)store->side * sizeof(int);
    int behind = store->layer_plane[layer + 1];
    long first = store->limit[store->layer_plane[layer]], *end = &store->end[behind];
    for (int r = *bucket_of(store, layer, row); r; r = store->next[r])
        if (r >= first && r < *end && !memcmp(store->row + (long)r * store->side, row, bytes))
            return r;
    int r = store->free_row[layer];
    if (r)
        store->free_row[layer] = store->next[r];
    else if (*end < store->limit[behind])
        r = (int)(*end)++;
    else
        return -1;
    memcpy(store->row + (long)r * store->side, row, bytes);
    enter(store, layer, r);
    return r;
}

/* Takes back one use of row r. A row without uses becomes free; returns whether it did, its members
 * in `row`. A free row lists nothing: the sums still pass over it. */
static bool give_back(LsmRowStore *store, int layer, int r, int *row)
{
    if (--store->uses[r]) return false;
    size_t bytes = (size_t)store->side * sizeof(int);
    memcpy(row, store->row + (long)r * store->side, bytes);
    int *link = bucket_of(store, layer, row);
    while (*link != r) link = &store->next[*link];
    *link = store->next[r];
    memset(store->row + (long)r * store->side, 0, bytes);
    store->next[r] = store->free_row[layer];
    store->free_row[layer] = r;
    return true;
}

/* The plate of centre (x, y) in plane z with these members (any): its row, or -1 for no room. */
static int add_plate(LsmListAllocator *allocator, const LsmLists *lists, const LsmLattice *l,
                     const int *slot, const int at[3], const LsmRow *rows)
{
    LsmRowStore *bars = &allocator->bars;
    int side = bars->side, z = at[2], layer = allocator->layer[z];
    int plate[LSM_MAX_SIDE] = {0}, bar[LSM_MAX_SIDE];
    for (int i = 0; i < side; i++) {
        if (!rows[i]) continue;
        lsm_lists_bar(l, slot, lists->slot_shift[z], side / 2, at[0], at[1] + i - side / 2, z,
                      rows[i], bar);
        int r = find_or_add(bars, layer, bar);
        if (r < 0) return -1;
        plate[i] = lsm_name(bars->shift, z, r);
    }
    int r = find_or_add(&allocator->plates, layer, plate);
    if (r < 0) return -1;
    for (int i = 0; i < side && !allocator->plates.uses[r]; i++)
        if (plate[i]) bars->uses[lsm_named(bars->shift, z, plate[i])]++;
    return r;
}

static void drop_plate(LsmListAllocator *allocator, int z, int plate)
{
    LsmRowStore *bars = &allocator->bars;
    int row[LSM_MAX_SIDE], bar[LSM_MAX_SIDE], layer = allocator->layer[z];
    if (!give_back(&allocator->plates, layer, plate, row)) return;
    for (int i = 0; i < allocator->plates.side; i++)
        if (row[i]) give_back(bars, layer, lsm_named(bars->shift, z, row[i]), bar);
}

bool lsm_allocator_revise(LsmListAllocator *allocator, LsmLists *lists, const LsmLattice *l,
                          const int *slot, long p, long region, const LsmRow *rows)
{
    int side = lists->side, plate[LSM_MAX_SIDE], *old = lists->region + region * side;
    for (int i = 0; i < side; i++) {
        int at[3] = {l->coord[p][0], l->coord[p][1], l->coord[p][2] + i - side / 2};
        LsmRow any = 0;
        for (int b = 0; b < side; b++) any |= rows[i * side + b];
        int r = any ? add_plate(allocator, lists, l, slot, at, rows + i * side) : 0;
        if (r < 0) return false;
        if (r) allocator->plates.uses[r]++;
        plate[i] = r ? lsm_name(lists->plate_shift, at[2], r) : 0;
    }
    for (int i = 0; i < side; i++) {
        int z = l->coord[p][2] + i - side / 2;
        if (old[i]) drop_plate(allocator, z, lsm_named(lists->plate_shift, z, old[i]));
    }
    memcpy(old, plate, (size_t)side * sizeof(int));
    return true;
}
