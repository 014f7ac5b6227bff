/* option.h - option values as text, checked; and the options that several commands have.
 *
 * A value that is not what the option takes ends the program with one line on standard error and
 * exit code 2. `name` is the option's name as typed ("--w"). */
#ifndef BENCH_OPTION_H
#define BENCH_OPTION_H

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>

#include "../../lib/error.h"

/* Options that several commands have. */
typedef struct {
    int threads; /* 1 or more */
    unsigned long seed;
    bool quiet;
} BenchCommon;

/* Choices of --precision, and of --layout in SmLayout's order with its help. */
extern const char *const bench_precisions[];
extern const char *const bench_widths[]; /* units of an octree's w: "edges", "cells" */
extern const char *const bench_layouts[];
extern const char *const bench_papers[]; /* that have tables */
#define BENCH_LAYOUT_HELP "Fastlsm's sums: auto, lists, or blocks where it can"

/* What an option does with its value in the command's record. */
typedef enum {
    BENCH_TO_TEXT,   /* const char *: the value itself */
    BENCH_TO_NAMES,  /* BenchNames: one more of them */
    BENCH_TO_TRUE,   /* bool: no value, sets it */
    BENCH_TO_INT,    /* int, a whole number from `low` to `high` */
    BENCH_TO_LONG,   /* long, likewise */
    BENCH_TO_REAL,   /* double, from `low` to `high` */
    BENCH_TO_CHOICE, /* int or enum: its place in `choices` */
} BenchTarget;

/* Values of an option that may be repeated. */
enum { BENCH_NAMES = 64 };
typedef struct {
    const char *name[BENCH_NAMES];
    int count;
} BenchNames;

/* An option that does no more than that. */
typedef struct {
    int key;
    BenchTarget target;
    size_t offset; /* of the member */
    double low, high;
    const char *const *choices;
} BenchOption;

/* Target and offset of a member of the command's record, which its file calls Options. */
#define BENCH_TO(target, member) BENCH_TO_##target, offsetof(Options, member)

/* What every command that writes a file has: in its options, and in what they do with a bool
 * `overwrite` (bench_draft_reserve()). */
enum { BENCH_KEY_OVERWRITE = 0x3000 };
#define BENCH_OVERWRITE_OPTION(group)                                                              \
    {                                                                                              \
        "overwrite", BENCH_KEY_OVERWRITE, 0, 0, "Replace a file that is there (default: refuse)",  \
            group                                                                                  \
    }
#define BENCH_OVERWRITE_TAKEN                                                                      \
    {                                                                                              \
        BENCH_KEY_OVERWRITE, BENCH_TO(TRUE, overwrite), 0, 0, NULL                                 \
    }

/* What every campaign (campaign_run.h) has, whose Options have a BenchCampaignRun `run`. */
enum { BENCH_KEY_SHARD = 0x3100, BENCH_KEY_RESUME };
#define BENCH_CAMPAIGN_OPTIONS(point, group)                                                       \
    {"shard",                                                                                      \
     BENCH_KEY_SHARD,                                                                              \
     "I/N|auto",                                                                                   \
     0,                                                                                            \
     "Measure only every N-th " point ", from the I-th on; auto: those of a task of a Slurm job "  \
     "array (SLURM_ARRAY_TASK_ID and _COUNT); put the files together with 'merge'",                \
     group},                                                                                       \
    {                                                                                              \
        "resume", BENCH_KEY_RESUME, 0, 0, "Go on with FILE.h5 if it is there", group               \
    }
#define BENCH_CAMPAIGN_TAKEN                                                                       \
    {BENCH_KEY_SHARD, BENCH_TO(TEXT, run.shard), 0, 0, NULL},                                      \
    {                                                                                              \
        BENCH_KEY_RESUME, BENCH_TO(TRUE, run.resume), 0, 0, NULL                                   \
    }
static inline bool bench_option_of_campaign(int key)
{
    return key == BENCH_KEY_SHARD || key == BENCH_KEY_RESUME;
}

/* Puts the value of the option `key` of the command's `list` into the record, which is the state's
 * input, as `options` has it; false where it is none of these. Both end with {0}. */
bool bench_option_take(const struct argp_option *list, const BenchOption *options, int key,
                       const char *text, const struct argp_state *state);

/* The file that a command shows when it is given alone: takes it as the argument, and refuses a
 * second one, and at the end any option that says what to measure (`measuring`). */
error_t bench_option_shown(int key, const char *text, const struct argp_state *state,
                           bool measuring, const char **file);

/* What of BenchCommon a command takes; the rest has its defaults. */
enum { BENCH_TAKES_QUIET = 1, BENCH_TAKES_THREADS = 2, BENCH_TAKES_SEED = 4, BENCH_TAKES_ALL = 7 };

/* argp_parse() for a command: its own options `argp` into `input`, whose defaults are set, and
 * beside them the common ones that it takes. Usage errors end the program: one line, exit code 2.
 * argv[0] is the program and command ("shapebench run"). */
void bench_options_parse(const struct argp *argp, int argc, char **argv, void *input,
                         unsigned takes, BenchCommon *common);

/* argp_parse(), but what getopt finds wrong (an unknown option, a missing value) is one line like
 * all others, and ends the program with exit code 2. */
void bench_option_words(const struct argp *argp, int argc, char **argv, unsigned flags, int *first,
                        void *input);

/* Prints "program command: line", of SM_USAGE with where to look it up. */
void bench_option_fail(const char *name, const SmError *error);

/* Prints "program command: line; see ... --help" and ends the program with exit code 2. */
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
