#include "../table/records.h"
#include "campaign.h"

static void print_json(FILE *file, const BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    char name[32];
    json_t *root = json_object(), *more = type->more_json ? type->more_json(campaign) : NULL;
    snprintf(name, sizeof name, "%ss", type->point);
    json_object_set_new(root, name,
                        bench_json_records(type->points, *type->point_fields, campaign->point,
                                           type->point_size, campaign->count));
    json_object_update(root, more);
    json_decref(more);
    json_object_set_new(root, "plan",
                        bench_json_record(type->plan, *type->plan_fields, campaign->plan));
    json_object_set_new(root, "environment", bench_json_machine(&campaign->machine));
    bench_json_write(file, root);
}

static void print_grid(FILE *file, BenchFormat format, const BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    BenchGrid grid = bench_records_grid(type->points, *type->point_fields, campaign->point,
                                        type->point_size, campaign->count, 0);
    if (type->head) type->head(file, format, campaign, &grid);
    bench_grid_whole(file, &grid, bench_format_form(format));
    bench_grid_free(&grid);
    if (type->tail) type->tail(file, format, campaign);
}

void bench_campaign_print(FILE *file, BenchFormat format, const BenchCampaign *campaign)
{
    const BenchCampaignType *type = campaign->type;
    if (format == BENCH_AS_CSV)
        bench_csv_records(file, type->points, *type->point_fields, campaign->point,
                          type->point_size, campaign->count, NULL);
    else if (format == BENCH_AS_JSON)
        print_json(file, campaign);
    else
        print_grid(file, format, campaign);
}

void bench_campaign_document(FILE *file, const BenchCampaignType *type)
{
    char place[48];
    bench_records_document(file, "attribute of `/plan`", type->plan, *type->plan_fields);
    fputc('\n', file);
    snprintf(place, sizeof place, "dataset of `/%ss`", type->point);
    bench_records_document(file, place, type->points, *type->point_fields);
    if (!type->more) return;
    fputc('\n', file);
    snprintf(place, sizeof place, "in `/%s`", type->more_name);
    bench_records_document(file, place, type->more, *type->more_fields);
}
