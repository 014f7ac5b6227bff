/* sweep.h - a sweep: a campaign (campaign.h) whose plan is a BenchPlan and whose points are
 * BenchPoints. Each is measured in the scene and body that they share: its cost (measure.h), its
 * stiffness (swing.h) and its gaps (gap.h). The file's schema: results/README.md.
 *
 * One body is swept, elastic and whole: what cuts, breaks, touches or looks at it, plasticity,
 * further instances and widths of places are left out of the scene, and a remark names them. */
#ifndef BENCH_SWEEP_H
#define BENCH_SWEEP_H

#include "plan.h"

extern const BenchCampaignType bench_sweep_type;

#endif
