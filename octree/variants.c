/* variants.c - the tables of the instruction set in use (lib/isa.h). */
#include "../lib/isa.h"
#include "engine.h"

SM_ISA_TABLE(SmEngineType, octree_engine_f32)
SM_ISA_TABLE(SmEngineType, octree_engine_f64)
