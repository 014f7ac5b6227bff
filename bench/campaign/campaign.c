#include "campaign.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../lib/system/hash.h"
#include "../engines.h"
#include "../settings/setting.h"
#include "../table/row_store.h"

static int *plan_int(const BenchCampaign *campaign, size_t offset)
{
    return (int *)(void *)((char *)campaign->plan + offset);
}

static int index_of(const BenchCampaign *campaign, long i)
{
    return *(const int *)bench_campaign_at(campaign, i);
}

BenchCampaign bench_campaign_create(const BenchCampaignType *type)
{
    return (BenchCampaign){.type = type, .plan = sm_alloc(1, type->plan_size)};
}

static void free_points(BenchCampaign *campaign)
{
    for (long i = 0; i < campaign->count && campaign->type->free_point; i++)
        campaign->type->free_point(bench_campaign_at(campaign, i));
    free(campaign->point);
    campaign->point = NULL;
    campaign->count = 0;
}

void bench_campaign_free(BenchCampaign *campaign)
{
    if (!campaign->type) return;
    free_points(campaign);
    if (campaign->type->free_plan) campaign->type->free_plan(campaign->plan);
    free(campaign->plan);
    *campaign = (BenchCampaign){0};
}

int bench_campaign_planned(const BenchCampaign *campaign)
{
    return *plan_int(campaign, campaign->type->planned);
}

void *bench_campaign_at(const BenchCampaign *campaign, long i)
{
    return (char *)campaign->point + (size_t)i * campaign->type->point_size;
}

