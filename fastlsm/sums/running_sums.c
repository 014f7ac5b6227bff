/* running_sums.c - the sums over running lists (running_lists.h): O(1) a row for any shape.
 *
 * A row's sum stays where the rows made from it find it: bars and plates in their own rows, regions
 * and, on the way down, particles in rows.transform, which holds nothing else meanwhile. */
#include <stdlib.h>

#include "list_rows.h"
#include "lists.h"

/* Measured: below it, lists are faster. */
enum { RUN_LEAST_W = SM_REAL_BITS == 32 ? 5 : 4, WIDTH = 16 };

/* Where a kind of row takes its moments from and adds them to, in vectors of four. */
typedef enum { NONE, UP, DOWN } Moments;
typedef struct {
    const real *in;
    int in_width, vectors; /* values apart, and vectors of four to read */
    real *out;
    Moments moments;
    int from, to;
} Level;

/* One row of a running, in two halves, into `out`: its base, moved on, and its terms. */
SM_INLINE void running_row(const Lsm *lsm, const LsmRunningList *running, long row, Level level,
                           real *out)
{
    const real *base = level.out + (long)(running->base[row] / 2) * WIDTH;
    HalfRow sum[2] = {0};
    vec4 moment = {0};
    if (level.moments != NONE)
        moment -= (real)(running->base[row] & 1) * load4(base + 4 * level.from);
    const LsmTerm *term = running->term + running->first[row],
                  *end = running->term + running->first[row + 1];
    do {
        for (int i = 0; i < 2; i++, term++) {
            const real *member = level.in + (long)term->row * level.in_width,
                       *factor = lsm->running_factor[term->factor];
            if (level.vectors == 1)
                sum[0] = half_add_four(sum[0], 0, factor[0] * load4(member));
            else
                sum[0] = half_add_times(sum[0], factor[0], half_load(member));
            if (level.vectors == 4)
                sum[1] = half_add_times(sum[1], factor[0], half_load(member + 8));
            if (level.moments != NONE) moment += factor[1] * load4(member + 4 * level.from);
        }
    } while (term < end);
    HalfRow *to = &sum[level.to / 2];
    if (level.moments == UP) *to = half_add_four(*to, level.to % 2, moment);
    if (level.moments == DOWN) *to = half_add_four(*to, level.to % 2, -moment);
    /* what is large last: it is rounded once */
    half_store(out, half_add(half_load(base), sum[0]));
    half_store(out + 8, half_add(half_load(base + 8), sum[1]));
}

/* Bars or plates `first` .. `last` - 1. */
SM_INLINE void running_rows(const Lsm *lsm, const LsmRunningList *running, long first, long last,
                            Level level)
{
    for (long row = first; row < last; row++)
        running_row(lsm, running, row, level, level.out + row * WIDTH);
}

/* Regions around, or sums over, the particles of a layer. */
SM_INLINE void running_slots(const Lsm *lsm, int layer, Level level)
{
    const LsmRunningList *running = &lsm->running_lists->region;
    for (long slot = lsm->layer_block[layer] * SM_LANES;
         slot < lsm->layer_block[layer + 1] * SM_LANES && lsm->particle[slot] >= 0; slot++) {
        running_row(lsm, running, lsm->particle[slot] + 1, level, level.out + (slot + 1) * WIDTH);
    }
}

SM_INLINE void subsums(const Lsm *lsm, int layer, Level bar, Level plate)
{
    const LsmLists *lists = &lsm->lists;
    int first = lsm->layer_plane[layer], last = lsm->layer_plane[layer + 1];
    running_rows(lsm, &lsm->running_lists->bar, lists->bar_plane[first], lists->bar_end[last], bar);
    running_rows(lsm, &lsm->running_lists->plate, lists->plate_plane[first], lists->plate_end[last],
                 plate);
}

static void subsums_up(const Lsm *lsm, int layer, bool plain)
{
    const Rows *r = &lsm->rows;
    if (plain)
        subsums(lsm, layer, (Level){r->transform, ROW_T, 4, r->bar, NONE, 0, 0},
                (Level){r->bar, ROW_BAR, 4, r->plate, NONE, 0, 0});
    else
        subsums(lsm, layer, (Level){r->p, ROW_P, 1, r->bar, UP, 0, 1},
                (Level){r->bar, ROW_BAR, 2, r->plate, UP, 0, 2});
}

