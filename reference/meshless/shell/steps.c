#include "steps.h"

#include <math.h>
#include <stdlib.h>

void ref_steps_free(RefSteps *steps)
{
    ref_solver_destroy(steps->solver);
    ref_rows_free(&steps->rows);
    ref_steps_slacken(steps);
    sm_free_all(steps->u, steps->v, steps->force, steps->speed, steps->value, steps->right,
                steps->other);
    *steps = (RefSteps){.solver = NULL};
}

/* What K is multiplied by in M + h C + h^2 K. */
static double share_of_K(const RefDamping *damping, double h)
{
    return h * damping->stiffness_damping + h * h;
}

double ref_steps_mass_share(const RefDamping *damping, double h)
{
    return (1 + h * damping->mass_damping) / share_of_K(damping, h);
}

SmCode ref_steps_create(const RefMatrices *matrices, const RefDamping *damping, double h,
                        const RefRows *rows, const RefSolver *like, RefSteps *steps, SmError *error)
{
    double a = damping->mass_damping, b = damping->stiffness_damping;
    *steps = (RefSteps){.matrices = matrices, .damping = *damping, .h = h};
    if (!(h > 0 && isfinite(h)))
        return sm_fail(error, SM_USAGE, "a step of %g s; give one above 0", h);
    if (!(a >= 0 && b >= 0))
        return sm_fail(error, SM_USAGE, "dampings of %g 1/s and %g s; give none below 0", a, b);
    double share = -ref_steps_mass_share(damping, h);
    SmCode code = like && !rows
                      ? ref_solver_create_like(like, matrices, share, &steps->solver, error)
                      : ref_solver_create(matrices, share, rows, &steps->solver, error);
    if (code != SM_OK) return code;
    double **vector[] = {&steps->u, &steps->v, &steps->force, &steps->right, &steps->other};
    for (int n = 0; n < 5; n++)
        *vector[n] = sm_alloc((size_t)matrices->stiffness.columns, sizeof(double));
    if (rows) steps->rows = ref_rows_copy(rows);
    steps->speed = sm_alloc((size_t)steps->rows.count, sizeof *steps->speed);
    steps->value = sm_alloc((size_t)steps->rows.count, sizeof *steps->value);
    return SM_OK;
}

SmCode ref_steps_bear(RefSteps *steps, RefSparse *tension, SmError *error)
{
    const RefMatrices *matrices = steps->matrices;
    size_t entries = (size_t)tension->start[tension->columns];
    double m = ref_steps_mass_share(&steps->damping, steps->h);
    double times = steps->h / (steps->damping.stiffness_damping + steps->h) / m;
    RefMatrices heavy = *matrices;
    RefSolver *solver;
    heavy.mass.value = sm_copy(matrices->mass.value, entries, sizeof *heavy.mass.value);
    for (size_t e = 0; e < entries; e++) heavy.mass.value[e] += times * tension->value[e];
    SmCode code =
        ref_solver_create(&heavy, -m, steps->rows.count ? &steps->rows : NULL, &solver, error);
    free(heavy.mass.value);
    if (code != SM_OK) {
        ref_sparse_free(tension);
        return code;
    }
    ref_steps_slacken(steps);
    steps->taut = solver;
    steps->tension = *tension;
    return SM_OK;
}

void ref_steps_slacken(RefSteps *steps)
{
    ref_solver_destroy(steps->taut);
    ref_sparse_free(&steps->tension);
    steps->taut = NULL;
}

/* What tension adds on the side of steps that v + u' / (b + h) is solved from. */
static void add_tension(RefSteps *steps)
{
    double lead = 1 / (steps->damping.stiffness_damping + steps->h);
    double *of_u = steps->other;
    ref_sparse_apply(&steps->tension, 3, steps->u, of_u);
    for (int n = 0; n < steps->matrices->stiffness.columns; n++)
        steps->right[n] += steps->h * lead * lead * of_u[n];
}

RefSolver *ref_steps_solver(const RefSteps *steps)
{
    return steps->taut ? steps->taut : steps->solver;
}

void ref_steps_go(RefSteps *steps)
{
    double a = steps->damping.mass_damping, b = steps->damping.stiffness_damping, h = steps->h;
    int size = steps->matrices->stiffness.columns;
    double *right = steps->right, *end = steps->other, lead = 1 / (b + h);
    for (int n = 0; n < size; n++) end[n] = steps->v[n] + (1 + h * a) * lead * steps->u[n];
    ref_sparse_apply(&steps->matrices->mass, 3, end, right);
    double times = 1 / share_of_K(&steps->damping, h);
    for (int n = 0; n < size; n++) right[n] = times * (right[n] + h * steps->force[n]);
    if (steps->taut) add_tension(steps);
    for (long r = 0; r < steps->rows.count; r++)
        steps->value[r] = steps->speed[r] + lead * ref_rows_apply(&steps->rows, r, steps->u);
    ref_solver_solve(ref_steps_solver(steps), right, steps->value, end);
    for (int n = 0; n < size; n++) {
        steps->v[n] = end[n] - lead * steps->u[n];
        steps->u[n] += h * steps->v[n];
    }
}

double ref_steps_energy(RefSteps *steps)
{
    double sum = 0;
    ref_sparse_apply(&steps->matrices->stiffness, 1, steps->u, steps->right);
    ref_sparse_apply(&steps->matrices->mass, 3, steps->v, steps->other);
    for (int n = 0; n < steps->matrices->stiffness.columns; n++)
        sum += steps->u[n] * steps->right[n] + steps->v[n] * steps->other[n];
    return sum / 2;
}
