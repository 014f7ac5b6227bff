#include "claim.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../scene/config_file.h"
#include "../scene/setting.h"
#include "experiment.h"

enum { CLAIMS_MOST = 500 };

/* A claim as it stands in a file: where the paper's value comes from is resolved after it. */
typedef struct {
    BenchClaim claim;
    char number[40], row[64], column[24]; /* names in papers.cfg */
    double value;                         /* or given here */
} Entry;

#define MEMBER(type, name, kind, member, low, high, words, table)                                  \
    {                                                                                              \
        name, kind, offsetof(type, member), low, high, words, table, 0, 0                          \
    }
#define TEXT(type, name, member)                                                                   \
    MEMBER(type, name, BENCH_TEXT, member, 0, sizeof((type *)0)->member, NULL, NULL)
#define WHOLE(type, name, member, low, high)                                                       \
    MEMBER(type, name, BENCH_INT, member, low, high, NULL, NULL)
#define REAL(type, name, member, low, high)                                                        \
    MEMBER(type, name, BENCH_REAL, member, low, high, NULL, NULL)
#define WORDS(type, name, member, given, words)                                                    \
    MEMBER(type, name, BENCH_CHOICE, member, given, 0, words, NULL)
#define GROUP(type, name, member, table) MEMBER(type, name, BENCH_GROUP, member, 0, 0, NULL, table)

static const BenchSetting range_table[] = {
    WHOLE(BenchRange, "from", from, 1, 1000),
    WHOLE(BenchRange, "to", to, 1, 1000),
    WHOLE(BenchRange, "points", points, 1, 24),
    {0},
};

static const BenchSetting measure_table[] = {
    WORDS(BenchMeasure, "experiment", experiment, 1,
          "none|scene|sums|size|polar|sweeps|smoothing|blending|sag|resampling|regions|growth|"
          "placement"),
    TEXT(BenchMeasure, "scene", scene),
    TEXT(BenchMeasure, "engine", engine),
    TEXT(BenchMeasure, "field", field),
    WORDS(BenchMeasure, "summation", summation, 0, "fast|bars|naive"),
    WORDS(BenchMeasure, "layout", layout, 0, "auto|lists|blocks"),
    WORDS(BenchMeasure, "matching", matching, 0, "lattice|rigid|linear|quadratic"),
    WORDS(BenchMeasure, "masses", masses, 0, BENCH_MASSES),
    WORDS(BenchMeasure, "symmetry", symmetry, 0, BENCH_SYMMETRIES),
    WORDS(BenchMeasure, "weighting", weighting, 0, BENCH_WEIGHTINGS),
    WORDS(BenchMeasure, "without", without, 0, "nothing|nodes|bases|summation_nodes|reach|collide"),
    GROUP(BenchMeasure, "w", w, range_table),
    GROUP(BenchMeasure, "n", n, range_table),
    {0},
};

static const char kind_words[] = "method|machine|by construction";
static const char test_words[] = "near|within|factor|at_least|at_most|inside|rises|falls";

static const BenchSetting claim_table[] = {
    WORDS(Entry, "kind", claim.kind, 1, kind_words),
    TEXT(Entry, "paper", claim.paper),
    TEXT(Entry, "name", claim.name),
    TEXT(Entry, "statement", claim.statement),
    TEXT(Entry, "place", claim.place),
    TEXT(Entry, "unit", claim.unit),
    TEXT(Entry, "number", number),
    TEXT(Entry, "row", row),
    TEXT(Entry, "column", column),
    REAL(Entry, "value", value, -1e15, 1e15),
    GROUP(Entry, "measure", claim.measure, measure_table),
    GROUP(Entry, "over", claim.over, measure_table),
    GROUP(Entry, "unset", claim.unset, measure_table),
    WORDS(Entry, "take", claim.reduction, 0, "values|exponent|largest|gain"),
    WORDS(Entry, "test", claim.test, 1, test_words),
    REAL(Entry, "tolerance", claim.tolerance, 0, 1e6),
    WORDS(Entry, "expect", claim.expect, 0, "reproduced|different|not comparable"),
    TEXT(Entry, "because", claim.because),
    {0},
};

/* Where in a file a claim stands, for messages. */
typedef struct {
    const char *file;
    unsigned line;
    SmError *error;
} Place;

static __attribute__((format(printf, 2, 3))) SmCode fail_at(const Place *place, const char *format,
                                                            ...)
{
    char text[440];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    for (char *c = text; *c; c++)
        if (*c == '\n' || *c == '\r') *c = ' '; /* of a name in the file */
    return sm_fail(place->error, SM_INPUT, "%s:%u: %s", place->file, place->line, text);
}

