#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../system/process.h"
#include "command.h"

enum { FIXED = 12 }; /* words of the command that starts the script */

#define PYTHON "/usr/bin/python3" /* Debian's, which has h5py and matplotlib */

typedef struct {
    BenchCommon common;
    const char *output, *title;
    bool overwrite, no_page;
} Options;

static const BenchSetting settings[] = {
    {BENCH_OUTPUT_OPTION(
         "NAME", 1,
         "NAME.html: one page with everything in it; any other NAME: a folder with index.html, "
         "and every figure as SVG, PNG and CSV (default: report.html)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 1),
    {BENCH_OPTION("no-page", NULL, 1,
                  "Leave out the live page, 2.8 MB, in which scenes' pictures open"),
     BENCH_IN(Options, no_page)},
    {BENCH_OPTION("title", "TEXT", 1, "The page's heading (default: shapebench report)"),
     BENCH_IN(Options, title), .letter = 't'},
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (!*options->output) bench_usage(state, "--output wants a name");
    if (!options->common.words)
        bench_usage(state, "which FILE? 'shapebench tables -o FILE.h5' makes one");
}

static const char help[] =
    "Make a page of result files that can be sent to a colleague: tables beside the papers', "
    "claims with verdicts, figures with their data, scenes to be pulled by hand, and where it "
    "was measured.\v"
    "FILE is what tables, claims, sweep and calibrate write with -o. The page needs no network. "
    "Files of the same scenes from several commits make a history: what a step took in each, and, "
    "in ten files of a scene or more, from which on it is slower or faster.\n" BENCH_EXIT_CODES;

/* Becomes the script. */
static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    const BenchCommon *common = &options->common;
    (void)argc, (void)argv;
    char script[PATH_MAX], program[PATH_MAX];
    SmCode code = bench_script_find("report/main.py", script, error);
    if (code) return code;
    const char *const start[] = {PYTHON,          script,    "--output",
                                 options->output, "--title", options->title};
    const char **word = sm_alloc((size_t)(FIXED + common->words + 1), sizeof *word);
    memcpy(word, start, sizeof start);
    int words = sizeof start / sizeof *start;
    if (bench_program_path(program)) word[words++] = "--program", word[words++] = program;
    if (common->quiet) word[words++] = "--quiet";
    if (options->overwrite) word[words++] = "--overwrite";
    if (options->no_page) word[words++] = "--no-page";
    word[words++] = "--"; /* what follows are files, whatever they begin with */
    memcpy(word + words, common->word, (size_t)common->words * sizeof *word);
    fflush(NULL);
    execv(PYTHON, (char *const *)word);
    free(word);
    return sm_fail(
        error, SM_INPUT,
        "%s cannot be started (%s): install python3-h5py, python3-matplotlib, python3-jinja2",
        PYTHON, strerror(errno));
}

static const Options defaults = {.output = "report.html", .title = "shapebench report"};

const BenchCommand bench_command_report = {
    .name = "report",
    .summary = "make a page of result files to send to a colleague",
    .line = {settings, BENCH_TAKES_QUIET, "FILE...", help, check, .most = -1},
    .size = sizeof(Options),
    .defaults = &defaults,
    .perform = perform,
};