static void subsums_down(const Lsm *lsm, int layer, bool plain)
{
    const Rows *r = &lsm->rows;
    if (plain)
        subsums(lsm, layer, (Level){r->transform, ROW_T, 2, r->bar, NONE, 0, 0},
                (Level){r->bar, ROW_BAR, 2, r->plate_down, NONE, 0, 0});
    else
        subsums(lsm, layer, (Level){r->transform, ROW_T, 4, r->bar, DOWN, 3, 0},
                (Level){r->bar, ROW_BAR, 4, r->plate_down, DOWN, 2, 0});
}

static void regions(const Lsm *lsm, int layer, bool plain)
{
    const Rows *r = &lsm->rows;
    if (plain)
        running_slots(lsm, layer, (Level){r->plate, ROW_PLATE, 4, r->transform, NONE, 0, 0});
    else
        running_slots(lsm, layer, (Level){r->plate, ROW_PLATE, 4, r->transform, UP, 0, 3});
}

static void particles(const Lsm *lsm, int layer, bool plain)
{
    const Rows *r = &lsm->rows;
    Level level = {r->plate_down, ROW_PLATE_RUN, 2, r->transform, NONE, 0, 0};
    if (plain) {
        running_slots(lsm, layer, level);
        return;
    }
    level.moments = DOWN;
    level.from = 1;
    running_slots(lsm, layer, level);
}

static void tile_sums(const Lsm *lsm, long tile, bool plain, vec sum[12])
{
    const int *slot = lsm->tile_slot + tile * SM_LANES;
    const real *row[SM_LANES];
    for (int lane = 0; lane < SM_LANES; lane++)
        row[lane] = lsm->rows.transform + (slot[lane] + 1) * (long)ROW_T;
    sums_of_rows(row, plain, sum);
}

static void block_sums(const Lsm *lsm, long block, bool plain, vec sum[6])
{
    const real *row = lsm->rows.transform + (block * SM_LANES + 1) * ROW_T;
    real(*out)[SM_LANES] = (real(*)[SM_LANES])sum;
    for (int lane = 0; lane < SM_LANES; lane++)
        for (int i = 0; i < (plain ? 6 : 3); i++)
            out[i][lane] = row[lane * ROW_T + i / 3 * 4 + i % 3];
}

static const LsmListKernels kernels = {subsums_up, subsums_down, regions,
                                       particles,  tile_sums,    block_sums};

/* Where w is small the lists are as short; running sums subtract, so masses must be of like size;
 * rows that change one by one stay lists. */
static bool applies(const Lsm *lsm)
{
    const double like = 16; /* a heavy particle that leaves a sum leaves its rounding behind */
    double least = 1, most = 1;
    for (long p = 0; p < lsm->lattice.count && lsm->mass; p++) {
        least = lsm->mass[p] < least ? lsm->mass[p] : least;
        most = lsm->mass[p] > most ? lsm->mass[p] : most;
    }
    return lsm->w >= RUN_LEAST_W && lsm->params.summation == SM_SUM_FAST &&
           lsm->params.strain_limit == 0 && most <= like * least;
}

/* In place of the lists, which go. */
static void open_running(Lsm *lsm)
{
    double factor[LSM_FACTORS][2];
    lsm->running_lists = sm_alloc(1, sizeof *lsm->running_lists);
    lsm_running_lists_build(&lsm->lattice, &lsm->lists, lsm->layers, lsm->layer_plane,
                            lsm->running_lists);
    LsmRunningList *region = &lsm->running_lists->region;
    for (long r = 1; r < region->rows; r++)
        if (region->base[r]) region->base[r] = 2 * (lsm->slot[region->base[r] / 2 - 1] + 1) + 1;
    lsm_running_factors(lsm->w, factor);
    lsm->running_factor = sm_alloc(LSM_FACTORS, sizeof *lsm->running_factor);
    for (int i = 0; i < 4 * lsm->w + 4; i++)
        for (int k = 0; k < 2; k++) lsm->running_factor[i][k] = (real)factor[i][k];
    int **list[3] = {&lsm->lists.bar, &lsm->lists.plate, &lsm->lists.region};
    for (int i = 0; i < 3; i++) {
        free(*list[i]);
        *list[i] = NULL;
    }
}

const LsmSums lsm_sums_running = {
    .name = "running",
    .applies = applies,
    .lay_out = lsm_lists_lay_out,
    .open = open_running,
    .phase = {lsm_lists_subsums, lsm_lists_solve, lsm_lists_end},
    .lists = &kernels,
    .layer_planes = 8, /* that lists along z run through */
    .plate_down = ROW_PLATE_RUN,
};
