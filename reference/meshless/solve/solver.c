#include "solver.h"

#include <assert.h>
#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "blas.h"
#include "node_order.h"
#include "semidefinite.h"

const bool ref_solver_built = true;

struct RefSolver {
    cholmod_common common;
    cholmod_factor *factor, *symbolic;     /* the second has an order and places of entries alone */
    cholmod_dense *result[2], *work[2][2]; /* of solves for one right side and for several */
    int size, rows, rank;
    int *place;     /* [nodes] in the order in which the matrix is factorised, or NULL: as given */
    double *placed; /* right sides in that order */
    long placed_room;
    RefRows A;
    double *response; /* [rows][size] K'^-1 A^T, row by row */
    double *S;        /* [rows][rows] of A K'^-1 A^T, and its `order` (semidefinite.h) */
    int *order;       /* [rows]; the first `rank` count */
    double *y;        /* [rows] of a solve */
};

static void row_of(const RefRows *rows, long row, double *dense)
{
    for (long e = rows->start[row]; e < rows->start[row + 1]; e++)
        dense[rows->column[e]] += rows->value[e];
}

/* K - shift M as CHOLMOD has it, with M spread over the three axes. */
static cholmod_sparse *shifted(const RefMatrices *matrices, double shift, cholmod_common *common)
{
    const RefSparse *K = &matrices->stiffness, *M = &matrices->mass;
    size_t size = (size_t)K->columns, entries = (size_t)K->start[size];
    cholmod_sparse *matrix =
        cholmod_allocate_sparse(size, size, entries, 1, 1, -1, CHOLMOD_REAL, common);
    if (!matrix) return NULL;
    memcpy(matrix->p, K->start, (size + 1) * sizeof(int));
    memcpy(matrix->i, K->row, entries * sizeof(int));
    memcpy(matrix->x, K->value, entries * sizeof(double));
    double *value = matrix->x;
    for (int i = 0; shift != 0 && i < M->columns; i++)
        for (int a = 0; a < 3; a++) {
            int at = K->start[3 * i + a];
            for (int e = M->start[i]; e < M->start[i + 1]; e++) {
                while (K->row[at] != 3 * M->row[e] + a) at++;
                value[at] -= shift * M->value[e];
            }
        }
    return matrix;
}

/* matrix + A^T A times a typical stiffness. */
static cholmod_sparse *held(cholmod_sparse *matrix, const RefMatrices *matrices, const RefRows *A,
                            cholmod_common *common)
{
    const RefSparse *K = &matrices->stiffness;
    size_t entries = (size_t)A->start[A->count];
    double trace = 0, squares = 0, one[2] = {1, 0};
    for (int c = 0; c < K->columns; c++) trace += K->value[K->start[c]];
    for (size_t e = 0; e < entries; e++) squares += A->value[e] * A->value[e];
    double weight[2] = {trace / K->columns / (squares / (double)A->count), 0};
    cholmod_sparse *At = cholmod_allocate_sparse((size_t)K->columns, (size_t)A->count, entries, 0,
                                                 1, 0, CHOLMOD_REAL, common);
    if (!At) {
        cholmod_free_sparse(&matrix, common);
        return NULL;
    }
    for (long r = 0; r <= A->count; r++) ((int *)At->p)[r] = (int)A->start[r];
    memcpy(At->i, A->column, entries * sizeof(int));
    memcpy(At->x, A->value, entries * sizeof(double));
    cholmod_sparse *product = cholmod_aat(At, NULL, 0, 1, common);
    /* SuiteSparse 7's cholmod_copy(product, -1, ...) is empty where size_t has 32 bits (page) */
    cholmod_sparse *lower = cholmod_band(product, -K->columns, 0, 1, common);
    if (lower) lower->stype = -1;
    cholmod_sparse *sum = cholmod_add(matrix, lower, one, weight, 1, 1, common);
    cholmod_free_sparse(&At, common);
    cholmod_free_sparse(&product, common);
    cholmod_free_sparse(&lower, common);
    cholmod_free_sparse(&matrix, common);
    return sum;
}

