/* Lists of regions (subsum_lists.h): what they name when they are built, after any changes
 * (list_allocator.h), and as rows made from their neighbours' (running_lists.h). */
#include "list_allocator.h"
#include "running_lists.h"

#include "../../lib/error.h"
#include "../../lib/test_frame.h"
#include "../../lib/voxel/test_bodies.h"

enum { WINDOW = LSM_MAX_SIDE * LSM_MAX_SIDE, PLATE = 6 };

/* A body some of whose particles have lists, and what each region is to list. */
typedef struct {
    SmVoxels voxels;
    LsmLattice lattice;
    LsmInterior interior;
    int w, side, layers;
    int *slot, *layer_plane; /* [particles], [layers + 1] */
    long regions, *centre;   /* [regions] particle */
    LsmRow (*rows)[WINDOW];  /* [regions] */
    LsmLists lists;
    LsmListAllocator allocator;
    int *region_plane;            /* [regions] */
    int **bar, **plate, **region; /* the lists, by numbers (1 + slot) in place of names */
} Listed;

static void build_lists(Listed *b)
{
    LsmListsBuilder *builder = lsm_lists_open(&b->lattice, b->slot, b->w);
    for (long r = 0; r < b->regions; r++) lsm_lists_add(builder, b->centre[r], b->rows[r]);
    lsm_lists_close(builder, &b->lists);
    assert_int_equal(b->lists.region_count, b->regions);
}

static int layer_of(const Listed *b, int z)
{
    int layer = 0;
    while (b->layer_plane[layer + 1] <= z) layer++;
    return layer;
}

/* Rows, or slots, of a layer are somewhere in memory, one after the other. */
static int *some_shifts(unsigned *seed, const Listed *b, const long *first)
{
    int *shift = sm_alloc((size_t)b->lists.planes, sizeof *shift);
    for (int l = 0; l < b->layers; l++) {
        int at = 1 + random_int(seed, 50) - (int)first[b->layer_plane[l]];
        for (int z = b->layer_plane[l]; z < b->layer_plane[l + 1]; z++) shift[z] = at;
    }
    return shift;
}

static void place_lists(unsigned *seed, Listed *b)
{
    LsmLists *l = &b->lists;
    long *slot = sm_alloc((size_t)l->planes, sizeof *slot);
    for (long p = b->lattice.count; p-- > 0;)
        slot[b->layer_plane[layer_of(b, b->lattice.coord[p][2])]] = b->slot[p];
    int *bar = some_shifts(seed, b, l->bar_plane), *plate = some_shifts(seed, b, l->plate_plane);
    lsm_lists_place(l, bar, plate, some_shifts(seed, b, slot), b->region_plane);
    free(slot);
}

/* Names of members of plane z, in numbers: these are off by `more`. */
static void copy_numbers(const int *name, long count, const int *shift, int z, int more, int *out)
{
    for (long i = 0; i < count; i++) {
        assert_int_equal(name[i] % LSM_NAME, 0);
        out[i] = name[i] ? lsm_named(shift, z, name[i]) + more : 0;
    }
}

static void number_lists(const Listed *b)
{
    const LsmLists *l = &b->lists;
    int side = b->side;
    sm_free_all(*b->bar, *b->plate, *b->region);
    *b->bar = sm_copy(l->bar, (size_t)(l->bar_count * side), sizeof(int));
    *b->plate = sm_copy(l->plate, (size_t)(l->plate_count * side), sizeof(int));
    *b->region = sm_copy(l->region, (size_t)(l->region_count * side), sizeof(int));
    for (int z = 0; z < l->planes; z++) {
        long bar = l->bar_plane[z] * side, plate = l->plate_plane[z] * side;
        copy_numbers(l->bar + bar, l->bar_end[z + 1] * side - bar, l->slot_shift, z, 1,
                     *b->bar + bar);
        copy_numbers(l->plate + plate, l->plate_end[z + 1] * side - plate, l->bar_shift, z, 0,
                     *b->plate + plate);
    }
    for (long i = 0; i < l->region_count * side; i++)
        copy_numbers(l->region + i, 1, l->plate_shift,
                     b->region_plane[i / side] + (int)(i % side) - b->w, 0, *b->region + i);
}

/* A body of a kind of test_bodies.h, or a plate on which runs are at their longest; of layers of
 * one to four planes. About `share` of the regions, at least one, have lists. */
