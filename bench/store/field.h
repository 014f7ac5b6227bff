/* field.h - one quantity of a C record, described once: HDF5 files, CSV, JSON and the documented
 * lists of columns are made of it. */
#ifndef BENCH_FIELD_H
#define BENCH_FIELD_H

#include <stdbool.h>
#include <stddef.h>

typedef enum {
    BENCH_TEXT,   /* char[] */
    BENCH_INT,    /* int */
    BENCH_LONG,   /* long */
    BENCH_BOOL,   /* bool, stored as 0 or 1 in 8 bits */
    BENCH_HASH,   /* unsigned long long */
    BENCH_DOUBLE, /* double, or an array of them */
} BenchKind;

typedef struct {
    const char *name; /* of the attribute or dataset in HDF5; NULL: not stored */
    BenchKind kind;
    size_t offset, size; /* in the record, bytes */
    const char *column;  /* in CSV and JSON; NULL: not there. Of an array CSV has a column for each
                          * number: those of stages by name ("fast_sum_ms"), others NAME_1, ... */
    bool stages;         /* an array of SM_STAGES milliseconds */
    bool (*timed)(const void *record);       /* of a time: does the record have it? If not, its mark
                                              * stands there, in JSON null */
    bool (*given)(const void *record);       /* is there a value? NULL: always */
    double (*number)(const void *record);    /* the value, where it is not in the record */
    const char *(*text)(const void *record); /* the same of a text; of a BENCH_BOOL as CSV has it */
    const char *unit, *meaning;              /* "ms" (NULL: none); what results/README.md says */
} BenchField;

/* A member, stored and a column under this name, or under its own. */
#define BENCH_FIELD_AS(record, type, member, title)                                                \
    .name = (title), .kind = (type), .offset = offsetof(record, member),                           \
    .size = sizeof(((record *)0)->member), .column = (title)
#define BENCH_FIELD(record, type, member)                                                          \
    {                                                                                              \
        BENCH_FIELD_AS(record, type, member, #member)                                              \
    }

/* A variable alone: its address is the record. */
#define BENCH_VARIABLE(title, type, variable)                                                      \
    {                                                                                              \
        .name = title, .kind = type, .size = sizeof(variable)                                      \
    }

#endif
