/* The registry: a line for each engine. */
#include "engines.h"

/* clang-format off */
const BenchEngine *const bench_engine_list[] = {
    &bench_fastlsm,
    &bench_octree,
    &bench_brute,
    &bench_meshless,
    NULL,
};
