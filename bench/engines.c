#include <stdio.h>
#include <string.h>

#include "../fastlsm/fastlsm.h"
#include "../octree/engine.h"
#include "../reference/brute.h"
#include "../reference/meshless/engine.h"
#include "cli/suggest.h"
#include "play/runner.h"

static const SmEngineType *const engines[] = {
    &fastlsm_engine_f32, &fastlsm_engine_f64, &octree_engine_f32,
    &octree_engine_f64,  &ref_brute_engine,   &ref_meshless_engine,
};
enum { ENGINES = sizeof engines / sizeof engines[0] };

SmCode bench_engine_find(const char *name, const char *precision, const SmEngineType **type,
                         SmError *error)
{
    char known[256] = "", near[BENCH_SUGGEST_TEXT];
    const char *names[ENGINES + 1] = {NULL};
    for (int i = 0; i < ENGINES; i++) {
        const SmEngineType *e = engines[i];
        names[i] = e->name;
        if (!strcmp(e->name, name) && (!precision || !strcmp(e->precision, precision))) {
            *type = e;
            return SM_OK;
        }
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s (%s)", used ? ", " : "", e->name,
                 e->precision);
    }
    return sm_fail(error, SM_USAGE, "no engine '%.32s'%s%s%s; there are: %s%s", name,
                   precision ? " in " : "", precision ? precision : "",
                   precision ? " precision" : "", known, bench_suggest_among(name, names, near));
}
