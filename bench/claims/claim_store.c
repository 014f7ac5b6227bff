#include "claim_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../table/row_store.h"
#include "fit.h"

static const char *const takes[] = {"values", "exponent", "largest", "gain"};

/* A finding as it is stored: words instead of enums. */
typedef struct {
    char paper[24], name[BENCH_CLAIM_NAME], place[32], unit[32], statement[240], note[200];
    char status[16], take[16], test[96], expect[16], because[320], verdict[16], words[560];
    char evidence[208], over[208], kind[20], unset_evidence[208];
    int values, count, trend;
    double tolerance, ratio[3], unset;
    double paper_value[BENCH_CLAIM_VALUES], measured[BENCH_CLAIM_VALUES];
    double low[BENCH_CLAIM_VALUES], high[BENCH_CLAIM_VALUES];
} Stored;

#define FIELD(kind, member) BENCH_FIELD(Stored, kind, member)
#define COUNT(array)        ((int)(sizeof(array) / sizeof((array)[0])))

static const BenchField claim_fields[] = {
    FIELD(BENCH_TEXT, paper),          FIELD(BENCH_TEXT, name),
    FIELD(BENCH_TEXT, place),          FIELD(BENCH_TEXT, unit),
    FIELD(BENCH_TEXT, statement),      FIELD(BENCH_TEXT, note),
    FIELD(BENCH_TEXT, status),         FIELD(BENCH_TEXT, take),
    FIELD(BENCH_TEXT, test),           FIELD(BENCH_TEXT, expect),
    FIELD(BENCH_TEXT, because),        FIELD(BENCH_TEXT, verdict),
    FIELD(BENCH_TEXT, words),          FIELD(BENCH_TEXT, evidence),
    FIELD(BENCH_TEXT, over),           FIELD(BENCH_INT, values),
    FIELD(BENCH_INT, count),           FIELD(BENCH_INT, trend),
    FIELD(BENCH_DOUBLE, tolerance),    FIELD(BENCH_DOUBLE, paper_value),
    FIELD(BENCH_DOUBLE, measured),     FIELD(BENCH_DOUBLE, low),
    FIELD(BENCH_DOUBLE, high),         FIELD(BENCH_TEXT, kind),
    FIELD(BENCH_DOUBLE, ratio),        FIELD(BENCH_DOUBLE, unset),
    FIELD(BENCH_TEXT, unset_evidence),
};

/* A curve's attributes. */
typedef struct {
    BenchCurve curve;
    BenchFit fit;
} StoredCurve;

#define CURVE_FIELD(kind, name, member)                                                            \
    {                                                                                              \
        BENCH_FIELD_AS(StoredCurve, kind, member, name)                                            \
    }

static const BenchField curve_fields[] = {
    CURVE_FIELD(BENCH_TEXT, "x_name", curve.x_name),
    CURVE_FIELD(BENCH_TEXT, "y_name", curve.y_name),
    CURVE_FIELD(BENCH_BOOL, "valid", curve.valid),
    CURVE_FIELD(BENCH_TEXT, "reason", curve.reason),
    CURVE_FIELD(BENCH_INT, "points", curve.points),
    CURVE_FIELD(BENCH_BOOL, "busy", curve.busy),
    CURVE_FIELD(BENCH_INT, "experiment", curve.experiment),
    CURVE_FIELD(BENCH_DOUBLE, "exponent", fit.exponent),
    CURVE_FIELD(BENCH_DOUBLE, "exponent_low", fit.low),
    CURVE_FIELD(BENCH_DOUBLE, "exponent_high", fit.high),
    CURVE_FIELD(BENCH_DOUBLE, "factor", fit.factor),
    CURVE_FIELD(BENCH_DOUBLE, "scatter", fit.scatter),
};

void bench_claim_place(const BenchLab *lab, int curve, size_t size, char *place)
{
    const BenchCurve *of = &lab->curve[curve];
    if (of->row >= 0)
        snprintf(place, size, "/rows/%03d", of->row);
    else
        snprintf(place, size, "/curves/%s", of->name);
}

static void pack(const BenchFinding *finding, Stored *stored)
{
    const BenchClaim *claim = &finding->claim;
    *stored = (Stored){.values = claim->values,
                       .count = finding->count,
                       .trend = finding->trend,
                       .tolerance = claim->tolerance,
                       .unset = finding->unset};
    memcpy(stored->ratio, finding->ratio, sizeof stored->ratio);
    strcpy(stored->kind, bench_claim_kind_name(claim->kind));
    strcpy(stored->unset_evidence, finding->evidence[2]);
    strcpy(stored->paper, claim->paper);
    strcpy(stored->name, claim->name);
    strcpy(stored->place, claim->place);
    strcpy(stored->unit, claim->unit);
    strcpy(stored->statement, claim->statement);
    strcpy(stored->note, claim->note);
    strcpy(stored->because, claim->because);
    strcpy(stored->words, finding->words);
    strcpy(stored->status, ref_status_name(claim->status));
    strcpy(stored->take, takes[claim->reduction]);
    strcpy(stored->expect, bench_expectation_name(claim->expect));
    strcpy(stored->verdict, bench_verdict_name(finding->verdict));
    strcpy(stored->evidence, finding->evidence[0]);
    strcpy(stored->over, finding->evidence[1]);
    bench_verdict_test(claim, sizeof stored->test, stored->test);
    for (int v = 0; v < BENCH_CLAIM_VALUES; v++) {
        bool there = v < finding->count;
        stored->paper_value[v] = v < claim->values ? claim->value[v] : NAN;
        stored->measured[v] = there ? finding->value[v] : NAN;
        stored->low[v] = there ? finding->low[v] : NAN;
        stored->high[v] = there ? finding->high[v] : NAN;
    }
}