static void listed_open(unsigned *seed, int kind, int w, double share, Listed *b)
{
    *b = (Listed){.w = w, .side = 2 * w + 1};
    if (kind == PLATE)
        random_block(seed, (const int[3]){24, 20, 2}, 1, 1, &b->voxels);
    else
        random_body(seed, kind, 9, &b->voxels);
    lsm_lattice_build(&b->voxels, &b->lattice);
    lsm_interior_build(&b->lattice, w, &b->interior);
    size_t n = (size_t)b->lattice.count;
    int planes = b->lattice.size[2];
    b->slot = sm_alloc(n, sizeof *b->slot);
    b->layer_plane = sm_alloc((size_t)planes + 1, sizeof *b->layer_plane);
    b->centre = sm_alloc(n, sizeof *b->centre);
    b->rows = sm_alloc(n, sizeof *b->rows);
    b->region_plane = sm_alloc(n, sizeof *b->region_plane);
    b->bar = sm_alloc(1, sizeof *b->bar);
    b->plate = sm_alloc(1, sizeof *b->plate);
    b->region = sm_alloc(1, sizeof *b->region);
    for (int z = 0; z < planes; z = b->layer_plane[b->layers]) {
        z += 1 + random_int(seed, 4);
        b->layer_plane[++b->layers] = z < planes ? z : planes;
    }
    for (long p = 0, slot = 0; p < b->lattice.count; p++, slot++) {
        slot += random_int(seed, 2);
        b->slot[p] = (int)slot;
        if (p && random_unit(seed) >= share) continue;
        lsm_region_rows(&b->lattice, &b->interior, p, b->rows[b->regions]);
        b->region_plane[b->regions] = b->lattice.coord[p][2];
        b->centre[b->regions++] = p;
    }
    build_lists(b);
}

static void listed_free(Listed *b)
{
    lsm_lists_free(&b->lists);
    lsm_interior_free(&b->interior);
    lsm_lattice_free(&b->lattice);
    sm_voxels_free(&b->voxels);
    sm_free_all(b->slot, b->layer_plane, b->centre, b->rows, b->region_plane);
    sm_free_all(*b->bar, *b->plate, *b->region, b->bar, b->plate, b->region);
}

/* The row is one of the layer of plane z, and in use. */
static void assert_row_of(const Listed *b, int row, const long *plane, const long *end, int z)
{
    int layer = layer_of(b, z), behind = b->layer_plane[layer + 1];
    assert_in_range(row, plane[b->layer_plane[layer]], end[behind] - 1);
    assert_true(end[behind] <= plane[behind]);
}

/* The bar of a region at offsets (b, c) holds the particles `bits`, each at its place. */
static void assert_bar(const Listed *body, const int *bar, const int centre[3], int b, int c,
                       LsmRow bits)
{
    for (int i = 0; i < body->side; i++) {
        long p =
            lsm_lattice_find(&body->lattice, centre[0] + i - body->w, centre[1] + b, centre[2] + c);
        assert_int_equal(bar[i], bits >> i & 1 ? body->slot[p] + 1 : 0);
    }
}

static void assert_region(const Listed *b, long r)
{
    const LsmLists *l = &b->lists;
    const int *at = b->lattice.coord[b->centre[r]];
    for (int c = 0; c < b->side; c++) {
        int plate = (*b->region)[r * b->side + c], z = at[2] + c - b->w;
        if (plate) assert_row_of(b, plate, l->plate_plane, l->plate_end, z);
        for (int i = 0; i < b->side; i++) {
            int bar = (*b->plate)[(long)plate * b->side + i];
            if (bar) assert_row_of(b, bar, l->bar_plane, l->bar_end, z);
            assert_bar(b, *b->bar + (long)bar * b->side, at, i - b->w, c - b->w,
                       b->rows[r][c * b->side + i]);
        }
    }
}

static int row_side; /* of what compare_rows() sorts */
static int compare_rows(const void *a, const void *b)
{
    return memcmp(a, b, (size_t)row_side * sizeof(int));
}

/* Row 0 names nothing, as does every row that nothing names; the others all differ. Returns how
 * many these are. */
