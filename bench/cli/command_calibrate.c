#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/solve/solver.h"
#include "../calibrate/calibration.h"
#include "../calibrate/calibration_table.h"
#include "../campaign/campaign_run.h"
#include "../engines.h"
#include "command.h"
#include "option.h"
#include "range.h"

enum {
    KEY_SCENE = 0x3000,
    KEY_ENGINE,
    KEY_W,
    KEY_EPSILON,
    KEY_ACROSS,
    KEY_ASPECT,
    KEY_STEP,
    KEY_DAMPING,
    KEY_POISSON,
    KEY_FORMAT,
    KEY_DENSITY,
    KEY_YOUNG
};

typedef struct {
    BenchCommon common;
    const char *scene, *file;
    const char *range[BENCH_CALIBRATION_LISTS]; /* in the plan's order */
    int engines;                                /* in the list below */
    double damping, poisson, density, young;
    BenchCampaignRun run;
    BenchFormat format;
    bool measuring; /* was an option given that says what to measure? */
} Options;

static const double standard_density = 1000;

static const struct argp_option option_list[] = {
    {"scene", KEY_SCENE, "NAME|FILE.cfg", 0,
     "A beam: its body's box, its cells and its time step are taken (default: beam)", 1},
    {"engine", KEY_ENGINE, "NAME", 0, "both, fastlsm or octree (default: both)", 1},
    {"w", KEY_W, "RANGE", 0,
     "Region half-widths in cells, which in a regular octree are its nodes' edges, 1 to 31, "
     "FIRST:LAST[:STEP] or a list (default: 1:10)",
     1},
    {"epsilon", KEY_EPSILON, "RANGE", 0, "The octree's (default: 0:1:0.25)", 1},
    {"across", KEY_ACROSS, "RANGE", 0,
     "Lattice spacings beside the scene's: cells through the beam, or none (default: 3,4,7)", 2},
    {"aspect", KEY_ASPECT, "RANGE", 0,
     "Beams beside the scene's: length over thickness, 3 or more, or none (default: 5,12)", 2},
    {"step", KEY_STEP, "RANGE", 0,
     "Time steps beside the scene's: times that, or none (default: 0.5,2)", 2},
    {"damping", KEY_DAMPING, "K", 0, "Share of region damping, 0 to 1 (default: 0)", 2},
    {"poisson", KEY_POISSON, "NU", 0, "Poisson's ratio of the elastic body (default: 0.3)", 2},
    {"output", 'o', "FILE.h5", 0,
     "Store every specimen as it is finished; if the file is there, go on with it (default: "
     "nothing stored)",
     3},
    BENCH_CAMPAIGN_OPTIONS("specimen", 3),
    {"format", KEY_FORMAT, "FORMAT", 0, "text, markdown, csv, latex, json (default: text)", 3},
    {"density", KEY_DENSITY, "RHO", 0, "kg a cubic unit, of the wish (default: 1000)", 4},
    {"young", KEY_YOUNG, "E", 0,
     "Say which w and epsilon have this Young's modulus, in Pa, or what would, and print a scene's "
     "settings that do",
     4},
    {0},
};

static const BenchOption options_taken[] = {
    {KEY_SCENE, BENCH_TO(TEXT, scene), 0, 0, NULL},
    {KEY_W, BENCH_TO(TEXT, range[0]), 0, 0, NULL},
    {KEY_EPSILON, BENCH_TO(TEXT, range[1]), 0, 0, NULL},
    {KEY_ACROSS, BENCH_TO(TEXT, range[2]), 0, 0, NULL},
    {KEY_ASPECT, BENCH_TO(TEXT, range[3]), 0, 0, NULL},
    {KEY_STEP, BENCH_TO(TEXT, range[4]), 0, 0, NULL},
    {KEY_DAMPING, BENCH_TO(REAL, damping), 0, 1, NULL},
    {KEY_POISSON, BENCH_TO(REAL, poisson), -0.5, 0.49, NULL},
    {'o', BENCH_TO(TEXT, run.output), 0, 0, NULL},
    BENCH_CAMPAIGN_TAKEN,
    {KEY_FORMAT, BENCH_TO(CHOICE, format), 0, 0, bench_format_names},
    {KEY_DENSITY, BENCH_TO(REAL, density), 1e-6, 1e9, NULL},
    {KEY_YOUNG, BENCH_TO(REAL, young), 1e-6, 1e18, NULL},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    Options *options = state->input;
    options->measuring |=
        (key >= KEY_SCENE && key < KEY_FORMAT) || key == 'o' || bench_option_of_campaign(key);
    if (bench_option_take(option_list, options_taken, key, text, state)) return 0;
    if (key == KEY_ENGINE) {
        options->engines = bench_option_choice(state, "--engine", text, bench_engine_choices());
        return 0;
    }
    if (key == ARGP_KEY_END && options->density > 0 && isnan(options->young))
        bench_usage(state, "--density is that of --young's body: give both");
    return bench_option_shown(key, text, state, options->measuring, &options->file);
}

