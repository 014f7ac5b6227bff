/* modes.h - the lowest natural modes of a meshless body: K x = lambda M x, by ARPACK. */
#ifndef REF_MODES_H
#define REF_MODES_H

#include <stdlib.h>

#include "solver.h"

enum { REF_RIGID_MODES = 6 }; /* of a free body, the lowest ones */

typedef struct {
    long nodes;
    int count;
    double *lambda; /* [count] rising: squares of the angular frequencies, 1/s^2 */
    double *shape;  /* [3 nodes][count]: Psi, M-orthonormal columns */
} RefModes;

/* The `count` lowest modes of what `rows` leave free (NULL: a free body, whose first six lambda are
 * 0 but for rounding), by Lanczos with shift and invert: the factors of K - sigma M, sigma a little
 * below 0, in an operator that keeps A x = 0. Errors: SM_USAGE, a count that is not from 1 to half
 * of what there is; SM_INPUT, a singular matrix or a search that does not converge. The caller
 * frees. */
SmCode ref_modes_find(const RefMatrices *matrices, const RefRows *rows, int count, RefModes *modes,
                      SmError *error);

/* The same by a solver of the caller's, whose shift was this one. */
SmCode ref_modes_of(const RefMatrices *matrices, RefSolver *solver, double shift, int count,
                    RefModes *modes, SmError *error);
double ref_modes_shift(const RefMatrices *matrices);

static inline void ref_modes_free(RefModes *modes)
{
    free(modes->lambda);
    free(modes->shape);
    *modes = (RefModes){0};
}

#endif
