#include "calibration_store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../store/h5.h"

static const char file_kind[] = "shapebench calibration";

static void write_laws(BenchH5 *h5, const BenchCalibration *calibration)
{
    int count;
    const BenchField *fields = bench_law_fields(&count);
    hid_t group = bench_h5_group(h5, h5->file, "laws");
    bench_h5_columns(h5, group, fields, count, calibration->law, sizeof *calibration->law,
                     calibration->laws);
    for (int i = 0; i < BENCH_FOUND; i++) {
        char name[16];
        snprintf(name, sizeof name, "found_%d", i + 1);
        bench_h5_text(h5, group, name, calibration->found[i]);
    }
}

static void write_file(BenchH5 *h5, void *record)
{
    BenchCalibration *calibration = record;
    int schema = BENCH_CALIBRATION_SCHEMA, count;
    const BenchField *fields = bench_machine_fields(&count);
    bench_h5_text(h5, h5->file, "kind", file_kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    hid_t group = bench_h5_group(h5, h5->file, "machine");
    bench_h5_fields(h5, group, fields, count, &calibration->machine);
    group = bench_h5_group(h5, h5->file, "plan");
    fields = bench_calibration_fields(&count);
    bench_h5_fields(h5, group, fields, count, &calibration->plan);
    BenchCalibrationList list[BENCH_CALIBRATION_LISTS];
    bench_calibration_lists(&calibration->plan, list);
    for (int l = 0; l < BENCH_CALIBRATION_LISTS; l++)
        bench_h5_dataset(h5, group, list[l].name, H5T_IEEE_F64LE, 1,
                         &(hsize_t){(hsize_t)*list[l].count}, list[l].value);
    group = bench_h5_group(h5, h5->file, "specimens");
    fields = bench_specimen_fields(&count);
    bench_h5_columns(h5, group, fields, count, calibration->specimen, sizeof *calibration->specimen,
                     calibration->count);
    write_laws(h5, calibration);
}

SmCode bench_calibration_store(const char *path, BenchCalibration *calibration, SmError *error)
{
    return bench_h5_store(path, write_file, calibration, error);
}

static void read_list(BenchH5 *h5, hid_t group, const BenchCalibrationList *list)
{
    if (!h5->failed && (*list->count < 0 || *list->count > BENCH_CALIBRATION_VALUES))
        bench_h5_fail(h5, "its plan has %d values of %s", *list->count, list->name);
    hid_t dataset =
        bench_h5_find_dataset(h5, group, list->name, 1, &(hsize_t){(hsize_t)*list->count});
    bench_h5_read(h5, dataset, H5T_NATIVE_DOUBLE, list->value);
    for (int i = 0; i < *list->count && !h5->failed; i++)
        if (!(list->value[i] >= list->low && list->value[i] <= list->high))
            bench_h5_fail(h5, "its plan has %g as %s", list->value[i], list->name);
}

static void read_plan(BenchH5 *h5, BenchCalibrationPlan *plan)
{
    int count;
    const BenchField *fields = bench_calibration_fields(&count);
    hid_t group = bench_h5_find_group(h5, h5->file, "plan");
    bench_h5_read_fields(h5, group, fields, count, plan);
    BenchCalibrationList list[BENCH_CALIBRATION_LISTS];
    bench_calibration_lists(plan, list);
    for (int l = 0; l < BENCH_CALIBRATION_LISTS; l++) read_list(h5, group, &list[l]);
    if (!h5->failed && (plan->ws < 1 || plan->epsilons < 1 || plan->across < 1))
        bench_h5_fail(h5, "its plan is empty");
}

/* Every specimen must be one of the plan's, in order. */
static void check_specimens(BenchH5 *h5, BenchCalibration *calibration)
{
    if (h5->failed) return;
    BenchSpecimen *planned = sm_alloc(BENCH_CALIBRATION_SPECIMENS, sizeof *planned);
    int before = -1, wanted = calibration->plan.specimens;
    SmError error;
    if (bench_calibration_plan(&calibration->plan, planned, &error) ||
        calibration->plan.specimens != wanted)
        bench_h5_fail(h5, "its plan does not make %d specimens", wanted);
    for (long i = 0; i < calibration->count && !h5->failed; i++) {
        const BenchSpecimen *s = &calibration->specimen[i];
        const BenchSpecimen *p = s->index > before && s->index < wanted ? &planned[s->index] : NULL;
        if (!p || strcmp(p->engine, s->engine) != 0 || strcmp(p->set, s->set) != 0 ||
            p->w != s->w || p->epsilon != s->epsilon || p->across != s->across ||
            p->aspect != s->aspect || p->h != s->h || p->spacing != s->spacing)
            bench_h5_fail(h5, "specimen %ld is not one of its plan's", i);
        before = s->index;
    }
    free(planned);
}

static void read_file(BenchH5 *h5, void *record)
{
    BenchCalibration *calibration = record;
    int count;
    const BenchField *fields = bench_machine_fields(&count);
    bench_h5_check_kind(h5, file_kind, BENCH_CALIBRATION_SCHEMA, BENCH_CALIBRATION_SCHEMA);
    hid_t group = bench_h5_find_group(h5, h5->file, "machine");
    bench_h5_read_fields(h5, group, fields, count, &calibration->machine);
    read_plan(h5, &calibration->plan);
    group = bench_h5_find_group(h5, h5->file, "specimens");
    fields = bench_specimen_fields(&count);
    long number = bench_h5_records(h5, group, fields, BENCH_CALIBRATION_SPECIMENS);
    if (h5->failed) return;
    calibration->count = number;
    calibration->specimen = sm_alloc((size_t)number, sizeof *calibration->specimen);
    bench_h5_read_columns(h5, group, fields, count, calibration->specimen,
                          sizeof *calibration->specimen, number);
    check_specimens(h5, calibration);
}

SmCode bench_calibration_load(const char *path, BenchCalibration *calibration, SmError *error)
{
    memset(calibration, 0, sizeof *calibration);
    SmCode code = bench_h5_load(path, read_file, calibration, error);
    if (code)
        bench_calibration_free(calibration);
    else
        bench_calibration_conclude(calibration);
    return code;
}
