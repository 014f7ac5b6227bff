/* What each engine says of itself. */
#include "../fastlsm/fastlsm.h"
#include "../octree/engine.h"
#include "../reference/brute.h"
#include "../reference/meshless/engine.h"
#include "../reference/meshless/shell_engine.h"
#include "check/check.h"
#include "engines.h"
#include "measure/checker.h"
#include "measure/elastic_checker.h"
#include "measure/shell_checker.h"
#include "measure/tree_row.h"
#include "play/body_group.h"
#include "play/mode.h"
#include "scene/body.h"
#include "scene/memory.h"

static void set_cells(BenchScene *scene, double w, double epsilon, bool cells)
{
    (void)epsilon, (void)cells;
    scene->params.w = (int)w;
}

static long *octree_nodes(BenchScene *scene)
{
    return &scene->octree.sampling.nodes;
}

static long *meshless_nodes(BenchScene *scene)
{
    return &scene->meshless.nodes;
}

const BenchEngine bench_fastlsm = {.type = {&fastlsm_engine_f32, &fastlsm_engine_f64},
                                   .yardstick = true,
                                   .set_width = set_cells,
                                   .carrier = &bench_lattice_carrier,
                                   .twin = &bench_lattice_twin,
                                   .checker = &bench_matching_checker,
                                   .memory = bench_memory_lattice};

const BenchEngine bench_octree = {.type = {&octree_engine_f32, &octree_engine_f64},
                                  .sampled = true,
                                  .own = BENCH_OF_SAMPLED,
                                  .whose = "the octree's",
                                  .set_width = bench_width_of_octree,
                                  .nodes = octree_nodes,
                                  .adapt = bench_scene_sample,
                                  .carrier = &bench_octree_carrier,
                                  .twin = &bench_octree_twin,
                                  .checker = &bench_matching_checker,
                                  .fill = bench_tree_row_fill,
                                  .explain = bench_tree_row_explain,
                                  .describe = bench_tree_row_describe,
                                  .structure = oct_engine_structure,
                                  .memory = bench_memory_octree};

const BenchEngine bench_brute = {.type = {&ref_brute_engine},
                                 .carrier = &bench_lattice_carrier,
                                 .twin = &bench_lattice_twin,
                                 .checker = &bench_matching_checker,
                                 .memory = bench_memory_brute};

const BenchEngine bench_shell = {.type = {&ref_shell_engine},
                                 .own = BENCH_OF_SHELL,
                                 .whose = "a shell's",
                                 .reference = true,
                                 .nodes = meshless_nodes,
                                 .adapt = bench_scene_hold_shell,
                                 .carrier = &bench_drawn_carrier,
                                 .describe = bench_shell_row_describe,
                                 .checker = &bench_shell_checker,
                                 .modes = &bench_shell_modes,
                                 .fill = bench_shell_row_fill,
                                 .explain = bench_shell_row_explain,
                                 .memory = bench_memory_lattice};

const BenchEngine bench_meshless = {.type = {&ref_meshless_engine},
                                    .own = BENCH_OF_ELASTIC,
                                    .whose = "a meshless body's",
                                    .reference = true,
                                    .nodes = meshless_nodes,
                                    .adapt = bench_scene_hold,
                                    .carrier = &bench_lattice_carrier,
                                    .describe = bench_elastic_row_describe,
                                    .frames = &ref_meshless_frames,
                                    .checker = &bench_elastic_checker,
                                    .modes = &bench_elastic_modes,
                                    .fill = bench_elastic_row_fill,
                                    .explain = bench_elastic_row_explain,
                                    .memory = bench_memory_lattice};
