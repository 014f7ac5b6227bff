/* What one would take instead: the file of scripts/baselines.py read, and its table in every form.
 * The test writes the file by the layout in results/README.md. */
#include <math.h>

#include "../../lib/test_folder.h"
#include "../store/test_damage.h"
#include "baselines.h"

/* What the test's file holds; a test may change it before it writes. */
typedef struct {
    char method[64], stiffness[64];
    double step, sag_percent, ms_step, ns_node_step, ms_second, deviation_percent;
} Method;

static const Method good[] = {
    {"FastLSM, w 2", "w 2", 0.001, 10.1, 0.025, 30, 25, 0.125},
    {"Elements", "E 1e6 Pa", 0.001, 9.95, 4, 4800, 4000, 0.0625},
    {"Clusters\033[31m", "k|1_%", 0.004, 75, 3, 3600, 750, NAN},
};
enum { METHODS = sizeof good / sizeof *good };

typedef struct {
    Method method[METHODS];
    int count, schema;
    const char *kind;
    double sag;
    BenchMachine machine;
} File;

static File whole(void)
{
    File file = {.count = METHODS, .schema = 2, .kind = "shapebench baselines", .sag = 10};
    memcpy(file.method, good, sizeof good);
    bench_machine_read(1, (char *[]){"test"}, 1, &file.machine);
    file.machine.git_dirty = false;
    strcpy(file.machine.git_commit, "0123456789abcdef");
    strcpy(file.machine.utc, "2026-11-25T12:00:00Z");
    return file;
}

#define COLUMN(kind, member) BENCH_FIELD(Method, BENCH_##kind, member)

static void write_layout(BenchH5 *h5, void *record)
{
    const File *file = record;
    static const BenchField columns[] = {
        COLUMN(TEXT, method),      COLUMN(TEXT, stiffness),
        COLUMN(DOUBLE, step),      COLUMN(DOUBLE, sag_percent),
        COLUMN(DOUBLE, ms_step),   COLUMN(DOUBLE, ns_node_step),
        COLUMN(DOUBLE, ms_second), COLUMN(DOUBLE, deviation_percent),
    };
    const double length = 0.8;
    const long long nodes = 825;
    bench_h5_text(h5, h5->file, "kind", file->kind);
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &file->schema);
    bench_machine_store(h5, &file->machine);
    hid_t plan = bench_h5_group(h5, h5->file, "plan");
    bench_h5_numbers(h5, plan, "nodes", H5T_STD_I64LE, 0, &nodes);
    bench_h5_numbers(h5, plan, "length", H5T_IEEE_F64LE, 0, &length);
    bench_h5_numbers(h5, plan, "sag_percent", H5T_IEEE_F64LE, 0, &file->sag);
    bench_h5_text(h5, plan, "comparable", "nodes and masses");
    bench_h5_text(h5, plan, "not_comparable", "damping");
    bench_h5_columns(h5, bench_h5_group(h5, h5->file, "methods"), columns,
                     sizeof columns / sizeof *columns, file->method, sizeof *file->method,
                     file->count);
}

static void write_as(const char *path, File *file)
{
    SmError error;
    if (bench_h5_store(path, write_layout, file, &error)) fail_msg("%s", error.text);
}

static void write_good(const char *path)
{
    File file = whole();
    write_as(path, &file);
}

static SmCode load(const char *path, SmError *error)
{
    static const BenchBaselines none;
    BenchBaselines baselines;
    SmCode code = bench_baselines_load(path, &baselines, error);
    if (code)
        assert_memory_equal(&baselines, &none, sizeof none);
    else
        bench_baselines_free(&baselines);
    return code;
}

static const TestStored stored = {"shapebench baselines", write_good, load};

