#include "grip_modes.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"

/* Functions that are to become modes, [unknowns] each, M-orthonormal so far. */
typedef struct {
    const RefBody *body;
    size_t unknowns;
    int count, room;
    double *u, *Mu;
} Space;

/* One of six: a displacement along an axis, or a small turn about it. */
static void rigid_at(int kind, const double x[3], const double middle[3], double u[3])
{
    double axis[3] = {kind % 3 == 0, kind % 3 == 1, kind % 3 == 2}, way[3];
    for (int d = 0; d < 3; d++) {
        u[d] = axis[d];
        way[d] = x[d] - middle[d];
    }
    if (kind >= 3) sm_cross(axis, way, u);
}

/* Adds u, or what is left of it beside the others, if that is more than rounding. */
static void add(Space *space, const double *u)
{
    double *own = space->u + (size_t)space->count * space->unknowns;
    double *mass = space->Mu + (size_t)space->count * space->unknowns, before = 0, norm = 0;
    if (space->count == space->room) return;
    memcpy(own, u, space->unknowns * sizeof *own);
    for (int round = 0; round < 3; round++) {
        ref_sparse_apply(&space->body->matrices.mass, 3, own, mass);
        norm = 0;
        for (size_t n = 0; n < space->unknowns; n++) norm += own[n] * mass[n];
        if (round == 0) before = norm;
        if (!(norm > 1e-12 * before) || round == 2) break;
        for (int k = 0; k < space->count; k++) {
            const double *other = space->u + (size_t)k * space->unknowns;
            const double *other_mass = space->Mu + (size_t)k * space->unknowns;
            double share = 0;
            for (size_t n = 0; n < space->unknowns; n++) share += own[n] * other_mass[n];
            for (size_t n = 0; n < space->unknowns; n++) own[n] -= share * other[n];
        }
    }
    if (!(norm > 1e-12 * before && norm > 0)) return;
    for (size_t n = 0; n < space->unknowns; n++) {
        own[n] /= sqrt(norm);
        mass[n] /= sqrt(norm);
    }
    space->count++;
}

static RefRows rows_of(const RefBody *body, int grips, const RefGrip *grip)
{
    RefRows rows = {0};
    RefShape shape = ref_shape_create(&body->nodes);
    for (int k = 0; k < grips; k++)
        for (int n = 0; n < grip[k].count; n++)
            if (ref_mls_at(&body->nodes, body->basis, grip[k].x[n], &shape))
                for (int d = 0; d < 3; d++) ref_rows_displacement(&rows, &shape, d);
    ref_shape_free(&shape);
    return rows;
}

/* What is left at rest, moves as a whole, or answers at once. */
static void add_static(const RefBody *body, RefSolver *solver, int grips, const RefGrip *grip,
                       long rows, Space *space)
{
    double *u = sm_alloc(space->unknowns, sizeof *u),
           *load = sm_alloc(space->unknowns, sizeof *load);
    double *target = sm_alloc((size_t)rows, sizeof *target);
    for (int kind = 0; kind < 6; kind++) {
        for (long n = 0; n < body->nodes.count; n++)
            rigid_at(kind, body->nodes.position[n], grip[0].middle, u + 3 * n);
        add(space, u);
    }
    for (int k = 1, row = 3 * grip[0].count; k < grips; row += 3 * grip[k++].count)
        for (int kind = 0; kind < 6; kind++) {
            memset(target, 0, (size_t)rows * sizeof *target);
            for (int n = 0; n < grip[k].count; n++)
                rigid_at(kind, grip[k].x[n], grip[k].middle, target + row + 3 * n);
            ref_solver_solve(solver, NULL, target, u);
            add(space, u);
        }
    for (int axis = 0; axis < 3; axis++) {
        for (size_t n = 0; n < space->unknowns; n++) u[n] = n % 3 == (size_t)axis;
        ref_sparse_apply(&body->matrices.mass, 3, u, load);
        ref_solver_solve(solver, load, NULL, u);
        add(space, u);
    }
    sm_free_all(u, load, target);
}