/* Columns of the nodes' parameters into the order of the factor, or back. */
static void reorder(const RefSolver *solver, int count, bool back, const double *from, double *to)
{
    int size = solver->size;
    for (int c = 0; c < count; c++, from += size, to += size)
        for (int n = 0; n < size; n++) {
            int at = 3 * solver->place[n / 3] + n % 3;
            to[back ? n : at] = from[back ? at : n];
        }
}

static void solve_free(RefSolver *solver, int count, const double *b, double *x)
{
    size_t size = (size_t)solver->size, columns = (size_t)count;
    int several = count > 1;
    if (solver->place) {
        sm_make_room(solver->placed, solver->placed_room, (long)(columns * size));
        reorder(solver, count, false, b, solver->placed);
    }
    cholmod_dense right = {.nrow = size,
                           .ncol = columns,
                           .nzmax = columns * size,
                           .d = size,
                           .x = solver->place ? solver->placed : (double *)b,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    int threads = ref_blas_alone();
#pragma omp teams num_teams(1) thread_limit(1)
    cholmod_solve2(CHOLMOD_A, solver->factor, &right, NULL, &solver->result[several], NULL,
                   &solver->work[several][0], &solver->work[several][1], &solver->common);
    ref_blas_again(threads);
    if (solver->place)
        reorder(solver, count, true, solver->result[several]->x, x);
    else
        memcpy(x, solver->result[several]->x, columns * size * sizeof *x);
}

/* What the rows' multipliers do, and the Schur complement with its independent rows. */
static void complement(RefSolver *solver)
{
    size_t rows = (size_t)solver->rows, size = (size_t)solver->size;
    double *dense = sm_alloc(size, sizeof *dense), largest = 0;
    solver->response = sm_alloc(rows * size, sizeof *solver->response);
    solver->S = sm_alloc(rows * rows, sizeof *solver->S);
    solver->order = sm_alloc(rows, sizeof *solver->order);
    solver->y = sm_alloc(rows, sizeof *solver->y);
    for (size_t r = 0; r < rows; r++) {
        memset(dense, 0, size * sizeof *dense);
        row_of(&solver->A, (long)r, dense);
        solve_free(solver, 1, dense, solver->response + r * size);
    }
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < rows; c++)
            solver->S[r * rows + c] =
                ref_rows_apply(&solver->A, (long)c, solver->response + r * size);
    for (size_t r = 0; r < rows; r++) largest = fmax(largest, solver->S[r * rows + r]);
    solver->rank = ref_semidefinite(solver->rows, solver->S, 1e-10 * largest, solver->order);
    free(dense);
}

/* On one thread, as all else here: CHOLMOD itself asks for four, whatever OpenMP's number is. */
static void factorise(cholmod_sparse *matrix, RefSolver *solver)
{
    int threads = ref_blas_alone();
#pragma omp teams num_teams(1) thread_limit(1)
    cholmod_factorize(matrix, solver->factor, &solver->common);
    ref_blas_again(threads);
}

/* In the order of the nodes, whatever rows add between them: CHOLMOD finds none with so little fill
 * from the parameters. */
static cholmod_factor *analyse_by_nodes(cholmod_sparse *matrix, const RefSparse *mass,
                                        cholmod_common *common)
{
    int *place = ref_node_order(mass, common);
    if (!place) return NULL;
    int *order = sm_alloc(matrix->ncol, sizeof *order);
    for (int n = 0; n < (int)matrix->ncol; n++) order[3 * place[n / 3] + n % 3] = n;
    common->method[0].ordering = CHOLMOD_GIVEN;
    cholmod_factor *symbolic = cholmod_analyze_p(matrix, order, NULL, 0, common);
    sm_free_all(place, order);
    return symbolic;
}

/* The places of three parameters a node from those of one, in the order of the nodes, which CHOLMOD
 * would find again: supernodes, their rows and all counts are three times as many. */
