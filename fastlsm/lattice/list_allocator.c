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

static uint64_t bucket_of(const LsmRowStore *store, const int *row)
{
    return lsm_lists_hash(row, store->side) & store->mask;
}

static void enter(LsmRowStore *store, long r)
{
    uint64_t at = bucket_of(store, store->row + r * store->side);
    store->next[r] = store->bucket[at];
    store->bucket[at] = (int)r;
}

/* Counts how often `named` (rows of the next kind) names each row, and enters those in use. */
static void open_store(LsmRowStore *store, long count, const int *named, long names, int planes)
{
    size_t rows = (size_t)count;
    store->mask = 63;
    while (store->mask < rows) store->mask = store->mask * 2 + 1;
    store->uses = sm_alloc(rows, sizeof(int));
    store->next = sm_alloc(rows, sizeof(int));
    store->bucket = sm_alloc(store->mask + 1, sizeof(int));
    store->free_row = sm_alloc((size_t)planes + 1, sizeof(int));
    for (long i = 0; i < names; i++) store->uses[named[i] / LSM_NAME]++;
    for (long r = 1; r < count; r++)
        if (store->uses[r]) enter(store, r);
}

void lsm_allocator_open(LsmLists *lists, int layers, const int *layer_plane, long spare,
                        LsmListAllocator *allocator)
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
    *allocator = (LsmListAllocator){
        .bars = {.side = side, .row = lists->bar, .limit = lists->bar_plane, .end = lists->bar_end},
        .plates = {.side = side,
                   .row = lists->plate,
                   .limit = lists->plate_plane,
                   .end = lists->plate_end}};
    open_store(&allocator->bars, lists->bar_count, lists->plate, lists->plate_count * side,
               lists->planes);
    open_store(&allocator->plates, lists->plate_count, lists->region, lists->region_count * side,
               lists->planes);
    allocator->layer_end = sm_alloc((size_t)lists->planes, sizeof(int));
    for (int l = 0; l < layers; l++)
        for (int z = layer_plane[l]; z < layer_plane[l + 1]; z++)
            allocator->layer_end[z] = layer_plane[l + 1];
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
    free(allocator->layer_end);
    memset(allocator, 0, sizeof *allocator);
}

/* The number of a row with these members in the layer before plane `layer_end`, a new one when
 * there is none (uses 0 then); -1 when the layer is full. */
static int find_or_add(LsmRowStore *store, int layer_end, const int *row)
{
    size_t bytes = (size_t)store->side * sizeof(int);
    for (int r = store->bucket[bucket_of(store, row)]; r; r = store->next[r])
        if (!memcmp(store->row + (long)r * store->side, row, bytes)) return r;
    int r = store->free_row[layer_end];
    if (r)
        store->free_row[layer_end] = store->next[r];
    else if (store->end[layer_end] < store->limit[layer_end])
        r = (int)store->end[layer_end]++;
    else
        return -1;
    memcpy(store->row + (long)r * store->side, row, bytes);
    enter(store, r);
    return r;
}

/* Takes back one use of row r. A row without uses becomes free; returns whether it did, its members
 * in `row`. A free row lists nothing: the sums still pass over it. */
static bool give_back(LsmRowStore *store, int layer_end, int r, int *row)
{
    if (--store->uses[r]) return false;
    size_t bytes = (size_t)store->side * sizeof(int);
    memcpy(row, store->row + (long)r * store->side, bytes);
    int *link = &store->bucket[bucket_of(store, row)];
    while (*link != r) link = &store->next[*link];
    *link = store->next[r];
    memset(store->row + (long)r * store->side, 0, bytes);
    store->next[r] = store->free_row[layer_end];
    store->free_row[layer_end] = r;
    return true;
}

/* The plate of centre (x, y) in plane z with these members (any): its row, or -1 for no room. */
static int add_plate(LsmListAllocator *allocator, const LsmLattice *l, const int *slot,
                     const int at[3], const uint64_t *rows)
{
    int side = allocator->bars.side, layer_end = allocator->layer_end[at[2]];
    int plate[LSM_MAX_SIDE] = {0}, bar[LSM_MAX_SIDE];
    for (int i = 0; i < side; i++) {
        if (!rows[i]) continue;
        lsm_lists_bar(l, slot, side / 2, at[0], at[1] + i - side / 2, at[2], rows[i], bar);
        int r = find_or_add(&allocator->bars, layer_end, bar);
        if (r < 0) return -1;
        plate[i] = LSM_NAME * r;
    }
    int r = find_or_add(&allocator->plates, layer_end, plate);
    if (r < 0) return -1;
    for (int i = 0; i < side && !allocator->plates.uses[r]; i++)
        if (plate[i]) allocator->bars.uses[plate[i] / LSM_NAME]++;
    return r;
}

static void drop_plate(LsmListAllocator *allocator, int z, int plate)
{
    int row[LSM_MAX_SIDE], bar[LSM_MAX_SIDE], layer_end = allocator->layer_end[z];
    if (!give_back(&allocator->plates, layer_end, plate, row)) return;
    for (int i = 0; i < allocator->plates.side; i++)
        if (row[i]) give_back(&allocator->bars, layer_end, row[i] / LSM_NAME, bar);
}

bool lsm_allocator_revise(LsmListAllocator *allocator, LsmLists *lists, const LsmLattice *l,
                          const int *slot, long p, long region, const uint64_t *rows)
{
    int side = lists->side, plate[LSM_MAX_SIDE], *old = lists->region + region * side;
    for (int i = 0; i < side; i++) {
        int at[3] = {l->coord[p][0], l->coord[p][1], l->coord[p][2] + i - side / 2};
        uint64_t any = 0;
        for (int b = 0; b < side; b++) any |= rows[i * side + b];
        int r = any ? add_plate(allocator, l, slot, at, rows + i * side) : 0;
        if (r < 0) return false;
        if (r) allocator->plates.uses[r]++;
        plate[i] = LSM_NAME * r;
    }
    for (int i = 0; i < side; i++)
        if (old[i]) drop_plate(allocator, l->coord[p][2] + i - side / 2, old[i] / LSM_NAME);
    memcpy(old, plate, (size_t)side * sizeof(int));
    return true;
}
