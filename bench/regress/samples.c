#include "samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../measure/measure.h"
#include "../table/quantity.h"
#include "../table/row_store.h"

#define FIELD(kind, member) BENCH_FIELD(BenchRow, kind, member)
#define COUNT(array)        ((int)(sizeof(array) / sizeof((array)[0])))

enum { MOST_ROWS = 100000, MOST_REPEATS = 1000000, MOST_STAGES = 64, LEAST_ROW = 256 /* bytes */ };

/* In every schema so far; what else there is of every row is read where it is stored. */
static const BenchField needed[] = {
    FIELD(BENCH_TEXT, scene),
    FIELD(BENCH_BOOL, valid),
    FIELD(BENCH_INT, repeats),
};

static void read_where_there(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                             void *record)
{
    for (int i = 0; i < count && !h5->failed; i++)
        if (H5Aexists(object, fields[i].name) > 0)
            bench_h5_read_fields(h5, object, &fields[i], 1, record);
}

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
    hsize_t size[] = {(hsize_t)row->repeats, (hsize_t)columns};
    hid_t dataset = bench_h5_find_dataset(h5, group, "stage", 2, size);
    if (h5->failed) return;
    size_t repeats = (size_t)row->repeats;
    double *all = sm_alloc(repeats * (size_t)columns, sizeof *all);
    bench_h5_read(h5, dataset, H5T_NATIVE_DOUBLE, all);
    for (size_t r = 0; r < repeats; r++)
        for (int s = 0; s < SM_STAGES; s++)
            row->stage[r][s] = column[s] < 0 ? NAN : all[r * (size_t)columns + (size_t)column[s]];
    free(all);
}

static void read_times(BenchH5 *h5, hid_t group, BenchRow *row)
{
    if (!h5->failed && (row->repeats < 1 || row->repeats > MOST_REPEATS))
        bench_h5_fail(h5, "repeats is %d", row->repeats);
    hsize_t size[] = {(hsize_t)row->repeats};
    hid_t total = bench_h5_find_dataset(h5, group, "total", 1, size);
    if (h5->failed) return;
    row->total = sm_alloc((size_t)row->repeats, sizeof *row->total);
    row->stage = sm_alloc((size_t)row->repeats, sizeof *row->stage);
    bench_h5_read(h5, total, H5T_NATIVE_DOUBLE, row->total);
    for (int r = 0; r < row->repeats && row->valid && !h5->failed; r++)
        if (!isfinite(row->total[r]) || row->total[r] <= 0)
            bench_h5_fail(h5, "dataset 'total' holds %g s", row->total[r]);
    read_stages(h5, group, row);
}

/* A failure's message is preceded by the row. */
static void read_row(BenchH5 *h5, hid_t parent, int index, BenchRow *row)
{
    char name[16], message[sizeof h5->message];
    snprintf(name, sizeof name, "%03d", index);
    hid_t group = bench_h5_find_group(h5, parent, name);
    row->epsilon = row->h = NAN;
    bench_h5_read_fields(h5, group, needed, COUNT(needed), row);
    for (int q = 0; q < bench_quantity_count; q++) {
        const BenchField *field = &bench_quantities[q].field;
        bool array = field->kind == BENCH_DOUBLE && field->size > sizeof(double);
        if (field->name && !bench_quantities[q].of && !array)
            read_where_there(h5, group, field, 1, row);
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
} File;

static void read_file(BenchH5 *h5, void *record)
{
    File *file = record;
    int stored = 0, fields;
    const BenchField field = BENCH_VARIABLE("rows", BENCH_INT, stored);
    const BenchField *machine_fields = bench_machine_fields(&fields);
    bench_store_check_kind(h5, 1);
    bench_h5_read_fields(h5, h5->file, &field, 1, &stored);
    hid_t group = bench_h5_find_group(h5, h5->file, "machine");
    if (!h5->failed) read_where_there(h5, group, machine_fields, fields, file->machine);
    group = bench_h5_find_group(h5, h5->file, "rows");
    if (!h5->failed && (stored < 1 || stored > MOST_ROWS || (hsize_t)stored > h5->size / LEAST_ROW))
        bench_h5_fail(h5, "it states %d rows", stored);
    if (h5->failed) return;
    *file->rows = sm_alloc((size_t)stored, sizeof **file->rows);
    *file->count = stored;
    for (int i = 0; i < stored && !h5->failed; i++) read_row(h5, group, i, &(*file->rows)[i]);
}

SmCode bench_samples_load(const char *path, BenchRow **rows, int *count, BenchMachine *machine,
                          SmError *error)
{
    *rows = NULL;
    *count = 0;
    memset(machine, 0, sizeof *machine);
    SmCode code = bench_h5_load(path, read_file, &(File){rows, count, machine}, error);
    if (!code) return SM_OK;
    bench_rows_free(*rows, *count);
    *rows = NULL;
    *count = 0;
    return code;
}
