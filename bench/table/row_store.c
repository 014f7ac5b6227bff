#include "row_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../reference/paper.h"
#include "../engines.h"
#include "../measure/measure.h"
#include "quantity.h"

static const char file_kind[] = "shapebench results";

enum { MOST_ROWS = 100000, MOST_REPEATS = 1000000, MOST_STAGES = 64, LEAST_ROW = 256 /* bytes */ };

void bench_store_stages(const char *engine, size_t size, char *names)
{
    names[0] = '\0';
    for (int stage = 0; stage < SM_STAGES; stage++) {
        const char *name = sm_engine_stage(bench_engine(engine)->type[0], (SmStage)stage);
        sm_append(names, size, "%s%s", stage ? " " : "", name ? name : "-");
    }
}

/* More of the paper's row, where one is set beside this one, and how its values came to us. */
static void write_paper(BenchH5 *h5, hid_t group, const BenchRow *row)
{
    const RefPaperRow *paper = ref_paper_find(row->paper, row->paper_row);
    char stages[SM_STAGES * 16] = "";
    double percent[SM_STAGES];
    if (!paper) return;
    for (int s = 0; s < SM_STAGES; s++) {
        percent[s] = paper->stage_percent[s].value;
        sm_append(stages, sizeof stages, "%s%s", s ? " " : "",
                  ref_status_name(paper->stage_ms[s].status));
    }
    bench_h5_text(h5, group, "paper_total_status", ref_status_name(paper->total_ms.status));
    bench_h5_text(h5, group, "paper_rate_status", ref_status_name(paper->fps.status));
    bench_h5_text(h5, group, "paper_stage_status", stages);
    bench_h5_numbers(h5, group, "paper_stage_percent", H5T_IEEE_F64LE, SM_STAGES, percent);
    bench_h5_numbers(h5, group, "paper_particles", H5T_IEEE_F64LE, 0, &paper->particles.value);
}

static void write_quantities(BenchH5 *h5, hid_t group, const BenchRow *row, bool elastic)
{
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++)
        if (quantity[q].elastic == elastic) bench_h5_fields(h5, group, &quantity[q].field, 1, row);
}

void bench_store_row(BenchH5 *h5, hid_t parent, int index, const BenchRow *row)
{
    char name[16], stages[128];
    snprintf(name, sizeof name, "%03d", index);
    bench_store_stages(row->engine, sizeof stages, stages);
    hid_t group = bench_h5_group(h5, parent, name);
    write_quantities(h5, group, row, false);
    bench_h5_text(h5, group, "stages", stages);
    write_paper(h5, group, row);
    hsize_t size[] = {(hsize_t)row->repeats, SM_STAGES};
    bench_h5_dataset(h5, group, "total", H5T_IEEE_F64LE, 1, size, row->total);
    bench_h5_dataset(h5, group, "stage", H5T_IEEE_F64LE, 2, size, row->stage);
    hsize_t counters[] = {(hsize_t)row->repeats, BENCH_COUNTERS};
    if (bench_row_counted(row))
        bench_h5_dataset(h5, group, "counters", H5T_IEEE_F64LE, 2, counters, row->counter);
    hsize_t frames[] = {(hsize_t)row->change.frames, BENCH_FRAME_PARTS};
    if (row->change.frames)
        bench_h5_dataset(h5, group, "frames", H5T_IEEE_F64LE, 2, frames, row->change.time);
    if (row->elastic.nodes) {
        hid_t elastic = bench_h5_group(h5, group, "elastic");
        write_quantities(h5, elastic, row, true);
        if (elastic >= 0) H5Gclose(elastic);
    }
    if (group >= 0) H5Gclose(group);
}

/* A dataset of `count` lines of so many numbers (0: a list), which the caller frees. */
static void *read_samples(BenchH5 *h5, hid_t group, const char *name, long count, int each)
{
    hsize_t size[] = {(hsize_t)count, (hsize_t)each};
    hid_t dataset = bench_h5_find_dataset(h5, group, name, each ? 2 : 1, size);
    if (h5->failed) return NULL;
    double *values = sm_alloc((size_t)count * (size_t)(each ? each : 1), sizeof *values);
    bench_h5_read(h5, dataset, H5T_NATIVE_DOUBLE, values);
    return values;
}

