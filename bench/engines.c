#include "engines.h"

#include <stdio.h>
#include <string.h>

#include "../lib/printable.h"
#include "system/quote.h"
#include "system/suggest.h"

enum { TYPES = 2 };

const BenchEngine *const *bench_engine_list;

const BenchEngine *bench_engine(const char *name)
{
    static const SmEngineType none_type = {.name = "", .precision = ""};
    static const BenchEngine none = {.type = {&none_type}};
    for (int e = 0; bench_engine_list[e]; e++)
        if (!strcmp(bench_engine_list[e]->type[0]->name, name)) return bench_engine_list[e];
    return &none;
}

SmCode bench_engine_find(const char *name, const char *precision, const SmEngineType **type,
                         SmError *error)
{
    char known[256] = "", near[BENCH_SUGGEST_TEXT];
    const char *const *names = bench_engine_names();
    for (int i = 0; bench_engine_list[i / TYPES]; i++) {
        const SmEngineType *t = bench_engine_list[i / TYPES]->type[i % TYPES];
        if (!t) continue;
        if (!strcmp(t->name, name) && (!precision || !strcmp(t->precision, precision))) {
            *type = t;
            return SM_OK;
        }
        sm_append(known, sizeof known, "%s%s (%s)", *known ? ", " : "", t->name, t->precision);
    }
    return sm_fail(error, SM_USAGE, "no engine '%.32s'%s%s%s; there are: %s%s", name,
                   precision ? " in " : "", precision ? precision : "",
                   precision ? " precision" : "", known, bench_suggest_among(name, names, near));
}

SmStage bench_stage_find(const char *name)
{
    for (int e = 0; bench_engine_list[e]; e++)
        for (int s = 0; s < SM_STAGES; s++) {
            const char *stage = sm_engine_stage(bench_engine_list[e]->type[0], (SmStage)s);
            if (stage && !strcmp(stage, name)) return (SmStage)s;
        }
    return SM_STAGES;
}

const BenchEngine *bench_engine_yardstick(void)
{
    int e = 0;
    while (!bench_engine_list[e]->yardstick) e++;
    return bench_engine_list[e];
}

/* The names of the first `most` that are such, or of all, for NULL; NULL behind the last. */
static void list_names(bool (*are)(const BenchEngine *engine), int most, const char **names)
{
    for (const BenchEngine *const *engine = bench_engine_list; *engine && most; engine++)
        if (!are || are(*engine)) {
            *names++ = (*engine)->type[0]->name;
            most--;
        }
    *names = NULL;
}

const char *const *bench_engine_names(void)
{
    static const char *names[BENCH_MOST_ENGINES + 1];
    list_names(NULL, BENCH_MOST_ENGINES, names);
    return names;
}

const char *bench_engines_that(bool (*are)(const BenchEngine *engine),
                               char text[BENCH_ENGINES_TEXT])
{
    const char *names[BENCH_MOST_ENGINES + 1];
    list_names(are, BENCH_MOST_ENGINES, names);
    return bench_enumerate(names, "", " or ", BENCH_ENGINES_TEXT, text);
}

bool bench_engine_is_planned(const BenchEngine *engine)
{
    return engine->set_width;
}

const BenchEngine *bench_engine_planned(const char *engines, int i)
{
    const char *const *choice = bench_engine_choices();
    bool all = !strcmp(engines, *choice);
    while (*++choice)
        if ((all || !strcmp(*choice, engines)) && i-- == 0) return bench_engine(*choice);
    return NULL;
}

const char *const *bench_engine_choices(void)
{
    static const char *choices[BENCH_MOST_PLANNED + 2] = {"both"};
    list_names(bench_engine_is_planned, BENCH_MOST_PLANNED, choices + 1);
    return choices;
}

const char *bench_engine_unplanned(const char *word)
{
    return bench_engine(word)->reference
               ? "it has no w and epsilon; its Young's modulus is given (run --young)"
               : NULL;
}
