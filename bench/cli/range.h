/* range.h - numbers as an option gives them: "3", "1:8", "0:1:0.1", or several of these, "1:3,6,9".
 */
#ifndef BENCH_RANGE_H
#define BENCH_RANGE_H

#include "../../lib/error.h"

/* FIRST:LAST:STEP, step 1 where it is left out; LAST belongs to it where a step falls on it. Writes
 * the numbers to `value`, which has room for `most`, rounded to 1e-9. They must rise and lie in
 * low..high. SM_USAGE: what is wrong, after the option's name ("--w"). */
SmCode bench_range_parse(const char *name, const char *text, double low, double high, int most,
                         double *value, int *count, SmError *error);

#endif
