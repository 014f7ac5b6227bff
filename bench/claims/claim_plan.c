#include "claim_plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/hash.h"
#include "../measure/measure.h"
#include "../table/row_store.h"
#include "claim_store.h"
#include "experiments.h"

#define PLAN(type, member)   BENCH_FIELD_AS(BenchClaimsPlan, BENCH_##type, member, #member)
#define POINT(type, member)  BENCH_FIELD_AS(BenchClaimPoint, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)

static const BenchField plan_fields[] = {
    {PLAN(TEXT, build), MEANS(NULL, "as of a sweep")},
    {PLAN(BOOL, quick), MEANS(NULL, "smaller bodies and fewer repeats")},
    {PLAN(INT, threads), MEANS(NULL, "of scenes")},
    {PLAN(LONG, seed), MEANS(NULL, "of what is drawn by chance")},
    {PLAN(HASH, claims_hash), MEANS(NULL, "FNV-1a of the datasets `names` and `files`")},
    {PLAN(INT, experiments), MEANS(NULL, "that the claims ask for, each once")},
    {PLAN(INT, names_size), MEANS("bytes", "of the dataset `names`")},
    {PLAN(INT, files_size), MEANS("bytes", "of the dataset `files`")},
};

static const int plan_field_count = sizeof plan_fields / sizeof plan_fields[0];

static const BenchField point_fields[] = {
    {POINT(INT, index), MEANS(NULL, "place in the plan")},
    {POINT(TEXT, name),
     MEANS(NULL, "of a curve, or a scene, its engine, and what it is without: then its row is "
                 "the next of `/rows`"),
     .given_by_plan = true},
    {POINT(TEXT, reason), MEANS(NULL, "why the scene could not be measured, and has no row")},
    {POINT(INT, steps_per_frame), MEANS(NULL, "of the scene; 0 of a curve")},
    BENCH_STAMP_FIELDS(BenchClaimPoint, "that it took"),
};

static const int point_field_count = sizeof point_fields / sizeof point_fields[0];

/* ---- the plan */

static void append(char **text, int *size, const void *bytes, size_t count)
{
    *text = sm_realloc(*text, (size_t)*size + count + 1, 1);
    memcpy(*text + *size, bytes, count);
    *size += (int)count;
    (*text)[*size] = '\0';
}

void bench_claims_plan_file(BenchClaimsPlan *plan, const char *text, size_t size)
{
    append(&plan->files, &plan->files_size, text, size);
    append(&plan->files, &plan->files_size, "", 1);
}

void bench_claims_plan_name(BenchClaimsPlan *plan, const BenchClaim *claim)
{
    char line[sizeof claim->paper + sizeof claim->name + 4];
    int size = snprintf(line, sizeof line, "%s %s\n", claim->paper, claim->name);
    append(&plan->names, &plan->names_size, line, (size_t)size);
}

static bool chosen(const BenchClaimsPlan *plan, const BenchClaim *claim)
{
    char line[sizeof claim->paper + sizeof claim->name + 4];
    snprintf(line, sizeof line, "%s %s\n", claim->paper, claim->name);
    for (const char *at = plan->names; at && (at = strstr(at, line)); at++)
        if (at == plan->names || at[-1] == '\n') return true;
    return false;
}

static SmCode read_claims(BenchClaimsPlan *plan, SmError *error)
{
    BenchClaims *claims = &plan->claims;
    int kept = 0, wanted = 0;
    SmCode code = bench_claims_builtin(claims, error);
    for (int at = 0; at < plan->files_size && !code;) {
        size_t size = strlen(plan->files + at);
        code = bench_claims_parse(plan->files + at, size, "its claims file", claims, error);
        at += (int)size + 1;
    }
    if (code) return code;
    for (int c = 0; c < claims->count; c++)
        if (chosen(plan, &claims->claim[c])) claims->claim[kept++] = claims->claim[c];
    claims->count = kept;
    for (int i = 0; i < plan->names_size; i++) wanted += plan->names[i] == '\n';
    if (kept && kept == wanted) return SM_OK;
    return sm_fail(error, SM_INPUT, "%d of its %d claims are not known to this program",
                   wanted - kept, wanted);
}