/* Where the point of this index is, or would be. */
static long place_of(const BenchCampaign *campaign, int index)
{
    long low = 0, high = campaign->count;
    while (low < high) {
        long middle = (low + high) / 2;
        if (index_of(campaign, middle) < index)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

void *bench_campaign_find(const BenchCampaign *campaign, int index)
{
    long place = place_of(campaign, index);
    bool there = place < campaign->count && index_of(campaign, place) == index;
    return there ? bench_campaign_at(campaign, place) : NULL;
}

void bench_campaign_point(const BenchCampaign *campaign, int index, void *point)
{
    const BenchCampaignType *type = campaign->type;
    bench_record_none(type->points, *type->point_fields, point, type->point_size);
    *(int *)point = index;
    type->plan_point(campaign->plan, index, point);
}

void bench_campaign_add(BenchCampaign *campaign, const void *point)
{
    size_t size = campaign->type->point_size;
    long place = place_of(campaign, *(const int *)point), after = campaign->count - place;
    campaign->point = sm_realloc(campaign->point, (size_t)++campaign->count, size);
    char *at = bench_campaign_at(campaign, place);
    memmove(at + size, at, (size_t)after * size);
    memcpy(at, point, size);
}

SmCode bench_campaign_read_lists(const BenchCampaign *campaign, const char *const *text,
                                 SmError *error)
{
    const BenchCampaignType *type = campaign->type;
    SmCode code = SM_OK;
    for (int l = 0; l < type->lists && !code; l++) {
        const BenchCampaignList *list = &type->list[l];
        if (list->least || strcmp(text[l], "none") != 0)
            code = bench_range_parse(list->option, text[l], list->low, list->high, list->most,
                                     (double *)(void *)plan_int(campaign, list->value),
                                     plan_int(campaign, list->count), error);
    }
    return code;
}

/* ---- two of the same */

static void say_list(const BenchCampaignList *list, const double *mine, int my_count,
                     const double *theirs, int their_count, size_t size, char *what)
{
    snprintf(what, size, "its %s is %d numbers from %g to %g, and here %d from %g to %g",
             list->name, their_count, their_count ? theirs[0] : NAN,
             their_count ? theirs[their_count - 1] : NAN, my_count, my_count ? mine[0] : NAN,
             my_count ? mine[my_count - 1] : NAN);
}

static void say_field(const BenchField *field, const void *mine, const void *theirs, size_t size,
                      char *what)
{
    const char *a = (const char *)mine + field->offset, *b = (const char *)theirs + field->offset;
    if (field->kind == BENCH_TEXT)
        snprintf(what, size, "its %s is '%.90s', and here '%.90s'", field->name, b, a);
    else if (field->kind == BENCH_DOUBLE)
        snprintf(what, size, "its %s is %g, and here %g", field->name,
                 *(const double *)(const void *)b, *(const double *)(const void *)a);
    else if (field->kind == BENCH_HASH)
        snprintf(what, size, "its %s differs: the %.*s has changed", field->name,
                 (int)strcspn(field->name, "_"), field->name);
    else if (field->kind == BENCH_LONG)
        snprintf(what, size, "its %s is %ld, and here %ld", field->name,
                 *(const long *)(const void *)b, *(const long *)(const void *)a);
    else if (field->kind == BENCH_BOOL)
        snprintf(what, size, "its %s is %d, and here %d", field->name, *b, *a);
    else
        snprintf(what, size, "its %s is %d, and here %d", field->name,
                 *(const int *)(const void *)b, *(const int *)(const void *)a);
}

bool bench_campaign_same(const BenchCampaign *mine, const BenchCampaign *theirs, size_t size,
                         char *what)
{
    const BenchCampaignType *type = mine->type;
    for (int l = 0; l < type->lists; l++) {
        const BenchCampaignList *list = &type->list[l];
        const double *a = (const double *)(const void *)plan_int(mine, list->value),
                     *b = (const double *)(const void *)plan_int(theirs, list->value);
        int count = *plan_int(mine, list->count), other = *plan_int(theirs, list->count);
        if (count == other && !memcmp(a, b, sizeof *a * (size_t)count)) continue;
        say_list(list, a, count, b, other, size, what);
        return false;
    }
    const BenchField *differs =
        bench_record_differs(type->plan, *type->plan_fields, mine->plan, theirs->plan, false);
    if (differs) say_field(differs, mine->plan, theirs->plan, size, what);
    return !differs;
}

SmCode bench_campaign_verdict(const BenchCampaign *campaign, SmError *error)
{
    const BenchCampaignType *type = campaign->type;
    long invalid = 0, first = 0;
    char what[BENCH_CAMPAIGN_TEXT];
    for (long i = campaign->count - 1; i >= 0; i--)
        if (type->fault(bench_campaign_at(campaign, i))) invalid++, first = i;
    if (!invalid) return SM_OK;
    const void *point = bench_campaign_at(campaign, first);
    type->say(point, sizeof what, what);
    return sm_fail(error, SM_INVALID, "%ld of %ld %ss are INVALID, the first %s: %s", invalid,
                   campaign->count, type->point, what, type->fault(point));
}

/* ---- the file */

/* Members of points, a series as long as the plan says; the caller frees them. */
static BenchField *point_fields(const BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    BenchField *fields = sm_alloc((size_t)*type->point_fields, sizeof *fields);
    memcpy(fields, type->points, (size_t)*type->point_fields * sizeof *fields);
    for (int f = 0; f < *type->point_fields; f++)
        if (fields[f].series)
            fields[f].size = (size_t)*plan_int(campaign, type->series) * sizeof(double);
    return fields;
}

void bench_campaign_write_sampled(BenchH5 *h5, hid_t group, const void *plan)
{
    char names[BENCH_ENGINES_TEXT] = "";
    (void)plan;
    for (const BenchEngine *const *engine = bench_engine_list; *engine; engine++)
        if ((*engine)->sampled)
            sm_append(names, sizeof names, "%s%s", *names ? " " : "", (*engine)->type[0]->name);
    bench_h5_text(h5, group, "sampled", names);
}

static void write_points(BenchH5 *h5, const BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    char name[32], stages[128];
    snprintf(name, sizeof name, "%ss", type->point);
    hid_t group = bench_h5_group(h5, h5->file, name);
    BenchField *fields = point_fields(campaign);
    for (int f = 0; f < *type->point_fields; f++) {
        if (!fields[f].stages) continue;
        bench_store_stages("", sizeof stages, stages); /* of shape matching */
        bench_h5_text(h5, group, "stages", stages);
    }
    bench_h5_columns(h5, group, fields, *type->point_fields, campaign->point, type->point_size,
                     campaign->count);
    free(fields);
}

static void write_file(BenchH5 *h5, void *record)
{
    const BenchCampaign *campaign = record;
    const BenchCampaignType *type = campaign->type;
    char kind[64];
    snprintf(kind, sizeof kind, "shapebench %s", type->name);
    bench_h5_text(h5, h5->file, "kind", kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &type->schema);
    bench_machine_store(h5, &campaign->machine);
    hid_t group = bench_h5_group(h5, h5->file, "plan");
    bench_h5_fields(h5, group, type->plan, *type->plan_fields, campaign->plan);
    for (int l = 0; l < type->lists; l++) {
        hsize_t size = (hsize_t)*plan_int(campaign, type->list[l].count);
        bench_h5_dataset(h5, group, type->list[l].name, H5T_IEEE_F64LE, 1, &size,
                         plan_int(campaign, type->list[l].value));
    }
    if (type->write_plan) type->write_plan(h5, group, campaign->plan);
    write_points(h5, campaign);
    if (type->write) type->write(h5, campaign);
}

SmCode bench_campaign_store(const char *path, BenchCampaign *campaign, SmError *error)
{
    if (campaign->type->conclude) campaign->type->conclude(campaign);
    return bench_h5_store(path, write_file, campaign, error);
}

static void read_list(BenchH5 *h5, hid_t group, const BenchCampaignList *list,
                      const BenchCampaign *campaign)
{
    int count = *plan_int(campaign, list->count);
    double *value = (double *)(void *)plan_int(campaign, list->value);
    if (!h5->failed && (count < list->least || count > list->most))
        bench_h5_fail(h5, "its plan has %d values of %s", count, list->name);
    hid_t dataset = bench_h5_find_dataset(h5, group, list->name, 1, &(hsize_t){(hsize_t)count});
    bench_h5_read(h5, dataset, H5T_NATIVE_DOUBLE, value);
    for (int i = 0; i < count && !h5->failed; i++)
        if (!(value[i] >= list->low && value[i] <= list->high))
            bench_h5_fail(h5, "its plan has %g as %s", value[i], list->name);
}

static void read_plan(BenchH5 *h5, BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    if (!h5->failed && H5Lexists(h5->file, "plan", H5P_DEFAULT) <= 0)
        bench_h5_fail(h5,
                      "group 'plan' is missing: 'shapebench report' alone shows files of %s "
                      "from before there was one",
                      type->name);
    hid_t group = bench_h5_find_group(h5, h5->file, "plan");
    bench_h5_read_fields(h5, group, type->plan, *type->plan_fields, campaign->plan);
    for (int l = 0; l < type->lists; l++) read_list(h5, group, &type->list[l], campaign);
    if (!h5->failed && type->read_plan) type->read_plan(h5, group, campaign->plan);
    if (h5->failed) return;
    int planned = bench_campaign_planned(campaign);
    SmError error;
    if (type->count(campaign->plan, &error))
        bench_h5_fail(h5, "its plan cannot be: %.200s", error.text);
    else if (bench_campaign_planned(campaign) != planned)
        bench_h5_fail(h5, "its plan does not make %d %ss", planned, type->point);
}

/* Every point must be one of the plan's, in order, with no longer a series than there is room for.
 */
static void check_points(BenchH5 *h5, const BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    void *planned = sm_alloc(1, type->point_size);
    for (long i = 0, before = -1; i < campaign->count && !h5->failed; i++) {
        const char *point = bench_campaign_at(campaign, i);
        int index = index_of(campaign, i);
        bool inside = index > before && index < bench_campaign_planned(campaign);
        if (inside) bench_campaign_point(campaign, index, planned);
        if (!inside ||
            bench_record_differs(type->points, *type->point_fields, planned, point, true))
            bench_h5_fail(h5, "%s %ld is not one of its plan's", type->point, i);
        int used = type->series ? *(const int *)(const void *)(point + type->used) : 0;
        if (type->series && (used < 0 || used > *plan_int(campaign, type->series)))
            bench_h5_fail(h5, "%s %ld has %d samples", type->point, i, used);
        before = index;
    }
    free(planned);
}

static void read_points(BenchH5 *h5, BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    char name[32];
    snprintf(name, sizeof name, "%ss", type->point);
    hid_t group = bench_h5_find_group(h5, h5->file, name);
    long count = bench_h5_records(h5, group, type->points, BENCH_CAMPAIGN_POINTS);
    if (h5->failed) return;
    campaign->count = count;
    campaign->point = sm_alloc((size_t)count, type->point_size);
    for (long i = 0; i < count; i++)
        bench_record_none(type->points, *type->point_fields, bench_campaign_at(campaign, i),
                          type->point_size);
    BenchField *fields = point_fields(campaign);
    bench_h5_read_columns(h5, group, fields, *type->point_fields, campaign->point, type->point_size,
                          count);
    free(fields);
    check_points(h5, campaign);
}

static void read_file(BenchH5 *h5, void *record)
{
    BenchCampaign *campaign = record;
    const BenchCampaignType *type = campaign->type;
    char kind[64];
    snprintf(kind, sizeof kind, "shapebench %s", type->name);
    bench_h5_check_kind(h5, kind, type->schema, type->schema);
    bench_machine_load(h5, &campaign->machine);
    read_plan(h5, campaign);
    if (!h5->failed) read_points(h5, campaign);
    if (!h5->failed && type->read) type->read(h5, campaign);
}

SmCode bench_campaign_load(const char *path, const BenchCampaignType *type, BenchCampaign *campaign,
                           SmError *error)
{
    *campaign = bench_campaign_create(type);
    SmCode code = bench_h5_load(path, read_file, campaign, error);
    if (code) bench_campaign_free(campaign);
    return code;
}

/* ---- provenance */

/* Of this program's file; 0 if it cannot be read. */
static unsigned long long hash_program(void)
{
    FILE *file = fopen("/proc/self/exe", "rbe");
    if (!file) return 0;
    unsigned long long hash = SM_HASH_START;
    char *bytes = sm_alloc(1 << 16, 1);
    for (size_t got; (got = fread(bytes, 1, 1 << 16, file)) > 0;)
        hash = sm_hash_bytes(hash, bytes, got);
    fclose(file);
    free(bytes);
    return hash;
}

void bench_campaign_build(BenchCampaign *campaign)
{
    const BenchMachine *machine = &campaign->machine;
    char *build = (char *)campaign->plan + campaign->type->build, changed[32] = "";
    if (machine->git_dirty) snprintf(changed, sizeof changed, " changed %016llx", hash_program());
    snprintf(build, BENCH_CAMPAIGN_BUILD, "%s %.16s%s, %s, %s %s", machine->version,
             machine->git_commit, changed, machine->isa, machine->compiler, machine->flags);
}
