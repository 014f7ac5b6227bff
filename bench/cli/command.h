/* command.h - the program's commands. Each parses its own options and returns the exit code. */
#ifndef BENCH_COMMAND_H
#define BENCH_COMMAND_H

#include "../settings/option.h"

/* Exit codes as every command's help prints them; error.h has them as SmCode. */
#define BENCH_EXIT_CODES                                                                           \
    "Exit codes: 0 done; 1 a correctness check failed (INVALID); 2 unknown option or value out "   \
    "of range; 3 a mesh, scene or result file cannot be used; 4 a file cannot be written; "        \
    "70 out of memory; 128 + N ended by signal N (Ctrl-C: 130)."

extern const char *const bench_papers[]; /* that have tables; NULL-terminated */

/* Options that are the same in several commands, which have a member of the same name. */
#define BENCH_OVERWRITE_OPTION(record, place)                                                      \
    {                                                                                              \
        BENCH_IN(record, overwrite),                                                               \
            BENCH_OPTION("overwrite", NULL, place,                                                 \
                         "Replace a file that is there (default: refuse)")                         \
    }
#define BENCH_FORMAT_OPTION(record, place)                                                         \
    {                                                                                              \
        BENCH_IN(record, format), BENCH_CHOICES(bench_format_names),                               \
            BENCH_OPTION("format", "FORMAT", place,                                                \
                         "text, markdown, csv, latex, json (default: text)")                       \
    }

/* What every campaign has (campaign_run.h), whose record has a BenchCampaignRun `run`. */
#define BENCH_CAMPAIGN_OPTIONS(record, place, point)                                               \
    {BENCH_MEASURE("shard", "I/N|auto", place,                                                     \
                   "Measure only every N-th " point                                                \
                   ", from the I-th on; auto: those of a task of a Slurm job array "               \
                   "(SLURM_ARRAY_TASK_ID and _COUNT); put the files together with 'merge'"),       \
     BENCH_IN(record, run.shard)},                                                                 \
        {BENCH_OPTION("columns", NULL, place,                                                      \
                      "Measure nothing; list what FILE.h5 has, as results/README.md does"),        \
         BENCH_IN(record, run.columns)},                                                           \
    {                                                                                              \
        BENCH_MEASURE("resume", NULL, place, "Go on with FILE.h5 if it is there"),                 \
            BENCH_IN(record, run.resume)                                                           \
    }

typedef struct {
    const char *name;
    const char *summary;               /* one line for the program's help */
    int (*run)(int argc, char **argv); /* argv[0] is "shapebench NAME" */
} BenchCommand;

int bench_command_scenes(int argc, char **argv);
int bench_command_info(int argc, char **argv);
int bench_command_run(int argc, char **argv);
int bench_command_tables(int argc, char **argv);
int bench_command_regress(int argc, char **argv);
int bench_command_kernels(int argc, char **argv);
int bench_command_report(int argc, char **argv);
int bench_command_sweep(int argc, char **argv);
int bench_command_calibrate(int argc, char **argv);
int bench_command_merge(int argc, char **argv);
int bench_command_claims(int argc, char **argv);

#endif
