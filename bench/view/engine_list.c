/* engine_list.c - the engines of the page, in single precision; elastic bodies and shells in
 * double.
 */
#include "../../fastlsm/fastlsm.h"
#include "../../octree/engine.h"
#include "../../reference/meshless/shell_engine.h"
#include "../engines.h"
#include "../play/body_group.h"
#include "../scene/memory.h"
#include "../scene/scene.h"

static const BenchEngine lattice = {.type = {&fastlsm_engine_f32},
                                    .carrier = &bench_lattice_carrier,
                                    .memory = bench_memory_lattice};
static const BenchEngine sampled = {.type = {&octree_engine_f32},
                                    .sampled = true,
                                    .own = BENCH_OF_SAMPLED,
                                    .whose = "the octree's",
                                    .set_width = bench_width_of_octree,
                                    .carrier = &bench_octree_carrier,
                                    .memory = bench_memory_octree};
static const BenchEngine elastic = {.type = {&ref_meshless_engine},
                                    .own = BENCH_OF_ELASTIC,
                                    .whose = "a meshless body's",
                                    .reference = true,
                                    .carrier = &bench_lattice_carrier,
                                    .memory = bench_memory_lattice};
static const BenchEngine shell = {.type = {&ref_shell_engine},
                                  .own = BENCH_OF_SHELL,
                                  .whose = "a shell's",
                                  .reference = true,
                                  .carrier = &bench_drawn_carrier,
                                  .memory = bench_memory_lattice};
static const BenchEngine *const list[] = {&lattice, &sampled, &elastic, &shell, NULL};

__attribute__((constructor)) static void hand_over(void)
{
    bench_engine_list = list;
}
