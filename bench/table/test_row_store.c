#define _GNU_SOURCE
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../measure/measure.h"
#include "quantity.h"
#include "row_store.h"

enum { ROWS = 2, FRAMES = 7, REPEATS = 7 };

/* A different value in every field. */
static void fill_field(const BenchField *field, int number, char *value)
{
    const int whole = number;
    const long large = 123456789012 + number;
    const unsigned long long hash = 0xcbf29ce484222325ULL + (unsigned)number;
    const bool yes = number % 2;
    for (size_t i = 0; i < field->size / sizeof(double) && field->kind == BENCH_DOUBLE; i++) {
        const double real = number + (double)(i + 1) / 3;
        memcpy(value + i * sizeof real, &real, sizeof real);
    }
    if (field->kind == BENCH_INT) memcpy(value, &whole, sizeof whole);
    if (field->kind == BENCH_LONG) memcpy(value, &large, sizeof large);
    if (field->kind == BENCH_HASH) memcpy(value, &hash, sizeof hash);
    if (field->kind == BENCH_BOOL) memcpy(value, &yes, sizeof yes);
    if (field->kind == BENCH_TEXT) snprintf(value, field->size, "%d \"\xc3\xa9", number);
}

static void fill_samples(BenchRow *row, int seed)
{
    row->total = sm_alloc(REPEATS, sizeof *row->total);
    row->stage = sm_alloc(REPEATS, sizeof *row->stage);
    if (bench_row_counted(row)) row->counter = sm_alloc(REPEATS, sizeof *row->counter);
    for (int i = 0; i < REPEATS && row->counter; i++)
        for (int c = 0; c < BENCH_COUNTERS; c++) row->counter[i][c] = 1000 * i + c + seed;
    if (row->change.frames) row->change.time = sm_alloc(FRAMES, sizeof *row->change.time);
    for (int f = 0; f < row->change.frames; f++)
        for (int i = 0; i < BENCH_FRAME_PARTS; i++) row->change.time[f][i] = 1e-6 * (10 * f + i);
    for (int i = 0; i < REPEATS; i++) {
        row->total[i] = 1e-4 * (i + 1 + seed);
        for (int s = 0; s < SM_STAGES; s++) row->stage[i][s] = 1e-5 * (10 * i + s + seed);
    }
}

static void fill_row(BenchRow *row, int seed)
{
    memset(row, 0, sizeof *row); /* its padding, too */
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++) {
        const BenchField *field = &quantity[q].field;
        if (field->name && !quantity[q].elastic)
            fill_field(field, 1 + q + seed * count, (char *)row + field->offset);
    }
    row->repeats = REPEATS;
    row->change.frames = seed % 2 ? FRAMES : 0;
    if (seed % 2) row->cycles = row->instructions = row->cache_misses = row->branch_misses = NAN;
    row->paper_stage_ms[3] = NAN;
    memset(row->reason, 'r', sizeof row->reason - 1); /* the longest there can be */
    fill_samples(row, seed);
}

static void compare_rows(const BenchRow *a, const BenchRow *b)
{
    /* All but the pointers bit for bit: both records were zeroed, padding included. */
    BenchRow left, right;
    memcpy(&left, a, sizeof left);
    memcpy(&right, b, sizeof right);
    left.total = right.total = NULL;
    left.stage = right.stage = NULL;
    left.counter = right.counter = NULL;
    left.change.time = right.change.time = NULL;
    assert_memory_equal(&left, &right, sizeof left);
    assert_memory_equal(a->total, b->total, REPEATS * sizeof *a->total);
    assert_memory_equal(a->stage, b->stage, REPEATS * sizeof *a->stage);
    assert_true(!a->counter == !b->counter);
    if (a->counter) assert_memory_equal(a->counter, b->counter, REPEATS * sizeof *a->counter);
    if (a->change.frames)
        assert_memory_equal(a->change.time, b->change.time, FRAMES * sizeof *a->change.time);
}

static void fill_rows(BenchRow *rows, BenchMachine *machine)
{
    static char *arguments[] = {"shapebench", "tables", "--output", "it's a file", "", "x=1"};
    for (int i = 0; i < ROWS; i++) fill_row(&rows[i], i);
    bench_machine_read(6, arguments, 2, machine);
}

