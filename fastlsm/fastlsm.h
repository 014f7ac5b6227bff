/* fastlsm.h - fast lattice shape matching (Rivers and James 2007) behind engine.h.
 *
 * Read fastlsm.c first: the step, top to bottom. */
#ifndef FASTLSM_H
#define FASTLSM_H

#include "../lib/engine/engine.h"

/* In single and double precision, those of the instruction set in use (lib/isa.h). */
extern SmEngineType fastlsm_engine_f32, fastlsm_engine_f64;

#endif
