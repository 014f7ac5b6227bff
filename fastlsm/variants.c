/* variants.c - the tables of the instruction set in use (lib/isa.h). */
#include "../lib/isa.h"
#include "fastlsm.h"

SM_ISA_TABLE(SmEngineType, fastlsm_engine_f32)
SM_ISA_TABLE(SmEngineType, fastlsm_engine_f64)
