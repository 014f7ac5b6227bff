/* plan.h - what a sweep is of: its scene, mesh, program, options, and so its points. Two sweeps of
 * the same plan may share a file. What the members are is said in plan.c. */
#ifndef BENCH_PLAN_H
#define BENCH_PLAN_H

#include "../campaign/campaign.h"
#include "point.h"

enum { BENCH_PLAN_VALUES = 256, BENCH_PLAN_POINTS = BENCH_CAMPAIGN_POINTS };

typedef struct {
    char
        file[1024]; /* the scene's name or file as given; empty: that of a mesh alone. Not stored */
    char scene[64], mesh[1024];
    char engines[12], precision[12], width[12]; /* engines: "both", or the one */
    char build[768];
    unsigned long long scene_hash, mesh_hash;
    int repeats;
    double block_ms;
    int frames, steps, threads;
    long seed;
    double size, cell;
    int points, ws, epsilons;
    double w[BENCH_PLAN_VALUES], epsilon[BENCH_PLAN_VALUES];
} BenchPlan;

/* The members by name, all but `file` and the two arrays; and those. */
extern const BenchField bench_plan_fields[];
extern const int bench_plan_field_count;
enum { BENCH_PLAN_LISTS = 2 };
extern const BenchCampaignList bench_plan_lists[BENCH_PLAN_LISTS];

/* Counts the points of the engines, w and epsilon given. SM_USAGE: a w that is no half-width of
 * fastlsm, too many points, or repeats that a point has no room for. */
SmCode bench_plan_count(BenchPlan *plan, SmError *error);

/* Is the body a mesh alone, dropped on the ground, rather than in the place of a scene's? */
bool bench_plan_alone(const BenchPlan *plan);

/* Engine, w and epsilon of a point: of every w in turn all engines, of sampled ones all epsilons.
 */
void bench_plan_point(const BenchPlan *plan, int index, BenchPoint *point);

#endif