/* What an older file lacks is NaN, or "" as in the zeroed row. */
static void read_later(BenchH5 *h5, hid_t group, const BenchField *field, BenchRow *row)
{
    if (field->kind == BENCH_DOUBLE) *(double *)(void *)((char *)row + field->offset) = NAN;
    bench_h5_read_what_is_there(h5, group, field, 1, row);
}

static void read_quantities(BenchH5 *h5, hid_t group, BenchRow *row, bool elastic)
{
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++)
        if (quantity[q].elastic == elastic && quantity[q].later)
            read_later(h5, group, &quantity[q].field, row);
        else if (quantity[q].elastic == elastic)
            bench_h5_read_fields(h5, group, &quantity[q].field, 1, row);
}

static void read_counters(BenchH5 *h5, hid_t group, BenchRow *row)
{
    if (!h5->failed && bench_row_counted(row))
        row->counter = read_samples(h5, group, "counters", row->repeats, BENCH_COUNTERS);
}

void bench_store_read_row(BenchH5 *h5, hid_t parent, int index, BenchRow *row)
{
    char name[16];
    snprintf(name, sizeof name, "%03d", index);
    hid_t group = bench_h5_find_group(h5, parent, name);
    read_quantities(h5, group, row, false);
    row->total = read_samples(h5, group, "total", row->repeats, 0);
    row->stage = read_samples(h5, group, "stage", row->repeats, SM_STAGES);
    read_counters(h5, group, row);
    if (row->change.frames)
        row->change.time = read_samples(h5, group, "frames", row->change.frames, BENCH_FRAME_PARTS);
    if (!h5->failed && H5Lexists(group, "elastic", H5P_DEFAULT) > 0)
        read_quantities(h5, bench_h5_find_group(h5, group, "elastic"), row, true);
    if (!h5->failed) return;
    row->repeats = 0;
    row->change.frames = 0;
}

/* What each attribute of a row is, for readers: "median of a step [ms]". */
static void write_columns(BenchH5 *h5)
{
    hid_t columns = bench_h5_group(h5, h5->file, "columns");
    hid_t elastic = bench_h5_group(h5, columns, "elastic");
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++) {
        const BenchField *field = &quantity[q].field;
        char text[512];
        if (!field->name) continue;
        snprintf(text, sizeof text, field->unit ? "%s [%s]" : "%s", field->meaning, field->unit);
        bench_h5_text(h5, quantity[q].elastic ? elastic : columns, field->name, text);
    }
}

/* What a file is to hold. */
typedef struct {
    const BenchRow *rows;
    int count;
    const BenchMachine *machine;
} File;

