#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../campaign/campaign_run.h"
#include "../engines.h"
#include "../sweep/front.h"
#include "../sweep/recommend.h"
#include "../sweep/sweep.h"
#include "../sweep/sweep_table.h"
#include "command.h"
#include "option.h"
#include "range.h"

enum {
    KEY_SCENE = 0x2000,
    KEY_MESH,
    KEY_ENGINE,
    KEY_W,
    KEY_EPSILON,
    KEY_WIDTH,
    KEY_PRECISION,
    KEY_REPEATS,
    KEY_BLOCK,
    KEY_FRAMES,
    KEY_FORMAT,
    KEY_RECOMMEND,
    KEY_STIFFNESS,
    KEY_DEVIATION,
    KEY_BUDGET
};

typedef struct {
    BenchCommon common;
    const char *scene, *mesh, *file, *w, *epsilon;
    int engines, width, precision; /* in the lists below */
    BenchPlan plan;
    BenchCampaignRun run;
    BenchFormat format;
    bool recommend, measuring; /* was an option given that says what to measure? */
    BenchWish wish;
} Options;

static const struct argp_option option_list[] = {
    {"scene", KEY_SCENE, "NAME|FILE.cfg", 0, "The scene to sweep (default: hand)", 1},
    {"mesh", KEY_MESH, "FILE", 0,
     "Your mesh in the scene's place, scaled to it; without --scene dropped on the ground as 'run' "
     "does",
     1},
    {"engine", KEY_ENGINE, "NAME", 0, "both, fastlsm or octree (default: both)", 1},
    {"w", KEY_W, "RANGE", 0,
     "Region half-widths, FIRST:LAST[:STEP] or a list (default: 1:8), in edges of each node's own "
     "cell as run's --w; of a lattice, whose cells are alike, whole numbers of cells",
     1},
    {"epsilon", KEY_EPSILON, "RANGE", 0, "The octree's (default: 0:1:0.1)", 1},
    {"width", KEY_WIDTH, "UNIT", 0,
     "What an octree's w counts: edges of each node's own cell, or finest cells (default: edges)",
     1},
    {"precision", KEY_PRECISION, "P", 0, "Of what is timed: single or double (default: single)", 1},
    {"repeats", KEY_REPEATS, "N", 0, "Samples of every time, 1 to 64 (default: 9)", 2},
    {"block", KEY_BLOCK, "MS", 0, "Least milliseconds in a sample (default: 10)", 2},
    {"frames", KEY_FRAMES, "N", 0, "Frames of motion to compare (default: 50)", 2},
    {"output", 'o', "FILE.h5", 0,
     "Store every point as it is finished; if the file is there, go on with it (default: nothing "
     "stored)",
     3},
    BENCH_CAMPAIGN_OPTIONS("point", 3),
    {"format", KEY_FORMAT, "FORMAT", 0, "text, markdown, csv, latex, json (default: text)", 3},
    {"recommend", KEY_RECOMMEND, 0, 0,
     "Say which w and epsilon of each engine to take, for --budget, --deviation and --stiffness "
     "(default: at most 1% more deviation than the engine's least), and the command that runs it",
     4},
    {"stiffness", KEY_STIFFNESS, "HZ", 0, "Wish: the beam's first frequency", 4},
    {"deviation", KEY_DEVIATION, "PERCENT", 0,
     "Wish: the surface at most so far from full resolution, of the body's size, rms", 4},
    {"budget", KEY_BUDGET, "MS", 0, "Wish: a step takes at most so long", 4},
    {0},
};

static const BenchOption options_taken[] = {
    {KEY_SCENE, BENCH_TO(TEXT, scene), 0, 0, NULL},
    {KEY_W, BENCH_TO(TEXT, w), 0, 0, NULL},
    {KEY_EPSILON, BENCH_TO(TEXT, epsilon), 0, 0, NULL},
    {KEY_WIDTH, BENCH_TO(CHOICE, width), 0, 0, bench_widths},
    {KEY_PRECISION, BENCH_TO(CHOICE, precision), 0, 0, bench_precisions},
    {KEY_REPEATS, BENCH_TO(INT, plan.repeats), 1, BENCH_POINT_SAMPLES, NULL},
    {KEY_BLOCK, BENCH_TO(REAL, plan.block_ms), 0.001, 60000, NULL},
    {KEY_FRAMES, BENCH_TO(INT, plan.frames), 1, 10000, NULL},
    {'o', BENCH_TO(TEXT, run.output), 0, 0, NULL},
    BENCH_CAMPAIGN_TAKEN,
    {KEY_FORMAT, BENCH_TO(CHOICE, format), 0, 0, bench_format_names},
    {KEY_RECOMMEND, BENCH_TO(TRUE, recommend), 0, 0, NULL},
    {KEY_STIFFNESS, BENCH_TO(REAL, wish.stiffness), 1e-6, 1e6, NULL},
    {KEY_DEVIATION, BENCH_TO(REAL, wish.deviation), 0, 1000, NULL},
    {KEY_BUDGET, BENCH_TO(REAL, wish.budget), 1e-6, 1e9, NULL},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    Options *options = state->input;
    options->measuring |=
        (key >= KEY_SCENE && key < KEY_FORMAT) || key == 'o' || bench_option_of_campaign(key);
    if (bench_option_take(option_list, options_taken, key, text, state)) return 0;
    switch (key) {
    case KEY_MESH:
        if (strlen(text) >= sizeof options->plan.mesh)
            bench_usage(state, "--mesh: the path '%.60s...' is too long", text);
        options->mesh = text;
        return 0;
    case KEY_ENGINE:
        options->engines = bench_option_choice(state, "--engine", text, bench_engine_choices());
        return 0;
    }
    return bench_option_shown(key, text, state, options->measuring, &options->file);
}