static bool curved(const BenchClaim *claim)
{
    return claim->reduction == BENCH_AS_EXPONENT || claim->reduction == BENCH_AS_GAIN ||
           claim->test == BENCH_RISES || claim->test == BENCH_FALLS;
}

static bool wordy(BenchTest test)
{
    return test == BENCH_RISES || test == BENCH_FALLS;
}

/* A number that papers.cfg has outside its rows, with where and in what unit. */
static SmCode take_number(const Entry *entry, BenchClaim *claim, const Place *place)
{
    const RefPaperClaim *said = ref_paper_claim(claim->paper, entry->number);
    if (!said)
        return fail_at(place, "'%s': the paper '%s' has no number '%s' in reference/papers.cfg",
                       claim->name, claim->paper, entry->number);
    if (!isfinite(said->value.value))
        return fail_at(place, "'%s': the paper's '%s' cannot be read", claim->name, entry->number);
    claim->values = 1;
    claim->value[0] = said->value.value;
    claim->status = said->value.status;
    if (!claim->place[0]) strcpy(claim->place, said->place);
    if (!claim->unit[0]) strcpy(claim->unit, said->unit);
    strcpy(claim->note, said->note);
    return SM_OK;
}

static SmCode take_column(const Entry *entry, BenchClaim *claim, const Place *place)
{
    const RefPaperRow *row = ref_paper_find(claim->paper, entry->row);
    if (!row)
        return fail_at(place, "'%s': the paper '%s' has no row '%s' in reference/papers.cfg",
                       claim->name, claim->paper, entry->row);
    RefValue value[SM_STAGES];
    claim->values = ref_paper_column(row, entry->column, value);
    bool given = false;
    for (int v = 0; v < claim->values; v++) {
        claim->value[v] = value[v].value;
        if (value[v].status > claim->status) claim->status = value[v].status;
        given = given || isfinite(value[v].value);
    }
    if (!given)
        return fail_at(place, "'%s': row '%s' has nothing in a column '%s'", claim->name,
                       entry->row, entry->column);
    strcpy(claim->note, row->note);
    return SM_OK;
}

/* From one of the three places that it may have. */
static SmCode take_value(const Entry *entry, BenchClaim *claim, const Place *place)
{
    int given = (entry->number[0] != 0) + (entry->row[0] != 0) + isfinite(entry->value);
    if (given > 1)
        return fail_at(place,
                       "'%s': the paper's value is 'number', 'row' and 'column', or 'value': "
                       "give one of them",
                       claim->name);
    if (given == 0 && !wordy(claim->test))
        return fail_at(place,
                       "'%s': no value to test: give 'number', 'row' and 'column', or "
                       "'value'",
                       claim->name);
    if (entry->number[0]) return take_number(entry, claim, place);
    if (entry->row[0]) return take_column(entry, claim, place);
    claim->values = given;
    claim->value[0] = entry->value;
    return SM_OK;
}

static SmCode check_measure(const BenchClaim *claim, const BenchMeasure *measure,
                            const Place *place)
{
    const char *fault = bench_experiment_fault(measure);
    if (fault) return fail_at(place, "'%s': %s", claim->name, fault);
    if (curved(claim) && bench_experiment_points(measure) < 3)
        return fail_at(place,
                       "'%s': an exponent, a gain, or what rises or falls is of a curve of "
                       "three points or more: give the experiment a range of them",
                       claim->name);
    return SM_OK;
}

/* What each kind needs and cannot have. */
static SmCode check_kind(const BenchClaim *claim, const Place *place)
{
    bool speed = claim->test == BENCH_IS_AT_LEAST || claim->test == BENCH_IS_AT_MOST;
    bool built = claim->kind == BENCH_BY_CONSTRUCTION, timed = claim->kind == BENCH_OF_MACHINE;
    if (claim->unset.experiment && !built)
        return fail_at(place, "'%s': 'unset' is of a claim of the kind \"by construction\"",
                       claim->name);
    if (built && !claim->unset.experiment && !claim->because[0])
        return fail_at(place,
                       "'%s': measure what comes where the scene does not set it, 'unset', or say "
                       "'because' why there is no such thing",
                       claim->name);
    if (timed && (!speed || claim->values != 1 || claim->reduction != BENCH_AS_VALUES))
        return fail_at(place,
                       "'%s': a claim of the kind \"machine\" is of one value: of a rate with the "
                       "test \"at_least\", of a time with \"at_most\"",
                       claim->name);
    if ((claim->expect == BENCH_DIFFERS && claim->kind != BENCH_OF_METHOD) ||
        (claim->expect != BENCH_REPRODUCES && built))
        return fail_at(place, "'%s': a claim of the kind \"%s\" is not expected to differ",
                       claim->name, bench_claim_kind_name(claim->kind));
    return SM_OK;
}

