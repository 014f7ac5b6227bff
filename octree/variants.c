/* variants.c - the tables of the instruction set in use (lib/isa.h). */
#include "../lib/isa.h"
#include "engine.h"
#include "search/multi_source_search.h"

SM_ISA_TABLE(SmEngineType, octree_engine_f32)
SM_ISA_TABLE(SmEngineType, octree_engine_f64)
SM_ISA_TABLE(OctSearchKernels, oct_search)
