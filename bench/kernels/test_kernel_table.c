/* Timed kernels as tables: verdicts, rows without numbers, formats that parse. */

#include <jansson.h>

#include "../../lib/test_frame.h"
#include "kernel_table.h"

static const BenchMachine machine = {.cpu = "Test CPU", .cores = 2};
static const BenchPeak peak = {.isa = "wide", .one = {.threads = 1}, .all = {.threads = 2}};

TEST(verdicts_follow_the_limits)
{
    BenchKernelRow row = {.valid = true, .ns = 8, .at_most = NAN, .wanted = NAN};
    assert_string_equal(bench_kernel_verdict(&row), "");
    row.at_most = 8;
    assert_string_equal(bench_kernel_verdict(&row), "met");
    row.at_most = 7.9;
    assert_string_equal(bench_kernel_verdict(&row), "missed");
    row = (BenchKernelRow){
        .valid = true, .at_most = NAN, .ratio = 1.9, .wanted = 1.85, .wanted_least = true};
    assert_string_equal(bench_kernel_verdict(&row), "met");
    row.wanted_least = false;
    assert_string_equal(bench_kernel_verdict(&row), "missed");
    row.busy = true;
    assert_string_equal(bench_kernel_verdict(&row), "");
    row.own_time = true; /* which others hardly touch */
    assert_string_equal(bench_kernel_verdict(&row), "missed");
    row = (BenchKernelRow){.valid = false, .ns = 1, .at_most = 8, .wanted = NAN};
    assert_string_equal(bench_kernel_verdict(&row), "missed");
}

/* Three rows, the second not valid and the third busy although their times are filled in. */
static void write_rows(BenchFormat format, char **text, size_t *size)
{
    BenchKernelRow rows[3] = {{.kernel = "good",
                               .group = "a",
                               .item = "particle",
                               .precision = "single",
                               .isa = "wide",
                               .threads = 1,
                               .items = 10,
                               .valid = true,
                               .ns = 12.5,
                               .low = 12,
                               .high = 13,
                               .bound_ns = 5,
                               .bound = "L1",
                               .at_most = 20,
                               .ratio = NAN,
                               .wanted = NAN,
                               .note = "with, a comma"}};
    rows[1] = rows[0];
    rows[1].valid = false;
    rows[1].ns = rows[1].low = rows[1].high = rows[1].bound_ns = 98765;
    strcpy(rows[1].kernel, "bad");
    strcpy(rows[1].reason, "it is \"wrong\"");
    rows[2] = rows[1];
    rows[2].valid = rows[2].busy = true;
    strcpy(rows[2].kernel, "late");
    strcpy(rows[2].reason, "others took it");
    FILE *file = open_memstream(text, size);
    bench_kernels_write(file, format, rows, 3, &peak, 1, &machine);
    fclose(file);
}

TEST(an_invalid_or_busy_row_has_no_number)
{
    for (int f = 0; bench_format_names[f]; f++) {
        char *text;
        size_t size;
        write_rows((BenchFormat)f, &text, &size);
        assert_non_null(strstr(text, "12.5"));
        assert_null(strstr(text, "98765"));
        assert_null(strstr(text, "98.8"));
        free(text);
    }
}

/* But the ratio, where it is of processor time, and its verdict. */
TEST(a_busy_row_tells_what_others_do_not_touch)
{
    const BenchKernelRow row = {.kernel = "late",
                                .valid = true,
                                .busy = true,
                                .own_time = true,
                                .ns = 98765,
                                .at_most = NAN,
                                .ratio = 1.25,
                                .wanted = 2,
                                .ratio_to = "least's CPU time"};
    for (int f = 0; bench_format_names[f]; f++) {
        char *text;
        size_t size;
        FILE *file = open_memstream(&text, &size);
        bench_kernels_write(file, (BenchFormat)f, &row, 1, &peak, 1, &machine);
        fclose(file);
        assert_non_null(strstr(text, "1.25"));
        assert_non_null(strstr(text, "met"));
        assert_null(strstr(text, "98765"));
        free(text);
    }
}

TEST(formats_parse)
{
    char *text;
    size_t size;
    static const char header[] =
        "kernel,group,precision,threads,w,item,items,ns,ns_low,ns_high,floor_ns,bound,"
        "share_percent,at_most_ns,ratio,ratio_to,ratio_wanted,verdict,valid,note,isa\n";
    write_rows(BENCH_AS_CSV, &text, &size);
    assert_int_equal(strncmp(text, header, sizeof header - 1), 0);
    assert_non_null(strstr(text,
                           "\ngood,a,single,1,,particle,10,12.5,12,13,5,L1,40,20,,,,met,VALID,"
                           "\"with, a comma\",wide\n"));
    assert_non_null(strstr(text,
                           "\nbad,a,single,1,,particle,10,INVALID,INVALID,INVALID,INVALID,L1,"
                           "INVALID,20,INVALID,,,missed,INVALID,\"it is \"\"wrong\"\"\",wide\n"));
    assert_non_null(strstr(text, "\nlate,a,single,1,,particle,10,BUSY,BUSY,BUSY,BUSY,L1,BUSY,20,"
                                 "BUSY,,,,BUSY,others took it,wide\n"));
    free(text);
    write_rows(BENCH_AS_JSON, &text, &size);
    json_t *root = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(root);
    json_t *good = json_array_get(json_object_get(root, "kernels"), 0);
    json_t *bad = json_array_get(json_object_get(root, "kernels"), 1);
    assert_true(json_number_value(json_object_get(good, "share_percent")) == 40);
    assert_true(json_is_true(json_object_get(good, "valid")));
    assert_true(json_is_false(json_object_get(bad, "valid")));
    assert_true(json_is_null(json_object_get(bad, "ns")));
    json_t *late = json_array_get(json_object_get(root, "kernels"), 2);
    assert_true(json_is_true(json_object_get(late, "valid")));
    assert_true(json_is_true(json_object_get(late, "busy")));
    assert_true(json_is_null(json_object_get(late, "ns")));
    assert_string_equal(json_string_value(json_object_get(late, "verdict")), "");
    assert_int_equal(json_array_size(json_object_get(root, "ceilings")), 2);
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(root, "environment"), "cpu")),
        machine.cpu);
    json_decref(root);
    free(text);
    write_rows(BENCH_AS_MARKDOWN, &text, &size);
    const char *table = strchr(text, '|'); /* below when and where it was measured */
    assert_non_null(strstr(text, machine.cpu));
    assert_true(strstr(text, machine.cpu) < table);
    int bars = 0, lines = 0; /* every line has as many cells */
    for (const char *c = table; *c; c++) {
        bars += *c == '|';
        lines += *c == '\n';
    }
    assert_int_equal(lines, 5);
    assert_int_equal(bars, 5 * 15);
    free(text);
}