static cholmod_factor *triple(const cholmod_factor *nodes, cholmod_common *common)
{
    size_t supers = nodes->nsuper + 1;
    cholmod_factor *all = cholmod_allocate_factor(3 * nodes->n, common);
    if (!all) return NULL;
    all->is_super = all->is_ll = true;
    all->ordering = CHOLMOD_NATURAL;
    all->nsuper = nodes->nsuper;
    all->ssize = 3 * nodes->ssize;
    all->xsize = 9 * nodes->xsize;
    all->maxcsize = 9 * nodes->maxcsize;
    all->maxesize = 3 * nodes->maxesize;
    all->super = cholmod_malloc(supers, sizeof(int), common);
    all->pi = cholmod_malloc(supers, sizeof(int), common);
    all->px = cholmod_malloc(supers, sizeof(int), common);
    all->s = cholmod_malloc(all->ssize, sizeof(int), common);
    if (common->status != CHOLMOD_OK) {
        cholmod_free_factor(&all, common);
        return NULL;
    }
    for (size_t n = 0; n < supers; n++) {
        ((int *)all->super)[n] = 3 * ((int *)nodes->super)[n];
        ((int *)all->pi)[n] = 3 * ((int *)nodes->pi)[n];
        ((int *)all->px)[n] = 9 * ((int *)nodes->px)[n];
    }
    for (size_t e = 0; e < all->ssize; e++)
        ((int *)all->s)[e] = 3 * ((int *)nodes->s)[e / 3] + (int)(e % 3);
    for (size_t c = 0; c < all->n; c++)
        ((int *)all->ColCount)[c] = 3 * ((int *)nodes->ColCount)[c / 3] - (int)(c % 3);
    return all;
}

/* The order and the places of a factor's entries: those of another solver; of nodes' parameters the
 * order of the nodes, in which the matrix may be; of others as CHOLMOD finds best. */
static cholmod_factor *analyse(const RefSolver *like, const RefMatrices *matrices,
                               cholmod_sparse *matrix, RefSolver *solver)
{
    cholmod_common *common = &solver->common;
    if (like && like->size == solver->size) return cholmod_copy_factor(like->symbolic, common);
    if (like && like->symbolic->is_super) return triple(like->symbolic, common);
    if (solver->place) {
        common->nmethods = 1;
        common->method[0].ordering = CHOLMOD_NATURAL;
        common->postorder = false;
        for (int k = 0; k < 3; k++) common->nrelax[k] *= 3; /* columns: a node has three */
    } else if (ref_node_order_fits(matrices))
        return analyse_by_nodes(matrix, &matrices->mass, common);
    return cholmod_analyze(matrix, common);
}

/* The places that another solver gives its nodes. */
static int *places_of(const RefSolver *like)
{
    size_t size = (size_t)like->size;
    if (like->place) return sm_copy(like->place, size / 3, sizeof *like->place);
    int *place = sm_alloc(size, sizeof *place);
    for (size_t n = 0; n < size; n++) place[((int *)like->symbolic->Perm)[n]] = (int)n;
    return place;
}

/* The matrix as it is factorised, and the places of its nodes, if they have any. */
static cholmod_sparse *arrange(const RefSolver *like, const RefMatrices *matrices, double shift,
                               RefSolver *solver)
{
    cholmod_common *common = &solver->common;
    if (solver->rows || !ref_node_order_fits(matrices)) {
        cholmod_sparse *matrix = shifted(matrices, shift, common);
        return matrix && solver->rows ? held(matrix, matrices, &solver->A, common) : matrix;
    }
    solver->place = like ? places_of(like) : ref_node_order(&matrices->mass, common);
    return solver->place ? ref_node_ordered(matrices, shift, solver->place, common) : NULL;
}

static SmCode say_failure(int status, int columns, SmError *error)
{
    if (status == CHOLMOD_OUT_OF_MEMORY || status == CHOLMOD_TOO_LARGE)
        return sm_fail(error, SM_INPUT,
                       "a stiffness of %d columns is too large to be factorised: give the body "
                       "fewer nodes",
                       columns);
    return sm_fail(error, SM_INPUT,
                   "the stiffness matrix is singular: the body is not held, or parts of it hang "
                   "together by too few nodes; hold it, or give it more nodes");
}

