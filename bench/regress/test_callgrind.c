/* Instructions a step, of two programs that stand for builds. */
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "callgrind.h"

/* A program whose start takes 10^5 rounds of a loop and each step WORK; with the step -1 it dies.
 */
static const char program[] =
    "#include <stdlib.h>\n#include <string.h>\n"
    "int main(int n, char **v) { long steps = 0; volatile long x = 0;\n"
    "for (int i = 1; i + 1 < n; i++) if (!strcmp(v[i], \"--steps\")) steps = atol(v[i + 1]);\n"
    "if (WORK < 0) __builtin_trap();\n"
    "for (long i = 0; i < 100000 + steps * WORK; i++) x += i;\n"
    "return n < 3 || strcmp(v[1], \"run\") ? 2 : 0; }\n";

static void compile(const char *name, long work)
{
    char command[512];
    write_text("program.c", program);
    snprintf(command, sizeof command, "cd %s && cc -O0 -DWORK='(%ldL)' program.c -o %s", folder,
             work, name);
    assert_int_equal(system(command), 0);
}

static void add(BenchAbSamples *all)
{
    double total = 1, stage[1][SM_STAGES] = {{1, 1, 1, 1, 1}};
    BenchRow row = {
        .scene = "penguin", .valid = true, .repeats = 1, .total = &total, .stage = stage};
    for (int b = 0; b < BENCH_BUILDS; b++) bench_ab_add(all, (BenchBuild)b, 0, &row);
}

static SmCode count(const char *old, const char *new, double counted[BENCH_BUILDS], SmError *error)
{
    char path[BENCH_BUILDS][256];
    BenchProgress progress = {0};
    BenchAbSamples all = {0};
    const BenchTask task = {.scene = "penguin"};
    snprintf(path[BENCH_OLD], 256, "%s", path_in(old));
    snprintf(path[BENCH_NEW], 256, "%s", path_in(new));
    const BenchAbRunner rounds = {.program = {path[BENCH_OLD], path[BENCH_NEW]},
                                  .task = &task,
                                  .tasks = 1,
                                  .folder = folder,
                                  .progress = &progress};
    add(&all);
    SmCode code = bench_callgrind_count(&rounds, &all, error);
    for (int b = 0; b < BENCH_BUILDS; b++) counted[b] = all.scenes[0].side[b].instructions;
    bench_ab_free(&all);
    return code;
}

TEST(a_step_is_counted_and_the_start_is_not)
{
    double counted[BENCH_BUILDS];
    SmError error;
    compile("old", 10000);
    compile("new", 10500);
    if (count("old", "new", counted, &error)) {
        assert_non_null(strstr(error.text, "install the package valgrind"));
        skip_because(error.text);
    }
    double each = counted[BENCH_OLD] / 10000; /* instructions of a round of the loop */
    assert_true(each > 3 && each < 20);
    assert_true(fabs(counted[BENCH_NEW] / counted[BENCH_OLD] - 1.05) < 0.001);
}

TEST(a_program_that_cannot_be_counted_is_a_line)
{
    double counted[BENCH_BUILDS];
    SmError error;
    compile("old", -1);
    assert_int_equal(count("old", "old", counted, &error), SM_INPUT);
    assert_true(isnan(counted[BENCH_OLD]));
    if (!strstr(error.text, "-DSHAPEBENCH_NATIVE=OFF") &&
        !strstr(error.text, "cannot be simulated") && !strstr(error.text, "valgrind"))
        fail_msg("%s", error.text);
}
