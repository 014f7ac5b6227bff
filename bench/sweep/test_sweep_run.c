/* Sweeps as a user runs them: whole, interrupted, by mpirun; and mistakes. */
#define _GNU_SOURCE
#include <signal.h>
#include <unistd.h>

#include <jansson.h>

#include "../../lib/system/heap.h"
#include "../../lib/test_frame.h"
#include "../cli/test_program.h"
#include "sweep.h"

/* A small body that a force pushes; three points. */
#define SMALL                                                                                      \
    "sweep --scene small.cfg --w 6 --epsilon 0,0.5 --frames 3 --repeats 2 --block 0.1 --quiet"

static void runs(const char *arguments)
{
    Result *result = malloc(sizeof *result);
    run(arguments, result);
    if (result->code) fail_msg("%s: %d: %s", arguments, result->code, result->err);
    free(result);
}

static void load(const char *name, BenchCampaign *sweep)
{
    SmError error;
    if (bench_campaign_load(path_in(name), &bench_sweep_type, sweep, &error))
        fail_msg("%s", error.text);
}

static BenchPoint *point(const BenchCampaign *sweep, long i)
{
    return bench_campaign_at(sweep, i);
}

/* whole.h5 with times of our own: where others take the processors a point has none, and which is
 * the cheapest is the machine's to say. */
static void set_times(void)
{
    BenchCampaign sweep;
    load("whole.h5", &sweep);
    for (int i = 0; i < sweep.count; i++)
        point(&sweep, i)->total_ms = point(&sweep, i)->total_low_ms =
            point(&sweep, i)->total_high_ms = 1 + i;
    SmError error;
    if (bench_campaign_store(path_in("timed.h5"), &sweep, &error)) fail_msg("%s", error.text);
    bench_campaign_free(&sweep);
}

static int set_up(void **state)
{
    if (make_folder(state)) return -1;
    write_text("small.cfg",
               "mesh = \"shape:block\"; particles = 125; w = 1; bend = 0.3; steps_per_frame = 2;\n"
               "forces = ( { box_low = [0.0, 0.5, 0.0]; box_high = [1.0, 1.0, 1.0];\n"
               "             force = [1.0, 0.0, 0.0]; } );\n"
               "octree = { levels = 1; nodes = 20; };\n");
    write_text("held.cfg", "mesh = \"shape:block\"; particles = 512; bend = 0.3;\n"
                           "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.01, 1.0, 1.0]; "
                           "} );\n"
                           "octree = { levels = 1; };\n");
    write_text("noise.h5", "no HDF5\n");
    runs(SMALL " -o whole.h5");
    set_times();
    return 0;
}

/* Is the field the same in every run? The state in which goals are checked depends on how many
 * steps fill a block. */
static bool repeats(const char *name)
{
    static const char *const other[] = {"total_ms",   "total_low_ms", "total_high_ms", "stage_ms",
                                        "goal_error", "wall",         "build_seconds", "front",
                                        "rank",       "host",         "utc",           "samples",
                                        "reason",     "sample",       "bytes"}; /* none, and why,
                                                      where others took the processors */
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++)
        if (!strcmp(name, other[i])) return false;
    return true;
}

/* The file has all points of whole.h5, and what repeats is the same to the last bit. */
static void equals_whole(const char *name)
{
    BenchCampaign whole, other;
    load("whole.h5", &whole);
    load(name, &other);
    assert_int_equal(other.count, whole.count);
    for (long i = 0; i < whole.count; i++)
        for (int f = 0; f < bench_point_field_count; f++) {
            const BenchField *field = &bench_point_fields[f];
            const char *a = (const char *)point(&whole, i) + field->offset,
                       *b = (const char *)point(&other, i) + field->offset;
            if (field->name && repeats(field->name) && memcmp(a, b, field->size) != 0)
                fail_msg("%s: %s of point %ld differs", name, field->name, i);
        }
    bench_campaign_free(&whole);
    bench_campaign_free(&other);
}

static void near_to(double value, double wanted)
{
    if (!(fabs(value - wanted) <= 1e-9 * wanted)) fail_msg("%.17g is not %.17g", value, wanted);
}

