/* pipeline.h - runs the three parts of a pass over the layers of a body, in cache and in parallel.
 *
 * Part 0 of layer l needs only layer l; part 1 needs part 0 of layers l - reach .. l + reach; part
 * 2 needs part 1 of the same span, and may overwrite what part 0 and 1 read of layer l. A thread
 * owns consecutive layers and runs the parts as a software pipeline, so that what one part wrote is
 * still in cache when the next reads it; what depends on another thread's layers waits behind a
 * barrier. No part's result depends on who runs it or when, so any thread count gives the same
 * bits. */
#ifndef LSM_PIPELINE_H
#define LSM_PIPELINE_H

#include "state.h"

#define lsm_pipeline       SM_NAME(lsm_pipeline)
#define lsm_pipeline_split SM_NAME(lsm_pipeline_split)

/* `laps` is NULL but for the first thread of an instrumented run. */
typedef void LsmPart(Lsm *lsm, int layer, int thread, SmLaps *laps);

void lsm_pipeline(Lsm *lsm, LsmPart *const part[3]);

/* Shares the layers among threads by their blocks: fills thread_layer, may lower `threads`. */
void lsm_pipeline_split(Lsm *lsm);

#endif
