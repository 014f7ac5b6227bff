#include "running_lists.h"

#include <stdlib.h>
#include <string.h>

/* One kind of rows while its bases are chosen. */
typedef struct {
    const int *list; /* from row `start` on */
    int side, start;
    long rows;
    const int *number; /* [rows] rows are known by; NULL: themselves */
    const int *shift;  /* of that number (subsum_lists.h) .. */
    const int *member; /* .. and of its members' */
    bool along_z;      /* members are of the planes of their places */
    char *depth;       /* [rows] rows of the running up to this one; 0: not met yet */
    char *way, *times; /* [rows] as in LsmGroup */
    int *base;         /* [rows] 2 * its base, + 1 where that lies one place back; 0: none */
} Kind;

typedef struct {
    const LsmLattice *lattice;
    int *layer; /* [planes] */
    Kind bar, plate, region;
} Builder;

static const int *row_of(const Kind *kind, long r)
{
    return kind->list + (r - kind->start) * kind->side;
}

/* The members that a row has beyond its base, and those it lacks, with their places. Above MOST of
 * either are only counted. */
enum { MOST = 8 };
typedef struct {
    int count, name[MOST], place[MOST];
} Members;
typedef struct {
    Members enter, leave;
} Change;

static void add_member(Members *members, int name, int place)
{
    if (!name) return;
    if (members->count < MOST) {
        members->name[members->count] = name;
        members->place[members->count] = place;
    }
    members->count++;
}

/* From a base that lies `moved` places back. */
static Change change_of(const Kind *kind, long r, long base, int moved)
{
    const int *row = row_of(kind, r), *from = row_of(kind, base);
    Change change = {0};
    if (moved) add_member(&change.leave, from[0], 0);
    for (int i = 0; i < kind->side; i++) {
        int before = i + moved < kind->side ? from[i + moved] : 0;
        if (row[i] == before) continue;
        add_member(&change.enter, row[i], i + 1);
        add_member(&change.leave, before, i + 1);
    }
    return change;
}

/* Whether a row is made as LSM_MOVED, from a base one place back. */
static bool is_moved(const Change *change, int side)
{
    const Members *enter = &change->enter, *leave = &change->leave;
    return enter->count <= 1 && leave->count <= 1 && (!enter->count || enter->place[0] == side) &&
           (!leave->count || !leave->place[0]);
}

/* What a row takes to make, about: the members that are read. */
static int cost_of(LsmWay way, int times)
{
    const int cost[] = {2, 1 + 4 * times, times};
    return cost[way];
}

/* Makes `candidate` (2 * row + moved; row 0: none) the base of row r where that saves time. */
static void offer(const Kind *kind, long r, long candidate)
{
    long base = candidate / 2;
    int moved = (int)(candidate % 2);
    if (!base || !kind->depth[base] || kind->depth[base] >= LSM_RUN_MOST) return;
    Change change = change_of(kind, r, base, moved);
    int most = change.enter.count > change.leave.count ? change.enter.count : change.leave.count;
    int times = most > 2 ? (most + 1) / 2 : 1;
    LsmWay way = moved && is_moved(&change, kind->side) ? LSM_MOVED : LSM_CHANGED;
    if (most > MOST || cost_of(way, times) >= cost_of((LsmWay)kind->way[r], kind->times[r])) return;
    kind->way[r] = (char)way;
    kind->times[r] = (char)times;
    kind->base[r] = (int)candidate;
    kind->depth[r] = (char)(kind->depth[base] + 1);
}

/* The places from the first to the last with a member. */
static void find_span(const Kind *kind, long r, int *first, int *count)
{
    const int *row = row_of(kind, r);
    int last = kind->side - 1;
    *first = 0;
    while (*first < last && !row[*first]) ++*first;
    while (last > *first && !row[last]) last--;
    *count = last - *first + 1;
}

/* A row met for the first time: as yet listed. */
static void meet(const Kind *kind, long r)
{
    int first, count;
    find_span(kind, r, &first, &count);
    kind->depth[r] = 1;
    kind->way[r] = LSM_LISTED;
    kind->times[r] = (char)count;
}

/* The number of the member at place i of row r, of plane z; 0 where there is none. */
static int member(const Kind *kind, long r, int i, int z)
{
    return r == 0 || i >= kind->side ? 0 : lsm_named(kind->member, z, row_of(kind, r)[i]);
}

