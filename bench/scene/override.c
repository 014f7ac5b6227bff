#include "override.h"

#include <stdio.h>
#include <string.h>

#include "../engines.h"
#include "../settings/command_line.h"

/* "NAME=FILE" */
static void add_substitute(const struct argp_state *state, const char *text, void *member)
{
    BenchSubstitutes *list = member;
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1] || equals - text >= BENCH_NAME)
        bench_usage(state, "--mesh: '%.100s' is not NAME=FILE", text);
    if (list->count == BENCH_SUBSTITUTES)
        bench_usage(state, "--mesh: given more than %d times", BENCH_SUBSTITUTES);
    char *name = list->scene[list->count];
    snprintf(name, BENCH_NAME, "%.*s", (int)(equals - text), text);
    char near[BENCH_SUGGEST_TEXT];
    if (!bench_scene_text(name, NULL))
        bench_usage(state, "--mesh: '%s' is not a built-in scene%s", name,
                    bench_scene_suggest(name, near));
    list->file[list->count++] = equals + 1;
}

const BenchSetting bench_override_settings[] = {
    {BENCH_OPTION("engine", "NAME", 1, "%s (default: as the scene says)"),
     BENCH_IN(BenchOverride, engine), .choices_of = bench_engine_names},
    {BENCH_OPTION("precision", "P", 1, "%s (default: the engine's first)"),
     BENCH_IN(BenchOverride, precision), BENCH_CHOICES(bench_precisions)},
    {BENCH_OPTION(
         "mesh", "NAME=FILE", 1,
         "Use the mesh FILE in the place of scene NAME's, scaled and moved to its size and "
         "place"),
     BENCH_IN(BenchOverride, substitutes), .take = add_substitute},
    {BENCH_IN(BenchOverride, given), .table = bench_scene_settings},
    {0},
};

const char *bench_substitute_find(const BenchSubstitutes *list, const char *scene)
{
    for (int i = list->count - 1; i >= 0; i--)
        if (!strcmp(list->scene[i], scene)) return list->file[i];
    return NULL;
}

void bench_override_apply(const BenchOverride *chosen, BenchScene *scene)
{
    if (chosen->engine) snprintf(scene->engine, sizeof scene->engine, "%.23s", chosen->engine);
    bench_given_apply(&chosen->given, scene);
}