/* The file's baselines; the caller frees them. */
static BenchBaselines loaded(File *file)
{
    BenchBaselines baselines;
    SmError error;
    const char *path = path_in("good.h5");
    write_as(path, file);
    if (bench_baselines_load(path, &baselines, &error)) fail_msg("%s", error.text);
    unlink(path);
    return baselines;
}

TEST(methods_are_read_and_compared)
{
    File file = whole();
    BenchBaselines read = loaded(&file);
    assert_int_equal(read.count, METHODS);
    assert_int_equal(read.nodes, 825);
    assert_true(read.length == 0.8 && read.sag_percent == 10);
    assert_string_equal(read.comparable, "nodes and masses");
    assert_string_equal(read.not_comparable, "damping");
    assert_string_equal(read.machine.git_commit, "0123456789abcdef");
    for (int m = 0; m < METHODS; m++) {
        const BenchBaseline *method = &read.method[m];
        assert_true(method->step == good[m].step && method->ms_step == good[m].ms_step &&
                    method->ns_node_step == good[m].ns_node_step);
        assert_true(method->times == good[m].ms_second / good[0].ms_second);
        assert_int_equal(method->same_sag, m < 2);
    }
    assert_string_equal(read.method[2].method, "Clusters?[31m");
    assert_true(isnan(read.method[2].deviation_percent));
    bench_baselines_free(&read);
}

/* ---- what cannot be used */

TEST(foreign_and_cut_files_are_refused)
{
    refuses_foreign(&stored);
}

static void of_another_kind(hid_t file)
{
    hid_t kind = H5Aopen(file, "kind", H5P_DEFAULT), type = H5Aget_type(kind);
    assert_true(H5Awrite(kind, type, "shapebench results  ") >= 0);
    H5Tclose(type);
    H5Aclose(kind);
}

static void without_words(hid_t file)
{
    assert_true(H5Adelete_by_name(file, "plan", "not_comparable", H5P_DEFAULT) >= 0);
}

static void without_times(hid_t file)
{
    assert_true(H5Ldelete(file, "methods/ms_second", H5P_DEFAULT) >= 0);
}

static void without_machine(hid_t file)
{
    assert_true(H5Ldelete(file, "machine", H5P_DEFAULT) >= 0);
}

TEST(changed_files_are_refused)
{
    static const TestChange changes[] = {
        {older, "its schema is 0 and this program reads 2; measure again"},
        {newer, "its schema is 3 and this program reads 2; use a newer shapebench"},
        {of_another_kind, "not a shapebench baselines file"},
        {without_words, "attribute 'not_comparable' is missing"},
        {without_times, "dataset 'ms_second' is missing"},
        {without_machine, "group 'machine' is missing"},
    };
    refuses_changed(&stored, changes, sizeof changes / sizeof *changes);
}

static void refuses_file(File *file, const char *words)
{
    const char *path = path_in("wrong.h5");
    write_as(path, file);
    refuses(&stored, path, words);
    unlink(path);
}

TEST(numbers_that_are_none_are_refused)
{
    File file = whole();
    file.method[1].ms_step = 0;
    refuses_file(&file, "method 1 has a time of 0");
    file = whole();
    file.method[2].ms_second = NAN;
    refuses_file(&file, "method 2 has a time of ");
    file = whole();
    file.method[0].step = -1;
    refuses_file(&file, "method 0 has a time of -1");
    file = whole();
    file.method[0].sag_percent = INFINITY;
    refuses_file(&file, "method 0 sags by inf%");
    file = whole();
    file.sag = 0;
    refuses_file(&file, "its beams are to sag by 0%");
    file = whole();
    file.count = 0;
    refuses_file(&file, "not one method is there");
}

/* ---- tables */

/* What `print` writes; stands until the next call. */
static const char *printed(BenchGridForm form, const BenchBaselines *baselines,
                           const BenchMachine *here)
{
    static char text[4096];
    FILE *file = fmemopen(text, sizeof text, "w");
    assert_non_null(file);
    bench_baselines_print(file, form, baselines, here);
    fclose(file);
    return text;
}

