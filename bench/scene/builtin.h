/* builtin.h - the scene files of bench/scenes/, compiled in by scripts/embed.cmake. */
#ifndef BENCH_BUILTIN_H
#define BENCH_BUILTIN_H

typedef struct {
    const char *name; /* "penguin" */
    const char *text; /* the file's text, zero-terminated */
} BenchBuiltin;

/* In alphabetical order; ends with an entry without a name. */
extern const BenchBuiltin bench_builtin[];

#endif
