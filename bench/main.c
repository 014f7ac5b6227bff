/* shapebench: dispatch to the commands; see command.h. */
#include <argp.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../lib/error.h"
#include "../lib/printable.h"
#include "cli/command.h"
#include "scene/scene.h"
#include "settings/command_line.h"
#include "system/interrupt.h"
#include "system/process.h"
#include "system/suggest.h"

static const BenchCommand *const commands[] = {
    &bench_command_tables,  &bench_command_claims, &bench_command_sweep,   &bench_command_calibrate,
    &bench_command_regress, &bench_command_report, &bench_command_kernels, &bench_command_simulate,
    &bench_command_view,    &bench_command_info,   &bench_command_scenes,  NULL};
enum { COMMANDS = sizeof commands / sizeof commands[0] - 1 };

static const char help_start[] =
    "Reference implementation and benchmark harness for shape-matching deformation.\n"
    "With no command: tables.\v"
    "Commands ('shapebench help COMMAND' says more of each):\n";

static const char help_end[] = "\n" BENCH_EXIT_CODES;

static error_t parse(int key, char *text, struct argp_state *state)
{
    (void)text;
    if (key == ARGP_KEY_INIT) state->err_stream = NULL; /* see bench_options_parse() */
    return key == ARGP_KEY_INIT ? 0 : ARGP_ERR_UNKNOWN;
}

/* Help text with the commands' list in it, for argp. */
static void write_help(char *help, size_t room)
{
    snprintf(help, room, "%s", help_start);
    for (int i = 0; i < COMMANDS; i++)
        sm_append(help, room, "  %-9s  %s\n", commands[i]->name, commands[i]->summary);
    sm_append(help, room, "%s", help_end);
}

static int run_command(const BenchCommand *command, int argc, char **argv)
{
    char name[64];
    snprintf(name, sizeof name, "shapebench %s", command->name);
    argv[0] = name;
    int code = bench_command_run(command, argc, argv);
    if (fflush(stdout) || ferror(stdout)) {
        fprintf(stderr, "%s: standard output cannot be written: is the disk full?\n", name);
        return code ? code : SM_OUTPUT;
    }
    return code;
}

static const BenchCommand *find_command(const char *name)
{
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(commands[i]->name, name)) return commands[i];
    return NULL;
}

/* Scenes and files are run's arguments. */
static void unknown_command(const char *name)
{
    char shown[512];
    snprintf(shown, sizeof shown, "%s", name);
    sm_printable(shown);
    BenchSuggestion meant = {.typed = shown};
    for (int i = 0; i < COMMANDS; i++) bench_suggest(&meant, commands[i]->name);
    bool of_run = bench_scene_text(name, NULL) || access(name, F_OK) == 0;
    if (of_run) meant.name = shown;
    char near[BENCH_SUGGEST_TEXT];
    fprintf(stderr, "shapebench: unknown command '%s'%s%s 'shapebench --help'\n", shown,
            bench_suggest_words(&meant, of_run ? "run " : "", near), meant.name ? " See" : "; see");
}

/* -h is --help, and so is the command help; 'help NAME' is 'NAME --help'. Returns how many words
 * are left. */
static int ask_for_help(int argc, char **argv)
{
    static char help[] = "--help";
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (!strcmp(argv[i], "-h")) argv[i] = help;
    if (argc < 2 || strcmp(argv[1], "help") != 0) return argc;
    argv[1] = argc > 2 ? argv[2] : help;
    if (argc > 2) argv[2] = help;
    return argc < 3 ? argc : 3;
}

int main(int argc, char **argv)
{
    char help[2048];
    write_help(help, sizeof help);
    const struct argp argp = {NULL, parse, "[COMMAND [OPTION...]]", help, NULL, NULL, NULL};
    char program[] = "shapebench";
    char *none[] = {program, NULL};
    if (argc < 1) argv = none, argc = 1;
    argv[0] = program;
    argp_err_exit_status = SM_USAGE;
    bench_interrupt_catch();
    argc = ask_for_help(argc, argv);

    int first = argc;
    bench_option_words(&argp, argc, argv, ARGP_IN_ORDER, &first, NULL);
    const char *name = first < argc ? argv[first] : "tables";
    const BenchCommand *command = find_command(name);
    if (!command) {
        unknown_command(name);
        return SM_USAGE;
    }
    if (first >= argc) return run_command(command, 1, none);
    return run_command(command, argc - first, argv + first);
}
