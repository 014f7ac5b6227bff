#include "engines.h"

#include <stdio.h>
#include <string.h>

#include "../lib/printable.h"
#include "system/suggest.h"

enum { TYPES = 2, MOST = 16 };

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
    const char *names[MOST + 1] = {NULL};
    for (int i = 0; bench_engine_list[i / TYPES]; i++) {
        const SmEngineType *t = bench_engine_list[i / TYPES]->type[i % TYPES];
        if (!t) continue;
        if (i / TYPES < MOST) names[i / TYPES] = t->name;
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

const char *bench_stage_name(const BenchEngine *engine, SmStage stage)
{
    return engine->stages ? engine->stages->name[stage] : sm_stage_name(stage);
}

SmStage bench_stage_find(const char *name)
{
    for (int e = 0; bench_engine_list[e]; e++)
        for (int s = 0; s < SM_STAGES; s++) {
            const char *stage = bench_stage_name(bench_engine_list[e], (SmStage)s);
            if (stage && !strcmp(stage, name)) return (SmStage)s;
        }
    return SM_STAGES;
}

const BenchEngine *bench_engine_planned(const char *engines, int i)
{
    bool all = !strcmp(engines, bench_engine_choices()[0]);
    for (const BenchEngine *const *engine = bench_engine_list; *engine; engine++)
        if ((*engine)->planned && (all || !strcmp((*engine)->type[0]->name, engines)) && i-- == 0)
            return *engine;
    return NULL;
}

const char *const *bench_engine_choices(void)
{
    static const char *choices[BENCH_MOST_PLANNED + 2] = {"both"};
    int count = 1;
    for (const BenchEngine *const *engine = bench_engine_list; *engine; engine++)
        if ((*engine)->planned && count <= BENCH_MOST_PLANNED)
            choices[count++] = (*engine)->type[0]->name;
    return choices;
}
