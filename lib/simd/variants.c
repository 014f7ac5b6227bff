/* variants.c - the tables of the instruction set in use (lib/isa.h). */
#include "../isa.h"
#include "../polar.h"

SM_ISA_TABLE(SmPolarBatch32, sm_polar_batch_f32)
SM_ISA_TABLE(SmPolarBatch64, sm_polar_batch_f64)
