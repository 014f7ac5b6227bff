/* `shapebench regress` as a user runs it: baselines of all kinds, other revisions, what goes wrong.
 */
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../measure/measure.h"
#include "../table/row_store.h"

#define TINY "--scene tiny.cfg --repeats 5 --block 0.1 "

typedef struct {
    int code; /* exit code, or 1000 + signal */
    char out[16384], err[4096];
} Result;

static void slurp(const char *name, char *text, size_t room)
{
    FILE *file = fopen(path_in(name), "r");
    size_t size = file ? fread(text, 1, room - 1, file) : 0;
    text[size] = '\0';
    if (file) fclose(file);
}

/* Runs a command line in the test's folder, where `shapebench` is the program. */
static void run(const char *line, Result *result)
{
    char command[4096];
    snprintf(command, sizeof command,
             "cd %s && export TMPDIR=\"$PWD/scratch\" && shapebench() { '%s/shapebench' \"$@\"; }; "
             "(%s) >out 2>err",
             folder, BINARY_DIR, line);
    int status = system(command);
    result->code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    slurp("out", result->out, sizeof result->out);
    slurp("err", result->err, sizeof result->err);
}

static void expect(const char *line, int code, const char *wanted)
{
    Result result;
    run(line, &result);
    if (result.code != code || !(strstr(result.err, wanted) || strstr(result.out, wanted)))
        fail_msg("%s: exit code %d (wanted %d, '%s')\n%s%s", line, result.code, code, wanted,
                 result.out, result.err);
    char *newline = strchr(result.err, '\n');
    if (newline && newline[1]) fail_msg("%s: more than a line:\n%s", line, result.err);
}

/* A results file with a row of the tiny scene as it would be measured here, changed by the caller.
 */
static void row_of_tiny(BenchRow *row, BenchMachine *machine)
{
    static char *words[] = {"shapebench", "tables"};
    BenchRow *rows;
    int count;
    SmError error;
    char path[256];
    snprintf(path, sizeof path, "%s", path_in("tiny.h5"));
    assert_int_equal(bench_store_load(path, &rows, &count, machine, &error), SM_OK);
    assert_int_equal(count, 1);
    *row = rows[0];
    free(rows); /* its samples are the row's now */
    bench_machine_read(2, words, 1, machine);
}

static void store(const char *name, BenchRow *row, const BenchMachine *machine)
{
    SmError error;
    assert_int_equal(bench_store_rows(path_in(name), row, 1, machine, &error), SM_OK);
}

static int set_up(void **state)
{
    Result result;
    if (make_folder(state)) return -1;
    write_text("tiny.cfg",
               "mesh = \"shape:block\"; particles = 64; w = 1; engine = \"brute\"; bend = 0.3;\n");
    write_text("noise.h5", "no HDF5 at all\n");
    run("mkdir scratch && shapebench tables " TINY "-o tiny.h5", &result);
    return result.code;
}

TEST(usage)
{
    expect("shapebench regress", 2, "compare what?");
    expect("shapebench regress --baseline a --revision b", 2, "compare what?");
    expect("shapebench regress --baseline a --by instructions", 2, "not one of time, cycles");
    expect("shapebench regress --baseline a --paper octree", 2, "--paper: a file has its own");
    expect("shapebench regress --baseline a --format pdf", 2, "'pdf' is not one of text, markdown");
    expect("shapebench regress --baseline a --threshold x", 2, "--threshold: 'x'");
    expect("shapebench regress --baseline a --rounds 0", 2, "--rounds: '0'");
    expect("shapebench regress a.h5", 2, "a.h5: with which file?");
    expect("shapebench regress a.h5 b.h5 c.h5", 2, "what is 'c.h5'? Two files are compared");
    expect("shapebench regress a.h5 b.h5 --revision x", 2, "compare what?");
    expect("shapebench regress a.h5 b.h5 --rounds 3", 2, "files are compared as they are");
    expect("shapebench regress --help", 0, "6 no baseline");
    expect("shapebench regress --help | tr '\\n' ' '", 0, "7 no verdict on any time");
}

