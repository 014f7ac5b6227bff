/* Plans, laws, recommendations and files of calibrations, on specimens whose laws are known. */
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "calibration.h"

static const BenchCalibrationPlan sample_plan = {.scene = "beam",
                                                 .engines = "both",
                                                 .build = "this",
                                                 .across = 5,
                                                 .aspect = 8,
                                                 .thickness = 0.1,
                                                 .h = 1e-3,
                                                 .density = 1000,
                                                 .poisson = 0.3,
                                                 .ws = 4,
                                                 .epsilons = 2,
                                                 .acrosses = 2,
                                                 .aspects = 2,
                                                 .steps = 2,
                                                 .w = {1, 2, 5, 9},
                                                 .epsilon = {0, 0.5},
                                                 .other_across = {5, 10},
                                                 .other_aspect = {4, 16},
                                                 .step = {0.5, 2}};

/* E = rho (a / h)^2 w (w + 1) (c + d w (w + 1) (a / t)^2 / (1 + 3 w a / L)); an epsilon doubles it.
 */
static double two_terms(const BenchSpecimen *s, double c, double d)
{
    double speed = s->spacing / s->h, W = s->w * (s->w + 1.0), length = 0.1 * s->aspect;
    double size = W * pow(s->spacing / 0.1, 2) / (1 + 3 * s->w * s->spacing / length);
    return 1000 * speed * speed * W * (c + d * size) * (s->epsilon > 0 ? 2 : 1);
}

/* A calibration, and what follows from it. */
typedef struct {
    BenchCampaign campaign;
    BenchCalibrationPlan *plan;
    BenchSpecimen *specimen;
    long count;
    BenchConclusion its;
} Made;

static void conclude(Made *made)
{
    made->campaign.count = made->count;
    made->its = bench_calibration_conclude(&made->campaign);
}

/* All specimens of the plan, finished and valid, with a law's modulus. */
static Made *make(double c, double d)
{
    Made *made = sm_alloc(1, sizeof *made);
    made->campaign = bench_campaign_create(&bench_calibration_type);
    made->plan = made->campaign.plan;
    *made->plan = sample_plan;
    assert_int_equal(bench_calibration_type.count(made->plan, NULL), SM_OK);
    made->count = made->plan->specimens;
    made->specimen = sm_alloc((size_t)made->count, sizeof *made->specimen);
    for (int i = 0; i < made->count; i++) {
        BenchSpecimen *s = &made->specimen[i];
        bench_campaign_point(&made->campaign, i, s);
        s->valid = true;
        s->young = two_terms(s, c, d);
        s->spread = 0.02;
        s->loss[0] = 1e-6;
        for (int y = 0; y < BENCH_YOUNGS; y++) s->young_timoshenko[y] = s->young * (1 + 0.005 * y);
    }
    made->campaign.point = made->specimen;
    conclude(made);
    return made;
}

static void let_go(Made *made)
{
    bench_campaign_free(&made->campaign);
    free(made);
}

static SmCode store(const char *name, Made *made, SmError *error)
{
    made->campaign.count = made->count;
    return bench_campaign_store(path_in(name), &made->campaign, error);
}

static SmCode load(const char *name, Made *made, SmError *error)
{
    SmCode code =
        bench_campaign_load(path_in(name), &bench_calibration_type, &made->campaign, error);
    if (code) return code;
    made->plan = made->campaign.plan;
    made->specimen = made->campaign.point;
    made->count = made->campaign.count;
    conclude(made);
    return code;
}

/* Of four w: both engines, one and two epsilons; another spacing for all (the scene's own is no
 * other), other lengths and steps for the first, the middle and the last. */
