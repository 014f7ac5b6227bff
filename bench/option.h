/* option.h - option values as text, checked; and the options that every command has.
 *
 * A value that is not what the option takes ends the program with one line on standard error and
 * exit code 2. `name` is the option's name as typed ("--w"). */
#ifndef BENCH_OPTION_H
#define BENCH_OPTION_H

#include <argp.h>
#include <stdbool.h>

#include "../lib/error.h"

/* Options that every command has. */
typedef struct {
    int threads; /* 1 or more */
    unsigned long seed;
    bool quiet;
} BenchCommon;

/* Choices of --precision, and of --layout in SmLayout's order with its help. */
extern const char *const bench_precisions[];
extern const char *const bench_layouts[];
#define BENCH_LAYOUT_HELP "Fastlsm's sums: auto, lists, or blocks where it can"

/* argp_parse() for a command: its own options `argp` into `input`, whose defaults are set, and
 * beside them those that every command has. Usage errors end the program: one line, exit code 2.
 * argv[0] is the program and command ("shapebench run"). */
void bench_options_parse(const struct argp *argp, int argc, char **argv, void *input,
                         BenchCommon *common);

/* Prints "program command: line" and ends the program with exit code 2. */
void bench_usage(const struct argp_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3), noreturn));

long bench_option_long(const struct argp_state *state, const char *name, const char *text, long low,
                       long high);
double bench_option_real(const struct argp_state *state, const char *name, const char *text,
                         double low, double high);
/* "x,y,z" */
void bench_option_vector(const struct argp_state *state, const char *name, const char *text,
                         double value[3]);
/* Place of `text` in the NULL-terminated list `choices`. */
int bench_option_choice(const struct argp_state *state, const char *name, const char *text,
                        const char *const *choices);

#endif