/* Bases of the bars of a plate, from the same plates of the regions one step back along x, y, z. */
static void choose_bars(const Builder *b, int plate, int x, int y, int beside_z, int z)
{
    for (int i = 0; i < b->bar.side; i++) {
        int r = member(&b->plate, plate, i, z);
        if (!r || b->bar.depth[r]) continue;
        long back_x = member(&b->plate, x, i, z), along_y = member(&b->plate, y, i + 1, z),
             along_z = member(&b->plate, beside_z, i, z);
        meet(&b->bar, r);
        offer(&b->bar, r, 2 * back_x + 1);
        if (along_y != r) offer(&b->bar, r, 2 * along_y);
        if (along_z != r) offer(&b->bar, r, 2 * along_z);
    }
}

/* Region row of the particle beside; 0 where there is none. */
static long beside(const Builder *b, const int at[3], int axis)
{
    int c[3] = {at[0], at[1], at[2]};
    c[axis]--;
    return lsm_lattice_find(b->lattice, c[0], c[1], c[2]) + 1;
}

/* Bases of what particle p's region is the first to use. */
static void choose(const Builder *b, long p)
{
    const int *at = b->lattice->coord[p];
    long x = beside(b, at, 0), y = beside(b, at, 1), z = beside(b, at, 2);
    for (int c = 0; c < b->plate.side; c++) {
        int plane = at[2] + c - b->plate.side / 2, r = member(&b->region, p + 1, c, plane),
            back_y = member(&b->region, y, c, plane),
            beside_z = member(&b->region, z, c + 1, plane);
        if (!r || b->plate.depth[r]) continue;
        meet(&b->plate, r);
        choose_bars(b, r, member(&b->region, x, c, plane), back_y, beside_z, plane);
        offer(&b->plate, r, 2L * back_y + 1);
        if (beside_z != r) offer(&b->plate, r, 2L * beside_z);
    }
    meet(&b->region, p + 1);
    if (z && b->layer[at[2] - 1] == b->layer[at[2]]) offer(&b->region, p + 1, 2 * z + 1);
}

static void open_kind(Kind *kind, const int *list, int side, int start, long rows)
{
    *kind = (Kind){.list = list, .side = side, .start = start, .rows = rows};
    kind->depth = sm_alloc((size_t)rows, 1);
    kind->way = sm_alloc((size_t)rows, 1);
    kind->times = sm_alloc((size_t)rows, 1);
    kind->base = sm_alloc((size_t)rows, sizeof(int));
}

static int row_name(const Kind *kind, int z, long r)
{
    return lsm_name(kind->shift, z, kind->number ? kind->number[r - 1] : r);
}

/* Members t and t + 1 of either kind. */
static void write_changes(const Change *change, int t, int *record)
{
    uint32_t places = 0;
    for (int i = 0; i < 4; i++) {
        const Members *of = i % 2 ? &change->leave : &change->enter;
        int at = t + i / 2;
        record[i] = of->name[at];
        places |= (uint32_t)of->place[at] << 8 * i;
    }
    memcpy(record + 4, &places, sizeof places);
}

static void write_listed(const Kind *kind, long r, int *record)
{
    int first, count;
    find_span(kind, r, &first, &count);
    record[1] = first + 1;
    memcpy(record + 2, row_of(kind, r) + first, (size_t)count * sizeof *record);
}

static void write_record(const Kind *kind, int z, long r, int *record)
{
    record[0] = row_name(kind, z, r);
    if (kind->way[r] == LSM_LISTED) {
        write_listed(kind, r, record);
        return;
    }
    long base = kind->base[r] / 2;
    int moved = kind->base[r] % 2;
    Change change = change_of(kind, r, base, moved);
    record[1] = row_name(kind, z, base);
    if (kind->way[r] == LSM_MOVED) {
        record[2] = change.enter.name[0];
        record[3] = change.leave.name[0];
        return;
    }
    record[1] += moved;
    for (int t = 0; t < kind->times[r]; t++)
        write_changes(&change, 2 * t, record + 2 + LSM_CHANGES * t);
}

/* Groups of a plane in their order: listed rows, by their members; then, as far down a run, those
 * that are moved and those that are changed. A region's base is of another plane. */
enum {
    BASED = LSM_MAX_SIDE + 1,
    BASED_WAYS = MOST / 2 + 1,
    GROUPS = BASED + (LSM_RUN_MOST + 1) * BASED_WAYS
};

static int group_of(const Kind *kind, long r)
{
    int depth = kind->along_z ? 0 : kind->depth[r];
    if (kind->way[r] == LSM_LISTED) return kind->times[r];
    return BASED + depth * BASED_WAYS + (kind->way[r] == LSM_MOVED ? 0 : kind->times[r]);
}

