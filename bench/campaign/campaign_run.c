#include "campaign_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/system/clock.h"
#include "../store/draft.h"
#include "../system/interrupt.h"

/* What rank 0 tells the others at the start; the plan stands behind it. */
typedef struct {
    SmCode code; /* not SM_OK: there is nothing to do */
    bool done[BENCH_CAMPAIGN_POINTS];
} Start;

typedef struct {
    const BenchCampaignRun *run;
    BenchCampaign *campaign;
    void *work;
    BenchProgress progress;
    int left;       /* ranks that have not ended */
    SmError failed; /* of another rank; code SM_OK: none */
} Job;

/* ---- the file */

static bool goes_on(const BenchCampaignRun *run, const BenchCampaignType *type)
{
    return run->resume || !type->asks;
}

/* Takes over what the file holds. */
static SmCode resume(const BenchCampaignRun *run, BenchCampaign *campaign, SmError *error)
{
    const BenchCampaignType *type = campaign->type;
    if (!run->output || !goes_on(run, type) || access(run->output, F_OK) != 0) return SM_OK;
    BenchCampaign stored;
    SmCode code = bench_campaign_load(run->output, type, &stored, error);
    if (code) return code;
    char what[BENCH_CAMPAIGN_TEXT];
    if (!bench_campaign_same(campaign, &stored, sizeof what, what)) {
        code = sm_fail(error, SM_INPUT,
                       "%.200s holds %s: %s; give the same options to go on with it, or another "
                       "name with -o",
                       run->output, type->another, what);
    } else {
        campaign->machine = stored.machine;
        campaign->count = stored.count;
        campaign->point = stored.point;
        stored.point = NULL;
        stored.count = 0;
    }
    bench_campaign_free(&stored);
    return code;
}

/* The same at every moment: a signal may come between a file's renaming and what follows it. */
static void say_interrupt(const BenchCampaignRun *run, const BenchCampaignType *type)
{
    char line[BENCH_CAMPAIGN_TEXT];
    if (!run->output) return;
    snprintf(line, sizeof line,
             "%.100s keeps the %ss that are finished, if any; the same command%s goes on with the "
             "rest",
             run->output, type->point, type->asks && !run->resume ? " with --resume" : "");
    bench_interrupt_say(line);
}

static SmCode take(Job *job, const void *point, SmError *error)
{
    bench_campaign_add(job->campaign, point);
    return job->run->output ? bench_campaign_store(job->run->output, job->campaign, error) : SM_OK;
}

/* ---- ranks */

static SmCode measure(Job *job, int index, void *point, SmError *error)
{
    const BenchCampaign *campaign = job->campaign;
    char what[BENCH_CAMPAIGN_TEXT];
    bench_campaign_point(campaign, index, point);
    campaign->type->say(point, sizeof what, what);
    bench_progress_show(&job->progress, what, (double)index / bench_campaign_planned(campaign));
    double start = sm_now();
    SmCode code = campaign->type->measure(job->work, campaign, point, error);
    BenchStamp *stamp = (void *)((char *)point + campaign->type->stamp);
    bench_machine_stamp(stamp->host, stamp->utc);
    stamp->rank = job->run->ranks->rank;
    stamp->wall = sm_now() - start;
    return code;
}

static SmCode take_note(Job *job, const BenchNote *note, SmError *error)
{
    const BenchCampaignType *type = job->campaign->type;
    void *point = sm_alloc(1, type->point_size);
    memcpy(point, note->bytes, type->point_size);
    if (type->unpack)
        type->unpack(note->bytes + type->point_size, note->size - type->point_size, point);
    SmCode code = take(job, point, error);
    free(point);
    return code;
}

/* Notes of other ranks: those that are there, or with `wait` until all have ended. */
static SmCode listen(Job *job, bool wait, SmError *error)
{
    BenchNote note;
    SmCode code = SM_OK;
    while (!code && job->left && bench_ranks_receive(job->run->ranks, wait, &note)) {
        if (note.kind == BENCH_NOTE_POINT) {
            code = take_note(job, &note, error);
            bench_progress_show(&job->progress, "points from other ranks",
                                (double)job->campaign->count /
                                    bench_campaign_planned(job->campaign));
        } else {
            job->left--;
        }
        if (note.kind == BENCH_NOTE_FAILED)
            sm_fail(&job->failed, SM_INPUT, "rank %d: %.400s", note.rank, note.bytes);
        free(note.bytes);
    }
    return code;
}

/* Rank 0: measures its points, and takes those of the others. One that cannot stops no other. */
static SmCode lead(Job *job, const int *pending, int count, SmError *error)
{
    const BenchCampaignRun *run = job->run;
    void *point = sm_alloc(1, job->campaign->type->point_size);
    SmError own = {.code = SM_OK};
    SmCode code = SM_OK;
    bench_progress_start(&job->progress, run->quiet);
    for (int i = 0; i < count && !code && !own.code; i += run->ranks->count) {
        if (!measure(job, pending[i], point, &own)) code = take(job, point, error);
        if (!code) code = listen(job, false, error);
    }
    if (!code) code = listen(job, true, error);
    bench_progress_stop(&job->progress);
    free(point);
    if (code || (!own.code && !job->failed.code)) return code;
    *error = own.code ? own : job->failed;
    return error->code;
}