TEST(files_that_are_no_baseline)
{
    BenchRow row;
    BenchMachine machine;
    row_of_tiny(&row, &machine);
    BenchMachine alien = machine;
    strcpy(alien.cpu, "Another 9000");
    store("alien.h5", &row, &alien);
    alien = machine; /* of the same name */
    strcpy(alien.cpu_model, "AuthenticAMD family 25 model 17 stepping 1, elsewhere");
    store("family.h5", &row, &alien);
    alien = machine;
    alien.l3_bytes = 2 * machine.l3_bytes + 1024;
    store("cache.h5", &row, &alien);
    alien = machine;
    strcpy(alien.cpu_instructions, "sse");
    store("instructions.h5", &row, &alien);
    expect("shapebench regress --baseline missing.h5", 6, "there is no missing.h5");
    expect("shapebench regress --baseline noise.h5", 3, "not an HDF5 file, or cut off");
    expect("head -c 3000 tiny.h5 >cut.h5; shapebench regress --baseline cut.h5", 3, "cut.h5");
    expect("shapebench regress --baseline alien.h5", 6, "another machine (Another 9000; this is ");
    expect("shapebench regress --baseline family.h5", 6,
           "family 25 model 17 stepping 1, elsewhere; ");
    expect("shapebench regress --baseline instructions.h5", 6, "(instructions sse; this is ");
    if (machine.l3_bytes) expect("shapebench regress --baseline cache.h5", 6, "(an L3 cache of ");
    expect(
        "shapebench run tiny.cfg --frames 1 --quiet -o x.vtkhdf >x; shapebench regress --baseline "
        "x.vtkhdf",
        3, "not a shapebench results file");
    bench_row_free(&row);
}

/* Changes the file by h5py: another schema, things that are missing. */
static void alter(const char *name, const char *python)
{
    char command[1024];
    snprintf(command, sizeof command,
             "cd %s && cp tiny.h5 %s && /usr/bin/python3 -c 'import h5py\nf = h5py.File(\"%s\", "
             "\"r+\")\nr = f[\"rows/000\"]\n%s'",
             folder, name, name, python);
    assert_int_equal(system(command), 0);
}

TEST(files_of_other_schemas)
{
    needs_python("h5py");
    alter("newer.h5", "f.attrs.modify(\"schema\", 99)");
    expect("shapebench regress --baseline newer.h5 " TINY, 3, "its schema is 99 and this program");
    alter("bare.h5", "del r[\"total\"]");
    expect("shapebench regress --baseline bare.h5 " TINY, 3, "row 000: dataset 'total' is missing");
    alter("zero.h5", "r[\"total\"][0] = 0");
    expect("shapebench regress --baseline zero.h5 " TINY, 3, "dataset 'total' holds 0 s");
    alter("many.h5", "f.attrs.modify(\"rows\", 2)");
    expect("shapebench regress --baseline many.h5 " TINY, 3, "group '001' is missing");
    alter("old.h5",
          "f.attrs.modify(\"schema\", 1)\n"
          "for k in list(r.attrs):\n"
          "  if k not in (\"scene\", \"valid\", \"repeats\", \"stages\"): del r.attrs[k]\n"
          "for k in list(f[\"machine\"].attrs): del f[\"machine\"].attrs[k]\n");
    BenchRow *rows;
    BenchMachine machine;
    SmError error;
    int count;
    assert_int_equal(bench_store_load(path_in("old.h5"), &rows, &count, &machine, &error), SM_OK);
    assert_int_equal(count, 1);
    assert_string_equal(rows[0].scene, "tiny");
    assert_int_equal(rows[0].particles, 0);
    assert_string_equal(machine.cpu, "unknown");
    bench_rows_free(rows, count);
    expect("shapebench regress --baseline old.h5 --threshold 5 --rounds 3 " TINY, 0,
           "Against old.h5");
}

