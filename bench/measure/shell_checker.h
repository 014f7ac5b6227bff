/* shell_checker.h - a shell's row of `tables`: what is its own, how it is checked, and how it is
 * told to people. */
#ifndef BENCH_SHELL_CHECKER_H
#define BENCH_SHELL_CHECKER_H

#include <stdio.h>

#include "checker.h"

/* Nodes, and what was built in how long; what only shape matching has is NaN and 0. */
void bench_shell_row_fill(const BenchRunner *runner, BenchRow *row);

/* By what must hold (shell_check.h). Refuses what the check of other meshless bodies refuses. */
extern const BenchChecker bench_shell_checker;

/* On standard output: what carries it, and its material. */
void bench_shell_row_describe(const BenchRunner *runner, const SmCounts *counts);

/* What the shell is made of, behind the line of its check. */
void bench_shell_row_explain(FILE *file, const BenchRow *row);

#endif