static SmCode store_file(const char *path, SmError *error)
{
    BenchRow rows[ROWS];
    BenchMachine machine;
    fill_rows(rows, &machine);
    SmCode code = bench_store_rows(path, rows, ROWS, &machine, error);
    for (int i = 0; i < ROWS; i++) bench_row_free(&rows[i]);
    return code;
}

static void write_file(const char *path)
{
    SmError error = {0};
    if (store_file(path, &error) != SM_OK) fail_msg("%s", error.text);
}

static void read_samples(BenchH5 *h5, hid_t group, BenchRow *row)
{
    const hsize_t stages[] = {REPEATS, SM_STAGES}, frames[] = {FRAMES, BENCH_FRAME_PARTS};
    row->total = sm_alloc(REPEATS, sizeof *row->total);
    row->stage = sm_alloc(REPEATS, sizeof *row->stage);
    bench_h5_read(h5, bench_h5_find_dataset(h5, group, "total", 1, stages), H5T_NATIVE_DOUBLE,
                  row->total);
    bench_h5_read(h5, bench_h5_find_dataset(h5, group, "stage", 2, stages), H5T_NATIVE_DOUBLE,
                  row->stage);
    if (bench_row_counted(row)) {
        const hsize_t counters[] = {REPEATS, BENCH_COUNTERS};
        row->counter = sm_alloc(REPEATS, sizeof *row->counter);
        bench_h5_read(h5, bench_h5_find_dataset(h5, group, "counters", 2, counters),
                      H5T_NATIVE_DOUBLE, row->counter);
    }
    if (row->change.frames == 0) return;
    row->change.time = sm_alloc(FRAMES, sizeof *row->change.time);
    bench_h5_read(h5, bench_h5_find_dataset(h5, group, "frames", 2, frames), H5T_NATIVE_DOUBLE,
                  row->change.time);
}

/* All that the file holds. */
static void read_file(BenchH5 *h5, BenchRow *rows, int *count, BenchMachine *machine)
{
    int quantities;
    const BenchQuantity *quantity = bench_quantities(&quantities);
    const BenchField stored = BENCH_VARIABLE("rows", BENCH_INT, *count);
    bench_h5_check_kind(h5, "shapebench results", BENCH_STORE_SCHEMA, BENCH_STORE_SCHEMA);
    bench_h5_read_fields(h5, h5->file, &stored, 1, count);
    bench_machine_load(h5, machine);
    for (int i = 0; i < *count; i++) {
        char name[32];
        snprintf(name, sizeof name, "rows/%03d", i);
        hid_t group = bench_h5_find_group(h5, h5->file, name);
        for (int q = 0; q < quantities; q++)
            if (!quantity[q].elastic)
                bench_h5_read_fields(h5, group, &quantity[q].field, 1, &rows[i]);
        read_samples(h5, group, &rows[i]);
    }
}

static void read_back(const char *path, BenchRow *rows, int wanted, BenchMachine *machine)
{
    BenchH5 h5;
    int count = 0;
    memset(rows, 0, ROWS * sizeof *rows);
    memset(machine, 0, sizeof *machine);
    bench_h5_open(&h5, path);
    read_file(&h5, rows, &count, machine);
    if (!bench_h5_close(&h5)) fail_msg("%s", h5.message);
    assert_int_equal(count, wanted);
}

TEST(round_trip)
{
    const char *path = path_in("rows.h5");
    BenchRow rows[ROWS], expected[ROWS];
    BenchMachine machine, now;
    write_file(path);
    write_file(path); /* replaces */
    assert_int_equal(entries(""), 1);
    read_back(path, rows, ROWS, &machine);
    fill_rows(expected, &now);
    for (int i = 0; i < ROWS; i++) compare_rows(&rows[i], &expected[i]);
    memcpy(now.utc, machine.utc, sizeof now.utc);
    assert_memory_equal(&machine, &now, sizeof now);
    for (int i = 0; i < ROWS; i++) {
        bench_row_free(&rows[i]);
        bench_row_free(&expected[i]);
    }
    unlink(path);
}