TEST(a_plan_makes_its_specimens)
{
    Made *made = make(0.3, 0.1);
    assert_int_equal(made->plan->specimens, 4 * 3 + 4 * 2 + 2 * 3 * 2 + 2 * 3 * 2);
    const BenchSpecimen *s = made->specimen;
    assert_string_equal(s[0].engine, "fastlsm");
    assert_true(s[1].epsilon == 0 && s[2].epsilon == 0.5 && s[3].w == 2);
    assert_false(s[3].wide || s[4].wide); /* 5 nodes through 5 cells; the lattice has 6 */
    assert_true(s[6].wide && s[7].wide);
    assert_true(s[12].across == 10 && fabs(s[12].spacing - 0.01) < 1e-15);
    assert_string_equal(s[12].set, "spacing");
    assert_true(s[20].aspect == 4 && s[22].w == 5 && s[24].w == 9 && s[26].aspect == 16);
    assert_true(s[32].h == 5e-4 && s[43].h == 2e-3);
    for (int i = 0; i < made->count; i++) assert_int_equal(s[i].index, i);
    let_go(made);
    BenchCalibrationPlan plan = sample_plan;
    SmError error;
    plan.w[1] = 2.5;
    assert_int_equal(bench_calibration_type.count(&plan, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "--w: 2.5 is no whole number"));
    plan = sample_plan;
    strcpy(plan.engines, "octree");
    assert_int_equal(bench_calibration_type.count(&plan, &error), SM_OK);
    plan.ws = plan.epsilons = BENCH_CALIBRATION_VALUES;
    for (int i = 0; i < BENCH_CALIBRATION_VALUES; i++)
        plan.w[i] = i + 1, plan.epsilon[i] = 0.01 * i;
    assert_int_equal(bench_calibration_type.count(&plan, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "specimens; 1 to 4096"));
}

static void near_to(const double found[3], double wanted)
{
    assert_true(fabs(found[0] - wanted) < 1e-6);
    assert_true(found[1] <= found[0] && found[0] <= found[2]);
}

TEST(two_terms_are_found_again)
{
    Made *made = make(0.3, 0.1);
    assert_int_equal(made->its.laws, 2);
    for (int e = 0; e < 2; e++) {
        const BenchStiffnessFit *law = &made->its.law[e];
        assert_string_equal(law->engine, e ? "octree" : "fastlsm");
        near_to(law->c, 0.3);
        near_to(law->d, 0.1);
        assert_true(law->scatter < 1e-9 && law->c[2] - law->c[1] < 1e-6);
        assert_int_equal(law->specimens, 4 + 4 + 6 + 6); /* the first epsilon's alone */
    }
    for (long i = 0; i < made->count; i++) made->specimen[i].young *= 1 + 0.02 * (i % 3 - 1);
    BenchStiffnessFit exact = made->its.law[0],
                      noisy = bench_calibration_conclude(&made->campaign).law[0];
    assert_true(noisy.c[1] < 0.3 && noisy.c[2] > 0.3 && noisy.c[2] - noisy.c[1] > 1e-3);
    assert_true(noisy.scatter > 100 * exact.scatter);
    for (int i = 0; i < BENCH_FOUND; i++) assert_true(made->its.found[i][0]);
    assert_non_null(strstr(made->its.found[0], "in 44 valid specimens of 44"));
    assert_non_null(strstr(made->its.found[1], "fastlsm c = 0.300 (0.300 to 0.300)"));
    assert_non_null(strstr(made->its.found[2], "from w 5"));
    assert_non_null(strstr(made->its.found[2], "up to 2 times as stiff"));
    let_go(made);
}

/* Specimens whose sag and frequencies disagree are described as they are: those of w 1 and 5 of a
 * beam of 5 cells, while w 9 agrees. */
TEST(what_is_apart_is_described_as_it_is)
{
    Made *made = make(0.3, 0.1);
    int apart = 0;
    for (long i = 0; i < made->count; i++) {
        BenchSpecimen *s = &made->specimen[i];
        if (s->across != 5 || (s->w != 1 && s->w != 5)) continue;
        s->spread = 0.2;
        apart++;
    }
    conclude(made);
    char wanted[160];
    snprintf(wanted, sizeof wanted,
             "in %d specimens, whose regions are 0.6 to 2.2 times as wide as the beam is thick.",
             apart);
    if (!strstr(made->its.found[2], wanted)) fail_msg("%s", made->its.found[2]);
    for (long i = 0; i < made->count; i++) made->specimen[i].spread = 0.02;
    conclude(made);
    assert_non_null(strstr(made->its.found[2], "apart in 0 specimens."));
    let_go(made);
}

TEST(nothing_is_concluded_from_nothing)
{
    Made *made = make(0.3, 0.1);
    long count = made->count;
    made->count = 2;
    conclude(made);
    assert_int_equal(made->its.laws, 0);
    assert_true(made->its.found[0][0] && !made->its.found[1][0]);
    for (long i = 0; i < count; i++) made->specimen[i].valid = false;
    made->count = count;
    conclude(made);
    assert_int_equal(made->its.laws, 0);
    assert_true(!made->its.found[0][0] && !made->its.found[2][0]);
    char sentence[BENCH_WORDS];
    BenchYoung wish = {1e6, 1000, 1000, 0.02};
    assert_int_equal(bench_recommendation_young(made->specimen, count, &wish, sentence), -1);
    assert_non_null(strstr(sentence, "no specimen of the grid is valid"));
    made->count = 0;
    conclude(made);
    assert_int_equal(made->its.laws, 0);
    let_go(made);
}

