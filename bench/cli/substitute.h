/* substitute.h - the option --mesh NAME=FILE: a user's mesh in a scene's place. */
#ifndef BENCH_SUBSTITUTE_H
#define BENCH_SUBSTITUTE_H

#include <argp.h>

#include "../scene/scene.h"

enum { BENCH_SUBSTITUTES = 32 };

typedef struct {
    int count;
    char scene[BENCH_SUBSTITUTES][BENCH_NAME];
    const char *file[BENCH_SUBSTITUTES];
} BenchSubstitutes;

/* Adds the option's value "NAME=FILE"; anything else, or a NAME that is no built-in scene, ends
 * the program with exit code 2. */
void bench_substitute_add(const struct argp_state *state, char *text, BenchSubstitutes *list);

/* The file for this scene, or NULL. The last one given wins. */
const char *bench_substitute_find(const BenchSubstitutes *list, const char *scene);

#endif
