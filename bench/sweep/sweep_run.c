#include "sweep_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../store/draft.h"
#include "../system/interrupt.h"
#include "sweeper.h"

/* What rank 0 tells the others at the start. */
typedef struct {
    SmCode code; /* not SM_OK: there is nothing to do */
    BenchPlan plan;
    bool done[BENCH_PLAN_POINTS];
} Start;

typedef struct {
    const BenchSweepRun *run;
    BenchSweep *sweep;
    BenchSweeper sweeper;
    BenchProgress progress;
    int left;       /* ranks that have not ended */
    SmError failed; /* of another rank; code SM_OK: none */
} Job;

/* Takes over what the file holds. */
static SmCode resume(const BenchSweepRun *run, BenchSweep *sweep, SmError *error)
{
    if (!run->output || access(run->output, F_OK) != 0) return SM_OK;
    BenchSweep stored;
    SmCode code = bench_sweep_load(run->output, &stored, error);
    if (code) return code;
    char what[240];
    if (!bench_plan_same(&sweep->plan, &stored.plan, sizeof what, what)) {
        bench_sweep_free(&stored);
        return sm_fail(error, SM_INPUT,
                       "%.200s holds another sweep: %s; give the same options to go on with it, or "
                       "another name with -o",
                       run->output, what);
    }
    sweep->machine = stored.machine;
    sweep->count = stored.count;
    sweep->point = stored.point;
    return SM_OK;
}

/* The same at every moment: a signal may come between a file's renaming and what follows it. */
static void say_interrupt(const BenchSweepRun *run)
{
    char line[240];
    if (!run->output) return;
    snprintf(line, sizeof line,
             "%.100s keeps the points that are finished, if any; the same command goes on with the "
             "rest",
             run->output);
    bench_interrupt_say(line);
}

static SmCode take(Job *job, const BenchPoint *point, SmError *error)
{
    bench_sweep_add(job->sweep, point);
    return job->run->output ? bench_sweep_store(job->run->output, job->sweep, error) : SM_OK;
}

/* Notes of other ranks: those that are there, or with `wait` until all have ended. */
static SmCode listen(Job *job, bool wait, SmError *error)
{
    BenchNote *note = sm_alloc(1, sizeof *note);
    SmCode code = SM_OK;
    while (!code && job->left && bench_ranks_receive(job->run->ranks, wait, note)) {
        if (note->kind == BENCH_NOTE_POINT) {
            code = take(job, &note->point, error);
            bench_progress_show(&job->progress, "points from other ranks",
                                (double)job->sweep->count / job->sweep->plan.points);
            continue;
        }
        job->left--;
        if (note->kind == BENCH_NOTE_FAILED)
            sm_fail(&job->failed, SM_INPUT, "rank %d: %.400s", note->rank, note->line);
    }
    free(note);
    return code;
}

/* Rank 0: measures its points, and takes those of the others. */
static SmCode lead(Job *job, const int *pending, int count, SmError *error)
{
    const BenchSweepRun *run = job->run;
    SmCode code = SM_OK;
    bench_progress_start(&job->progress, run->quiet);
    for (int i = 0; i < count && !code; i += run->ranks->count) {
        BenchPoint point;
        bench_sweeper_measure(&job->sweeper, &job->sweep->plan, pending[i], &job->progress, &point);
        code = take(job, &point, error);
        if (!code) code = listen(job, false, error);
    }
    if (!code) code = listen(job, true, error);
    bench_progress_stop(&job->progress);
    if (!code && job->failed.code) {
        *error = job->failed;
        code = job->failed.code;
    }
    return code;
}

/* Another rank: `failed` is why it cannot, or NULL. */
static void serve(Job *job, const int *pending, int count, const SmError *failed)
{
    const BenchRanks *ranks = job->run->ranks;
    BenchNote *note = sm_alloc(1, sizeof *note);
    bench_progress_start(&job->progress, true);
    for (int i = ranks->rank; i < count && !failed; i += ranks->count) {
        note->kind = BENCH_NOTE_POINT;
        bench_sweeper_measure(&job->sweeper, &job->sweep->plan, pending[i], &job->progress,
                              &note->point);
        note->point.rank = ranks->rank;
        bench_ranks_send(ranks, note);
    }
    note->kind = failed ? BENCH_NOTE_FAILED : BENCH_NOTE_END;
    if (failed) snprintf(note->line, sizeof note->line, "%s", failed->text);
    bench_ranks_send(ranks, note);
    free(note);
}

static int find_pending(const BenchSweepRun *run, const BenchPlan *plan, const bool *done,
                        int *pending)
{
    int count = 0;
    for (int i = run->shard - 1; i < plan->points; i += run->shards)
        if (!done[i]) pending[count++] = i;
    return count;
}

static SmCode prepare(Job *job, Start *start, SmError *error)
{
    const BenchSweepRun *run = job->run;
    BenchSweep *sweep = job->sweep;
    bool first = run->ranks->rank == 0;
    SmCode code = first ? bench_draft_reserve(run->output, run->output != NULL, error) : SM_OK;
    if (!code) code = bench_sweeper_create(&sweep->plan, &job->sweeper, error);
    if (!first) return code;
    if (!code) code = resume(run, sweep, error);
    start->code = code;
    start->plan = sweep->plan;
    for (long i = 0; i < sweep->count && !code; i++) start->done[sweep->point[i].index] = true;
    return code;
}

/* A rank of another program or other options would measure other points. */
static SmCode check_rank(const BenchPlan *mine, const BenchPlan *first, SmError *error)
{
    char what[240];
    if (bench_plan_same(first, mine, sizeof what, what)) return SM_OK;
    return sm_fail(error, SM_INPUT, "it has another sweep than the first rank: %s", what);
}

static void remark(const Job *job, int pending)
{
    if (job->run->quiet) return;
    if (job->sweeper.left_out[0])
        fprintf(stderr, "shapebench sweep: left out of the scene: %s\n", job->sweeper.left_out);
    if (job->sweep->count)
        fprintf(stderr, "shapebench sweep: %s has %ld points; %d are to be measured\n",
                job->run->output, job->sweep->count, pending);
}

SmCode bench_sweep_run(const BenchSweepRun *run, BenchSweep *sweep, SmError *error)
{
    Job job = {.run = run, .sweep = sweep, .left = run->ranks->count - 1};
    Start *start = sm_alloc(1, sizeof *start);
    int *pending = sm_alloc(BENCH_PLAN_POINTS, sizeof *pending);
    SmCode code = prepare(&job, start, error);
    bench_ranks_share(run->ranks, start, sizeof *start);
    if (!code && run->ranks->rank > 0) code = check_rank(&sweep->plan, &start->plan, error);
    if (!start->code) {
        int count = find_pending(run, &sweep->plan, start->done, pending);
        if (run->ranks->rank > 0) {
            serve(&job, pending, count, code ? error : NULL);
        } else {
            remark(&job, count);
            say_interrupt(run);
            code = lead(&job, pending, count, error);
        }
    }
    bench_interrupt_say(NULL);
    bench_sweeper_free(&job.sweeper);
    free(start);
    free(pending);
    return code;
}
