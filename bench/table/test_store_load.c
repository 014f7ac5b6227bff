/* Results files that cannot be read: each is one line that names it and says why. */
#define _GNU_SOURCE
#include <sys/stat.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../measure/measure.h"
#include "row_store.h"

enum { ROWS = 2, REPEATS = 7 };

static void write_file(const char *path)
{
    BenchRow rows[ROWS];
    BenchMachine machine;
    SmError error;
    for (int i = 0; i < ROWS; i++) {
        rows[i] = (BenchRow){.scene = "penguin", .engine = "fastlsm", .valid = true, .w = 2};
        rows[i].repeats = REPEATS;
        rows[i].total = sm_alloc(REPEATS, sizeof *rows[i].total);
        rows[i].stage = sm_alloc(REPEATS, sizeof *rows[i].stage);
        for (int r = 0; r < REPEATS; r++) rows[i].total[r] = 1e-4 * (r + 1);
    }
    bench_machine_read(0, NULL, 1, &machine);
    if (bench_store_rows(path, rows, ROWS, &machine, &error)) fail_msg("%s", error.text);
    for (int i = 0; i < ROWS; i++) bench_row_free(&rows[i]);
}

TEST(a_whole_file_is_read)
{
    BenchRow *rows;
    BenchMachine machine;
    SmError error;
    int count;
    const char *path = path_in("whole.h5");
    write_file(path);
    if (bench_store_load(path, &rows, &count, &machine, &error)) fail_msg("%s", error.text);
    assert_int_equal(count, ROWS);
    assert_string_equal(rows[1].scene, "penguin");
    assert_true(rows[1].valid && rows[1].w == 2 && rows[1].repeats == REPEATS);
    assert_true(rows[1].total[2] == 1e-4 * 3 && rows[1].stage[2][0] == 0);
    bench_rows_free(rows, count);
    unlink(path);
}

/* Loading `path` fails with a line that names it and holds `words`. */
static void refuses(const char *path, const char *words)
{
    BenchRow *rows;
    BenchMachine machine;
    SmError error = {0};
    int count;
    assert_int_equal(bench_store_load(path, &rows, &count, &machine, &error), SM_INPUT);
    assert_null(rows);
    assert_non_null(strstr(error.text, path));
    if (!strstr(error.text, words)) fail_msg("'%s' does not say '%s'", error.text, words);
}

TEST(foreign_files)
{
    const char *path = path_in("foreign.h5");
    refuses(path, "No such file");
    write_text("foreign.h5", "this is no HDF5\n");
    refuses(path, "not an HDF5 file");
    hid_t other = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(other);
    refuses(path, "not a shapebench results file");
    unlink(path);
    refuses(folder, "it is a folder");
    assert_int_equal(mkfifo(path, 0600), 0);
    refuses(path, "it is a pipe");
    unlink(path);
}

TEST(truncated_file)
{
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
    H5Adelete(file, BENCH_H5_CHECKSUM); /* as of a file from before there were any */
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

static void lose_total(hid_t file)
{
    assert_true(H5Ldelete(file, "rows/001/total", H5P_DEFAULT) >= 0);
}
static void lose_field(hid_t file)
{
    assert_true(H5Adelete_by_name(file, "rows/000", "valid", H5P_DEFAULT) >= 0);
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

TEST(damaged_files)
{
    refuses_changed(older, "measure again");
    refuses_changed(newer, "newer shapebench");
    refuses_changed(more_rows, "it states 1073741824 rows");
    refuses_changed(lose_total, "row 001: dataset 'total' is missing");
    refuses_changed(lose_field, "row 000: attribute 'valid' is missing");
    refuses_changed(lose_machine, "group 'machine' is missing");
    refuses_changed(more_repeats, "row 001: dataset 'total' has the wrong size");
    refuses_changed(negative_repeats, "row 001: repeats is -1");
    refuses_changed(text_for_number, "row 001: attribute 'w' has the wrong type");
    refuses_changed(long_text, "attribute 'engine' cannot be read or is too long");
}
