#include "claim.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../settings/config_file.h"
#include "experiments.h"

enum { CLAIMS_MOST = 500 };

/* A claim as it stands in a file: where the paper's value comes from is resolved after it. */
typedef struct {
    BenchClaim claim;
    char number[40], row[64], column[24]; /* names in papers.cfg */
    double value;                         /* or given here */
} Entry;

const char *const bench_claim_kinds[] = {"method", "machine", "by construction", NULL};
const char *const bench_reductions[] = {"values", "exponent", "largest", "gain", NULL};
const char *const bench_expectations[] = {"reproduced", "different", "not comparable", NULL};

static const BenchSetting claim_table[] = {
    {"kind", BENCH_IN(Entry, claim.kind), BENCH_CHOICES(bench_claim_kinds), .needed = true},
    {"paper", BENCH_IN(Entry, claim.paper)},
    {"name", BENCH_IN(Entry, claim.name)},
    {"statement", BENCH_IN(Entry, claim.statement)},
    {"place", BENCH_IN(Entry, claim.place)},
    {"unit", BENCH_IN(Entry, claim.unit)},
    {"number", BENCH_IN(Entry, number)},
    {"row", BENCH_IN(Entry, row)},
    {"column", BENCH_IN(Entry, column)},
    {"value", BENCH_IN(Entry, value), -1e15, 1e15},
    {"measure", BENCH_IN(Entry, claim.measure), .table = bench_measure_settings},
    {"over", BENCH_IN(Entry, claim.over), .table = bench_measure_settings},
    {"unset", BENCH_IN(Entry, claim.unset), .table = bench_measure_settings},
    {"take", BENCH_IN(Entry, claim.reduction), BENCH_CHOICES(bench_reductions)},
    {"test", BENCH_IN(Entry, claim.test),
     BENCH_ONE_OF("near", "within", "factor", "at_least", "at_most", "inside", "rises", "falls"),
     .needed = true},
    {"tolerance", BENCH_IN(Entry, claim.tolerance), 0, 1e6},
    {"expect", BENCH_IN(Entry, claim.expect), BENCH_CHOICES(bench_expectations)},
    {"because", BENCH_IN(Entry, claim.because)},
    {0},
};

/* Where in a file a claim stands, for messages; and its name. */
typedef struct {
    const char *file;
    unsigned line;
    const char *name; /* "" before it is known */
    SmError *error;
} Place;

static __attribute__((format(printf, 2, 3))) SmCode fail_at(const Place *place, const char *format,
                                                            ...)
{
    char text[440];
    va_list values;
    va_start(values, format);
    int used = place->name[0] ? snprintf(text, sizeof text, "'%s': ", place->name) : 0;
    vsnprintf(text + used, sizeof text - (size_t)used, format, values);
    va_end(values);
    for (char *c = text; *c; c++)
        if (*c == '\n' || *c == '\r') *c = ' '; /* of a name in the file */
    return sm_fail(place->error, SM_INPUT, "%s:%u: %s", place->file, place->line, text);
}

/* A number that papers.cfg has outside its rows, with where and in what unit. */
static SmCode take_number(const Entry *entry, BenchClaim *claim, const Place *place)
{
    const RefPaperClaim *said = ref_paper_claim(claim->paper, entry->number);
    if (!said)
        return fail_at(place, "the paper '%s' has no number '%s' in reference/papers.cfg",
                       claim->paper, entry->number);
    if (!isfinite(said->value.value))
        return fail_at(place, "the paper's '%s' cannot be read", entry->number);
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
        return fail_at(place, "the paper '%s' has no row '%s' in reference/papers.cfg",
                       claim->paper, entry->row);
    RefValue value[SM_STAGES];
    claim->values = ref_paper_column(row, entry->column, value);
    bool given = false;
    for (int v = 0; v < claim->values; v++) {
        claim->value[v] = value[v].value;
        if (value[v].status > claim->status) claim->status = value[v].status;
        given = given || isfinite(value[v].value);
    }
    if (!given)
        return fail_at(place, "row '%s' has nothing in a column '%s'", entry->row, entry->column);
    strcpy(claim->note, row->note);
    return SM_OK;
}

/* From one of the three places that it may have. */
static SmCode take_value(const Entry *entry, BenchClaim *claim, const Place *place)
{
    int given = (entry->number[0] != 0) + (entry->row[0] != 0) + isfinite(entry->value);
    bool trend = claim->test == BENCH_RISES || claim->test == BENCH_FALLS;
    if (given > 1)
        return fail_at(place, "the paper's value is 'number', 'row' and 'column', or 'value': "
                              "give one of them");
    if (given == 0 && !trend)
        return fail_at(place, "no value to test: give 'number', 'row' and 'column', or 'value'");
    if (entry->number[0]) return take_number(entry, claim, place);
    if (entry->row[0]) return take_column(entry, claim, place);
    claim->values = given;
    claim->value[0] = entry->value;
    return SM_OK;
}

