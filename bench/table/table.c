#include "table.h"

#include <math.h>
#include <string.h>

#include "export.h"

const char *const bench_format_names[] = {"text", "markdown", "csv", "latex", "json", NULL};

enum { COLUMNS = 38 };

static const char *const column_names[COLUMNS] = {
    "paper",
    "scene",
    "engine",
    "particles",
    "regions",
    "w",
    "epsilon",
    "fast_sum_ms",
    "shape_matching_ms",
    "polar_ms",
    "damping_ms",
    "other_ms",
    "total_ms",
    "ns_per_particle_step",
    "paper_total_ms",
    "ratio",
    "valid",
    "fps",
    "speedup",
    "summation_nodes",
    "last_particles",
    "frame_ms",
    "last_frame_ms",
    "resampling_ms",
    "most_resampling_ms",
    "splitting_ms",
    "surface_ms",
    "nodes",
    "modes",
    "matrices_s",
    "modes_s",
    "total_low_ms",
    "total_high_ms",
    "steps",
    "busy",
    "lost_percent",
    "load",
    "samples_ms",
};

/* A value of one of these kinds. */
typedef struct {
    const char *text;
    long whole;            /* also the number of samples */
    double number;         /* NaN: not given */
    const double *samples; /* s */
    enum {
        TEXT,
        WHOLE,
        NUMBER,
        TIME,
        SAMPLES,
        VALID
    } kind; /* TIME, SAMPLES: not of rows that are INVALID or BUSY */
} Cell;

static void fill_cells(const BenchRow *row, Cell cell[COLUMNS])
{
    Cell *c = cell;
    *c++ = (Cell){.kind = TEXT, .text = row->paper};
    *c++ = (Cell){.kind = TEXT, .text = row->scene};
    *c++ = (Cell){.kind = TEXT, .text = row->engine};
    *c++ = (Cell){.kind = WHOLE, .whole = row->particles};
    *c++ = (Cell){.kind = WHOLE, .whole = row->regions};
    *c++ = (Cell){.kind = WHOLE, .whole = row->w};
    *c++ = (Cell){.kind = NUMBER, .number = row->epsilon};
    for (int s = 0; s < SM_STAGES; s++) *c++ = (Cell){.kind = TIME, .number = row->stage_ms[s]};
    *c++ = (Cell){.kind = TIME, .number = row->total_ms};
    *c++ = (Cell){.kind = TIME, .number = row->ns_per_particle_step};
    *c++ = (Cell){.kind = NUMBER, .number = row->paper_total_ms};
    *c++ = (Cell){.kind = TIME, .number = row->paper_total_ms / row->total_ms};
    *c++ = (Cell){.kind = VALID, .whole = row->valid};
    *c++ = (Cell){.kind = TIME, .number = row->fps};
    *c++ = (Cell){.kind = TIME, .number = row->speedup};
    *c++ = (Cell){.kind = NUMBER, .number = row->summation_nodes};
    const BenchChangeRow *change = &row->change;
    bool changes = change->frames > 0;
    *c++ = (Cell){.kind = NUMBER, .number = changes ? (double)change->last_nodes : NAN};
    const double times[] = {change->first_ms,       change->last_ms,   change->change_ms,
                            change->change_most_ms, change->follow_ms, change->surface_ms};
    for (int i = 0; i < 6; i++) *c++ = (Cell){.kind = TIME, .number = changes ? times[i] : NAN};
    const BenchElasticRow *elastic = &row->elastic;
    bool moves = elastic->nodes > 0;
    *c++ = (Cell){.kind = NUMBER, .number = moves ? (double)elastic->nodes : NAN};
    *c++ = (Cell){.kind = NUMBER, .number = moves ? (double)elastic->modes : NAN};
    *c++ = (Cell){.kind = TIME, .number = moves ? elastic->matrix_seconds : NAN};
    *c++ = (Cell){.kind = TIME, .number = moves ? elastic->mode_seconds : NAN};
    *c++ = (Cell){.kind = TIME, .number = row->total_low_ms};
    *c++ = (Cell){.kind = TIME, .number = row->total_high_ms};
    *c++ = (Cell){.kind = WHOLE, .whole = row->steps};
    *c++ = (Cell){.kind = WHOLE, .whole = row->busy};
    *c++ = (Cell){.kind = NUMBER, .number = row->lost_percent};
    *c++ = (Cell){.kind = NUMBER, .number = row->load};
    *c++ = (Cell){.kind = SAMPLES, .samples = row->total, .whole = row->total ? row->repeats : 0};
}

static void csv_cell(FILE *file, const Cell *cell, const BenchRow *row)
{
    if (cell->kind == TEXT)
        bench_csv_text(file, cell->text);
    else if (cell->kind == WHOLE)
        fprintf(file, "%ld", cell->whole);
    else if (cell->kind == VALID || (cell->kind >= TIME && !bench_row_timed(row)))
        fputs(bench_row_mark(row), file);
    else if (cell->kind == SAMPLES)
        for (long i = 0; i < cell->whole; i++) {
            if (i) fputc(' ', file);
            bench_csv_number(file, 1e3 * cell->samples[i]);
        }
    else
        bench_csv_number(file, cell->number);
}

static void write_csv(BenchReport *report, int measured)
{
    FILE *file = report->file;
    for (int c = 0; c < COLUMNS && !report->written; c++)
        fprintf(file, "%s%s%s", c ? "," : "", column_names[c], c + 1 < COLUMNS ? "" : "\n");
    for (; report->written < measured; report->written++) {
        const BenchRow *row = &report->rows[report->written];
        Cell cell[COLUMNS];
        fill_cells(row, cell);
        for (int c = 0; c < COLUMNS; c++) {
            if (c) fputc(',', file);
            csv_cell(file, &cell[c], row);
        }
        fputc('\n', file);
    }
    fflush(file);
}

static json_t *json_cell(const Cell *cell, const BenchRow *row)
{
    if (cell->kind == TEXT) return bench_json_text(cell->text);
    if (cell->kind == WHOLE) return json_integer(cell->whole);
    if (cell->kind == VALID) return json_boolean(row->valid);
    if ((cell->kind >= TIME && !bench_row_timed(row)) || !isfinite(cell->number))
        return json_null();
    if (cell->kind == SAMPLES) {
        json_t *list = json_array();
        for (long i = 0; i < cell->whole; i++)
            json_array_append_new(list, bench_json_number(1e3 * cell->samples[i]));
        return list;
    }
    return json_real(cell->number);
}

static void write_json(const BenchReport *report)
{
    json_t *list = json_array();
    for (int r = 0; r < report->written; r++) {
        const BenchRow *row = &report->rows[r];
        Cell cell[COLUMNS];
        fill_cells(row, cell);
        json_t *object = json_object();
        for (int c = 0; c < COLUMNS; c++)
            json_object_set_new(object, column_names[c], json_cell(&cell[c], row));
        json_array_append_new(list, object);
    }
    json_t *root = json_object();
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
