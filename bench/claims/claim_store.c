#include "claim_store.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../table/grid.h"
#include "../table/quantity.h"
#include "../table/row_store.h"
#include "fit.h"

#define MEMBER(title, member)                                                                      \
    .name = (title), .offset = offsetof(BenchFinding, member),                                     \
    .size = sizeof(((BenchFinding *)0)->member)
#define STORED(type, title, member) MEMBER(title, member), .kind = BENCH_##type
#define FIELD(type, title, member)  STORED(type, title, member), .column = (title)
#define MEANS(of_what, what)        BENCH_MEANS(of_what, what)
#define ONLY(kind)                  .tables = 1U << (kind)
#define COUNT(array)                ((int)(sizeof(array) / sizeof((array)[0])))

/* ---- cells */

static int paper_values(const void *record)
{
    return ((const BenchFinding *)record)->claim.values;
}

static int measured_values(const void *record)
{
    return ((const BenchFinding *)record)->count;
}

static int ratio_values(const void *record)
{
    return isnan(((const BenchFinding *)record)->ratio[0]) ? 0 : 3;
}

static int unset_values(const void *record)
{
    return !isnan(((const BenchFinding *)record)->unset);
}

static const char *status_text(const void *record)
{
    return ref_status_name(((const BenchFinding *)record)->claim.status);
}

static const char *status_of_values(const void *record)
{
    return paper_values(record) ? status_text(record) : "";
}

static void paper_cell(const void *record, char *text)
{
    const BenchClaim *claim = &((const BenchFinding *)record)->claim;
    char paper[64];
    bench_verdict_paper(claim, sizeof paper, paper);
    snprintf(text, BENCH_GRID_TEXT, "%s%s", paper, bench_quantity_mark(claim->status));
}

static void measured_cell(const void *record, char *text)
{
    bench_verdict_measured(record, BENCH_GRID_TEXT, text);
}

static void unset_cell(const void *record, char *text)
{
    bench_verdict_unset_text(record, BENCH_GRID_TEXT, text);
}

static void ratio_cell(const void *record, char *text)
{
    bench_verdict_ratio(record, BENCH_GRID_TEXT, text);
}

/* ---- all members */

