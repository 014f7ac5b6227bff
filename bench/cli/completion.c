#include "completion.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    FILE *file;
    const BenchCommand *command;
    void *record;       /* zeroed, of the command's options */
    const char *begun;  /* the word to complete, */
    char before[64];    /* and what of it comes before a value: "--scene=", or nothing */
    const char *option; /* that a value is wanted of: its name, of this length */
    size_t length;
    const BenchSetting *found;
} Completion;

/* A line, if the word goes on with what was typed. */
static void offer(const Completion *its, const char *dash, const char *name, const char *what)
{
    const char *typed = its->begun;
    size_t dashes = strlen(dash);
    if (strncmp(typed, dash, strlen(typed) < dashes ? strlen(typed) : dashes) != 0) return;
    if (strlen(typed) > dashes && strncmp(typed + dashes, name, strlen(typed + dashes)) != 0)
        return;
    fprintf(its->file, "%s%s%s\t%s\n", its->before, dash, name, what);
}

static void offer_all(const Completion *its, const char *const *name, const char *what)
{
    for (; name && *name; name++) offer(its, "", *name, what);
}

/* "NAME|FILE.cfg", "[MESH...]": files, and the ending of their names, where it has a single one. */
static void offer_files(const Completion *its, const char *argument)
{
    static const char *const words[] = {"FILE", "MESH", ".h5"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const char *place = strstr(argument, words[i]);
        if (!place) continue;
        const char *dot = strchr(place, '.');
        bool single = dot && dot[1] != '.' && !strstr(place, "MESH");
        int length = single ? 1 + (int)strspn(dot + 1, "abcdefghijklmnopqrstuvwxyz0123456789") : 0;
        fprintf(its->file, "\t%.*s\n", length, single ? dot : "");
        return;
    }
}

static void offer_values(const Completion *its, const BenchSetting *setting)
{
    const char *const *names = setting->offers ? setting->offers() : bench_setting_choices(setting);
    offer_all(its, names, setting->argument);
    offer_files(its, setting->argument);
}

static void offer_option(void *context, const BenchSetting *setting)
{
    char sentence[BENCH_SENTENCE];
    offer(context, "--", setting->option, bench_setting_sentence(setting, sentence));
}

/* Is it the one whose value is wanted? */
static void find_option(void *context, const BenchSetting *setting)
{
    Completion *its = context;
    bool letter = its->length == 1 && setting->letter == its->option[0];
    bool named = strlen(setting->option) == its->length &&
                 !strncmp(setting->option, its->option, its->length);
    if (setting->argument && (letter || named)) its->found = setting;
}

/* The option that a word names, without its dashes, and that wants a value; NULL: none does. */
static const BenchSetting *wanting(Completion *its, const char *name, size_t length)
{
    its->option = name;
    its->length = length;
    its->found = NULL;
    bench_options_each(&its->command->line, its->record, find_option, its);
    return its->found;
}

/* The last word behind a command. */
static void complete_word(Completion *its, const char *last, bool options)
{
    const char *equals = strchr(its->begun, '=');
    bool dashed = options && its->begun[0] == '-';
    const BenchSetting *setting = NULL;
    if (options && last[0] == '-')
        setting = last[1] == '-' ? wanting(its, last + 2, strlen(last + 2))
                                 : wanting(its, last + 1, strlen(last + 1) == 1 ? 1 : 0);
    if (!setting && dashed && equals && !strncmp(its->begun, "--", 2)) {
        setting = wanting(its, its->begun + 2, (size_t)(equals - its->begun - 2));
        if (!setting) return;
        snprintf(its->before, sizeof its->before, "%.*s", (int)(equals + 1 - its->begun),
                 its->begun);
        its->begun = equals + 1;
    }
    if (setting) {
        offer_values(its, setting);
    } else if (dashed) {
        bench_options_each(&its->command->line, its->record, offer_option, its);
        offer(its, "--", "help", "Say what the command does and takes");
        offer(its, "--", "version", "Say which version this is");
    } else {
        const BenchCommandLine *line = &its->command->line;
        if (line->offers) offer_all(its, line->offers(), "");
        if (line->arguments) offer_files(its, line->arguments);
    }
}

static void complete_command(const Completion *its, const BenchCommand *const *commands)
{
    for (; *commands; commands++) offer(its, "", (*commands)->name, (*commands)->summary);
    offer(its, "", "help", "say what a command does and takes");
    if (its->begun[0] != '-') return;
    offer(its, "--", "help", "List the commands");
    offer(its, "--", "version", "Say which version this is");
}

void bench_complete(FILE *file, const BenchCommand *const *commands, int words, char **word)
{
    if (words < 1) return;
    Completion its = {.file = file, .begun = word[words - 1]};
    if (words == 1 || (words == 2 && !strcmp(word[0], "help"))) {
        complete_command(&its, commands);
        return;
    }
    bool options = true;
    for (int i = 1; i < words - 1; i++) options = options && strcmp(word[i], "--") != 0;
    for (; *commands; commands++) {
        if (strcmp((*commands)->name, word[0]) != 0) continue;
        its.command = *commands;
        its.record = sm_alloc(1, its.command->size);
        complete_word(&its, words > 2 ? word[words - 2] : "", options);
        free(its.record);
    }
}
