/* field.h - one quantity of a C record, described once: HDF5 files, CSV, JSON, tables for people
 * (records.h) and the documented lists of columns are made of it. */
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
    bool series;         /* an array of as many numbers as a campaign's plan says (campaign.h) */
    bool given_by_plan;  /* of a campaign's point: a setting of its plan's, not a result */
    bool may_differ;     /* of a campaign: between two plans, or files, that hold the same */
    bool (*timed)(const void *record);       /* of a time: does the record have it? If not, its mark
                                              * stands there, in JSON null */
    bool (*given)(const void *record);       /* is there a value? NULL: always */
    double (*number)(const void *record);    /* the value, where it is not in the record */
    const char *(*text)(const void *record); /* the same of a text; of a BENCH_BOOL as CSV has it */
    const char *const *choices; /* of a text: the member is an enum, and these are its names */
    const char *unit, *meaning; /* "ms" (NULL: none); what results/README.md says */
    int (*listed)(const void *record); /* of an array: how many numbers it has, which CSV has
                                        * in one column, as "1/2/3" */
    const char *title;                 /* heading in tables for people; NULL: not there */
    unsigned tables;                   /* in which of several, bits 1 << number; 0: all */
    bool left;                         /* aligned left */
    const char *format; /* of its number there, for printf() with a double; NULL: three digits */
    double scale;       /* times which it is there; 0: 1 */
    void (*cell)(const void *record, char *text); /* writes what it has there; NULL: its value */
} BenchField;

/* A member, stored and a column under this name, or under its own. */
#define BENCH_FIELD_AS(record, type, member, title)                                                \
    .name = (title), .kind = (type), .offset = offsetof(record, member),                           \
    .size = sizeof(((record *)0)->member), .column = (title)
#define BENCH_FIELD(record, type, member)                                                          \
    {                                                                                              \
        BENCH_FIELD_AS(record, type, member, #member)                                              \
    }

#define BENCH_MEANS(of_what, what) .unit = (of_what), .meaning = (what)

/* A cell of tables for people that is no column of files. */
#define BENCH_CELL(heading, write) .title = (heading), .cell = (write)

/* A variable alone: its address is the record. */
#define BENCH_VARIABLE(title, type, variable)                                                      \
    {                                                                                              \
        .name = title, .kind = type, .size = sizeof(variable)                                      \
    }

/* How many values a field's member is: of an array of numbers several. */
int bench_field_values(const BenchField *field);

/* The text that a BENCH_TEXT of a record is. */
const char *bench_field_text(const BenchField *field, const void *record);

/* Has the record a value there, and if it is a time, that? */
bool bench_record_has(const BenchField *field, const void *record);

/* The whole number that a field of a record is, a hash's bits; of others 0. */
long long bench_record_whole(const BenchField *field, const void *record);

/* The number that a field of a record is; of an array the first, of a text NaN. */
double bench_record_number(const BenchField *field, const void *record);

/* A record that is not measured yet: all zero, but every number that has a fraction NaN. */
void bench_record_none(const BenchField *fields, int count, void *record, size_t size);

/* The first field that is stored and not the same to the last bit in both, or NULL. Fields that
 * may differ are left out; with `given` also those that are not given by the plan. */
const BenchField *bench_record_differs(const BenchField *fields, int count, const void *a,
                                       const void *b, bool given);

#endif
