/* machine_info.h - what `shapebench info` says without a mesh: the machine, and what this program
 * can do on it. */
#ifndef BENCH_MACHINE_INFO_H
#define BENCH_MACHINE_INFO_H

#include "../system/machine.h"

/* To standard output, as text or as JSON: {"environment": {...}, "isas": [{"name", "there",
 * "in_use"}], "processors", "affinity", "quota", "openmp", "openmp_library"}; what is not there
 * is null. */
void bench_machine_info(const BenchMachine *machine, bool json);

#endif