/* In the order of another one, if there is one. */
static SmCode create(const RefSolver *like, const RefMatrices *matrices, double shift,
                     const RefRows *rows, RefSolver **result, SmError *error)
{
    RefSolver *solver = sm_alloc(1, sizeof *solver);
    cholmod_common *common = &solver->common;
    cholmod_start(common);
    common->print = 0;
    solver->size = matrices->stiffness.columns;
    if (rows) solver->A = ref_rows_copy(rows);
    solver->rows = (int)solver->A.count;
    cholmod_sparse *matrix = arrange(like, matrices, shift, solver);
    if (matrix) solver->symbolic = analyse(like, matrices, matrix, solver);
    if (solver->symbolic) solver->factor = cholmod_copy_factor(solver->symbolic, common);
    if (solver->factor) factorise(matrix, solver);
    cholmod_free_sparse(&matrix, common);
    int status = common->status;
    double condition = status == CHOLMOD_OK ? cholmod_rcond(solver->factor, common) : 0;
    if (condition > 1e-14) {
        if (solver->rows) complement(solver);
        *result = solver;
        return SM_OK;
    }
    ref_solver_destroy(solver);
    return say_failure(status, matrices->stiffness.columns, error);
}

SmCode ref_solver_create(const RefMatrices *matrices, double shift, const RefRows *rows,
                         RefSolver **solver, SmError *error)
{
    return create(NULL, matrices, shift, rows, solver, error);
}

SmCode ref_solver_create_like(const RefSolver *like, const RefMatrices *matrices, double shift,
                              RefSolver **solver, SmError *error)
{
    int size = matrices->stiffness.columns;
    bool same = like->size == size, placed = like->place != NULL;
    assert(!like->rows && (same || 3 * like->size == size));
    assert(same ? placed == ref_node_order_fits(matrices) : !placed);
    return create(like, matrices, shift, NULL, solver, error);
}

void ref_solver_destroy(RefSolver *solver)
{
    if (!solver) return;
    cholmod_free_factor(&solver->factor, &solver->common);
    cholmod_free_factor(&solver->symbolic, &solver->common);
    for (int of = 0; of < 2; of++) {
        cholmod_free_dense(&solver->result[of], &solver->common);
        for (int k = 0; k < 2; k++) cholmod_free_dense(&solver->work[of][k], &solver->common);
    }
    cholmod_finish(&solver->common);
    ref_rows_free(&solver->A);
    sm_free_all(solver->place, solver->placed, solver->response, solver->S, solver->order,
                solver->y, solver);
}

/* y = S^-1 y over the rows that count, in their order. */
static void solve_complement(const RefSolver *solver, double *y)
{
    size_t rows = (size_t)solver->rows;
    for (int i = 0; i < solver->rank; i++) { /* the lower half, column by column */
        for (int k = 0; k < i; k++) y[i] -= solver->S[(size_t)k * rows + (size_t)i] * y[k];
        y[i] /= solver->S[(size_t)i * rows + (size_t)i];
    }
    for (int i = solver->rank - 1; i >= 0; i--) {
        for (int k = i + 1; k < solver->rank; k++)
            y[i] -= solver->S[(size_t)i * rows + (size_t)k] * y[k];
        y[i] /= solver->S[(size_t)i * rows + (size_t)i];
    }
}

/* Moves a solution of the free body to where the rows want it. */
static void bind(const RefSolver *solver, const double *target, double *x)
{
    size_t size = (size_t)solver->size;
    double *y = solver->y;
    for (int i = 0; i < solver->rank; i++) {
        int row = solver->order[i];
        y[i] = ref_rows_apply(&solver->A, row, x) - (target ? target[row] : 0);
    }
    solve_complement(solver, y);
    for (int i = 0; i < solver->rank; i++) {
        const double *response = solver->response + (size_t)solver->order[i] * size;
        for (size_t n = 0; n < size; n++) x[n] -= y[i] * response[n];
    }
}

void ref_solver_solve_several(RefSolver *solver, int count, const double *b, const double *target,
                              double *x)
{
    size_t size = (size_t)solver->size, rows = (size_t)solver->rows;
    if (b)
        solve_free(solver, count, b, x);
    else
        memset(x, 0, (size_t)count * size * sizeof *x);
    for (size_t c = 0; c < (size_t)count && solver->rank; c++)
        bind(solver, target ? target + c * rows : NULL, x + c * size);
}

void ref_solver_solve(RefSolver *solver, const double *b, const double *target, double *x)
{
    ref_solver_solve_several(solver, 1, b, target, x);
}

int ref_solver_rank(const RefSolver *solver)
{
    return solver->rank;
}
