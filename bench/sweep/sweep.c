#include "sweep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../store/h5.h"
#include "../table/row_store.h"
#include "front.h"

static const char file_kind[] = "shapebench sweep";

/* Where the point of this index is, or would be. */
static long place_of(const BenchSweep *sweep, int index)
{
    long low = 0, high = sweep->count;
    while (low < high) {
        long middle = (low + high) / 2;
        if (sweep->point[middle].index < index)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const BenchPoint *bench_sweep_find(const BenchSweep *sweep, int index)
{
    long place = place_of(sweep, index);
    bool there = place < sweep->count && sweep->point[place].index == index;
    return there ? &sweep->point[place] : NULL;
}

void bench_sweep_add(BenchSweep *sweep, const BenchPoint *point)
{
    long place = place_of(sweep, point->index);
    sweep->point = sm_realloc(sweep->point, (size_t)sweep->count + 1, sizeof *sweep->point);
    memmove(sweep->point + place + 1, sweep->point + place,
            (size_t)(sweep->count - place) * sizeof *sweep->point);
    sweep->point[place] = *point;
    sweep->count++;
}

void bench_sweep_free(BenchSweep *sweep)
{
    free(sweep->point);
    *sweep = (BenchSweep){0};
}

/* sample[] of every point as one table. */
static void write_samples(BenchH5 *h5, hid_t group, const BenchSweep *sweep)
{
    size_t repeats = (size_t)sweep->plan.repeats;
    double *sample = sm_alloc((size_t)sweep->count * repeats, sizeof *sample);
    for (long i = 0; i < sweep->count; i++)
        memcpy(sample + (size_t)i * repeats, sweep->point[i].sample, repeats * sizeof *sample);
    hsize_t size[] = {(hsize_t)sweep->count, repeats};
    bench_h5_dataset(h5, group, "sample", H5T_IEEE_F64LE, 2, size, sample);
    free(sample);
}

static void write_file(BenchH5 *h5, void *record)
{
    const BenchSweep *sweep = record;
    int schema = BENCH_SWEEP_SCHEMA, machine_count, plan_count, point_count;
    char stages[128];
    const BenchPlan *plan = &sweep->plan;
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    const BenchField *plan_fields = bench_plan_fields(&plan_count);
    const BenchField *point_fields = bench_point_fields(&point_count);
    bench_h5_text(h5, h5->file, "kind", file_kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    hid_t group = bench_h5_group(h5, h5->file, "machine");
    bench_h5_fields(h5, group, machine_fields, machine_count, &sweep->machine);
    group = bench_h5_group(h5, h5->file, "plan");
    bench_h5_fields(h5, group, plan_fields, plan_count, plan);
    hsize_t ws = (hsize_t)plan->ws, epsilons = (hsize_t)plan->epsilons;
    bench_h5_dataset(h5, group, "w", H5T_IEEE_F64LE, 1, &ws, plan->w);
    bench_h5_dataset(h5, group, "epsilon", H5T_IEEE_F64LE, 1, &epsilons, plan->epsilon);
    group = bench_h5_group(h5, h5->file, "points");
    bench_store_stages(sizeof stages, stages);
    bench_h5_text(h5, group, "stages", stages);
    bench_h5_columns(h5, group, point_fields, point_count, sweep->point, sizeof *sweep->point,
                     sweep->count);
    write_samples(h5, group, sweep);
}

SmCode bench_sweep_store(const char *path, BenchSweep *sweep, SmError *error)
{
    bench_front_mark(sweep->point, sweep->count);
    return bench_h5_store(path, write_file, sweep, error);
}

static void read_numbers(BenchH5 *h5, hid_t group, const char *name, int count, double *values)
{
    hsize_t size = (hsize_t)count;
    if (!h5->failed && (count < 1 || count > BENCH_PLAN_VALUES))
        bench_h5_fail(h5, "its plan has %d values of %s", count, name);
    hid_t dataset = bench_h5_find_dataset(h5, group, name, 1, &size);
    bench_h5_read(h5, dataset, H5T_NATIVE_DOUBLE, values);
}

static void read_plan(BenchH5 *h5, BenchPlan *plan)
{
    int count;
    const BenchField *fields = bench_plan_fields(&count);
    hid_t group = bench_h5_find_group(h5, h5->file, "plan");
    bench_h5_read_fields(h5, group, fields, count, plan);
    read_numbers(h5, group, "w", plan->ws, plan->w);
    read_numbers(h5, group, "epsilon", plan->epsilons, plan->epsilon);
    int points = plan->points;
    SmError error;
    if (!h5->failed && (bench_plan_count(plan, &error) || plan->points != points || points < 1))
        bench_h5_fail(h5, "its plan does not make %d points", points);
    if (!h5->failed && (plan->repeats < 1 || plan->repeats > BENCH_POINT_SAMPLES))
        bench_h5_fail(h5, "its plan has %d repeats", plan->repeats);
}

/* Every point must be one of the plan's, in order, with no more samples than there is room for. */
static void check_points(BenchH5 *h5, const BenchSweep *sweep)
{
    for (long i = 0; i < sweep->count && !h5->failed; i++) {
        const BenchPoint *p = &sweep->point[i];
        BenchPoint planned = {0};
        bool inside =
            p->index >= 0 && p->index < sweep->plan.points && (i == 0 || p->index > p[-1].index);
        if (inside) bench_plan_point(&sweep->plan, p->index, &planned);
        if (!inside || strcmp(planned.engine, p->engine) != 0 || planned.w != p->w ||
            planned.epsilon != p->epsilon)
            bench_h5_fail(h5, "point %ld is not one of its plan's", i);
        if (p->samples < 0 || p->samples > sweep->plan.repeats)
            bench_h5_fail(h5, "point %ld has %d samples", i, p->samples);
    }
}

static void read_samples(BenchH5 *h5, hid_t group, BenchSweep *sweep)
{
    size_t repeats = (size_t)sweep->plan.repeats;
    hsize_t size[] = {(hsize_t)sweep->count, repeats};
    hid_t dataset = bench_h5_find_dataset(h5, group, "sample", 2, size);
    if (h5->failed) return;
    double *sample = sm_alloc((size_t)sweep->count * repeats, sizeof *sample);
    bench_h5_read(h5, dataset, H5T_NATIVE_DOUBLE, sample);
    for (long i = 0; i < sweep->count; i++)
        memcpy(sweep->point[i].sample, sample + (size_t)i * repeats, repeats * sizeof *sample);
    free(sample);
}

static void read_file(BenchH5 *h5, void *record)
{
    BenchSweep *sweep = record;
    int machine_count, count;
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    const BenchField *fields = bench_point_fields(&count);
    bench_h5_check_kind(h5, file_kind, BENCH_SWEEP_SCHEMA, BENCH_SWEEP_SCHEMA);
    hid_t group = bench_h5_find_group(h5, h5->file, "machine");
    bench_h5_read_fields(h5, group, machine_fields, machine_count, &sweep->machine);
    read_plan(h5, &sweep->plan);
    group = bench_h5_find_group(h5, h5->file, "points");
    long number = bench_h5_records(h5, group, fields, BENCH_PLAN_POINTS);
    if (h5->failed) return;
    sweep->count = number;
    sweep->point = sm_alloc((size_t)number, sizeof *sweep->point);
    for (long i = 0; i < number; i++) sweep->point[i] = bench_point_none();
    bench_h5_read_columns(h5, group, fields, count, sweep->point, sizeof *sweep->point, number);
    read_samples(h5, group, sweep);
    check_points(h5, sweep);
}

SmCode bench_sweep_load(const char *path, BenchSweep *sweep, SmError *error)
{
    *sweep = (BenchSweep){0};
    SmCode code = bench_h5_load(path, read_file, sweep, error);
    if (code) bench_sweep_free(sweep);
    return code;
}

/* Bit for bit, but for the mark of a front, which depends on the other points. */
static bool same_point(const BenchPoint *a, const BenchPoint *b)
{
    int count;
    const BenchField *fields = bench_point_fields(&count);
    for (int f = 0; f < count; f++) {
        const char *left = (const char *)a + fields[f].offset,
                   *right = (const char *)b + fields[f].offset;
        if (!strcmp(fields[f].name, "front")) continue;
        if (fields[f].kind == BENCH_TEXT ? strcmp(left, right) != 0
                                         : memcmp(left, right, fields[f].size) != 0)
            return false;
    }
    return !memcmp(a->sample, b->sample, (size_t)a->samples * sizeof *a->sample);
}

SmCode bench_sweep_merge(BenchSweep *into, const BenchSweep *from, const char *path, SmError *error)
{
    char what[240];
    if (!bench_plan_same(&into->plan, &from->plan, sizeof what, what))
        return sm_fail(error, SM_INPUT, "%.200s is of another sweep: %s", path, what);
    for (long i = 0; i < from->count; i++) {
        const BenchPoint *point = &from->point[i], *there = bench_sweep_find(into, point->index);
        if (!there)
            bench_sweep_add(into, point);
        else if (!same_point(there, point))
            return sm_fail(error, SM_INPUT,
                           "%.200s: its point %d (%s, w %g, epsilon %g) was measured twice, here "
                           "and in a file before it, and the two differ: leave one file out",
                           path, point->index, point->engine, point->w, point->epsilon);
    }
    return SM_OK;
}