static long assert_rows(const int *list, int side, long count, const int *naming, long names)
{
    bool *used = sm_alloc((size_t)count, sizeof *used);
    int *rows = sm_alloc((size_t)(count * side), sizeof *rows);
    long in_use = 0;
    for (long i = 0; i < names; i++) used[naming[i]] = true;
    for (long r = 0; r < count; r++) {
        for (int i = 0; i < side && (r == 0 || !used[r]); i++)
            assert_int_equal(list[r * side + i], 0);
        if (r && used[r])
            memcpy(rows + in_use++ * side, list + r * side, (size_t)side * sizeof *rows);
    }
    row_side = side;
    qsort(rows, (size_t)in_use, (size_t)side * sizeof *rows, compare_rows);
    for (long r = 1; r < in_use; r++)
        assert_true(compare_rows(rows + (r - 1) * side, rows + r * side) < 0);
    sm_free_all(used, rows);
    return in_use;
}

/* Returns how many bars and plates are in use. */
static long assert_lists(const Listed *b)
{
    const LsmLists *l = &b->lists;
    number_lists(b);
    for (long r = 0; r < b->regions; r++) assert_region(b, r);
    return assert_rows(*b->bar, b->side, l->bar_count, *b->plate, l->plate_count * b->side) +
           assert_rows(*b->plate, b->side, l->plate_count, *b->region, b->regions * b->side);
}

TEST(lists_name_the_members_of_regions_once)
{
    unsigned seed = 1;
    for (int trial = 0; trial < 48; trial++) {
        Listed b;
        listed_open(&seed, trial % 6, 1 + trial / 6 % 4, trial % 5 ? 1 : 0.4, &b);
        for (int placed = 0; placed < 3; placed++) {
            /* built without spare rows: all are in use but row 0 */
            assert_int_equal(assert_lists(&b), b.lists.bar_count + b.lists.plate_count - 2);
            place_lists(&seed, &b);
        }
        listed_free(&b);
    }
}

/* What region r is to list from now on: its members, or some of them, or of all that its window
 * holds; some regions lose them all. */
static void choose_rows(unsigned *seed, const Listed *b, long r, LsmRow *rows)
{
    const int *at = b->lattice.coord[b->centre[r]];
    int way = random_int(seed, 8), row = random_int(seed, b->side * b->side);
    if (way < 6) lsm_region_rows(&b->lattice, &b->interior, b->centre[r], rows);
    for (int i = 0; i < b->side * b->side; i++) {
        LsmRow any = (LsmRow)(unsigned)rand_r(seed) << 40 ^ (unsigned)rand_r(seed);
        if (way == 6)
            rows[i] =
                any & lsm_window(&b->lattice, b->lattice.bits, at[0], at[1] + i % b->side - b->w,
                                 at[2] + i / b->side - b->w, b->w);
        if ((way < 4 && i == row) || (way == 4 && i > row)) rows[i] &= any;
        if (way == 7) rows[i] = 0;
    }
}

/* Every row counts the names of it, and a row without any is in its layer's list of free ones. */
static void assert_store(const Listed *b, const LsmRowStore *store, const int *naming, long names)
{
    int *uses = sm_alloc((size_t)store->limit[b->lists.planes], sizeof *uses);
    for (long i = 0; i < names; i++) uses[naming[i]]++;
    for (int l = 0; l < b->layers; l++) {
        long first = store->limit[b->layer_plane[l]], unused = 0;
        int behind = b->layer_plane[l + 1];
        for (long r = first; r < store->end[behind]; r++) {
            assert_int_equal(store->uses[r], uses[r]);
            unused += !uses[r];
        }
        for (int r = store->free_row[l]; r; r = store->next[r], unused--)
            assert_true(r >= first && r < store->end[behind] && !uses[r]);
        assert_int_equal(unused, 0);
    }
    free(uses);
}

static void assert_allocator(const Listed *b)
{
    const LsmLists *l = &b->lists;
    assert_lists(b);
    assert_store(b, &b->allocator.bars, *b->plate, l->plate_count * b->side);
    assert_store(b, &b->allocator.plates, *b->region, b->regions * b->side);
}

/* Is some layer out of rows of a kind? */
static bool some_layer_is_full(const Listed *b, const LsmRowStore *store)
{
    for (int l = 0; l < b->layers; l++) {
        int behind = b->layer_plane[l + 1];
        if (store->end[behind] == store->limit[behind] && !store->free_row[l]) return true;
    }
    return false;
}

