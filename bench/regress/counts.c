#include "counts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../scene/scene.h"
#include "../system/process.h"

enum { PATH = BENCH_DRAFT_PATH, WORDS = 32 };

typedef struct {
    const char *name;
    int few, least; /* steps of the shorter run, and at least as many again of the longer one */
} Tool;

static const Tool counter = {"perf_event", 20, 100}, callgrind = {"callgrind", 4, 8};

/* Particles times steps that the runs differ by: some 10^8 instructions, beside which those of
 * loading the program, which depend on its addresses, are nothing. */
static const double particle_steps = 2e6, most_steps = 1e4;

/* The line "... Collected : 123" of callgrind's; NaN: it has none. */
static double read_collected(const char *log)
{
    static const char words[] = "Collected :";
    char line[512];
    if (!bench_process_last_line(log, words, sizeof line, line)) return NAN;
    return strtod(strstr(line, words) + strlen(words), NULL);
}

/* Valgrind's reason why a program has died, in our words. */
static SmCode valgrind_failed(const char *log, int status, SmError *error)
{
    char line[256];
    if (bench_process_last_line(log, "SIGILL", sizeof line, line))
        return sm_fail(
            error, SM_INPUT,
            "this machine has no instruction counter for us, and Valgrind does not know all "
            "of its instructions: build with -DSHAPEBENCH_NATIVE=OFF and start that "
            "shapebench");
    bench_process_last_line(log, NULL, sizeof line, line);
    return sm_fail(error, SM_INPUT, "Valgrind ended with exit code %d: %.200s", status, line);
}

/* Instructions of one whole run. */
static SmCode count_run(const BenchAbRunner *runner, const Tool *tool, const BenchTask *task,
                        const char *program, int steps, double *count, SmError *error)
{
    char log[PATH], number[2][32];
    const char *word[WORDS];
    int words = 0;
    snprintf(log, sizeof log, "%.4000s/counts.txt", runner->folder);
    snprintf(number[0], 32, "%d", steps);
    snprintf(number[1], 32, "%lu", runner->seed);
    if (tool == &callgrind) {
        word[words++] = "valgrind";
        word[words++] = "--tool=callgrind";
        word[words++] = "--callgrind-out-file=/dev/null";
    }
    const char *const rest[] = {program,    "run",       task->scene, "--no-output", "--quiet",
                                "--frames", "1",         "--steps",   number[0],     "--seed",
                                number[1],  "--threads", "1"};
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++) word[words++] = rest[i];
    if (task->engine) word[words++] = "--engine", word[words++] = task->engine;
    if (task->precision) word[words++] = "--precision", word[words++] = task->precision;
    word[words] = NULL;
    BenchProcess process = {.word = word, .output = log, .count = tool == &counter};
    BenchProcessEnd end;
    SmError why;
    SmCode code = bench_process_run(&process, &end, &why);
    if (code)
        return sm_fail(
            error, code, "%.200s%s", why.text,
            tool == &callgrind && !bench_process_caught()
                ? ", and this machine has no instruction counter for us: install the package "
                  "valgrind"
                : "");
    *count = tool == &counter ? end.instructions : read_collected(log);
    if (end.status == SM_OK || end.status == SM_INVALID) return SM_OK;
    *count = NAN;
    if (tool == &callgrind) return valgrind_failed(log, end.status, error);
    char line[256];
    bench_process_last_line(log, NULL, sizeof line, line);
    return sm_fail(error, SM_INPUT, "%.60s cannot be simulated: %.200s", task->scene, line);
}

/* Instructions a step; NaN where the tool has no counter here. */
static SmCode count_step(const BenchAbRunner *runner, const Tool *tool, const BenchTask *task,
                         const char *program, long particles, double *count, SmError *error)
{
    double few, more;
    double steps = fmin(particle_steps / (double)(particles > 0 ? particles : 1), most_steps);
    int longer = tool->few + (int)fmax(steps, tool->least);
    *count = NAN;
    SmCode code = count_run(runner, tool, task, program, tool->few, &few, error);
    if (code || isnan(few)) return code;
    code = count_run(runner, tool, task, program, longer, &more, error);
    if (!code) *count = (more - few) / (longer - tool->few);
    return code;
}

/* The task to simulate for a scene: one that names it, or stands for it among others. */
static BenchTask task_of(const BenchAbRunner *runner, const BenchAbScene *samples)
{
    BenchTask task = {.scene = samples->scene};
    for (int t = 0; t < runner->tasks; t++) {
        BenchScene scene;
        if (bench_scene_find(runner->task[t].scene, &scene, NULL)) continue;
        if (!strcmp(scene.name, samples->scene)) task = runner->task[t];
    }
    return task;
}

/* Both builds of a scene, with one tool: the chosen one, or callgrind from where that has no
 * counter on. */
static SmCode count_scene(const BenchAbRunner *runner, const Tool **tool, const BenchTask *task,
                          BenchSide *side, SmError *error)
{
    for (;;) {
        bool counted = true;
        SmCode code = SM_OK;
        for (int b = 0; b < BENCH_BUILDS && !code && counted; b++) {
            code = count_step(runner, *tool, task, runner->program[b], side[b].row.particles,
                              &side[b].instructions, error);
            counted = !isnan(side[b].instructions);
        }
        if (code || counted || *tool == &callgrind) return code;
        *tool = &callgrind;
    }
}

SmCode bench_counts_take(const BenchAbRunner *runner, BenchAbSamples *all, const char **tool,
                         SmError *error)
{
    const Tool *chosen = &counter;
    SmCode code = SM_OK;
    for (int i = 0; i < all->count && !code; i++) {
        BenchSide *side = all->scenes[i].side;
        BenchTask task = task_of(runner, &all->scenes[i]);
        bench_progress_show(runner->progress, "counting instructions", (double)i / all->count);
        if (side[BENCH_OLD].count && side[BENCH_NEW].count)
            code = count_scene(runner, &chosen, &task, side, error);
    }
    bench_progress_stop(runner->progress);
    *tool = chosen->name;
    return code;
}
