#include "substitute.h"

#include <stdio.h>
#include <string.h>

#include "option.h"

void bench_substitute_add(const struct argp_state *state, char *text, BenchSubstitutes *list)
{
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

const char *bench_substitute_find(const BenchSubstitutes *list, const char *scene)
{
    for (int i = list->count - 1; i >= 0; i--)
        if (!strcmp(list->scene[i], scene)) return list->file[i];
    return NULL;
}
