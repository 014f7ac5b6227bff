/* option.h - option values as text, checked; and the options that every command has.
 *
 * A value that is not what the option takes ends the program with one line on standard error and
 * exit code 2. `name` is the option's name as typed ("--w"). */
#ifndef BENCH_OPTION_H
#define BENCH_OPTION_H

#include <argp.h>
#include <stdbool.h>

#include "../lib/error.h"

/* Options that every command has; the input of bench_common_argp. */
typedef struct {
    int threads; /* 1 or more */
    unsigned long seed;
    bool quiet;
} BenchCommon;

extern const struct argp bench_common_argp;

/* --layout: words in SmLayout's order, and the help of commands that run a scene. */
extern const char *const bench_layouts[];
#define BENCH_LAYOUT_HELP "Fastlsm's sums: auto, lists, or blocks where it can"

/* argp_parse() for a command: `argp` has bench_common_argp as its first child, `input` begins
 * with a BenchCommon. Usage errors end the program: one line, exit code 2. argv[0] is the program
 * and command ("shapebench run"). */
void bench_options_parse(const struct argp *argp, int argc, char **argv, void *input);

/* Call for ARGP_KEY_INIT in a command's parser: hands the BenchCommon on to the child parser. */
void bench_options_init(struct argp_state *state, BenchCommon *common);

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
