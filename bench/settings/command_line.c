#include "command_line.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/isa.h"
#include "../../lib/printable.h"
#include "../../lib/system/cores.h"
#include "../../lib/system/team.h"
#include "../system/remark.h"
#include "../system/suggest.h"
#include "provenance.h"

void bench_print_isas(FILE *file)
{
    for (int isa = 0; isa < sm_isa_count(); isa++)
        fprintf(file, "%s%s%s", isa ? " " : "", sm_isa_name(isa),
                isa == sm_isa()     ? " (in use)"
                : sm_isa_there(isa) ? ""
                                    : " (not of this processor)");
}

static void print_version(FILE *file, struct argp_state *state)
{
    SmError error;
    if (sm_isa_wanted(&error)) bench_usage(state, "%s", error.text);
    fputs("shapebench " SHAPEBENCH_VERSION "\ninstruction sets: ", file);
    bench_print_isas(file);
    fputc('\n', file);
}

void (*argp_program_version_hook)(FILE *, struct argp_state *) = print_version;

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

/* Offers all long names. */
static void suggest_options(const struct argp *argp, BenchSuggestion *meant)
{
    const struct argp_option *option = argp->options;
    for (; option && (option->name || option->key || option->doc); option++)
        if (option->name) bench_suggest(meant, option->name);
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

/* ---- tables of settings as argp's options */

enum { MOST = 48, FIRST_KEY = 0x2000 };

/* An option: the setting, and what it is written to. */
typedef struct {
    const BenchSetting *setting;
    void *record;      /* that its table describes; NULL: `given` takes it, */
    BenchGiven *given; /* for the struct at `offset` */
    size_t offset;
} Option;

typedef struct {
    const BenchCommandLine *line;
    void *record; /* begins with a BenchCommon */
    int count;
    Option option[MOST];
    struct argp_option list[MOST + 1]; /* in the same order */
} Options;

static void add_option(Options *options, const Option *option)
{
    const BenchSetting *setting = option->setting;
    if (options->count == MOST) abort();
    int key = setting->letter ? setting->letter : FIRST_KEY + options->count;
    options->option[options->count] = *option;
    options->list[options->count++] =
        (struct argp_option){setting->option, setting->option ? key : 0, setting->argument, 0,
                             setting->help,   setting->section};
}

/* Adds the options of the table that `into` begins with, as `who` has them. */
static void add_table(Options *options, const Option *into, unsigned who)
{
    for (const BenchSetting *s = into->setting; !bench_setting_ends(s); s++) {
        Option option = *into;
        option.setting = s;
        if (s->kind == BENCH_SET_GROUP && s->table) {
            option.setting = s->table;
            option.offset += s->offset;
            if (into->record) option.record = (char *)into->record + s->offset;
            add_table(options, &option, s->who ? s->who : who);
        } else if (s->kind == BENCH_SET_GIVEN) {
            option = (Option){s->table, NULL, (void *)((char *)into->record + s->offset), 0};
            add_table(options, &option, who);
        } else if ((s->option || !s->key) && (!s->who || !who || s->who & who)) {
            add_option(options, &option);
        }
    }
}

static void take(const Options *options, const Option *option, const char *text,
                 const struct argp_state *state)
{
    const BenchSetting *setting = option->setting;
    SmError error = {.code = SM_OK};
    ((BenchCommon *)options->record)->measuring |= setting->measuring;
    if (setting->take)
        setting->take(state, text, (char *)option->record + setting->offset);
    else if (option->given)
        bench_given_add(option->given, setting, option->offset, text, &error);
    else
        bench_setting_text(setting, text, option->record, &error);
    if (error.code) bench_usage(state, "--%s: %s", setting->option, error.text);
}

static void take_argument(const Options *options, char *text, const struct argp_state *state)
{
    const BenchCommandLine *line = options->line;
    BenchCommon *common = options->record;
    if (common->words == line->most) bench_usage(state, "what is '%s'? %s", text, line->limit);
    common->word = sm_realloc(common->word, (size_t)common->words + 1, sizeof *common->word);
    common->word[common->words++] = text;
}

static void check(const Options *options, const struct argp_state *state)
{
    const BenchCommon *common = options->record;
    if (options->line->check) options->line->check(state, options->record);
    if (common->words && common->measuring)
        bench_usage(state, "%s alone is shown as it is; to measure into it, name it with -o",
                    common->word[0]);
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    const Options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->err_stream = NULL; /* getopt's line is enough: no second one, "Try ..." */
        return 0;
    case ARGP_KEY_ARG:
        take_argument(options, text, state);
        return 0;
    case ARGP_KEY_END:
        check(options, state);
        return 0;
    }
    for (int i = 0; i < options->count; i++)
        if (options->list[i].name && options->list[i].key == key) {
            take(options, &options->option[i], text, state);
            return 0;
        }
    return ARGP_ERR_UNKNOWN;
}