static void open_group(int number, long rows, LsmRunningList *out)
{
    LsmGroup *group = &out->group[out->groups++];
    int based = (number - BASED) % BASED_WAYS;
    *group = (LsmGroup){LSM_LISTED, number, out->ints, rows};
    if (number >= BASED) group->way = based ? LSM_CHANGED : LSM_MOVED;
    if (number >= BASED) group->times = based;
    out->ints += rows * lsm_record_width(group->way, group->times);
}

/* The groups of plane z, whose rows are `first` .. `last` - 1. */
static void group_rows(const Kind *kind, int z, long first, long last, LsmRunningList *out)
{
    long count[GROUPS] = {0}, at[GROUPS];
    for (long r = first; r < last; r++) count[group_of(kind, r)]++;
    for (int g = 0; g < GROUPS; g++) {
        at[g] = out->ints;
        if (count[g]) open_group(g, count[g], out);
    }
    out->record = sm_realloc(out->record, (size_t)out->ints + 1, sizeof *out->record);
    for (long r = first; r < last; r++) {
        long *to = &at[group_of(kind, r)];
        write_record(kind, z, r, out->record + *to);
        *to += lsm_record_width((LsmWay)kind->way[r], kind->times[r]);
    }
}

/* The records of rows whose bases are chosen; those of plane z are first[z] .. first[z + 1] - 1. */
static void close_kind(Kind *kind, int planes, const long *first, LsmRunningList *out)
{
    *out = (LsmRunningList){.plane = sm_alloc((size_t)planes + 1, sizeof *out->plane),
                            .group = sm_alloc((size_t)planes * GROUPS, sizeof *out->group)};
    for (int z = 0; z < planes; z++) {
        group_rows(kind, z, first[z], first[z + 1], out);
        out->plane[z + 1] = out->groups;
    }
    out->group = sm_realloc(out->group, (size_t)out->groups + 1, sizeof *out->group);
    sm_free_all(kind->depth, kind->way, kind->times, kind->base);
}

void lsm_running_lists_build(const LsmLattice *l, const int *slot, const LsmLists *lists,
                             int layers, const int *layer_plane, LsmRunningLists *running)
{
    Builder b = {.lattice = l};
    int side = lists->side, planes = lists->planes;
    long *region = sm_alloc((size_t)planes + 1, sizeof *region);
    b.layer = sm_alloc((size_t)planes, sizeof(int));
    for (int layer = 0; layer < layers; layer++)
        for (int z = layer_plane[layer]; z < layer_plane[layer + 1]; z++) b.layer[z] = layer;
    open_kind(&b.bar, lists->bar, side, 0, lists->bar_count);
    open_kind(&b.plate, lists->plate, side, 0, lists->plate_count);
    open_kind(&b.region, lists->region, side, 1, lists->region_count + 1);
    b.bar.shift = b.plate.member = lists->bar_shift;
    b.plate.shift = b.region.member = lists->plate_shift;
    b.bar.member = b.region.shift = lists->slot_shift;
    b.region.number = slot;
    b.region.along_z = true;
    for (long p = 0; p < l->count; p++) {
        choose(&b, p);
        region[l->coord[p][2] + 1]++;
    }
    region[0] = 1;
    for (int z = 0; z < planes; z++) region[z + 1] += region[z];
    close_kind(&b.bar, planes, lists->bar_plane, &running->bar);
    close_kind(&b.plate, planes, lists->plate_plane, &running->plate);
    close_kind(&b.region, planes, region, &running->region);
    sm_free_all(b.layer, region);
}

long lsm_running_additions(const LsmRunningList *list)
{
    long count = 0;
    for (long g = 0; g < list->groups; g++) {
        const LsmGroup *group = &list->group[g];
        int width = lsm_record_width(group->way, group->times);
        for (long i = 0; i < group->count * width; i++) {
            int at = (int)(i % width) - 2;
            bool places = group->way == LSM_CHANGED && at % LSM_CHANGES == 4;
            count += at >= 0 && !places && list->record[group->first + i] != 0;
        }
    }
    return count;
}

static void free_list(LsmRunningList *list)
{
    sm_free_all(list->record, list->group, list->plane);
}

void lsm_running_lists_free(LsmRunningLists *running)
{
    free_list(&running->bar);
    free_list(&running->plate);
    free_list(&running->region);
}
