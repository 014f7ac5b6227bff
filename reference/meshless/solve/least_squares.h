/* least_squares.h - small least-squares problems by their normal equations N a = b. */
#ifndef REF_LEAST_SQUARES_H
#define REF_LEAST_SQUARES_H

/* Adds weight * (row . a - value)^2: to N, [terms][terms], and b, which begin zeroed. */
void ref_least_squares_add(int terms, const double *row, double value, double weight, double *N,
                           double *b);

/* Replaces b by the solution, and N by its factors. A little pull to zero makes few rows, or such
 * that say the same, harmless; more of it on the first `curved` unknowns, a local shape's quadratic
 * ones. All zeros where the rows are not finite. */
void ref_least_squares_solve(int terms, int curved, double *N, double *b);

#endif