/* Whether what the library allocates is counted: not under sanitizers. */
static bool heap_is_known(void)
{
    enum { SIZE = 1 << 20 };
    long before = sm_heap_used();
    void *memory = sm_alloc(SIZE, 1);
    long more = sm_heap_used() - before;
    free(memory);
    assert_true(more == 0 || more >= SIZE);
    return more > 0;
}

TEST(a_point_has_its_figures)
{
    BenchCampaign sweep;
    load("whole.h5", &sweep);
    assert_int_equal(bench_campaign_planned(&sweep), 3);
    assert_int_equal(sweep.count, 3);
    const BenchPoint *lattice = point(&sweep, 0), *exact = lattice + 1, *wide = lattice + 2;
    for (int i = 0; i < 3; i++) {
        const BenchPoint *p = point(&sweep, i);
        assert_true(p->valid && p->goal_error < 5e-5 && (p->bytes > 0 || !heap_is_known()));
        if (p->samples > 0) { /* else others took the processors */
            double stages = 0;
            for (int s = 0; s < SM_STAGES; s++) stages += p->stage_ms[s];
            assert_int_equal(p->samples, 2);
            near_to(p->total_ms, 1e3 * (p->sample[0] + p->sample[1]) / 2);
            near_to(stages, p->total_ms);
            assert_true(p->build_seconds + p->sample[0] + p->sample[1] <= p->stamp.wall);
        }
        assert_true(p->sag > 0 && p->frequency > 0);
        /* A beam under a constant load: omega^2 sag is 1.53 g / length (Euler and Bernoulli's
         * 12.36 and 1/8), somewhat less where shear counts. */
        double omega = 6.283185307179586 * p->frequency;
        assert_in_range((long)(1000 * omega * omega * p->sag * 0.8 / 9.81), 1200, 1700);
        assert_true(p->stamp.host[0] && p->stamp.utc[0] && p->stamp.rank == 0);
    }
    assert_true(lattice->path_rms == 0 && lattice->goal_rms == 0 && lattice->full_w == 6);
    assert_true(exact->goal_rms == 0 && exact->goal_most == 0); /* epsilon is 0 */
    assert_true(exact->path_rms > 0 && exact->path_rms <= exact->path_most && exact->path_most < 1);
    assert_true(exact->summation_nodes >= 1 && exact->width_cells >= 6);
    assert_true(wide->frequency > exact->frequency); /* wider regions are stiffer */
    bench_campaign_free(&sweep);
}

/* Interrupted as soon as a point is stored, and again, until nothing is left. */
TEST(an_interrupted_sweep_goes_on)
{
    char said[512];
    assert_int_equal(interrupt(SMALL " -o part.h5", "part.h5"), 128 + SIGINT);
    slurp("err", said, sizeof said);
    assert_non_null(strstr(said, "interrupted: part.h5 keeps the points that are finished"));
    assert_int_equal(entries(".tmp"), 0);
    BenchCampaign part;
    load("part.h5", &part);
    assert_in_range(part.count, 1, 2);
    char utc[sizeof(BenchStamp){0}.utc], begun[sizeof part.machine.utc];
    strcpy(utc, point(&part, 0)->stamp.utc);
    strcpy(begun, part.machine.utc);
    bench_campaign_free(&part);
    runs(SMALL " -o part.h5");
    equals_whole("part.h5");
    load("part.h5", &part);
    assert_string_equal(point(&part, 0)->stamp.utc, utc); /* not measured again */
    assert_string_equal(part.machine.utc, begun);
    bench_campaign_free(&part);
}

TEST(other_options_do_not_mix)
{
    static const Mistake cases[] = {
        {SMALL " --seed 5 -o whole.h5", 3,
         "whole.h5 holds another sweep: its seed is 1, and here 5"},
        {SMALL " --w 5 -o whole.h5", 3, "its w is 1 numbers from 6 to 6"},
        {SMALL " --engine octree -o whole.h5", 3, "its engines is 'both', and here 'octree'"},
        {SMALL " --width cells -o whole.h5", 3, "its width is 'edges', and here 'cells'"},
        {SMALL " --scene held.cfg -o whole.h5", 3, "its scene is 'small', and here 'held'"},
        {SMALL " --mesh ball.obj -o whole.h5", 3, "its mesh_hash differs: the mesh has changed"},
        {SMALL " -o noise.h5", 3, "noise.h5: not an HDF5 file"},
        {"sweep noise.h5", 3, "noise.h5: not an HDF5 file"},
    };
    write_text("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n"
                           "f 1 4 3\n");
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
    equals_whole("whole.h5");
}

