#include "kernel_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../table/export.h"

const char *const bench_kernel_formats[] = {"text", "markdown", "csv", "json", NULL};

/* ---- for programs */

enum { COLUMNS = 20 };

typedef struct {
    const char *name, *text; /* text NULL: a number */
    double number;           /* NaN: not given */
    bool time;               /* INVALID or BUSY, or null, in a row that has no times */
} Cell;

/* What stands for the check, and for the times of a row that has none. */
static const char *mark(const BenchKernel *row)
{
    return !row->valid ? "INVALID" : row->busy ? "BUSY" : "VALID";
}

static bool timed(const BenchKernel *row)
{
    return row->valid && !row->busy;
}

static double share(const BenchKernel *row)
{
    return 100 * row->floor_ns / row->ns;
}

static void fill_cells(const BenchKernel *row, Cell cell[COLUMNS])
{
    const Cell cells[COLUMNS] = {
        {.name = "kernel", .text = row->kernel},
        {.name = "group", .text = row->group},
        {.name = "precision", .text = row->precision},
        {.name = "threads", .number = row->threads},
        {.name = "w", .number = row->w > 0 ? row->w : NAN},
        {.name = "item", .text = row->item},
        {.name = "items", .number = (double)row->items},
        {.name = "ns", .number = row->ns, .time = true},
        {.name = "ns_low", .number = row->low, .time = true},
        {.name = "ns_high", .number = row->high, .time = true},
        {.name = "floor_ns", .number = row->floor_ns, .time = true},
        {.name = "bound", .text = row->bound},
        {.name = "share_percent", .number = share(row), .time = true},
        {.name = "at_most_ns", .number = row->at_most},
        {.name = "ratio", .number = row->ratio, .time = !(row->valid && row->own_time)},
        {.name = "ratio_to", .text = row->ratio_to},
        {.name = "ratio_wanted", .number = row->wanted},
        {.name = "verdict", .text = bench_kernel_verdict(row)},
        {.name = "valid", .text = mark(row)},
        {.name = "note", .text = timed(row) ? row->note : row->reason},
    };
    memcpy(cell, cells, sizeof cells);
}

static void write_csv(FILE *file, const BenchKernel *rows, int count)
{
    Cell cell[COLUMNS];
    fill_cells(&(BenchKernel){0}, cell);
    for (int c = 0; c < COLUMNS; c++) fprintf(file, "%s%s", c ? "," : "", cell[c].name);
    fputc('\n', file);
    for (int r = 0; r < count; r++) {
        fill_cells(&rows[r], cell);
        for (int c = 0; c < COLUMNS; c++) {
            if (c) fputc(',', file);
            if (cell[c].text)
                bench_csv_text(file, cell[c].text);
            else if (cell[c].time && !timed(&rows[r]))
                fputs(mark(&rows[r]), file);
            else
                bench_csv_number(file, cell[c].number);
        }
        fputc('\n', file);
    }
}