/* An experiment more, unless it is there. */
static void ask(BenchClaimsPlan *plan, const BenchMeasure *measure)
{
    char name[BENCH_CURVE_NAME], other[BENCH_CURVE_NAME];
    if (measure->experiment == BENCH_TRY_NOTHING) return;
    bench_experiment_name(measure, name);
    for (int e = 0; e < plan->experiments; e++) {
        bench_experiment_name(plan->measure[e], other);
        if (!strcmp(name, other)) return;
    }
    plan->measure[plan->experiments++] = measure;
}

static void free_plan(void *record)
{
    BenchClaimsPlan *plan = record;
    bench_claims_free(&plan->claims);
    free(plan->measure);
    free(plan->names);
    free(plan->files);
}

static SmCode count(void *record, SmError *error)
{
    BenchClaimsPlan *plan = record;
    bench_claims_free(&plan->claims);
    SmCode code = read_claims(plan, error);
    if (code) return code;
    plan->claims_hash = sm_hash_bytes(SM_HASH_START, plan->names, (size_t)plan->names_size);
    if (plan->files)
        plan->claims_hash = sm_hash_bytes(plan->claims_hash, plan->files, (size_t)plan->files_size);
    free(plan->measure);
    plan->measure = sm_alloc(3 * (size_t)plan->claims.count, sizeof(const BenchMeasure *));
    plan->experiments = 0;
    for (int c = 0; c < plan->claims.count; c++) {
        ask(plan, &plan->claims.claim[c].measure);
        ask(plan, &plan->claims.claim[c].over);
        ask(plan, &plan->claims.claim[c].unset);
    }
    if (plan->experiments <= BENCH_CAMPAIGN_POINTS) return SM_OK;
    return sm_fail(error, SM_USAGE, "the claims ask for %d experiments, at most %d can be",
                   plan->experiments, BENCH_CAMPAIGN_POINTS);
}

static void plan_point(const void *record, int index, void *point)
{
    const BenchClaimsPlan *plan = record;
    bench_experiment_name(plan->measure[index], ((BenchClaimPoint *)point)->name);
}

static void say(const void *point, size_t size, char *text)
{
    snprintf(text, size, "%s", ((const BenchClaimPoint *)point)->name);
}

static void write_text(BenchH5 *h5, hid_t group, const char *name, const char *text, int size)
{
    hsize_t bytes = (hsize_t)size;
    bench_h5_dataset(h5, group, name, H5T_STD_U8LE, 1, &bytes, text ? text : "");
}

static char *read_text(BenchH5 *h5, hid_t group, const char *name, int size)
{
    hsize_t bytes = size < 0 ? 0 : (hsize_t)size;
    hid_t dataset = bench_h5_find_dataset(h5, group, name, 1, &bytes);
    if (h5->failed) return NULL;
    char *text = sm_alloc((size_t)bytes + 1, 1);
    bench_h5_read(h5, dataset, H5T_NATIVE_UINT8, text);
    return text;
}

static void write_plan(BenchH5 *h5, hid_t group, const void *record)
{
    const BenchClaimsPlan *plan = record;
    write_text(h5, group, "names", plan->names, plan->names_size);
    write_text(h5, group, "files", plan->files, plan->files_size);
}

static void read_plan(BenchH5 *h5, hid_t group, void *record)
{
    BenchClaimsPlan *plan = record;
    plan->names = read_text(h5, group, "names", plan->names_size);
    plan->files = read_text(h5, group, "files", plan->files_size);
}

/* ---- what is measured */

static SmCode measure(void *work, const BenchCampaign *campaign, void *record, SmError *error)
{
    (void)work, (void)error;
    const BenchClaimsPlan *plan = campaign->plan;
    BenchClaimPoint *point = record;
    const BenchMeasure *of = plan->measure[point->index];
    BenchLab *lab = &point->lab;
    *lab = (BenchLab){
        .quick = plan->quick, .threads = plan->threads, .seed = (unsigned long)plan->seed};
    bench_experiment(lab, of);
    if (of->experiment == BENCH_TRY_SCENE) lab->curves = 0; /* fields are taken of its row */
    if (lab->rows) point->steps_per_frame = lab->origin[0].steps_per_frame;
    if (lab->failures) strcpy(point->reason, lab->failure[0].reason);
    for (int c = 0; c < lab->curves; c++) lab->curve[c].experiment = point->index;
    return SM_OK;
}

static void free_point(void *point)
{
    bench_lab_free(&((BenchClaimPoint *)point)->lab);
}

