/* baselines.h - what one would take instead of shapebench, on the same beam: what
 * scripts/baselines.py measured and stored (results/README.md), as a table below the papers'. */
#ifndef BENCH_BASELINES_H
#define BENCH_BASELINES_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "../system/machine.h"
#include "../table/grid.h"

enum { BENCH_BASELINE_TEXT = 64, BENCH_BASELINES_WORDS = 512 };

/* One method. The last two follow from the others when a file is read. */
typedef struct {
    char method[BENCH_BASELINE_TEXT], stiffness[BENCH_BASELINE_TEXT];
    double step;              /* s */
    double sag_percent;       /* at rest, of the beam's length */
    double ms_step;           /* median of a step */
    double ns_node_step;      /* the same, of a node */
    double ms_second;         /* of a simulated second */
    double deviation_percent; /* rms of nodes at rest from the elastic reference that sags as much,
                               * of the length; NaN: there was none */
    bool same_sag;            /* it sags as much as all are to, within 2% of that */
    double times;             /* its ms_second by the first method's */
} BenchBaseline;

/* All of them, the first of which is FastLSM. */
typedef struct {
    BenchBaseline *method; /* [count] */
    long count;
    long nodes;                 /* of the beam */
    double length, sag_percent; /* its length; how much all are to sag */
    char comparable[BENCH_BASELINES_WORDS],
        not_comparable[BENCH_BASELINES_WORDS]; /* among methods */
    BenchMachine machine;
} BenchBaselines;

/* Reads a file. On SM_OK the caller frees it; else there is nothing to free. SM_INPUT, with the
 * file and what is wrong: no such file, not HDF5, cut off, damaged, another kind, another schema,
 * something missing, no method, a time that is no positive number, a sag that is
 * none. */
SmCode bench_baselines_load(const char *path, BenchBaselines *baselines, SmError *error);
void bench_baselines_free(BenchBaselines *baselines);

/* The table for people, after an empty line: on which machine and commit, a line a method, what is
 * comparable and what is not, and whether `here` is another machine; in LaTeX all but the tabular
 * are comments. */
void bench_baselines_print(FILE *file, BenchGridForm form, const BenchBaselines *baselines,
                           const BenchMachine *here);

/* For programs: as CSV, a header line and a line a method; as a JSON object {"methods": [{column:
 * value}], "nodes", "length", "sag_percent", "comparable", "not_comparable", "other_machine" (what
 * differs from `here`, or null), "environment": {...}}. */
void bench_baselines_csv(FILE *file, const BenchBaselines *baselines);
json_t *bench_json_baselines(const BenchBaselines *baselines, const BenchMachine *here);

#endif
