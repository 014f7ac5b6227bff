/* fit.h - how a group of nodes moves, as one affine motion: least squares over their masses
 * (Mueller et al. 2005), and where the nodes span less than space the rigid motion beyond. */
#ifndef OCT_FIT_H
#define OCT_FIT_H

/* Sums of masses, and their moments, about any place. Begins zeroed. */
typedef struct {
    double mass, X[3], x[3], v[3];
    double XX[9], xX[9], vX[9];
} OctFit;

/* Adds a node of rest position X, position x and velocity v. They should be small: the moments
 * about the centre of mass are differences. */
void oct_fit_add(OctFit *fit, double mass, const double X[3], const double x[3], const double v[3]);

/* The gradients F = dx/dX and L = dv/dX, row-major. A direction is spanned if the nodes are farther
 * than `least` apart there, as a root of mean squares: carried from the middle as far as that, what
 * they say is as good as their positions. Exact for affine motions where the nodes span space and
 * for rigid ones where they span a plane. On a line the turn about it is that of `last`, and the
 * velocity without one; of a single node F is `last`, and L is 0. Returns the dimensions that they
 * span. About a microsecond. */
int oct_fit_solve(const OctFit *fit, double least, const double last[9], double F[9], double L[9]);

#endif
