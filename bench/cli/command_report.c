#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command.h"
#include "option.h"

enum { FILES = 256, FIXED = 9 }; /* FIXED: words of the command that starts the script */

#define PYTHON "/usr/bin/python3" /* Debian's, which has h5py and matplotlib */

typedef struct {
    BenchCommon common;
    const char *file[FILES];
    int count;
    const char *output, *title;
    bool overwrite;
} Options;

static const struct argp_option option_list[] = {
    {"output", 'o', "NAME", 0,
     "NAME.html: one page with everything in it; any other NAME: a folder with index.html, and "
     "every figure as SVG, PNG and CSV (default: report.html)",
     1},
    BENCH_OVERWRITE_OPTION(1),
    {"title", 't', "TEXT", 0, "The page's heading (default: shapebench report)", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    Options *options = state->input;
    switch (key) {
    case 'o':
        if (!*text) bench_usage(state, "--output wants a name");
        options->output = text;
        return 0;
    case 't':
        options->title = text;
        return 0;
    case BENCH_KEY_OVERWRITE:
        options->overwrite = true;
        return 0;
    case ARGP_KEY_ARG:
        if (options->count == FILES) bench_usage(state, "at most %d files", FILES);
        options->file[options->count++] = text;
        return 0;
    case ARGP_KEY_END:
        if (!options->count)
            bench_usage(state, "which FILE? 'shapebench tables -o FILE.h5' makes one");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const char help[] =
    "Make a page of result files that can be sent to a colleague: tables beside the papers', "
    "claims with verdicts, figures with their data, and where it was measured.\v"
    "FILE is what tables, claims, sweep and calibrate write with -o. The page needs no network. "
    "Files of "
    "the same scenes from several commits make a history.\n" BENCH_EXIT_CODES;

static const struct argp argp = {option_list, parse, "FILE...", help, NULL, NULL, NULL};

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
    bench_options_parse(&argp, argc, argv, &options, BENCH_TAKES_QUIET, &options.common);
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
