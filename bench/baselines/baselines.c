#include "baselines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../store/export.h"
#include "../store/h5.h"
#include "../table/records.h"

enum { SCHEMA = 2, MOST_METHODS = 1000 };

static const double same_sag = 0.02; /* baselines.py finds stiffnesses to half of that */

/* ---- a method's columns */

#define FIELD(kind, member) BENCH_FIELD_AS(BenchBaseline, BENCH_##kind, member, #member)
#define DERIVED(type, member)                                                                      \
    .kind = BENCH_##type, .offset = offsetof(BenchBaseline, member),                               \
    .size = sizeof(((BenchBaseline *)0)->member), .column = #member

static void same_sag_cell(const void *record, char *text)
{
    strcpy(text, ((const BenchBaseline *)record)->same_sag ? "yes" : "no");
}

static const BenchField fields[] = {
    {FIELD(TEXT, method), .title = "method", .left = true},
    {FIELD(TEXT, stiffness), .title = "stiffness", .left = true},
    {FIELD(DOUBLE, step), .title = "step s", .format = "%.3g"},
    {FIELD(DOUBLE, sag_percent), .title = "sag %", .format = "%.3g"},
    {DERIVED(BOOL, same_sag), BENCH_CELL("same sag", same_sag_cell), .left = true},
    {FIELD(DOUBLE, ms_step), .title = "ms/step"},
    {FIELD(DOUBLE, ns_node_step), .title = "ns/particle/step"},
    {FIELD(DOUBLE, ms_second), .title = "ms/s"},
    {FIELD(DOUBLE, deviation_percent), .title = "deviation %"},
    {DERIVED(DOUBLE, times), .title = "times"},
};
enum { FIELDS = sizeof fields / sizeof *fields };

/* ---- reading */

#define PLAN(kind, member) BENCH_FIELD(BenchBaselines, BENCH_##kind, member)

static const BenchField plan_fields[] = {
    PLAN(LONG, nodes),      PLAN(DOUBLE, length),       PLAN(DOUBLE, sag_percent),
    PLAN(TEXT, comparable), PLAN(TEXT, not_comparable),
};
enum { PLAN_FIELDS = sizeof plan_fields / sizeof *plan_fields };

/* Texts of a file may hold what a terminal takes for commands; a time of 0 or less is none. */
static void check_method(BenchH5 *h5, BenchBaseline *method, long index)
{
    const double times[] = {method->step, method->ms_step, method->ns_node_step, method->ms_second};
    sm_printable(method->method);
    sm_printable(method->stiffness);
    for (size_t t = 0; t < sizeof times / sizeof *times; t++)
        if (!isfinite(times[t]) || times[t] <= 0)
            bench_h5_fail(h5, "method %ld has a time of %g", index, times[t]);
    if (!isfinite(method->sag_percent))
        bench_h5_fail(h5, "method %ld sags by %g%%", index, method->sag_percent);
    if (isinf(method->deviation_percent))
        bench_h5_fail(h5, "method %ld deviates by %g%%", index, method->deviation_percent);
}

static void read_methods(BenchH5 *h5, BenchBaselines *baselines)
{
    hid_t group = bench_h5_find_group(h5, h5->file, "methods");
    long count = bench_h5_records(h5, group, fields, MOST_METHODS);
    if (!count) bench_h5_fail(h5, "not one method is there");
    if (h5->failed) return;
    baselines->method = sm_alloc((size_t)count, sizeof *baselines->method);
    baselines->count = count;
    bench_h5_read_columns(h5, group, fields, FIELDS, baselines->method, sizeof *baselines->method,
                          count);
    for (long m = 0; m < count && !h5->failed; m++) check_method(h5, &baselines->method[m], m);
}

static void read_file(BenchH5 *h5, void *record)
{
    BenchBaselines *baselines = record;
    bench_h5_check_kind(h5, "shapebench baselines", SCHEMA, SCHEMA);
    bench_machine_load(h5, &baselines->machine);
    hid_t plan = bench_h5_find_group(h5, h5->file, "plan");
    bench_h5_read_fields(h5, plan, plan_fields, PLAN_FIELDS, baselines);
    if (!h5->failed && !(baselines->sag_percent > 0)) /* also NaN */
        bench_h5_fail(h5, "its beams are to sag by %g%%", baselines->sag_percent);
    read_methods(h5, baselines);
}