TEST(beside_a_stored_file)
{
    BenchRow row;
    BenchMachine machine;
    row_of_tiny(&row, &machine);
    expect("shapebench regress --baseline tiny.h5 --threshold 9 --rounds 3 " TINY, 0,
           "not slower in ");
    expect("shapebench regress --baseline tiny.h5 --rounds 1 " TINY, 7, "at least --rounds 3\n");
    expect("shapebench regress --baseline none.h5 " TINY, 6,
           "shapebench tables --repeats 201 --block 0.5 -o FILE.h5\n");
    row.particles = 63;
    store("other.h5", &row, &machine);
    expect("shapebench regress --baseline other.h5 --rounds 1 " TINY, 6,
           "other work: particles 63, now 64");
    row.particles = 64;
    strcat(row.settings, "octree.levels = 3; ");
    store("other.h5", &row, &machine);
    expect("shapebench regress --baseline other.h5 --rounds 1 " TINY, 6,
           "other work: octree.levels = 3, now the default");
    strcpy(row.settings, "particles = 64; engine = brute; bend = 0.3; ");
    store("other.h5", &row, &machine);
    expect("shapebench regress --baseline other.h5 --rounds 1 " TINY, 6,
           "other work: w = the default, now 1");
    row.valid = false;
    strcpy(row.reason, "goals are off");
    store("invalid.h5", &row, &machine);
    expect("shapebench regress --baseline invalid.h5 --rounds 1 " TINY, 1,
           "INVALID: tiny: the baseline: goals are off");
    bench_row_free(&row);
    row_of_tiny(&row, &machine);
    for (int r = 0; r < row.repeats; r++) {
        row.total[r] /= 1000;
        for (int s = 0; s < SM_STAGES; s++) row.stage[r][s] /= 1000;
    }
    store("fast.h5", &row, &machine);
    expect("shapebench regress --baseline fast.h5 --rounds 4 --repeats 10 --threshold 1 " TINY, 5,
           "SLOWER in ");
    strcpy(row.scene, "gone");
    store("gone.h5", &row, &machine);
    expect("shapebench regress --baseline gone.h5 --rounds 1", 2, "cannot measure scene gone");
    expect("shapebench regress --baseline gone.h5 --rounds 1 " TINY, 6,
           "the baseline has no such scene");
    bench_row_free(&row);
}

TEST(two_files_side_by_side)
{
    BenchRow *rows, row;
    BenchMachine machine;
    SmError error;
    int count;
    row_of_tiny(&row, &machine);
    row.busy = false;
    store("few.h5", &row, &machine);
    bench_row_free(&row);
    expect("shapebench regress few.h5 few.h5", 7, "too few samples): take files with more repeats");
    expect("shapebench tables --scene tiny.cfg --repeats 20 --block 0.1 -o twenty.h5", 0, "tiny");
    assert_int_equal(bench_store_load(path_in("twenty.h5"), &rows, &count, &machine, &error),
                     SM_OK);
    row = rows[0];
    row.busy = false;
    for (int r = 0; r < row.repeats; r++) { /* the machine's other work is no matter of this test */
        row.total[r] = 1e-4 * (1 + 1e-3 * r);
        for (int s = 0; s < SM_STAGES; s++) row.stage[r][s] = row.total[r] / SM_STAGES;
    }
    store("old.h5", &row, &machine);
    expect("shapebench regress old.h5 old.h5", 0, "not slower in ");
    strcpy(machine.cpu, "Another 9000");
    strcpy(machine.isa, "other");
    strcpy(row.isa, "other");
    for (int r = 0; r < row.repeats; r++) row.total[r] *= 1.25;
    store("slow.h5", &row, &machine);
    Result result;
    run("shapebench regress old.h5 slow.h5 --threshold 0.1", &result);
    assert_int_equal(result.code, 5);
    assert_non_null(strstr(result.out, "slow.h5 against old.h5, as stored"));
    assert_non_null(strstr(result.out, "most in tiny total: 1.250 times (1.2"));
    assert_non_null(strstr(result.out, "processor differs: "));
    assert_non_null(strstr(result.out, "instruction set differs: "));
    expect("shapebench regress slow.h5 old.h5 --threshold 0.1", 0, "faster");
    for (int r = 0; r < row.repeats; r++) row.stage[r][SM_SHAPE_MATCHING] *= 4;
    store("stage.h5", &row, &machine);
    expect("shapebench regress old.h5 stage.h5 --threshold 0.1", 5, "most in tiny total: 1.250 ");
    expect("shapebench regress old.h5 stage.h5 --threshold 0.1", 5,
           "), of stages tiny shape_matching: 4.000 times\n");
    expect("shapebench regress old.h5 stage.h5 --threshold 0.3", 5,
           "tiny: total 25.0% slower, below the threshold of 30.0%\n");
    expect("shapebench regress old.h5 stage.h5 --threshold 0.3", 5, "most in tiny total: 1.250 ");
    expect("shapebench regress old.h5 slow.h5 --scene hand", 6, "neither file has the scene hand");
    expect("shapebench regress old.h5 slow.h5 --format json", 5, "\"stored\": \"slow.h5\"");
    expect("shapebench regress old.h5 old.h5 --scene tiny.cfg", 0, "not slower in ");
    row.busy = true;
    store("busy.h5", &row, &machine);
    expect("shapebench regress old.h5 busy.h5", 6, "this build has no such scene: it is BUSY");
    expect("shapebench regress busy.h5 old.h5", 6, "the baseline has no such scene: it is BUSY");
    row.valid = false;
    strcpy(row.reason, "goals are off");
    store("wrong.h5", &row, &machine);
    expect("shapebench regress old.h5 wrong.h5", 1, "INVALID: tiny: this build: goals are off");
    bench_rows_free(rows, count);
}

