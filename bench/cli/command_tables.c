#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/isa.h"
#include "../../lib/printable.h"
#include "../../lib/system/cores.h"
#include "../../lib/system/team.h"
#include "../../reference/meshless/solve/solver.h"
#include "../../reference/paper.h"
#include "../engines.h"
#include "../measure/measure.h"
#include "../play/runner.h"
#include "../scene/override.h"
#include "../store/draft.h"
#include "../table/quantity.h"
#include "../table/row_grid.h"
#include "../table/row_store.h"
#include "../table/row_table.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    BenchOverride chosen;
    const char *paper, *output, *checked;
    BenchNames given;
    int repeats;
    double block;
    BenchFormat format;
    bool overwrite, explain, counters, columns;
} Options;

/* A scene to measure, and the name that stood for it and others, or NULL; and the instruction set
 * to measure it with. */
typedef struct {
    const char *scene, *stem, *isa;
} Choice;

typedef struct {
    const Options *options;
    Choice *scene; /* [count] */
    int count;
} Choices;

static const BenchSetting settings[] = {
    {BENCH_PAPER_OPTION(Options, paper, "The paper whose table to measure",
                        "fastlsm and meshless")},
    {BENCH_OPTION("scene", "NAME|FILE", 1,
                  "Measure this scene only, or the paper's scenes NAME-...; may be repeated"),
     BENCH_IN(Options, given)},
    {BENCH_IN(Options, chosen), .table = bench_override_settings, .who = BENCH_BY_TABLES},
    {BENCH_REPEATS_OPTION(Options, repeats, 10000, " (default: 15)")},
    {BENCH_BLOCK_OPTION(Options, block, " (default: 20)")},
    {BENCH_OPTION("checked", "HASH", 2,
                  "The state that is timed has been checked by this program, and state_hash was "
                  "HASH: it is not checked again, and any other is INVALID"),
     BENCH_IN(Options, checked)},
    BENCH_FORMAT_OPTION(Options, format, 3),
    {BENCH_OPTION("explain", NULL, 3,
                  "Say below a text table all that stands behind each row, not only a line each"),
     BENCH_IN(Options, explain)},
    {BENCH_OPTION("counters", NULL, 3,
                  "Add a table of what the processor counted in a step: cycles, instructions, "
                  "misses; csv, json and FILE.h5 always have it where it can be read (see info)"),
     BENCH_IN(Options, counters)},
    {BENCH_OUTPUT_OPTION(
         "FILE.h5", 3,
         "Also store every sample, counts, validity and provenance in HDF5 (default: nothing "
         "stored)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 3),
    {BENCH_OPTION(
         "columns", NULL, 4,
         "Measure nothing; list the columns of csv, json and FILE.h5 as results/README.md has "
         "them"),
     BENCH_IN(Options, columns)},
    {0},
};

static const char help[] =
    "Measure the scenes of a paper's table and set the paper's values beside them. Every scene is "
    "first checked on the very state that is timed: goal positions against double-precision brute "
    "force, the octree's against sums over its regions' leaves (at most 5e-5 of a cell off in "
    "single, 1e-10 in double precision), linear momentum (sum m g = sum m x to 1e-6 of sum m |x - "
    "centroid|), counts, and that everything is finite. Of a meshless body its shape functions, "
    "matrices, modes, and the frames that are timed; of a shell that breaks, which is played to "
    "its end three times, what it is then. A row that fails has INVALID in place of its times, one "
    "that other programs or the quota of a container left no undisturbed time has BUSY; what they "
    "took of the others is left out. --threads is of what is timed; meshes and checks take all "
    "cores.\v"
    "Times are medians over the repeats; the total is timed without clocks inside the step, stages "
    "are the shares of a run with clocks, interleaved. Of a shell that breaks they are of the "
    "steps "
    "that make cracks, with clocks inside; --repeats, --block and --counters mean nothing there. "
    "'faster' is the paper's total divided by "
    "the measured one, 'speed-up' the time of the table's first lattice row by the row's; csv and "
    "json call them 'ratio' and 'speedup'.\n" BENCH_EXIT_CODES;

/* Is it a built-in scene of the paper's for `row`, or, with NULL, for none, and does its name begin
 * with `stem` and a dash, unless that is NULL? */
static bool belongs(const char *name, const char *paper, const char *row, const char *stem)
{
    BenchScene scene;
    size_t length = stem ? strlen(stem) : 0;
    if (stem && (strncmp(name, stem, length) != 0 || name[length] != '-')) return false;
    if (bench_scene_find(name, &scene, NULL) || strcmp(scene.paper, paper) != 0) return false;
    return row ? !strcmp(scene.row, row) : !scene.row[0];
}

static void add_scene(Choices *chosen, const char *name, const char *stem)
{
    chosen->scene = sm_realloc(chosen->scene, (size_t)chosen->count + 1, sizeof *chosen->scene);
    chosen->scene[chosen->count++] = (Choice){name, stem, NULL};
}

/* The scenes of a paper's table whose names begin with `stem` and a dash, or all: in the order of
 * its rows, behind each those that only we have. */
static void add_scenes(Choices *chosen, const char *paper, const char *stem)
{
    int count;
    const RefPaperRow *rows = ref_paper_rows(&count);
    for (int i = 0; i < count; i++) {
        if (strcmp(rows[i].paper, paper) != 0) continue;
        for (const char *const *name = bench_scene_names(); *name; name++) {
            if (!belongs(*name, paper, rows[i].scene, stem)) continue;
            add_scene(chosen, *name, stem);
            for (const char *const *more = bench_scene_names(); *more; more++)
                if (belongs(*more, paper, NULL, *name)) add_scene(chosen, *more, stem);
        }
    }
}

/* Is it a built-in scene of the paper's? */
static bool of_paper(const char *name, const char *paper)
{
    BenchScene scene;
    return bench_scene_text(name, NULL) && !bench_scene_find(name, &scene, NULL) &&
           !strcmp(scene.paper, paper);
}

/* The tables that are regenerated when none is named. */
static void add_default(Choices *chosen)
{
    add_scenes(chosen, bench_papers[0], NULL);
    if (ref_solver_built)
        add_scenes(chosen, "meshless", NULL);
    else if (!chosen->options->common.quiet)
        fputs("shapebench tables: --paper meshless is left out: this program was built without "
              "CHOLMOD and ARPACK\n",
              stderr);
}

/* The scenes of the paper's table, or those that the names given stand for. */
static void choose_scenes(Choices *chosen)
{
    const Options *options = chosen->options;
    const char *paper = options->paper ? options->paper : bench_papers[0];
    for (int i = 0; i < options->given.count; i++) {
        const char *name = options->given.name[i];
        int before = chosen->count;
        add_scenes(chosen, paper, name);
        if (chosen->count > before && !of_paper(name, paper)) continue;
        chosen->count = before;
        add_scene(chosen, name, NULL);
    }
    if (!options->given.count && options->paper) add_scenes(chosen, paper, NULL);
    if (!options->given.count && !options->paper) add_default(chosen);
}

/* Each scene with every instruction set, one after the other. */
static void choose_sets(Choices *chosen)
{
    const Choice *once = chosen->scene;
    const BenchNames *isas = &chosen->options->common.isas;
    int scenes = chosen->count;
    *chosen = (Choices){.options = chosen->options};
    for (int i = 0; i < scenes; i++)
        for (int isa = 0; isa < isas->count; isa++) {
            add_scene(chosen, once[i].scene, once[i].stem);
            chosen->scene[chosen->count - 1].isa = isas->name[isa];
        }
    free((void *)once);
}

/* Fails where no scene is to be measured that `--mesh name=FILE` gives a mesh. */
static SmCode check_substitute(const Choices *chosen, const char *name, SmError *error)
{
    for (int i = 0; i < chosen->count; i++) {
        const Choice *choice = &chosen->scene[i];
        BenchScene scene;
        SmCode code = bench_scene_find(choice->scene, &scene, error);
        if (code) return code;
        if (!strcmp(scene.name, name) || (choice->stem && !strcmp(choice->stem, name)))
            return SM_OK;
    }
    return sm_fail(error, SM_USAGE, "--mesh: '%s' is not measured: name it with --scene %s", name,
                   name);
}

static SmCode check_substitutes(const Choices *chosen, SmError *error)
{
    const BenchSubstitutes *given = &chosen->options->chosen.substitutes;
    SmCode code = SM_OK;
    for (int i = 0; i < given->count && !code; i++)
        code = check_substitute(chosen, given->scene[i], error);
    return code;
}

static SmCode find_scene(const Options *options, const Choice *choice, BenchScene *scene,
                         SmError *error)
{
    SmCode code = bench_scene_find(choice->scene, scene, error);
    if (!code) bench_override_apply(&options->chosen, scene);
    return code;
}

/* Rows of several instruction sets have names of their own. */
static void name_set(const Options *options, const Choice *choice, BenchScene *scene)
{
    if (options->common.isas.count > 1)
        sm_append(scene->name, sizeof scene->name, "-%s", choice->isa);
}

/* Names the rows (row_report.h), table after table; fails where a scene is not there. */
static SmCode plan_rows(Choices *chosen, BenchRow *rows, SmError *error)
{
    Choice *ordered = sm_alloc((size_t)chosen->count, sizeof *ordered);
    int planned = 0;
    SmCode code = SM_OK;
    for (int table = BENCH_TABLE_LATTICES; table <= BENCH_TABLE_SHELLS; table++)
        for (int i = 0; i < chosen->count && !code; i++) {
            BenchScene scene;
            BenchRow row = {0};
            code = find_scene(chosen->options, &chosen->scene[i], &scene, error);
            if (code) break;
            name_set(chosen->options, &chosen->scene[i], &scene);
            bench_row_name(&scene, &row);
            if ((int)bench_row_table(&row) != table) continue;
            ordered[planned] = chosen->scene[i];
            rows[planned++] = row;
        }
    free(chosen->scene);
    chosen->scene = ordered;
    return code;
}

static SmCode measure_scene(const Options *options, const Choice *choice, BenchProgress *progress,
                            BenchRow *row, SmError *error)
{
    const BenchOverride *chosen = &options->chosen;
    BenchScene scene;
    const SmEngineType *type;
    SmCode code = find_scene(options, choice, &scene, error);
    if (!code) code = sm_isa_use(choice->isa, error);
    if (code) return code;
    code = bench_engine_find(scene.engine, chosen->precision, &type, error);
    if (code) return code;
    BenchBody body;
    const char *substitute = bench_substitute_find(&chosen->substitutes, scene.name);
    if (!substitute && choice->stem)
        substitute = bench_substitute_find(&chosen->substitutes, choice->stem);
    name_set(options, choice, &scene);
    bench_progress_show(progress, scene.name, 0);
    int team = sm_team_enter(sm_cores("")); /* meshes and checks are not timed */
    code = bench_body_of_scene(&scene, substitute, &body, error);
    BenchMeasureParams params = {.repeats = options->repeats,
                                 .block_seconds = options->block / 1e3,
                                 .threads = options->common.threads,
                                 .seed = options->common.seed,
                                 .checked = options->checked,
                                 .progress = progress};
    if (!code) {
        code = bench_measure(&scene, &body, type, &params, row, error);
        bench_body_free(&body);
    }
    sm_team_leave(team);
    return code;
}

/* Speed-ups of the octree paper's rows over their lattices. Returns how many of the rows measured
 * are complete: a row waits for a lattice that is still to come. */
static int compare_rows(BenchRow *rows, int measured, int count)
{
    int complete = 0;
    bool waits = false;
    for (int i = 0; i < measured; i++) {
        if (bench_engine(rows[i].paper)->sampled) {
            const BenchRow *lattice = bench_row_lattice(rows, measured, &rows[i]);
            if (lattice) rows[i].speedup = lattice->total_ms / rows[i].total_ms;
            for (int l = measured; l < count && !lattice; l++)
                waits |= bench_row_measures(&rows[l], &rows[i]);
        }
        if (!waits) complete = i + 1;
    }
    return complete;
}

/* Rows are written as they are measured; those before an error stay. */
static SmCode measure_all(const Choices *chosen, BenchRow *rows, BenchTable *table, SmError *error)
{
    const Options *options = chosen->options;
    BenchProgress progress;
    bench_progress_start(&progress, options->common.quiet);
    SmCode code = SM_OK;
    int measured = 0;
    while (measured < chosen->count && !code) {
        bench_progress_part(&progress, measured, chosen->count);
        code = measure_scene(options, &chosen->scene[measured], &progress, &rows[measured], error);
        bench_progress_stop(&progress);
        if (!code) bench_table_rows(table, compare_rows(rows, ++measured, chosen->count));
    }
    if (code && table->format == BENCH_AS_JSON) return code;
    bench_table_rows(table, measured);
    bench_table_end(table);
    return code;
}

static SmCode verdict(const BenchRow *rows, int count, SmError *error)
{
    for (int i = 0; i < count; i++)
        if (!rows[i].valid)
            return sm_fail(error, SM_INVALID, "%s is INVALID: %s", rows[i].scene, rows[i].reason);
    return SM_OK;
}

static void warn_of_counters(const Options *options, const char *program)
{
    char why[160];
    if (options->counters && !options->common.quiet && !bench_counters_there(sizeof why, why))
        fprintf(stderr, "%s: --counters: none can be read: %s\n", program, why);
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    Choices chosen = {.options = options};
    if (options->columns) {
        bench_quantities_document(stdout);
        return SM_OK;
    }
    choose_scenes(&chosen);
    choose_sets(&chosen);
    SmCode code = check_substitutes(&chosen, error);
    BenchRow *rows = sm_alloc((size_t)chosen.count, sizeof *rows);
    if (!code) code = bench_draft_reserve(options->output, options->overwrite, error);
    if (!code) code = plan_rows(&chosen, rows, error);
    if (!code) warn_of_counters(options, argv[0]);
    BenchMachine machine;
    bench_command_machine(&options->common, argc, argv, &machine);
    BenchTable table = {.format = options->format,
                        .explain = options->explain,
                        .report = {.file = stdout,
                                   .rows = rows,
                                   .count = chosen.count,
                                   .machine = &machine,
                                   .counters = options->counters}};
    if (!code) code = measure_all(&chosen, rows, &table, error);
    if (!code && options->output)
        code = bench_store_rows(options->output, rows, chosen.count, &machine, error);
    if (!code) code = verdict(rows, chosen.count, error);
    bench_rows_free(rows, chosen.count);
    free(chosen.scene);
    return code;
}

static const Options defaults = {.repeats = 15, .block = 20};

const BenchCommand bench_command_tables = {
    .name = "tables",
    .summary = "measure a paper's table, checked, its values beside",
    .line = {settings, BENCH_TAKES_ALL | BENCH_TAKES_SETS, NULL, help,
             .limit = "Scenes are named with --scene"},
    .size = sizeof(Options),
    .defaults = &defaults,
    .perform = perform,
};
