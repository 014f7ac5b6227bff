#include "callgrind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../scene/scene.h"
#include "../system/process.h"

enum { PATH = BENCH_DRAFT_PATH, WORDS = 32 };

enum { FEW = 4, LEAST = 8 }; /* steps of the shorter run, and of the longer one at least more */

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
        return sm_fail(error, SM_INPUT,
                       "Valgrind does not know all of this processor's instructions: build with "
                       "-DSHAPEBENCH_NATIVE=OFF and start that shapebench");
    if (!bench_process_last_line(log, "shapebench run: ", sizeof line, line))
        bench_process_last_line(log, NULL, sizeof line, line);
    return sm_fail(error, SM_INPUT, "Valgrind ended with exit code %d: %.200s", status, line);
}

/* Instructions of one whole run. */
static SmCode count_run(const BenchAbRunner *runner, const BenchTask *task, const char *program,
                        int steps, double *count, SmError *error)
{
    char log[PATH], number[2][32];
    const char *word[WORDS];
    int words = 0;
    snprintf(log, sizeof log, "%.4000s/callgrind.txt", runner->folder);
    snprintf(number[0], 32, "%d", steps);
    snprintf(number[1], 32, "%lu", runner->seed);
    const char *const first[] = {"valgrind",
                                 "--tool=callgrind",
                                 "--callgrind-out-file=/dev/null",
                                 program,
                                 "run",
                                 task->scene,
                                 "--quiet",
                                 "--no-output",
                                 "--frames",
                                 "1",
                                 "--steps",
                                 number[0],
                                 "--seed",
                                 number[1],
                                 "--threads",
                                 "1"};
    for (size_t i = 0; i < sizeof first / sizeof *first; i++) word[words++] = first[i];
    if (task->engine) word[words++] = "--engine", word[words++] = task->engine;
    if (task->precision) word[words++] = "--precision", word[words++] = task->precision;
    word[words] = NULL;
    BenchProcess process = {.word = word, .output = log};
    BenchProcessEnd end;
    SmError why;
    SmCode code = bench_process_run(&process, &end, &why);
    if (code)
        return sm_fail(error, code, "%.200s%s", why.text,
                       bench_process_caught() ? "" : ": install the package valgrind");
    *count = read_collected(log);
    bool ended = end.status == SM_OK || end.status == SM_INVALID;
    if (ended && isfinite(*count)) return SM_OK;
    *count = NAN;
    if (ended) return sm_fail(error, SM_INPUT, "Valgrind has counted nothing in %.200s", program);
    return valgrind_failed(log, end.status, error);
}

/* Instructions a step. */
static SmCode count_step(const BenchAbRunner *runner, const BenchTask *task, const char *program,
                         long particles, double *count, SmError *error)
{
    double few, more;
    double steps = fmin(particle_steps / (double)(particles > 0 ? particles : 1), most_steps);
    int longer = FEW + (int)fmax(steps, LEAST);
    *count = NAN;
    SmCode code = count_run(runner, task, program, FEW, &few, error);
    if (!code) code = count_run(runner, task, program, longer, &more, error);
    if (!code) *count = (more - few) / (longer - FEW);
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
    if (samples->engine[0]) task.engine = samples->engine;
    if (samples->precision[0]) task.precision = samples->precision;
    return task;
}

SmCode bench_callgrind_count(const BenchAbRunner *runner, BenchAbSamples *all, SmError *error)
{
    SmCode code = SM_OK;
    const char *isa = getenv("SHAPEBENCH_ISA");
    bool hidden = isa && !strcmp(isa, "avx512"); /* Valgrind has no such processor */
    if (hidden) unsetenv("SHAPEBENCH_ISA");
    for (int i = 0; i < all->count && !code; i++) {
        BenchSide *side = all->scenes[i].side;
        BenchTask task = task_of(runner, &all->scenes[i]);
        bench_progress_show(runner->progress, "counting instructions", (double)i / all->count);
        bool both = side[BENCH_OLD].count && side[BENCH_NEW].count;
        for (int b = 0; b < BENCH_BUILDS && !code && both; b++)
            code = count_step(runner, &task, runner->program[b], side[b].row.particles,
                              &side[b].instructions, error);
    }
    bench_progress_stop(runner->progress);
    if (hidden) setenv("SHAPEBENCH_ISA", "avx512", 1);
    return code;
}