/* A file with two engines' rows of one scene is measured with both, and each is beside its own. */
TEST(engines_of_one_scene_are_apart)
{
    BenchRow rows[2];
    BenchMachine machine;
    SmError error;
    Result result;
    row_of_tiny(&rows[0], &machine);
    expect("shapebench tables --engine fastlsm " TINY "-o lattice.h5", 0, "tiny");
    BenchRow *lattice;
    int count;
    assert_int_equal(
        bench_store_load(path_in("lattice.h5"), &lattice, &count, &(BenchMachine){0}, &error),
        SM_OK);
    if (rows[0].busy || lattice[0].busy) {
        bench_row_free(&rows[0]);
        bench_rows_free(lattice, count);
        skip_because("other programs take the processors");
    }
    rows[1] = lattice[0];
    assert_int_equal(bench_store_rows(path_in("two.h5"), rows, 2, &machine, &error), SM_OK);
    for (int named = 0; named < 2; named++) {
        run(named ? "shapebench regress --baseline two.h5 --threshold 9 --rounds 3 " TINY
                  : "shapebench regress two.h5 two.h5",
            &result);
        bool busy = result.code == 5 || result.code == 7; /* or others had its processors */
        assert_true(named ? result.code == 0 || busy : result.code == 7);
        assert_non_null(strstr(result.out, "tiny (brute, double)"));
        assert_non_null(strstr(result.out, "tiny (fastlsm, single)"));
        assert_null(strstr(result.out, "no such scene"));
    }
    bench_row_free(&rows[0]);
    bench_rows_free(lattice, count);
}

/* Where there are none, that is a line; a file may hold none. */
TEST(counters_or_why_not)
{
    char why[160];
    bool there = bench_counters_there(sizeof why, why);
    if (!there)
        expect("shapebench regress --baseline tiny.h5 --by cycles " TINY, 7,
               "--by cycles: none can be read: ");
    BenchRow row;
    BenchMachine machine;
    row_of_tiny(&row, &machine);
    free(row.counter);
    row.counter = NULL;
    row.cycles = row.instructions = NAN;
    store("uncounted.h5", &row, &machine);
    if (there)
        expect("shapebench regress --baseline uncounted.h5 --by cycles " TINY, 6,
               "no baseline: uncounted.h5 holds no cycles");
    expect("shapebench regress --baseline uncounted.h5 --threshold 9 --rounds 3 --counters " TINY,
           0,
           there ? "no counters: uncounted.h5 or this build has none"
                 : "no counters can be read here: ");
    if (there)
        expect("shapebench regress --baseline tiny.h5 --by cycles --threshold 9 --rounds 3 " TINY,
               0, "not slower in 1 of 1 scenes");
    bench_row_free(&row);
}

TEST(places_that_cannot_be_written)
{
    expect("shapebench regress --baseline tiny.h5 -o no/such/out.txt", 4, "no/such/out.txt");
    expect("TMPDIR=/no/such shapebench regress --baseline tiny.h5", 4, "cannot write /no/such/");
    expect("shapebench regress --baseline tiny.h5 --rounds 3 --threshold 9 " TINY "> /dev/full", 4,
           "standard output cannot be written");
    expect("shapebench regress --baseline tiny.h5 --rounds 1 " TINY "--format json -o out.json", 7,
           "");
    assert_int_equal(access(path_in("out.json"), F_OK), 0);
}

