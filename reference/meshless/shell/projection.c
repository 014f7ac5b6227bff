#include "projection.h"

#include <stdlib.h>
#include <string.h>

/* Of the mass share that steps have; of the mass of a node. */
static const double STIFF_SHARE = 1e-2, SMOOTH_SHARE = 1e-8;

static SmCode project_displacements(const RefSteps *steps, const double *residual, double *u,
                                    SmError *error)
{
    RefSolver *solver;
    int size = steps->matrices->stiffness.columns;
    double share = STIFF_SHARE * ref_steps_mass_share(&steps->damping, steps->h);
    SmCode code = ref_solver_create_like(steps->solver, steps->matrices, -share, &solver, error);
    if (code != SM_OK) return code;
    double *change = sm_alloc((size_t)size, sizeof *change);
    ref_solver_solve(solver, residual, NULL, change);
    for (int n = 0; n < size; n++) u[n] += change[n];
    ref_solver_destroy(solver);
    free(change);
    return SM_OK;
}

/* Of a surface whose nodes lie a length of 1 apart. */
static double smoothing(const RefSparse *M)
{
    double *sum = sm_alloc((size_t)M->columns, sizeof *sum), mass = 0;
    ref_sparse_sums(M, sum);
    for (int n = 0; n < M->columns; n++) mass += sum[n];
    free(sum);
    return SMOOTH_SHARE * mass / M->columns;
}

static SmCode project_velocities(const RefSparse *M, const RefWarp *warp, const double *residual,
                                 double *v, SmError *error)
{
    const RefSparse *L = &warp->laplacian.stiffness;
    size_t nodes = (size_t)M->columns, entries = (size_t)M->start[nodes];
    double share = smoothing(M), *column = sm_alloc(nodes, sizeof *column),
           *right = sm_alloc(3 * nodes, sizeof *right);
    RefMatrices smooth = {.stiffness = *M};
    RefSolver *solver;
    smooth.stiffness.value = sm_copy(M->value, entries, sizeof *M->value);
    for (size_t e = 0; e < entries; e++) smooth.stiffness.value[e] += share * L->value[e];
    SmCode code = ref_solver_create_like(warp->solver, &smooth, 0, &solver, error);
    ref_sparse_apply(L, 3, v, right);
    for (int d = 0; code == SM_OK && d < 3; d++) {
        for (size_t n = 0; n < nodes; n++)
            column[n] = residual[3 * n + (size_t)d] - share * right[3 * n + (size_t)d];
        ref_solver_solve(solver, column, NULL, column);
        for (size_t n = 0; n < nodes; n++) v[3 * n + (size_t)d] += column[n];
    }
    if (code == SM_OK) ref_solver_destroy(solver);
    sm_free_all(smooth.stiffness.value, column, right);
    return code;
}

SmCode ref_project_fields(const RefSteps *steps, const RefWarp *warp, double *const residual[2],
                          double *u, double *v, SmError *error)
{
    SmCode code = project_velocities(&steps->matrices->mass, warp, residual[1], v, error);
    return code == SM_OK ? project_displacements(steps, residual[0], u, error) : code;
}
