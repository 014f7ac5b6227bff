/* engine_list.c - the engines that there are, handed to who looks them up (engines.c). It is linked
 * into programs and not part of the library: nothing there depends on it, and so on every engine.
 */
#include "engines.h"

#define ENGINE(name) &bench_##name,
static const BenchEngine *const list[] = {
#include "registry.inc"
    NULL};

__attribute__((constructor)) static void hand_over(void)
{
    bench_engine_list = list;
}
