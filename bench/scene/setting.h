/* setting.h - libconfig settings into structs by a table, with line-numbered errors.
 *
 * A table names every setting that a group may have, its kind, range, and place in the struct.
 * Anything else in the group is an error that lists what is known. */
#ifndef BENCH_SETTING_H
#define BENCH_SETTING_H

#include <libconfig.h>
#include <stddef.h>

#include "../../lib/error.h"

typedef enum {
    BENCH_INT,    /* int, low..high */
    BENCH_LONG,   /* long, low..high */
    BENCH_REAL,   /* double, low..high */
    BENCH_BOOL,   /* bool */
    BENCH_TEXT,   /* char[high] */
    BENCH_VECTOR, /* double[3], each low..high */
    BENCH_CHOICE, /* an enum; `words` in its order, separated by |; low 1: it must be given */
    BENCH_GROUP,  /* a group with its own table */
    BENCH_LIST,   /* a list of at most `high` groups with their own table */
} BenchKind;

typedef struct BenchSetting {
    const char *name;
    BenchKind kind;
    size_t offset; /* in the struct that the table describes */
    double low, high;
    const char *words;
    const struct BenchSetting *table; /* group, list: ends with an entry without a name */
    size_t size;                      /* list: bytes of an element */
    size_t count;                     /* list: offset of the int that takes how many */
} BenchSetting;

/* Reads `group` into `target`. A setting that is absent leaves its place as it is. `file` is for
 * the messages: "file:line: ...". Errors: SM_INPUT. */
SmCode bench_settings_read(const config_setting_t *group, const BenchSetting *table, void *target,
                           const char *file, SmError *error);

#endif
