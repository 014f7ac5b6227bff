/* override.h - the options of commands that run scenes by which a user replaces what a scene says:
 * --engine, --precision, --mesh, and those of the scene's settings. */
#ifndef BENCH_OVERRIDE_H
#define BENCH_OVERRIDE_H

#include "scene.h"

enum { BENCH_SUBSTITUTES = 32 };

/* Users' meshes in scenes' places. */
typedef struct {
    int count;
    char scene[BENCH_SUBSTITUTES][BENCH_NAME];
    const char *file[BENCH_SUBSTITUTES];
} BenchSubstitutes;

typedef struct {
    const char *engine;    /* NULL: the scene's */
    const char *precision; /* NULL: the engine's first */
    BenchSubstitutes substitutes;
    BenchGiven given; /* for a BenchScene */
} BenchOverride;

/* Of a BenchOverride; as whom (BENCH_BY_...) the group that has them says. */
extern const BenchSetting bench_override_settings[];

/* The file for this scene, or NULL. The last one given wins. */
const char *bench_substitute_find(const BenchSubstitutes *list, const char *scene);

/* Puts the engine and all settings given into the scene. */
void bench_override_apply(const BenchOverride *chosen, BenchScene *scene);

#endif