/* For cells that are so many times as large as the specimens'. */
static long advise(const Made *made, double young, double density, double times, char *sentence)
{
    const BenchSpecimen *s = made->specimen;
    BenchYoung wish = {young, density, made->plan->density, times * s->spacing};
    return bench_recommendation_young(s, made->count, &wish, sentence);
}

TEST(a_modulus_has_its_w)
{
    char text[BENCH_WORDS];
    Made *made = make(0.3, 0.1);
    double young = made->specimen[3].young; /* fastlsm w 2; the octree's is the same */
    made->specimen[4].spread = 0.01;
    for (double times = 1; times < 3; times++) {
        /* the octree's is more elastic; twice the density has twice the modulus */
        assert_int_equal(advise(made, 1.05 * young, 1000, times, text), 4);
        assert_non_null(strstr(text, "take octree with w 2 and epsilon 0"));
        assert_int_equal(advise(made, 2 * young, 2000, times, text), 4);
        /* between two w: the time step goes with 1 / sqrt(E) */
        assert_int_equal(advise(made, 1.25 * young, 1000, times, text), 3);
        assert_non_null(strstr(text, "No w and epsilon is within 10%"));
        char step[48];
        snprintf(step, sizeof step, "a time step of %.4g s hits", times * 1e-3 / sqrt(1.25));
        assert_non_null(strstr(text, step));
        assert_int_equal(advise(made, 4 * made->specimen[11].young, 1000, times, text), 11);
    }
    made->specimen[4].valid = false;
    assert_int_equal(advise(made, young, 1000, 1, text), 3);
    let_go(made);
}

TEST(a_calibration_comes_back)
{
    Made *made = make(0.3, 0.1), *back = sm_alloc(1, sizeof *back);
    SmError error;
    made->specimen[5].valid = false;
    strcpy(made->specimen[5].reason, "it broke");
    made->specimen[5].young = NAN;
    made->count = 7; /* one that was interrupted */
    conclude(made);
    assert_int_equal(store("a.h5", made, &error), SM_OK);
    if (load("a.h5", back, &error)) fail_msg("%s", error.text);
    char what[240];
    assert_true(bench_campaign_same(&made->campaign, &back->campaign, sizeof what, what));
    assert_int_equal(back->count, 7);
    assert_memory_equal(back->specimen, made->specimen, 7 * sizeof *made->specimen);
    assert_int_equal(back->its.laws, made->its.laws);
    assert_string_equal(back->its.found[1], made->its.found[1]);
    back->plan->poisson = 0.25;
    assert_false(bench_campaign_same(&made->campaign, &back->campaign, sizeof what, what));
    assert_string_equal(what, "its poisson is 0.25, and here 0.3");
    *back->plan = *made->plan;
    back->plan->steps = 0;
    assert_false(bench_campaign_same(&made->campaign, &back->campaign, sizeof what, what));
    assert_non_null(strstr(what, "its step is 0 numbers"));
    let_go(made);
    let_go(back);
}

/* A file whose specimens or plan are another's is refused, as is one cut off. */
TEST(foreign_files_are_refused)
{
    Made *made = make(0.3, 0.1), *back = sm_alloc(1, sizeof *back);
    SmError error;
    made->specimen[2].w = 7;
    assert_int_equal(store("b.h5", made, &error), SM_OK);
    assert_int_equal(load("b.h5", back, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "specimen 2 is not one of its plan's"));
    made->specimen[2].w = 1;
    made->plan->specimens = 7;
    assert_int_equal(store("b.h5", made, &error), SM_OK);
    assert_int_equal(load("b.h5", back, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "its plan does not make 7 specimens"));
    made->plan->specimens = 44;
    made->plan->epsilon[1] = -1;
    assert_int_equal(store("b.h5", made, &error), SM_OK);
    assert_int_equal(load("b.h5", back, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "its plan has -1 as epsilon"));
    assert_int_equal(truncate(path_in("b.h5"), 3000), 0);
    assert_int_equal(load("b.h5", back, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "b.h5: "));
    assert_int_equal(load("no.h5", back, &error), SM_INPUT);
    assert_int_equal(store("no/b.h5", made, &error), SM_OUTPUT);
    let_go(made);
    free(back);
}