/* One of the paper's numbers is misprinted; of the hand's, the rate is not from the paper. */
TEST(statuses_of_the_paper_are_stored)
{
    static const char *const cases[][5] = {
        {"fastlsm", "infant", "quoted", "quoted", "quoted damaged quoted quoted derived"},
        {"octree", "hand-regular", "derived", "second-hand", "quoted quoted quoted quoted quoted"},
    };
    static const char *const names[] = {"paper_total_status", "paper_rate_status",
                                        "paper_stage_status"};
    for (int c = 0; c < 2; c++) {
        BenchRow row;
        BenchMachine machine;
        BenchH5 h5;
        SmError error;
        char text[80];
        fill_row(&row, 0);
        strcpy(row.paper, cases[c][0]);
        strcpy(row.paper_row, cases[c][1]);
        bench_machine_read(0, NULL, 1, &machine);
        const char *path = path_in("status.h5");
        assert_int_equal(bench_store_rows(path, &row, 1, &machine, &error), SM_OK);
        bench_h5_open(&h5, path);
        hid_t group = bench_h5_find_group(&h5, h5.file, "rows/000");
        for (int n = 0; n < 3; n++) {
            bench_h5_read_text(&h5, group, names[n], sizeof text, text);
            assert_string_equal(h5.failed ? h5.message : text, cases[c][2 + n]);
        }
        typedef struct {
            double paper_stage_percent[SM_STAGES], paper_particles;
        } Given;
        Given given;
        const BenchField more[] = {BENCH_FIELD(Given, BENCH_DOUBLE, paper_stage_percent),
                                   BENCH_FIELD(Given, BENCH_DOUBLE, paper_particles)};
        bench_h5_read_fields(&h5, group, more, 2, &given);
        assert_true(c == 0
                        ? given.paper_stage_percent[0] == 10 && given.paper_stage_percent[1] == 19
                        : isnan(given.paper_stage_percent[0]));
        assert_true(given.paper_particles == (c == 0 ? 2570 : 35000));
        bench_h5_close(&h5);
        bench_row_free(&row);
        unlink(path);
    }
}

/* Deletes what files from before it was added lack. */
static void make_older(const char *path)
{
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t group = H5Gopen2(file, "rows/000", H5P_DEFAULT);
    assert_true(group >= 0);
    for (int q = 0; q < count; q++)
        if (quantity[q].later && quantity[q].field.name && !quantity[q].elastic)
            assert_true(H5Adelete(group, quantity[q].field.name) >= 0);
    assert_true(H5Ldelete(group, "counters", H5P_DEFAULT) >= 0);
    H5Gclose(group);
    H5Fclose(file);
}

TEST(older_files_are_read_without_what_they_lack)
{
    const char *path = path_in("older.h5");
    BenchRow row = {0};
    BenchH5 h5;
    for (int older = 0; older < 2; older++) {
        write_file(path);
        if (older) make_older(path);
        bench_h5_open(&h5, path);
        bench_store_read_row(&h5, bench_h5_find_group(&h5, h5.file, "rows"), 0, &row);
        if (!bench_h5_close(&h5)) fail_msg("%s", h5.message);
        assert_int_equal(row.repeats, REPEATS);
        assert_true(older ? isnan(row.cycles) && !row.isa[0] : row.cycles > 0 && row.isa[0]);
        assert_true(older ? !row.counter : row.counter[6][1] == 6001);
        bench_row_free(&row);
    }
    unlink(path);
}

TEST(no_rows)
{
    const char *path = path_in("none.h5");
    BenchRow rows[ROWS];
    BenchMachine machine;
    SmError error = {0};
    bench_machine_read(0, NULL, 1, &machine);
    assert_int_equal(bench_store_rows(path, NULL, 0, &machine, &error), SM_OK);
    read_back(path, rows, 0, &machine);
    unlink(path);
}

