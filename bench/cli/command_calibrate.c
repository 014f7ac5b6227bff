#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/solve/solver.h"
#include "../calibrate/calibration.h"
#include "../engines.h"
#include "command.h"

typedef struct {
    BenchCampaignOptions its;
    const char *range[5]; /* in the plan's order */
    BenchCalibrationPlan plan;
    double density, young; /* of the wish */
} Options;

#define STANDARD_DENSITY 1000

/* The plan's lists. */
#define LIST(name, list, place, words)                                                             \
    BENCH_MEASURE(name, "RANGE", place, words), BENCH_IN(Options, range[list])

static const BenchSetting settings[] = {
    {BENCH_OPTION("scene", "NAME|FILE.cfg", 1,
                  "A beam, whose body's box, cells and time step are taken; with FILE.h5 the scene "
                  "that --young is for, of any body (default: beam)"),
     BENCH_IN(Options, plan.file)},
    {BENCH_MEASURE("engine", "NAME", 1, "%s (default: both)"), BENCH_IN(Options, plan.engines),
     .choices_of = bench_engine_choices, .why_not = bench_engine_unplanned},
    {LIST("w", 0, 1,
          "Region half-widths in cells, which in a regular octree are its nodes' edges, 1 to "
          "31, FIRST:LAST[:STEP] or a list (default: 1:10)")},
    {LIST("epsilon", 1, 1, "The octree's (default: 0:1:0.25)")},
    {LIST("across", 2, 2,
          "Lattice spacings beside the scene's: cells through the beam, or none (default: "
          "3,4,7)")},
    {LIST("aspect", 3, 2,
          "Beams beside the scene's: length over thickness, 3 or more, or none (default: "
          "5,12)")},
    {LIST("step", 4, 2, "Time steps beside the scene's: times that, or none (default: 0.5,2)")},
    {BENCH_MEASURE("damping", "K", 2, "Share of region damping, 0 to 1 (default: 0)"),
     BENCH_IN(Options, plan.damping), 0, 1},
    {BENCH_MEASURE("poisson", "NU", 2, "The elastic body's Poisson ratio (default: 0.3)"),
     BENCH_IN(Options, plan.poisson), -0.5, 0.49},
    BENCH_CAMPAIGN_OPTIONS(Options, 3, "specimen", BENCH_STORES("specimen")),
    {BENCH_OPTION("density", "RHO", 4,
                  "kg a cubic unit, of --young's body (default: the scene's, or 1000)"),
     BENCH_IN(Options, density), 1e-6, 1e9},
    {BENCH_OPTION(
         "young", "E", 4,
         "Say which w and epsilon have this Young's modulus, in Pa, or what would, and print the "
         "scene's settings that do, for the cells that it has"),
     BENCH_IN(Options, young), 1e-6, 1e18},
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (!isnan(options->young)) return;
    if (options->density > 0) bench_usage(state, "--density is that of --young's body: give both");
    if (options->its.common.words && strcmp(options->plan.file, "beam") != 0)
        bench_usage(state, "--scene is that of --young where FILE.h5 is shown: give both");
}

static const char help[] =
    "Find what w and epsilon mean: the Young's modulus and loss factor of the elastic body that "
    "behaves as an engine does, by the static sag and the natural frequencies of a clamped beam. "
    "With FILE.h5 alone: show a stored calibration.\v"
    "The elastic body is the meshless reference's beam, and theory's, Euler and Bernoulli's and "
    "Timoshenko's. The grid is of all w and epsilon on the scene's beam; other spacings are "
    "measured for all w, other lengths and time steps for the first, middle and last, at the first "
    "epsilon. Every specimen is checked against brute force, and that it is at rest; one that "
    "fails is INVALID. The law is fitted to all of them. The octree samples the beam regularly. "
    "Meshless bodies and shells are not calibrated: they have no w and epsilon, and their modulus "
    "is given (run --young).\n"
    "A modulus goes with the density: --density serves --young alone. It holds for scenes that set "
    "their density: where particles weigh 1 each, as is the default, those at a lattice's surface "
    "weigh too much, and it is 24% stiffer by sag at w 1, 21% at w 2.\n" BENCH_EXIT_CODES;

static SmCode make_plan(void *record, BenchCampaign *calibration, SmError *error)
{
    Options *options = record;
    BenchCalibrationPlan *plan = calibration->plan;
    *plan = options->plan;
    plan->meshless = ref_solver_built;
    options->its.common.threads = 1; /* the others were for the meshless reference */
    SmCode code = bench_campaign_read_lists(calibration, options->range, error);
    if (!code) code = bench_calibration_beam(plan, error);
    if (!code && !ref_solver_built && !options->its.common.quiet)
        fputs("shapebench calibrate: built without CHOLMOD and ARPACK: the meshless reference is "
              "left out, theory stands alone\n",
              stderr);
    return code;
}

/* For the scene's cells and, unless another is given, its density. */
static SmCode make_wish(const Options *options, const BenchCalibrationPlan *plan, BenchYoung *wish,
                        SmError *error)
{
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    BenchBody body = {0};
    SmCode code = bench_scene_find(options->plan.file, scene, error);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, error);
    double density = options->density > 0 ? options->density : scene->density;
    if (!(density > 0)) density = STANDARD_DENSITY;
    *wish = (BenchYoung){options->young, density, plan->density, body.voxels.cell};
    bench_body_free(&body);
    free(scene);
    return code;
}

static SmCode recommend(const Options *options, const BenchCampaign *calibration, SmError *error)
{
    char sentence[BENCH_WORDS], found[BENCH_WORDS];
    const BenchCalibrationPlan *plan = calibration->plan;
    BenchYoung wish;
    SmCode code = make_wish(options, plan, &wish, error);
    if (code) return code;
    long best = bench_recommendation_young(calibration->point, calibration->count, &wish, sentence);
    bool table = options->its.format == BENCH_AS_CSV || options->its.format == BENCH_AS_JSON;
    FILE *file = table ? stderr : stdout;
    fprintf(file, "%s%s\n", table ? "" : "\n", sentence);
    if (best < 0) return SM_OK;
    bench_recommendation_settings(bench_campaign_at(calibration, best), &wish, plan->damping,
                                  found);
    fprintf(file, "In the scene %s these lines hit it, in the place of its own of these names:\n%s",
            options->plan.file, found);
    return SM_OK;
}

static SmCode show(const void *record, BenchCampaign *calibration, SmError *error)
{
    const Options *options = record;
    bench_campaign_print(stdout, options->its.format, calibration);
    SmCode code = isnan(options->young) ? SM_OK : recommend(options, calibration, error);
    return code ? code : bench_campaign_verdict(calibration, error);
}

static const Options defaults = {
    .range = {"1:10", "0:1:0.25", "3,4,7", "5,12", "0.5,2"},
    .plan = {.file = "beam", .engines = "both", .density = STANDARD_DENSITY, .poisson = 0.3},
    .young = NAN};

const BenchCommand bench_command_calibrate = {
    .name = "calibrate",
    .summary = "the elastic body that w and epsilon make: its modulus",
    .line = {settings, BENCH_TAKES_QUIET | BENCH_TAKES_THREADS, "[FILE.h5]", help, check, .most = 1,
             .limit = "One file is shown at a time"},
    .size = sizeof(Options),
    .defaults = &defaults,
    .campaign = &bench_calibration_type,
    .plan = make_plan,
    .show = show,
};
