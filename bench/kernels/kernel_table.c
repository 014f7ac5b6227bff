#include "kernel_table.h"

#include <math.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../store/export.h"
#include "../table/records.h"

/* What stands for the check, and for the times of a row that has none. */
static const char *mark(const void *record)
{
    const BenchKernelRow *row = record;
    return !row->valid ? "INVALID" : row->busy ? "BUSY" : "VALID";
}

static bool timed(const void *record)
{
    const BenchKernelRow *row = record;
    return row->valid && !row->busy;
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

static bool has_share(const void *record)
{
    return isfinite(share(record));
}

static bool has_w(const void *record)
{
    return ((const BenchKernelRow *)record)->w > 0;
}

static bool has_limit(const void *record)
{
    return isfinite(((const BenchKernelRow *)record)->at_most);
}

static const char *verdict(const void *record)
{
    return bench_kernel_verdict(record);
}

static const char *note(const void *record)
{
    const BenchKernelRow *row = record;
    return timed(row) ? row->note : row->reason;
}

/* ---- cells of the table for people */

/* "" where the number is not given. */
static void number_text(double value, char text[BENCH_GRID_TEXT])
{
    bench_grid_number(value, text);
    if (!isfinite(value)) text[0] = '\0';
}

static void ns_cell(const void *record, char *text)
{
    if (timed(record))
        number_text(((const BenchKernelRow *)record)->ns, text);
    else
        strcpy(text, mark(record));
}

static void quartiles_cell(const void *record, char *text)
{
    const BenchKernelRow *row = record;
    char low[BENCH_GRID_TEXT], high[BENCH_GRID_TEXT];
    number_text(row->low, low);
    number_text(row->high, high);
    snprintf(text, BENCH_GRID_TEXT, "%.60s..%.60s", low, high);
}

static void bound_cell(const void *record, char *text)
{
    const BenchKernelRow *row = record;
    char ns[BENCH_GRID_TEXT];
    number_text(row->bound_ns, ns);
    snprintf(text, BENCH_GRID_TEXT, "%.60s %s", ns, row->bound);
}

/* "1.97x as fast as 1 thread, at least 1.85" */
static void ratio_cell(const void *record, char *text)
{
    const BenchKernelRow *row = record;
    char ratio[BENCH_GRID_TEXT], wanted[BENCH_GRID_TEXT];
    if (!isfinite(row->ratio)) return;
    bench_grid_number(row->ratio, ratio);
    snprintf(text, BENCH_GRID_TEXT, "%.60s%s%s", ratio,
             row->wanted_least ? "x as fast as " : " of ", row->ratio_to);
    if (!isfinite(row->wanted)) return;
    bench_grid_number(row->wanted, wanted);
    sm_append(text, BENCH_GRID_TEXT, ", at %s %.60s", row->wanted_least ? "least" : "most", wanted);
}

/* ---- all columns, of files and of the table for people */

#define FIELD(type, member, title) BENCH_FIELD_AS(BenchKernelRow, BENCH_##type, member, title)

static const BenchField fields[] = {
    {FIELD(TEXT, kernel, "kernel"), .title = "kernel", .left = true},
    {FIELD(TEXT, group, "group")},
    {.kind = BENCH_TEXT, .offset = offsetof(BenchKernelRow, isa), .title = "isa", .left = true},
    {FIELD(TEXT, precision, "precision"), .title = "precision", .left = true},
    {FIELD(INT, threads, "threads"), .title = "threads"},
    {FIELD(INT, w, "w"), .given = has_w, .title = "w"},
    {FIELD(TEXT, item, "item"), .title = "per", .left = true},
    {FIELD(LONG, items, "items")},
    {BENCH_CELL("ns", ns_cell)},
    {FIELD(DOUBLE, ns, "ns"), .timed = timed},
    {FIELD(DOUBLE, low, "ns_low"), .timed = timed, BENCH_CELL("quartiles", quartiles_cell)},
    {FIELD(DOUBLE, high, "ns_high"), .timed = timed},
    {FIELD(DOUBLE, bound_ns, "floor_ns"), .timed = timed, BENCH_CELL("floor", bound_cell)},
    {FIELD(TEXT, bound, "bound")},
    {.kind = BENCH_DOUBLE,
     .column = "share_percent",
     .number = share,
     .timed = timed,
     .given = has_share,
     .title = "share",
     .format = "%.0f%%"},
    {FIELD(DOUBLE, at_most, "at_most_ns"), .given = has_limit, .title = "at most"},
    {FIELD(DOUBLE, ratio, "ratio"), .timed = has_ratio, BENCH_CELL("ratio", ratio_cell),
     .left = true},
    {FIELD(TEXT, ratio_to, "ratio_to")},
    {FIELD(DOUBLE, wanted, "ratio_wanted")},
    {.kind = BENCH_TEXT, .column = "verdict", .text = verdict, .title = "verdict", .left = true},
    {FIELD(BOOL, valid, "valid"), .text = mark},
    {.kind = BENCH_TEXT, .column = "note", .text = note, .title = "note", .left = true},
    {FIELD(TEXT, isa, "isa")},
};
enum { FIELDS = sizeof fields / sizeof fields[0] };

/* ---- for programs */

static json_t *json_row(const BenchKernelRow *row)
{
    json_t *object = bench_json_record(fields, FIELDS, row);
    json_object_set_new(object, "busy", json_boolean(row->busy));
    return object;
}

static json_t *json_rates(const char *isa, const BenchRates *rates)
{
    json_t *object = json_object();
    json_object_set_new(object, "isa", json_string(isa));
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
                       int sets, const BenchMachine *machine)
{
    json_t *root = json_object(), *list = json_array(), *rates = json_array();
    for (int r = 0; r < count; r++) json_array_append_new(list, json_row(&rows[r]));
    for (const BenchPeak *of = peak; of < peak + sets; of++) {
        json_array_append_new(rates, json_rates(of->isa, &of->one));
        if (of->all.threads > 1) json_array_append_new(rates, json_rates(of->isa, &of->all));
    }
    json_object_set_new(root, "ceilings", rates);
    json_object_set_new(root, "kernels", list);
    json_object_set_new(root, "environment", bench_json_machine(machine));
    bench_json_write(file, root);
}

/* ---- for people */

static void print_rates(FILE *file, const char *isa, const BenchRates *rates)
{
    fprintf(file, "  %-7s %d thread%s  multiply-add %.0f GFLOP/s single, %.0f double; read", isa,
            rates->threads, rates->threads > 1 ? "s:" : ": ", rates->flops[0] / 1e9,
            rates->flops[1] / 1e9);
    for (int level = 0; level < BENCH_LEVELS; level++)
        fprintf(file, " %s %.0f%s", bench_level_name((BenchLevel)level), rates->read[level] / 1e9,
                level + 1 < BENCH_LEVELS ? "," : "");
    fprintf(file, " GB/s; update in DRAM %.0f GB/s\n", rates->update / 1e9);
}

static void print_peaks(FILE *file, const BenchPeak *peak, int sets, const BenchMachine *machine)
{
    fprintf(file, "Peaks measured now, on %s:\n", machine->cpu);
    for (const BenchPeak *of = peak; of < peak + sets; of++) {
        print_rates(file, of->isa, &of->one);
        if (of->all.threads > 1) print_rates(file, of->isa, &of->all);
    }
    fputs(
        "\nTimes in ns, medians; those of steps in each step. The floor is the least time that the "
        "peaks\nallow, with what sets it; the share is floor / time.\n\n",
        file);
}

/* As text with an empty line between groups. */
static void write_people(FILE *file, BenchFormat format, const BenchKernelRow *rows, int count,
                         const BenchPeak *peak, int sets, const BenchMachine *machine)
{
    bool text = format == BENCH_AS_TEXT;
    BenchGridForm form = bench_format_form(format);
    BenchGrid grid = bench_records_grid(fields, FIELDS, rows, sizeof *rows, count, 0);
    bench_grid_fit(&grid);
    BenchGrid one = grid;
    if (text) print_peaks(file, peak, sets, machine);
    if (form == BENCH_GRID_MARKDOWN) bench_machine_measured(file, machine);
    bench_grid_head(file, &grid, form);
    one.lines = 1;
    for (int r = 0; r < count; r++) {
        if (text && r && strcmp(rows[r].group, rows[r - 1].group) != 0) fputc('\n', file);
        one.line = &grid.line[r];
        bench_grid_lines(file, &one, form);
    }
    bench_grid_end(file, form);
    bench_grid_free(&grid);
}

void bench_kernels_write(FILE *file, BenchFormat format, const BenchKernelRow *rows, int count,
                         const BenchPeak *peak, int sets, const BenchMachine *machine)
{
    if (format == BENCH_AS_CSV)
        bench_csv_records(file, fields, FIELDS, rows, sizeof *rows, count, mark);
    else if (format == BENCH_AS_JSON)
        write_json(file, rows, count, peak, sets, machine);
    else
        write_people(file, format, rows, count, peak, sets, machine);
}
