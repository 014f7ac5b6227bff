#include "option.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/printable.h"
#include "../../lib/system/team.h"
#include "../system/suggest.h"
#include "provenance.h"

const char *argp_program_version = "shapebench " SHAPEBENCH_VERSION;

enum { KEY_THREADS = 0x1000, KEY_SEED, KEY_QUIET };

/* In the order of BENCH_TAKES_QUIET and so on. */
static const struct argp_option common_options[] = {
    {"quiet", KEY_QUIET, 0, 0, "No progress and no remarks on standard error", 90},
    {"threads", KEY_THREADS, "N", 0, "Threads; 0: all cores (default: 1)", 90},
    {"seed", KEY_SEED, "N", 0, "Seed of everything random (default: 1)", 90},
};
enum { COMMON = sizeof common_options / sizeof *common_options };

static error_t parse_common(int key, char *text, struct argp_state *state)
{
    BenchCommon *common = state->input;
    switch (key) {
    case KEY_THREADS:
        common->threads = (int)bench_option_long(state, "--threads", text, 0, SM_MOST_THREADS);
        if (!common->threads) common->threads = sm_team(omp_get_num_procs());
        return 0;
    case KEY_SEED:
        common->seed = (unsigned long)bench_option_long(state, "--seed", text, 0, 2147483647);
        return 0;
    case KEY_QUIET:
        common->quiet = true;
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

const char *const bench_precisions[] = {"single", "double", NULL};
const char *const bench_widths[] = {"edges", "cells", NULL};
const char *const bench_papers[] = {"fastlsm", "octree", "meshless", NULL};
const char *const bench_layouts[] = {"auto", "lists", "blocks", NULL};

/* Where the system's BLAS is OpenBLAS, which has threads of its own. */
void openblas_set_num_threads(int threads) __attribute__((weak));

/* One number for all that takes none of its own (lib/system/team.h). */
static void set_threads(int threads)
{
    omp_set_num_threads(threads);
    if (openblas_set_num_threads) openblas_set_num_threads(threads);
}

/* Above a command's own parser and the common one: hands each its input. */
static error_t parse_both(int key, char *text, struct argp_state *state)
{
    (void)text;
    if (key != ARGP_KEY_INIT) return ARGP_ERR_UNKNOWN;
    void *const *inputs = state->input;
    state->err_stream = NULL; /* getopt's line is enough: no second one, "Try ..." */
    for (int i = 0; i < 2 && state->root_argp->children[i].argp; i++)
        state->child_inputs[i] = inputs[i];
    return 0;
}

error_t bench_option_shown(int key, const char *text, const struct argp_state *state,
                           bool measuring, const char **file)
{
    switch (key) {
    case ARGP_KEY_ARG:
        if (*file) bench_usage(state, "what is '%s'? One file is shown at a time", text);
        *file = text;
        return 0;
    case ARGP_KEY_END:
        if (*file && measuring)
            bench_usage(state, "%s alone is shown as it is; to measure into it, name it with -o",
                        *file);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

/* Standard error while getopt's words go elsewhere, or NULL. */
static FILE *console;

static void restore_console(void)
{
    if (!console) return;
    fclose(stderr);
    stderr = console;
    console = NULL;
}

static void say(const char *name, const char *text, int length, bool usage)
{
    const char *join = length && text[length - 1] == '?' ? " See" : "; see";
    char *line = sm_alloc((size_t)length + 1, 1); /* it may name a file, or what was typed */
    memcpy(line, text, (size_t)length);
    sm_printable(line);
    fprintf(stderr, "%s: %s", name, line);
    free(line);
    bool told = strstr(text, " --help'") != NULL; /* by another program, whose line this repeats */
    if (usage && !told) fprintf(stderr, "%s '%s --help'", join, name);
    fputc('\n', stderr);
}

/* Offers all long names that the parser and its children have. */
static void suggest_options(const struct argp *argp, BenchSuggestion *meant)
{
    const struct argp_option *option = argp->options;
    const struct argp_child *child = argp->children;
    for (; option && (option->name || option->key || option->doc); option++)
        if (option->name) bench_suggest(meant, option->name);
    for (; child && child->argp; child++) suggest_options(child->argp, meant);
}

/* Adds to what getopt says of an unknown option which one may be meant. */
static void say_words(const struct argp *argp, const char *name, const char *words)
{
    static const char unknown[] = "unrecognized option '--";
    char line[512], typed[64], near[BENCH_SUGGEST_TEXT];
    BenchSuggestion meant = {.typed = typed};
    int length = (int)strcspn(words, "\n");
    if (!strncmp(words, unknown, sizeof unknown - 1)) {
        const char *start = words + sizeof unknown - 1;
        snprintf(typed, sizeof typed, "%.*s", (int)strcspn(start, "='\n"), start);
        suggest_options(argp, &meant);
        bench_suggest(&meant, "help");
        bench_suggest(&meant, "version");
    }
    snprintf(line, sizeof line, "%.*s%s", length, words, bench_suggest_words(&meant, "--", near));
    say(name, line, (int)strlen(line), true);
}

void bench_option_words(const struct argp *argp, int argc, char **argv, unsigned flags, int *first,
                        void *input)
{
    char *said = NULL;
    size_t size;
    FILE *words = open_memstream(&said, &size);
    if (words) console = stderr, stderr = words;
    error_t failed = argp_parse(argp, argc, argv, flags, first, input);
    restore_console();
    size_t start = strlen(argv[0]) + 2; /* getopt begins with the name */
    if (failed && said && strlen(said) > start) say_words(argp, argv[0], said + start);
    free(said);
    if (failed) exit(SM_USAGE);
}

void bench_option_fail(const char *name, const SmError *error)
{
    say(name, error->text, (int)strlen(error->text), error->code == SM_USAGE);
}

void bench_options_parse(const struct argp *argp, int argc, char **argv, void *input,
                         unsigned takes, BenchCommon *common)
{
    struct argp_option options[COMMON + 2] = {{0, 0, 0, 0, "Common options:", 90}};
    for (int i = 0, count = 0; i < COMMON; i++)
        if (takes & 1u << i) options[++count] = common_options[i];
    const struct argp common_argp = {options, parse_common, 0, 0, 0, 0, 0};
    const struct argp_child children[] = {
        {argp, 0, NULL, 0}, {takes ? &common_argp : NULL, 0, NULL, 0}, {0}};
    const struct argp both = {NULL, parse_both, NULL, NULL, children, NULL, NULL};
    void *inputs[] = {input, common};
    *common = (BenchCommon){.threads = 1, .seed = 1};
    bench_option_words(&both, argc, argv, 0, NULL, inputs);
    set_threads(common->threads);
}

void bench_usage(const struct argp_state *state, const char *format, ...)
{
    SmError error;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error.text, sizeof error.text, format, arguments);
    va_end(arguments);
    for (char *c = error.text; *c; c++)
        if (*c == '\n' || *c == '\r') *c = ' ';
    restore_console();
    say(state->name, error.text, (int)strlen(error.text), true);
    exit(SM_USAGE);
}

long bench_option_long(const struct argp_state *state, const char *name, const char *text, long low,
                       long high)
{
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (errno || end == text || *end || value < low || value > high)
        bench_usage(state, "%s: '%s' is not a whole number from %ld to %ld", name, text, low, high);
    return value;
}

double bench_option_real(const struct argp_state *state, const char *name, const char *text,
                         double low, double high)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high))
        bench_usage(state, "%s: '%s' is not a number from %g to %g", name, text, low, high);
    return value;
}