const BenchField bench_claim_fields[] = {
    {FIELD(TEXT, "paper", claim.paper), MEANS(NULL, "whose claim it is"), .title = "paper",
     .left = true},
    {FIELD(TEXT, "name", claim.name), MEANS(NULL, "of the claim"), .title = "claim", .left = true},
    {FIELD(TEXT, "place", claim.place), MEANS(NULL, "where it stands"), .title = "where",
     .left = true},
    {FIELD(TEXT, "statement", claim.statement), MEANS(NULL, "what is claimed")},
    {STORED(TEXT, "note", claim.note), MEANS(NULL, "of the paper's number")},
    {STORED(INT, "values", claim.values),
     MEANS(NULL, "how many the paper gives; 0: it says only that something rises or falls")},
    {BENCH_CELL("paper says", paper_cell)},
    {BENCH_CELL("measured", measured_cell),
     .tables = 1U << BENCH_OF_METHOD | 1U << BENCH_OF_MACHINE},
    {BENCH_CELL("counted", measured_cell), ONLY(BENCH_BY_CONSTRUCTION)},
    {FIELD(TEXT, "unit", claim.unit), MEANS(NULL, "of all values"), .title = "unit", .left = true},
    {FIELD(DOUBLE, "paper_value", claim.value), MEANS(NULL, "the paper's, NaN beyond `values`"),
     .listed = paper_values},
    {.name = "status",
     .kind = BENCH_TEXT,
     .text = status_text,
     MEANS(NULL, "of them: quoted, derived, ours (for the paper's words), damaged or second-hand")},
    {.column = "status", .kind = BENCH_TEXT, .text = status_of_values},
    {FIELD(DOUBLE, "measured", value), MEANS(NULL, "values, NaN beyond `count`"),
     .listed = measured_values},
    {FIELD(DOUBLE, "low", low), MEANS(NULL, "of each the lower end of the 95% confidence interval"),
     .listed = measured_values},
    {FIELD(DOUBLE, "high", high), MEANS(NULL, "and the upper one; the same: it has none"),
     .listed = measured_values},
    {STORED(INT, "count", count), MEANS(NULL, "how many were measured")},
    {STORED(INT, "trend", trend),
     MEANS(NULL, "1: the curve rises from every point to the next; -1: falls; 0: neither")},
    {STORED(TEXT, "take", claim.reduction), .choices = bench_reductions,
     MEANS(NULL, "what was taken of it: values, exponent, largest, gain")},
    {BENCH_CELL("not set", unset_cell), ONLY(BENCH_BY_CONSTRUCTION)},
    {BENCH_CELL("times as fast", ratio_cell), ONLY(BENCH_OF_MACHINE)},
    {FIELD(TEXT, "test", test), MEANS(NULL, "in words"), .title = "test", .left = true,
     .tables = 1U << BENCH_OF_METHOD | 1U << BENCH_BY_CONSTRUCTION},
    {STORED(DOUBLE, "tolerance", claim.tolerance), MEANS(NULL, "of the test")},
    {FIELD(TEXT, "expect", claim.expect), .choices = bench_expectations,
     MEANS(NULL, "reproduced, different or not comparable")},
    {STORED(TEXT, "because", claim.because), MEANS(NULL, "why it differs, or cannot be compared")},
    {FIELD(TEXT, "verdict", verdict), .choices = bench_verdict_names,
     MEANS(NULL, "of the method reproduced, undecided, not reproduced or differs; of a machine "
                 "measured or not comparable; by construction as set or not as set; BUSY (others "
                 "took the processors) or INVALID (`bench/claims/verdict.h`)"),
     .title = "verdict", .left = true},
    {FIELD(TEXT, "words", words), MEANS(NULL, "the line that explains it")},
    {FIELD(TEXT, "evidence", evidence[0]),
     MEANS(NULL, "group in the file, /rows/... or /curves/..., that `measured` comes from")},
    {FIELD(TEXT, "over", evidence[1]), MEANS(NULL, "what it is divided by, or empty")},
    {FIELD(TEXT, "kind", claim.kind), .choices = bench_claim_kinds,
     MEANS(NULL, "method: what the paper's idea should do anywhere; machine: a speed; by "
                 "construction: what the scene file sets")},
    {FIELD(DOUBLE, "ratio", ratio),
     MEANS(NULL, "of a machine's speed: how many times as fast as the paper's machine, and the "
                 "ends of the 95% interval; NaN of others"),
     .listed = ratio_values},
    {FIELD(DOUBLE, "unset", unset),
     MEANS(NULL, "by construction: what comes where the scene does not set the number; NaN: not "
                 "measured"),
     .listed = unset_values},
    {FIELD(TEXT, "unset_evidence", evidence[2]), MEANS(NULL, "the group that it is from")},
};

const int bench_claim_field_count = COUNT(bench_claim_fields);

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

/* Its datasets. */
static const struct {
    const char *name;
    size_t offset;
} curve_sets[] = {{"x", offsetof(BenchCurve, x)},
                  {"y", offsetof(BenchCurve, y)},
                  {"low", offsetof(BenchCurve, low)},
                  {"high", offsetof(BenchCurve, high)}};

static void write_curve(BenchH5 *h5, hid_t parent, const BenchCurve *curve)
{
    StoredCurve stored = {.curve = *curve};
    hsize_t size[] = {(hsize_t)curve->points};
    hid_t group = bench_h5_group(h5, parent, curve->name);
    bench_fit_power(curve->x, curve->y, curve->points, &stored.fit);
    bench_h5_fields(h5, group, curve_fields, COUNT(curve_fields), &stored);
    for (int s = 0; s < COUNT(curve_sets) && curve->points; s++)
        bench_h5_dataset(h5, group, curve_sets[s].name, H5T_IEEE_F64LE, 1, size,
                         (const char *)curve + curve_sets[s].offset);
    if (group >= 0) H5Gclose(group);
}

static void write_claims(BenchH5 *h5, const BenchFinding *findings, int count)
{
    hid_t group = bench_h5_group(h5, h5->file, "claims");
    for (int f = 0; f < count; f++) {
        char name[16];
        snprintf(name, sizeof name, "%03d", f);
        hid_t claim = bench_h5_group(h5, group, name);
        bench_h5_fields(h5, claim, bench_claim_fields, bench_claim_field_count, &findings[f]);
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
    hsize_t size = (hsize_t)curve->points;
    for (int s = 0; s < COUNT(curve_sets) && curve->points && !h5->failed; s++)
        bench_h5_read(h5, bench_h5_find_dataset(h5, group, curve_sets[s].name, 1, &size),
                      H5T_NATIVE_DOUBLE, (char *)curve + curve_sets[s].offset);
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
