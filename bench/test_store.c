#define _GNU_SOURCE
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "../lib/test_folder.h"
#include "store.h"

enum { ROWS = 2, FRAMES = 7, REPEATS = 7, ROW_BYTES = 1504 };

/* A field new in row.h is to be stored (store.c), described (results/README.md) and filled here. */
_Static_assert(sizeof(BenchRow) == ROW_BYTES, "row.h has changed: see above");

/* Fills a record with a different number in every field that has one. */
static void fill_row(BenchRow *row, int seed)
{
    *row = (BenchRow){.triangles = 9874 + seed,
                      .particles = 150,
                      .regions = 130,
                      .instances = 3,
                      .w = 2,
                      .steps = 1000,
                      .epsilon = 0.125,
                      .h = 0.01,
                      .cell = 0.1 / 3,
                      .damping = 0.3,
                      .threads = 2,
                      .valid = seed % 2 == 0,
                      .goal_error = 1.5e-5,
                      .momentum_error = 2e-9,
                      .goal_tolerance = 5e-5,
                      .repeats = REPEATS,
                      .total_ms = 0.28,
                      .total_low_ms = 0.27,
                      .total_high_ms = 0.29,
                      .instruments_percent = 4.5,
                      .ns_per_particle_step = 50.25,
                      .voxelise_seconds = 0.002,
                      .build_seconds = 0.003,
                      .bytes = 123456789012,
                      .fps = 3571.4,
                      .speedup = 88,
                      .summation_nodes = 6.2,
                      .width_cells = 0.5,
                      .width_edges = 0.75,
                      .wanted_summation = 6,
                      .most_summation = 32,
                      .bases = 28,
                      .cells = 29358,
                      .parts = 4,
                      .reached = 3.25,
                      .most_reached = 12.5,
                      .wanted_nodes = 661,
                      .wanted_bases = 27,
                      .local_nodes = 11,
                      .welded_cells = 3,
                      .welded_pairs = 2,
                      .balance_splits = 9,
                      .plain = seed % 2 == 1,
                      .paper_total_ms = 0.281,
                      .change = {.frames = seed % 2 ? FRAMES : 0,
                                 .changed = 3,
                                 .first_nodes = 500,
                                 .most_nodes = 1600,
                                 .last_nodes = 1550,
                                 .most_added = 70,
                                 .first_ms = 0.05,
                                 .last_ms = 0.2,
                                 .change_ms = 2.5,
                                 .change_most_ms = 4.5,
                                 .follow_ms = 1.5,
                                 .surface_ms = 0.06,
                                 .first_triangles = 4400,
                                 .last_triangles = 12000,
                                 .pieces = 2,
                                 .open_edges = 4,
                                 .left = 1},
                      .input_hash = 0xcbf29ce484222325ULL};
    strcpy(row->paper, "fastlsm");
    strcpy(row->paper_row, "penguin");
    snprintf(row->scene, sizeof row->scene, "penguin \"%d\" \xc3\xa9", seed);
    strcpy(row->engine, "fastlsm");
    strcpy(row->precision, "single");
    memset(row->reason, 'r', sizeof row->reason - 1); /* the longest there can be */
    strcpy(row->found, "goals within 1.5e-05 cells");
    if (seed) row->elastic = (BenchElasticRow){1008, 64, 0.25, 1.5, 2.5, 0.125, {1e-14, 2e-13}};
    row->total = sm_alloc(REPEATS, sizeof *row->total);
    row->stage = sm_alloc(REPEATS, sizeof *row->stage);
    if (row->change.frames) row->change.time = sm_alloc(FRAMES, sizeof *row->change.time);
    for (int f = 0; f < row->change.frames; f++)
        for (int i = 0; i < BENCH_FRAME_PARTS; i++) row->change.time[f][i] = 1e-6 * (10 * f + i);
    for (int i = 0; i < REPEATS; i++) row->total[i] = 1e-4 * (i + seed);
    for (int s = 0; s < SM_STAGES; s++) {
        row->stage_ms[s] = 0.01 * (s + 1);
        row->paper_stage_ms[s] = s == 3 ? NAN : 0.02 * s;
        for (int i = 0; i < REPEATS; i++) row->stage[i][s] = 1e-5 * (10 * i + s + seed);
    }
}

static void compare_rows(const BenchRow *a, const BenchRow *b)
{
    /* All but the two pointers bit for bit: both records were zeroed, padding included. */
    BenchRow left, right;
    memcpy(&left, a, sizeof left);
    memcpy(&right, b, sizeof right);
    left.total = right.total = NULL;
    left.stage = right.stage = NULL;
    left.change.time = right.change.time = NULL;
    assert_memory_equal(&left, &right, sizeof left);
    assert_memory_equal(a->total, b->total, REPEATS * sizeof *a->total);
    assert_memory_equal(a->stage, b->stage, REPEATS * sizeof *a->stage);
    if (a->change.frames)
        assert_memory_equal(a->change.time, b->change.time, FRAMES * sizeof *a->change.time);
}

