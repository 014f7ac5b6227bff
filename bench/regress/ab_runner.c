#include "ab_runner.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../measure/measure.h"
#include "../system/process.h"
#include "../table/row_store.h"

enum { PATH = BENCH_DRAFT_PATH, WORDS = 32 };

/* What has become of a task. */
typedef struct {
    bool there[BENCH_BUILDS]; /* which builds have it, as far as is known */
    char checked[BENCH_BUILDS][sizeof((BenchRow *)0)->state_hash]; /* their state's, or empty */
    bool refused[BENCH_BUILDS]; /* the build cannot be told that */
    int processes;              /* so far */
    int repeats;                /* of further ones; 0: as the task says */
    char reason[224];           /* why the old one has not */
} State;

typedef struct {
    const BenchAbRunner *runner;
    BenchAbSamples *all;
    BenchMachine *machine;
    bool measured[BENCH_BUILDS]; /* `machine` is known */
    int done;                    /* processes */
} Session;

/* The words of a `tables` process; numbers are written into `number`. */
static void make_words(const BenchAbRunner *runner, const BenchTask *task, const State *state,
                       BenchBuild build, const char *output, char number[4][32],
                       const char *word[WORDS])
{
    int count = 0;
    const char *checked = state->checked[build][0] ? state->checked[build] : NULL;
    const struct {
        const char *option, *value;
    } option[] = {
        {"--paper", runner->paper}, {"--scene", task->scene},
        {"--engine", task->engine}, {"--precision", task->precision},
        {"--threads", number[0]},   {"--repeats", number[1]},
        {"--block", number[2]},     {"--seed", number[3]},
        {"--checked", checked},     {"-o", output},
    };
    snprintf(number[0], 32, "%d", task->threads > 0 ? task->threads : 1);
    snprintf(number[1], 32, "%d", state->repeats ? state->repeats : task->repeats);
    snprintf(number[2], 32, "%.6g", task->block);
    snprintf(number[3], 32, "%lu", runner->seed);
    word[count++] = runner->program[build];
    word[count++] = "tables";
    word[count++] = "--quiet";
    for (size_t i = 0; i < sizeof option / sizeof *option; i++) {
        if (!option[i].value) continue;
        word[count++] = option[i].option;
        word[count++] = option[i].value;
    }
    word[count] = NULL;
}

/* A scene that the old build cannot measure is no error: `state` keeps why. One that it could
 * measure before is. */
static SmCode failed(const BenchTask *task, BenchBuild build, int round, int status,
                     const char *log, State *state, SmError *error)
{
    char line[sizeof state->reason];
    bench_process_last_line(log, NULL, sizeof line, line);
    bool crashed = status > 128 || status == 127;
    if (build == BENCH_OLD && round == 0 && !crashed && status != SM_OUTPUT) {
        memcpy(state->reason, line, sizeof line);
        return SM_OK;
    }
    if (crashed)
        return sm_fail(error, SM_INVALID, "%s crashed on scene %.60s (exit code %d): %.200s",
                       bench_build_names[build], task->scene, status, line);
    SmCode code = status == SM_USAGE || status == SM_OUTPUT ? (SmCode)status : SM_INPUT;
    return sm_fail(error, code, "%s cannot measure scene %.60s: %.250s", bench_build_names[build],
                   task->scene, line);
}

/* The scenes of a task that the old build has not say why; a task may be a file, whose name is not
 * the scene's, or stand for several. */
static void say_why(const State *state, BenchAbScene *samples)
{
    BenchSide *old = &samples->side[BENCH_OLD];
    if (state->reason[0] && old->count == 0)
        snprintf(old->reason, sizeof old->reason, "%s", state->reason);
}

/* Of what is one row: its state; and, once both builds have had as many processes, how many repeats
 * fit, but where a file is compared with, which has as many as the task: of fewer the least is
 * larger. */
static void note_row(const BenchAbRunner *runner, const BenchTask *task, BenchBuild build,
                     const BenchRow *row, State *state)
{
    if (!row->valid || row->busy) return;
    if (!state->refused[build])
        memcpy(state->checked[build], row->state_hash, sizeof row->state_hash);
    if (!runner->program[BENCH_OLD] || state->repeats || state->processes % 2) return;
    double repeat = 2 * (row->steps + 2) * row->total_ms / 1e3;
    state->repeats = (int)fmin(fmax(BENCH_PROCESS_SECONDS / repeat, 15), task->repeats);
}