/* A repository whose CMakeLists.txt is this. */
static void make_repository(const char *cmake)
{
    write_text("CMakeLists.txt", cmake);
    write_text("program.c", "#include <stdlib.h>\n#include <unistd.h>\n"
                            "int main(int n, char **v) { (void)n;\n"
                            "if (getenv(\"UNCOUNTED\")) unsetenv(\"LD_PRELOAD\");\n"
                            "return getenv(\"FAIL\") ? atoi(getenv(\"FAIL\")) : execv(\"" BINARY_DIR
                            "/shapebench\", v); }\n");
    Result result;
    run("rm -rf repo && mkdir repo && mv CMakeLists.txt program.c repo && cp tiny.cfg repo && cd "
        "repo "
        "&& git init -q && git add . && git -c user.name=t -c user.email=t@t commit -qm t",
        &result);
    if (result.code) fail_msg("%s", result.err);
}

/* Its optional MPI is there by half. */
static const char works[] = "cmake_minimum_required(VERSION 3.22)\nproject(p C)\n"
                            "if(NOT CMAKE_DISABLE_FIND_PACKAGE_MPI)\nmessage(FATAL_ERROR \"MPI "
                            "without headers\")\nendif()\n"
                            "add_executable(shapebench program.c)\n";

static void nothing_is_left_in_the_repository(void)
{
    expect("cd repo && git worktree list | wc -l", 0, "1\n");
    expect("ls repo/build/regress | grep -c source", 1, "0\n");
    expect("ls scratch | grep -q shapebench", 1, "");
}

/* The other revision is a program that becomes this one. */
TEST(another_revision_is_built_and_measured)
{
    make_repository(works);
    expect("cd repo && shapebench regress --revision HEAD --rounds 3 " TINY, 2,
           "one of 6 times: take at least --rounds 4");
    expect("ls repo", 0, "CMakeLists.txt\nprogram.c\ntiny.cfg"); /* nothing was built */
    expect("cd repo && shapebench regress --revision HEAD --threshold 9 --rounds 7 " TINY, 0,
           "Against revision HEAD (");
    nothing_is_left_in_the_repository();
    expect("cd repo && TMPDIR=/no/such shapebench regress --revision HEAD " TINY, 4,
           "cannot write /no/such/shapebench_");
    expect("cd repo && ls build/regress", 0, "lock"); /* and the program, which is used again: */
    expect("cd repo && FAIL=2 shapebench regress --revision HEAD --rounds 7 " TINY, 6,
           "the baseline has no such scene");
    expect("cd repo && FAIL=2 shapebench regress --revision HEAD --rounds 7 --format json " TINY
           "| grep -c '\"scene\":'",
           0, "1\n"); /* once, by its own name and not the file's */
    expect("cd repo && FAIL=139 shapebench regress --revision HEAD --rounds 7 " TINY, 1,
           "the baseline crashed on scene tiny.cfg (exit code 139)");
}

/* A library that has the kernel count the ns that a thread runs in place of what the processor
 * counts, which virtual machines lack. */
static const char clock_for_counters[] =
    "#define _GNU_SOURCE\n#include <dlfcn.h>\n#include <linux/perf_event.h>\n"
    "#include <stdarg.h>\n#include <sys/syscall.h>\n"
    "long syscall(long n, ...) {\n"
    "va_list v; long a[6]; va_start(v, n);\n"
    "for (int i = 0; i < 6; i++) a[i] = va_arg(v, long);\n"
    "struct perf_event_attr *e = (void *)a[0]; va_end(v);\n"
    "if (n == SYS_perf_event_open) e->type = PERF_TYPE_SOFTWARE, e->config = "
    "PERF_COUNT_SW_TASK_CLOCK;\n"
    "return ((long (*)(long, ...))dlsym(RTLD_NEXT, \"syscall\"))(n, a[0], a[1], a[2], a[3], a[4], "
    "a[5]); }\n";

#define COUNTING "LD_PRELOAD=\"$PWD/clock.so\" shapebench "

