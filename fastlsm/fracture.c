#include "fracture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build.h"
#include "sums/blocks.h"

static real component(const Lsm *lsm, long slot, int d)
{
    return lsm->x[(slot / SM_LANES * 3 + d) * SM_LANES + slot % SM_LANES];
}

static bool too_long(const Lsm *lsm, long p, long q)
{
    double square = 0, rest = 0;
    for (int d = 0; d < 3; d++) {
        double stretch =
            (double)component(lsm, lsm->slot[p], d) - (double)component(lsm, lsm->slot[q], d);
        int cells = lsm->lattice.coord[p][d] - lsm->lattice.coord[q][d];
        square += stretch * stretch;
        rest += cells * cells;
    }
    return square > lsm->params.strain_limit * lsm->params.strain_limit * rest;
}

/* Particles, each once. */
typedef struct {
    int *particle;
    long count, room;
} List;

/* What a break changes. Marks tell who is in which list. */
enum { NEAR = 1, TOUCHED = 2 };
typedef struct {
    Lsm *lsm;
    List near;    /* regions that may have lost members */
    List changed; /* regions that have */
    List touched; /* regions that hold the centre of a changed one: m~ changed */
    int *member;  /* [side^3] */
    LsmRow *rows;
} Change;

static void append(List *list, long p)
{
    if (list->count == list->room) {
        list->room = 2 * list->room + 64;
        list->particle = sm_realloc(list->particle, (size_t)list->room, sizeof(int));
    }
    list->particle[list->count++] = (int)p;
}

static void append_once(Change *change, List *list, char mark, long p)
{
    if (change->lsm->mark[p] & mark) return;
    change->lsm->mark[p] |= mark;
    append(list, p);
}

static void clear_bit(const LsmLattice *l, uint64_t *bitmap, int x, int y, int z)
{
    size_t row = (size_t)z * (size_t)l->size[1] + (size_t)y;
    bitmap[row * (size_t)l->words + (size_t)(x >> 6)] &= ~((uint64_t)1 << (x & 63));
}

/* An end of a broken link: no region within w - 1 steps is a whole cube any more, and only those
 * can have lost members, because a path of w steps comes to its first broken link after w - 1. */
static void note_end(Change *change, long p)
{
    const LsmLattice *l = &change->lsm->lattice;
    LsmInterior *interior = &change->lsm->interior;
    int low[3], high[3], reach = change->lsm->w - 1;
    for (int d = 0; d < 3; d++) {
        low[d] = l->coord[p][d] > reach ? l->coord[p][d] - reach : 0;
        high[d] = l->coord[p][d] + reach < l->size[d] ? l->coord[p][d] + reach : l->size[d] - 1;
    }
    clear_bit(l, interior->complete, l->coord[p][0], l->coord[p][1], l->coord[p][2]);
    for (int z = low[2]; z <= high[2]; z++)
        for (int y = low[1]; y <= high[1]; y++)
            for (int x = low[0]; x <= high[0]; x++) {
                long near = lsm_lattice_find(l, x, y, z);
                clear_bit(l, interior->interior, x, y, z);
                if (near >= 0) append_once(change, &change->near, NEAR, near);
            }
}

/* The particles of p's region, from its rows; returns how many. */
static int list_members(const Lsm *lsm, long p, const LsmRow *rows, int *member)
{
    const int *c = lsm->lattice.coord[p];
    int count = 0, w = lsm->w, side = lsm->side;
    for (int row = 0; row < side * side; row++)
        for (LsmRow rest = rows[row]; rest; rest &= rest - 1)
            member[count++] = (int)lsm_lattice_find(&lsm->lattice, c[0] - w + lsm_row_first(rest),
                                                    c[1] - w + row % side, c[2] - w + row / side);
    return count;
}

/* Makes room for one more region that has lists: block form only. */
static int add_region(Lsm *lsm)
{
    LsmLists *lists = &lsm->lists;
    long region = lists->region_count++;
    if (lists->region_count > lists->region_room) {
        lists->region_room = 2 * lists->region_count + 64;
        lists->region =
            sm_realloc(lists->region, (size_t)(lists->region_room * lists->side), sizeof(int));
    }
    memset(lists->region + region * lists->side, 0, (size_t)lists->side * sizeof(int));
    return (int)region;
}

/* Lists for the region of p that has changed, where it has or now needs them. False: no room. */
static bool revise_lists(Lsm *lsm, long p, const LsmRow *rows, int count, const int *member)
{
    int slot = lsm->slot[p], *region = &lsm->block_region[slot];
    if (*region < 0) {
        if (lsm_blocks_regular(lsm, p, rows)) return true;
        *region = add_region(lsm);
        lsm->box->mixed[slot / SM_LANES] = true;
    }
    for (int i = 0; i < count && lsm->box; i++) lsm->listed[lsm->slot[member[i]] / SM_LANES] = true;
    return lsm_allocator_revise(lsm->allocator, &lsm->lists, &lsm->lattice, lsm->slot, p, *region,
                                rows);
}

