#include "export.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

void bench_csv_text(FILE *file, const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"') fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

void bench_csv_number(FILE *file, double value)
{
    if (isfinite(value)) fprintf(file, "%.9g", value);
}

json_t *bench_json_text(const char *text)
{
    json_t *value = json_string(text);
    if (value) return value;
    char copy[1024];
    size_t i = 0;
    for (; text[i] && i < sizeof copy - 1; i++)
        copy[i] = (unsigned char)text[i] < 128 ? text[i] : '?';
    copy[i] = '\0';
    return json_string(copy);
}

json_t *bench_json_number(double value)
{
    if (!isfinite(value)) return json_null();
    return value == rint(value) && fabs(value) < 1e15 ? json_integer((json_int_t)value)
                                                      : json_real(value);
}

static json_t *json_value(const BenchField *field, const void *value)
{
    switch (field->kind) {
    case BENCH_TEXT:
        return bench_json_text(value);
    case BENCH_INT:
        return json_integer(*(const int *)value);
    case BENCH_LONG:
        return json_integer(*(const long *)value);
    case BENCH_BOOL:
        return json_boolean(*(const bool *)value);
    case BENCH_HASH: {
        char text[24]; /* beyond what a JSON number holds exactly */
        snprintf(text, sizeof text, "%016llx", *(const unsigned long long *)value);
        return json_string(text);
    }
    case BENCH_DOUBLE:
        break;
    }
    const double *numbers = value;
    size_t many = field->size / sizeof *numbers;
    if (many == 1) return bench_json_number(*numbers);
    json_t *list = json_array();
    for (size_t i = 0; i < many; i++) json_array_append_new(list, bench_json_number(numbers[i]));
    return list;
}

json_t *bench_json_record(const BenchField *fields, int count, const void *record)
{
    json_t *object = json_object();
    for (int f = 0; f < count; f++)
        json_object_set_new(object, fields[f].name,
                            json_value(&fields[f], (const char *)record + fields[f].offset));
    return object;
}

json_t *bench_json_machine(const BenchMachine *machine)
{
    int count;
    const BenchField *fields = bench_machine_fields(&count);
    return bench_json_record(fields, count, machine);
}

void bench_json_write(FILE *file, json_t *root)
{
    json_dumpf(root, file, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    fputc('\n', file);
    json_decref(root);
}
