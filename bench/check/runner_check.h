/* runner_check.h - is the present state of a runner right: all checks together. */
#ifndef BENCH_RUNNER_CHECK_H
#define BENCH_RUNNER_CHECK_H

#include "check.h"

/* Goals, damping, contacts, obstacles and momentum of the runner's present state. */
BenchDeviation bench_check_find(const BenchCheck *check, const BenchRunner *runner);

/* The same, and whether all are within their tolerances; `reason` says what is not. */
bool bench_check_all(const BenchCheck *check, const BenchRunner *runner, BenchDeviation *found,
                     size_t size, char *reason);

/* The same, motion, and that what handles hold is where they hold it (the runner has stepped, or
 * nothing is held): of what is measured without a row. The state does not change. Where regions
 * have more than BENCH_MOST_MEMBERS, goals are held to momentum alone. False, and `reason` says so.
 */
bool bench_check_runner(const BenchRunner *runner, size_t size, char *reason);

#endif
