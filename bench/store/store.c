#include "store.h"

#include <stdio.h>
#include <string.h>

#include "../../reference/paper.h"

#define FIELD(kind, member) BENCH_FIELD(BenchRow, kind, member)
#define COUNT(array)        ((int)(sizeof(array) / sizeof((array)[0])))

static const char file_kind[] = "shapebench results";

static const BenchField row_fields[] = {
    FIELD(BENCH_TEXT, paper),
    FIELD(BENCH_TEXT, paper_row),
    FIELD(BENCH_TEXT, scene),
    FIELD(BENCH_TEXT, engine),
    FIELD(BENCH_TEXT, precision),
    FIELD(BENCH_TEXT, polar),
    FIELD(BENCH_TEXT, summation),
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
    FIELD(BENCH_BOOL, busy),
    FIELD(BENCH_DOUBLE, lost_percent),
    FIELD(BENCH_DOUBLE, load),
    FIELD(BENCH_TEXT, reason),
    FIELD(BENCH_TEXT, found),
    FIELD(BENCH_DOUBLE, goal_error),
    FIELD(BENCH_DOUBLE, momentum_error),
    FIELD(BENCH_DOUBLE, drift),
    FIELD(BENCH_DOUBLE, twist),
    FIELD(BENCH_LONG, drift_steps),
    FIELD(BENCH_LONG, left_out),
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
    FIELD(BENCH_LONG, splits),
    FIELD(BENCH_LONG, balance_splits),
    FIELD(BENCH_LONG, unasked_splits),
    FIELD(BENCH_BOOL, plain),
    FIELD(BENCH_INT, masses),
    FIELD(BENCH_INT, symmetry),
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

const BenchField *bench_row_fields(int *count)
{
    *count = COUNT(row_fields);
    return row_fields;
}

void bench_store_stages(size_t size, char *names)
{
    size_t used = 0;
    for (int stage = 0; stage < SM_STAGES; stage++)
        used += (size_t)snprintf(names + used, size - used, "%s%s", stage ? " " : "",
                                 sm_stage_name((SmStage)stage));
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
        if (s) strcat(stages, " ");
        strcat(stages, ref_status_name(paper->stage_ms[s].status));
    }
    bench_h5_text(h5, group, "paper_total_status", ref_status_name(paper->total_ms.status));
    bench_h5_text(h5, group, "paper_rate_status", ref_status_name(paper->fps.status));
    bench_h5_text(h5, group, "paper_stage_status", stages);
    bench_h5_numbers(h5, group, "paper_stage_percent", H5T_IEEE_F64LE, SM_STAGES, percent);
    bench_h5_numbers(h5, group, "paper_particles", H5T_IEEE_F64LE, 0, &paper->particles.value);
}

void bench_store_row(BenchH5 *h5, hid_t parent, int index, const BenchRow *row)
{
    char name[16], stages[128];
    snprintf(name, sizeof name, "%03d", index);
    bench_store_stages(sizeof stages, stages);
    hid_t group = bench_h5_group(h5, parent, name);
    bench_h5_fields(h5, group, row_fields, COUNT(row_fields), row);
    bench_h5_text(h5, group, "stages", stages);
    write_paper(h5, group, row);
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

/* What a file is to hold. */
typedef struct {
    const BenchRow *rows;
    int count;
    const BenchMachine *machine;
} File;

static void write_file(BenchH5 *h5, void *record)
{
    const File *file = record;
    int schema = BENCH_STORE_SCHEMA, machine_count;
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    bench_h5_text(h5, h5->file, "kind", file_kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_numbers(h5, h5->file, "rows", H5T_STD_I32LE, 0, &file->count);
    hid_t group = bench_h5_group(h5, h5->file, "machine");
    bench_h5_fields(h5, group, machine_fields, machine_count, file->machine);
    group = bench_h5_group(h5, h5->file, "rows");
    for (int i = 0; i < file->count; i++) bench_store_row(h5, group, i, &file->rows[i]);
}

SmCode bench_store_rows(const char *path, const BenchRow *rows, int count,
                        const BenchMachine *machine, SmError *error)
{
    return bench_h5_store(path, write_file, &(File){rows, count, machine}, error);
}

void bench_store_check_kind(BenchH5 *h5, int oldest)
{
    bench_h5_check_kind(h5, file_kind, oldest, BENCH_STORE_SCHEMA);
}