/* K is made diagonal over the space: its modes. */
static void rayleigh_ritz(const Space *space, RefModes *modes)
{
    size_t count = (size_t)space->count, unknowns = space->unknowns;
    double *Ku = sm_alloc(unknowns, sizeof *Ku);
    gsl_matrix *K = gsl_matrix_alloc(count, count), *turn = gsl_matrix_alloc(count, count);
    gsl_vector *value = gsl_vector_alloc(count);
    for (size_t a = 0; a < count; a++) {
        ref_sparse_apply(&space->body->matrices.stiffness, 1, space->u + a * unknowns, Ku);
        for (size_t b = 0; b < count; b++) {
            double sum = 0;
            for (size_t n = 0; n < unknowns; n++) sum += space->u[b * unknowns + n] * Ku[n];
            gsl_matrix_set(K, a, b, sum);
        }
    }
    gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(count);
    gsl_eigen_symmv(K, value, turn, work);
    gsl_eigen_symmv_sort(value, turn, GSL_EIGEN_SORT_VAL_ASC);
    *modes = (RefModes){.nodes = (long)(unknowns / 3), .count = (int)count};
    modes->lambda = sm_alloc(count, sizeof *modes->lambda);
    modes->shape = sm_alloc(unknowns * count, sizeof *modes->shape);
    for (size_t k = 0; k < count; k++) {
        modes->lambda[k] = gsl_vector_get(value, k);
        for (size_t a = 0; a < count; a++) {
            double share = gsl_matrix_get(turn, a, k);
            for (size_t n = 0; n < unknowns; n++)
                modes->shape[n * count + k] += share * space->u[a * unknowns + n];
        }
    }
    gsl_eigen_symmv_free(work);
    gsl_matrix_free(K);
    gsl_matrix_free(turn);
    gsl_vector_free(value);
    free(Ku);
}

static void add_modes(const RefModes *own, Space *space)
{
    double *u = sm_alloc(space->unknowns, sizeof *u);
    for (int k = 0; k < own->count; k++) {
        for (size_t n = 0; n < space->unknowns; n++)
            u[n] = own->shape[n * (size_t)own->count + (size_t)k];
        add(space, u);
    }
    free(u);
}

SmCode ref_grip_modes(const RefBody *body, int grips, const RefGrip *grip, int count,
                      RefModes *modes, SmError *error)
{
    Space space = {.body = body, .unknowns = 3 * (size_t)body->nodes.count};
    RefRows rows = rows_of(body, grips, grip);
    RefSolver *solver;
    RefModes own = {0};
    int answers = 6 * grips + 3,
        free_ones = count - answers > count / 2 ? count - answers : count / 2;
    *modes = (RefModes){0};
    double shift = ref_modes_shift(&body->matrices);
    SmCode code = ref_solver_create(&body->matrices, shift, &rows, &solver, error);
    if (code == SM_OK) {
        int left = ((int)space.unknowns - ref_solver_rank(solver)) / 2;
        if (free_ones > left) free_ones = left;
        if (free_ones > 0)
            code = ref_modes_of(&body->matrices, solver, shift, free_ones, &own, error);
        if (code == SM_OK) {
            space.room = answers + free_ones;
            size_t room = ((size_t)space.room + 1) * space.unknowns;
            space.u = sm_alloc(room, sizeof *space.u);
            space.Mu = sm_alloc(room, sizeof *space.Mu);
            add_static(body, solver, grips, grip, rows.count, &space);
            add_modes(&own, &space);
            rayleigh_ritz(&space, modes);
        }
        ref_solver_destroy(solver);
    }
    ref_modes_free(&own);
    ref_rows_free(&rows);
    free(space.u);
    free(space.Mu);
    return code;
}
