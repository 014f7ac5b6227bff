#include "field.h"

#include <math.h>
#include <string.h>

const char *bench_field_text(const BenchField *field, const void *record)
{
    const void *member = (const char *)record + field->offset;
    if (field->text) return field->text(record);
    return field->choices ? field->choices[*(const int *)member] : member;
}

void bench_record_none(const BenchField *fields, int count, void *record, size_t size)
{
    memset(record, 0, size);
    for (int f = 0; f < count; f++) {
        const BenchField *field = &fields[f];
        double *value = (double *)(void *)((char *)record + field->offset);
        bool fraction = field->name && field->kind == BENCH_DOUBLE;
        for (size_t i = 0; fraction && i < field->size / sizeof *value; i++) value[i] = NAN;
    }
}

const BenchField *bench_record_differs(const BenchField *fields, int count, const void *a,
                                       const void *b, bool given)
{
    for (int f = 0; f < count; f++) {
        const BenchField *field = &fields[f];
        const char *left = (const char *)a + field->offset,
                   *right = (const char *)b + field->offset;
        if (!field->name || field->may_differ || (given && !field->given_by_plan)) continue;
        if (field->kind == BENCH_TEXT ? strcmp(left, right) : memcmp(left, right, field->size))
            return field;
    }
    return NULL;
}