static void open_allocator(unsigned *seed, Listed *b, long spare)
{
    long bars = b->lists.bar_count, plates = b->lists.plate_count;
    lsm_allocator_make_room(&b->lists, b->layers, b->layer_plane, spare);
    place_lists(seed, b);
    lsm_allocator_open(&b->lists, b->layers, b->layer_plane, b->region_plane, &b->allocator);
    assert_true(b->lists.bar_count >= bars + b->layers * spare);
    assert_true(b->lists.plate_count >= plates + b->layers * spare);
    assert_allocator(b);
}

/* As many changes one after the other; where a layer is full the lists are built anew. Returns how
 * often. */
static int change_lists(unsigned *seed, Listed *b, int changes, long spare)
{
    int rebuilt = 0;
    open_allocator(seed, b, spare);
    for (int i = 0; i < changes; i++) {
        long r = random_int(seed, (int)b->regions);
        choose_rows(seed, b, r, b->rows[r]);
        if (!lsm_allocator_revise(&b->allocator, &b->lists, &b->lattice, b->slot, b->centre[r], r,
                                  b->rows[r])) {
            assert_true(some_layer_is_full(b, &b->allocator.bars) ||
                        some_layer_is_full(b, &b->allocator.plates));
            lsm_allocator_free(&b->allocator);
            lsm_lists_free(&b->lists);
            build_lists(b);
            open_allocator(seed, b, spare);
            rebuilt++;
        }
        if (i % 8 == 0) assert_allocator(b);
    }
    assert_allocator(b);
    return rebuilt;
}

TEST(lists_that_change_name_what_they_should)
{
    unsigned seed = 2;
    int rebuilt = 0;
    for (int trial = 0; trial < 36; trial++) {
        Listed b;
        listed_open(&seed, trial % 6, 1 + trial / 6 % 3, trial % 5 ? 1 : 0.4, &b);
        rebuilt += change_lists(&seed, &b, 100, trial % 4 * 8);
        /* when all list what they first did, no more rows are in use than then */
        for (long r = 0; r < b.regions; r++) {
            lsm_region_rows(&b.lattice, &b.interior, b.centre[r], b.rows[r]);
            if (!lsm_allocator_revise(&b.allocator, &b.lists, &b.lattice, b.slot, b.centre[r], r,
                                      b.rows[r]))
                break;
            if (r + 1 < b.regions) continue;
            long in_use = assert_lists(&b);
            lsm_lists_free(&b.lists);
            build_lists(&b);
            assert_int_equal(in_use, assert_lists(&b));
        }
        lsm_allocator_free(&b.allocator);
        listed_free(&b);
    }
    assert_in_range(rebuilt, 20, 1000);
}

/* The sum of a row's members, and their moment about its centre. */
static void sum_list(const int *list, int side, const int *value, long *sum, long *moment)
{
    *sum = *moment = 0;
    for (int i = 0; i < side; i++) {
        *sum += value[list[i]];
        *moment += (i - side / 2) * (long)value[list[i]];
    }
}

/* Of one kind of rows: their lists, which count from row 0 and name some of `members` by number;
 * the shifts of both. */
typedef struct {
    const int *list;
    int side, planes;
    long rows, count, members; /* count: rows that are made */
    const int *shift, *member;
    bool along_z;
} Kind;

/* What `row` of plane z says of a member's place and name: its value. */
static long value_at(const Kind *kind, const int *value, int z, int place, int name)
{
    int plane = kind->along_z ? z + place - kind->side / 2 - 1 : z;
    return name ? value[lsm_named(kind->member, plane, name)] : 0;
}

/* A record sums what its row's list does, if its base, of the same layer and fewer than
 * LSM_RUN_MOST rows down, does. */
