#include "claim_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draft.h"
#include "fit.h"
#include "store.h"

static const char file_kind[] = "shapebench claims";
enum { MOST = 10000 }; /* claims or curves: more is a damaged file */

static const char *const takes[] = {"values", "exponent", "largest", "gain"};

/* A finding as it is stored: words instead of enums. */
typedef struct {
    char paper[24], name[BENCH_CLAIM_NAME], place[32], unit[32], statement[240], note[200];
    char status[16], take[16], test[96], expect[16], because[320], verdict[16], words[560];
    char evidence[208], over[208];
    int values, count, trend;
    double tolerance;
    double paper_value[BENCH_CLAIM_VALUES], measured[BENCH_CLAIM_VALUES];
    double low[BENCH_CLAIM_VALUES], high[BENCH_CLAIM_VALUES];
} Stored;

#define FIELD(kind, member) BENCH_FIELD(Stored, kind, member)
#define COUNT(array)        ((int)(sizeof(array) / sizeof((array)[0])))

static const BenchField claim_fields[] = {
    FIELD(BENCH_TEXT, paper),       FIELD(BENCH_TEXT, name),          FIELD(BENCH_TEXT, place),
    FIELD(BENCH_TEXT, unit),        FIELD(BENCH_TEXT, statement),     FIELD(BENCH_TEXT, note),
    FIELD(BENCH_TEXT, status),      FIELD(BENCH_TEXT, take),          FIELD(BENCH_TEXT, test),
    FIELD(BENCH_TEXT, expect),      FIELD(BENCH_TEXT, because),       FIELD(BENCH_TEXT, verdict),
    FIELD(BENCH_TEXT, words),       FIELD(BENCH_TEXT, evidence),      FIELD(BENCH_TEXT, over),
    FIELD(BENCH_INT, values),       FIELD(BENCH_INT, count),          FIELD(BENCH_INT, trend),
    FIELD(BENCH_DOUBLE, tolerance), FIELD(BENCH_DOUBLE, paper_value), FIELD(BENCH_DOUBLE, measured),
    FIELD(BENCH_DOUBLE, low),       FIELD(BENCH_DOUBLE, high),
};

/* A curve's attributes. */
typedef struct {
    BenchCurve curve;
    BenchFit fit;
} StoredCurve;

#define CURVE_FIELD(kind, name, member)                                                            \
    {                                                                                              \
        name, kind, offsetof(StoredCurve, member), sizeof((StoredCurve *)0)->member                \
    }