/* A record of its own for what shared one; returns the records, which may have moved. */
static void *own_record(void *records, size_t size, Records *held, int *index)
{
    if (*index >= held->shared) return records;
    if (held->count == held->room) {
        held->room = held->room + held->room / 2 + 16;
        void *grown = sm_alloc((size_t)held->room, size);
        memcpy(grown, records, (size_t)held->count * size);
        free(records);
        records = grown;
    }
    memcpy((char *)records + (size_t)held->count * size, (char *)records + (size_t)*index * size,
           size);
    *index = (int)held->count++;
    return records;
}

/* m~_i and 1 / |R_i|. */
static void revise_particle(Lsm *lsm, long p)
{
    long block = lsm->slot[p] / SM_LANES;
    int lane = lsm->slot[p] % SM_LANES;
    lsm->particle_const = own_record(lsm->particle_const, sizeof(ParticleConst),
                                     &lsm->particle_records, &lsm->block_const[block]);
    ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
    k->weight[lane] = (real)(mass_of(lsm, p) / lsm->members[p]);
    k->inverse_count[lane] = (real)(1.0 / lsm->members[p]);
}

/* 1 / M_r and c0_r - x0_r, from the m~ that the engine sums. */
static void revise_region(Lsm *lsm, long r, const int *member)
{
    long tile = lsm->slot[r] / SM_LANES;
    int lane = lsm->slot[r] % SM_LANES;
    double mass = 0, moment[3] = {0, 0, 0};
    for (int i = 0; i < lsm->members[r]; i++) {
        int slot = lsm->slot[member[i]];
        double weight =
            (double)lsm->particle_const[lsm->block_const[slot / SM_LANES]].weight[slot % SM_LANES];
        mass += weight;
        for (int d = 0; d < 3; d++)
            moment[d] += weight * (lsm->lattice.coord[member[i]][d] - lsm->lattice.coord[r][d]);
    }
    lsm->region_const = own_record(lsm->region_const, sizeof(RegionConst), &lsm->region_records,
                                   &lsm->tile_const[tile]);
    RegionConst *k = &lsm->region_const[lsm->tile_const[tile]];
    double inverse = mass > 0 ? 1 / mass : 0;
    k->inverse_mass[lane] = (real)inverse;
    for (int d = 0; d < 3; d++) k->offset[d][lane] = (real)(moment[d] * inverse);
}

/* Regions, members and lists of the particles near; false when there is no room for the lists. */
static bool revise_near(Change *change)
{
    Lsm *lsm = change->lsm;
    for (long i = 0; i < change->near.count; i++) {
        long p = change->near.particle[i];
        int count = lsm_region_rows(&lsm->lattice, &lsm->interior, p, change->rows);
        if (count == lsm->members[p]) continue; /* regions only ever lose members */
        lsm->members[p] = count;
        append(&change->changed, p);
        list_members(lsm, p, change->rows, change->member);
        for (int k = 0; k < count; k++)
            append_once(change, &change->touched, TOUCHED, change->member[k]);
        if (!revise_lists(lsm, p, change->rows, count, change->member)) return false;
    }
    return true;
}

static void revise_constants(Change *change)
{
    Lsm *lsm = change->lsm;
    for (long i = 0; i < change->changed.count; i++)
        revise_particle(lsm, change->changed.particle[i]);
    for (long i = 0; i < change->touched.count; i++) {
        long r = change->touched.particle[i];
        lsm_region_rows(&lsm->lattice, &lsm->interior, r, change->rows);
        list_members(lsm, r, change->rows, change->member);
        revise_region(lsm, r, change->member);
    }
    if (change->changed.count) lsm->unique = -1;
}

static void break_links(Change *change, long count, const LsmLink *link)
{
    LsmLattice *l = &change->lsm->lattice;
    for (long i = 0; i < count; i++) {
        long p = link[i].particle;
        int bit = link[i].bit;
        const int *c = l->coord[p];
        if (!(l->link[p] >> bit & 1)) continue; /* broken before */
        lsm_lattice_break(l, p, bit);
        change->lsm->broken++;
        note_end(change, p);
        note_end(change, lsm_lattice_find(l, c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1,
                                          c[2] + bit / 9 - 1));
    }
}

