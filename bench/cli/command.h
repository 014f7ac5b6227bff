/* command.h - the program's commands: each says what it takes and what it does; how its options are
 * read, its failure is told and its exit code found is the same for all. */
#ifndef BENCH_COMMAND_H
#define BENCH_COMMAND_H

#include "../campaign/campaign_run.h"
#include "../settings/command_line.h"
#include "../table/row_table.h"

/* Exit codes as every command's help prints them; error.h has them as SmCode. */
#define BENCH_EXIT_CODES                                                                           \
    "Exit codes: 0 done; 1 a correctness check failed (INVALID); 2 unknown option or value out "   \
    "of range; 3 a mesh, scene or result file cannot be used; 4 a file cannot be written; "        \
    "70 out of memory; 128 + N ended by signal N (Ctrl-C: 130)."

/* The papers whose tables are regenerated: the first is taken where none is named. */
extern const char *const bench_papers[];

/* Options that are the same in several commands. */
#define BENCH_OVERWRITE_OPTION(record, member, place)                                              \
    {                                                                                              \
        BENCH_IN(record, member), BENCH_OPTION("overwrite", NULL, place,                           \
                                               "Replace a file that is there (default: refuse)")   \
    }
#define BENCH_FORMAT_OPTION(record, member, place)                                                 \
    {                                                                                              \
        BENCH_IN(record, member), BENCH_CHOICES(bench_format_names),                               \
            BENCH_OPTION("format", "FORMAT", place, "As %s (default: text)")                       \
    }
/* The members of a setting; `more` goes on in the sentence. */
#define BENCH_REPEATS_OPTION(record, member, most, more)                                           \
    BENCH_OPTION("repeats", "N", 2, "Samples of every time" more), BENCH_IN(record, member), 1,    \
        (most)
#define BENCH_BLOCK_OPTION(record, member, more)                                                   \
    BENCH_OPTION("block", "MS", 2, "Least milliseconds in a sample" more),                         \
        BENCH_IN(record, member), 0.001, 60000
#define BENCH_PAPER_OPTION(record, member, before, default)                                        \
    BENCH_OPTION("paper", "NAME", 1, before ": %s (default: " default ")"),                        \
        BENCH_IN(record, member), BENCH_CHOICES(bench_papers)

/* What every command that is a campaign has: its record begins with a BenchCampaignOptions `its`.
 */
typedef struct {
    BenchCommon common;
    BenchCampaignRun run;
    BenchFormat format;
} BenchCampaignOptions;

#define BENCH_CAMPAIGN_OPTIONS(record, place, point, stored)                                       \
    {BENCH_MEASURE("output", "FILE.h5", place, stored " (default: nothing stored)"),               \
     BENCH_IN(record, its.run.output), .letter = 'o'},                                             \
        {BENCH_OPTION("columns", NULL, place,                                                      \
                      "Measure nothing; list what FILE.h5 has, as results/README.md does"),        \
         BENCH_IN(record, its.run.columns)},                                                       \
        {BENCH_MEASURE("resume", NULL, place, "Go on with FILE.h5 if it is there"),                \
         BENCH_IN(record, its.run.resume)},                                                        \
        BENCH_FORMAT_OPTION(record, its.format, place)
#define BENCH_STORES(point)                                                                        \
    "Store every " point " as it is finished; if the file is there, go on with it"

typedef struct {
    const char *name;
    const char *summary;   /* one line for the program's help */
    BenchCommandLine line; /* what it takes */
    size_t size;           /* of its record of options, which begins with a BenchCommon, */
    const void *defaults;  /* and the record before they are read; NULL: zero */

    /* Does it; argv[0] is "shapebench NAME". Returns the exit code; what `error` says is printed.
     * NULL of a command that is a campaign (campaign.h): what it shows is measured by its options,
     * alone or by the ranks of an MPI launch, or read from the file that it is given.
     */
    SmCode (*perform)(void *options, int argc, char **argv, SmError *error);
    const BenchCampaignType *campaign;
    /* Sets the campaign's plan by the options; with run.list also says what it is. */
    SmCode (*plan)(void *options, BenchCampaign *campaign, SmError *error);
    /* Prints a campaign, measured or read; on rank 0 only. */
    SmCode (*show)(const void *options, BenchCampaign *campaign, SmError *error);
} BenchCommand;

/* The machine as a command measures on it, with one instruction set or with several. */
void bench_command_machine(const BenchCommon *common, int argc, char **argv, BenchMachine *machine);

/* An SmMesh as OBJ, for bench_draft_write(). */
void bench_print_mesh(FILE *file, const void *mesh);

/* Reads the command's options and does it. Returns the program's exit code. */
int bench_command_run(const BenchCommand *command, int argc, char **argv);

extern const BenchCommand bench_command_scenes, bench_command_info, bench_command_simulate,
    bench_command_tables, bench_command_regress, bench_command_kernels, bench_command_report,
    bench_command_sweep, bench_command_calibrate, bench_command_claims, bench_command_view;

#endif
