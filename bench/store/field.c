#include "field.h"

#include <math.h>
#include <string.h>

const char *bench_field_text(const BenchField *field, const void *record)
{
    const void *member = (const char *)record + field->offset;
    if (field->text) return field->text(record);
    return field->choices ? field->choices[*(const int *)member] : member;
}

int bench_field_values(const BenchField *field)
{
    size_t one = field->kind == BENCH_DOUBLE ? sizeof(double)
                 : field->kind == BENCH_INT  ? sizeof(int)
                                             : field->size;
    return field->size > one ? (int)(field->size / one) : 1;
}

bool bench_record_has(const BenchField *field, const void *record)
{
    return (!field->timed || field->timed(record)) && (!field->given || field->given(record));
}

long long bench_record_whole(const BenchField *field, const void *record)
{
    const void *value = (const char *)record + field->offset;
    return field->kind == BENCH_INT    ? *(const int *)value
           : field->kind == BENCH_LONG ? *(const long *)value
           : field->kind == BENCH_BOOL ? *(const bool *)value
           : field->kind == BENCH_HASH ? (long long)*(const unsigned long long *)value
                                       : 0;
}

double bench_record_number(const BenchField *field, const void *record)
{
    const double *number = (const double *)(const void *)((const char *)record + field->offset);
    if (field->number) return field->number(record);
    if (field->kind == BENCH_TEXT) return NAN;
    return field->kind == BENCH_DOUBLE ? *number : (double)bench_record_whole(field, record);
}

void bench_record_none(const BenchField *fields, int count, void *record, size_t size)
{
    memset(record, 0, size);
    for (int f = 0; f < count; f++) {
        const BenchField *field = &fields[f];
        double *value = (double *)(void *)((char *)record + field->offset);
        bool fraction = field->name && field->kind == BENCH_DOUBLE;
        for (int i = 0; fraction && i < bench_field_values(field); i++) value[i] = NAN;
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
