#define _GNU_SOURCE
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../store/h5.h"
#include "claim_store.h"
#include "claim_table.h"
#include "experiments.h"

/* A claim to change words of. */
static const char good[] =
    "claims = (\n"
    "  { kind = \"method\"; paper = \"p\"; name = \"n\"; statement = \"It is so.\"; value = 3.0;\n"
    "    test = \"near\"; tolerance = 0.1;\n"
    "    measure = { experiment = \"sums\"; w = { from = 1; to = 8; points = 4; }; };\n"
    "  }\n"
    ");\n";

static SmCode parse(const char *text, BenchClaims *claims, SmError *error)
{
    return bench_claims_parse(text, strlen(text), "my.cfg", claims, error);
}

/* The good claim with one text replaced by another. */
static const char *with(const char *old, const char *new)
{
    static char text[2048];
    const char *at = strstr(good, old);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, new, at + strlen(old));
    return text;
}

TEST(a_claim_is_read_whole)
{
    BenchClaims claims = {0};
    SmError error;
    assert_int_equal(parse(good, &claims, &error), SM_OK);
    const BenchClaim *claim = &claims.claim[0];
    assert_int_equal(claims.count, 1);
    assert_true(claim->values == 1 && claim->value[0] == 3 && claim->tolerance == 0.1);
    assert_int_equal(claim->test, BENCH_IS_NEAR);
    assert_int_equal(claim->measure.experiment, BENCH_TRY_SUMS);
    assert_int_equal(claim->measure.w.to, 8);
    assert_int_equal(claim->over.experiment, BENCH_TRY_NOTHING);
    assert_int_equal(claim->expect, BENCH_REPRODUCES);
    assert_int_equal(claim->kind, BENCH_OF_METHOD);
    bench_claims_free(&claims);
}

TEST(values_come_from_the_papers)
{
    BenchClaims claims = {0};
    SmError error;
    const char *number =
        with("paper = \"p\"; name = \"n\"; statement = \"It is so.\"; value = 3.0;",
             "paper = \"fastlsm\"; name = \"n\"; statement = \"s\"; number = \"warm-sweeps\";");
    assert_int_equal(parse(number, &claims, &error), SM_OK);
    assert_true(claims.claim[0].value[0] == ref_paper_claim("fastlsm", "warm-sweeps")->value.value);
    assert_string_equal(claims.claim[0].place, "section 4");
    const char *row =
        with("paper = \"p\"; name = \"n\"; statement = \"It is so.\"; value = 3.0;",
             "paper = \"fastlsm\"; name = \"row\"; statement = \"s\"; row = \"infant\"; "
             "column = \"stage_percent\";");
    assert_int_equal(parse(row, &claims, &error), SM_OK);
    assert_int_equal(claims.claim[1].values, SM_STAGES);
    assert_true(claims.claim[1].value[SM_DAMPING] == 30);
    bench_claims_free(&claims);
}