TEST(mistakes_are_one_line)
{
    static const Mistake cases[] = {
        {"sweep --w 8:1", 2, "--w: 8:1 falls"},
        {"sweep --w 0:8", 2, "--w: 0 is not from 0.01 to 1000"},
        {"sweep --w 1:8:0.5", 2, "1.5 is no half-width of fastlsm"},
        {"sweep --epsilon 0:1:0", 2, "--epsilon: the step 0 is not above 0"},
        {"sweep --epsilon 0:1000:1e-6", 2, "is more than 256 numbers"},
        {"sweep --w 1:64 --engine octree --epsilon 0:1:0.005", 2, "12864 points"},
        {"sweep --engine brute", 2, "'brute' is not one of both, fastlsm, octree"},
        {"sweep --engine shell", 2, "fastlsm, octree: it has no w and epsilon; its Young's"},
        {"sweep --repeats 65", 2, "--repeats: '65'"},
        {"sweep --scene nothing", 2, "neither a built-in scene"},
        {"sweep --mesh nothing.obj", 3, "nothing.obj"},
        {"sweep --w 32:33", 2, "--w: 33 is no half-width of fastlsm"},
        {"sweep missing.h5", 3, "missing.h5: no such file"},
        {"sweep a.h5 b.h5", 2, "what is 'b.h5'?"},
        {"sweep whole.h5 --w 3", 2, "whole.h5 alone is shown as it is"},
        {"sweep whole.h5 -o x.h5", 2, "whole.h5 alone is shown as it is"},
        {SMALL " -o nowhere/x.h5", 4, "create the folder first"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

/* A handle that holds lattice vertices on a face, and no node's centre. */
TEST(a_point_that_cannot_be_is_invalid)
{
    Result *result = malloc(sizeof *result);
    run("sweep --scene held.cfg --w 7 --epsilon 0 --frames 2 --repeats 1 --block 0.1 -o held.h5",
        result);
    assert_int_equal(result->code, 1);
    assert_non_null(strstr(result->err, "1 of 2 points are INVALID"));
    assert_non_null(strstr(result->out, "INVALID"));
    assert_non_null(strstr(result->out, "handle 1 selects no particle"));
    BenchCampaign sweep;
    load("held.h5", &sweep);
    assert_true(point(&sweep, 0)->valid);
    assert_true(point(&sweep, 0)->front || !point(&sweep, 0)->samples);
    assert_false(point(&sweep, 1)->valid || point(&sweep, 1)->front);
    assert_true(point(&sweep, 1)->total_ms != point(&sweep, 1)->total_ms); /* NaN */
    assert_non_null(strstr(point(&sweep, 1)->path_why, "selects no particle"));
    assert_true(point(&sweep, 1)->frequency > 0); /* the beam's */
    bench_campaign_free(&sweep);
    free(result);
}

/* The command that is recommended has the w and the epsilon recommended. */
TEST(a_recommended_command_gives_that_w)
{
    static const char *const wanted[] = {", w 6, cell ",
                                         "regions: w = 6 x the node's edge, epsilon 0"};
    Result *result = malloc(sizeof *result);
    char command[2][256];
    run("sweep timed.h5 --stiffness 2 --deviation 100", result);
    static const char before[] = "\n  shapebench ";
    const char *at = result->out;
    for (int c = 0; c < 2; c++) {
        at = strstr(at, before);
        assert_non_null(at);
        int length = 0;
        at += sizeof before - 1;
        while (at[length] && at[length] != '\n') length++;
        snprintf(command[c], sizeof command[c], "%.*s --frames 1 --no-output", length, at);
    }
    for (int c = 0; c < 2; c++) {
        run(command[c], result);
        if (result->code || !strstr(result->out, wanted[c]))
            fail_msg("%s: %s%s", command[c], result->out, result->err);
    }
    free(result);
}

TEST(tables_in_every_format)
{
    Result *result = malloc(sizeof *result);
    run("sweep timed.h5 --stiffness 2 --deviation 100", result);
    assert_int_equal(result->code, 0);
    assert_non_null(strstr(result->out, "3 of 3 points"));
    assert_non_null(strstr(result->out, "and a deviation of at most 100% take octree w 6 "));
    run("sweep whole.h5 --format csv", result);
    int lines = 0, commas = 0;
    for (const char *c = result->out; *c; c++) {
        lines += *c == '\n';
        commas += *c == ',' && lines == 0;
    }
    assert_int_equal(lines, 4);
    assert_int_equal(commas, 35 + 4 - 1); /* a column a member, five of the stages */
    run("sweep timed.h5 --format json --recommend", result);
    assert_non_null(strstr(result->err, "How stiff is the body to be?"));
    assert_non_null(strstr(result->err, "\n    fastlsm w 6: 1.00 ms a step of"));
    json_t *root = json_loads(result->out, 0, NULL);
    assert_int_equal(json_array_size(json_object_get(root, "points")), 3);
    const json_t *point = json_array_get(json_object_get(root, "points"), 0);
    assert_true(json_is_null(json_object_get(point, "summation_nodes"))); /* of a lattice */
    assert_true(json_is_string(json_object_get(json_object_get(root, "environment"), "cpu")));
    json_decref(root);
    run("sweep whole.h5 --format markdown", result);
    assert_non_null(strstr(result->out, "| engine | w edges | epsilon |"));
    run("sweep whole.h5 --format latex", result);
    assert_non_null(strstr(result->out, "\\begin{tabular}"));
    free(result);
}

/* The second rank has no such scene: the first does its points and says whose are missing. */
static void a_rank_that_cannot_stops_no_other(Result *result)
{
    run_with("ASAN_OPTIONS=detect_leaks=0 timeout 100 mpirun --allow-run-as-root --oversubscribe "
             "-n 2 sh -c '[ ${OMPI_COMM_WORLD_RANK-$PMI_RANK} = 0 ] || "
             "set -- \"$1\" sweep --scene no.cfg -o lame.h5; exec \"$@\"' sh",
             SMALL " -o lame.h5", result);
    assert_int_equal(result->code, 3);
    assert_non_null(strstr(result->err, "rank 1: no.cfg: no such file"));
    BenchCampaign sweep;
    load("lame.h5", &sweep);
    assert_int_equal(sweep.count, 2);
    bench_campaign_free(&sweep);
}

/* Two ranks do the same as one. Without MPI a launch of two is refused in a line. */
TEST(ranks_share_the_work)
{
    static Result result;
    run_ranks(SMALL " -o ranks.h5", &result);
    if (result.code) fail_msg("%d: %s", result.code, result.err);
    equals_whole("ranks.h5");
    BenchCampaign sweep;
    load("ranks.h5", &sweep);
    for (int i = 0; i < 3; i++) assert_int_equal(point(&sweep, i)->stamp.rank, i % 2);
    bench_campaign_free(&sweep);
    a_rank_that_cannot_stops_no_other(&result);
}

/* Points of two machines cannot be set beside each other without a word. */
TEST(several_hosts_are_said)
{
    static char text[8192];
    BenchCampaign sweep = bench_campaign_create(&bench_sweep_type);
    strcpy(((BenchPlan *)sweep.plan)->width, "edges");
    for (int i = 0; i < 2; i++) {
        BenchPoint next = bench_point_none();
        next.index = i;
        strcpy(next.stamp.host, i ? "there" : "here");
        bench_campaign_add(&sweep, &next);
        FILE *file = fmemopen(text, sizeof text, "w");
        bench_campaign_print(file, BENCH_AS_TEXT, &sweep);
        fclose(file);
        assert_int_equal(strstr(text, "Points are of several hosts (here, there)") != NULL, i);
    }
    bench_campaign_free(&sweep);
}

TEST_GROUP(set_up, remove_folder)
