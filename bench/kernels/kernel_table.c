#include "kernel_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../store/export.h"
#include "../table/grid.h"

const char *const bench_kernel_formats[] = {"text", "markdown", "csv", "json", NULL};

/* What stands for the check, and for the times of a row that has none. */
static const char *mark(const BenchKernelRow *row)
{
    return !row->valid ? "INVALID" : row->busy ? "BUSY" : "VALID";
}

static bool timed(const BenchKernelRow *row)
{
    return row->valid && !row->busy;
}

static bool has_times(const void *record)
{
    return timed(record);
}

/* One of processor time is told of a busy row, too. */
static bool has_ratio(const void *record)
{
    const BenchKernelRow *row = record;
    return timed(row) || (row->valid && row->own_time);
}

static double share(const void *record)
{
    const BenchKernelRow *row = record;
    return 100 * row->bound_ns / row->ns;
}

static bool has_w(const void *record)
{
    return ((const BenchKernelRow *)record)->w > 0;
}

static const char *verdict_text(const void *record)
{
    return bench_kernel_verdict(record);
}

static const char *mark_text(const void *record)
{
    return mark(record);
}

static const char *note_text(const void *record)
{
    const BenchKernelRow *row = record;
    return timed(row) ? row->note : row->reason;
}

/* ---- for programs */

#define FIELD(kind, member) BENCH_FIELD(BenchKernelRow, kind, member)
#define FIELD_AS(kind, member, title)                                                              \
    {                                                                                              \
        BENCH_FIELD_AS(BenchKernelRow, kind, member, title)                                        \
    }
#define TIME(member, title)                                                                        \
    {                                                                                              \
        BENCH_FIELD_AS(BenchKernelRow, BENCH_DOUBLE, member, title), .timed = has_times            \
    }

static const BenchField fields[] = {
    FIELD(BENCH_TEXT, kernel),
    FIELD(BENCH_TEXT, group),
    FIELD(BENCH_TEXT, precision),
    FIELD(BENCH_INT, threads),
    {BENCH_FIELD_AS(BenchKernelRow, BENCH_INT, w, "w"), .given = has_w},
    FIELD(BENCH_TEXT, item),
    FIELD(BENCH_LONG, items),
    TIME(ns, "ns"),
    TIME(low, "ns_low"),
    TIME(high, "ns_high"),
    TIME(bound_ns, "floor_ns"),
    FIELD(BENCH_TEXT, bound),
    {.kind = BENCH_DOUBLE, .column = "share_percent", .number = share, .timed = has_times},
    FIELD_AS(BENCH_DOUBLE, at_most, "at_most_ns"),
    {BENCH_FIELD_AS(BenchKernelRow, BENCH_DOUBLE, ratio, "ratio"), .timed = has_ratio},
    FIELD(BENCH_TEXT, ratio_to),
    FIELD_AS(BENCH_DOUBLE, wanted, "ratio_wanted"),
    {.kind = BENCH_TEXT, .column = "verdict", .text = verdict_text},
    {BENCH_FIELD_AS(BenchKernelRow, BENCH_BOOL, valid, "valid"), .text = mark_text},
    {.kind = BENCH_TEXT, .column = "note", .text = note_text},
};
enum { COLUMNS = sizeof fields / sizeof fields[0] };

static json_t *json_row(const BenchKernelRow *row)
{
    json_t *object = bench_json_record(fields, COLUMNS, row);
    json_object_set_new(object, "busy", json_boolean(row->busy));
    return object;
}

static json_t *json_rates(const BenchRates *rates)
{
    json_t *object = json_object();
    json_object_set_new(object, "threads", json_integer(rates->threads));
    json_object_set_new(object, "single_gflops", json_real(rates->flops[BENCH_F32] / 1e9));
    json_object_set_new(object, "double_gflops", json_real(rates->flops[BENCH_F64] / 1e9));
    for (int level = 0; level < BENCH_LEVELS; level++) {
        char name[32];
        snprintf(name, sizeof name, "%s_read_gb_s", bench_level_name((BenchLevel)level));
        json_object_set_new(object, name, json_real(rates->read[level] / 1e9));
    }
    json_object_set_new(object, "DRAM_update_gb_s", json_real(rates->update / 1e9));
    return object;
}

static void write_json(FILE *file, const BenchKernelRow *rows, int count, const BenchPeak *peak,
                       const BenchMachine *machine)
{
    json_t *root = json_object(), *list = json_array(), *rates = json_array();
    for (int r = 0; r < count; r++) json_array_append_new(list, json_row(&rows[r]));
    json_array_append_new(rates, json_rates(&peak->one));
    if (peak->all.threads > 1) json_array_append_new(rates, json_rates(&peak->all));
    json_object_set_new(root, "ceilings", rates);
    json_object_set_new(root, "kernels", list);
    json_object_set_new(root, "environment", bench_json_machine(machine));
    bench_json_write(file, root);
}

/* ---- for people */

static void join(char *text, const char *a, const char *between, const char *b)
{
    snprintf(text, BENCH_GRID_TEXT, "%.60s%.20s%.120s", a, between, b);
}

/* "" where the number is not given. */
static void number_text(double value, char *text)
{
    bench_grid_number(value, text);
    if (!isfinite(value)) text[0] = '\0';
}