/* Into memory; aborts where there is none left. Of none `bytes` may be NULL. */
static void put(FILE *file, const void *bytes, size_t size, int count)
{
    if (count > 0 && fwrite(bytes, size, (size_t)count, file) < (size_t)count) abort();
}

/* Rows, their samples, and curves, one after another. */
static char *pack(const void *point, size_t *size)
{
    const BenchLab *lab = &((const BenchClaimPoint *)point)->lab;
    const int counts[] = {lab->rows, lab->curves};
    char *bytes;
    FILE *file = open_memstream(&bytes, size);
    if (!file) abort();
    put(file, counts, sizeof counts, 1);
    for (int r = 0; r < lab->rows; r++) {
        BenchRow row = lab->row[r];
        row.total = NULL, row.stage = NULL, row.counter = NULL, row.change.time = NULL;
        put(file, &row, sizeof row, 1);
        put(file, lab->row[r].total, sizeof *row.total, row.repeats);
        put(file, lab->row[r].stage, sizeof *row.stage, row.repeats);
        if (bench_row_counted(&row))
            put(file, lab->row[r].counter, sizeof *row.counter, row.repeats);
        put(file, lab->row[r].change.time, sizeof *row.change.time, row.change.frames);
    }
    put(file, lab->curve, sizeof *lab->curve, lab->curves);
    if (fclose(file)) abort();
    return bytes;
}

static void *take(const char **from, size_t size)
{
    void *bytes = sm_alloc(size ? size : 1, 1);
    memcpy(bytes, *from, size);
    *from += size;
    return bytes;
}

/* The failure that the point's reason is. */
static void restore_failure(BenchClaimPoint *point)
{
    if (point->reason[0]) bench_lab_fail(&point->lab, point->name, point->reason);
}

static void unpack(const char *bytes, size_t size, void *record)
{
    (void)size;
    BenchClaimPoint *point = record;
    int counts[2];
    memcpy(counts, bytes, sizeof counts);
    bytes += sizeof counts;
    point->lab = (BenchLab){.curves = counts[1]};
    for (int r = 0; r < counts[0]; r++) {
        BenchRow row;
        memcpy(&row, bytes, sizeof row);
        bytes += sizeof row;
        size_t repeats = (size_t)row.repeats;
        row.total = take(&bytes, repeats * sizeof *row.total);
        row.stage = take(&bytes, repeats * sizeof *row.stage);
        if (bench_row_counted(&row)) row.counter = take(&bytes, repeats * sizeof *row.counter);
        if (row.change.frames)
            row.change.time = take(&bytes, (size_t)row.change.frames * sizeof *row.change.time);
        bench_lab_row(&point->lab, &row, point->name, point->steps_per_frame);
    }
    point->lab.curve = take(&bytes, (size_t)counts[1] * sizeof *point->lab.curve);
    restore_failure(point);
}

/* ---- what follows from it */

/* All that was measured, in the plan's order. */
static BenchLab gather(const BenchCampaign *campaign)
{
    const BenchClaimsPlan *plan = campaign->plan;
    BenchLab lab = {.quick = plan->quick, .threads = plan->threads};
    for (long i = 0; i < campaign->count; i++) {
        const BenchClaimPoint *point = bench_campaign_at(campaign, i);
        const BenchLab *its = &point->lab;
        if (its->rows) bench_lab_row(&lab, &its->row[0], point->name, point->steps_per_frame);
        if (its->failures) bench_lab_fail(&lab, point->name, point->reason);
        for (int c = 0; c < its->curves; c++) bench_lab_keep(&lab, &its->curve[c]);
    }
    return lab;
}

static bool finished(const BenchCampaign *campaign, const BenchMeasure *wanted)
{
    char name[BENCH_CURVE_NAME];
    if (wanted->experiment == BENCH_TRY_NOTHING) return true;
    bench_experiment_name(wanted, name);
    for (long i = 0; i < campaign->count; i++)
        if (!strcmp(((const BenchClaimPoint *)bench_campaign_at(campaign, i))->name, name))
            return true;
    return false;
}

/* Place of a claim's curve in the lab; -1: it has none. */
static int evidence(BenchLab *lab, const BenchMeasure *wanted, char text[208])
{
    if (wanted->experiment == BENCH_TRY_NOTHING) return -1;
    int curve = bench_experiment(lab, wanted);
    bench_claim_place(lab, curve, 208, text);
    return curve;
}

