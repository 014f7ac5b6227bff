#include "sum.h"

/* Levels of fewer rows are left to the first thread, one after the other: sharing them costs more
 * than it spares. */
enum { ROWS_WORTH_SHARING = 256 };

/* Before the team shares work again, and after it has. */
static void wait_for_all(OctTask *task)
{
    task->alone = false;
    if (task->team == 1) return;
#pragma omp barrier
}

void oct_each_block(OctTask *task, OctPass *pass)
{
    const Oct *oct = task->oct;
    if (task->alone) wait_for_all(task);
    /* loops, in case the runtime grants fewer threads than there are shares */
    for (int share = task->me; share < oct->threads; share += task->team)
        pass(task, oct->share[share], oct->share[share + 1]);
    wait_for_all(task);
}

static void run_level(OctTask *task, OctPass *pass, long first, long last)
{
    if (last - first < ROWS_WORTH_SHARING) {
        if (first == last) return;
        if (task->me == 0) pass(task, first, last);
        task->alone = true;
        return;
    }
    if (task->alone) wait_for_all(task);
    int shares = task->oct->threads;
    for (int share = task->me; share < shares; share += task->team)
        pass(task, first + (last - first) * share / shares,
             first + (last - first) * (share + 1) / shares);
    wait_for_all(task);
}

void oct_climb(OctTask *task, OctPass *pass)
{
    for (int level = task->oct->levels; level >= 0; level--) {
        const OctLevel *inner = &task->oct->inner.level[level];
        task->inner = inner->node;
        run_level(task, pass, 0, inner->count);
    }
}

void oct_descend(OctTask *task, const OctSumLists *lists, OctPass *pass)
{
    for (int level = 0; level <= lists->levels; level++)
        run_level(task, pass, lists->level_first[level], lists->level_first[level + 1]);
}

void oct_each_ghost(OctTask *task, OctPass *pass)
{
    run_level(task, pass, 0, task->oct->ghosts);
}
