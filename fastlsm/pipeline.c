#include "pipeline.h"
#include "../lib/system/team.h"

#include <stdlib.h>

enum { BLOCKS_WORTH_A_THREAD = 128 };

/* The first layer of a chapter, not before `layer`. */
static int chapter_from(const Lsm *lsm, int layer)
{
    return (layer + lsm->chapter - 1) / lsm->chapter * lsm->chapter;
}

void lsm_pipeline_split(Lsm *lsm)
{
    int threads = sm_team(lsm->params.threads);
    long worth = lsm->blocks / BLOCKS_WORTH_A_THREAD;
    if (threads > worth && lsm->reach > 0) /* who waits for no other is worth one sooner */
        threads = worth > 1 ? (int)worth : 1;
    if (threads > lsm->layers) threads = lsm->layers > 0 ? lsm->layers : 1;
    lsm->threads = threads;
    free(lsm->thread_layer);
    lsm->thread_layer = sm_alloc((size_t)threads + 1, sizeof(int));
    int layer = 0;
    for (int t = 1; t < threads; t++) {
        while (layer < lsm->layers && lsm->layer_block[layer] * threads < lsm->blocks * t) layer++;
        int chapter = chapter_from(lsm, layer - lsm->chapter / 2);
        lsm->thread_layer[t] = chapter < lsm->layers ? chapter : lsm->layers;
    }
    lsm->thread_layer[threads] = lsm->layers;
}

void lsm_pipeline_share(Lsm *lsm, int first, int end)
{
    for (int t = 0; t <= lsm->threads; t++)
        lsm->thread_layer[t] = first + (end - first) * t / lsm->threads;
}

void lsm_pipeline_own(const Lsm *lsm, int phase, int thread, int *begin, int *end)
{
    *begin = lsm->thread_layer[thread];
    *end = lsm->thread_layer[thread + 1];
    bool before = *begin > 0, after = *end < lsm->layers;
    for (int i = 0; i < phase; i++) {
        if (before) *begin = chapter_from(lsm, *begin + lsm->reach);
        if (after) *end -= lsm->reach;
    }
}

int lsm_pipeline_stores(const Lsm *lsm, int phase, int *store)
{
    int turns = 2 * lsm->reach + 1, stores = 0;
    for (int t = 0; t < lsm->threads; t++) {
        int begin, end;
        lsm_pipeline_own(lsm, phase, t, &begin, &end);
        if (begin > 0) begin += lsm->reach;
        if (end < lsm->layers) end -= lsm->reach;
        int ring = stores;
        stores += turns;
        for (int l = lsm->thread_layer[t]; l < lsm->thread_layer[t + 1]; l++)
            store[l] = l < begin || l >= end ? stores++ : ring + l % turns;
    }
    return stores;
}

static void run_own(Lsm *lsm, LsmPhase *const phase[3], int thread, SmLaps *laps)
{
    int first = lsm->thread_layer[thread], last = lsm->thread_layer[thread + 1];
    int begin[3], end[3];
    for (int i = 0; i < 3; i++) lsm_pipeline_own(lsm, i, thread, &begin[i], &end[i]);
    for (int l = first; l < last + 2 * lsm->reach; l++)
        for (int i = 0; i < 3; i++) {
            int layer = l - i * lsm->reach;
            if (layer >= begin[i] && layer < end[i]) phase[i](lsm, layer, thread, laps);
        }
}

/* What is left: first the layers at the end of the share, which go on from its own. */
static void run_shared(Lsm *lsm, LsmPhase *const phase[3], int i, int thread, SmLaps *laps)
{
    int first = lsm->thread_layer[thread], last = lsm->thread_layer[thread + 1], begin, end;
    lsm_pipeline_own(lsm, i, thread, &begin, &end);
    if (end <= begin) begin = end = last;
    for (int l = end; l < last; l++) phase[i](lsm, l, thread, laps);
    for (int l = first; l < begin; l++) phase[i](lsm, l, thread, laps);
}

void lsm_pipeline(Lsm *lsm, LsmPhase *const phase[3])
{
    if (lsm->threads == 1) {
        run_own(lsm, phase, 0, lsm->laps);
        return;
    }
    /* loops, in case the runtime grants fewer threads than there are shares */
#pragma omp parallel num_threads(lsm->threads)
    {
        int me = omp_get_thread_num(), team = omp_get_num_threads();
        for (int t = me; t < lsm->threads; t += team) run_own(lsm, phase, t, t ? NULL : lsm->laps);
        for (int i = 1; i < 3 && lsm->reach > 0; i++) {
#pragma omp barrier
            for (int t = me; t < lsm->threads; t += team)
                run_shared(lsm, phase, i, t, t ? NULL : lsm->laps);
        }
    }
}