static void send_point(const Job *job, const void *point)
{
    const BenchCampaignType *type = job->campaign->type;
    size_t more = 0;
    char *packed = type->pack ? type->pack(point, &more) : NULL;
    char *bytes = sm_alloc(type->point_size + more, 1);
    memcpy(bytes, point, type->point_size);
    if (more) memcpy(bytes + type->point_size, packed, more);
    bench_ranks_send(job->run->ranks, BENCH_NOTE_POINT, bytes, type->point_size + more);
    free(packed);
    free(bytes);
}

/* Another rank: `failed` is why it cannot, or its code is SM_OK. */
static void serve(Job *job, const int *pending, int count, SmError *failed)
{
    const BenchRanks *ranks = job->run->ranks;
    const BenchCampaignType *type = job->campaign->type;
    void *point = sm_alloc(1, type->point_size);
    bench_progress_start(&job->progress, true);
    for (int i = ranks->rank; i < count && !failed->code; i += ranks->count) {
        if (measure(job, pending[i], point, failed)) break;
        send_point(job, point);
        if (type->free_point) type->free_point(point);
    }
    free(point);
    if (failed->code)
        bench_ranks_send(ranks, BENCH_NOTE_FAILED, failed->text, strlen(failed->text) + 1);
    else
        bench_ranks_send(ranks, BENCH_NOTE_END, NULL, 0);
}

/* A rank of another program or other options would measure other points. */
static SmCode check_rank(const BenchCampaign *mine, void *plan, SmError *error)
{
    BenchCampaign first = *mine;
    char what[BENCH_CAMPAIGN_TEXT];
    first.plan = plan;
    if (bench_campaign_same(&first, mine, sizeof what, what)) return SM_OK;
    return sm_fail(error, SM_INPUT, "it has another %s than the first rank: %s", mine->type->name,
                   what);
}

/* ---- all of it */

static int find_pending(const BenchCampaign *campaign, const bool *done, int *pending)
{
    int count = 0, planned = bench_campaign_planned(campaign);
    for (int i = 0; i < planned; i++)
        if (!done[i]) pending[count++] = i;
    return count;
}

static SmCode prepare(Job *job, Start *start, SmError *error)
{
    const BenchCampaignRun *run = job->run;
    BenchCampaign *campaign = job->campaign;
    const BenchCampaignType *type = campaign->type;
    bool first = run->ranks->rank == 0, replace = run->overwrite;
    if (goes_on(run, type)) replace = run->output != NULL;
    SmCode code = first ? bench_draft_reserve(run->output, replace, error) : SM_OK;
    if (!code && type->begin) code = type->begin(campaign, run, &job->work, error);
    if (!first) return code;
    if (!code) code = resume(run, campaign, error);
    start->code = code;
    memcpy(start + 1, campaign->plan, type->plan_size);
    for (long i = 0; i < campaign->count && !code; i++)
        start->done[*(int *)bench_campaign_at(campaign, i)] = true;
    return code;
}

static SmCode share_out(Job *job, SmError *error)
{
    const BenchCampaignRun *run = job->run;
    BenchCampaign *campaign = job->campaign;
    const BenchCampaignType *type = campaign->type;
    size_t size = sizeof(Start) + type->plan_size;
    Start *start = sm_alloc(1, size);
    int *pending = sm_alloc(BENCH_CAMPAIGN_POINTS, sizeof *pending);
    SmError mine = {.code = SM_OK};
    SmCode code = mine.code = prepare(job, start, &mine);
    bench_ranks_share(run->ranks, start, (int)size);
    if (!code && run->ranks->rank > 0) code = mine.code = check_rank(campaign, start + 1, &mine);
    if (!start->code) {
        int count = find_pending(campaign, start->done, pending);
        if (run->ranks->rank > 0) {
            serve(job, pending, count, &mine);
        } else {
            if (campaign->count && !run->quiet)
                fprintf(stderr, "shapebench %s: %s has %ld %ss; %d are to be measured\n",
                        type->command, run->output, campaign->count, type->point, count);
            say_interrupt(run, type);
            code = lead(job, pending, count, &mine);
        }
    }
    free(start);
    free(pending);
    if (code) *error = mine;
    return code;
}

SmCode bench_campaign_run(const BenchCampaignRun *run, BenchCampaign *campaign, SmError *error)
{
    Job job = {.run = run, .campaign = campaign, .left = run->ranks->count - 1};
    SmCode code = share_out(&job, error);
    bench_interrupt_say(NULL);
    if (job.work) campaign->type->end(job.work);
    return code;
}