static void write_file(BenchH5 *h5, void *record)
{
    const File *file = record;
    int schema = BENCH_STORE_SCHEMA;
    bench_h5_text(h5, h5->file, "kind", file_kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_numbers(h5, h5->file, "rows", H5T_STD_I32LE, 0, &file->count);
    bench_machine_store(h5, file->machine);
    write_columns(h5);
    hid_t group = bench_h5_group(h5, h5->file, "rows");
    for (int i = 0; i < file->count; i++) bench_store_row(h5, group, i, &file->rows[i]);
}

SmCode bench_store_rows(const char *path, const BenchRow *rows, int count,
                        const BenchMachine *machine, SmError *error)
{
    return bench_h5_store(path, write_file, &(File){rows, count, machine}, error);
}

/* ---- files of any schema */

/* In every schema so far; what else there is of every row is read where it is stored. */
static const BenchField needed[] = {
    BENCH_FIELD(BenchRow, BENCH_TEXT, scene),
    BENCH_FIELD(BenchRow, BENCH_BOOL, valid),
    BENCH_FIELD(BenchRow, BENCH_INT, repeats),
};

/* Which of the file's columns holds each of our stages, or -1; returns how many columns there are.
 */
static int find_columns(BenchH5 *h5, hid_t group, int column[SM_STAGES])
{
    char names[512] = "";
    bench_h5_read_text(h5, group, "stages", sizeof names, names);
    for (int s = 0; s < SM_STAGES; s++) column[s] = -1;
    int columns = 0;
    char *rest = names;
    for (char *name; (name = strtok_r(rest, " ", &rest)) && columns < MOST_STAGES; columns++)
        if (bench_stage_find(name) < SM_STAGES) column[bench_stage_find(name)] = columns;
    return columns;
}

static void read_stages(BenchH5 *h5, hid_t group, BenchRow *row)
{
    int column[SM_STAGES], columns = find_columns(h5, group, column);
    if (!columns) bench_h5_fail(h5, "attribute 'stages' names none");
    double *all = read_samples(h5, group, "stage", row->repeats, columns);
    if (!all) return;
    row->stage = sm_alloc((size_t)row->repeats, sizeof *row->stage);
    for (int r = 0; r < row->repeats; r++)
        for (int s = 0; s < SM_STAGES; s++)
            row->stage[r][s] = column[s] < 0 ? NAN : all[r * columns + column[s]];
    free(all);
}

static void read_times(BenchH5 *h5, hid_t group, BenchRow *row)
{
    if (!h5->failed && (row->repeats < 1 || row->repeats > MOST_REPEATS))
        bench_h5_fail(h5, "repeats is %d", row->repeats);
    row->total = read_samples(h5, group, "total", row->repeats, 0);
    for (int r = 0; r < row->repeats && row->valid && !h5->failed; r++)
        if (!isfinite(row->total[r]) || row->total[r] <= 0)
            bench_h5_fail(h5, "dataset 'total' holds %g s", row->total[r]);
    if (!h5->failed) read_stages(h5, group, row);
    read_counters(h5, group, row);
}

/* A failure's message is preceded by the row. */
static void read_what_is_there(BenchH5 *h5, hid_t parent, int index, BenchRow *row)
{
    char name[16], message[sizeof h5->message];
    snprintf(name, sizeof name, "%03d", index);
    hid_t group = bench_h5_find_group(h5, parent, name);
    row->epsilon = row->h = NAN;
    bench_h5_read_fields(h5, group, needed, sizeof needed / sizeof *needed, row);
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++) {
        const BenchField *field = &quantity[q].field;
        if (field->name && quantity[q].later)
            read_later(h5, group, field, row);
        else if (field->name && !quantity[q].of && bench_field_values(field) == 1)
            bench_h5_read_what_is_there(h5, group, field, 1, row);
    }
    read_times(h5, group, row);
    if (!h5->failed) return;
    snprintf(message, sizeof message, "row %s: %.200s", name, h5->message);
    memcpy(h5->message, message, sizeof message);
}

/* Where what is read goes. */
typedef struct {
    BenchRow **rows;
    int *count;
    BenchMachine *machine;
} Load;

static void read_file(BenchH5 *h5, void *record)
{
    Load *load = record;
    int stored = 0;
    const BenchField field = BENCH_VARIABLE("rows", BENCH_INT, stored);
    bench_h5_check_kind(h5, file_kind, 1, BENCH_STORE_SCHEMA);
    bench_h5_read_fields(h5, h5->file, &field, 1, &stored);
    bench_machine_load(h5, load->machine);
    hid_t group = bench_h5_find_group(h5, h5->file, "rows");
    if (!h5->failed && (stored < 1 || stored > MOST_ROWS || (hsize_t)stored > h5->size / LEAST_ROW))
        bench_h5_fail(h5, "it states %d rows", stored);
    if (h5->failed) return;
    *load->rows = sm_alloc((size_t)stored, sizeof **load->rows);
    *load->count = stored;
    for (int i = 0; i < stored && !h5->failed; i++)
        read_what_is_there(h5, group, i, &(*load->rows)[i]);
}

SmCode bench_store_load(const char *path, BenchRow **rows, int *count, BenchMachine *machine,
                        SmError *error)
{
    *rows = NULL;
    *count = 0;
    memset(machine, 0, sizeof *machine);
    SmCode code = bench_h5_load(path, read_file, &(Load){rows, count, machine}, error);
    if (!code) return SM_OK;
    bench_rows_free(*rows, *count);
    *rows = NULL;
    *count = 0;
    return code;
}
