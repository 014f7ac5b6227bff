/* sweep.h - a sweep: a campaign (campaign.h) whose plan is a BenchPlan and whose points are
 * BenchPoints: of every w in turn all engines, of sampled ones all epsilons. Each is measured in
 * the scene and body that they share: its cost (measure.h), its stiffness (bending.h) and its gaps
 * (gap.h). The file's schema: results/README.md.
 *
 * One body is swept, elastic and whole: what cuts, breaks, touches or looks at it, plasticity,
 * further instances and widths of places are left out of the scene, and a remark names them.
 *
 * In its table times of a point that is not valid are INVALID, empty or null; other quantities that
 * could not be had are "-", empty or null. The reasons follow the text form, each once, and a line
 * where points were measured on several hosts. */
#ifndef BENCH_SWEEP_H
#define BENCH_SWEEP_H

#include "../campaign/campaign.h"
#include "point.h"

enum { BENCH_PLAN_VALUES = 256, BENCH_PLAN_POINTS = BENCH_CAMPAIGN_POINTS };

/* What it is of; two sweeps of the same plan may share a file. What the members are is said in
 * sweep.c. */
typedef struct {
    char
        file[1024]; /* the scene's name or file as given; empty: that of a mesh alone. Not stored */
    char scene[64], mesh[1024];
    char engines[12], precision[12], width[12]; /* engines: "both", or the one */
    char build[BENCH_CAMPAIGN_BUILD];
    unsigned long long scene_hash, mesh_hash;
    int repeats;
    double block_ms;
    int frames, steps, threads;
    long seed;
    double size, cell;
    int points, ws, epsilons;
    double w[BENCH_PLAN_VALUES], epsilon[BENCH_PLAN_VALUES];
} BenchPlan;

/* Is the body a mesh alone, dropped on the ground, rather than in the place of a scene's? */
bool bench_plan_alone(const BenchPlan *plan);

/* Its lists are w and epsilon. */
extern const BenchCampaignType bench_sweep_type;

#endif
