/* test_solver.h - what tests of meshless bodies need of the build. */
#ifndef REF_TEST_SOLVER_H
#define REF_TEST_SOLVER_H

#include "../../lib/test_frame.h"
#include "solve/solver.h"

static inline void needs_solver(void)
{
    needs(ref_solver_built, "this program was built without CHOLMOD and ARPACK");
}

#endif