static void ratio_text(const BenchKernelRow *row, char *text)
{
    char ratio[BENCH_GRID_TEXT], wanted[BENCH_GRID_TEXT];
    if (!isfinite(row->ratio)) return;
    number_text(row->ratio, ratio);
    join(text, ratio, row->wanted_least ? "x as fast as " : " of ", row->ratio_to);
    if (!isfinite(row->wanted)) return;
    number_text(row->wanted, wanted);
    strcpy(ratio, text);
    join(text, ratio, row->wanted_least ? ", at least " : ", at most ", wanted);
}

enum { KERNEL, PRECISION, THREADS, W, PER, NS, QUARTILES, FLOOR, SHARE, AT_MOST, RATIO };

static const char *const headings[] = {"kernel", "precision", "threads", "w",     "per",
                                       "ns",     "quartiles", "floor",   "share", "at most",
                                       "ratio",  "verdict",   "note"};

/* Of a row that has times. */
static void fill_times(const BenchKernelRow *row, BenchGridLine *line)
{
    char low[BENCH_GRID_TEXT], high[BENCH_GRID_TEXT];
    number_text(row->ns, (*line)[NS]);
    number_text(row->low, low);
    number_text(row->high, high);
    join((*line)[QUARTILES], low, "..", high);
    number_text(row->bound_ns, low);
    join((*line)[FLOOR], low, " ", row->bound);
    if (isfinite(share(row))) snprintf((*line)[SHARE], BENCH_GRID_TEXT, "%.0f%%", share(row));
}

static void add_line(BenchGrid *grid, const BenchKernelRow *row)
{
    BenchGridLine *line = bench_grid_add(grid);
    strcpy((*line)[KERNEL], row->kernel);
    strcpy((*line)[PRECISION], row->precision);
    snprintf((*line)[THREADS], BENCH_GRID_TEXT, "%d", row->threads);
    if (has_w(row)) snprintf((*line)[W], BENCH_GRID_TEXT, "%d", row->w);
    strcpy((*line)[PER], row->item);
    number_text(row->at_most, (*line)[AT_MOST]);
    strcpy((*line)[RATIO + 1], bench_kernel_verdict(row));
    strcpy((*line)[RATIO + 2], note_text(row));
    if (has_ratio(row)) ratio_text(row, (*line)[RATIO]);
    if (timed(row))
        fill_times(row, line);
    else
        strcpy((*line)[NS], mark(row));
}

static BenchGrid make_grid(const BenchKernelRow *rows, int count)
{
    BenchGrid grid = {0};
    for (int c = 0; c < (int)(sizeof headings / sizeof headings[0]); c++)
        bench_grid_column(&grid, headings[c],
                          c == KERNEL || c == PRECISION || c == PER || c >= RATIO);
    for (int r = 0; r < count; r++) add_line(&grid, &rows[r]);
    bench_grid_fit(&grid);
    return grid;
}

static void print_rates(FILE *file, const BenchRates *rates)
{
    fprintf(file, "  %d thread%s  multiply-add %.0f GFLOP/s single, %.0f double; read",
            rates->threads, rates->threads > 1 ? "s:" : ": ", rates->flops[0] / 1e9,
            rates->flops[1] / 1e9);
    for (int level = 0; level < BENCH_LEVELS; level++)
        fprintf(file, " %s %.0f%s", bench_level_name((BenchLevel)level), rates->read[level] / 1e9,
                level + 1 < BENCH_LEVELS ? "," : "");
    fprintf(file, " GB/s; update in DRAM %.0f GB/s\n", rates->update / 1e9);
}

static void print_peak(FILE *file, const BenchPeak *peak, const BenchMachine *machine)
{
    fprintf(file, "Ceilings measured now, on %s:\n", machine->cpu);
    print_rates(file, &peak->one);
    if (peak->all.threads > 1) print_rates(file, &peak->all);
    fputs(
        "\nTimes in ns, medians; those of steps in each step. The floor is the least time that the "
        "ceilings\nallow, with what sets it; the share is floor / time.\n\n",
        file);
}

/* As text with an empty line between groups. */
static void write_people(FILE *file, BenchKernelFormat format, const BenchKernelRow *rows,
                         int count, const BenchPeak *peak, const BenchMachine *machine)
{
    bool text = format == BENCH_KERNELS_TEXT;
    BenchGridForm form = text ? BENCH_GRID_PLAIN : BENCH_GRID_MARKDOWN;
    BenchGrid grid = make_grid(rows, count), one = grid;
    if (text) print_peak(file, peak, machine);
    bench_grid_head(file, &grid, form);
    one.lines = 1;
    for (int r = 0; r < count; r++) {
        if (text && r && strcmp(rows[r].group, rows[r - 1].group) != 0) fputc('\n', file);
        one.line = &grid.line[r];
        bench_grid_lines(file, &one, form);
    }
    bench_grid_free(&grid);
}

void bench_kernels_write(FILE *file, BenchKernelFormat format, const BenchKernelRow *rows,
                         int count, const BenchPeak *peak, const BenchMachine *machine)
{
    if (format == BENCH_KERNELS_CSV)
        bench_csv_records(file, fields, COLUMNS, rows, sizeof *rows, count, mark_text);
    else if (format == BENCH_KERNELS_JSON)
        write_json(file, rows, count, peak, machine);
    else
        write_people(file, format, rows, count, peak, machine);
}