TEST(machine_is_described)
{
    static char *arguments[] = {"shapebench run", "a b", "it's", "", "plain-1.5"};
    BenchMachine machine;
    bench_machine_read(5, arguments, 3, &machine);
    assert_string_equal(machine.command, "shapebench run 'a b' 'it'\\''s' '' plain-1.5");
    assert_int_equal(machine.threads, 3);
    assert_true(strlen(machine.git_commit) == 40 || !strcmp(machine.git_commit, "unknown"));
    assert_non_null(strstr(machine.libraries, "HDF5 1."));
    assert_non_null(strstr(machine.kernel, "Linux"));
    assert_int_equal(strlen(machine.utc), strlen("2026-11-21T10:17:02Z"));
    char host[sizeof machine.hostname] = "";
    assert_int_equal(gethostname(host, sizeof host - 1), 0);
    assert_string_equal(machine.hostname, host);
    assert_true(strstr(machine.compiler, "GNU ") || strstr(machine.compiler, "Clang "));
    assert_in_range(machine.cores, 1, sysconf(_SC_NPROCESSORS_ONLN));
}

TEST(long_command_is_cut)
{
    static char word[3000], *arguments[] = {"shapebench", word};
    BenchMachine machine;
    memset(word, '\'', sizeof word - 1);
    bench_machine_read(2, arguments, 1, &machine);
    size_t length = strlen(machine.command);
    assert_in_range(length, sizeof machine.command - 16, sizeof machine.command - 1);
    assert_string_equal(machine.command + length - 3, "...");
}

/* Storing at `path` fails with `words` and leaves nothing. */
static void cannot_store(const char *path, const char *words)
{
    SmError error = {0};
    int before = entries("");
    assert_int_equal(store_file(path, &error), SM_OUTPUT);
    assert_non_null(strstr(error.text, path));
    if (!strstr(error.text, words)) fail_msg("'%s' does not say '%s'", error.text, words);
    assert_int_equal(entries(""), before);
}

TEST(unwritable_targets)
{
    const char *path = path_in("missing/rows.h5");
    cannot_store(path, "create the folder");
    cannot_store("/dev/null", "not a regular file");
    cannot_store(folder, "not a regular file");
    cannot_store("/proc/rows.h5", "no file can be made in that folder");
    cannot_store("/dev/null/rows.h5", "Not a directory");
}

/* Runs `body` in a child that may change its rights and limits; its asserts decide. */
static void in_child(void (*body)(void))
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        body();
        _exit(0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void store_in_locked_folder(void)
{
    const char *path = path_in("locked/rows.h5");
    BenchMachine machine;
    SmError error = {0};
    bench_machine_read(0, NULL, 1, &machine);
    if (geteuid() == 0 && setuid(65534) != 0) _exit(2);
    if (bench_store_rows(path, NULL, 0, &machine, &error) != SM_OUTPUT) _exit(3);
    if (!strstr(error.text, "a folder that you may write to")) _exit(4);
}

TEST(locked_folder)
{
    const char *path = path_in("locked");
    assert_int_equal(chmod(folder, 0755), 0);
    assert_int_equal(mkdir(path, 0555), 0);
    in_child(store_in_locked_folder);
    rmdir(path);
}

/* A size limit on files stands in for a full disk: the write fails at the same places. */
static void store_with_limits(void)
{
    const char *path = path_in("full.h5");
    signal(SIGXFSZ, SIG_IGN);
    struct stat status;
    if (store_file(path, NULL) != SM_OK || stat(path, &status) != 0) _exit(4);
    unlink(path);
    for (rlim_t limit = 0; limit < (rlim_t)status.st_size; limit += 512) {
        struct rlimit bound = {limit, RLIM_INFINITY};
        SmError error = {0};
        setrlimit(RLIMIT_FSIZE, &bound);
        if (store_file(path, &error) != SM_OUTPUT) _exit(2);
        if (!strstr(error.text, "size limit")) _exit(3);
    }
    struct rlimit none = {RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &none);
    if (store_file(path, NULL) != SM_OK) _exit(5);
}

TEST(full_disk)
{
    const char *path = path_in("full.h5");
    in_child(store_with_limits);
    BenchRow rows[ROWS];
    BenchMachine machine;
    assert_int_equal(entries(""), 1); /* the last one, and no drafts */
    read_back(path, rows, ROWS, &machine);
    for (int i = 0; i < ROWS; i++) bench_row_free(&rows[i]);
    unlink(path);
}
