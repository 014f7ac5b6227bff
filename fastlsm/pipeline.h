/* pipeline.h - runs the three phases of a pass over the layers of a body, in cache and in parallel.
 *
 * Phase 0 of layer l needs only layer l; phase 1 needs phase 0 of layers l - reach .. l + reach;
 * phase 2 needs phase 1 of the same span, and may overwrite what phase 0 and 1 read of layer l. A
 * thread owns consecutive layers and runs the phases as a software pipeline, so that what one phase
 * wrote is still in cache when the next reads it; what depends on another thread's layers waits
 * behind a barrier.
 *
 * A phase may go on from what the same thread left at the layer before, except at layers that are
 * multiples of lsm->chapter: the layers from one of these to the next are run in turn by one
 * thread. So no phase's result depends on who runs it or when, and any thread count gives the same
 * bits. */
#ifndef LSM_PIPELINE_H
#define LSM_PIPELINE_H

#include "state.h"

#define lsm_pipeline        SM_NAME(lsm_pipeline)
#define lsm_pipeline_own    SM_NAME(lsm_pipeline_own)
#define lsm_pipeline_stores SM_NAME(lsm_pipeline_stores)
#define lsm_pipeline_split  SM_NAME(lsm_pipeline_split)
#define lsm_pipeline_share  SM_NAME(lsm_pipeline_share)

/* `laps` is NULL but for the first thread of an instrumented run. */
typedef void LsmPhase(Lsm *lsm, int layer, int thread, SmLaps *laps);

void lsm_pipeline(Lsm *lsm, LsmPhase *const phase[3]);

/* The layers begin .. end - 1 of a thread's share whose phase `phase` waits for no other thread;
 * none if end <= begin. */
void lsm_pipeline_own(const Lsm *lsm, int phase, int thread, int *begin, int *end);

/* Shares the layers among threads by their blocks: fills thread_layer, may lower `threads`. */
void lsm_pipeline_split(Lsm *lsm);

/* Of a body whose layers wait for no other: shares layers first .. end - 1, which alone are run. */
void lsm_pipeline_share(Lsm *lsm, int first, int end);

/* Where what phase `phase - 1` leaves of each layer is kept for phase `phase`: store[layers], and
 * returns how many there are. A store is free for another layer once that phase has passed `reach`
 * layers on: in the middle of a thread's share layers take turns; near its ends, where the phase
 * waits for another thread, each has its own. */
int lsm_pipeline_stores(const Lsm *lsm, int phase, int *store);

#endif
