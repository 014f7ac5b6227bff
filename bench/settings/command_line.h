/* command_line.h - what a command takes on its command line, from tables of settings (setting.h),
 * by argp.
 *
 * A mistake ends the program with one line on standard error and exit code 2. */
#ifndef BENCH_COMMAND_LINE_H
#define BENCH_COMMAND_LINE_H

#include <argp.h>

#include "setting.h"

/* Options that several commands have: the first member of every command's record. */
typedef struct {
    int threads; /* 1 or more */
    unsigned long seed;
    bool quiet;
    BenchNames isas;   /* instruction sets to measure with, one after the other: with `--isa all`
                        * all that this processor has, else the one in use */
    bool measuring;    /* was an option given that says what to measure? */
    const char **word; /* [words] arguments that are no options; freed with the record */
    int words;
} BenchCommon;

/* What of BenchCommon a command takes; the rest has its defaults. */
enum { BENCH_TAKES_QUIET = 1, BENCH_TAKES_THREADS = 2, BENCH_TAKES_SEED = 4, BENCH_TAKES_ALL = 7 };
enum { BENCH_TAKES_SETS = 8 }; /* `--isa all` */

typedef struct {
    const BenchSetting *settings; /* of its record */
    unsigned takes;               /* BENCH_TAKES_... */
    const char *arguments;        /* "[FILE.h5]"; NULL: it has none */
    const char *help;             /* as argp's: before the options, \v, behind them */
    /* Refuses what does not go together, when all options are read; NULL: everything does. */
    void (*check)(const struct argp_state *state, void *record);
    int most;          /* how many arguments there may be that are no options; -1: any */
    const char *limit; /* what is said of one more: "One file is shown at a time" */
} BenchCommandLine;

/* Reads a command's options into its record, whose defaults are set, and the common ones. Usage
 * errors end the program. argv[0] is the program and command ("shapebench run"). */
void bench_options_parse(const BenchCommandLine *line, int argc, char **argv, void *record);

/* argp_parse(), but what getopt finds wrong (an unknown option, a missing value) is one line like
 * all others, and ends the program with exit code 2. */
void bench_option_words(const struct argp *argp, int argc, char **argv, unsigned flags, int *first,
                        void *input);

/* "sse2 avx2 (in use) avx512 (not of this processor)": the kernels' (lib/isa.h). */
void bench_print_isas(FILE *file);

/* Prints "program command: line", of SM_USAGE with where to look it up. */
void bench_option_fail(const char *name, const SmError *error);

/* Prints "program command: line; see ... --help" and ends the program with exit code 2. */
void bench_usage(const struct argp_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3), noreturn));

#endif
