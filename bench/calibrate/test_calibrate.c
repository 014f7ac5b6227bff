/* Calibrations as a user runs them: whole, interrupted, the other way round; and mistakes. */
#define _GNU_SOURCE
#include <signal.h>
#include <unistd.h>

#include <hdf5.h>
#include <jansson.h>

#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../reference/beam_theory.h"
#include "../cli/test_program.h"
#include "../engines.h"
#include "../play/runner.h"
#include "calibration.h"

/* A short beam of two cells through; three specimens, and one with another step. */
#define SMALL                                                                                      \
    "calibrate --scene small.cfg --w 1:2 --engine fastlsm --across none --aspect none --step 2 "   \
    "--quiet"

/* One specimen and a wish: five cells through, but two where figures do not count. */
#define WISH                                                                                       \
    "calibrate --engine %s --scene %s.cfg --w 1 --across none --aspect none --step none --quiet "  \
    "--young 1.3e6 --density 800"

#define CELL (1.0 / 32)

static Result result;

static void runs(const char *arguments)
{
    run(arguments, &result);
    if (result.code) fail_msg("%s: %d: %s", arguments, result.code, result.err);
}

/* A beam from x = low to x = high, so thick. */
static void write_box(const char *name, double low, double high, double thick)
{
    char text[1024] = "";
    for (int c = 0; c < 8; c++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "v %.9g %.9g %.9g\n",
                 c & 1 ? high : low, c & 2 ? thick : 0, c & 4 ? thick : 0);
    strcat(text, "f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\n"
                 "f 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 8 6\n");
    write_text(name, text);
}

static int set_up(void **state)
{
    if (make_folder(state)) return -1;
    write_box("box.obj", 0, 0.3, 0.1);
    write_box("beam.obj", 0, 15 * CELL, 5 * CELL);
    write_box("rooted.obj", -8 * CELL, 15 * CELL, 5 * CELL);
    write_text("small.cfg", "mesh = \"box.obj\"; cell = 0.05; h = 0.001;\n");
    write_text("other.cfg", "mesh = \"box.obj\"; particles = 500; h = 0.005; density = 700;\n");
    write_text("five.cfg", "mesh = \"beam.obj\"; cell = 0.03125; h = 0.001;\n");
    write_text("fine.cfg", "mesh = \"box.obj\"; cell = 0.001; h = 0.001;\n");
    write_text("noise.h5", "no HDF5\n");
    runs(SMALL " -o whole.h5");
    return 0;
}

static void load(const char *name, BenchCampaign *calibration)
{
    SmError error;
    if (bench_campaign_load(path_in(name), &bench_calibration_type, calibration, &error))
        fail_msg("%s", error.text);
}

TEST(a_specimen_has_its_figures)
{
    BenchCampaign c;
    load("whole.h5", &c);
    const BenchCalibrationPlan *plan = c.plan;
    const BenchSpecimen *specimen = c.point;
    assert_true(plan->across == 2 && plan->aspect == 3 && plan->h == 1e-3);
    assert_int_equal(c.count, 4);
    for (int i = 0; i < 4; i++) {
        const BenchSpecimen *s = &specimen[i];
        assert_true(s->valid && s->unrest < BENCH_REST && s->particles > 0 && s->stamp.wall > 0);
        assert_true(s->sag > 9e-4 && s->sag < 1.1e-3 && s->spread < 0.5);
        assert_true(fabs(s->young_timoshenko[1] / s->young_timoshenko[0] - 1) < 0.03);
        assert_int_equal(isfinite(s->young_meshless[0]), plan->meshless);
    }
    assert_true(specimen[1].young > 2 * specimen[0].young);
    assert_true(fabs(specimen[0].young / specimen[2].young - 4) < 1e-3); /* twice the step */
    assert_true(specimen[0].linear_to >= 0.1 && isnan(specimen[2].linear_to));
    bench_campaign_free(&c);
}

/* The file has all specimens of whole.h5, the same to the last bit but for the time they took. */
static void equals_whole(const char *name)
{
    BenchCampaign whole, other;
    load("whole.h5", &whole);
    load(name, &other);
    assert_int_equal(other.count, whole.count);
    BenchSpecimen *ours = other.point, *theirs = whole.point;
    for (int i = 0; i < whole.count; i++) ours[i].stamp = theirs[i].stamp;
    assert_memory_equal(ours, theirs, 4 * sizeof *ours);
    bench_campaign_free(&whole);
    bench_campaign_free(&other);
}

