/* solver.h - solves with stiffness under linear constraints, by CHOLMOD. */
#ifndef REF_SOLVER_H
#define REF_SOLVER_H

#include "../body/matrices.h"
#include "../body/mls.h"

typedef struct RefSolver RefSolver;

/* Whether this program was built with CHOLMOD and ARPACK; where it was not, this module and modes.h
 * fail with SM_USAGE and a line that names the packages. */
extern const bool ref_solver_built;

/* Factorises K - shift M, shift at most 0, under `rows` (NULL: none). To a K that rigid motions
 * make singular, A^T A times a stiffness is added, which changes no solution: rows that hold the
 * body make it definite. Rows that follow from others are dropped. The solver keeps no pointer to
 * its arguments. Errors (SM_INPUT): the matrix is singular. */
SmCode ref_solver_create(const RefMatrices *matrices, double shift, const RefRows *rows,
                         RefSolver **solver, SmError *error);

/* The same in the order of `like`, which takes no time to be found; neither has rows. The matrix
 * has its entries where that of `like` has them, and both or neither of these masses say where; or
 * `like` is of the nodes of which the matrix has three parameters each, and no mass. */
SmCode ref_solver_create_like(const RefSolver *like, const RefMatrices *matrices, double shift,
                              RefSolver **solver, SmError *error);
void ref_solver_destroy(RefSolver *solver);

/* x: (K - shift M) x = b - A^T multipliers, A x = target. `b` and `target` may be NULL: zero. */
void ref_solver_solve(RefSolver *solver, const double *b, const double *target, double *x);

/* The same for `count` right sides at once, which reads the factor once: b and x are [count][size],
 * target [count][rows]; to rounding what each alone would have. The first solve for one right side
 * allocates, and the first for each other `count` than the last above 1. */
void ref_solver_solve_several(RefSolver *solver, int count, const double *b, const double *target,
                              double *x);

/* Rows that count: those that do not follow from others. */
int ref_solver_rank(const RefSolver *solver);

#endif
