/* variants.c - the table of the instruction set in use (lib/isa.h). */
#include "../../../lib/isa.h"
#include "frame_sums.h"

SM_ISA_TABLE(RefFrameSums, ref_frame_sums)
