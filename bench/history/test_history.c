/* `shapebench history` on files of known times. */
#include <jansson.h>

#include "../cli/test_program.h"
#include "../measure/measure.h"
#include "../system/statistic.h"
#include "../table/row_store.h"

enum { FILES = 16, CHANGED = 9, KERNEL = 9 };

static BenchRow *rows;
static BenchMachine machine;

/* A file of the tiny scene of that day, each step of so many ms. */
static void store(const char *name, int day, double ms)
{
    SmError error;
    BenchRow row = rows[0];
    for (int r = 0; r < row.repeats; r++) row.total[r] = 1e-3 * ms * (1 + 1e-4 * r);
    BenchQuartiles of = bench_quartiles(row.total, row.repeats);
    row.total_ms = 1e3 * of.median, row.total_low_ms = 1e3 * of.low;
    row.total_high_ms = 1e3 * of.high;
    snprintf(machine.utc, sizeof machine.utc, "2026-03-%02dT10:00:00Z", day);
    snprintf(machine.kernel, sizeof machine.kernel, "Linux %d", day > KERNEL ? 7 : 6);
    snprintf(machine.git_commit, sizeof machine.git_commit, "%012d", day);
    assert_int_equal(bench_store_rows(path_in(name), &row, 1, &machine, &error), SM_OK);
}

/* Sixteen days; from the tenth on a step takes a fifth longer. */
static int set_up(void **state)
{
    Result result;
    SmError error;
    int count;
    if (make_folder(state)) return -1;
    write_text("tiny.cfg",
               "mesh = \"shape:block\"; particles = 64; w = 1; engine = \"brute\"; bend = 0.3;\n");
    run("tables --scene tiny.cfg --repeats 8 --block 0.1 -o tiny.h5", &result);
    if (result.code || bench_store_load(path_in("tiny.h5"), &rows, &count, &machine, &error))
        return -1;
    rows->busy = false; /* the times are made up */
    for (int day = 1; day <= FILES; day++) {
        char name[32];
        int noise = 7919 * day % 17 - 8;                      /* -8..8: up to 0.8% */
        snprintf(name, sizeof name, "d%02d.h5", FILES - day); /* against the order of time */
        store(name, day, (day > CHANGED ? 1.2 : 1) * (1 + 1e-3 * noise));
    }
    return 0;
}

static int tear_down(void **state)
{
    bench_rows_free(rows, 1);
    return remove_folder(state);
}

TEST_GROUP(set_up, tear_down)

static void expect(const char *arguments, int code, const char *wanted)
{
    Result result;
    run(arguments, &result);
    if (result.code != code || !strstr(code ? result.err : result.out, wanted))
        fail_msg("%s: %d, not %d with '%s'\n%s%s", arguments, result.code, code, wanted, result.out,
                 result.err);
}

TEST(a_change_is_told_with_its_file_and_what_else_changed)
{
    Result result;
    run("history d*.h5", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "16 files, from d15.h5 (2026-03-01T10:00, 000000000001"));
    assert_non_null(
        strstr(result.out, "  tiny is slower from d06.h5 (2026-03-10T10:00, 000000000010"));
    assert_non_null(strstr(result.out, "; there the kernel changed\n"));
    assert_non_null(strstr(result.out, "  d06.h5: kernel Linux 7, before Linux 6\n"));
    const char *ratio = strstr(result.out, " on: ");
    assert_true(ratio && fabs(atof(ratio + 5) - 1.2) < 0.02);
    assert_null(strstr(result.out, "faster"));
    expect("history d1*.h5 d09.h5", 0, "no change can be told from noise in fewer than 10 files");
    expect("history d*.h5 --format markdown", 0, "| tiny ");
}

TEST(json_has_all_that_is_drawn)
{
    Result result;
    json_error_t error;
    run("history d*.h5 --format json", &result);
    json_t *root = json_loads(result.out, 0, &error);
    assert_non_null(root);
    assert_int_equal(json_array_size(json_object_get(root, "files")), FILES);
    const char *file, *what;
    int points, at, mark;
    double p, ratio, low, high;
    assert_int_equal(json_unpack(root, "{s:[{s:s}], s:[{s:i, s:s}]}", "files", "file", &file,
                                 "marks", "file", &mark, "what", &what),
                     0);
    assert_string_equal(file, "d15.h5");
    assert_string_equal(what, "kernel");
    assert_int_equal(mark, KERNEL);
    json_t *series = json_object_get(root, "series"), *one = json_array_get(series, 0);
    assert_int_equal(json_array_size(series), 1);
    points = (int)json_array_size(json_object_get(one, "points"));
    assert_int_equal(points, FILES);
    assert_int_equal(json_array_size(json_object_get(one, "changes")), 1);
    assert_int_equal(json_unpack(one, "{s:[{s:i, s:F, s:F, s:F, s:F}]}", "changes", "point", &at,
                                 "p", &p, "ratio", &ratio, "low", &low, "high", &high),
                     0);
    assert_int_equal(at, CHANGED);
    assert_true(p <= 0.01 && low <= ratio && ratio <= high && low > 1.15 && high < 1.25);
    json_decref(root);
}

TEST(mistakes_are_named)
{
    expect("history", 2, "which FILE?");
    expect("history none.h5", 3, "none.h5");
    expect("history tiny.cfg", 3, "not an HDF5 file");
    expect("history d01.h5 --format pdf", 2, "not one of text, markdown, json");
    expect("history d01.h5 -o d02.h5", 4, "d02.h5");
    rows[0].particles++;
    store("other.h5", 17, 3); /* other work: a series of its own */
    rows[0].particles--;
    expect("history d*.h5 other.h5", 0, "  1      1 ");
}
