/* How rows of shape matching are checked: against brute force (check.h), and that momenta stay. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../check/parted.h"
#include "../check/runner_check.h"
#include "../check/step_check.h"
#include "checker.h"
#include "measure.h"

/* `worst` keeps the larger of all checks' findings. */
static void check_state(const BenchCheck *check, const BenchRunner *runner, BenchDeviation *worst,
                        BenchRow *row)
{
    char reason[sizeof row->reason];
    BenchDeviation found;
    if (!bench_check_all(check, runner, &found, sizeof reason, reason))
        bench_row_invalidate(row, "%s", reason);
    if (worst->particles == 0) worst->finite = true; /* the first state */
    bench_check_merge(&found, worst);
    row->goal_error = worst->goal_error;
    row->momentum_error = worst->momentum_error;
    row->sampled = worst->sampled;
    row->left_out = worst->unresolved > worst->tied ? worst->unresolved : worst->tied;
    bench_check_text(worst, sizeof row->found, row->found);
}

/* Are the momenta of the body, left alone as it is now, kept over many steps? */
static void check_drift(const BenchRunner *runner, BenchDeviation *worst, BenchRow *row)
{
    char reason[sizeof row->reason];
    BenchDrift drift = bench_drift(runner);
    if (drift.steps > worst->drift.steps) worst->drift.steps = drift.steps;
    worst->drift.apart = fmax(worst->drift.apart, drift.apart);
    row->drift = worst->drift.linear = fmax(worst->drift.linear, drift.linear);
    worst->drift.held = fmax(worst->drift.held, drift.held);
    worst->drift.touching = fmax(worst->drift.touching, drift.touching);
    worst->drift.hung = fmax(worst->drift.hung, drift.hung);
    row->twist = worst->drift.angular = fmax(worst->drift.angular, drift.angular);
    row->drift_steps = worst->drift.steps;
    bench_check_text(worst, sizeof row->found, row->found);
    if (!worst->plain &&
        !bench_drift_verdict(&drift, runner->type->precision, sizeof reason, reason))
        bench_row_invalidate(row, "%s", reason);
}

/* Of a plastic octree: do its rest shapes flow as they should in the step that follows? */
static void check_flow(const BenchCheck *check, BenchRunner *runner, BenchRow *row)
{
    double error = bench_check_flow(check, runner);
    if (!(error <= row->goal_tolerance))
        bench_row_invalidate(row,
                             "rest shapes flow %.3g otherwise than brute force; at most %g allowed",
                             error, row->goal_tolerance);
}

/* Of a body that breaks by strain: does the step that follows break what it should? */
static void check_breaks(BenchRunner *runner, BenchRow *row)
{
    double limit = runner->scene->params.strain_limit;
    if (!(limit > 0 && isfinite(limit)) || runner->body->instances > 1) return;
    long wrong = bench_parted_step_wrong(runner);
    if (wrong > 0)
        bench_row_invalidate(row, "a step breaks %ld links that are not too long, or fails to",
                             wrong);
}

static void check_counts(const BenchCheck *check, const BenchRunner *runner, BenchRow *row)
{
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    long particles = check->count * check->body->instances;
    if (counts.particles != particles)
        bench_row_invalidate(row, "the engine has %.0f particles, its twin %.0f",
                             (double)counts.particles, (double)particles);
    if (check->parted > 0) bench_row_invalidate(row, "links broken at rest: %ld", check->parted);
    if (counts.broken == 0 && !check->samples && counts.regions != check->unique)
        bench_row_invalidate(row, "the engine has %.0f unique regions, brute force %.0f",
                             (double)counts.regions, (double)check->unique);
}

static SmCode check_members(const BenchRunner *runner, SmError *error)
{
    double members = bench_twin_members(runner);
    if (members <= BENCH_MOST_SAMPLED) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "%s: regions with %.3g members take too long to be checked by brute force (at "
                   "most %g): take narrower ones",
                   runner->scene->file, members, BENCH_MOST_SAMPLED);
}

/* A check of every group of bodies as it is now. */
typedef struct {
    BenchCheck *group; /* [count] */
    long *links;       /* [count] that it was made for */
    int count;
} Checks;

static SmCode accepts(const BenchPlayback *play, SmError *error)
{
    SmCode code = SM_OK;
    for (int g = 0; g < play->count && !code; g++)
        code = check_members(&play->group[g].runner, error);
    return code;
}

static long links_of(const BenchRunner *runner)
{
    return runner->type->links ? runner->type->links(runner->engine, NULL, 0) : 0;
}

static void begin_group(Checks *checks, int g, const BenchRunner *runner)
{
    bench_check_begin(runner->scene, runner->body, runner->type, runner->engine, &checks->group[g]);
    checks->links[g] = links_of(runner);
}

static void *begin(BenchPlayback *play)
{
    Checks *checks = sm_alloc(1, sizeof *checks);
    checks->count = play->count;
    checks->group = sm_alloc((size_t)checks->count, sizeof *checks->group);
    checks->links = sm_alloc((size_t)checks->count, sizeof *checks->links);
    for (int g = 0; g < checks->count; g++) begin_group(checks, g, &play->group[g].runner);
    return checks;
}

/* Of bodies that have broken since, by strain, begins anew. */
static void renew(Checks *checks, const BenchPlayback *play)
{
    for (int g = 0; g < checks->count; g++) {
        if (links_of(&play->group[g].runner) == checks->links[g]) continue;
        bench_check_free(&checks->group[g]);
        begin_group(checks, g, &play->group[g].runner);
    }
}

static void rest(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    (void)worst;
    const Checks *checks = check;
    for (int g = 0; g < checks->count; g++)
        check_counts(&checks->group[g], &play->group[g].runner, row);
}

static void state(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    Checks *checks = check;
    renew(checks, play);
    for (int g = 0; g < checks->count; g++)
        check_state(&checks->group[g], &play->group[g].runner, worst, row);
}

static void end(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    const Checks *checks = check;
    for (int g = 0; g < checks->count; g++)
        check_flow(&checks->group[g], &play->group[g].runner, row);
    for (int g = 0; g < checks->count; g++) check_breaks(&play->group[g].runner, row);
    for (int g = 0; g < checks->count; g++) check_drift(&play->group[g].runner, worst, row);
}

static void let_go(void *check)
{
    Checks *checks = check;
    for (int g = 0; g < checks->count; g++) bench_check_free(&checks->group[g]);
    sm_free_all(checks->group, checks->links, checks);
}

const BenchChecker bench_matching_checker = {
    .size = sizeof(BenchDeviation),
    .accepts = accepts,
    .begin = begin,
    .rest = rest,
    .state = state,
    .end = end,
    .free = let_go,
};