static json_t *json_row(const BenchKernel *row)
{
    Cell cell[COLUMNS];
    json_t *object = json_object();
    fill_cells(row, cell);
    for (int c = 0; c < COLUMNS; c++) {
        json_t *value = cell[c].text                  ? bench_json_text(cell[c].text)
                        : cell[c].time && !timed(row) ? json_null()
                                                      : bench_json_number(cell[c].number);
        if (!strcmp(cell[c].name, "valid")) {
            json_decref(value);
            value = json_boolean(row->valid);
        }
        json_object_set_new(object, cell[c].name, value);
    }
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

static void write_json(FILE *file, const BenchKernel *rows, int count,
                       const BenchCeilings *ceilings, const BenchMachine *machine)
{
    json_t *root = json_object(), *list = json_array(), *rates = json_array();
    for (int r = 0; r < count; r++) json_array_append_new(list, json_row(&rows[r]));
    json_array_append_new(rates, json_rates(&ceilings->one));
    if (ceilings->all.threads > 1) json_array_append_new(rates, json_rates(&ceilings->all));
    json_object_set_new(root, "ceilings", rates);
    json_object_set_new(root, "kernels", list);
    json_object_set_new(root, "environment", bench_json_machine(machine));
    bench_json_write(file, root);
}

/* ---- for people */

enum {
    KERNEL,
    PRECISION,
    THREADS,
    W,
    PER,
    NS,
    QUARTILES,
    FLOOR,
    SHARE,
    AT_MOST,
    RATIO,
    VERDICT,
    NOTE,
    FIELDS,
    FIELD_TEXT = 224
};

typedef struct {
    char field[FIELDS][FIELD_TEXT];
} Line;

static const Line heading = {{"kernel", "precision", "threads", "w", "per", "ns", "quartiles",
                              "floor", "share", "at most", "ratio", "verdict", "note"}};

/* Three significant digits without an exponent. */
static void number_text(double value, char text[FIELD_TEXT])
{
    int digits = value > 0 ? 2 - (int)floor(log10(value)) : 0;
    if (isfinite(value))
        snprintf(text, FIELD_TEXT, "%.*f", digits < 0 ? 0 : digits > 9 ? 9 : digits, value);
}

static void join(char text[FIELD_TEXT], const char *a, const char *between, const char *b)
{
    snprintf(text, FIELD_TEXT, "%.60s%.20s%.120s", a, between, b);
}

static void fill_ratio(const BenchKernel *row, Line *line)
{
    char ratio[FIELD_TEXT], wanted[FIELD_TEXT] = "";
    if (!isfinite(row->ratio)) return;
    number_text(row->ratio, ratio);
    join(line->field[RATIO], ratio, row->wanted_least ? "x as fast as " : " of ", row->ratio_to);
    if (!isfinite(row->wanted)) return;
    number_text(row->wanted, wanted);
    strcpy(ratio, line->field[RATIO]);
    join(line->field[RATIO], ratio, row->wanted_least ? ", at least " : ", at most ", wanted);
}

static void fill_line(const BenchKernel *row, Line *line)
{
    memset(line, 0, sizeof *line);
    snprintf(line->field[KERNEL], FIELD_TEXT, "%s", row->kernel);
    snprintf(line->field[PRECISION], FIELD_TEXT, "%s", row->precision);
    snprintf(line->field[THREADS], FIELD_TEXT, "%d", row->threads);
    if (row->w) snprintf(line->field[W], FIELD_TEXT, "%d", row->w);
    snprintf(line->field[PER], FIELD_TEXT, "%s", row->item);
    number_text(row->at_most, line->field[AT_MOST]);
    snprintf(line->field[VERDICT], FIELD_TEXT, "%s", bench_kernel_verdict(row));
    snprintf(line->field[NOTE], FIELD_TEXT, "%s", timed(row) ? row->note : row->reason);
    if (row->valid && (!row->busy || row->own_time)) fill_ratio(row, line);
    if (!timed(row)) {
        strcpy(line->field[NS], mark(row));
        return;
    }
    char low[FIELD_TEXT], high[FIELD_TEXT];
    number_text(row->ns, line->field[NS]);
    number_text(row->low, low);
    number_text(row->high, high);
    join(line->field[QUARTILES], low, "..", high);
    number_text(row->floor_ns, low);
    join(line->field[FLOOR], low, " ", row->bound);
    if (isfinite(share(row))) snprintf(line->field[SHARE], FIELD_TEXT, "%.0f%%", share(row));
}

static bool left(int field)
{
    return field == KERNEL || field == PRECISION || field == PER || field >= RATIO;
}

static void widen(const Line *line, int width[FIELDS])
{
    for (int f = 0; f < FIELDS; f++) {
        int length = (int)strlen(line->field[f]);
        if (length > width[f]) width[f] = length;
    }
}

static void print_line(FILE *file, const Line *line, const int width[FIELDS])
{
    char text[FIELDS * (FIELD_TEXT + 2) + 1];
    int used = 0;
    for (int f = 0; f < FIELDS; f++)
        used += snprintf(text + used, sizeof text - (size_t)used, "%s%*s", f ? "  " : "",
                         left(f) ? -width[f] : width[f], line->field[f]);
    while (used > 0 && text[used - 1] == ' ') text[--used] = '\0';
    fprintf(file, "%s\n", text);
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

static void write_text(FILE *file, const BenchKernel *rows, int count,
                       const BenchCeilings *ceilings, const BenchMachine *machine)
{
    int width[FIELDS] = {0};
    Line line;
    widen(&heading, width);
    for (int r = 0; r < count; r++) {
        fill_line(&rows[r], &line);
        widen(&line, width);
    }
    fprintf(file, "Ceilings measured now, on %s:\n", machine->cpu);
    print_rates(file, &ceilings->one);
    if (ceilings->all.threads > 1) print_rates(file, &ceilings->all);
    fputs(
        "\nTimes in ns, medians; those of steps in each step. The floor is the least time that the "
        "ceilings\nallow, with what sets it; the share is floor / time.\n\n",
        file);
    print_line(file, &heading, width);
    for (int r = 0; r < count; r++) {
        if (r && strcmp(rows[r].group, rows[r - 1].group) != 0) fputc('\n', file);
        fill_line(&rows[r], &line);
        print_line(file, &line, width);
    }
}

static void markdown_line(FILE *file, const Line *line)
{
    for (int f = 0; f < FIELDS; f++) {
        fputs("| ", file);
        for (const char *c = line->field[f]; *c; c++) fprintf(file, *c == '|' ? "\\%c" : "%c", *c);
        fputc(' ', file);
    }
    fputs("|\n", file);
}

static void write_markdown(FILE *file, const BenchKernel *rows, int count)
{
    Line line;
    markdown_line(file, &heading);
    for (int f = 0; f < FIELDS; f++) fputs(left(f) ? "| --- " : "| ---: ", file);
    fputs("|\n", file);
    for (int r = 0; r < count; r++) {
        fill_line(&rows[r], &line);
        markdown_line(file, &line);
    }
}

void bench_kernels_write(FILE *file, BenchKernelFormat format, const BenchKernel *rows, int count,
                         const BenchCeilings *ceilings, const BenchMachine *machine)
{
    switch (format) {
    case BENCH_KERNELS_TEXT:
        write_text(file, rows, count, ceilings, machine);
        break;
    case BENCH_KERNELS_MARKDOWN:
        write_markdown(file, rows, count);
        break;
    case BENCH_KERNELS_CSV:
        write_csv(file, rows, count);
        break;
    case BENCH_KERNELS_JSON:
        write_json(file, rows, count, ceilings, machine);
        break;
    }
}
