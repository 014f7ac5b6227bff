/* variants.c - the tables of the instruction set in use (lib/isa.h). */
#include "../../lib/isa.h"
#include "peak_loops.h"
#include "tree_steps.h"

SM_ISA_TABLE(BenchTreeSteps, bench_tree_steps_f32)
SM_ISA_TABLE(BenchTreeSteps, bench_tree_steps_f64)
SM_ISA_TABLE(BenchPeakLoops, bench_peak_loops_f32)
SM_ISA_TABLE(BenchPeakLoops, bench_peak_loops_f64)
