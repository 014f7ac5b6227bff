/* builtin.h - the scene files of bench/scenes/, compiled in by bench/scenes.cmake. */
#ifndef BENCH_BUILTIN_H
#define BENCH_BUILTIN_H

#include <stddef.h>

typedef struct {
    const char *name; /* "penguin" */
    const char *text; /* the file's text, zero-terminated */
    size_t size;      /* without the zero */
} BenchBuiltin;

/* In alphabetical order; ends with an entry without a name. */
extern const BenchBuiltin bench_builtin[];

#endif
