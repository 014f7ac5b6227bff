#include "records.h"

#include <math.h>
#include <string.h>

static void number_cell(const BenchField *field, double value, char *text)
{
    double shown = field->scale != 0 ? field->scale * value : value;
    if (isnan(value))
        strcpy(text, "-");
    else if (field->format)
        snprintf(text, BENCH_GRID_TEXT, field->format, shown);
    else if (value == 0)
        strcpy(text, "0");
    else
        bench_grid_number(shown, text);
}

void bench_record_cell(const BenchField *field, const void *record, char *text)
{
    const void *value = (const char *)record + field->offset;
    if (field->cell)
        field->cell(record, text);
    else if (field->text || field->kind == BENCH_TEXT)
        snprintf(text, BENCH_GRID_TEXT, "%s", bench_field_text(field, record));
    else if (field->kind == BENCH_BOOL)
        strcpy(text, *(const bool *)value ? "*" : "");
    else if (field->kind == BENCH_INT)
        snprintf(text, BENCH_GRID_TEXT, "%d", *(const int *)value);
    else if (field->kind == BENCH_LONG && !field->number && !field->format && field->scale == 0)
        snprintf(text, BENCH_GRID_TEXT, "%ld", *(const long *)value);
    else
        number_cell(field, bench_record_number(field, record), text);
}

static bool shown(const BenchField *field, int table)
{
    return field->title && (!field->tables || field->tables >> table & 1);
}

BenchGrid bench_records_grid(const BenchField *fields, int count, const void *records, size_t size,
                             long number, int table)
{
    BenchGrid grid = {0};
    for (int f = 0; f < count; f++)
        if (shown(&fields[f], table)) bench_grid_column(&grid, fields[f].title, fields[f].left);
    for (long r = 0; r < number; r++) {
        BenchGridLine *line = bench_grid_add(&grid);
        for (int f = 0, c = 0; f < count; f++)
            if (shown(&fields[f], table)) {
                const void *record = (const char *)records + (size_t)r * size;
                if (bench_record_has(&fields[f], record))
                    bench_record_cell(&fields[f], record, (*line)[c]);
                c++;
            }
    }
    return grid;
}

void bench_field_type(const BenchField *field, size_t size, char *text)
{
    static const char *const names[] = {
        [BENCH_TEXT] = "text",  [BENCH_INT] = "int32",   [BENCH_LONG] = "int64",
        [BENCH_BOOL] = "uint8", [BENCH_HASH] = "uint64", [BENCH_DOUBLE] = "float64"};
    int values = bench_field_values(field);
    if (field->series)
        snprintf(text, size, "%s [repeats]", names[field->kind]);
    else if (values > 1)
        snprintf(text, size, "%s [%d]", names[field->kind], values);
    else
        snprintf(text, size, "%s", names[field->kind]);
}

void bench_records_document(FILE *file, const char *place, const BenchField *fields, int count)
{
    char type[32];
    fprintf(file, "| %s | type | unit | meaning |\n| --- | --- | --- | --- |\n", place);
    for (int f = 0; f < count; f++) {
        if (!fields[f].name) continue;
        bench_field_type(&fields[f], sizeof type, type);
        fprintf(file, "| `%s` | %s | %s | %s |\n", fields[f].name, type,
                fields[f].unit ? fields[f].unit : "", fields[f].meaning);
    }
}
