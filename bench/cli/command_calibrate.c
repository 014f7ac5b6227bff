#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/solve/solver.h"
#include "../calibrate/calibration.h"
#include "../calibrate/calibration_table.h"
#include "../engines.h"
#include "campaign_command.h"

typedef struct {
    BenchCommon common;
    const char *scene;
    const char *range[BENCH_CALIBRATION_LISTS]; /* in the plan's order */
    const char *engines;
    double damping, poisson, density, young;
    BenchCampaignRun run;
    BenchFormat format;
} Options;

static const double standard_density = 1000;

/* The plan's lists. */
#define LIST(name, list, place, words)                                                             \
    BENCH_MEASURE(name, "RANGE", place, words), BENCH_IN(Options, range[list])

static const BenchSetting settings[] = {
    {BENCH_MEASURE("scene", "NAME|FILE.cfg", 1,
                   "A beam: its body's box, its cells and its time step are taken (default: beam)"),
     BENCH_IN(Options, scene)},
    {BENCH_MEASURE("engine", "NAME", 1, "both, fastlsm or octree (default: both)"),
     BENCH_IN(Options, engines), .choices_of = bench_engine_choices},
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
     BENCH_IN(Options, damping), 0, 1},
    {BENCH_MEASURE("poisson", "NU", 2, "Poisson's ratio of the elastic body (default: 0.3)"),
     BENCH_IN(Options, poisson), -0.5, 0.49},
    {BENCH_MEASURE("output", "FILE.h5", 3,
                   "Store every specimen as it is finished; if the file is there, go on with it "
                   "(default: nothing stored)"),
     BENCH_IN(Options, run.output), .letter = 'o'},
    BENCH_CAMPAIGN_OPTIONS(Options, 3, "specimen"),
    BENCH_FORMAT_OPTION(Options, 3),
    {BENCH_OPTION("density", "RHO", 4, "kg a cubic unit, of the wish (default: 1000)"),
     BENCH_IN(Options, density), 1e-6, 1e9},
    {BENCH_OPTION(
         "young", "E", 4,
         "Say which w and epsilon have this Young's modulus, in Pa, or what would, and print a "
         "scene's settings that do"),
     BENCH_IN(Options, young), 1e-6, 1e18},
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (options->density > 0 && isnan(options->young))
        bench_usage(state, "--density is that of --young's body: give both");
}

static const char help[] =
    "Find what w and epsilon mean: the Young's modulus and loss factor of the elastic body that "
    "behaves as an engine does, by the static sag and the natural frequencies of a clamped beam. "
    "With FILE.h5 alone: show a stored calibration.\v"
    "The elastic body is the meshless reference's beam, and theory's, Euler and Bernoulli's and "
    "Timoshenko's. The grid is of all w and epsilon on the scene's beam; other spacings are "
    "measured for all w, other lengths and time steps for the first, middle and last, at the first "
    "epsilon. Every specimen is checked against brute force, and that it is at rest; one that "
    "fails is INVALID. The laws are fitted to all of them. The octree samples the beam regularly.\n"
    "A modulus goes with the density: --density serves --young alone. It holds for scenes that set "
    "their density: where particles weigh 1 each, as is the default, those at a lattice's surface "
    "weigh too much, and it is 24% stiffer by sag at w 1, 21% at w 2.\n" BENCH_EXIT_CODES;

static const BenchCommandLine line = {
    settings, BENCH_TAKES_QUIET | BENCH_TAKES_THREADS, "[FILE.h5]", help, check, NULL, NULL};

static SmCode read_lists(const Options *options, BenchCalibrationPlan *plan, SmError *error)
{
    SmCode code = SM_OK;
    for (int l = 0; l < BENCH_CALIBRATION_LISTS && !code; l++) {
        const BenchCampaignList *list = &bench_calibration_lists[l];
        if (!list->least && !strcmp(options->range[l], "none")) continue;
        char *at = (char *)plan;
        code = bench_range_parse(list->option, options->range[l], list->low, list->high, list->most,
                                 (double *)(void *)(at + list->value),
                                 (int *)(void *)(at + list->count), error);
    }
    return code;
}

static SmCode measure(void *record, int argc, char **argv, BenchCampaign *calibration,
                      SmError *error)
{
    Options *options = record;
    *calibration = bench_campaign_create(&bench_calibration_type);
    BenchCalibrationPlan *plan = calibration->plan;
    if (strlen(options->scene) >= sizeof plan->file)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", options->scene);
    snprintf(plan->file, sizeof plan->file, "%s", options->scene);
    strcpy(plan->engines, options->engines);
    plan->density = standard_density;
    plan->poisson = options->poisson;
    plan->damping = options->damping;
    plan->meshless = ref_solver_built;
    SmCode code = read_lists(options, plan, error);
    if (!code) code = bench_calibration_beam(plan, error);
    if (!code) code = bench_calibration_count(plan, error);
    if (code) return code;
    bench_machine_read(argc, argv, 1, &calibration->machine);
    bench_campaign_build(&calibration->machine, sizeof plan->build, plan->build);
    options->run.quiet = options->common.quiet;
    if (!ref_solver_built && !options->run.quiet)
        fprintf(stderr,
                "%s: built without CHOLMOD and ARPACK: the meshless reference is left out, theory "
                "stands alone\n",
                argv[0]);
    return bench_campaign_run(&options->run, calibration, error);
}

static void advise(const Options *options, const BenchCampaign *calibration)
{
    char sentence[BENCH_WORDS], found[BENCH_WORDS];
    const BenchCalibrationPlan *plan = calibration->plan;
    BenchConclusion conclusion = bench_calibration_conclude(calibration);
    double density = options->density > 0 ? options->density : standard_density;
    BenchYoung wish = {options->young, density, plan->density, plan->thickness};
    long best = bench_recommendation_young(calibration->point, calibration->count, conclusion.law,
                                           conclusion.laws, &wish, sentence);
    bool table = options->format == BENCH_AS_CSV || options->format == BENCH_AS_JSON;
    FILE *file = table ? stderr : stdout;
    fprintf(file, "%s%s\n", table ? "" : "\n", sentence);
    if (best < 0) return;
    bench_recommendation_settings(bench_campaign_at(calibration, best), &wish, plan->damping,
                                  found);
    fprintf(file, "The scene's settings that hit it, of which density is one:\n    %s\n", found);
}

static SmCode show(void *record, BenchCampaign *calibration, SmError *error)
{
    const Options *options = record;
    bench_calibration_table(stdout, options->format, calibration);
    if (!isnan(options->young)) advise(options, calibration);
    return bench_campaign_verdict(calibration, error);
}

int bench_command_calibrate(int argc, char **argv)
{
    Options options = {.scene = "beam",
                       .engines = "both",
                       .range = {"1:10", "0:1:0.25", "3,4,7", "5,12", "0.5,2"},
                       .poisson = 0.3,
                       .young = NAN};
    static const BenchCampaignCommand command = {&bench_calibration_type, &line, measure, show};
    return bench_campaign_command(&command, argc, argv, &options, &options.common, &options.run);
}
