/* campaign.h - a plan of points, each of which is measured and checked, stored as it ends, and so
 * can be gone on with. A sweep (sweep.h), a calibration
 * (calibration.h) and the experiments of claims (experiments.h) are three; each describes itself
 * by a BenchCampaignType. campaign_run.h measures one. */
#ifndef BENCH_CAMPAIGN_H
#define BENCH_CAMPAIGN_H

#include <stdio.h>

#include "../store/h5.h"
#include "../system/machine.h"
#include "../table/row_table.h"

enum { BENCH_CAMPAIGN_POINTS = 10000, BENCH_CAMPAIGN_TEXT = 240, BENCH_CAMPAIGN_BUILD = 768 };

/* What may be done with it. */
typedef struct BenchCampaign BenchCampaign;
typedef struct BenchCampaignRun BenchCampaignRun; /* campaign_run.h */

/* Numbers that a plan is made of: an array of `most`, of which the first `count` are there. */
typedef struct {
    const char *name, *option; /* of the dataset; as it is given */
    size_t value, count;       /* where in the plan: double[most], int */
    int least, most;
    double low, high; /* of each */
} BenchCampaignList;

/* Who measured a point, when it ended (ISO 8601), and how long that took. */
typedef struct {
    double wall; /* s */
    int rank;    /* of an MPI launch; else 0 */
    char host[64], utc[32];
} BenchStamp;

/* Its members as fields of a point with a BenchStamp `stamp`. */
#define BENCH_STAMP_FIELDS(record, took)                                                           \
    {BENCH_FIELD_AS(record, BENCH_DOUBLE, stamp.wall, "wall"), BENCH_MEANS("s", took)},            \
        {BENCH_FIELD_AS(record, BENCH_INT, stamp.rank, "rank"),                                    \
         BENCH_MEANS(NULL, "of an MPI launch; else 0")},                                           \
        {BENCH_FIELD_AS(record, BENCH_TEXT, stamp.host, "host"),                                   \
         BENCH_MEANS(NULL, "where it was measured")},                                              \
    {                                                                                              \
        BENCH_FIELD_AS(record, BENCH_TEXT, stamp.utc, "utc"),                                      \
            BENCH_MEANS(NULL, "and when (ISO 8601)")                                               \
    }

typedef struct {
    const char *command, *name, *point; /* "calibrate", "calibration", "specimen" */
    const char *another;                /* "another calibration" */
    int schema;                         /* of its file */
    bool asks; /* goes on with a file that is there only where --resume says so */
    size_t plan_size, point_size;
    const BenchField *plan, *points; /* members of a plan, and of a point; its first is `index` */
    const int *plan_fields, *point_fields;
    const BenchField *more; /* of what follows from the points, in the file's group `more_name`; */
    const int *more_fields; /* NULL: none */
    const char *more_name;
    const BenchCampaignList *list;
    int lists;
    size_t planned;      /* where in a plan: int, how many points it has */
    size_t build, stamp; /* where in a plan: char[BENCH_CAMPAIGN_BUILD]; in a point: BenchStamp */
    size_t series, used; /* of points that have a series: its length, an int of the plan, and how
                          * many of it are there, an int of the point */

    /* Counts the plan's points. SM_USAGE: it can have none. */
    SmCode (*count)(void *plan, SmError *error);
    /* Settings of the point of this index, which is none yet (bench_record_none()). */
    void (*plan_point)(const void *plan, int index, void *point);
    /* "octree with w 1, epsilon 0". */
    void (*say)(const void *point, size_t size, char *text);
    /* Why it is not valid, or NULL. */
    const char *(*fault)(const void *point);

    /* What the points share (NULL: nothing): completes the plan. The caller frees `work` by `end`,
     * also where it failed. */
    SmCode (*begin)(BenchCampaign *campaign, const BenchCampaignRun *run, void **work,
                    SmError *error);
    /* Measures a point, in which its settings are. What cannot be had is said in it; an error ends
     * the campaign. */
    SmCode (*measure)(void *work, const BenchCampaign *campaign, void *point, SmError *error);
    void (*end)(void *work);

    /* What else the plan has is written, and read before its points are counted (NULL). */
    void (*write_plan)(BenchH5 *h5, hid_t group, const void *plan);
    void (*read_plan)(BenchH5 *h5, hid_t group, void *plan);

    /* What follows from all points is marked in them (NULL: nothing); what else the file holds is
     * written and, after the points, read (NULL). */
    void (*conclude)(BenchCampaign *campaign);
    void (*write)(BenchH5 *h5, const BenchCampaign *campaign);
    void (*read)(BenchH5 *h5, BenchCampaign *campaign);

    /* What stands before and behind the table of its points (NULL: nothing), where columns may also
     * get other headings; and what JSON has beside them, an object that the caller frees. */
    void (*head)(FILE *file, BenchFormat format, const BenchCampaign *campaign, BenchGrid *grid);
    void (*tail)(FILE *file, BenchFormat format, const BenchCampaign *campaign);
    json_t *(*more_json)(const BenchCampaign *campaign);

    /* Of points that hold more than their bytes (NULL: none do): what it is, as bytes that the
     * caller frees; the same put back; and freed. */
    char *(*pack)(const void *point, size_t *size);
    void (*unpack)(const char *bytes, size_t size, void *point);
    void (*free_point)(void *point);
    void (*free_plan)(void *plan);
} BenchCampaignType;

