#include "ledger.h"

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

static uint64_t bucket_of(const LsmShelf *shelf, const int *row)
{
    return lsm_sets_hash(row, shelf->side) & shelf->mask;
}

static void enter(LsmShelf *shelf, long r)
{
    uint64_t at = bucket_of(shelf, shelf->row + r * shelf->side);
    shelf->next[r] = shelf->bucket[at];
    shelf->bucket[at] = (int)r;
}

/* Counts how often `named` (rows of the next kind) names each row, and enters those in use. */
static void open_shelf(LsmShelf *shelf, long count, const int *named, long names, int planes)
{
    size_t rows = (size_t)count;
    shelf->mask = 63;
    while (shelf->mask < rows) shelf->mask = shelf->mask * 2 + 1;
    shelf->uses = sm_alloc(rows, sizeof(int));
    shelf->next = sm_alloc(rows, sizeof(int));
    shelf->bucket = sm_alloc(shelf->mask + 1, sizeof(int));
    shelf->free_row = sm_alloc((size_t)planes + 1, sizeof(int));
    for (long i = 0; i < names; i++) shelf->uses[named[i] / LSM_NAME]++;
    for (long r = 1; r < count; r++)
        if (shelf->uses[r]) enter(shelf, r);
}

void lsm_ledger_open(LsmSets *sets, int layers, const int *layer_plane, long spare,
                     LsmLedger *ledger)
{
    int side = sets->side;
    int *number = make_room(&sets->bar, side, &sets->bar_count, sets->bar_plane, sets->bar_end,
                            layers, layer_plane, spare);
    rename_rows(sets->plate, sets->plate_count * side, number);
    free(number);
    number = make_room(&sets->plate, side, &sets->plate_count, sets->plate_plane, sets->plate_end,
                       layers, layer_plane, spare);
    rename_rows(sets->region, sets->region_count * side, number);
    free(number);
    *ledger = (LsmLedger){
        .bars = {.side = side, .row = sets->bar, .limit = sets->bar_plane, .end = sets->bar_end},
        .plates = {
            .side = side, .row = sets->plate, .limit = sets->plate_plane, .end = sets->plate_end}};
    open_shelf(&ledger->bars, sets->bar_count, sets->plate, sets->plate_count * side, sets->planes);
    open_shelf(&ledger->plates, sets->plate_count, sets->region, sets->region_count * side,
               sets->planes);
    ledger->layer_end = sm_alloc((size_t)sets->planes, sizeof(int));
    for (int l = 0; l < layers; l++)
        for (int z = layer_plane[l]; z < layer_plane[l + 1]; z++)
            ledger->layer_end[z] = layer_plane[l + 1];
    ledger->bytes = (2 * (sets->bar_count + sets->plate_count) + (long)ledger->bars.mask +
                     (long)ledger->plates.mask + 3 * sets->planes) *
                    (long)sizeof(int);
}

static void free_shelf(LsmShelf *shelf)
{
    free(shelf->uses);
    free(shelf->next);
    free(shelf->bucket);
    free(shelf->free_row);
}

void lsm_ledger_free(LsmLedger *ledger)
{
    free_shelf(&ledger->bars);
    free_shelf(&ledger->plates);
    free(ledger->layer_end);
    memset(ledger, 0, sizeof *ledger);
}

/* The number of a row with these members in the layer before plane `layer_end`, a new one when
 * there is none (uses 0 then); -1 when the layer is full. */
static int find_or_add(LsmShelf *shelf, int layer_end, const int *row)
{
    size_t bytes = (size_t)shelf->side * sizeof(int);
    for (int r = shelf->bucket[bucket_of(shelf, row)]; r; r = shelf->next[r])
        if (!memcmp(shelf->row + (long)r * shelf->side, row, bytes)) return r;
    int r = shelf->free_row[layer_end];
    if (r)
        shelf->free_row[layer_end] = shelf->next[r];
    else if (shelf->end[layer_end] < shelf->limit[layer_end])
        r = (int)shelf->end[layer_end]++;
    else
        return -1;
    memcpy(shelf->row + (long)r * shelf->side, row, bytes);
    enter(shelf, r);
    return r;
}

/* Takes back one use of row r. A row without uses becomes free; returns whether it did, its members
 * in `row`. A free row lists nothing: the sums still pass over it. */
static bool give_back(LsmShelf *shelf, int layer_end, int r, int *row)
{
    if (--shelf->uses[r]) return false;
    size_t bytes = (size_t)shelf->side * sizeof(int);
    memcpy(row, shelf->row + (long)r * shelf->side, bytes);
    int *link = &shelf->bucket[bucket_of(shelf, row)];
    while (*link != r) link = &shelf->next[*link];
    *link = shelf->next[r];
    memset(shelf->row + (long)r * shelf->side, 0, bytes);
    shelf->next[r] = shelf->free_row[layer_end];
    shelf->free_row[layer_end] = r;
    return true;
}

/* The plate of centre (x, y) in plane z with these members (any): its row, or -1 for no room. */
static int add_plate(LsmLedger *ledger, const LsmLattice *l, const int *slot, const int at[3],
                     const uint64_t *rows)
{
    int side = ledger->bars.side, layer_end = ledger->layer_end[at[2]];
    int plate[LSM_MAX_SIDE] = {0}, bar[LSM_MAX_SIDE];
    for (int i = 0; i < side; i++) {
        if (!rows[i]) continue;
        lsm_sets_bar(l, slot, side / 2, at[0], at[1] + i - side / 2, at[2], rows[i], bar);
        int r = find_or_add(&ledger->bars, layer_end, bar);
        if (r < 0) return -1;
        plate[i] = LSM_NAME * r;
    }
    int r = find_or_add(&ledger->plates, layer_end, plate);
    if (r < 0) return -1;
    for (int i = 0; i < side && !ledger->plates.uses[r]; i++)
        if (plate[i]) ledger->bars.uses[plate[i] / LSM_NAME]++;
    return r;
}

static void drop_plate(LsmLedger *ledger, int z, int plate)
{
    int row[LSM_MAX_SIDE], bar[LSM_MAX_SIDE], layer_end = ledger->layer_end[z];
    if (!give_back(&ledger->plates, layer_end, plate, row)) return;
    for (int i = 0; i < ledger->plates.side; i++)
        if (row[i]) give_back(&ledger->bars, layer_end, row[i] / LSM_NAME, bar);
}

bool lsm_ledger_revise(LsmLedger *ledger, LsmSets *sets, const LsmLattice *l, const int *slot,
                       long p, long region, const uint64_t *rows)
{
    int side = sets->side, plate[LSM_MAX_SIDE], *old = sets->region + region * side;
    for (int i = 0; i < side; i++) {
        int at[3] = {l->coord[p][0], l->coord[p][1], l->coord[p][2] + i - side / 2};
        uint64_t any = 0;
        for (int b = 0; b < side; b++) any |= rows[i * side + b];
        int r = any ? add_plate(ledger, l, slot, at, rows + i * side) : 0;
        if (r < 0) return false;
        if (r) ledger->plates.uses[r]++;
        plate[i] = LSM_NAME * r;
    }
    for (int i = 0; i < side; i++)
        if (old[i]) drop_plate(ledger, l->coord[p][2] + i - side / 2, old[i] / LSM_NAME);
    memcpy(old, plate, (size_t)side * sizeof(int));
    return true;
}
