#include "export.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/engine/stage.h"
#include "../../lib/error.h"
#include "../../lib/printable.h"

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

/* The numbers of an array. */
static void csv_numbers(FILE *file, const BenchField *field, const void *record)
{
    const double *number = (const double *)(const void *)((const char *)record + field->offset);
    int count = field->listed ? field->listed(record) : bench_field_values(field);
    for (int i = 0; i < count; i++) {
        if (i) fputc(field->listed ? '/' : ',', file);
        bench_csv_number(file, number[i]);
    }
}

void bench_csv_cell(FILE *file, const BenchField *field, const void *record, const char *mark)
{
    if (field->timed && !field->timed(record))
        fputs(mark, file);
    else if (field->given && !field->given(record))
        return;
    else if (field->text || field->kind == BENCH_TEXT)
        bench_csv_text(file, bench_field_text(field, record));
    else if (field->number)
        bench_csv_number(file, field->number(record));
    else if (field->kind == BENCH_DOUBLE)
        csv_numbers(file, field, record);
    else
        fprintf(file, "%lld", bench_record_whole(field, record));
}

static void csv_title(FILE *file, const BenchField *field)
{
    for (int i = 0, count = field->listed ? 1 : bench_field_values(field); i < count; i++) {
        if (i) fputc(',', file);
        if (field->stages)
            fprintf(file, "%s_ms", sm_stage_name((SmStage)i));
        else if (count > 1)
            fprintf(file, "%s_%d", field->column, i + 1);
        else
            fputs(field->column, file);
    }
}

void bench_csv_records(FILE *file, const BenchField *fields, int count, const void *records,
                       size_t size, long number, const char *(*mark)(const void *record))
{
    for (long r = -1; r < number; r++) {
        const char *record = r < 0 ? NULL : (const char *)records + (size_t)r * size;
        for (int f = 0, columns = 0; f < count; f++) {
            if (!fields[f].column) continue;
            if (columns++) fputc(',', file);
            if (record)
                bench_csv_cell(file, &fields[f], record, mark ? mark(record) : NULL);
            else
                csv_title(file, &fields[f]);
        }
        fputc('\n', file);
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

static json_t *json_numbers(const double *numbers, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(list, bench_json_number(numbers[i]));
    return list;
}

json_t *bench_json_cell(const BenchField *field, const void *record)
{
    if (!bench_record_has(field, record)) return json_null();
    if (field->kind == BENCH_TEXT) return bench_json_text(bench_field_text(field, record));
    if (field->number) return bench_json_number(field->number(record));
    long long whole = bench_record_whole(field, record);
    if (field->kind == BENCH_BOOL) return json_boolean(whole);
    if (field->kind == BENCH_HASH) return json_sprintf("%016llx", (unsigned long long)whole);
    if (field->kind != BENCH_DOUBLE) return json_integer(whole);
    const double *numbers = (const double *)(const void *)((const char *)record + field->offset);
    int many = bench_field_values(field);
    if (field->listed) return json_numbers(numbers, field->listed(record));
    return many == 1 ? bench_json_number(*numbers) : json_numbers(numbers, many);
}

json_t *bench_json_record(const BenchField *fields, int count, const void *record)
{
    json_t *object = json_object();
    for (int f = 0; f < count; f++)
        if (fields[f].column)
            json_object_set_new(object, fields[f].column, bench_json_cell(&fields[f], record));
    return object;
}

json_t *bench_json_records(const BenchField *fields, int count, const void *records, size_t size,
                           long number)
{
    json_t *list = json_array();
    for (long r = 0; r < number; r++)
        json_array_append_new(
            list, bench_json_record(fields, count, (const char *)records + (size_t)r * size));
    return list;
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
