/* fastlsm.h - fast lattice shape matching (Rivers and James 2007) behind engine.h.
 *
 * Read fastlsm.c first: the step, top to bottom. */
#ifndef FASTLSM_H
#define FASTLSM_H

#include "../lib/engine/engine.h"

extern const SmEngineType fastlsm_engine_f32; /* single precision */
extern const SmEngineType fastlsm_engine_f64; /* double precision */

#endif
