/* A sweep's parts: ranges, plans, and the file. */
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../lib/test_frame.h"
#include "../campaign/campaign_run.h"
#include "../settings/setting.h"
#include "../store/test_damage.h"
#include "sweep.h"
#include "test_point.h"

enum { POINT_BYTES = 1392, REPEATS = 3 };

/* A member new in point.h is to be stored (point.c), described (results/README.md), and filled
 * here. */
_Static_assert(sizeof(BenchPoint) == POINT_BYTES, "point.h has changed: see above");

TEST(ranges_are_numbers)
{
    static const struct {
        const char *text;
        int count;
        double value[12];
    } cases[] = {
        {"3", 1, {3}},
        {"1:4", 4, {1, 2, 3, 4}},
        {"0:1:0.1", 11, {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1}},
        {"0:1:0.3", 4, {0, 0.3, 0.6, 0.9}},
        {"1:2,4,6:8:2", 5, {1, 2, 4, 6, 8}},
        {"0.75,1e0", 2, {0.75, 1}},
        {"2:2", 1, {2}},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double value[12];
        int count;
        SmError error;
        if (bench_range_parse("--x", cases[c].text, 0, 10, 12, value, &count, &error))
            fail_msg("%s: %s", cases[c].text, error.text);
        assert_int_equal(count, cases[c].count);
        assert_memory_equal(value, cases[c].value, (size_t)count * sizeof *value);
    }
}

TEST(bad_ranges_are_refused)
{
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"", "is not a range"},      {"8:1", "falls"},           {"0:1:0", "step 0"},
        {"0:1:-1", "step -1"},       {"0:10:1e-9", "more than"}, {"0:1e9", "not from"},
        {"1:2:3:4", "not a range"},  {"1:", "not a range"},      {"a", "not a range"},
        {"1,,2", "not a range"},     {"nan", "not a range"},     {"0:inf", "not a range"},
        {"-1:2", "-1 is not from"},  {"3,2", "2 follows 3"},     {"1:3,3", "3 follows 3"},
        {"0:1:1e-320", "more than"}, {"1 2", "not a range"},     {"0:8:0.5", "more than 12"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double value[12];
        int count;
        SmError error = {0};
        assert_int_equal(bench_range_parse("--x", cases[c].text, 0, 10, 12, value, &count, &error),
                         SM_USAGE);
        if (!strstr(error.text, cases[c].words) || strncmp(error.text, "--x: ", 5) != 0)
            fail_msg("'%s': '%s' does not say '%s'", cases[c].text, error.text, cases[c].words);
    }
}

/* w 1 and 2, epsilon 0, 0.5 and 1. */
static BenchPlan make_plan(const char *engines)
{
    BenchPlan plan = {.ws = 2,
                      .epsilons = 3,
                      .w = {1, 2},
                      .epsilon = {0, 0.5, 1},
                      .repeats = REPEATS,
                      .frames = 5,
                      .block_ms = 1,
                      .threads = 1,
                      .scene_hash = ~0ULL,
                      .mesh_hash = 7,
                      .size = 0.1};
    strcpy(plan.scene, "hand");
    strcpy(plan.engines, engines);
    strcpy(plan.precision, "single");
    strcpy(plan.width, "edges");
    strcpy(plan.build, "0.1");
    assert_int_equal(bench_sweep_type.count(&plan, NULL), SM_OK);
    return plan;
}

TEST(a_plan_makes_its_points)
{
    static const struct {
        const char *engines;
        int points, w1; /* and where the second w begins */
        const char *first;
    } cases[] = {
        {"both", 8, 4, "fastlsm"}, {"fastlsm", 2, 1, "fastlsm"}, {"octree", 6, 3, "octree"}};
    for (int c = 0; c < 3; c++) {
        BenchPlan plan = make_plan(cases[c].engines);
        BenchPoint point = {0};
        assert_int_equal(plan.points, cases[c].points);
        bench_sweep_type.plan_point(&plan, cases[c].w1, &point);
        assert_string_equal(point.engine, cases[c].first);
        assert_true(point.w == 2 && point.epsilon == 0);
        bench_sweep_type.plan_point(&plan, plan.points - 1, &point);
        assert_true(point.epsilon == (c == 1 ? 0 : 1));
    }
    BenchPlan plan = make_plan("octree");
    plan.w[0] = 0.75;
    assert_int_equal(bench_sweep_type.count(&plan, NULL), SM_OK);
    strcpy(plan.engines, "both");
    SmError error;
    assert_int_equal(bench_sweep_type.count(&plan, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "0.75 is no half-width of fastlsm"));
    plan.ws = plan.epsilons = BENCH_PLAN_VALUES;
    strcpy(plan.engines, "octree");
    assert_int_equal(bench_sweep_type.count(&plan, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "65536 points"));
}

