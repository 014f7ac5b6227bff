/* shell_check.h - is the shell right that is timed? By what must hold whichever way its matrices,
 * motion and points were computed; the findings are those of elastic_check.h that shells have. */
#ifndef BENCH_SHELL_CHECK_H
#define BENCH_SHELL_CHECK_H

#include "../../reference/meshless/shell_engine.h"
#include "elastic_check.h"

/* What stays while it moves: shape functions and their slopes, in cells, and that no integration
 * point has fewer covers than the basis has terms; the mass from density, thickness and area; and
 * what rigid motions cost. */
void bench_shell_check_body(const RefShellBody *body, BenchElasticFound *found);

/* The present state of a runner, which is as it was afterwards: small displacements, a step's
 * residual in the equation of motion, holds after it, points from shape functions computed anew,
 * and whether energy grows without forces and holds. */
void bench_shell_check_state(BenchRunner *runner, BenchElasticFound *found);

#endif