static void fill_rows(BenchRow *rows, BenchMachine *machine)
{
    static char *arguments[] = {"shapebench", "tables", "--output", "it's a file", "", "x=1"};
    for (int i = 0; i < ROWS; i++) {
        memset(&rows[i], 0, sizeof rows[i]);
        fill_row(&rows[i], i);
    }
    bench_machine_read(6, arguments, 2, machine);
}

static SmCode store_file(const char *path, SmError *error)
{
    BenchRow rows[ROWS];
    BenchMachine machine;
    fill_rows(rows, &machine);
    SmCode code = bench_store_rows(path, rows, ROWS, &machine, error);
    for (int i = 0; i < ROWS; i++) {
        free(rows[i].total);
        free(rows[i].stage);
        free(rows[i].change.time);
    }
    return code;
}

static void write_file(const char *path)
{
    SmError error = {0};
    if (store_file(path, &error) != SM_OK) fail_msg("%s", error.text);
}

static void round_trip(void **state)
{
    (void)state;
    const char *path = path_in("rows.h5");
    BenchRow *rows, expected[ROWS];
    BenchMachine machine, now;
    SmError error = {0};
    int count;
    write_file(path);
    write_file(path); /* replaces */
    assert_int_equal(entries(""), 1);
    if (bench_load_rows(path, &rows, &count, &machine, &error) != SM_OK) fail_msg("%s", error.text);
    assert_int_equal(count, ROWS);
    fill_rows(expected, &now);
    for (int i = 0; i < ROWS; i++) compare_rows(&rows[i], &expected[i]);
    memcpy(now.utc, machine.utc, sizeof now.utc);
    assert_memory_equal(&machine, &now, sizeof now);
    bench_rows_free(rows, count);
    for (int i = 0; i < ROWS; i++) {
        free(expected[i].total);
        free(expected[i].stage);
        free(expected[i].change.time);
    }
    unlink(path);
}

static void no_rows(void **state)
{
    (void)state;
    const char *path = path_in("none.h5");
    BenchRow *rows;
    BenchMachine machine;
    SmError error = {0};
    int count;
    bench_machine_read(0, NULL, 1, &machine);
    assert_int_equal(bench_store_rows(path, NULL, 0, &machine, &error), SM_OK);
    assert_int_equal(bench_load_rows(path, &rows, &count, &machine, &error), SM_OK);
    assert_int_equal(count, 0);
    bench_rows_free(rows, count);
    unlink(path);
}

static void machine_is_described(void **state)
{
    (void)state;
    static char *arguments[] = {"shapebench run", "a b", "it's", "", "plain-1.5"};
    BenchMachine machine;
    bench_machine_read(5, arguments, 3, &machine);
    assert_string_equal(machine.command, "shapebench run 'a b' 'it'\\''s' '' plain-1.5");
    assert_int_equal(machine.threads, 3);
    assert_true(machine.cores >= 1);
    assert_true(strlen(machine.git_commit) == 40 || !strcmp(machine.git_commit, "unknown"));
    assert_non_null(strstr(machine.libraries, "HDF5 1."));
    assert_non_null(strstr(machine.kernel, "Linux"));
    assert_int_equal(strlen(machine.utc), strlen("2026-11-21T10:17:02Z"));
    assert_true(machine.compiler[0] && machine.flags[0] && machine.cpu[0] && machine.hostname[0]);
}

static void long_command_is_cut(void **state)
{
    (void)state;
    static char word[3000], *arguments[] = {"shapebench", word};
    BenchMachine machine;
    memset(word, '\'', sizeof word - 1);
    bench_machine_read(2, arguments, 1, &machine);
    size_t length = strlen(machine.command);
    assert_in_range(length, sizeof machine.command - 16, sizeof machine.command - 1);
    assert_string_equal(machine.command + length - 3, "...");
}

/* Loading `path` fails with a line that names it and holds `words`. */
static void refuses(const char *path, const char *words)
{
    BenchRow *rows;
    BenchMachine machine;
    SmError error = {0};
    int count;
    assert_int_equal(bench_load_rows(path, &rows, &count, &machine, &error), SM_INPUT);
    assert_null(rows);
    assert_non_null(strstr(error.text, path));
    if (!strstr(error.text, words)) fail_msg("'%s' does not say '%s'", error.text, words);
}

static void foreign_files(void **state)
{
    (void)state;
    const char *path = path_in("foreign.h5");
    refuses(path, "No such file");
    write_text("foreign.h5", "this is no HDF5\n");
    refuses(path, "not an HDF5 file");
    hid_t other = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(other);
    refuses(path, "not a shapebench results file");
    unlink(path);
    refuses(folder, "not an HDF5 file");
}