/* With its samples. */
static BenchPoint make_measured(int index, double ms, double path, double hz)
{
    BenchPoint point = make_point(index, ms, path, hz);
    point.samples = point.valid ? REPEATS : 0;
    for (int i = 0; i < point.samples; i++) point.sample[i] = 1e-3 * ms;
    if (!point.valid) strcpy(point.reason, "goals are off");
    strcpy(point.stamp.host, "here");
    return point;
}

static BenchPoint *at(const BenchCampaign *sweep, long i)
{
    return bench_campaign_at(sweep, i);
}

static BenchPlan *plan_of(const BenchCampaign *sweep)
{
    return sweep->plan;
}

static BenchCampaign with_plan(const BenchPlan *plan)
{
    BenchCampaign sweep = bench_campaign_create(&bench_sweep_type);
    *plan_of(&sweep) = *plan;
    return sweep;
}

TEST(plans_differ_in_words)
{
    static const struct {
        size_t offset;
        const char *words;
    } cases[] = {
        {offsetof(BenchPlan, mesh_hash), "the mesh has changed"},
        {offsetof(BenchPlan, frames), "its frames is 261, and here 5"},
        {offsetof(BenchPlan, build), "and here '0.1'"},
    };
    char what[240];
    BenchPlan plan = make_plan("both");
    BenchCampaign mine = with_plan(&plan), other = with_plan(&plan);
    strcpy(plan_of(&other)->mesh, "elsewhere/hand.obj"); /* the same by its hash */
    assert_true(bench_campaign_same(&mine, &other, sizeof what, what));
    plan_of(&other)->w[1] = 3;
    assert_false(bench_campaign_same(&mine, &other, sizeof what, what));
    assert_string_equal(what, "its w is 2 numbers from 1 to 3, and here 2 from 1 to 2");
    for (int c = 0; c < 3; c++) {
        *plan_of(&other) = plan;
        ((char *)other.plan)[cases[c].offset + 1]++;
        assert_false(bench_campaign_same(&mine, &other, sizeof what, what));
        if (!strstr(what, cases[c].words)) fail_msg("%s", what);
    }
    bench_campaign_free(&mine);
    bench_campaign_free(&other);
}

/* Three of the plan's eight points, one INVALID; the number in `first` is where it differs. */
static BenchCampaign make_sweep(double first)
{
    BenchPlan plan = make_plan("both");
    BenchCampaign sweep = with_plan(&plan);
    static char *arguments[] = {"shapebench sweep", "-o", "a b.h5"};
    bench_machine_read(3, arguments, 1, &sweep.machine);
    static const int order[] = {6, 1, 4};
    for (int i = 0; i < 3; i++) {
        BenchPoint point = make_measured(order[i], order[i] == 4 ? NAN : first, 0.01, 12);
        bench_campaign_add(&sweep, &point);
    }
    return sweep;
}

static void write_sweep(const char *path)
{
    BenchCampaign sweep = make_sweep(1.5);
    SmError error;
    if (bench_campaign_store(path, &sweep, &error)) fail_msg("%s", error.text);
    bench_campaign_free(&sweep);
}

TEST(a_sweep_comes_back)
{
    const char *path = path_in("sweep.h5");
    BenchCampaign expected = make_sweep(1.5), found;
    SmError error;
    write_sweep(path);
    write_sweep(path); /* replaces */
    assert_int_equal(entries(""), 1);
    if (bench_campaign_load(path, &bench_sweep_type, &found, &error)) fail_msg("%s", error.text);
    bench_front_mark(expected.point, expected.count);
    assert_int_equal(found.count, 3);
    char what[240];
    assert_true(bench_campaign_same(&found, &expected, sizeof what, what));
    assert_int_equal(plan_of(&found)->scene_hash, ~0ULL);
    assert_memory_equal(found.point, expected.point, 3 * sizeof(BenchPoint));
    assert_string_equal(found.machine.command, "shapebench sweep -o 'a b.h5'");
    assert_true(at(&found, 0)->index == 1 && at(&found, 2)->index == 6);
    assert_true(isnan(at(&found, 1)->total_ms) && !at(&found, 1)->valid);
    assert_null(bench_campaign_find(&found, 2));
    bench_campaign_free(&found);
    bench_campaign_free(&expected);
    unlink(path);
}

