/* running_sums.c - the sums over running lists (running_lists.h): O(1) a row for any shape. A row's
 * sum stays where the rows made from it find it. */
#include <stdlib.h>

#include "../lattice/running_lists.h"
#include "list_rows.h"
#include "lists.h"

/* Measured: below it, lists are faster. */
enum { RUN_LEAST_W = 3 };

struct LsmRunning {
    LsmRunningLists lists;
    real place[LSM_MAX_SIDE + 1]; /* -w-1 .. w */
};

SM_INLINE real *made_at(Level level, int name)
{
    return (real *)named(level.out, (uint64_t)name, 4 * level.made);
}

SM_INLINE vec4 moment_of(Level level, const real *base)
{
    return level.moments == NO_MOMENTS ? (vec4){0} : load4(base + 4 * level.from);
}

SM_INLINE void rows_moved(const int *record, long count, int w, Level level)
{
    for (; count > 0; count--, record += 4) {
        const real *base = made_at(level, record[1]);
        Sum sum = difference(level, (real)w, member_at(level, (uint64_t)record[2]), (real)(-w - 1),
                             member_at(level, (uint64_t)record[3]));
        sum.moment -= moment_of(level, base);
        sum_store(sum, level, base, made_at(level, record[0]));
    }
}

SM_INLINE void rows_changed(const int *record, long count, int times, const real *place, int w,
                            Level level)
{
    while (count-- > 0) {
        int row = *record++, moved = *record & 1;
        const real *base = made_at(level, *record++ - moved);
        Sum sum = {0};
        sum.moment = place[w + 1 - moved] * moment_of(level, base);
        for (int t = 0; t < times; t++, record += LSM_CHANGES) {
            uint32_t at = (uint32_t)record[4];
            for (int i = 0; i < 4; i += 2, at >>= 16) {
                int enter = at & 255, leave = at >> 8 & 255;
                Sum change = difference(level, place[enter], member_at(level, (uint64_t)record[i]),
                                        place[leave], member_at(level, (uint64_t)record[i + 1]));
                sum = sum_of(level, sum, change);
            }
        }
        sum_store(sum, level, base, made_at(level, row));
    }
}

SM_INLINE void rows_listed(const int *record, long count, const real *place, Level level, int times)
{
    while (count-- > 0) {
        int row = *record++, at = *record++;
        Sum sum = {0};
        for (int t = 0; t < times; t++, at++, record++) {
            Sum own = member_at(level, (uint64_t)*record);
            own.moment *= place[at];
            sum = sum_of(level, sum, own);
        }
        sum_store(sum, level, NULL, made_at(level, row));
    }
}

/* The rows of a plane. */
SM_INLINE void plane_rows(const Lsm *lsm, const LsmRunningList *list, int z, Level level)
{
    const real *place = lsm->running->place;
    int w = lsm->w;
    for (long g = list->plane[z]; g < list->plane[z + 1]; g++) {
        LsmGroup group = list->group[g];
        const int *record = list->record + group.first;
        if (group.way == LSM_MOVED)
            rows_moved(record, group.count, w, level);
        else if (group.way == LSM_LISTED)
            FOR_SIDE(group.times, rows_listed, record, group.count, place, level);
        else if (group.times == 1)
            rows_changed(record, group.count, 1, place, w, level);
        else
            rows_changed(record, group.count, group.times, place, w, level);
    }
}

SM_INLINE void subsums_pass(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    const LsmRunningLists *lists = &lsm->running->lists;
    for (int z = lsm->layer_plane[layer]; z < lsm->layer_plane[layer + 1]; z++) {
        plane_rows(lsm, &lists->bar, z, bar_level(rows, way, plain));
        plane_rows(lsm, &lists->plate, z, plate_level(rows, way, plain, true));
    }
}

static void subsums(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    FOR_PASS(way, plain, subsums_pass, lsm, rows, layer);
}

SM_INLINE void last_pass(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    for (int z = lsm->layer_plane[layer]; z < lsm->layer_plane[layer + 1]; z++)
        plane_rows(lsm, &lsm->running->lists.region, z, region_level(rows, way, plain, true));
}

static void last(const Lsm *lsm, const Rows *rows, int layer, int way, bool plain)
{
    FOR_PASS(way, plain, last_pass, lsm, rows, layer);
}

static void tile_sums(const Lsm *lsm, const Rows *rows, long tile, bool plain, vec sum[12])
{
    const int *slot = lsm->tile_slot + tile * SM_LANES;
    const real *row[SM_LANES];
    for (int lane = 0; lane < SM_LANES; lane++)
        row[lane] = slot[lane] < 0 ? rows->transform
                                   : rows->transform + slot_row(rows, slot[lane]) * ROW_WIDTH;
    sums_of_rows(row, plain, sum);
}

static void block_sums(const Lsm *lsm, const Rows *rows, long block, bool plain, vec sum[6])
{
    (void)lsm;
    const real *row = narrow(rows->transform, 2) + slot_row(rows, block * SM_LANES) * 8;
    real(*out)[SM_LANES] = (real(*)[SM_LANES])sum;
    for (int lane = 0; lane < SM_LANES; lane++)
        for (int i = 0; i < (plain ? 6 : 3); i++) out[i][lane] = row[lane * 8 + i / 3 * 4 + i % 3];
}

static const LsmListKernels kernels = {subsums, last, tile_sums, block_sums};

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

/* In place of lists. */
static void open_running(Lsm *lsm)
{
    LsmRunning *running = lsm->running = sm_alloc(1, sizeof *running);
    lsm_running_lists_build(&lsm->lattice, lsm->slot, &lsm->lists, lsm->layers, lsm->layer_plane,
                            &running->lists);
    for (int i = 0; i <= lsm->side; i++) running->place[i] = (real)(i - lsm->w - 1);
    int **list[3] = {&lsm->lists.bar, &lsm->lists.plate, &lsm->lists.region};
    for (int i = 0; i < 3; i++) {
        free(*list[i]);
        *list[i] = NULL;
    }
}

void lsm_running_free(LsmRunning *running)
{
    if (!running) return;
    lsm_running_lists_free(&running->lists);
    free(running);
}

const LsmSums lsm_sums_running = {
    .name = "running",
    .applies = applies,
    .lay_out = lsm_lists_lay_out,
    .open = open_running,
    .phase = {lsm_lists_subsums, lsm_lists_solve, lsm_lists_end},
    .lists = &kernels,
    .by_plane = true,
    .layer_planes = 8, /* that lists along z run through; w where that is more */
};
