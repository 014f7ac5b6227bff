#include <jansson.h>
#include <math.h>
#include <string.h>

#include <gsl/gsl_statistics.h>

#include "../store/export.h"
#include "../system/statistic.h"
#include "regression.h"

/* One build's part of a comparison. */
static json_t *side_json(const BenchComparison *one, BenchBuild build)
{
    const BenchSide *side = &one->contest->side[build];
    json_t *object = json_object(), *samples = json_array(), *rounds = json_array();
    json_t *outliers = json_array();
    for (int i = 0; i < side->count; i++) {
        json_array_append_new(samples, bench_json_number(side->time[one->time][i]));
        json_array_append_new(rounds, json_integer(side->round[i]));
        if (one->outlier[build] && one->outlier[build][i])
            json_array_append_new(outliers, json_integer(i));
    }
    json_object_set_new(object, "ms", bench_json_number(one->ms[build]));
    json_object_set_new(object, "samples", samples);
    json_object_set_new(object, "rounds", rounds);
    json_object_set_new(object, "outliers", outliers);
    json_object_set_new(object, "self_difference", bench_json_number(one->self[build]));
    json_object_set_new(object, "instructions",
                        bench_json_number(one->time ? NAN : side->instructions));
    return object;
}

static json_t *comparison_json(const BenchComparison *one)
{
    json_t *object = json_object();
    json_object_set_new(object, "scene", bench_json_text(one->contest->scene));
    json_object_set_new(object, "time", json_string(bench_time_name(one->time)));
    json_object_set_new(object, "verdict", json_string(bench_comparison_name(one->verdict)));
    json_object_set_new(object, "reason",
                        one->reason[0] ? bench_json_text(one->reason) : json_null());
    json_object_set_new(object, "ratio", bench_json_number(one->ratio));
    json_object_set_new(object, "low", bench_json_number(one->low));
    json_object_set_new(object, "high", bench_json_number(one->high));
    json_object_set_new(object, "p", bench_json_number(one->p));
    json_object_set_new(object, "p_adjusted", bench_json_number(one->adjusted));
    json_object_set_new(object, "threshold", bench_json_number(one->threshold));
    json_object_set_new(object, "old", side_json(one, BENCH_OLD));
    json_object_set_new(object, "new", side_json(one, BENCH_NEW));
    return object;
}

void bench_regression_json(FILE *file, const BenchRegression *found)
{
    char line[512];
    json_t *root = json_object(), *list = json_array(), *remarks = json_array();
    json_t *environments = json_object();
    bench_regression_summary(found, sizeof line, line);
    for (int i = 0; i < found->count; i++)
        json_array_append_new(list, comparison_json(&found->list[i]));
    for (int i = 0; i < found->remarks; i++)
        json_array_append_new(remarks, bench_json_text(found->remark[i]));
    json_object_set_new(environments, "old", bench_json_machine(&found->machine[BENCH_OLD]));
    json_object_set_new(environments, "new", bench_json_machine(&found->machine[BENCH_NEW]));
    json_object_set_new(root, "schema", json_integer(1));
    json_object_set_new(root, "verdict", bench_json_text(line));
    json_object_set_new(root, "exit_code",
                        json_integer(bench_comparisons_exit(found->list, found->count)));
    json_object_set_new(root, "baseline", bench_json_text(found->baseline));
    json_object_set_new(root, "interleaved", json_boolean(found->params->interleaved));
    json_object_set_new(root, "rounds", json_integer(found->params->rounds));
    json_object_set_new(root, "seconds", bench_json_number(found->seconds));
    json_object_set_new(root, "counter",
                        found->counter ? json_string(found->counter) : json_null());
    json_object_set_new(root, "comparisons", list);
    json_object_set_new(root, "remarks", remarks);
    json_object_set_new(root, "environments", environments);
    bench_json_write(file, root);
}