static void write_curve(BenchH5 *h5, hid_t parent, const BenchCurve *curve)
{
    const struct {
        const char *name;
        const double *values;
    } sets[] = {{"x", curve->x}, {"y", curve->y}, {"low", curve->low}, {"high", curve->high}};
    StoredCurve stored = {.curve = *curve};
    hsize_t size[] = {(hsize_t)curve->points};
    hid_t group = bench_h5_group(h5, parent, curve->name);
    bench_fit_power(curve->x, curve->y, curve->points, &stored.fit);
    bench_h5_fields(h5, group, curve_fields, COUNT(curve_fields), &stored);
    for (int s = 0; s < COUNT(sets) && curve->points; s++)
        bench_h5_dataset(h5, group, sets[s].name, H5T_IEEE_F64LE, 1, size, sets[s].values);
    if (group >= 0) H5Gclose(group);
}

static void write_claims(BenchH5 *h5, const BenchFinding *findings, int count)
{
    hid_t group = bench_h5_group(h5, h5->file, "claims");
    for (int f = 0; f < count; f++) {
        Stored stored;
        char name[16];
        snprintf(name, sizeof name, "%03d", f);
        pack(&findings[f], &stored);
        hid_t claim = bench_h5_group(h5, group, name);
        bench_h5_fields(h5, claim, claim_fields, COUNT(claim_fields), &stored);
        if (claim >= 0) H5Gclose(claim);
    }
}

void bench_claim_write(BenchH5 *h5, const BenchFinding *findings, int count, const BenchLab *lab)
{
    const unsigned char quick = lab->quick;
    bench_h5_numbers(h5, h5->file, "claims", H5T_STD_I32LE, 0, &count);
    bench_h5_numbers(h5, h5->file, "quick", H5T_STD_U8LE, 0, &quick);
    hid_t group = bench_h5_group(h5, h5->file, "rows");
    for (int r = 0; r < lab->rows; r++) bench_store_row(h5, group, r, &lab->row[r]);
    group = bench_h5_group(h5, h5->file, "curves");
    for (int c = 0; c < lab->curves; c++)
        if (lab->curve[c].row < 0) write_curve(h5, group, &lab->curve[c]);
    write_claims(h5, findings, count);
}

static void read_curve(BenchH5 *h5, hid_t parent, const char *name, BenchCurve *curve)
{
    StoredCurve stored = {.curve = {.row = -1}};
    hid_t group = bench_h5_find_group(h5, parent, name);
    bench_h5_read_fields(h5, group, curve_fields, COUNT(curve_fields), &stored);
    *curve = stored.curve;
    snprintf(curve->name, sizeof curve->name, "%s", name);
    if (!h5->failed && (curve->points < 0 || curve->points > BENCH_CURVE_POINTS))
        bench_h5_fail(h5, "curve '%s' has %d points", name, curve->points);
    const struct {
        const char *name;
        double *values;
    } sets[] = {{"x", curve->x}, {"y", curve->y}, {"low", curve->low}, {"high", curve->high}};
    hsize_t size = (hsize_t)curve->points;
    for (int s = 0; s < COUNT(sets) && curve->points && !h5->failed; s++)
        bench_h5_read(h5, bench_h5_find_dataset(h5, group, sets[s].name, 1, &size),
                      H5T_NATIVE_DOUBLE, sets[s].values);
    if (group >= 0) H5Gclose(group);
}

void bench_claim_read_curves(BenchH5 *h5, BenchLab *lab)
{
    H5G_info_t info = {.nlinks = 0};
    hid_t group = bench_h5_find_group(h5, h5->file, "curves");
    if (!h5->failed && H5Gget_info(group, &info) < 0) bench_h5_fail(h5, "no curves can be read");
    for (hsize_t c = 0; c < info.nlinks && !h5->failed; c++) {
        char name[BENCH_CURVE_NAME];
        BenchCurve curve;
        if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, c, name, sizeof name,
                               H5P_DEFAULT) < 0)
            bench_h5_fail(h5, "the curves cannot be listed");
        else
            read_curve(h5, group, name, &curve);
        if (!h5->failed) bench_lab_keep(lab, &curve);
    }
}
