#include "plan.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../engines.h"
#include "../scene/body.h"

#define FIELD(type, member)  BENCH_FIELD_AS(BenchPlan, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)

const BenchField bench_plan_fields[] = {
    {FIELD(TEXT, scene), MEANS(NULL, "that is swept")},
    {FIELD(TEXT, mesh),
     MEANS(NULL, "the user's mesh file in its place (empty: none); may differ between files of one "
                 "sweep, `mesh_hash` may not"),
     .may_differ = true},
    {FIELD(TEXT, engines), MEANS(NULL, "\"both\", \"fastlsm\" or \"octree\"")},
    {FIELD(TEXT, precision), MEANS(NULL, "of what is timed")},
    {FIELD(TEXT, width),
     MEANS(NULL, "what an octree's w counts: \"edges\" of each node's own cell, or finest "
                 "\"cells\"")},
    {FIELD(TEXT, build),
     MEANS(NULL, "version, commit, compiler, flags; where sources were changed after the commit, "
                 "the program's hash")},
    {FIELD(HASH, scene_hash), MEANS(NULL, "FNV-1a of the scene's settings")},
    {FIELD(HASH, mesh_hash), MEANS(NULL, "FNV-1a of the mesh's coordinates and indices")},
    {FIELD(INT, repeats), MEANS(NULL, "samples of every time")},
    {FIELD(DOUBLE, block_ms), MEANS("ms", "least time in a sample")},
    {FIELD(INT, frames), MEANS(NULL, "of the motion that is compared")},
    {FIELD(INT, steps), MEANS(NULL, "a frame")},
    {FIELD(INT, threads), MEANS(NULL, "used")},
    {FIELD(LONG, seed), MEANS(NULL, "of what is drawn by chance")},
    {FIELD(DOUBLE, size), MEANS("mesh units", "largest extent of the body")},
    {FIELD(DOUBLE, cell), MEANS("mesh units", "its finest cell")},
    {FIELD(INT, points),
     MEANS(NULL, "planned: of every w comes fastlsm, then the octree's epsilons")},
    {FIELD(INT, ws), MEANS(NULL, "numbers of w")},
    {FIELD(INT, epsilons), MEANS(NULL, "numbers of epsilon")},
};

const int bench_plan_field_count = sizeof bench_plan_fields / sizeof bench_plan_fields[0];

const BenchCampaignList bench_plan_lists[BENCH_PLAN_LISTS] = {
    {"w", "--w", offsetof(BenchPlan, w), offsetof(BenchPlan, ws), 1, BENCH_PLAN_VALUES, 0.01, 1000},
    {"epsilon", "--epsilon", offsetof(BenchPlan, epsilon), offsetof(BenchPlan, epsilons), 1,
     BENCH_PLAN_VALUES, 0, 1000},
};

/* Points of one w and engine. */
static int points_of(const BenchPlan *plan, const BenchEngine *engine)
{
    return engine->sampled ? plan->epsilons : 1;
}

/* Points of one w. */
static int points_of_w(const BenchPlan *plan)
{
    const BenchEngine *engine;
    int points = 0;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++)
        points += points_of(plan, engine);
    return points;
}

static SmCode check_w(const BenchPlan *plan, const SmEngineType *type, SmError *error)
{
    for (int i = 0; i < plan->ws && type->by_cells; i++)
        if (plan->w[i] != floor(plan->w[i]) || plan->w[i] > SM_MOST_W)
            return sm_fail(error, SM_USAGE,
                           "--w: %g is no half-width of %s, which are whole numbers from 1 to "
                           "%d; give --engine octree to sweep that alone",
                           plan->w[i], type->name, SM_MOST_W);
    return SM_OK;
}

SmCode bench_plan_count(BenchPlan *plan, SmError *error)
{
    const BenchEngine *engine;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++) {
        SmCode code = check_w(plan, engine->type[0], error);
        if (code) return code;
    }
    long points = (long)plan->ws * points_of_w(plan);
    if (points < 1) return sm_fail(error, SM_USAGE, "no points: no engine '%.11s'", plan->engines);
    if (points > BENCH_PLAN_POINTS)
        return sm_fail(error, SM_USAGE,
                       "--w and --epsilon make %ld points, and a sweep has %d at most: take larger "
                       "steps, or several files",
                       points, BENCH_PLAN_POINTS);
    if (plan->repeats < 1 || plan->repeats > BENCH_POINT_SAMPLES)
        return sm_fail(error, SM_USAGE, "%d repeats; 1 to %d can be", plan->repeats,
                       BENCH_POINT_SAMPLES);
    plan->points = (int)points;
    return SM_OK;
}

bool bench_plan_alone(const BenchPlan *plan)
{
    char name[BENCH_NAME];
    bench_mesh_name(plan->mesh, name);
    return plan->mesh[0] && !plan->file[0] && !strcmp(name, plan->scene);
}

void bench_plan_point(const BenchPlan *plan, int index, BenchPoint *point)
{
    int each = points_of_w(plan);
    assert(each > 0); /* bench_plan_count() has seen to it */
    int rest = index % each;
    const BenchEngine *engine = bench_engine_planned(plan->engines, 0);
    for (int e = 1; rest >= points_of(plan, engine); e++) {
        rest -= points_of(plan, engine);
        engine = bench_engine_planned(plan->engines, e);
    }
    point->index = index;
    point->w = plan->w[index / each];
    point->epsilon = engine->sampled ? plan->epsilon[rest] : 0;
    snprintf(point->engine, sizeof point->engine, "%s", engine->type[0]->name);
}