static SmCode check_claim(const Entry *entry, BenchClaim *claim, const Place *place)
{
    if (!claim->paper[0] || !claim->name[0] || !claim->statement[0])
        return fail_at(place, "a claim needs 'paper', 'name' and 'statement'");
    if (strpbrk(claim->name, "/ ") || strpbrk(claim->paper, "/ "))
        return fail_at(place, "'%s' of '%s': no blank and no '/' in a name", claim->name,
                       claim->paper);
    if (claim->expect != BENCH_REPRODUCES && !claim->because[0])
        return fail_at(place, "'%s': say 'because' why it is not expected to reproduce",
                       claim->name);
    if (claim->test == BENCH_IS_FACTOR && claim->tolerance < 1)
        return fail_at(place, "'%s': a factor's 'tolerance' is 1 or more", claim->name);
    SmCode code = take_value(entry, claim, place);
    if (!code) code = check_kind(claim, place);
    if (!code) code = check_measure(claim, &claim->measure, place);
    if (!code && claim->over.experiment) code = check_measure(claim, &claim->over, place);
    if (!code && claim->unset.experiment) code = check_measure(claim, &claim->unset, place);
    return code;
}

static SmCode add_claim(const config_setting_t *group, const char *file, BenchClaims *claims,
                        SmError *error)
{
    const Place place = {file, config_setting_source_line(group), error};
    Entry entry = {.value = NAN};
    if (!config_setting_is_group(group))
        return fail_at(&place, "'claims' is a list of groups: ( { ... }, { ... } )");
    SmCode code = bench_settings_read(group, claim_table, &entry, file, error);
    if (!code) code = check_claim(&entry, &entry.claim, &place);
    if (code) return code;
    for (int c = 0; c < claims->count; c++)
        if (!strcmp(claims->claim[c].paper, entry.claim.paper) &&
            !strcmp(claims->claim[c].name, entry.claim.name))
            return fail_at(&place, "'%s' of '%s' is there already: take another name",
                           entry.claim.name, entry.claim.paper);
    claims->claim = sm_realloc(claims->claim, (size_t)claims->count + 1, sizeof *claims->claim);
    claims->claim[claims->count++] = entry.claim;
    return SM_OK;
}

static SmCode add_claims(const config_t *config, const char *file, BenchClaims *claims,
                         SmError *error)
{
    const config_setting_t *root = config_root_setting(config), *list = NULL;
    int before = claims->count;
    if (config_setting_length(root) == 1) list = config_setting_get_member(root, "claims");
    if (!list || !config_setting_is_list(list) || config_setting_length(list) > CLAIMS_MOST)
        return sm_fail(
            error, SM_INPUT,
            "%s: a claims file has one setting, claims = ( { ... }, ... ), of at most %d "
            "groups",
            file, CLAIMS_MOST);
    SmCode code = SM_OK;
    for (int c = 0; c < config_setting_length(list) && !code; c++)
        code = add_claim(config_setting_get_elem(list, (unsigned)c), file, claims, error);
    if (code) claims->count = before;
    return code;
}

SmCode bench_claims_parse(const char *text, size_t size, const char *file, BenchClaims *claims,
                          SmError *error)
{
    config_t config;
    SmCode code = bench_config_parse(text, size, file, "claims", &config, error);
    if (code) return code;
    code = add_claims(&config, file, claims, error);
    config_destroy(&config);
    return code;
}

SmCode bench_claims_builtin(BenchClaims *claims, SmError *error)
{
    return bench_claims_parse(ref_claims_text, strlen(ref_claims_text), "reference/claims.cfg",
                              claims, error);
}

SmCode bench_claims_read(const char *path, BenchClaims *claims, SmError *error)
{
    size_t size = 0;
    char *text = bench_config_load(path, &size, error);
    if (!text) return SM_INPUT;
    SmCode code = bench_claims_parse(text, size, path, claims, error);
    free(text);
    return code;
}

const char *bench_claim_kind_name(BenchClaimKind kind)
{
    static const char *const names[] = {"method", "machine", "by construction"};
    return names[kind];
}

const char *bench_expectation_name(BenchExpectation expect)
{
    static const char *const names[] = {"reproduced", "different", "not comparable"};
    return names[expect];
}

void bench_claims_free(BenchClaims *claims)
{
    free(claims->claim);
    *claims = (BenchClaims){0};
}
