#include "../calibrate/calibration.h"
#include "../claims/claim_plan.h"
#include "../sweep/sweep.h"

const BenchCampaignType *const bench_campaign_types[] = {&bench_sweep_type, &bench_calibration_type,
                                                         &bench_claims_type, NULL};