/* argp's: what is printed in the place of an option's sentence. */
static char *filter_help(int key, const char *text, void *input)
{
    const Options *options = input;
    char sentence[BENCH_SENTENCE];
    const char *said = text;
    for (int i = 0; i < options->count; i++)
        if (options->list[i].name && options->list[i].key == key)
            said = bench_setting_sentence(options->option[i].setting, sentence);
    return said == sentence ? strdup(said) : (char *)text;
}

/* One is for processes that it starts, too. */
static void take_isa(const struct argp_state *state, const char *text, void *member)
{
    const Options *options = state->input;
    BenchNames *isas = member;
    SmError error;
    isas->count = 0;
    if (!strcmp(text, "all")) {
        if (!(options->line->takes & BENCH_TAKES_SETS))
            bench_usage(state, "--isa: 'all' is of tables and kernels");
        for (int isa = 0; isa < sm_isa_count(); isa++)
            if (sm_isa_there(isa)) isas->name[isas->count++] = sm_isa_name(isa);
        return;
    }
    if (sm_isa_use(text, &error)) bench_usage(state, "--isa: %s", error.text);
    setenv("SHAPEBENCH_ISA", text, 1);
}

static const BenchSetting common_settings[] = {
    {.help = "Common options:", .section = 90, .who = BENCH_TAKES_ALL},
    {BENCH_OPTION("quiet", NULL, 90, "No progress and no remarks on standard error"),
     BENCH_IN(BenchCommon, quiet), .who = BENCH_TAKES_QUIET},
    {BENCH_OPTION("threads", "N", 90, "Threads; 0: all that it may use (default: 1)"),
     BENCH_IN(BenchCommon, threads), 0, SM_MOST_THREADS, .who = BENCH_TAKES_THREADS},
    {BENCH_OPTION("isa", "NAME", 90,
                  "Instruction set of the engines: sse2, avx2, avx512, as SHAPEBENCH_ISA (default: "
                  "the best of this processor); tables, kernels: all, one after the other"),
     BENCH_IN(BenchCommon, isas), .take = take_isa, .who = BENCH_TAKES_THREADS},
    {BENCH_OPTION("seed", "N", 90, "Seed of everything random (default: 1)"),
     BENCH_IN(BenchCommon, seed), 0, 2147483647, .who = BENCH_TAKES_SEED},
    {0},
};

/* All that the command takes: its own options, and those that it shares. */
static void add_options(Options *options, const BenchCommandLine *line, void *record)
{
    *options = (Options){.line = line, .record = record};
    add_table(options, &(Option){.setting = line->settings, .record = record}, 0);
    if (line->takes)
        add_table(options, &(Option){.setting = common_settings, .record = record}, line->takes);
}

void bench_options_parse(const BenchCommandLine *line, int argc, char **argv, void *record)
{
    BenchCommon *common = record;
    Options options;
    SmError error;
    *common = (BenchCommon){.threads = 1, .seed = 1};
    add_options(&options, line, record);
    const struct argp argp = {options.list, parse, line->arguments, line->help, NULL,
                              filter_help,  NULL};
    bench_option_words(&argp, argc, argv, 0, NULL, &options);
    if (line->takes & BENCH_TAKES_THREADS && sm_isa_wanted(&error)) {
        bench_option_fail(argv[0], &error);
        exit(SM_USAGE);
    }
    if (!common->isas.count) common->isas.name[common->isas.count++] = sm_isa_name(sm_isa());
    if (common->quiet) bench_remarks_off();
    if (!common->threads) common->threads = sm_cores("");
    omp_set_num_threads(common->threads); /* lib/system/team.h */
}
