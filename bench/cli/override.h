/* override.h - the options of commands that run scenes by which a user replaces what a scene says:
 * --engine, --precision, --layout and --mesh. */
#ifndef BENCH_OVERRIDE_H
#define BENCH_OVERRIDE_H

#include <argp.h>

#include "substitute.h"

typedef struct {
    const char *engine;    /* NULL: the scene's */
    const char *precision; /* NULL: the engine's first */
    int layout;            /* SmLayout; below 0: the scene's */
    BenchSubstitutes substitutes;
} BenchOverride;

/* The only child of a command's argp; a BenchOverride, which it clears first, is its input. */
extern const struct argp_child bench_override_children[];

#endif