void bench_option_vector(const struct argp_state *state, const char *name, const char *text,
                         double value[3])
{
    const char *place = text;
    for (int d = 0; d < 3; d++) {
        char *end;
        value[d] = strtod(place, &end);
        bool good = end != place && isfinite(value[d]) && *end == (d < 2 ? ',' : '\0');
        if (!good) bench_usage(state, "%s: '%s' is not three numbers x,y,z", name, text);
        place = end + 1;
    }
}

int bench_option_choice(const struct argp_state *state, const char *name, const char *text,
                        const char *const *choices)
{
    char list[256] = "", near[BENCH_SUGGEST_TEXT];
    for (int i = 0; choices[i]; i++) {
        if (!strcmp(text, choices[i])) return i;
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", choices[i]);
    }
    bench_usage(state, "%s: '%s' is not %s%s%s", name, text, choices[1] ? "one of " : "", list,
                bench_suggest_among(text, choices, near));
}

static void add_name(const struct argp_state *state, const char *option, const char *text,
                     BenchNames *names)
{
    if (names->count == BENCH_NAMES) bench_usage(state, "%s: at most %d", option, BENCH_NAMES);
    names->name[names->count++] = text;
}

bool bench_option_take(const struct argp_option *list, const BenchOption *options, int key,
                       const char *text, const struct argp_state *state)
{
    char name[32];
    while (options->key && options->key != key) options++;
    if (!options->key) return false;
    while (list->key != key) list++;
    snprintf(name, sizeof name, "--%s", list->name);
    void *value = (char *)state->input + options->offset;
    long low = (long)options->low, high = (long)options->high;
    switch (options->target) {
    case BENCH_TO_TEXT:
        *(const char **)value = text;
        break;
    case BENCH_TO_NAMES:
        add_name(state, name, text, value);
        break;
    case BENCH_TO_TRUE:
        *(bool *)value = true;
        break;
    case BENCH_TO_INT:
        *(int *)value = (int)bench_option_long(state, name, text, low, high);
        break;
    case BENCH_TO_LONG:
        *(long *)value = bench_option_long(state, name, text, low, high);
        break;
    case BENCH_TO_REAL:
        *(double *)value = bench_option_real(state, name, text, options->low, options->high);
        break;
    case BENCH_TO_CHOICE:
        *(int *)value = bench_option_choice(state, name, text, options->choices);
        break;
    }
    return true;
}
