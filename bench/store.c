#include "store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draft.h"

#define FIELD(kind, member) BENCH_FIELD(BenchRow, kind, member)
#define COUNT(array)        ((int)(sizeof(array) / sizeof((array)[0])))

static const char file_kind[] = "shapebench results";
enum { MOST_REPEATS = 1000000, MOST_FRAMES = 10000000 }; /* more than can be: a damaged file */

static const BenchField row_fields[] = {
    FIELD(BENCH_TEXT, paper),
    FIELD(BENCH_TEXT, paper_row),
    FIELD(BENCH_TEXT, scene),
    FIELD(BENCH_TEXT, engine),
    FIELD(BENCH_TEXT, precision),
    FIELD(BENCH_LONG, triangles),
    FIELD(BENCH_LONG, particles),
    FIELD(BENCH_LONG, regions),
    FIELD(BENCH_LONG, instances),
    FIELD(BENCH_INT, w),
    FIELD(BENCH_INT, steps),
    FIELD(BENCH_DOUBLE, epsilon),
    FIELD(BENCH_DOUBLE, h),
    FIELD(BENCH_DOUBLE, cell),
    FIELD(BENCH_DOUBLE, damping),
    FIELD(BENCH_INT, threads),
    FIELD(BENCH_BOOL, valid),
    FIELD(BENCH_TEXT, reason),
    FIELD(BENCH_TEXT, found),
    FIELD(BENCH_DOUBLE, goal_error),
    FIELD(BENCH_DOUBLE, momentum_error),
    FIELD(BENCH_DOUBLE, goal_tolerance),
    FIELD(BENCH_INT, repeats),
    FIELD(BENCH_DOUBLE, stage_ms),
    FIELD(BENCH_DOUBLE, total_ms),
    FIELD(BENCH_DOUBLE, total_low_ms),
    FIELD(BENCH_DOUBLE, total_high_ms),
    FIELD(BENCH_DOUBLE, instruments_percent),
    FIELD(BENCH_DOUBLE, ns_per_particle_step),
    FIELD(BENCH_DOUBLE, voxelise_seconds),
    FIELD(BENCH_DOUBLE, build_seconds),
    FIELD(BENCH_LONG, bytes),
    FIELD(BENCH_DOUBLE, fps),
    FIELD(BENCH_DOUBLE, speedup),
    FIELD(BENCH_DOUBLE, summation_nodes),
    FIELD(BENCH_DOUBLE, width_cells),
    FIELD(BENCH_DOUBLE, width_edges),
    FIELD(BENCH_DOUBLE, wanted_summation),
    FIELD(BENCH_LONG, most_summation),
    FIELD(BENCH_LONG, bases),
    FIELD(BENCH_LONG, cells),
    FIELD(BENCH_LONG, parts),
    FIELD(BENCH_DOUBLE, reached),
    FIELD(BENCH_DOUBLE, most_reached),
    FIELD(BENCH_LONG, wanted_nodes),
    FIELD(BENCH_LONG, wanted_bases),
    FIELD(BENCH_LONG, local_nodes),
    FIELD(BENCH_LONG, welded_cells),
    FIELD(BENCH_LONG, welded_pairs),
    FIELD(BENCH_LONG, balance_splits),
    FIELD(BENCH_BOOL, plain),
    FIELD(BENCH_DOUBLE, paper_total_ms),
    FIELD(BENCH_DOUBLE, paper_stage_ms),
    FIELD(BENCH_LONG, change.frames),
    FIELD(BENCH_LONG, change.changed),
    FIELD(BENCH_LONG, change.first_nodes),
    FIELD(BENCH_LONG, change.most_nodes),
    FIELD(BENCH_LONG, change.last_nodes),
    FIELD(BENCH_LONG, change.most_added),
    FIELD(BENCH_DOUBLE, change.first_ms),
    FIELD(BENCH_DOUBLE, change.last_ms),
    FIELD(BENCH_DOUBLE, change.change_ms),
    FIELD(BENCH_DOUBLE, change.change_most_ms),
    FIELD(BENCH_DOUBLE, change.follow_ms),
    FIELD(BENCH_DOUBLE, change.surface_ms),
    FIELD(BENCH_LONG, change.first_triangles),
    FIELD(BENCH_LONG, change.last_triangles),
    FIELD(BENCH_LONG, change.pieces),
    FIELD(BENCH_LONG, change.open_edges),
    FIELD(BENCH_LONG, change.left),
    FIELD(BENCH_HASH, input_hash),
};

