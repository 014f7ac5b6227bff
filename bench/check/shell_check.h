/* shell_check.h - is the shell right that is timed? By what must hold whichever way its matrices,
 * motion and points were computed; the findings are those of elastic_check.h that shells have. */
#ifndef BENCH_SHELL_CHECK_H
#define BENCH_SHELL_CHECK_H

#include "../../reference/meshless/shell_engine.h"
#include "elastic_check.h"

/* What stays while it moves: at vertices spread over the mesh shape functions are defined and sum
 * up to 1, their slopes, in cells, to 0; the mass is that of density, thickness and area; rigid
 * motions cost nothing; and small displacements are the surface's. */
void bench_shell_check_body(const RefShellBody *body, BenchElasticFound *found);

/* The present state of a runner, which is as it was afterwards: a step's residual in the equation
 * of motion, holds after it, points from shape functions computed anew, and whether energy grows
 * without forces and holds. Of a shell that does not break. */
void bench_shell_check_state(BenchRunner *runner, BenchElasticFound *found);

/* One that has cracks, in the end: functions where there are any sum up to 1 and their slopes to 0;
 * rigid motions cost nothing; energy does not grow without forces; and the carried points are where
 * functions that are found anew have them. */
void bench_shell_check_broken(const RefShellBody *body, BenchElasticFound *found);

#endif