static const char help[] =
    "Measure an engine, or both, over region widths w and the octree's epsilon: what a step costs, "
    "how stiff it makes a body, and how far it is from exact regions and from full resolution. "
    "With FILE.h5 alone: show a stored sweep.\v"
    "Every point is checked like a row of 'tables'; one that fails has INVALID in place of its "
    "times. The octree's goals are compared with those of epsilon 0 on the same deformed state; "
    "the surface, over some frames of the same scene, with a lattice of all finest cells whose "
    "regions hold as much on average (a lattice is its own full resolution). "
    "Stiffness is that of a regularly sampled beam with the same w and epsilon. The scene's cuts, "
    "touches, plasticity and further instances are left out.\n"
    "Started by mpirun, all ranks measure and the first one stores. Points of ranks and shards "
    "that share a machine disturb each other's times; each keeps its host and "
    "rank.\n" BENCH_EXIT_CODES;

static const struct argp argp = {option_list, parse, "[FILE.h5]", help, NULL, NULL, NULL};

static SmCode make_plan(Options *options, BenchPlan *plan, SmError *error)
{
    const char *scene = options->scene ? options->scene : options->mesh ? "" : "hand";
    if (strlen(scene) >= sizeof plan->file)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", scene);
    snprintf(plan->file, sizeof plan->file, "%s", scene);
    if (options->mesh) snprintf(plan->mesh, sizeof plan->mesh, "%s", options->mesh);
    strcpy(plan->engines, bench_engine_choices()[options->engines]);
    strcpy(plan->width, bench_widths[options->width]);
    strcpy(plan->precision, bench_precisions[options->precision]);
    plan->threads = options->common.threads;
    plan->seed = (long)options->common.seed;
    SmCode code =
        bench_range_parse("--w", options->w, bench_engine(plan->engines)->sampled ? 0.01 : 1, 1000,
                          BENCH_PLAN_VALUES, plan->w, &plan->ws, error);
    if (!code)
        code = bench_range_parse("--epsilon", options->epsilon, 0, 1000, BENCH_PLAN_VALUES,
                                 plan->epsilon, &plan->epsilons, error);
    return code ? code : bench_plan_count(plan, error);
}

static SmCode show(const Options *options, BenchCampaign *sweep, SmError *error)
{
    bench_front_mark(sweep->point, sweep->count);
    bench_sweep_table(stdout, options->format, sweep);
    const BenchWish *wish = &options->wish;
    bool wished = !isnan(wish->stiffness) || !isnan(wish->deviation) || !isnan(wish->budget);
    if (options->recommend || wished) {
        bool table = options->format == BENCH_AS_CSV || options->format == BENCH_AS_JSON;
        if (!table) putchar('\n');
        bench_recommend(table ? stderr : stdout, sweep->plan, sweep->point, sweep->count, wish);
    }
    return bench_campaign_verdict(sweep, error);
}

static SmCode run(Options *options, int argc, char **argv, BenchCampaign *sweep, SmError *error)
{
    *sweep = bench_campaign_create(&bench_sweep_type);
    BenchPlan *plan = sweep->plan;
    *plan = options->plan;
    SmCode code = make_plan(options, plan, error);
    if (code) return code;
    bench_machine_read(argc, argv, options->common.threads, &sweep->machine);
    bench_campaign_build(&sweep->machine, sizeof plan->build, plan->build);
    options->run.quiet = options->common.quiet;
    return bench_campaign_run(&options->run, sweep, error);
}

int bench_command_sweep(int argc, char **argv)
{
    Options options = {.w = "1:8",
                       .epsilon = "0:1:0.1",
                       .plan = {.repeats = 9, .block_ms = 10, .frames = 50},
                       .wish = {NAN, NAN, NAN}};
    BenchRanks ranks;
    BenchCampaign sweep = {0};
    SmError error;
    options.run.ranks = &ranks;
    SmCode code = bench_ranks_start(&ranks, &error);
    if (!code) {
        bench_options_parse(&argp, argc, argv, &options, BENCH_TAKES_ALL, &options.common);
        code = options.file ? bench_campaign_load(options.file, &bench_sweep_type, &sweep, &error)
                            : run(&options, argc, argv, &sweep, &error);
    }
    if (!code && ranks.rank == 0) code = show(&options, &sweep, &error);
    return bench_campaign_end(argv[0], &ranks, &sweep, code, &error);
}