long lsm_break(Lsm *lsm, long count, const LsmLink *link)
{
    size_t side = (size_t)lsm->side;
    Change change = {.lsm = lsm,
                     .member = sm_alloc(side * side * side, sizeof(int)),
                     .rows = sm_alloc(side * side, sizeof(LsmRow))};
    break_links(&change, count, link);
    long work = lsm->lattice.count;
    if (revise_near(&change)) {
        revise_constants(&change);
        work = change.near.count + change.touched.count;
    } else {
        lsm->spare *= 2;
        lsm_rebuild_regions(lsm);
    }
    for (long i = 0; i < change.near.count; i++) lsm->mark[change.near.particle[i]] = 0;
    for (long i = 0; i < change.touched.count; i++) lsm->mark[change.touched.particle[i]] = 0;
    free(change.near.particle);
    free(change.changed.particle);
    free(change.touched.particle);
    free(change.member);
    free(change.rows);
    return work;
}

/* Links to be broken. */
typedef struct {
    LsmLink *link;
    long count, room;
} Links;

static void add_link(Links *links, long p, int bit)
{
    if (links->count == links->room) {
        links->room = 2 * links->room + 64;
        links->link = sm_realloc(links->link, (size_t)links->room, sizeof *links->link);
    }
    links->link[links->count++] = (LsmLink){(int)p, bit};
}

void lsm_fracture(Lsm *lsm)
{
    const LsmLattice *l = &lsm->lattice;
    Links links = {0};
    for (long p = 0; p < l->count; p++)
        for (uint32_t rest = l->link[p] >> (LSM_SELF + 1) << (LSM_SELF + 1); rest;
             rest &= rest - 1) {
            int bit = __builtin_ctz(rest);
            const int *c = l->coord[p];
            long q =
                lsm_lattice_find(l, c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1);
            if (too_long(lsm, p, q)) add_link(&links, p, bit);
        }
    if (links.count) lsm_break(lsm, links.count, links.link);
    free(links.link);
}

/* A place in lattice cells, as it is in the cut's axes. */
static void place_in(const Lsm *lsm, int turn, const int coord[3], double place[3])
{
    const LsmLattice *l = &lsm->lattice;
    for (int d = 0; d < 3; d++) place[(d + turn) % 3] = l->origin[d] + l->cell * coord[d];
}

/* The links of particle p to later ones, where they cross the cut. */
static void cut_links(const Lsm *lsm, int turn, const SmCut *cut, long first, long p, Links *links)
{
    const LsmLattice *l = &lsm->lattice;
    const int *c = l->coord[p];
    double from[3], to[3];
    place_in(lsm, turn, c, from);
    for (uint32_t rest = l->link[p] >> (LSM_SELF + 1) << (LSM_SELF + 1); rest; rest &= rest - 1) {
        int bit = __builtin_ctz(rest);
        int near[3] = {c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1};
        place_in(lsm, turn, near, to);
        if (sm_cut_crosses(cut, first, from, to)) add_link(links, p, bit);
    }
}

/* The box of lattice sites whose links a triangle can cross. */
static void sites_near(const Lsm *lsm, int turn, const SmCut *cut, long triangle, int low[3],
                       int high[3])
{
    const LsmLattice *l = &lsm->lattice;
    for (int d = 0; d < 3; d++) {
        double least = INFINITY, most = -INFINITY;
        for (int i = 0; i < 3; i++) {
            double at = cut->vertex[cut->triangle[triangle][i]][(d + turn) % 3];
            least = fmin(least, (at - l->origin[d]) / l->cell);
            most = fmax(most, (at - l->origin[d]) / l->cell);
        }
        low[d] = (int)fmin(fmax(floor(least) - 1, 0), l->size[d]);
        high[d] = (int)fmax(fmin(ceil(most) + 1, l->size[d] - 1), -1);
    }
}

/* Every particle near is looked at once: the marks are those of lsm_break(). */
long lsm_cut(Lsm *lsm, int turn, const SmCut *cut, long first)
{
    List seen = {0};
    Links links = {0};
    long before = lsm->broken;
    for (long t = first; t < cut->triangles; t++) {
        int low[3], high[3];
        sites_near(lsm, turn, cut, t, low, high);
        for (int z = low[2]; z <= high[2]; z++)
            for (int y = low[1]; y <= high[1]; y++)
                for (int x = low[0]; x <= high[0]; x++) {
                    long p = lsm_lattice_find(&lsm->lattice, x, y, z);
                    if (p < 0 || lsm->mark[p]) continue;
                    lsm->mark[p] = NEAR;
                    append(&seen, p);
                    cut_links(lsm, turn, cut, first, p, &links);
                }
    }
    for (long i = 0; i < seen.count; i++) lsm->mark[seen.particle[i]] = 0;
    if (links.count) lsm_break(lsm, links.count, links.link);
    free(seen.particle);
    free(links.link);
    return lsm->broken - before;
}