/* In the group `elastic` of a row that has one. */
#define ELASTIC(kind, member) BENCH_FIELD(BenchElasticRow, kind, member)
static const BenchField elastic_fields[] = {
    ELASTIC(BENCH_LONG, nodes),           ELASTIC(BENCH_LONG, modes),
    ELASTIC(BENCH_DOUBLE, field_seconds), ELASTIC(BENCH_DOUBLE, matrix_seconds),
    ELASTIC(BENCH_DOUBLE, mode_seconds),  ELASTIC(BENCH_DOUBLE, skin_seconds),
    ELASTIC(BENCH_DOUBLE, found),
};

/* "fast_sum shape_matching ...": the columns of `stage`, in order. */
void bench_store_stages(size_t size, char *names)
{
    size_t used = 0;
    for (int stage = 0; stage < SM_STAGES; stage++)
        used += (size_t)snprintf(names + used, size - used, "%s%s", stage ? " " : "",
                                 sm_stage_name((SmStage)stage));
}

void bench_store_row(BenchH5 *h5, hid_t parent, int index, const BenchRow *row)
{
    char name[16], stages[128];
    snprintf(name, sizeof name, "%03d", index);
    bench_store_stages(sizeof stages, stages);
    hid_t group = bench_h5_group(h5, parent, name);
    bench_h5_fields(h5, group, row_fields, COUNT(row_fields), row);
    bench_h5_text(h5, group, "stages", stages);
    hsize_t size[] = {(hsize_t)row->repeats, SM_STAGES};
    bench_h5_dataset(h5, group, "total", H5T_IEEE_F64LE, 1, size, row->total);
    bench_h5_dataset(h5, group, "stage", H5T_IEEE_F64LE, 2, size, row->stage);
    hsize_t frames[] = {(hsize_t)row->change.frames, BENCH_FRAME_PARTS};
    if (row->change.frames)
        bench_h5_dataset(h5, group, "frames", H5T_IEEE_F64LE, 2, frames, row->change.time);
    if (row->elastic.nodes) {
        hid_t elastic = bench_h5_group(h5, group, "elastic");
        bench_h5_fields(h5, elastic, elastic_fields, COUNT(elastic_fields), &row->elastic);
        if (elastic >= 0) H5Gclose(elastic);
    }
    if (group >= 0) H5Gclose(group);
}