static void find(BenchLab *lab, const BenchClaim *claim, BenchFinding *finding)
{
    char place[3][208] = {""};
    int curve = evidence(lab, &claim->measure, place[0]);
    int over = evidence(lab, &claim->over, place[1]);
    int unset = evidence(lab, &claim->unset, place[2]);
    bench_verdict_find(claim, &lab->curve[curve], over < 0 ? NULL : &lab->curve[over], finding);
    if (unset >= 0) bench_verdict_unset(&lab->curve[unset], finding);
    memcpy(finding->evidence, place, sizeof place);
}

int bench_claims_find(const BenchCampaign *campaign, BenchLab *lab, BenchFinding **findings)
{
    const BenchClaimsPlan *plan = campaign->plan;
    int found = 0;
    *lab = gather(campaign);
    *findings = sm_alloc((size_t)plan->claims.count, sizeof **findings);
    for (int c = 0; c < plan->claims.count; c++) {
        const BenchClaim *claim = &plan->claims.claim[c];
        if (finished(campaign, &claim->measure) && finished(campaign, &claim->over) &&
            finished(campaign, &claim->unset))
            find(lab, claim, &(*findings)[found++]);
    }
    return found;
}

void bench_claims_release(BenchLab *lab, BenchFinding *findings)
{
    lab->rows = 0; /* their samples are the campaign's */
    bench_lab_free(lab);
    free(findings);
}

/* ---- the file */

static void write_found(BenchH5 *h5, const BenchCampaign *campaign)
{
    BenchLab lab;
    BenchFinding *findings;
    int found = bench_claims_find(campaign, &lab, &findings);
    bench_claim_write(h5, findings, found, &lab);
    bench_claims_release(&lab, findings);
}

/* Every experiment has its row, its failure or its curve. */
static void read_found(BenchH5 *h5, BenchCampaign *campaign)
{
    const BenchClaimsPlan *plan = campaign->plan;
    hid_t rows = bench_h5_find_group(h5, h5->file, "rows");
    int row_count = 0;
    for (long i = 0; i < campaign->count && !h5->failed; i++) {
        BenchClaimPoint *point = bench_campaign_at(campaign, i);
        restore_failure(point);
        if (plan->measure[point->index]->experiment != BENCH_TRY_SCENE || point->reason[0])
            continue;
        BenchRow row = {0};
        bench_store_read_row(h5, rows, row_count++, &row);
        bench_lab_row(&point->lab, &row, point->name, point->steps_per_frame);
    }
    BenchLab curves = {0};
    bench_claim_read_curves(h5, &curves);
    for (int c = 0; c < curves.curves && !h5->failed; c++) {
        BenchClaimPoint *point = bench_campaign_find(campaign, curves.curve[c].experiment);
        if (point) bench_lab_keep(&point->lab, &curves.curve[c]);
    }
    bench_lab_free(&curves);
    for (long i = 0; i < campaign->count && !h5->failed; i++) {
        const BenchClaimPoint *point = bench_campaign_at(campaign, i);
        bool there = point->lab.rows || point->lab.failures;
        for (int c = 0; c < point->lab.curves; c++)
            there = there || !strcmp(point->lab.curve[c].name, point->name);
        if (!there) bench_h5_fail(h5, "experiment %ld (%s) has no curve", i, point->name);
    }
}

const BenchCampaignType bench_claims_type = {
    .command = "claims",
    .name = "claims",
    .point = "experiment",
    .another = "other claims",
    .schema = BENCH_CLAIM_SCHEMA,
    .asks = true,
    .plan_size = sizeof(BenchClaimsPlan),
    .point_size = sizeof(BenchClaimPoint),
    .plan = plan_fields,
    .points = point_fields,
    .plan_fields = &plan_field_count,
    .point_fields = &point_field_count,
    .more = bench_claim_fields,
    .more_fields = &bench_claim_field_count,
    .more_name = "claims/NNN",
    .planned = offsetof(BenchClaimsPlan, experiments),
    .build = offsetof(BenchClaimsPlan, build),
    .stamp = offsetof(BenchClaimPoint, stamp),
    .count = count,
    .plan_point = plan_point,
    .say = say,
    .measure = measure,
    .write_plan = write_plan,
    .read_plan = read_plan,
    .write = write_found,
    .read = read_found,
    .pack = pack,
    .unpack = unpack,
    .free_point = free_point,
    .free_plan = free_plan,
};
