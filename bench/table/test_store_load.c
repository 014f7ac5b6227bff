/* Results files that cannot be read: each is one line that names it and says why. */
#include "../../lib/test_frame.h"
#include "../measure/measure.h"
#include "../store/test_damage.h"
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

/* Whatever of the file was read is freed. */
static SmCode load(const char *path, SmError *error)
{
    BenchRow *rows;
    BenchMachine machine;
    int count;
    SmCode code = bench_store_load(path, &rows, &count, &machine, error);
    assert_null(rows);
    return code;
}

static const TestStored results = {"shapebench results", write_file, load};

TEST(foreign_and_cut_files)
{
    refuses_foreign(&results);
}

static void more_rows(hid_t file)
{
    set_int(file, ".", "rows", 1 << 30);
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
    set_int(file, "rows/001", "repeats", REPEATS + 1);
}
static void negative_repeats(hid_t file)
{
    set_int(file, "rows/001", "repeats", -1);
}
static void replace_by_text(hid_t file, const char *name, const char *text)
{
    BenchH5 h5 = {.file = file};
    hid_t group = H5Gopen2(file, "rows/001", H5P_DEFAULT);
    H5Adelete(group, name);
    bench_h5_text(&h5, group, name, text);
    H5Gclose(group);
}
static void text_for_number(hid_t file)
{
    replace_by_text(file, "w", "two");
}
static void long_text(hid_t file)
{
    replace_by_text(file, "engine", "an engine's name that has no room in the record");
}

TEST(damaged_files)
{
    static const TestChange changes[] = {
        {older, "measure again"},
        {newer, "newer shapebench"},
        {more_rows, "it states 1073741824 rows"},
        {lose_total, "row 001: dataset 'total' is missing"},
        {lose_field, "row 000: attribute 'valid' is missing"},
        {lose_machine, "group 'machine' is missing"},
        {more_repeats, "row 001: dataset 'total' has the wrong size"},
        {negative_repeats, "row 001: repeats is -1"},
        {text_for_number, "row 001: attribute 'w' has the wrong type"},
        {long_text, "attribute 'engine' cannot be read or is too long"},
    };
    refuses_changed(&results, changes, sizeof changes / sizeof *changes);
}
