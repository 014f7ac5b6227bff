/* modes.h without CHOLMOD and ARPACK. */
#include "modes.h"

SmCode ref_modes_find(const RefMatrices *matrices, const RefRows *rows, int count, RefModes *modes,
                      SmError *error)
{
    (void)count;
    *modes = (RefModes){0};
    return ref_solver_create(matrices, 0, rows, &(RefSolver *){NULL},
                             error); /* fails, and says why */
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
