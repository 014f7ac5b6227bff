#include "pipeline.h"

#include <omp.h>
#include <stdlib.h>

enum { BLOCKS_WORTH_A_THREAD = 128 };

void lsm_pipeline_split(Lsm *lsm)
{
    int threads = lsm->params.threads > 0 ? lsm->params.threads : omp_get_max_threads();
    long worth = lsm->blocks / BLOCKS_WORTH_A_THREAD;
    if (threads > worth) threads = worth > 1 ? (int)worth : 1;
    if (threads > lsm->layers) threads = lsm->layers > 0 ? lsm->layers : 1;
    lsm->threads = threads;
    free(lsm->thread_layer);
    lsm->thread_layer = sm_alloc((size_t)threads + 1, sizeof(int));
    int layer = 0;
    for (int t = 1; t < threads; t++) {
        while (layer < lsm->layers && lsm->layer_block[layer] * threads < lsm->blocks * t) layer++;
        lsm->thread_layer[t] = layer;
    }
    lsm->thread_layer[threads] = lsm->layers;
}

/* Do all layers within `span` of layer l belong to the thread that owns first .. last - 1? */
static bool own(const Lsm *lsm, int l, int span, int first, int last)
{
    return (l - span >= first || first == 0) && (l + span < last || last == lsm->layers);
}

static void run_own(Lsm *lsm, LsmPart *const part[3], int thread, SmLaps *laps)
{
    int first = lsm->thread_layer[thread], last = lsm->thread_layer[thread + 1], reach = lsm->reach;
    for (int l = first; l < last + 2 * reach; l++) {
        if (l < last) part[0](lsm, l, thread, laps);
        int one = l - reach, two = l - 2 * reach;
        if (one >= first && one < last && own(lsm, one, reach, first, last))
            part[1](lsm, one, thread, laps);
        if (two >= first && two < last && own(lsm, two, 2 * reach, first, last))
            part[2](lsm, two, thread, laps);
    }
}

static void run_shared(Lsm *lsm, LsmPart *run, int span, int thread, SmLaps *laps)
{
    int first = lsm->thread_layer[thread], last = lsm->thread_layer[thread + 1];
    for (int l = first; l < last; l++)
        if (!own(lsm, l, span, first, last)) run(lsm, l, thread, laps);
}

void lsm_pipeline(Lsm *lsm, LsmPart *const part[3])
{
    if (lsm->threads == 1) {
        run_own(lsm, part, 0, lsm->laps);
        return;
    }
    /* loops, in case the runtime grants fewer threads than there are shares */
#pragma omp parallel num_threads(lsm->threads)
    {
        int me = omp_get_thread_num(), team = omp_get_num_threads();
        for (int t = me; t < lsm->threads; t += team) run_own(lsm, part, t, t ? NULL : lsm->laps);
#pragma omp barrier
        for (int t = me; t < lsm->threads; t += team)
            run_shared(lsm, part[1], lsm->reach, t, t ? NULL : lsm->laps);
#pragma omp barrier
        for (int t = me; t < lsm->threads; t += team)
            run_shared(lsm, part[2], 2 * lsm->reach, t, t ? NULL : lsm->laps);
    }
}
