#include "running_lists.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* One kind of rows while its bases are chosen. */
typedef struct {
    const int *list; /* from row `start` on */
    int side, start;
    char *depth; /* [rows] rows of the running up to this one; 0: not met yet */
    LsmRunningList *running;
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

void lsm_running_factors(int w, double factor[LSM_FACTORS][2])
{
    for (int place = 0; place < 2 * w + 2; place++)
        for (int leaves = 0; leaves < 2; leaves++) {
            double sign = leaves ? -1 : 1;
            factor[2 * place + leaves][0] = sign;
            factor[2 * place + leaves][1] = sign * (place - w - 1);
        }
}

static void add_term(LsmTerm *term, int *count, int name, int place, bool leaves)
{
    if (!name) return;
    if (term) term[*count] = (LsmTerm){name / LSM_NAME, 2 * (place + 1) + leaves};
    (*count)++;
}

/* The terms of `row` beside a base (NULL: none) that lies `moved` places back; returns how many.
 * `term` may be NULL. */
static int list_terms(int side, const int *row, const int *base, int moved, LsmTerm *term)
{
    int count = 0;
    assert(row);
    if (base && moved) add_term(term, &count, base[0], -1, true);
    for (int i = 0; i < side; i++) {
        int before = base && i + moved < side ? base[i + moved] : 0;
        if (row[i] == before) continue;
        add_term(term, &count, row[i], i, false);
        add_term(term, &count, before, i, true);
    }
    int even = count ? count + count % 2 : 2;
    for (; term && count < even; count++) term[count] = (LsmTerm){0, 0};
    return even;
}

/* Makes `candidate` (2 * row + moved; row 0: none) the base of row r where that saves terms. */
static void offer(const Kind *kind, long r, long candidate, int *terms)
{
    long b = candidate / 2;
    if (b == 0 || b >= r || !kind->depth[b] || kind->depth[b] >= LSM_RUN_MOST) return;
    int count =
        list_terms(kind->side, row_of(kind, r), row_of(kind, b), (int)(candidate % 2), NULL);
    if (count >= *terms) return;
    *terms = count;
    kind->running->base[r] = (int)candidate;
    kind->depth[r] = (char)(kind->depth[b] + 1);
}

/* A row met for the first time: as yet listed in full. Returns its terms. */
static int meet(const Kind *kind, long r)
{
    kind->depth[r] = 1;
    return list_terms(kind->side, row_of(kind, r), NULL, 0, NULL);
}

/* The number of the member at place i of row r; 0 where there is none. */
static int member(const Kind *kind, long r, int i)
{
    return r == 0 || i >= kind->side ? 0 : row_of(kind, r)[i] / LSM_NAME;
}

/* Bases of the bars of a plate, from the same plates of the regions one step back along x, y, z. */
static void choose_bars(const Builder *b, int plate, int x, int y, int z)
{
    for (int i = 0; i < b->bar.side; i++) {
        int r = member(&b->plate, plate, i);
        if (!r || b->bar.depth[r]) continue;
        int terms = meet(&b->bar, r);
        offer(&b->bar, r, 2L * member(&b->plate, x, i) + 1, &terms);
        offer(&b->bar, r, 2L * member(&b->plate, y, i + 1), &terms);
        offer(&b->bar, r, 2L * member(&b->plate, z, i), &terms);
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
        int r = member(&b->region, p + 1, c), back_y = member(&b->region, y, c),
            back_z = member(&b->region, z, c + 1);
        if (!r || b->plate.depth[r]) continue;
        choose_bars(b, r, member(&b->region, x, c), back_y, back_z);
        int terms = meet(&b->plate, r);
        offer(&b->plate, r, 2L * back_y + 1, &terms);
        offer(&b->plate, r, 2L * back_z, &terms);
    }
    int terms = meet(&b->region, p + 1);
    if (z && b->layer[at[2] - 1] == b->layer[at[2]]) offer(&b->region, p + 1, 2 * z + 1, &terms);
}

static void open_kind(Kind *kind, const int *list, int side, int start, long rows,
                      LsmRunningList *running)
{
    *kind = (Kind){.list = list, .side = side, .start = start, .running = running};
    kind->depth = sm_alloc((size_t)rows, 1);
    running->rows = rows;
    running->base = sm_alloc((size_t)rows, sizeof(int));
    running->first = sm_alloc((size_t)rows + 1, sizeof(int));
}

/* Terms of every row beside the base chosen for it: counted, then listed. */
static void close_kind(Kind *kind)
{
    LsmRunningList *running = kind->running;
    for (int pass = 0; pass < 2; pass++) {
        int at = 0;
        for (long r = 1; r < running->rows; r++) {
            long base = running->base[r] / 2;
            running->first[r] = at;
            at += list_terms(kind->side, row_of(kind, r), base ? row_of(kind, base) : NULL,
                             running->base[r] % 2, pass ? running->term + at : NULL);
        }
        running->first[running->rows] = at;
        if (!pass) running->term = sm_alloc((size_t)at, sizeof *running->term);
    }
    free(kind->depth);
}

void lsm_running_lists_build(const LsmLattice *l, const LsmLists *lists, int layers,
                             const int *layer_plane, LsmRunningLists *running)
{
    Builder b = {.lattice = l};
    int side = lists->side;
    b.layer = sm_alloc((size_t)l->size[2], sizeof(int));
    for (int layer = 0; layer < layers; layer++)
        for (int z = layer_plane[layer]; z < layer_plane[layer + 1]; z++) b.layer[z] = layer;
    open_kind(&b.bar, lists->bar, side, 0, lists->bar_count, &running->bar);
    open_kind(&b.plate, lists->plate, side, 0, lists->plate_count, &running->plate);
    open_kind(&b.region, lists->region, side, 1, lists->region_count + 1, &running->region);
    for (long p = 0; p < l->count; p++) choose(&b, p);
    close_kind(&b.bar);
    close_kind(&b.plate);
    close_kind(&b.region);
    free(b.layer);
}

static void free_list(LsmRunningList *running)
{
    free(running->base);
    free(running->first);
    free(running->term);
}

void lsm_running_lists_free(LsmRunningLists *running)
{
    free_list(&running->bar);
    free_list(&running->plate);
    free_list(&running->region);
}