struct BenchCampaign {
    const BenchCampaignType *type;
    void *plan;           /* of type->plan_size */
    BenchMachine machine; /* where and how it was begun */
    long count;           /* of points that are finished, by rising index */
    void *point;          /* [count] of type->point_size */
};

/* An empty one, whose plan is zero. Free it. */
BenchCampaign bench_campaign_create(const BenchCampaignType *type);
void bench_campaign_free(BenchCampaign *campaign);

/* The attribute `sampled` of a plan whose points are of engines: the names of those that have an
 * epsilon, with spaces between. For `write_plan`. */
void bench_campaign_write_sampled(BenchH5 *h5, hid_t group, const void *plan);

/* Reads the lists of its plan from options' values, one for each of the type's ("none": it has no
 * number, where it may). SM_USAGE. */
SmCode bench_campaign_read_lists(const BenchCampaign *campaign, const char *const *text,
                                 SmError *error);

/* How many points are planned; the i-th finished one; the one of this index, or NULL. */
int bench_campaign_planned(const BenchCampaign *campaign);
void *bench_campaign_at(const BenchCampaign *campaign, long i);
void *bench_campaign_find(const BenchCampaign *campaign, int index);

/* The point of this index as it is planned, not measured yet. */
void bench_campaign_point(const BenchCampaign *campaign, int index, void *point);

/* Takes over a point of an index that is not there yet. */
void bench_campaign_add(BenchCampaign *campaign, const void *point);

/* Are the plans the same? If not, `what` says in what they differ first. */
bool bench_campaign_same(const BenchCampaign *mine, const BenchCampaign *theirs, size_t size,
                         char *what);

/* Concludes and writes all of it: the file appears whole or not at all (draft.h). */
SmCode bench_campaign_store(const char *path, BenchCampaign *campaign, SmError *error);

/* Reads a file of this kind; the caller frees the campaign.
 * SM_INPUT: no such file, not HDF5, cut off, of another kind or schema, something missing, of a
 * wrong size, or beside the plan. */
SmCode bench_campaign_load(const char *path, const BenchCampaignType *type, BenchCampaign *campaign,
                           SmError *error);

/* SM_INVALID, with how many and the first one, where points are not valid. */
SmCode bench_campaign_verdict(const BenchCampaign *campaign, SmError *error);

/* Writes down this program as the plan's build, by the campaign's machine. */
void bench_campaign_build(BenchCampaign *campaign);

/* Prints the table of its points: for people, with its head and tail; or for programs, as CSV, or
 * as JSON {"points": [...], "plan": {...}, "environment": {...}} and more. */
void bench_campaign_print(FILE *file, BenchFormat format, const BenchCampaign *campaign);

/* The lists of its plan's attributes, its points' datasets and what follows from them, as
 * results/README.md has them. */
void bench_campaign_document(FILE *file, const BenchCampaignType *type);

#endif