static json_t *context_json(const BenchMachine *machine)
{
    json_t *context = json_object(), *caches = json_array();
    const long size[] = {machine->l1_bytes, machine->l2_bytes, machine->l3_bytes};
    for (int level = 0; level < 3; level++)
        if (size[level] > 0)
            json_array_append_new(caches,
                                  json_pack("{s:s, s:i, s:I, s:i}", "type",
                                            level ? "Unified" : "Data", "level", level + 1, "size",
                                            (json_int_t)size[level], "num_sharing", 1));
    json_object_set_new(context, "date", bench_json_text(machine->utc));
    json_object_set_new(context, "host_name", bench_json_text(machine->hostname));
    json_object_set_new(context, "executable", json_string("shapebench"));
    json_object_set_new(context, "num_cpus", json_integer(machine->cores));
    json_object_set_new(context, "mhz_per_cpu", json_integer(0));
    json_object_set_new(context, "cpu_scaling_enabled",
                        json_boolean(strcmp(machine->governor, "unknown") != 0 &&
                                     strcmp(machine->governor, "performance") != 0));
    json_object_set_new(context, "caches", caches);
    json_object_set_new(context, "load_avg", json_array());
    json_object_set_new(context, "library_build_type", json_string("release"));
    return context;
}

/* A run or an aggregate; `time` in s. */
static json_t *benchmark_json(const BenchComparison *one, BenchBuild build, const char *aggregate,
                              double time)
{
    static const char *const prefix[] = {"old", "new"};
    const BenchSide *side = &one->contest->side[build];
    char run[160], name[192];
    snprintf(run, sizeof run, "%s/%s/%s", prefix[build], one->contest->scene,
             bench_time_name(one->time));
    snprintf(name, sizeof name, "%s%s%s", run, aggregate ? "_" : "", aggregate ? aggregate : "");
    bool share = aggregate && !strcmp(aggregate, "cv"); /* a percentage; as Google's, unscaled */
    json_t *object = json_object();
    json_object_set_new(object, "name", bench_json_text(name));
    json_object_set_new(object, "run_name", bench_json_text(run));
    json_object_set_new(object, "run_type", json_string(aggregate ? "aggregate" : "iteration"));
    json_object_set_new(object, "repetitions", json_integer(side->count));
    json_object_set_new(object, "threads",
                        json_integer(side->row.threads > 0 ? side->row.threads : 1));
    if (aggregate) {
        json_object_set_new(object, "aggregate_name", json_string(aggregate));
        json_object_set_new(object, "aggregate_unit", json_string(share ? "percentage" : "time"));
    }
    json_object_set_new(
        object, "iterations",
        json_integer(aggregate ? side->count : (side->row.steps > 0 ? side->row.steps : 1)));
    json_object_set_new(object, "real_time", bench_json_number(share ? time : 1e9 * time));
    json_object_set_new(object, "cpu_time", bench_json_number(share ? time : 1e9 * time));
    json_object_set_new(object, "time_unit", json_string("ns"));
    return object;
}

/* Every process of a build as a repetition, then the aggregates. */
static void add_benchmarks(json_t *list, const BenchComparison *one, BenchBuild build, int family)
{
    const BenchSide *side = &one->contest->side[build];
    const double *time = side->time[one->time];
    size_t count = (size_t)side->count;
    double mean = gsl_stats_mean(time, 1, count);
    double deviation = count > 1 ? gsl_stats_sd(time, 1, count) : 0;
    const struct {
        const char *name;
        double value;
    } aggregate[] = {{"mean", mean},
                     {"median", bench_quantile(time, side->count, 0.5)},
                     {"stddev", deviation},
                     {"cv", deviation / mean}};
    for (int i = 0; i < side->count + 4; i++) {
        bool whole = i >= side->count;
        json_t *object = whole ? benchmark_json(one, build, aggregate[i - side->count].name,
                                                aggregate[i - side->count].value)
                               : benchmark_json(one, build, NULL, time[i]);
        json_object_set_new(object, "family_index", json_integer(family));
        json_object_set_new(object, "per_family_instance_index", json_integer(0));
        if (!whole) json_object_set_new(object, "repetition_index", json_integer(i));
        json_array_append_new(list, object);
    }
}

void bench_regression_gbench(FILE *file, const BenchRegression *found)
{
    json_t *root = json_object(), *list = json_array();
    for (int b = 0; b < BENCH_BUILDS; b++)
        for (int i = 0; i < found->count; i++) {
            const BenchComparison *one = &found->list[i];
            if (one->verdict != BENCH_INCORRECT && one->verdict != BENCH_NO_BASELINE)
                add_benchmarks(list, one, (BenchBuild)b, b * found->count + i);
        }
    json_object_set_new(root, "context", context_json(&found->machine[BENCH_NEW]));
    json_object_set_new(root, "benchmarks", list);
    bench_json_write(file, root);
}