static void says(const char *text, const char *words)
{
    if (!strstr(text, words)) fail_msg("it does not say '%s':\n%s", words, text);
}

TEST(tables_for_people_say_what_can_be_compared)
{
    File file = whole();
    BenchBaselines read = loaded(&file);
    const char *text = printed(BENCH_GRID_PLAIN, &read, &file.machine);
    says(text, "\nWhat one would take instead, for a clamped beam of 825 nodes: on ");
    says(text, "; 2026-11-25, commit 0123456789.\n\nmethod ");
    says(text, "\nFastLSM, w 2   w 2         0.001   10.1  yes        0.0250              30.0  "
               "25.0        0.125   1.00\n");
    says(text, "\nClusters?[31m  k|1_%       0.004     75  no           3.00              3600   "
               "750            -   30.0\n");
    says(text, "\nComparable: nodes and masses.\nNot comparable: damping.\n");
    assert_null(strstr(text, "another machine"));
    text = printed(BENCH_GRID_MARKDOWN, &read, &file.machine);
    says(text, "| Elements | E 1e6 Pa | 0.001 | 9.95 | yes | 4.00 | 4800 | 4000 | 0.0625 | 160 |");
    says(text, "| Clusters?[31m | k\\|1_% |");
    says(text, "Comparable: nodes and masses.\n\nNot comparable: damping.\n");
    text = printed(BENCH_GRID_LATEX, &read, &file.machine);
    says(text, "k$|$1\\_\\% & 0.004 &");
    says(text, "\\end{tabular}\n% Comparable: nodes and masses.\n% Not comparable: damping.\n");
    bench_baselines_free(&read);
}

/* Where the processor is another one; the kernels that were chosen are no machine's. */
TEST(another_machine_is_said)
{
    File file = whole();
    strcpy(file.machine.cpu, "Pentium 4");
    BenchBaselines read = loaded(&file);
    BenchMachine here = whole().machine;
    strcpy(here.cpu, "Pentium 5");
    says(printed(BENCH_GRID_PLAIN, &read, &here),
         "\nThese rows were measured on another machine: Pentium 4; this is Pentium 5.\n");
    strcpy(here.cpu, "Pentium 4");
    strcpy(here.isa, "another");
    assert_null(strstr(printed(BENCH_GRID_PLAIN, &read, &here), "another machine"));
    bench_baselines_free(&read);
}

TEST(programs_get_columns)
{
    File file = whole();
    strcpy(file.method[0].method, "FastLSM");
    BenchBaselines read = loaded(&file);
    char text[4096];
    FILE *csv = fmemopen(text, sizeof text, "w");
    assert_non_null(csv);
    bench_baselines_csv(csv, &read);
    fclose(csv);
    says(text, "method,stiffness,step,sag_percent,same_sag,ms_step,ns_node_step,ms_second,"
               "deviation_percent,times\nFastLSM,w 2,0.001,10.1,1,0.025,30,25,0.125,1\n");
    says(text, "\nClusters?[31m,k|1_%,0.004,75,0,3,3600,750,,30\n");
    json_t *object = bench_json_baselines(&read, &file.machine);
    const json_t *methods = json_object_get(object, "methods");
    assert_int_equal(json_array_size(methods), METHODS);
    const json_t *last = json_array_get(methods, 2);
    assert_true(json_is_null(json_object_get(last, "deviation_percent")));
    assert_true(json_is_false(json_object_get(last, "same_sag")));
    assert_int_equal(json_integer_value(json_object_get(last, "times")), 30);
    assert_string_equal(json_string_value(json_object_get(object, "not_comparable")), "damping");
    assert_int_equal(json_integer_value(json_object_get(object, "nodes")), 825);
    assert_true(json_is_null(json_object_get(object, "other_machine")));
    json_decref(object);
    bench_baselines_free(&read);
}
