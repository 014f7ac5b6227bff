#define _GNU_SOURCE
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/system/clock.h"
#include "../measure/measure.h"
#include "../regress/ab_runner.h"
#include "../regress/regression.h"
#include "../regress/revision.h"
#include "../scene/scene.h"
#include "../store/draft.h"
#include "../system/process.h"
#include "../system/statistic.h"
#include "../table/row_store.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    const char *baseline, *revision, *paper, *output;
    BenchNames scenes;
    int rounds, repeats;
    double block, threshold; /* ms; a share, NaN: auto */
    BenchRegressionFormat format;
    enum { BY_TIME, BY_CYCLES } by;
    bool counters, overwrite, quick;
} Options;

static void take_threshold(const struct argp_state *state, const char *text, void *member)
{
    const BenchSetting share = {.kind = BENCH_SET_REAL, .low = 0, .high = 10};
    SmError error;
    if (!strcmp(text, "auto"))
        *(double *)member = NAN;
    else if (bench_setting_text(&share, text, member, &error))
        bench_usage(state, "--threshold: %s", error.text);
}

static const BenchSetting settings[] = {
    {BENCH_OPTION(
         "baseline", "FILE.h5", 1,
         "Compare with times that 'tables --repeats 201 --block 0.5 -o' (or other samples) "
         "stored, on this machine"),
     BENCH_IN(Options, baseline)},
    {BENCH_OPTION(
         "revision", "REV", 1,
         "Compare with this git revision, built in a temporary worktree and run interleaved"),
     BENCH_IN(Options, revision)},
    {BENCH_PAPER_OPTION(Options, paper, "With --revision: the scenes of this paper's table",
                        "fastlsm")},
    {BENCH_OPTION("scene", "NAME|FILE", 1,
                  "Compare this scene only; may be repeated (default: all of the file, or of the "
                  "paper)"),
     BENCH_IN(Options, scenes)},
    {BENCH_OPTION("rounds", "N", 2,
                  "Rounds of two processes of each build and scene (default: 8 or as many as the "
                  "test needs, or 3 beside a file)"),
     BENCH_IN(Options, rounds), 1, 1000},
    {BENCH_OPTION("quick", NULL, 2,
                  "As few rounds as can show a difference, and a third of the repeats: sees what "
                  "is large"),
     BENCH_IN(Options, quick)},
    {BENCH_REPEATS_OPTION(Options, repeats, 10000,
                          " in a process (default: 201; beside a file as there)")},
    {BENCH_BLOCK_OPTION(Options, block, " (default: 0.5; beside a file as there)")},
    {BENCH_OPTION(
         "threshold", "auto|X", 2,
         "Differences up to X (0.05: 5%) are 'same' (default: auto, as the build differs from "
         "itself)"),
     BENCH_IN(Options, threshold), .take = take_threshold},
    {BENCH_OPTION("by", "time|cycles", 2,
                  "Judge times, or the cycles of a step, which other work on the machine hardly "
                  "touches, where info says that they can be read (default: time)"),
     BENCH_IN(Options, by), BENCH_ONE_OF("time", "cycles")},
    {BENCH_OPTION(
         "counters", NULL, 2,
         "Also compare what the processor counted in a step: cycles, instructions, misses"),
     BENCH_IN(Options, counters)},
    {BENCH_OPTION("format", "FORMAT", 3, "text, markdown or json (default: text)"),
     BENCH_IN(Options, format), BENCH_CHOICES(bench_regression_formats)},
    {BENCH_OUTPUT_OPTION("FILE", 3, "Write there (default: standard output)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 3),
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    int files = options->common.words;
    if (!options->baseline + !options->revision + !files != 2)
        bench_usage(state, "compare what? Say either --baseline FILE.h5, --revision REV, or two "
                           "files: OLD.h5 NEW.h5");
    if (files == 1) bench_usage(state, "%s: with which file?", options->common.word[0]);
    if (files && (options->rounds || options->repeats || options->block > 0))
        bench_usage(state, "--rounds, --repeats and --block say how to measure: files are compared "
                           "as they are");
    if ((options->baseline || files) && options->paper)
        bench_usage(state, "--paper: a file has its own scenes; choose of them with --scene");
}

static const char help[] =
    "Is this build slower than that one? Every scene is measured in fresh processes, each of which "
    "checks it first: what is INVALID is not compared. The sample is a process, its value the 2% "
    "quantile of its repeats, which other work on the machine hardly touches. A time is slower or "
    "faster where the ratio of lower quartiles is beyond the threshold, its 95% bootstrap interval "
    "does not hold 1, and Mann-Whitney's p, adjusted for all times that are compared, is below "
    "0.01. The threshold is what a build differs from itself by between processes of the same "
    "rounds, and at least 2%, of a stage also 0.5% of the step; beside a file, which cannot be run "
    "interleaved, it is wider, and at least 10%. Scenes of a file are measured with the engine, "
    "precision and threads that it says. With OLD.h5 and NEW.h5 nothing is measured: their repeats "
    "are the samples, of any two builds, machines or instruction sets; in a process repeats are "
    "more alike than processes are, so there, too, the threshold is at least 10%.\v"
    "A program of another revision is kept in build/regress, for next time.\n" BENCH_EXIT_CODES
    " Of regress alone: 5 slower; 6 no baseline for a scene, or a baseline of another machine; 7 "
    "no "
    "verdict on any time: all too noisy, too few samples, or --by cycles where they cannot be "
    "read.";

/* What one comparison holds. */
typedef struct {
    const Options *options;
    BenchProgress progress;
    BenchAbSamples all;
    BenchTask *task; /* [tasks] */
    int tasks, rounds;
    BenchRow *stored; /* rows of the file */
    int stored_count;
    BenchRevision revision;
    char folder[PATH_MAX], self[64];
    BenchRegression found;
    int verdict; /* exit code */
} Session;

static BenchTask *add_task(Session *session, const char *scene)
{
    session->task = sm_realloc(session->task, (size_t)session->tasks + 1, sizeof *session->task);
    session->task[session->tasks] = (BenchTask){.scene = scene};
    return &session->task[session->tasks++];
}

static const char *paper_of(const Options *options)
{
    return options->paper ? options->paper : bench_papers[0];
}

/* The built-in scenes that are set beside rows of the paper's table. */
static void paper_tasks(Session *session)
{
    const char *paper = paper_of(session->options);
    for (const char *const *name = bench_scene_names(); *name; name++) {
        BenchScene scene;
        if (bench_scene_find(*name, &scene, NULL) || strcmp(scene.paper, paper) != 0) continue;
        if (scene.row[0]) add_task(session, *name);
    }
}

/* As the row of the file was measured: as many repeats, of as many steps. */
static void task_of_row(const BenchRow *row, BenchTask *task)
{
    task->engine = row->engine[0] ? row->engine : NULL;
    task->precision = row->precision[0] ? row->precision : NULL;
    task->threads = row->threads;
    task->repeats = row->repeats;
    if (row->valid && row->steps > 0)
        task->block = 1e3 * bench_quantile(row->total, row->repeats, 0) * row->steps;
}

/* Is it the scene of this name, or of this file? */
static bool is_scene(const char *named, const char *scene)
{
    BenchScene found;
    if (!strcmp(named, scene)) return true;
    return !bench_scene_find(named, &found, NULL) && !strcmp(found.name, scene);
}

/* Is the task the row's, or not yet any row's? */
static bool fits(const BenchTask *task, const BenchRow *row)
{
    return (!task->engine || !strcmp(task->engine, row->engine)) &&
           (!task->precision || !strcmp(task->precision, row->precision));
}

/* The scenes named, or all of the file, with every engine and precision that it has of them. */
static void file_tasks(Session *session)
{
    const Options *options = session->options;
    for (int i = 0; i < session->stored_count; i++) {
        const BenchRow *row = &session->stored[i];
        const char *scene = options->scenes.count ? NULL : row->scene;
        bool there = false;
        for (int t = 0; t < session->tasks; t++) {
            BenchTask *task = &session->task[t];
            if (options->scenes.count ? !is_scene(task->scene, row->scene)
                                      : strcmp(task->scene, row->scene) != 0)
                continue;
            scene = task->scene;
            if (!fits(task, row)) continue;
            if (options->scenes.count) task_of_row(row, task);
            there = true;
        }
        if (!there && scene) task_of_row(row, add_task(session, scene));
    }
}

/* Which scenes, and how long. */
static void choose_tasks(Session *session)
{
    const Options *options = session->options;
    for (int i = 0; i < options->scenes.count; i++) add_task(session, options->scenes.name[i]);
    if (options->baseline)
        file_tasks(session);
    else if (!options->scenes.count)
        paper_tasks(session);
    for (int t = 0; t < session->tasks; t++) {
        BenchTask *task = &session->task[t];
        if (!task->threads) task->threads = options->common.threads;
        if (options->repeats || !task->repeats)
            task->repeats = options->repeats ? options->repeats : options->quick ? 67 : 201;
        if (options->block > 0 || !(task->block > 0))
            task->block = options->block > 0 ? options->block : 0.5;
        task->block = fmin(fmax(task->block, 0.001), 60000);
    }
}

/* Refuses, before anything is built, what could find nothing. */
static SmCode choose_rounds(Session *session, SmError *error)
{
    const Options *options = session->options;
    int times = session->tasks * (options->by == BY_CYCLES ? 1 : BENCH_TIMES);
    int least = bench_compare_rounds(times);
    session->rounds = options->rounds     ? options->rounds
                      : options->quick    ? least
                      : options->baseline ? 3
                                          : 8;
    if (options->baseline || session->rounds >= least) return SM_OK;
    if (!options->rounds) {
        session->rounds = least;
        return SM_OK;
    }
    return sm_fail(error, SM_USAGE,
                   "--rounds %d: so few cannot show a difference in one of %d times: take at least "
                   "--rounds %d, or fewer scenes",
                   options->rounds, times, least);
}

/* Has one of the file's rows cycles? */
static bool has_cycles(const Session *session)
{
    bool any = false;
    for (int i = 0; i < session->stored_count; i++) any |= bench_row_counted(&session->stored[i]);
    return any;
}

/* As --baseline's help says; the samples that tables takes otherwise are too few and too short. */
#define STORE "shapebench tables --repeats 201 --block 0.5 -o FILE.h5"

static SmCode load_baseline(Session *session, const BenchMachine *here, SmError *error)
{
    const char *path = session->options->baseline;
    BenchMachine *there = &session->found.machine[BENCH_OLD];
    if (access(path, F_OK) != 0 && errno == ENOENT)
        return sm_fail(error, (SmCode)BENCH_EXIT_NO_BASELINE,
                       "no baseline: there is no %.200s; store one with " STORE, path);
    SmCode code = bench_store_load(path, &session->stored, &session->stored_count, there, error);
    if (code) return code;
    snprintf(session->found.baseline, sizeof session->found.baseline, "%.200s", path);
    if (session->options->by == BY_CYCLES && !has_cycles(session))
        return sm_fail(error, (SmCode)BENCH_EXIT_NO_BASELINE,
                       "no baseline: %.200s holds no cycles; store one with " STORE, path);
    char differs[160];
    if (bench_machine_same(there, here, sizeof differs, differs)) return SM_OK;
    return sm_fail(error, (SmCode)BENCH_EXIT_NO_BASELINE,
                   "no baseline: %.150s was measured on another machine (%s): "
                   "store one here with " STORE,
                   path, differs);
}

static SmCode build_revision(Session *session, SmError *error)
{
    const char *name = session->options->revision;
    SmCode code =
        bench_revision_build(name, session->folder, &session->progress, &session->revision, error);
    snprintf(session->found.baseline, sizeof session->found.baseline, "revision %.100s (%.12s)",
             name, session->revision.commit);
    return code;
}

/* Is it one of the scenes named, or is none? */
static bool wanted(const Options *options, const char *scene)
{
    for (int i = 0; i < options->scenes.count; i++)
        if (is_scene(options->scenes.name[i], scene)) return true;
    return options->scenes.count == 0;
}

/* A stored file as a build of its own, every repeat a sample; times of a busy machine are none. */
static SmCode add_file(Session *session, BenchBuild build, SmError *error)
{
    BenchRow *rows;
    int count;
    SmCode code = bench_store_load(session->options->common.word[build], &rows, &count,
                                   &session->found.machine[build], error);
    if (code) return code;
    for (int i = 0; i < count; i++) {
        if (!wanted(session->options, rows[i].scene)) continue;
        BenchSide *side = &bench_ab_scene(&session->all, &rows[i])->side[build];
        if (rows[i].valid && rows[i].busy && session->options->by == BY_TIME)
            snprintf(side->reason, sizeof side->reason, "it is BUSY there");
        else
            bench_ab_add_repeats(&session->all, build, &rows[i]);
    }
    bench_rows_free(rows, count);
    return SM_OK;
}

/* Both files. A scene that is in neither is misspelt. */
static SmCode add_files(Session *session, SmError *error)
{
    const Options *options = session->options;
    BenchRegression *found = &session->found;
    SmCode code = add_file(session, BENCH_OLD, error);
    if (!code) code = add_file(session, BENCH_NEW, error);
    if (code) return code;
    for (int i = 0; i < options->scenes.count; i++) {
        bool there = false;
        for (int s = 0; s < session->all.count; s++)
            there |= is_scene(options->scenes.name[i], session->all.scenes[s].scene);
        if (!there)
            return sm_fail(error, (SmCode)BENCH_EXIT_NO_BASELINE,
                           "no baseline: neither file has the scene %.60s",
                           options->scenes.name[i]);
    }
    snprintf(found->baseline, sizeof found->baseline, "%.200s", options->common.word[BENCH_OLD]);
    snprintf(found->stored, sizeof found->stored, "%.200s", options->common.word[BENCH_NEW]);
    return SM_OK;
}

/* The stored rows of the scenes that were measured. */
static void add_stored(Session *session)
{
    int measured = session->all.count;
    for (int i = 0; i < session->stored_count; i++) {
        bool there = false;
        for (int c = 0; c < measured; c++)
            there |= !strcmp(session->all.scenes[c].scene, session->stored[i].scene);
        if (there) bench_ab_add(&session->all, BENCH_OLD, 0, &session->stored[i]);
    }
}

/* Are there counters in all scenes that both builds have? */
static bool counted(const Session *session)
{
    for (int i = 0; i < session->all.count; i++)
        for (int b = 0; b < BENCH_BUILDS; b++) {
            const BenchSide *side = session->all.scenes[i].side;
            if (side[!b].count && side[b].count &&
                !bench_side_has(&side[b], BENCH_TIMES + BENCH_INSTRUCTIONS))
                return false;
        }
    return true;
}

/* Shows counters, or says why there are none. */
static void show_counters(Session *session)
{
    BenchRegression *found = &session->found;
    char why[160];
    found->counters = true;
    if (counted(session)) return;
    if (!found->stored[0] && !bench_counters_there(sizeof why, why))
        bench_regression_remark(found, "no counters can be read here: %s", why);
    else
        bench_regression_remark(found, "no counters: %s or %s has none", found->baseline,
                                found->stored[0] ? found->stored : "this build");
}

static SmCode measure(Session *session, SmError *error)
{
    const Options *options = session->options;
    BenchRegression *found = &session->found;
    BenchAbRunner rounds = {
        .program = {options->revision ? session->revision.program : NULL, session->self},
        .paper = paper_of(options),
        .task = session->task,
        .tasks = session->tasks,
        .rounds = session->rounds,
        .seed = options->common.seed,
        .by_cycles = options->by == BY_CYCLES,
        .folder = session->folder,
        .progress = &session->progress};
    SmCode code = options->common.words
                      ? add_files(session, error)
                      : bench_ab_run(&rounds, &session->all, found->machine, error);
    if (code) return code;
    add_stored(session);
    if (options->counters) show_counters(session);
    bench_ab_finish(&session->all);
    return SM_OK;
}

static void print_found(FILE *file, const void *what)
{
    const Session *session = what;
    bench_regression_write(file, session->options->format, &session->found);
}

/* Measures, compares and writes. */
static SmCode compare(Session *session, SmError *error)
{
    const Options *options = session->options;
    BenchCompareParams params = {options->revision != NULL, session->rounds,
                                 options->threshold,        options->common.seed,
                                 options->by == BY_CYCLES,  options->common.words > 0};
    BenchRegression *found = &session->found;
    double start = sm_now();
    SmCode code = measure(session, error);
    if (code) return code;
    BenchComparison *list;
    found->count = bench_compare(&session->all, &params, &list);
    found->list = list;
    found->params = &params;
    found->seconds = sm_now() - start;
    bench_regression_environment(found);
    session->verdict = bench_comparisons_exit(list, found->count);
    if (options->output)
        code = bench_draft_write(options->output, print_found, session, error);
    else
        print_found(stdout, session);
    bench_comparisons_free(list, found->count);
    return code;
}

static SmCode check_cycles(SmError *error)
{
    char why[160];
    if (bench_counters_there(sizeof why, why)) return SM_OK;
    return sm_fail(error, (SmCode)BENCH_EXIT_NOT_JUDGED, "--by cycles: none can be read: %s", why);
}

static SmCode run(Session *session, const BenchMachine *here, SmError *error)
{
    const Options *options = session->options;
    bool files = options->common.words > 0;
    SmCode code = options->by == BY_CYCLES && !files ? check_cycles(error) : SM_OK;
    if (!code && files) return compare(session, error);
    if (!code && options->baseline) code = load_baseline(session, here, error);
    if (!code) choose_tasks(session);
    if (!code) code = choose_rounds(session, error);
    if (!code && options->revision) code = build_revision(session, error);
    return code ? code : compare(session, error);
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    BenchMachine here;
    bench_machine_read(argc, argv, options->common.threads, &here);
    Session *session = sm_alloc(1, sizeof *session);
    session->options = options;
    snprintf(session->self, sizeof session->self, "/proc/%ld/exe", (long)getpid());
    bench_process_catch();
    bench_progress_start(&session->progress, options->common.quiet);
    SmCode code = bench_draft_reserve(options->output, options->overwrite, error);
    if (!code) code = bench_scratch_make(session->folder, error);
    if (!code) {
        code = run(session, &here, error);
        bench_scratch_remove(session->folder);
    }
    bench_ab_free(&session->all);
    bench_rows_free(session->stored, session->stored_count);
    free(session->task);
    if (!code) code = (SmCode)session->verdict;
    free(session);
    int caught = bench_process_caught();
    return caught ? (SmCode)(128 + caught) : code;
}

static const Options defaults = {.threshold = NAN};

const BenchCommand bench_command_regress = {
    .name = "regress",
    .summary = "is this build slower than another one, or wrong?",
    .line = {settings, BENCH_TAKES_ALL, "[OLD.h5 NEW.h5]", help, check, .most = 2,
             .limit = "Two files are compared"},
    .size = sizeof(Options),
    .defaults = &defaults,
    .perform = perform,
};