static void compare(BenchBaselines *baselines)
{
    for (long m = 0; m < baselines->count; m++) {
        BenchBaseline *method = &baselines->method[m];
        method->times = method->ms_second / baselines->method[0].ms_second;
        method->same_sag = fabs(method->sag_percent / baselines->sag_percent - 1) < same_sag;
    }
}

SmCode bench_baselines_load(const char *path, BenchBaselines *baselines, SmError *error)
{
    memset(baselines, 0, sizeof *baselines);
    SmCode code = bench_h5_load(path, read_file, baselines, error);
    if (code) bench_baselines_free(baselines);
    compare(baselines);
    return code;
}

void bench_baselines_free(BenchBaselines *baselines)
{
    free(baselines->method);
    memset(baselines, 0, sizeof *baselines);
}

/* ---- writing */

/* Does the processor differ from that of `here`? Its instruction set is chosen, not found. */
static bool is_elsewhere(const BenchBaselines *baselines, const BenchMachine *here, size_t size,
                         char *text)
{
    BenchMachine there = baselines->machine;
    there.isa[0] = '\0';
    return !bench_machine_same(&there, here, size, text);
}

static void print_notes(FILE *file, const char *before, const char *between,
                        const BenchBaselines *baselines, const BenchMachine *here)
{
    char differs[256];
    fprintf(file, "%sComparable: %s.\n%s%sNot comparable: %s.\n", before, baselines->comparable,
            between, before, baselines->not_comparable);
    fprintf(
        file,
        "%s%sSag, deviation: of nodes at rest, in percent of the beam's length; the second from an "
        "elastic body that sags as much.\n%s%sms/s: of a simulated second; times: that by "
        "FastLSM's.\n",
        between, before, between, before);
    if (is_elsewhere(baselines, here, sizeof differs, differs))
        fprintf(file, "%s%sThese rows were measured on another machine: %s.\n", between, before,
                differs);
}

void bench_baselines_print(FILE *file, BenchGridForm form, const BenchBaselines *baselines,
                           const BenchMachine *here)
{
    const BenchMachine *there = &baselines->machine;
    const char *before = form == BENCH_GRID_LATEX ? "% " : "";
    char where[BENCH_WHERE_TEXT];
    BenchGrid grid = bench_records_grid(fields, FIELDS, baselines->method,
                                        sizeof *baselines->method, baselines->count, 0);
    fprintf(file,
            "\n%sWhat one would take instead, for a clamped beam of %ld nodes: on %s; %.10s, "
            "commit %.10s%s.\n%s",
            before, baselines->nodes, bench_machine_where(there, where), there->utc,
            there->git_commit, there->git_dirty ? " with changes" : "",
            form == BENCH_GRID_LATEX ? "" : "\n");
    bench_grid_whole(file, &grid, form);
    if (form != BENCH_GRID_LATEX) fputc('\n', file);
    print_notes(file, before, form == BENCH_GRID_MARKDOWN ? "\n" : "", baselines, here);
    bench_grid_free(&grid);
}

void bench_baselines_csv(FILE *file, const BenchBaselines *baselines)
{
    bench_csv_records(file, fields, FIELDS, baselines->method, sizeof *baselines->method,
                      baselines->count, NULL);
}

json_t *bench_json_baselines(const BenchBaselines *baselines, const BenchMachine *here)
{
    char differs[256];
    json_t *object = json_object();
    json_object_set_new(object, "methods",
                        bench_json_records(fields, FIELDS, baselines->method,
                                           sizeof *baselines->method, baselines->count));
    json_object_update_new(object, bench_json_record(plan_fields, PLAN_FIELDS, baselines));
    bool elsewhere = is_elsewhere(baselines, here, sizeof differs, differs);
    json_object_set_new(object, "other_machine",
                        elsewhere ? bench_json_text(differs) : json_null());
    json_object_set_new(object, "environment", bench_json_machine(&baselines->machine));
    return object;
}
