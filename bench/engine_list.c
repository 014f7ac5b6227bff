#include "engines.h"

#define ENGINE(name) &bench_##name,
const BenchEngine *const bench_engine_list[] = {
#include "registry.inc"
    NULL};
