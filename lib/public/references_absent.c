/* What body.c asks of reference/ in a library that is the core alone: nothing, unless the program
 * has it (as tests do). */
#include "../../reference/brute.h"
#include "../../reference/meshless/engine.h"
#include "../../reference/meshless/shell_engine.h"
#include "../../reference/meshless/solve/solver.h"

__attribute__((weak)) const SmEngineType ref_brute_engine = {.create = NULL};
__attribute__((weak)) const SmEngineType ref_meshless_engine = {.create = NULL};
__attribute__((weak)) const SmEngineType ref_shell_engine = {.create = NULL};
__attribute__((weak)) const bool ref_solver_built = false;