static void assert_record(const Kind *kind, int z, LsmGroup group, const int *record,
                          const int *value, int *length)
{
    long sum = 0, moment = 0, want, want_moment, r = lsm_named(kind->shift, z, record[0]);
    int w = kind->side / 2, moved = group.way == LSM_MOVED || record[1] % LSM_NAME;
    if (group.way != LSM_LISTED) {
        long base = lsm_named(kind->shift, z, record[1]);
        assert_true(record[1] >= LSM_NAME && length[base] > 0);
        length[r] = length[base] + 1;
        sum_list(kind->list + base * kind->side, kind->side, value, &sum, &moment);
        moment -= moved * sum;
    } else {
        length[r] = 1;
    }
    int members = group.way == LSM_LISTED  ? group.times
                  : group.way == LSM_MOVED ? 2
                                           : 4 * group.times;
    for (int i = 0; i < members; i++) {
        const int *name = record + 2 + (group.way == LSM_CHANGED ? i / 4 * LSM_CHANGES + i % 4 : i);
        int place = group.way == LSM_LISTED ? record[1] + i
                    : group.way == LSM_MOVED
                        ? (i ? 0 : kind->side)
                        : record[2 + i / 4 * LSM_CHANGES + 4] >> i % 4 * 8 & 255;
        long sign = group.way != LSM_LISTED && i % 2 ? -1 : 1,
             own = sign * value_at(kind, value, z, place, *name);
        sum += own;
        moment += (place - w - 1) * own;
    }
    sum_list(kind->list + r * kind->side, kind->side, value, &want, &want_moment);
    assert_int_equal(sum, want);
    assert_int_equal(moment, want_moment);
    assert_true(length[r] <= LSM_RUN_MOST);
}

/* Every row is made once; returns how many have a base. */
static long assert_running(unsigned *seed, const LsmRunningList *running, const Kind *kind)
{
    long based = 0, made = 0;
    int *value = sm_alloc((size_t)kind->members, sizeof *value);
    int *length = sm_alloc((size_t)kind->rows, sizeof *length);
    for (long i = 1; i < kind->members; i++) value[i] = random_int(seed, 2001) - 1000;
    for (int z = 0; z < kind->planes; z++)
        for (long g = running->plane[z]; g < running->plane[z + 1]; g++) {
            LsmGroup group = running->group[g];
            int width = lsm_record_width(group.way, group.times);
            for (long i = 0; i < group.count; i++, made++)
                assert_record(kind, z, group, running->record + group.first + i * width, value,
                              length);
            based += group.way == LSM_LISTED ? 0 : group.count;
        }
    assert_int_equal(made, kind->count);
    sm_free_all(value, length);
    return based;
}

/* Of regions: their rows are 1 + slots, shifted by `slots`. */
static long assert_running_regions(unsigned *seed, const Listed *b, const LsmRunningList *running,
                                   const int *slots)
{
    const LsmLists *l = &b->lists;
    long rows = b->slot[b->lattice.count - 1] + 2;
    int *list = sm_alloc((size_t)(rows * b->side), sizeof *list);
    for (long p = 0; p < l->region_count; p++)
        memcpy(list + (b->slot[p] + 1) * b->side, *b->region + p * b->side,
               (size_t)b->side * sizeof *list);
    Kind region = {list,           b->side, l->planes,      rows, l->region_count,
                   l->plate_count, slots,   l->plate_shift, true};
    long based = assert_running(seed, running, &region);
    free(list);
    return based;
}

TEST(running_lists_sum_what_lists_do)
{
    unsigned seed = 3;
    long rows = 0, based = 0;
    for (int trial = 0; trial < 35; trial++) {
        Listed b;
        LsmRunningLists running;
        listed_open(&seed, trial % 7, 2 + trial / 7, 1, &b);
        if (trial % 3) place_lists(&seed, &b);
        number_lists(&b);
        const LsmLists *l = &b.lists;
        int *slots = sm_copy(l->slot_shift, (size_t)l->planes, sizeof *slots);
        for (int z = 0; z < l->planes; z++) slots[z]--;
        lsm_running_lists_build(&b.lattice, b.slot, l, b.layers, b.layer_plane, &running);
        long members = b.slot[b.lattice.count - 1] + 2;
        Kind bar = {*b.bar,  b.side,       l->planes, l->bar_count, l->bar_count - 1,
                    members, l->bar_shift, slots,     false},
             plate = {
                 *b.plate,     b.side,         l->planes,    l->plate_count, l->plate_count - 1,
                 l->bar_count, l->plate_shift, l->bar_shift, false};
        based += assert_running(&seed, &running.bar, &bar) +
                 assert_running(&seed, &running.plate, &plate) +
                 assert_running_regions(&seed, &b, &running.region, slots);
        rows += l->bar_count + l->plate_count + l->region_count;
        lsm_running_lists_free(&running);
        free(slots);
        listed_free(&b);
    }
    assert_true(2 * based > rows);
}
