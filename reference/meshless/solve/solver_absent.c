/* solver.h without CHOLMOD: the program has neither it nor ARPACK, or a page no sources of it. */
#include <stdlib.h>

#include "solver.h"

const bool ref_solver_built = false;

static SmCode absent(SmError *error)
{
    return sm_fail(
        error, SM_USAGE,
        "meshless bodies need CHOLMOD and ARPACK, which were missing when this was built: "
        "install libsuitesparse-dev and libarpack2-dev (for a page, SuiteSparse's sources), "
        "then configure and build again");
}

SmCode ref_solver_create(const RefMatrices *matrices, double shift, const RefRows *rows,
                         RefSolver **solver, SmError *error)
{
    (void)matrices, (void)shift, (void)rows;
    *solver = NULL;
    return absent(error);
}

SmCode ref_solver_create_like(const RefSolver *like, const RefMatrices *matrices, double shift,
                              RefSolver **solver, SmError *error)
{
    (void)like;
    return ref_solver_create(matrices, shift, NULL, solver, error);
}

void ref_solver_destroy(RefSolver *solver)
{
    (void)solver;
}

void ref_solver_solve_several(RefSolver *solver, int count, const double *b, const double *target,
                              double *x)
{
    (void)solver, (void)count, (void)b, (void)target, (void)x;
    abort(); /* there is no solver to call it with */
}

void ref_solver_solve(RefSolver *solver, const double *b, const double *target, double *x)
{
    ref_solver_solve_several(solver, 1, b, target, x);
}

int ref_solver_rank(const RefSolver *solver)
{
    (void)solver;
    return 0;
}