TEST(cycles_are_judged_where_they_can_be_read)
{
    BenchRow row;
    BenchMachine machine;
    Result result;
    write_text("clock.c", clock_for_counters);
    run("cc -shared -fPIC clock.c -o clock.so -ldl && " COUNTING "info", &result);
    if (!strstr(result.out, "counters      cycles instructions "))
        skip_because("nothing can be put before the kernel's counters here");
    expect(COUNTING "tables " TINY "--counters -o tiny.h5 --overwrite", 0, "branch misses\ntiny ");
    expect(COUNTING "regress --baseline tiny.h5 --by cycles --threshold 9 --rounds 3 " TINY, 0,
           "not slower in 1 of 1 scenes");
    row_of_tiny(&row, &machine);
    assert_true(row.cycles > 0 && row.counter[0][BENCH_CYCLES] > 0);
    for (int r = 0; r < row.repeats; r++) row.counter[r][BENCH_CYCLES] /= 1000;
    snprintf(machine.counters, sizeof machine.counters, "cycles");
    store("fast.h5", &row, &machine);
    expect(COUNTING "regress --baseline fast.h5 --by cycles --threshold 1 --rounds 4 " TINY, 5,
           "SLOWER in 1 of 1 scenes, most in tiny cycles: ");
    bench_row_free(&row);
    expect("cp clock.so repo; cd repo && UNCOUNTED=1 " COUNTING
           "regress --revision HEAD --by cycles --rounds 6 " TINY,
           6, "tiny: the baseline has no cycles"); /* of the test before, and built there */
}

TEST(revisions_that_cannot_be_had)
{
    expect("cd / && shapebench regress --revision HEAD", 3, "is in no git repository");
    make_repository("execute_process(COMMAND sh -c \"setsid -f sleep 20 >/dev/null 2>&1\")\n"
                    "message(FATAL_ERROR \"broken on purpose\")\n");
    expect("cd repo && shapebench regress --revision no-such", 3, "has no revision 'no-such'");
    expect("cd repo && shapebench regress --revision --help", 3, "has no revision '--help'");
    expect("cd repo && shapebench regress --revision HEAD", 3, "HEAD does not build: ");
    expect("flock -n repo/build/regress/lock true", 0, ""); /* what it started keeps no lock */
    nothing_is_left_in_the_repository();
    make_repository("cmake_minimum_required(VERSION 3.22)\nproject(p C)\n"
                    "add_custom_target(shapebench)\n");
    expect("cd repo && shapebench regress --revision HEAD", 3, "builds no program shapebench");
    make_repository("cmake_minimum_required(VERSION 3.22)\nproject(p C)\nadd_executable(shapebench "
                    "no.c)\n");
    expect("cd repo && shapebench regress --revision HEAD", 3, "HEAD does not build: ");
    nothing_is_left_in_the_repository();
}

static pid_t start_building(void)
{
    pid_t child = fork();
    if (child == 0) {
        if (chdir(path_in("repo")) || !freopen("../err", "w", stderr)) _exit(99);
        execl(BINARY_DIR "/shapebench", "shapebench", "regress", "--revision", "HEAD",
              (char *)NULL);
        _exit(99);
    }
    return child;
}

static void interrupt(pid_t child)
{
    int status;
    char said[4096];
    kill(child, SIGINT);
    waitpid(child, &status, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 130);
    slurp("err", said, sizeof said);
    assert_non_null(strstr(said, "interrupted; nothing is left behind"));
}

/* Waits until the command line finds something. */
static void wait_for(const char *command)
{
    for (int i = 0; i < 600 && system(command) != 0; i++) usleep(100000);
    if (system(command) != 0) fail_msg("nothing found: %s", command);
}

/* Ctrl-C in mid-build: what runs is stopped, the worktree goes, exit code 130. Of one that waits
 * for it to end, before: the build goes on. */
TEST(an_interrupt_leaves_nothing)
{
    char project[64], builds[64], waits[96]; /* the number tells it from those of other tests */
    snprintf(project, sizeof project, "execute_process(COMMAND sleep 47.%d)\n", getpid());
    snprintf(builds, sizeof builds, "pgrep -fx 'sleep 47.%d' >/dev/null", getpid());
    make_repository(project);
    pid_t first = start_building();
    wait_for(builds);
    pid_t second = start_building();
    snprintf(waits, sizeof waits, "pgrep -x flock -P \"$(pgrep -d , -P %d)\" >/dev/null 2>&1",
             second);
    wait_for(waits);
    interrupt(second);
    expect("cd repo && git worktree list | wc -l", 0, "2\n");
    expect("ls repo/build/regress/*.source/CMakeLists.txt", 0, "CMakeLists.txt");
    interrupt(first);
    assert_int_not_equal(system(builds), 0);
    expect("ls repo/build/regress | grep -vc lock", 1, "0\n");
    nothing_is_left_in_the_repository();
}

TEST_GROUP(set_up, remove_folder)
