#include "gbench.h"

#include <gsl/gsl_statistics.h>
#include <stdbool.h>
#include <string.h>

#include "../store/export.h"
#include "../system/statistic.h"

static json_t *context_json(const BenchMachine *machine)
{
    json_t *caches = json_array();
    bool scaling =
        bench_machine_known(machine->governor) && strcmp(machine->governor, "performance") != 0;
    const long size[] = {machine->l1_bytes, machine->l2_bytes, machine->l3_bytes};
    for (int level = 0; level < 3; level++)
        if (size[level] > 0)
            json_array_append_new(caches,
                                  json_pack("{s:s, s:i, s:I, s:i}", "type",
                                            level ? "Unified" : "Data", "level", level + 1, "size",
                                            (json_int_t)size[level], "num_sharing", 1));
    return json_pack("{s:o, s:o, s:s, s:i, s:i, s:b, s:o, s:[], s:s}", "date",
                     bench_json_text(machine->utc), "host_name", bench_json_text(machine->hostname),
                     "executable", "shapebench", "num_cpus", machine->cores, "mhz_per_cpu", 0,
                     "cpu_scaling_enabled", (int)scaling, "caches", caches, "load_avg",
                     "library_build_type", "release");
}

/* A run or an aggregate; `time` in s. */
static json_t *benchmark_json(const char *run, const char *aggregate, double time, int count,
                              int steps, int threads)
{
    char name[192];
    snprintf(name, sizeof name, "%.160s%s%s", run, aggregate ? "_" : "",
             aggregate ? aggregate : "");
    bool share = aggregate && !strcmp(aggregate, "cv"); /* a percentage; as Google's, unscaled */
    double shown = share ? time : 1e9 * time;
    json_t *object =
        json_pack("{s:o, s:o, s:s, s:i, s:i}", "name", bench_json_text(name), "run_name",
                  bench_json_text(run), "run_type", aggregate ? "aggregate" : "iteration",
                  "repetitions", count, "threads", threads > 0 ? threads : 1);
    if (aggregate)
        json_object_update_new(object, json_pack("{s:s, s:s}", "aggregate_name", aggregate,
                                                 "aggregate_unit", share ? "percentage" : "time"));
    json_object_update_new(object, json_pack("{s:i, s:o, s:o, s:s}", "iterations",
                                             aggregate   ? count
                                             : steps > 0 ? steps
                                                         : 1,
                                             "real_time", bench_json_number(shown), "cpu_time",
                                             bench_json_number(shown), "time_unit", "ns"));
    return object;
}

void bench_gbench_add(json_t *list, const char *name, int family, const double *time, int count,
                      int steps, int threads)
{
    double mean = gsl_stats_mean(time, 1, (size_t)count);
    double deviation = count > 1 ? gsl_stats_sd(time, 1, (size_t)count) : 0;
    const struct {
        const char *name;
        double value;
    } aggregate[] = {{"mean", mean},
                     {"median", bench_quantile(time, count, 0.5)},
                     {"stddev", deviation},
                     {"cv", deviation / mean}};
    for (int i = 0; i < count + 4; i++) {
        bool whole = i >= count;
        json_t *object = whole ? benchmark_json(name, aggregate[i - count].name,
                                                aggregate[i - count].value, count, steps, threads)
                               : benchmark_json(name, NULL, time[i], count, steps, threads);
        json_object_set_new(object, "family_index", json_integer(family));
        json_object_set_new(object, "per_family_instance_index", json_integer(0));
        if (!whole) json_object_set_new(object, "repetition_index", json_integer(i));
        json_array_append_new(list, object);
    }
}

void bench_gbench_write(FILE *file, const BenchMachine *machine, json_t *list)
{
    bench_json_write(file,
                     json_pack("{s:o, s:o}", "context", context_json(machine), "benchmarks", list));
}
