#include "modes.h"

#include <arpack.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "blas.h"

enum { MOST_RESTARTS = 300 };

/* ARPACK's reverse communication for a symmetric problem. */
typedef struct {
    int size, wanted, vectors, work_size;
    double *residual, *basis, *work, *far_work;
    int param[11], pointer[11];
} Lanczos;

/* A little below 0 on the scale of the eigenvalues, which M and K's traces give. */
double ref_modes_shift(const RefMatrices *matrices)
{
    const RefSparse *K = &matrices->stiffness, *M = &matrices->mass;
    double stiffness = 0, mass = 0;
    for (int c = 0; c < K->columns; c++) stiffness += K->value[K->start[c]];
    for (int c = 0; c < M->columns; c++) mass += 3 * M->value[M->start[c]];
    return -1e-6 * stiffness / mass;
}

static Lanczos lanczos_create(int size, int wanted, int free)
{
    int vectors = 2 * wanted + 10 < free ? 2 * wanted + 10 : free;
    Lanczos l = {.size = size, .wanted = wanted, .vectors = vectors};
    l.work_size = vectors * (vectors + 8);
    l.residual = sm_alloc((size_t)size, sizeof(double));
    l.basis = sm_alloc((size_t)size * (size_t)vectors, sizeof(double));
    l.work = sm_alloc(3 * (size_t)size, sizeof(double));
    l.far_work = sm_alloc((size_t)l.work_size, sizeof(double));
    l.param[0] = 1; /* exact shifts */
    l.param[2] = MOST_RESTARTS;
    l.param[6] = 3; /* shift and invert */
    /* a start that has a share of every mode, the same each time */
    unsigned state = 1;
    for (int n = 0; n < size; n++) {
        state = state * 1664525U + 1013904223U;
        l.residual[n] = state / 4294967296.0 - 0.5;
    }
    return l;
}

static void lanczos_free(Lanczos *l)
{
    sm_free_all(l->residual, l->basis, l->work, l->far_work);
}

/* Answers ARPACK's requests until it is done; returns its info. */
static int iterate(const RefMatrices *matrices, RefSolver *solver, Lanczos *l)
{
    int ask = 0, info = 1;
    double *product = sm_alloc((size_t)l->size, sizeof *product);
    for (;;) {
        dsaupd_c(&ask, "G", l->size, "LM", l->wanted, 0, l->residual, l->vectors, l->basis, l->size,
                 l->param, l->pointer, l->work, l->far_work, l->work_size, &info);
        double *x = l->work + l->pointer[0] - 1, *y = l->work + l->pointer[1] - 1;
        if (ask == -1) {
            ref_sparse_apply(&matrices->mass, 3, x, product);
            ref_solver_solve(solver, product, NULL, y);
        } else if (ask == 1) { /* M x is there already */
            ref_solver_solve(solver, l->work + l->pointer[2] - 1, NULL, y);
        } else if (ask == 2) {
            ref_sparse_apply(&matrices->mass, 3, x, y);
        } else {
            break;
        }
    }
    free(product);
    return info;
}

/* Eigenvalues and vectors out of the basis, which they replace. ARPACK has them falling in
 * 1 / (lambda - sigma) or rising: they are sorted by lambda here. */
static int extract(Lanczos *l, double shift, RefModes *modes)
{
    int info = 0, count = l->wanted;
    int *select = sm_alloc((size_t)l->vectors, sizeof *select);
    double *value = sm_alloc((size_t)count, sizeof *value);
    dseupd_c(1, "A", select, value, l->basis, l->size, shift, "G", l->size, "LM", count, 0,
             l->residual, l->vectors, l->basis, l->size, l->param, l->pointer, l->work, l->far_work,
             l->work_size, &info);
    for (int k = 0; info == 0 && k < count; k++) {
        int place = 0;
        for (int j = 0; j < count; j++)
            place += value[j] < value[k] || (value[j] == value[k] && j < k);
        modes->lambda[place] = value[k];
        for (int n = 0; n < l->size; n++)
            modes->shape[(size_t)n * (size_t)count + (size_t)place] =
                l->basis[(size_t)k * (size_t)l->size + (size_t)n];
    }
    free(select);
    free(value);
    return info;
}

SmCode ref_modes_of(const RefMatrices *matrices, RefSolver *solver, double shift, int count,
                    RefModes *modes, SmError *error)
{
    int size = matrices->stiffness.columns, left = size - ref_solver_rank(solver);
    *modes = (RefModes){0};
    if (count < 1 || count > left / 2)
        return sm_fail(error, SM_USAGE,
                       "%d modes of a body that has %d: give a number from 1 to %d", count, left,
                       left / 2);
    Lanczos lanczos = lanczos_create(size, count, left);
    modes->nodes = matrices->mass.columns;
    modes->count = count;
    modes->lambda = sm_alloc((size_t)count, sizeof *modes->lambda);
    modes->shape = sm_alloc((size_t)size * (size_t)count, sizeof *modes->shape);
    int threads = ref_blas_alone(), info = iterate(matrices, solver, &lanczos);
    if (info == 0) info = extract(&lanczos, shift, modes);
    ref_blas_again(threads);
    lanczos_free(&lanczos);
    if (info == 0) return SM_OK;
    ref_modes_free(modes);
    return sm_fail(error, SM_INPUT,
                   "the search for %d modes did not converge (ARPACK's code %d): ask for others",
                   count, info);
}

SmCode ref_modes_find(const RefMatrices *matrices, const RefRows *rows, int count, RefModes *modes,
                      SmError *error)
{
    RefSolver *solver;
    double shift = ref_modes_shift(matrices);
    *modes = (RefModes){0};
    SmCode code = ref_solver_create(matrices, shift, rows, &solver, error);
    if (code != SM_OK) return code;
    code = ref_modes_of(matrices, solver, shift, count, modes, error);
    ref_solver_destroy(solver);
    return code;
}
