#include "export.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../../lib/system/printable.h"

/* Whether a spreadsheet would take the text for a formula. */
static bool is_formula(const char *text)
{
    char *end;
    if (!*text || !strchr("=+-@\t\r", *text)) return false;
    strtod(text, &end);
    return end == text || *end;
}

void bench_csv_text(FILE *file, const char *text)
{
    bool formula = is_formula(text);
    if (!formula && !text[strcspn(text, ",\"\r\n")]) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    if (formula) fputc('\'', file);
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

void bench_csv_value(FILE *file, const BenchField *field, const void *value)
{
    switch (field->kind) {
    case BENCH_TEXT:
        bench_csv_text(file, value);
        return;
    case BENCH_INT:
        fprintf(file, "%d", *(const int *)value);
        return;
    case BENCH_LONG:
        fprintf(file, "%ld", *(const long *)value);
        return;
    case BENCH_BOOL:
        fprintf(file, "%d", *(const bool *)value);
        return;
    case BENCH_HASH:
        fprintf(file, "%llu", *(const unsigned long long *)value);
        return;
    case BENCH_DOUBLE:
        bench_csv_number(file, *(const double *)value);
        return;
    }
}

json_t *bench_json_text(const char *text)
{
    json_t *value = json_string(text);
    if (value) return value;
    size_t size = strlen(text);
    char *copy = sm_alloc(size + 1, 1);
    memcpy(copy, text, size + 1);
    sm_printable(copy);
    value = json_string(copy);
    free(copy);
    return value;
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

void bench_xml_text(FILE *file, const char *text)
{
    for (const char *c = text; *c;) {
        int length = sm_character(c);
        if (length == 0)
            fputc('?', file);
        else if (*c == '&')
            fputs("&amp;", file);
        else if (*c == '<')
            fputs("&lt;", file);
        else if (*c == '>')
            fputs("&gt;", file);
        else if (*c == '"')
            fputs("&quot;", file);
        else
            fwrite(c, 1, (size_t)length, file);
        c += length ? length : 1;
    }
}