static void truncated_file(void **state)
{
    (void)state;
    const char *path = path_in("cut.h5");
    struct stat status;
    for (int eighth = 7; eighth >= 0; eighth--) {
        write_file(path);
        assert_int_equal(stat(path, &status), 0);
        assert_int_equal(truncate(path, status.st_size * eighth / 8), 0);
        refuses(path, "not an HDF5 file, or cut off");
    }
    unlink(path);
}

/* Changes a good file by `change` and expects the refusal. */
static void refuses_changed(void (*change)(hid_t file), const char *words)
{
    const char *path = path_in("changed.h5");
    write_file(path);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    change(file);
    H5Fclose(file);
    refuses(path, words);
    unlink(path);
}

static void set_int(hid_t object, const char *name, int value)
{
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, H5T_NATIVE_INT, &value) >= 0);
    H5Aclose(attribute);
}

static void older(hid_t file)
{
    set_int(file, "schema", 0);
}
static void newer(hid_t file)
{
    set_int(file, "schema", BENCH_STORE_SCHEMA + 1);
}
static void more_rows(hid_t file)
{
    set_int(file, "rows", 1 << 30);
}
static void lose_frames(hid_t file)
{
    assert_true(H5Ldelete(file, "rows/001/frames", H5P_DEFAULT) >= 0);
}

static void lose_total(hid_t file)
{
    assert_true(H5Ldelete(file, "rows/001/total", H5P_DEFAULT) >= 0);
}
static void lose_field(hid_t file)
{
    assert_true(H5Adelete_by_name(file, "rows/000", "goal_error", H5P_DEFAULT) >= 0);
}
static void lose_machine(hid_t file)
{
    assert_true(H5Ldelete(file, "machine", H5P_DEFAULT) >= 0);
}
static void more_repeats(hid_t file)
{
    hid_t group = H5Gopen2(file, "rows/001", H5P_DEFAULT);
    set_int(group, "repeats", REPEATS + 1);
    H5Gclose(group);
}
static void negative_repeats(hid_t file)
{
    hid_t group = H5Gopen2(file, "rows/001", H5P_DEFAULT);
    set_int(group, "repeats", -1);
    H5Gclose(group);
}
static void text_for_number(hid_t file)
{
    BenchH5 h5 = {.file = file};
    hid_t group = H5Gopen2(file, "rows/001", H5P_DEFAULT);
    H5Adelete(group, "w");
    bench_h5_text(&h5, group, "w", "two");
    H5Gclose(group);
}
static void long_text(hid_t file)
{
    BenchH5 h5 = {.file = file};
    hid_t group = H5Gopen2(file, "rows/001", H5P_DEFAULT);
    H5Adelete(group, "engine");
    bench_h5_text(&h5, group, "engine", "an engine's name that has no room in the record");
    H5Gclose(group);
}

static void damaged_files(void **state)
{
    (void)state;
    refuses_changed(older, "measure again");
    refuses_changed(newer, "newer shapebench");
    refuses_changed(more_rows, "another number of rows");
    refuses_changed(lose_total, "row 001: dataset 'total' is missing");
    refuses_changed(lose_field, "row 000: attribute 'goal_error' is missing");
    refuses_changed(lose_machine, "group 'machine' is missing");
    refuses_changed(lose_frames, "row 001: dataset 'frames' is missing");
    refuses_changed(more_repeats, "row 001: dataset 'total' has the wrong size");
    refuses_changed(negative_repeats, "row 001: repeats is -1");
    refuses_changed(text_for_number, "row 001: attribute 'w' has the wrong type");
    refuses_changed(long_text, "attribute 'engine' cannot be read or is too long");
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

static void unwritable_targets(void **state)
{
    (void)state;
    const char *path = path_in("missing/rows.h5");
    cannot_store(path, "create the folder");
    cannot_store("/dev/null", "not a regular file");
    cannot_store(folder, "not a regular file");
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

static void locked_folder(void **state)
{
    (void)state;
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

static void full_disk(void **state)
{
    (void)state;
    const char *path = path_in("full.h5");
    in_child(store_with_limits);
    BenchRow *rows;
    BenchMachine machine;
    int count;
    assert_int_equal(entries(""), 1); /* the last one, and no drafts */
    assert_int_equal(bench_load_rows(path, &rows, &count, &machine, NULL), SM_OK);
    assert_int_equal(count, ROWS);
    bench_rows_free(rows, count);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trip),           cmocka_unit_test(no_rows),
        cmocka_unit_test(machine_is_described), cmocka_unit_test(long_command_is_cut),
        cmocka_unit_test(foreign_files),        cmocka_unit_test(truncated_file),
        cmocka_unit_test(damaged_files),        cmocka_unit_test(unwritable_targets),
        cmocka_unit_test(locked_folder),        cmocka_unit_test(full_disk),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
