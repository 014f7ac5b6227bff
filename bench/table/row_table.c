#include "row_table.h"

#include <math.h>

#include "../store/export.h"
#include "quantity.h"

const char *const bench_format_names[] = {"text", "markdown", "csv", "latex", "json", NULL};

static void csv_samples(FILE *file, const BenchRow *row)
{
    for (int i = 0; i < row->repeats && row->total; i++) {
        if (i) fputc(' ', file);
        bench_csv_number(file, 1e3 * row->total[i]);
    }
}

/* NaN of another engine's. */
static double stage_ms(const BenchQuantity *quantity, const BenchRow *row)
{
    const double *ms = bench_quantity_stage(quantity, row);
    return ms ? *ms : NAN;
}

static void write_csv(BenchReport *report, int measured)
{
    int quantities;
    const BenchQuantity *first = bench_quantities(&quantities);
    for (int r = report->written ? report->written : -1; r < measured; r++) {
        const BenchRow *row = r < 0 ? NULL : &report->rows[r];
        int columns = 0;
        for (const BenchQuantity *quantity = first; quantity < first + quantities; quantity++) {
            if (!quantity->field.column) continue;
            if (columns++) fputc(',', report->file);
            if (!row)
                fputs(quantity->field.column, report->file);
            else if (quantity->samples && bench_row_timed(row))
                csv_samples(report->file, row);
            else if (quantity->stage && bench_row_timed(row))
                bench_csv_number(report->file, stage_ms(quantity, row));
            else
                bench_csv_cell(report->file, &quantity->field, row, bench_row_mark(row));
        }
        fputc('\n', report->file);
    }
    report->written = measured;
    fflush(report->file);
}

static json_t *json_samples(const BenchRow *row)
{
    json_t *list = json_array();
    for (int i = 0; i < row->repeats && row->total; i++)
        json_array_append_new(list, bench_json_number(1e3 * row->total[i]));
    return list;
}

/* As readers have always had them: a number stays one with a fraction where it is whole, and so
 * does a count that not every row has; busy is 0 or 1. */
static json_t *json_cell(const BenchQuantity *quantity, const BenchRow *row)
{
    const BenchField *field = &quantity->field;
    if (quantity->samples && bench_row_timed(row)) return json_samples(row);
    bool staged = quantity->stage && bench_row_timed(row);
    json_t *value =
        staged ? bench_json_number(stage_ms(quantity, row)) : bench_json_cell(field, row);
    json_t *as = NULL;
    if (json_is_integer(value) && (field->kind == BENCH_DOUBLE || field->given))
        as = json_real((double)json_integer_value(value));
    if (json_is_boolean(value) && !field->text) as = json_integer(json_is_true(value));
    if (as) json_decref(value);
    return as ? as : value;
}

static void write_json(const BenchReport *report)
{
    json_t *root = json_object(), *list = json_array();
    int quantities;
    const BenchQuantity *quantity = bench_quantities(&quantities);
    for (int r = 0; r < report->written; r++) {
        json_t *object = json_object();
        for (int q = 0; q < quantities; q++)
            if (quantity[q].field.column)
                json_object_set_new(object, quantity[q].field.column,
                                    json_cell(&quantity[q], &report->rows[r]));
        json_array_append_new(list, object);
    }
    json_object_set_new(root, "rows", list);
    json_object_set_new(root, "environment", bench_json_machine(report->machine));
    bench_json_write(report->file, root);
}

BenchGridForm bench_format_form(BenchFormat format)
{
    return format == BENCH_AS_MARKDOWN ? BENCH_GRID_MARKDOWN
           : format == BENCH_AS_LATEX  ? BENCH_GRID_LATEX
                                       : BENCH_GRID_PLAIN;
}

void bench_table_rows(BenchTable *table, int measured)
{
    BenchReport *report = &table->report;
    report->form = bench_format_form(table->format);
    if (table->format == BENCH_AS_CSV)
        write_csv(report, measured);
    else if (table->format == BENCH_AS_JSON)
        report->written = measured;
    else
        bench_report_rows(report, measured);
}

void bench_table_end(BenchTable *table)
{
    if (table->format == BENCH_AS_JSON)
        write_json(&table->report);
    else if (table->format != BENCH_AS_CSV)
        bench_report_end(&table->report, table->explain);
}