static SmCode keep(Session *session, const BenchTask *task, State *state, BenchBuild build,
                   int round, const char *path, SmError *error)
{
    BenchRow *rows;
    BenchMachine machine;
    int count;
    SmError why;
    SmCode code = bench_store_load(path, &rows, &count, &machine, &why);
    if (code)
        return sm_fail(error, code, "what %s has measured cannot be used: %.300s",
                       bench_build_names[build], why.text);
    for (int i = 0; i < count; i++) {
        bench_ab_add(session->all, build, round, &rows[i]);
        say_why(state, bench_ab_scene(session->all, &rows[i]));
        if (session->runner->by_cycles && rows[i].valid && !bench_row_counted(&rows[i]))
            state->there[BENCH_OLD] = state->there[BENCH_NEW] = false;
    }
    if (count == 1) note_row(session->runner, task, build, rows, state);
    bench_rows_free(rows, count);
    if (!session->measured[build]) session->machine[build] = machine;
    session->measured[build] = true;
    return SM_OK;
}

static SmCode run_process(Session *session, const BenchTask *task, BenchBuild build, int round,
                          State *state, SmError *error)
{
    const BenchAbRunner *runner = session->runner;
    char output[PATH], log[PATH], number[4][32];
    const char *word[WORDS];
    snprintf(output, sizeof output, "%.4000s/rows.h5", runner->folder);
    snprintf(log, sizeof log, "%.4000s/process.txt", runner->folder);
    make_words(runner, task, state, build, output, number, word);
    BenchProcess process = {.word = word, .output = log};
    BenchProcessEnd end;
    SmCode code = bench_process_run(&process, &end, error);
    if (code) return code;
    if (end.status == SM_USAGE && state->checked[build][0]) {
        state->refused[build] = true;
        state->checked[build][0] = 0;
        return run_process(session, task, build, round, state, error);
    }
    /* an INVALID row is stored before the process says so; a scene that cannot run stores nothing
     */
    state->processes++;
    bool there = (end.status == SM_OK || end.status == SM_INVALID) && access(output, F_OK) == 0;
    state->there[build] = there;
    code = there ? keep(session, task, state, build, round, output, error)
                 : failed(task, build, round, end.status, log, state, error);
    unlink(output);
    return code;
}

BenchBuild bench_ab_turn(int round, int turn)
{
    bool outer = turn == 0 || turn == BENCH_TURNS - 1;
    return outer == (round % 2 == 0) ? BENCH_OLD : BENCH_NEW;
}

static void show(const Session *session, const BenchTask *task, int all)
{
    bench_progress_show(session->runner->progress, task->scene, (double)session->done / all);
}

/* One round of one scene, of the builds that have it. */
static SmCode run_round(Session *session, const BenchTask *task, int round, State *state, int all,
                        SmError *error)
{
    SmCode code = SM_OK;
    for (int i = 0; i < BENCH_TURNS && !code; i++) {
        BenchBuild build = bench_ab_turn(round, i);
        show(session, task, all);
        session->done++;
        if (session->runner->program[build] && state->there[build])
            code = run_process(session, task, build, round, state, error);
    }
    return code;
}

SmCode bench_ab_run(const BenchAbRunner *runner, BenchAbSamples *all,
                    BenchMachine machine[BENCH_BUILDS], SmError *error)
{
    Session session = {.runner = runner, .all = all, .machine = machine};
    State *state = sm_alloc((size_t)runner->tasks, sizeof *state);
    for (int t = 0; t < runner->tasks; t++)
        state[t].there[BENCH_OLD] = state[t].there[BENCH_NEW] = true;
    SmCode code = SM_OK;
    for (int r = 0; r < runner->rounds; r++)
        for (int t = 0; t < runner->tasks && !code; t++)
            code = run_round(&session, &runner->task[t], r, &state[t],
                             BENCH_TURNS * runner->rounds * runner->tasks, error);
    bench_progress_stop(runner->progress);
    free(state);
    return code;
}