static const char help[] =
    "Find what w and epsilon mean: the Young's modulus and loss factor of the elastic body that "
    "behaves as an engine does, by the static sag and the natural frequencies of a clamped beam. "
    "With FILE.h5 alone: show a stored calibration.\v"
    "The elastic body is the meshless reference's beam, and theory's, Euler and Bernoulli's and "
    "Timoshenko's. The grid is of all w and epsilon on the scene's beam; other spacings are "
    "measured "
    "for all w, other lengths and time steps for the first, middle and last, at the first epsilon. "
    "Every specimen is checked against brute force, and that it is at rest; one that fails is "
    "INVALID. The laws are fitted to all of them. The octree samples the beam regularly.\n"
    "A modulus goes with the density: --density serves --young alone. It holds for scenes that set "
    "their density: where particles weigh 1 each, as is the default, those at a lattice's surface "
    "weigh too much, and it is 24% stiffer by sag at w 1, 21% at w 2.\n" BENCH_EXIT_CODES;

static const struct argp argp = {option_list, parse, "[FILE.h5]", help, NULL, NULL, NULL};

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

static SmCode run(Options *options, int argc, char **argv, BenchCampaign *calibration,
                  SmError *error)
{
    *calibration = bench_campaign_create(&bench_calibration_type);
    BenchCalibrationPlan *plan = calibration->plan;
    if (strlen(options->scene) >= sizeof plan->file)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", options->scene);
    snprintf(plan->file, sizeof plan->file, "%s", options->scene);
    strcpy(plan->engines, bench_engine_choices()[options->engines]);
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
    char sentence[BENCH_WORDS], settings[BENCH_WORDS];
    const BenchCalibrationPlan *plan = calibration->plan;
    BenchConclusion conclusion = bench_calibration_conclude(calibration);
    double density = options->density > 0 ? options->density : standard_density;
    BenchYoung wish = {options->young, density, plan->density, plan->thickness};
    long best = bench_advice_young(calibration->point, calibration->count, conclusion.law,
                                   conclusion.laws, &wish, sentence);
    bool table = options->format == BENCH_AS_CSV || options->format == BENCH_AS_JSON;
    FILE *file = table ? stderr : stdout;
    fprintf(file, "%s%s\n", table ? "" : "\n", sentence);
    if (best < 0) return;
    bench_advice_settings(bench_campaign_at(calibration, best), &wish, plan->damping, settings);
    fprintf(file, "The scene's settings that hit it, of which density is one:\n    %s\n", settings);
}

static SmCode show(const Options *options, const BenchCampaign *calibration, SmError *error)
{
    bench_calibration_table(stdout, options->format, calibration);
    if (!isnan(options->young)) advise(options, calibration);
    return bench_campaign_verdict(calibration, error);
}

int bench_command_calibrate(int argc, char **argv)
{
    Options options = {.scene = "beam",
                       .range = {"1:10", "0:1:0.25", "3,4,7", "5,12", "0.5,2"},
                       .poisson = 0.3,
                       .young = NAN};
    BenchRanks ranks;
    BenchCampaign calibration = {0};
    SmError error;
    options.run.ranks = &ranks;
    SmCode code = bench_ranks_start(&ranks, &error);
    if (!code) {
        bench_options_parse(&argp, argc, argv, &options, BENCH_TAKES_QUIET | BENCH_TAKES_THREADS,
                            &options.common);
        code = options.file ? bench_campaign_load(options.file, &bench_calibration_type,
                                                  &calibration, &error)
                            : run(&options, argc, argv, &calibration, &error);
    }
    if (!code && ranks.rank == 0) code = show(&options, &calibration, &error);
    return bench_campaign_end(argv[0], &ranks, &calibration, code, &error);
}