static const BenchField curve_fields[] = {
    CURVE_FIELD(BENCH_TEXT, "x_name", curve.x_name),
    CURVE_FIELD(BENCH_TEXT, "y_name", curve.y_name),
    CURVE_FIELD(BENCH_BOOL, "valid", curve.valid),
    CURVE_FIELD(BENCH_TEXT, "reason", curve.reason),
    CURVE_FIELD(BENCH_INT, "points", curve.points),
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

/* ---- writing */

static void pack(const BenchFinding *finding, Stored *stored)
{
    const BenchClaim *claim = &finding->claim;
    *stored = (Stored){.values = claim->values,
                       .count = finding->count,
                       .trend = finding->trend,
                       .tolerance = claim->tolerance};
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

static void write_file(BenchH5 *h5, const BenchFinding *findings, int count, const BenchLab *lab,
                       const BenchMachine *machine)
{
    int schema = BENCH_CLAIM_SCHEMA, machine_count;
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    const unsigned char quick = lab->quick;
    bench_h5_text(h5, h5->file, "kind", file_kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_numbers(h5, h5->file, "claims", H5T_STD_I32LE, 0, &count);
    bench_h5_numbers(h5, h5->file, "quick", H5T_STD_U8LE, 0, &quick);
    hid_t group = bench_h5_group(h5, h5->file, "machine");
    bench_h5_fields(h5, group, machine_fields, machine_count, machine);
    group = bench_h5_group(h5, h5->file, "rows");
    for (int r = 0; r < lab->rows; r++) bench_store_row(h5, group, r, &lab->row[r]);
    group = bench_h5_group(h5, h5->file, "curves");
    for (int c = 0; c < lab->curves; c++)
        if (lab->curve[c].row < 0) write_curve(h5, group, &lab->curve[c]);
    write_claims(h5, findings, count);
}

SmCode bench_claim_store(const char *path, const BenchFinding *findings, int count,
                         const BenchLab *lab, const BenchMachine *machine, SmError *error)
{
    BenchDraft draft;
    SmCode code = bench_draft_begin(path, &draft, error);
    if (code) return code;
    BenchH5 h5;
    bench_h5_create(&h5, draft.tmp);
    write_file(&h5, findings, count, lab, machine);
    if (bench_h5_close(&h5)) return bench_draft_commit(&draft, error);
    bench_draft_discard(&draft);
    return bench_draft_fail(path, h5.number, h5.message, error);
}

/* ---- reading */

/* Place of `word` in the list; a failure where it is not. */
static int place_of(BenchH5 *h5, const char *word, const char *const *words, int count)
{
    for (int w = 0; w < count; w++)
        if (!strcmp(word, words[w])) return w;
    bench_h5_fail(h5, "'%.40s' is not one of its words", word);
    return 0;
}

static void unpack(BenchH5 *h5, const Stored *stored, BenchFinding *finding)
{
    const char *verdicts[BENCH_VERDICTS], *statuses[REF_SECOND_HAND + 1];
    const char *expectations[BENCH_NOT_COMPARABLE + 1];
    for (int e = 0; e <= BENCH_NOT_COMPARABLE; e++)
        expectations[e] = bench_expectation_name((BenchExpectation)e);
    for (int v = 0; v < BENCH_VERDICTS; v++) verdicts[v] = bench_verdict_name((BenchVerdict)v);
    for (int s = 0; s <= REF_SECOND_HAND; s++) statuses[s] = ref_status_name((RefStatus)s);
    BenchClaim *claim = &finding->claim;
    if (stored->values < 0 || stored->values > BENCH_CLAIM_VALUES || stored->count < 0 ||
        stored->count > BENCH_CLAIM_VALUES)
        bench_h5_fail(h5, "it has %d and %d values", stored->values, stored->count);
    if (h5->failed) return;
    strcpy(claim->paper, stored->paper);
    strcpy(claim->name, stored->name);
    strcpy(claim->place, stored->place);
    strcpy(claim->unit, stored->unit);
    strcpy(claim->statement, stored->statement);
    strcpy(claim->note, stored->note);
    strcpy(claim->because, stored->because);
    strcpy(finding->words, stored->words);
    strcpy(finding->evidence[0], stored->evidence);
    strcpy(finding->evidence[1], stored->over);
    claim->status = (RefStatus)place_of(h5, stored->status, statuses, COUNT(statuses));
    claim->reduction = (BenchReduction)place_of(h5, stored->take, takes, COUNT(takes));
    claim->expect =
        (BenchExpectation)place_of(h5, stored->expect, expectations, COUNT(expectations));
    finding->verdict = (BenchVerdict)place_of(h5, stored->verdict, verdicts, COUNT(verdicts));
    claim->values = stored->values;
    claim->tolerance = stored->tolerance;
    finding->count = stored->count;
    finding->trend = stored->trend;
    memcpy(claim->value, stored->paper_value, sizeof claim->value);
    memcpy(finding->value, stored->measured, sizeof finding->value);
    memcpy(finding->low, stored->low, sizeof finding->low);
    memcpy(finding->high, stored->high, sizeof finding->high);
}

static void read_claim(BenchH5 *h5, hid_t parent, int number, BenchFinding *finding)
{
    char name[16];
    Stored stored;
    memset(&stored, 0, sizeof stored);
    snprintf(name, sizeof name, "%03d", number);
    hid_t group = bench_h5_find_group(h5, parent, name);
    bench_h5_read_fields(h5, group, claim_fields, COUNT(claim_fields), &stored);
    if (!h5->failed) unpack(h5, &stored, finding);
    if (group >= 0) H5Gclose(group);
}

static void read_curve(BenchH5 *h5, hid_t parent, const char *name, BenchCurve *curve)
{
    StoredCurve stored;
    memset(&stored, 0, sizeof stored);
    hid_t group = bench_h5_find_group(h5, parent, name);
    bench_h5_read_fields(h5, group, curve_fields, COUNT(curve_fields), &stored);
    if (!h5->failed && (stored.curve.points < 0 || stored.curve.points > BENCH_CURVE_POINTS))
        bench_h5_fail(h5, "curve '%s' has %d points", name, stored.curve.points);
    *curve = stored.curve;
    curve->row = -1;
    snprintf(curve->name, sizeof curve->name, "%s", name);
    double *const values[] = {curve->x, curve->y, curve->low, curve->high};
    const char *const names[] = {"x", "y", "low", "high"};
    hsize_t size[] = {(hsize_t)curve->points};
    for (int s = 0; s < 4 && !h5->failed && curve->points; s++) {
        hid_t set = bench_h5_find_dataset(h5, group, names[s], 1, size);
        bench_h5_read(h5, set, H5T_NATIVE_DOUBLE, values[s]);
        if (set >= 0) H5Dclose(set);
    }
    if (group >= 0) H5Gclose(group);
}

/* Links of a group, at most MOST. */
static int links_of(BenchH5 *h5, hid_t group)
{
    H5G_info_t info;
    if (h5->failed) return 0;
    if (H5Gget_info(group, &info) < 0 || info.nlinks > MOST) {
        bench_h5_fail(h5, "a group has too many members");
        return 0;
    }
    return (int)info.nlinks;
}

/* Where what is read goes. */
typedef struct {
    BenchFinding **findings;
    int *count;
    BenchCurve **curves;
    int *curve_count;
    BenchMachine *machine;
} File;

static void read_file(BenchH5 *h5, void *record)
{
    File *file = record;
    int stored = 0, machine_count;
    const BenchField field = {"claims", BENCH_INT, 0, sizeof stored};
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    bench_h5_check_kind(h5, file_kind, BENCH_CLAIM_SCHEMA, BENCH_CLAIM_SCHEMA);
    bench_h5_read_fields(h5, h5->file, &field, 1, &stored);
    hid_t group = bench_h5_find_group(h5, h5->file, "machine");
    bench_h5_read_fields(h5, group, machine_fields, machine_count, file->machine);
    hid_t claims = bench_h5_find_group(h5, h5->file, "claims");
    if (!h5->failed && links_of(h5, claims) != stored)
        bench_h5_fail(h5, "it holds another number of claims than the %d it states", stored);
    group = bench_h5_find_group(h5, h5->file, "curves");
    int links = links_of(h5, group);
    if (h5->failed) return;
    *file->findings = sm_alloc((size_t)stored, sizeof **file->findings);
    *file->count = stored;
    for (int f = 0; f < stored && !h5->failed; f++)
        read_claim(h5, claims, f, &(*file->findings)[f]);
    *file->curves = sm_alloc((size_t)links, sizeof **file->curves);
    *file->curve_count = links;
    for (int c = 0; c < links && !h5->failed; c++) {
        char name[BENCH_CURVE_NAME];
        if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, (hsize_t)c, name,
                               sizeof name, H5P_DEFAULT) < 0)
            bench_h5_fail(h5, "a curve has no name");
        else
            read_curve(h5, group, name, &(*file->curves)[c]);
    }
}

SmCode bench_claim_load(const char *path, BenchFinding **findings, int *count, BenchCurve **curves,
                        int *curve_count, BenchMachine *machine, SmError *error)
{
    *findings = NULL;
    *curves = NULL;
    *count = *curve_count = 0;
    memset(machine, 0, sizeof *machine);
    SmCode code = bench_h5_load(path, read_file,
                                &(File){findings, count, curves, curve_count, machine}, error);
    if (!code) return SM_OK;
    free(*findings);
    free(*curves);
    *findings = NULL;
    *curves = NULL;
    *count = *curve_count = 0;
    return code;
}