static void write_file(BenchH5 *h5, const BenchRow *rows, int count, const BenchMachine *machine)
{
    int schema = BENCH_STORE_SCHEMA, machine_count;
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    bench_h5_text(h5, h5->file, "kind", file_kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_numbers(h5, h5->file, "rows", H5T_STD_I32LE, 0, &count);
    hid_t group = bench_h5_group(h5, h5->file, "machine");
    bench_h5_fields(h5, group, machine_fields, machine_count, machine);
    group = bench_h5_group(h5, h5->file, "rows");
    for (int i = 0; i < count; i++) bench_store_row(h5, group, i, &rows[i]);
}

SmCode bench_store_rows(const char *path, const BenchRow *rows, int count,
                        const BenchMachine *machine, SmError *error)
{
    BenchDraft draft;
    SmCode code = bench_draft_begin(path, &draft, error);
    if (code != SM_OK) return code;
    BenchH5 h5;
    bench_h5_create(&h5, draft.tmp);
    write_file(&h5, rows, count, machine);
    if (bench_h5_close(&h5)) return bench_draft_commit(&draft, error);
    bench_draft_discard(&draft);
    return bench_draft_fail(path, h5.number, h5.message, error);
}

static void read_samples(BenchH5 *h5, hid_t group, BenchRow *row)
{
    char expected[128], stages[128];
    bench_store_stages(sizeof expected, expected);
    bench_h5_read_text(h5, group, "stages", sizeof stages, stages);
    if (!h5->failed && strcmp(stages, expected) != 0)
        bench_h5_fail(h5, "its stages are '%s', not '%s'", stages, expected);
    if (!h5->failed && (row->repeats < 0 || row->repeats > MOST_REPEATS))
        bench_h5_fail(h5, "repeats is %d", row->repeats);
    hsize_t size[] = {(hsize_t)row->repeats, SM_STAGES};
    hid_t total = bench_h5_find_dataset(h5, group, "total", 1, size);
    hid_t stage = bench_h5_find_dataset(h5, group, "stage", 2, size);
    if (h5->failed) return;
    row->total = sm_alloc((size_t)row->repeats, sizeof *row->total);
    row->stage = sm_alloc((size_t)row->repeats, sizeof *row->stage);
    bench_h5_read(h5, total, H5T_NATIVE_DOUBLE, row->total);
    bench_h5_read(h5, stage, H5T_NATIVE_DOUBLE, row->stage);
}

static void read_frames(BenchH5 *h5, hid_t group, BenchChangeRow *change)
{
    if (!h5->failed && (change->frames < 0 || change->frames > MOST_FRAMES))
        bench_h5_fail(h5, "change.frames is %ld", change->frames);
    if (h5->failed || change->frames == 0) return;
    hsize_t size[] = {(hsize_t)change->frames, BENCH_FRAME_PARTS};
    hid_t frames = bench_h5_find_dataset(h5, group, "frames", 2, size);
    if (h5->failed) return;
    change->time = sm_alloc((size_t)change->frames, sizeof *change->time);
    bench_h5_read(h5, frames, H5T_NATIVE_DOUBLE, change->time);
}

static void read_elastic(BenchH5 *h5, hid_t group, BenchElasticRow *elastic)
{
    if (h5->failed || H5Lexists(group, "elastic", H5P_DEFAULT) <= 0) return;
    hid_t from = bench_h5_find_group(h5, group, "elastic");
    bench_h5_read_fields(h5, from, elastic_fields, COUNT(elastic_fields), elastic);
    if (!h5->failed) H5Gclose(from);
}

/* Reads row `index`; a failure's message is preceded by the row. */
static void read_row(BenchH5 *h5, hid_t parent, int index, BenchRow *row)
{
    char name[16];
    snprintf(name, sizeof name, "%03d", index);
    hid_t group = bench_h5_find_group(h5, parent, name);
    bench_h5_read_fields(h5, group, row_fields, COUNT(row_fields), row);
    read_samples(h5, group, row);
    read_frames(h5, group, &row->change);
    read_elastic(h5, group, &row->elastic);
    if (h5->failed) {
        char message[sizeof h5->message];
        snprintf(message, sizeof message, "row %s: %.200s", name, h5->message);
        memcpy(h5->message, message, sizeof message);
    }
}

void bench_store_check_kind(BenchH5 *h5, int oldest)
{
    bench_h5_check_kind(h5, file_kind, oldest, BENCH_STORE_SCHEMA);
}

static void read_file(BenchH5 *h5, void *record)
{
    BenchRowFile *file = record;
    bench_store_check_kind(h5, BENCH_STORE_SCHEMA);
    int stored = 0, machine_count;
    const BenchField field = {"rows", BENCH_INT, 0, sizeof stored};
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    bench_h5_read_fields(h5, h5->file, &field, 1, &stored);
    hid_t group = bench_h5_find_group(h5, h5->file, "machine");
    bench_h5_read_fields(h5, group, machine_fields, machine_count, file->machine);
    group = bench_h5_find_group(h5, h5->file, "rows");
    H5G_info_t info;
    if (!h5->failed && (H5Gget_info(group, &info) < 0 || (hsize_t)stored != info.nlinks))
        bench_h5_fail(h5, "it holds another number of rows than the %d it states", stored);
    if (h5->failed) return;
    *file->rows = sm_alloc((size_t)stored, sizeof **file->rows);
    *file->count = stored;
    for (int i = 0; i < stored && !h5->failed; i++) read_row(h5, group, i, &(*file->rows)[i]);
}

SmCode bench_load_rows(const char *path, BenchRow **rows, int *count, BenchMachine *machine,
                       SmError *error)
{
    return bench_store_load(path, read_file, &(BenchRowFile){rows, count, machine}, error);
}

SmCode bench_store_load(const char *path, void (*read)(BenchH5 *h5, void *record),
                        BenchRowFile *file, SmError *error)
{
    *file->rows = NULL;
    *file->count = 0;
    memset(file->machine, 0, sizeof *file->machine);
    SmCode code = bench_h5_load(path, read, file, error);
    if (!code) return SM_OK;
    bench_rows_free(*file->rows, *file->count);
    *file->rows = NULL;
    *file->count = 0;
    return code;
}

void bench_rows_free(BenchRow *rows, int count)
{
    for (int i = 0; i < count; i++) {
        free(rows[i].total);
        free(rows[i].stage);
        free(rows[i].change.time);
    }
    free(rows);
}
