#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command.h"

enum { FILES = 256, FIXED = 9 }; /* FIXED: words of the command that starts the script */

#define PYTHON "/usr/bin/python3" /* Debian's, which has h5py and matplotlib */

typedef struct {
    BenchCommon common;
    const char *file[FILES];
    int count;
    const char *output, *title;
    bool overwrite;
} Options;

static const BenchSetting settings[] = {
    {BENCH_OUTPUT_OPTION(
         "NAME", 1,
         "NAME.html: one page with everything in it; any other NAME: a folder with index.html, "
         "and every figure as SVG, PNG and CSV (default: report.html)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, 1),
    {BENCH_OPTION("title", "TEXT", 1, "The page's heading (default: shapebench report)"),
     BENCH_IN(Options, title), .letter = 't'},
    {0},
};

static void take_file(const struct argp_state *state, void *record, char *text)
{
    Options *options = record;
    if (options->count == FILES) bench_usage(state, "at most %d files", FILES);
    options->file[options->count++] = text;
}

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (!*options->output) bench_usage(state, "--output wants a name");
    if (!options->count) bench_usage(state, "which FILE? 'shapebench tables -o FILE.h5' makes one");
}

static const char help[] =
    "Make a page of result files that can be sent to a colleague: tables beside the papers', "
    "claims with verdicts, figures with their data, and where it was measured.\v"
    "FILE is what tables, claims, sweep and calibrate write with -o. The page needs no network. "
    "Files of the same scenes from several commits make a history.\n" BENCH_EXIT_CODES;

static const BenchCommandLine line = {settings, BENCH_TAKES_QUIET, "FILE...", help,
                                      check,    take_file,         NULL};

/* Where the script is: beside the installed program, or in the sources it was built from. */
static bool find_script(char path[PATH_MAX])
{
    char program[PATH_MAX - 64];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length > 0) {
        program[length] = '\0';
        char *name = strrchr(program, '/');
        if (name) *name = '\0';
        snprintf(path, PATH_MAX, "%s/../share/shapebench/report/main.py", program);
        if (!access(path, R_OK)) return true;
    }
    snprintf(path, PATH_MAX, "%s/report/main.py", SHAPEBENCH_SCRIPTS);
    return !access(path, R_OK);
}

int bench_command_report(int argc, char **argv)
{
    Options options = {.output = "report.html", .title = "shapebench report"};
    bench_options_parse(&line, argc, argv, &options, &options.common);
    char script[PATH_MAX];
    if (!find_script(script)) {
        fprintf(stderr, "%s: %s is missing: install shapebench again, or keep its sources\n",
                argv[0], script);
        return SM_INPUT;
    }
    const char *word[FIXED + FILES + 1] = {PYTHON,         script,    "--output",
                                           options.output, "--title", options.title};
    int words = 6;
    if (options.common.quiet) word[words++] = "--quiet";
    if (options.overwrite) word[words++] = "--overwrite";
    word[words++] = "--"; /* what follows are files, whatever they begin with */
    memcpy(word + words, options.file, (size_t)options.count * sizeof *word);
    fflush(NULL);
    execv(PYTHON, (char *const *)word);
    fprintf(stderr, "%s: %s cannot be started (%s): scripts/setup installs it\n", argv[0], PYTHON,
            strerror(errno));
    return SM_INPUT;
}