static SmCode check_measure(const BenchClaim *claim, const BenchMeasure *measure,
                            const Place *place)
{
    bool curved = claim->reduction == BENCH_AS_EXPONENT || claim->reduction == BENCH_AS_GAIN ||
                  claim->test == BENCH_RISES || claim->test == BENCH_FALLS;
    const char *fault = bench_experiment_fault(measure);
    if (fault) return fail_at(place, "%s", fault);
    if (curved && bench_experiment_points(measure) < 3)
        return fail_at(place, "an exponent, a gain, or what rises or falls is of a curve of three "
                              "points or more: give the experiment a range of them");
    return SM_OK;
}

/* What each kind needs and cannot have. */
static SmCode check_kind(const BenchClaim *claim, const Place *place)
{
    bool speed = claim->test == BENCH_IS_AT_LEAST || claim->test == BENCH_IS_AT_MOST;
    bool built = claim->kind == BENCH_BY_CONSTRUCTION, timed = claim->kind == BENCH_OF_MACHINE;
    bool unset = claim->unset.experiment != BENCH_TRY_NOTHING;
    if (unset && !built)
        return fail_at(place, "'unset' is of a claim of the kind \"by construction\"");
    if (built && !unset && !claim->because[0])
        return fail_at(place, "measure what comes where the scene does not set it, 'unset', or say "
                              "'because' why there is no such thing");
    if (timed && (!speed || claim->values != 1 || claim->reduction != BENCH_AS_VALUES))
        return fail_at(place, "a claim of the kind \"machine\" is of one value: of a rate with the "
                              "test \"at_least\", of a time with \"at_most\"");
    if ((claim->expect == BENCH_DIFFERS && claim->kind != BENCH_OF_METHOD) ||
        (claim->expect != BENCH_REPRODUCES && built))
        return fail_at(place, "a claim of the kind \"%s\" is not expected to differ",
                       bench_claim_kinds[claim->kind]);
    return SM_OK;
}

static SmCode check_claim(const Entry *entry, BenchClaim *claim, Place *place)
{
    if (!claim->paper[0] || !claim->name[0] || !claim->statement[0])
        return fail_at(place, "a claim needs 'paper', 'name' and 'statement'");
    if (strpbrk(claim->name, "/ ") || strpbrk(claim->paper, "/ "))
        return fail_at(place, "'%s' of '%s': no blank and no '/' in a name", claim->name,
                       claim->paper);
    place->name = claim->name;
    if (claim->expect != BENCH_REPRODUCES && !claim->because[0])
        return fail_at(place, "say 'because' why it is not expected to reproduce");
    if (claim->test == BENCH_IS_FACTOR && claim->tolerance < 1)
        return fail_at(place, "a factor's 'tolerance' is 1 or more");
    const BenchMeasure *measures[] = {&claim->measure, &claim->over, &claim->unset};
    SmCode code = take_value(entry, claim, place);
    if (!code) code = check_kind(claim, place);
    for (int m = 0; m < 3 && !code; m++)
        if (m == 0 || measures[m]->experiment) code = check_measure(claim, measures[m], place);
    return code;
}

static SmCode add_claim(const config_setting_t *group, const char *file, BenchClaims *claims,
                        SmError *error)
{
    Place place = {file, config_setting_source_line(group), "", error};
    Entry entry = {.value = NAN};
    const BenchClaim *claim = &entry.claim;
    if (!config_setting_is_group(group))
        return fail_at(&place, "'claims' is a list of groups: ( { ... }, { ... } )");
    SmCode code = bench_settings_read(group, claim_table, &entry, file, error);
    if (!code) code = check_claim(&entry, &entry.claim, &place);
    if (code) return code;
    place.name = "";
    for (int c = 0; c < claims->count; c++)
        if (!strcmp(claims->claim[c].paper, claim->paper) &&
            !strcmp(claims->claim[c].name, claim->name))
            return fail_at(&place, "'%s' of '%s' is there already: take another name", claim->name,
                           claim->paper);
    claims->claim = sm_realloc(claims->claim, (size_t)claims->count + 1, sizeof *claims->claim);
    claims->claim[claims->count++] = *claim;
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

void bench_claims_free(BenchClaims *claims)
{
    free(claims->claim);
    *claims = (BenchClaims){0};
}
