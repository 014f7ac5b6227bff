/* elastic_checker.h - a meshless body's row of `tables`: what is its own, how it is checked, and
 * how it is told to people. What is timed is a frame as ref_meshless_frames has it. */
#ifndef BENCH_ELASTIC_CHECKER_H
#define BENCH_ELASTIC_CHECKER_H

#include <stdio.h>

#include "checker.h"

/* Nodes, modes and what was built in how long; what only shape matching has is NaN and 0. */
void bench_elastic_row_fill(const BenchRunner *runner, BenchRow *row);

/* By what must hold (elastic_check.h). Refuses obstacles, collisions, forces, cuts, touches, an
 * eye, several instances, an initial deformation, and handles that bind the same point. */
extern const BenchChecker bench_elastic_checker;

/* Its `takes`, of shells, too. */
SmCode bench_elastic_takes(const BenchScene *scene, SmError *error);

/* Notes in the row what was found, and makes it invalid where that is too much. */
void bench_elastic_row_note(const BenchElasticFound *found, BenchRow *row);

/* Whether the row is a meshless body's, solid or a shell. */
bool bench_row_of_elastic(const BenchRow *row);

/* On standard output: what carries it, and its material. */
void bench_elastic_row_describe(const BenchRunner *runner, const SmCounts *counts);

/* What the body is made of, behind the line of its check. */
void bench_elastic_row_explain(FILE *file, const BenchRow *row);

#endif
