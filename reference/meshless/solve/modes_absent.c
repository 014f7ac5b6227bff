/* What solver.h and modes.h are without CHOLMOD and ARPACK. */
#include <stdlib.h>

#include "modes.h"

const bool ref_solver_built = false;

static SmCode absent(SmError *error)
{
    return sm_fail(error, SM_USAGE,
                   "this program was built without CHOLMOD and ARPACK, which meshless bodies need: "
                   "install libsuitesparse-dev and libarpack2-dev, then configure and build again");
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

SmCode ref_modes_find(const RefMatrices *matrices, const RefRows *rows, int count, RefModes *modes,
                      SmError *error)
{
    (void)matrices, (void)rows, (void)count;
    *modes = (RefModes){0};
    return absent(error);
}

SmCode ref_modes_of(const RefMatrices *matrices, RefSolver *solver, double shift, int count,
                    RefModes *modes, SmError *error)
{
    (void)solver, (void)shift;
    return ref_modes_find(matrices, NULL, count, modes, error);
}

double ref_modes_shift(const RefMatrices *matrices)
{
    (void)matrices;
    return 0;
}