static void add_group(const char *name)
{
    hid_t file = H5Fopen(name, H5F_ACC_RDWR, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, "note", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(file);
}

/* Interrupted as soon as a specimen is stored; what is there is not measured again, though another
 * program has written to the file. */
TEST(an_interrupted_calibration_goes_on)
{
    char said[512];
    assert_int_equal(interrupt(SMALL " -o part.h5", "part.h5"), 128 + SIGINT);
    slurp("err", said, sizeof said);
    assert_non_null(strstr(said, "interrupted: part.h5 keeps the specimens that are finished"));
    assert_int_equal(entries(".tmp"), 0);
    BenchCampaign part;
    load("part.h5", &part);
    assert_in_range(part.count, 1, 3);
    double took = ((BenchSpecimen *)part.point)->stamp.wall;
    bench_campaign_free(&part);
    add_group("part.h5");
    runs(SMALL " --resume -o part.h5");
    equals_whole("part.h5");
    load("part.h5", &part);
    assert_true(((BenchSpecimen *)part.point)->stamp.wall == took);
    bench_campaign_free(&part);
}

/* Two ranks do the same as one. */
TEST(ranks_share_the_work)
{
    run_ranks(SMALL " -o ranks.h5", &result);
    if (result.code) fail_msg("%d: %s", result.code, result.err);
    equals_whole("ranks.h5");
}

TEST(tables_in_every_format)
{
    runs("calibrate whole.h5 --young 1e6");
    assert_non_null(strstr(result.out, "4 of 4 specimens"));
    assert_non_null(strstr(result.out, "An elastic beam behaves alike: in 4 valid"));
    assert_non_null(strstr(result.out, " a time step of "));
    runs("calibrate whole.h5 --format csv --young 1e6");
    assert_non_null(strstr(result.out, "young_meshless_4,wall\n"));
    assert_non_null(strstr(result.err, " a time step of "));
    int lines = 0, commas = 0;
    for (const char *c = result.out; *c; c++) {
        lines += *c == '\n';
        commas += *c == ',' && lines == 0;
    }
    assert_int_equal(lines, 5);
    assert_int_equal(commas, 25 + 2 * 2 + 3 * 3 - 1); /* three tones, four moduli */
    runs("calibrate whole.h5 --format json");
    json_t *root = json_loads(result.out, 0, NULL);
    assert_int_equal(json_array_size(json_object_get(root, "specimens")), 4);
    assert_int_equal(json_array_size(json_object_get(root, "found")), BENCH_FOUND);
    assert_true(json_is_object(json_object_get(root, "environment")));
    json_decref(root);
    runs("calibrate whole.h5 --format markdown");
    assert_non_null(strstr(result.out, "| engine | w | epsilon |"));
    runs("calibrate whole.h5 --format latex");
    assert_non_null(strstr(result.out, "\\begin{tabular}"));
}

/* The tip's sag of a beam at rest, held behind x = 0; where nodes are in cells its end is half a
 * cell farther, which adds as much of the sag as its slope there does. */
static double sag_of(const char *name)
{
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    BenchBody body;
    BenchRunner runner;
    SmError error;
    const SmEngineType *type;
    SmCode code = bench_scene_read(path_in(name), scene, &error);
    if (!code) code = bench_engine_find(scene->engine, "double", &type, &error);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, &error);
    if (!code) code = bench_runner_create(scene, &body, type, 1, &runner, &error);
    if (code) {
        fail_msg("%s", error.text);
        return NAN;
    }
    double(*v)[3] = sm_alloc((size_t)runner.particles, sizeof *v), end = 0, sag = 0;
    for (int step = 0; step < (TEST_FIGURES ? 1500 : 15); step++) {
        bench_runner_step(&runner);
        type->get(runner.engine, SM_VELOCITY, v);
        for (long p = 0; p < runner.particles; p++)
            for (int d = 0; d < 3; d++) v[p][d] *= 0.9;
        type->set(runner.engine, SM_VELOCITY, (const double(*)[3])v);
    }
    type->get(runner.engine, SM_POSITION, v);
    for (long p = 0; p < runner.particles; p++) end = fmax(end, runner.x0[p][0]);
    int tips = 0;
    for (long p = 0; p < runner.particles; p++) {
        if (runner.x0[p][0] < end - 1e-9) continue;
        sag += runner.x0[p][1] - v[p][1];
        tips++;
    }
    double s = end / (15 * CELL);
    bench_runner_free(&runner);
    bench_body_free(&body);
    free(scene);
    free(v);
    return sag / tips / (s * s * (6 - 4 * s + s * s) / 3);
}

/* What is printed for a wish is all that a scene needs to have it: a beam of these settings sags as
 * an elastic one does. Without the density, which is one of them, a lattice's does not. */
TEST(the_settings_printed_have_the_modulus)
{
    const RefBeam beam = {15 * CELL, 5 * CELL, 0.3};
    const double young = 1.3e6, density = 800, gravity = 2;
    double wanted = ref_beam_sag(&beam, REF_TIMOSHENKO) * density * gravity / young;
    for (int engine = 0; engine < 2; engine++) {
        static const char clamp[] =
            "mesh = \"rooted.obj\"; cell = 0.03125; gravity = [0.0, -2.0, 0.0];\n"
            "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.3479, 1.0, 1.0]; } );\n";
        char text[2048], line[256];
        snprintf(line, sizeof line, WISH, engine ? "octree --epsilon 0.5" : "fastlsm",
                 TEST_FIGURES ? "five" : "small");
        runs(line);
        const char *settings = strstr(result.out, ".cfg these lines hit it");
        assert_non_null(settings);
        settings = strchr(settings, '\n') + 1;
        snprintf(text, sizeof text, "%s%s", settings, clamp);
        write_text("wish.cfg", text);
        double sag = sag_of("wish.cfg");
        if (!TEST_FIGURES) continue;
        if (fabs(sag / wanted - 1) > 0.05) fail_msg("sags %g, promised %g", sag, wanted);
        char *rho = strstr(text, "density");
        assert_non_null(rho);
        memset(rho, ' ', strcspn(rho, ";") + 1);
        write_text("light.cfg", text);
        double light = sag_of("light.cfg");
        assert_true(engine ? fabs(light / sag - 1) < 1e-6 : light < 0.9 * sag);
    }
}