TEST(mistakes_are_named_with_their_line)
{
    const struct {
        const char *old, *new, *line, *says;
    } cases[] = {
        {"test = \"near\"", "test = \"nearly\"", "my.cfg:3:", "one of"},
        {"test = \"near\"", "test = \"contains\"", "my.cfg:3:", "one of"},
        {"tolerance = 0.1", "tolerance = -1.0", "my.cfg:3:", "number from"},
        {"tolerance = 0.1", "tolerence = 0.1", "my.cfg:3:", "unknown setting 'tolerence'"},
        {"test = \"near\"; ", "", "my.cfg:2:", "no 'test'"},
        {"experiment = \"sums\"", "experiment = \"sum\"", "my.cfg:4:", "sums"},
        {"measure = { experiment = \"sums\"; w = { from = 1; to = 8; points = 4; }; };", "",
         "my.cfg:2:", "no experiment"},
        {"to = 8", "to = 0", "my.cfg:4:", "whole number"},
        {"from = 1", "from = 9", "my.cfg:2:", "rising"},
        {"to = 8", "to = 80", "my.cfg:2:", "at most 16"},
        {"experiment = \"sums\"; w = { from = 1;", "experiment = \"breaking\"; n = { from = 5;",
         "my.cfg:2:", "at least 6"},
        {"w = {", "scene = \"beam\"; w = {", "my.cfg:2:", "'scene' is not of this"},
        {"experiment = \"sums\"; w = { from = 1; to = 8; points = 4; };",
         "experiment = \"scene\"; scene = \"hand\"; field = \"x\";",
         "my.cfg:2:", "or a number of a row"},
        {"value = 3.0;", "", "my.cfg:2:", "no value"},
        {"value = 3.0;", "value = 3.0; number = \"x\";", "my.cfg:2:", "give one of them"},
        {"value = 3.0;", "number = \"x\";", "my.cfg:2:", "has no number 'x'"},
        {"value = 3.0;", "row = \"x\"; column = \"w\";", "my.cfg:2:", "has no row 'x'"},
        {"value = 3.0;", "value = 3.0; expect = \"different\";", "my.cfg:2:", "because"},
        {"test = \"near\"", "take = \"exponent\"; test = \"near\"", "", ""},
        {"points = 4", "points = 2", "", ""},
        {"kind = \"method\"; ", "", "my.cfg:2:", "no 'kind'"},
        {"kind = \"method\"", "kind = \"guess\"", "my.cfg:2:", "one of"},
        {"kind = \"method\"", "kind = \"machine\"", "my.cfg:2:", "at_least"},
        {"kind = \"method\"", "kind = \"by construction\"", "my.cfg:2:", "'unset', or say"},
        {"kind = \"method\"", "kind = \"by construction\"; because = \"x\"", "", ""},
        {"kind = \"method\"", "kind = \"by construction\"; because = \"x\"; expect = \"different\"",
         "my.cfg:2:", "is not expected to differ"},
        {"value = 3.0;", "value = 3.0; unset = { experiment = \"polar\"; field = \"cold-ns\"; };",
         "my.cfg:2:", "'unset' is of a claim of the kind"},
        {"w = {", "without = \"nodes\"; w = {", "my.cfg:2:", "'without' is not of this"},
        {"name = \"n\"", "name = \"a/b\"", "my.cfg:2:", "no blank"},
        {"name = \"n\"; ", "", "my.cfg:2:", "needs 'paper', 'name'"},
        {"claims = (", "claim = (", "my.cfg", "one setting"},
        {"claims = (", "@include \"x\"\nclaims = (", "my.cfg:1:", "@include"},
        {"value = 3.0;", "value = = 3.0;", "my.cfg:2:", "syntax error"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        BenchClaims claims = {0};
        SmError error = {0};
        SmCode code = parse(with(cases[c].old, cases[c].new), &claims, &error);
        assert_int_equal(code, cases[c].says[0] ? SM_INPUT : SM_OK);
        if (code) {
            assert_memory_equal(error.text, cases[c].line, strlen(cases[c].line));
            if (!strstr(error.text, cases[c].says)) fail_msg("%s", error.text);
            assert_int_equal(claims.count, 0);
        }
        bench_claims_free(&claims);
    }
}

TEST(a_name_is_there_once_and_curves_have_points)
{
    BenchClaims claims = {0};
    SmError error;
    assert_int_equal(parse(good, &claims, &error), SM_OK);
    assert_int_equal(parse(good, &claims, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "there already"));
    assert_int_equal(claims.count, 1);
    assert_int_equal(
        parse(with("points = 4", "points = 2; }; }; take = \"exponent\"; over = { experiment = "
                                 "\"sums\"; w = { from = 1; to = 8; points = 2"),
              &claims, &error),
        SM_INPUT);
    assert_non_null(strstr(error.text, "three points"));
    bench_claims_free(&claims);
}

/* "Table 1", "Fig. 4", "section 4" or "section 4.2", of what the paper has. */
static bool place_is_known(const char *paper, const char *place)
{
    bool octree = !strcmp(paper, "octree");
    bool shells = !strcmp(paper, "meshless");
    int part, sub, used = 0;
    if (sscanf(place, "Table %d%n", &part, &used) == 1)
        return !place[used] && !octree && part >= 1 && part <= (shells ? 2 : 1);
    if (sscanf(place, "Fig. %d%n", &part, &used) == 1)
        return !place[used] && part >= 1 && part <= 6;
    if (sscanf(place, "section %d%n", &part, &used) != 1) return false;
    if (part < 1 || part > (octree ? 7 : 6)) return false;
    if (!place[used]) return true;
    place += used;
    return sscanf(place, ".%d%n", &sub, &used) == 1 && !place[used] && sub >= 1 && sub <= 3;
}

/* And no experiment is without a claim. */
TEST(the_programs_own_claims_are_sound)
{
    bool used[64] = {false};
    BenchClaims claims = {0};
    SmError error;
    int kinds[BENCH_CLAIM_KINDS] = {0};
    if (bench_claims_builtin(&claims, &error)) fail_msg("%s", error.text);
    assert_true(claims.count >= 40);
    for (int c = 0; c < claims.count; c++) {
        const BenchClaim *claim = &claims.claim[c];
        if (!place_is_known(claim->paper, claim->place))
            fail_msg("%s of %s: '%s'", claim->name, claim->paper, claim->place);
        assert_true(claim->unit[0]);
        kinds[claim->kind]++;
        assert_true(claim->measure.experiment < 64);
        used[claim->measure.experiment] = true;
        char test[96];
        bench_verdict_test(&claims.claim[c], sizeof test, test);
        assert_true(strlen(test) > 4);
    }
    for (int k = 0; k < BENCH_CLAIM_KINDS; k++) assert_true(kinds[k] >= 5);
    for (int e = BENCH_TRY_NOTHING + 1; bench_experiment_names()[e]; e++)
        if (!used[e]) fail_msg("no claim is measured by '%s'", bench_experiment_names()[e]);
    bench_claims_free(&claims);
}

/* ---- the file */

enum { FINDINGS = 4 };
static BenchFinding findings[FINDINGS];
static BenchLab lab;
static BenchMachine machine;

/* A machine's time, and a number that the scene sets. */
static void fill_others(void)
{
    static BenchCurve time, count, unset;
    bench_curve_begin(&time, "-", "ms");
    bench_curve_add(&time, 0, 2, 1.5, 2.5);
    bench_curve_begin(&count, "-", "nodes");
    bench_curve_add(&count, 0, 662, 662, 662);
    bench_curve_begin(&unset, "-", "nodes");
    bench_curve_add(&unset, 0, 593, 593, 593);
    BenchClaim claim = {.kind = BENCH_OF_MACHINE,
                        .paper = "p",
                        .name = "time",
                        .test = BENCH_IS_AT_MOST,
                        .values = 1,
                        .value = {30}};
    bench_verdict_find(&claim, &time, NULL, &findings[2]);
    claim = (BenchClaim){.kind = BENCH_BY_CONSTRUCTION,
                         .paper = "p",
                         .name = "set",
                         .tolerance = 0.02,
                         .values = 1,
                         .value = {661}};
    bench_verdict_find(&claim, &count, NULL, &findings[3]);
    bench_verdict_unset(&unset, &findings[3]);
    strcpy(findings[3].evidence[2], "/rows/007");
}

static void fill(void)
{
    static BenchCurve curve;
    char program[] = "shapebench claims";
    char *argv[] = {program, NULL};
    bench_machine_read(1, argv, 2, &machine);
    bench_curve_begin(&curve, "w", "sag");
    strcpy(curve.name, "sag.beam.w1-3.3");
    for (int p = 0; p < 3; p++) bench_curve_add(&curve, p + 1, 3.25 - p, 3 - p, 3.5 - p);
    lab = (BenchLab){.quick = true, .threads = 2, .curves = 1, .curve = &curve};
    BenchClaim claim = {.paper = "p",
                        .name = "n",
                        .statement = "It is, \"so\" it is said.",
                        .test = BENCH_FALLS,
                        .expect = BENCH_DIFFERS,
                        .because = "of the weather"};
    bench_verdict_find(&claim, &curve, NULL, &findings[0]);
    bench_claim_place(&lab, 0, sizeof findings[0].evidence[0], findings[0].evidence[0]);
    claim.test = BENCH_IS_NEAR;
    claim.values = 3;
    claim.value[0] = claim.value[1] = claim.value[2] = 1;
    strcpy(claim.name, "m");
    bench_verdict_find(&claim, &curve, NULL, &findings[1]);
    fill_others();
}

static void has_text(BenchH5 *h5, hid_t object, const char *name, const char *wanted)
{
    char text[600] = "";
    bench_h5_read_text(h5, object, name, sizeof text, text);
    if (h5->failed) fail_msg("%s: %s", name, h5->message);
    assert_string_equal(text, wanted);
}

static void has_number(BenchH5 *h5, hid_t object, const char *name, int wanted)
{
    int number = 0;
    const BenchField field = BENCH_VARIABLE(name, BENCH_INT, number);
    bench_h5_read_fields(h5, object, &field, 1, &number);
    if (h5->failed) fail_msg("%s: %s", name, h5->message);
    assert_int_equal(number, wanted);
}

/* One of a claim's numbers, of which each has room for all values. */
static double number_of(BenchH5 *h5, hid_t claim, const char *name, int value)
{
    double numbers[BENCH_CLAIM_VALUES];
    const BenchField field = BENCH_VARIABLE(name, BENCH_DOUBLE, numbers);
    bench_h5_read_fields(h5, claim, &field, 1, numbers);
    if (h5->failed) fail_msg("%s: %s", name, h5->message);
    return numbers[value];
}

/* Stores what fill() makes and opens it. */
static void write_all(BenchH5 *h5, void *record)
{
    (void)record;
    bench_claim_write(h5, findings, FINDINGS, &lab);
}

static void open_stored(BenchH5 *h5)
{
    SmError error;
    const char *path = path_in("claims.h5");
    fill();
    if (bench_h5_store(path, write_all, NULL, &error)) fail_msg("%s", error.text);
    bench_h5_open(h5, path);
}

/* What only claims of a machine, and those by construction, have. */
static void kinds_are_stored(BenchH5 *h5)
{
    double ratio[3], unset;
    const BenchField fields[] = {BENCH_VARIABLE("ratio", BENCH_DOUBLE, ratio),
                                 BENCH_VARIABLE("unset", BENCH_DOUBLE, unset)};
    hid_t claim = bench_h5_find_group(h5, h5->file, "claims/002");
    has_text(h5, claim, "kind", "machine");
    has_text(h5, claim, "verdict", "measured");
    bench_h5_read_fields(h5, claim, &fields[0], 1, ratio);
    bench_h5_read_fields(h5, claim, &fields[1], 1, &unset);
    assert_true(ratio[0] == 15 && ratio[1] == 12 && ratio[2] == 20 && isnan(unset));
    claim = bench_h5_find_group(h5, h5->file, "claims/003");
    has_text(h5, claim, "kind", "by construction");
    has_text(h5, claim, "verdict", "as set");
    has_text(h5, claim, "unset_evidence", "/rows/007");
    bench_h5_read_fields(h5, claim, &fields[0], 1, ratio);
    bench_h5_read_fields(h5, claim, &fields[1], 1, &unset);
    assert_true(unset == 593 && isnan(ratio[0]));
}

TEST(findings_are_stored)
{
    BenchH5 h5;
    open_stored(&h5);
    has_number(&h5, h5.file, "claims", FINDINGS);
    hid_t claim = bench_h5_find_group(&h5, h5.file, "claims/000");
    has_text(&h5, claim, "statement", findings[0].claim.statement);
    has_text(&h5, claim, "evidence", "/curves/sag.beam.w1-3.3");
    has_text(&h5, claim, "verdict", "reproduced");
    has_text(&h5, claim, "because", "of the weather");
    has_number(&h5, claim, "trend", -1);
    claim = bench_h5_find_group(&h5, h5.file, "claims/001");
    has_text(&h5, claim, "verdict", "differs");
    has_text(&h5, claim, "status", "quoted");
    has_text(&h5, claim, "words", findings[1].words);
    has_number(&h5, claim, "count", 3);
    assert_true(number_of(&h5, claim, "measured", 2) == 1.25);
    assert_true(number_of(&h5, claim, "high", 2) == 1.5);
    assert_true(number_of(&h5, claim, "paper_value", 1) == 1);
    assert_true(isnan(number_of(&h5, claim, "paper_value", 3)));
    has_text(&h5, claim, "kind", "method");
    kinds_are_stored(&h5);
    assert_true(bench_h5_close(&h5));
}

TEST(curves_are_stored)
{
    BenchH5 h5;
    open_stored(&h5);
    hid_t curve = bench_h5_find_group(&h5, h5.file, "curves/sag.beam.w1-3.3");
    const char *const names[] = {"x", "y", "low", "high"};
    const double wanted[] = {2, 2.25, 2, 2.5};
    has_number(&h5, curve, "points", 3);
    has_text(&h5, curve, "y_name", "sag");
    for (int s = 0; s < 4; s++) {
        double values[3];
        const hsize_t size[] = {3};
        bench_h5_read(&h5, bench_h5_find_dataset(&h5, curve, names[s], 1, size), H5T_NATIVE_DOUBLE,
                      values);
        if (h5.failed) fail_msg("%s", h5.message);
        assert_true(values[1] == wanted[s]);
    }
    assert_true(bench_h5_close(&h5));
}

/* ---- tables */

static char *written(BenchFormat format)
{
    char *text;
    size_t size;
    fill();
    FILE *file = open_memstream(&text, &size);
    bench_claim_table_write(file, format, findings, FINDINGS, &machine);
    fclose(file);
    return text;
}

TEST(tables_say_all)
{
    static const struct {
        BenchFormat format;
        const char *has[3];
    } cases[] = {
        {BENCH_AS_TEXT,
         {"Of 4, 2 method: 1 reproduced, 1 differs; 1 machine: 1 measured; 1 by construction: 1 as "
          "set.",
          "15 (12 to 20)  measured", "Differs because of the weather"}},
        {BENCH_AS_TEXT, {"3.25 to 1.25", "593  within 2% of 661  as set", "not set /rows/007"}},
        {BENCH_AS_MARKDOWN, {"| p | n |", "`/curves/sag.beam.w1-3.3`", "| falls |"}},
        {BENCH_AS_LATEX, {"\\begin{tabular}", "3.25 to 1.25", "\\end{tabular}"}},
        {BENCH_AS_CSV,
         {"paper,name,place,", "\"It is, \"\"so\"\" it is said.\"", "3.25/2.25/1.25"}},
        {BENCH_AS_CSV,
         {",kind,ratio,unset,unset_evidence\n", ",machine,15/12/20,,\n",
          ",by construction,,593,/rows/007\n"}},
        {BENCH_AS_JSON, {"\"verdict\": \"differs\"", "\"environment\"", "\"cpu\""}},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        char *text = written(cases[c].format);
        for (int h = 0; h < 3; h++)
            if (!strstr(text, cases[c].has[h])) fail_msg("%s in:\n%s", cases[c].has[h], text);
        free(text);
    }
}