static SmCode load(const char *path, SmError *error)
{
    BenchCampaign sweep;
    SmCode code = bench_campaign_load(path, &bench_sweep_type, &sweep, error);
    assert_null(sweep.point);
    return code;
}

static const TestStored sweeps = {"shapebench sweep", write_sweep, load};

TEST(foreign_and_cut_files)
{
    refuses_foreign(&sweeps);
}

static void more_points(hid_t file)
{
    set_int(file, "plan", "points", 9);
}
static void many_values(hid_t file)
{
    set_int(file, "plan", "ws", 1 << 30);
}
static void no_repeats(hid_t file)
{
    set_int(file, "plan", "repeats", 0);
}
static void lose_column(hid_t file)
{
    assert_true(H5Ldelete(file, "points/sag", H5P_DEFAULT) >= 0);
}
static void lose_first(hid_t file)
{
    assert_true(H5Ldelete(file, "points/index", H5P_DEFAULT) >= 0);
}
static void short_column(hid_t file)
{
    lose_column(file);
    hsize_t size = 2;
    hid_t space = H5Screate_simple(1, &size, NULL);
    H5Dclose(H5Dcreate2(file, "points/sag", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT,
                        H5P_DEFAULT));
    H5Sclose(space);
}
static void text_column(hid_t file)
{
    lose_column(file);
    hsize_t size = 3;
    hid_t space = H5Screate_simple(1, &size, NULL);
    H5Dclose(
        H5Dcreate2(file, "points/sag", H5T_C_S1, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
}
static void set_column(hid_t file, const char *name, const int value[3])
{
    hid_t column = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(H5Dwrite(column, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0);
    H5Dclose(column);
}
static void other_index(hid_t file)
{
    set_column(file, "points/index", (const int[]){1, 5, 6});
}
static void many_samples(hid_t file)
{
    set_column(file, "points/samples", (const int[]){3, 3, 1 << 30});
}
static void negative_samples(hid_t file)
{
    set_column(file, "points/samples", (const int[]){-1, 3, 3});
}

TEST(changed_files)
{
    static const TestChange changes[] = {
        {older, "measure again"},
        {newer, "use a newer shapebench"},
        {more_points, "does not make 9 points"},
        {many_values, "1073741824 values of w"},
        {no_repeats, "0 repeats"},
        {lose_column, "dataset 'sag' is missing"},
        {lose_first, "dataset 'index' is missing"},
        {short_column, "dataset 'sag' has the wrong size"},
        {text_column, "dataset 'sag' has the wrong type"},
        {other_index, "point 1 is not one of its plan's"},
        {many_samples, "point 2 has 1073741824 samples"},
        {negative_samples, "point 0 has -1 samples"},
    };
    refuses_changed(&sweeps, changes, sizeof changes / sizeof *changes);
}

/* As of a file from before processors were told apart by more than their names. */
TEST(what_an_older_file_does_not_say_of_its_machine_is_unknown)
{
    const char *path = path_in("old.h5");
    BenchCampaign sweep;
    SmError error;
    write_sweep(path);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    for (int i = 0; i < 2; i++)
        assert_true(H5Adelete_by_name(file, "machine", i ? "l1_bytes" : "cpu_model", H5P_DEFAULT) >=
                    0);
    H5Fclose(file);
    if (bench_campaign_load(path, &bench_sweep_type, &sweep, &error)) fail_msg("%s", error.text);
    assert_string_equal(sweep.machine.cpu_model, "unknown");
    assert_int_equal(sweep.machine.l1_bytes, 0);
    assert_string_equal(sweep.machine.command, "shapebench sweep -o 'a b.h5'");
    assert_int_equal(sweep.count, 3);
    bench_campaign_free(&sweep);
    unlink(path);
}

/* In a child, whose limit on file sizes stands in for a full disk. */
static void store_on_full_disk(const char *path)
{
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit bound = {4096, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &bound);
    BenchCampaign sweep = make_sweep(9);
    SmError error = {0};
    if (bench_campaign_store(path, &sweep, &error) != SM_OUTPUT) _exit(2);
    _exit(strstr(error.text, "size limit") ? 0 : 3);
}

TEST(a_full_disk_keeps_what_was)
{
    const char *path = path_in("full.h5");
    write_sweep(path);
    pid_t child = fork();
    if (child == 0) store_on_full_disk(path);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    BenchCampaign sweep;
    assert_int_equal(entries(""), 1); /* no draft */
    assert_int_equal(bench_campaign_load(path, &bench_sweep_type, &sweep, NULL), SM_OK);
    assert_true(at(&sweep, 0)->total_ms == 1.5);
    bench_campaign_free(&sweep);
    unlink(path);
}