/* What is printed for a scene keeps its particles, and takes its density. */
TEST(the_settings_printed_are_the_scenes)
{
    runs("calibrate whole.h5 --young 1e9 --scene other.cfg");
    const char *settings = strstr(result.out, "In the scene other.cfg these lines hit it");
    assert_non_null(settings);
    assert_non_null(strstr(settings, "\n    w = 2;\n    h = "));
    assert_non_null(strstr(settings, "\n    density = 700;\n"));
    assert_null(strstr(settings, "cell ="));
    run("calibrate whole.h5 --young 1e9 --scene no.cfg", &result);
    assert_int_equal(result.code, 3);
}

/* With all of the relative motion damped away at every step a beam swings by rounding alone. A
 * lattice's takes 400,000 steps to be found out on some instruction sets, the octree's few on all.
 */
TEST(a_beam_that_does_not_swing_is_invalid)
{
    run("calibrate --scene small.cfg --w 1 --engine octree --epsilon 0 --across none --aspect none "
        "--step none --damping 1 -o bad.h5",
        &result);
    assert_int_equal(result.code, 1);
    assert_non_null(strstr(result.err, "1 of 1 specimens are INVALID"));
    assert_non_null(strstr(result.out, "INVALID"));
    BenchCampaign bad;
    load("bad.h5", &bad);
    const BenchSpecimen *s = bad.point;
    assert_true(!s->valid && s->reason[0] && isnan(s->young) && isnan(s->frequency[0]) &&
                isnan(s->sag));
    bench_campaign_free(&bad);
}

TEST(mistakes_are_one_line)
{
    static const Mistake cases[] = {
        {"calibrate --w 3:1", 2, "--w: 3:1 falls"},
        {"calibrate --density 800", 2, "--density is that of --young's body: give both"},
        {"calibrate whole.h5 --scene small.cfg", 2, "--scene is that of --young where FILE.h5"},
        {"calibrate --w 1.5", 2, "--w: 1.5 is no whole number"},
        {"calibrate --w none", 2, "--w: 'none' is not a range"},
        {"calibrate --w 0:3", 2, "--w: 0 is not from 1 to 32"},
        {"calibrate --epsilon -1", 2, "--epsilon: -1 is not from 0 to 4"},
        {"calibrate --aspect 2", 2, "--aspect: 2 is not from 3 to 100"},
        {"calibrate --across 2.5", 2, "--across: 2.5 is no whole number"},
        {"calibrate --step 0", 2, "--step: 0 is not from 0.001 to 1000"},
        {"calibrate --engine brute", 2, "'brute' is not one of both, fastlsm, octree; see"},
        {"calibrate --engine shell", 2, "fastlsm, octree: it has no w and epsilon; its Young's"},
        {"calibrate --damping 2", 2, "--damping: '2'"},
        {"calibrate --poisson 0.5", 2, "--poisson: '0.5'"},
        {"calibrate --young 0", 2, "--young: '0'"},
        {"calibrate --young lots", 2, "--young: 'lots'"},
        {"calibrate --format tiff", 2, "'tiff' is not one of text"},
        {"calibrate --scene nothing", 2, "neither a built-in scene"},
        {"calibrate --scene penguin", 3, "its body is no beam"},
        {"calibrate --scene block", 3, "its body is no beam"},
        {"calibrate --scene fine.cfg", 3, "its beam is 100 cells thick; 1 to 64 can be"},
        {"calibrate whole.h5 --resume", 2, "whole.h5 alone is shown as it is"},
        {"calibrate a.h5 b.h5", 2, "what is 'b.h5'?"},
        {"calibrate whole.h5 --w 3", 2, "whole.h5 alone is shown as it is"},
        {"calibrate whole.h5 -o x.h5", 2, "whole.h5 alone is shown as it is"},
        {"calibrate noise.h5", 3, "noise.h5: not an HDF5 file"},
        {"calibrate no.h5", 3, "no.h5: no such file"},
        {"sweep whole.h5", 3, "whole.h5"},
        {SMALL " -o noise.h5", 3, "noise.h5: not an HDF5 file"},
        {SMALL " -o nowhere/x.h5", 4, "create the folder first"},
        {SMALL " --poisson 0.2 -o whole.h5", 3,
         "whole.h5 holds another calibration: its poisson is 0.3, and here 0.2"},
        {SMALL " --w 1 -o whole.h5", 3, "its w is 2 numbers from 1 to 2, and here 1 from 1 to 1"},
        {SMALL " --step none -o whole.h5", 3, "its step is 1 numbers from 2 to 2, and here 0"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

TEST_GROUP(set_up, remove_folder)
