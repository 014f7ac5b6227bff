#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/mesh/reader.h"
#include "../engines.h"
#include "../scene/scene.h"
#include "../sweep/recommend.h"
#include "command.h"

typedef struct {
    BenchCampaignOptions its;
    const char *scene, *range[2]; /* of w and epsilon */
    BenchPlan plan;
    bool recommend;
    BenchWish wish;
} Options;

static const BenchSetting settings[] = {
    {BENCH_MEASURE("scene", "NAME|FILE.cfg", 1, "The scene to sweep (default: hand)"),
     BENCH_IN(Options, scene)},
    {BENCH_MEASURE(
         "mesh", "FILE", 1,
         "Your mesh in the scene's place, scaled to it; without --scene dropped on the ground "
         "as 'run' does"),
     BENCH_IN(Options, plan.mesh)},
    {BENCH_MEASURE("engine", "NAME", 1, "%s (default: both)"), BENCH_IN(Options, plan.engines),
     .choices_of = bench_engine_choices, .why_not = bench_engine_unplanned},
    {BENCH_MEASURE(
         "w", "RANGE", 1,
         "Region half-widths, FIRST:LAST[:STEP] or a list (default: 1:8), in edges of each "
         "node's own cell as run's --w; of a lattice, whose cells are alike, whole numbers of "
         "cells"),
     BENCH_IN(Options, range[0])},
    {BENCH_MEASURE("epsilon", "RANGE", 1, "The octree's (default: 0:1:0.1)"),
     BENCH_IN(Options, range[1])},
    {BENCH_MEASURE(
         "width", "UNIT", 1,
         "What an octree's w counts: edges of each node's own cell, or finest cells (default: "
         "edges)"),
     BENCH_IN(Options, plan.width), BENCH_CHOICES(bench_widths)},
    {BENCH_MEASURE("precision", "P", 1, "Of what is timed: %s (default: single)"),
     BENCH_IN(Options, plan.precision), BENCH_CHOICES(bench_precisions)},
    {BENCH_REPEATS_OPTION(Options, plan.repeats, BENCH_POINT_SAMPLES, ", 1 to 64 (default: 9)"),
     .measuring = true},
    {BENCH_BLOCK_OPTION(Options, plan.block_ms, " (default: 10)"), .measuring = true},
    {BENCH_MEASURE("frames", "N", 2, "Frames of motion to compare (default: 50)"),
     BENCH_IN(Options, plan.frames), 1, 10000},
    BENCH_CAMPAIGN_OPTIONS(Options, 3, "point", BENCH_STORES("point")),
    {BENCH_OPTION(
         "recommend", NULL, 4,
         "Say which w and epsilon of each engine to take for --stiffness within --deviation and "
         "--budget, and the command that runs it; without --stiffness what there is to choose "
         "from: "
         "soft, middle and stiff"),
     BENCH_IN(Options, recommend)},
    {BENCH_OPTION("stiffness", "HZ", 4,
                  "The wanted stiffness: the beam's first frequency, met within 10%"),
     BENCH_IN(Options, wish.stiffness), 1e-6, 1e6},
    {BENCH_OPTION("deviation", "PERCENT", 4,
                  "Constraint: the surface is at most so far from full resolution, rms, of the "
                  "body's size"),
     BENCH_IN(Options, wish.deviation), 0, 1000},
    {BENCH_OPTION("budget", "MS", 4, "Constraint: at most MS milliseconds a step"),
     BENCH_IN(Options, wish.budget), 1e-6, 1e9},
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    const char *word = options->its.common.words ? options->its.common.word[0] : "";
    bool scene =
        bench_scene_is_file(word) || (bench_scene_text(word, NULL) && access(word, F_OK) != 0);
    if (scene || sm_mesh_readable(word))
        bench_usage(state, "%s: FILE.h5 alone is shown; --%s %s is measured", word,
                    scene ? "scene" : "mesh", word);
}

static const char help[] =
    "Measure an engine, or both, over region widths w and the octree's epsilon: what a step costs, "
    "how stiff it makes a body, and how far it is from exact regions and from full resolution. "
    "With FILE.h5 alone: show a stored sweep.\v"
    "Every point is checked like a row of 'tables'; one that fails has INVALID in place of its "
    "times. The octree's goals are compared with those of epsilon 0 on the same deformed state; "
    "the surface, over some frames of the same scene, with a lattice of all finest cells whose "
    "regions hold as much on average (a lattice is its own full resolution). Stiffness is that of "
    "a regularly sampled beam with the same w and epsilon. The scene's cuts, touches, plasticity "
    "and further instances are left out.\n"
    "Started by mpirun, all ranks measure and the first one stores. Points of ranks "
    "that share a machine disturb each other's times; each keeps its host and "
    "rank.\n" BENCH_EXIT_CODES;

static SmCode make_plan(void *record, BenchCampaign *sweep, SmError *error)
{
    const Options *options = record;
    BenchPlan *plan = sweep->plan;
    *plan = options->plan;
    const char *scene = options->scene ? options->scene : plan->mesh[0] ? "" : "hand";
    if (strlen(scene) >= sizeof plan->file)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", scene);
    snprintf(plan->file, sizeof plan->file, "%s", scene);
    plan->threads = options->its.common.threads;
    plan->seed = (long)options->its.common.seed;
    return bench_campaign_read_lists(sweep, options->range, error);
}

static SmCode show(const void *record, BenchCampaign *sweep, SmError *error)
{
    const Options *options = record;
    BenchFormat format = options->its.format;
    bench_campaign_print(stdout, format, sweep);
    const BenchWish *wish = &options->wish;
    bool wished = !isnan(wish->stiffness) || !isnan(wish->deviation) || !isnan(wish->budget);
    if (options->recommend || wished) {
        bool table = format == BENCH_AS_CSV || format == BENCH_AS_JSON;
        if (!table) putchar('\n');
        bench_recommend(table ? stderr : stdout, sweep, wish);
    }
    return bench_campaign_verdict(sweep, error);
}

static const Options defaults = {.range = {"1:8", "0:1:0.1"},
                                 .plan = {.engines = "both",
                                          .width = "edges",
                                          .precision = "single",
                                          .repeats = 9,
                                          .block_ms = 10,
                                          .frames = 50},
                                 .wish = {NAN, NAN, NAN}};

const BenchCommand bench_command_sweep = {
    .name = "sweep",
    .summary = "cost and quality over w and epsilon; recommend some",
    .line = {settings, BENCH_TAKES_ALL, "[FILE.h5]", help, check, .most = 1,
             .limit = "One file is shown at a time"},
    .size = sizeof(Options),
    .defaults = &defaults,
    .campaign = &bench_sweep_type,
    .plan = make_plan,
    .show = show,
};
