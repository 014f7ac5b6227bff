#define _GNU_SOURCE

#include "../../fastlsm/fastlsm.h"
#include "../../lib/test_frame.h"
#include "../sweep/bending.h"
#include "experiments.h"
#include "scene_field.h"

static BenchLab quick_lab(void)
{
    return (BenchLab){.quick = true, .threads = 1, .seed = 1};
}

/* The curve, until the next one is measured. */
static const BenchCurve *curve_of(BenchLab *lab, const BenchMeasure *measure)
{
    int curve = bench_experiment(lab, measure);
    return &lab->curve[curve];
}

TEST(ranges_are_even_and_rise)
{
    int number[BENCH_RANGE_POINTS];
    assert_int_equal(bench_range_numbers(&(BenchRange){1, 8, 4}, number), 4);
    const int doubled[] = {1, 2, 4, 8};
    assert_memory_equal(number, doubled, sizeof doubled);
    int count = bench_range_numbers(&(BenchRange){1, 4, 20}, number);
    assert_int_equal(count, 4); /* what falls together is there once */
    assert_int_equal(bench_range_numbers(&(BenchRange){7, 7, 1}, number), 1);
    assert_int_equal(number[0], 7);
}

TEST(smoothing_reaches_four_widths_and_is_measured_once)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SMOOTHING, .w = {1, 3, 3}};
    int curve = bench_experiment(&lab, &measure), curves = lab.curves;
    assert_true(lab.curve[curve].valid && lab.curve[curve].points == 3);
    assert_true(lab.curve[curve].y[2] > lab.curve[curve].y[0]);
    for (int c = 0; c < lab.curves; c++) {
        const BenchCurve *profile = &lab.curve[c];
        int w;
        double all = 0;
        if (!strstr(profile->name, ".profile")) continue;
        assert_int_equal(sscanf(profile->name, "smoothing.w%d", &w), 1);
        for (int p = 0; p < profile->points; p++) {
            all += profile->y[p];
            assert_true(p <= 4 * w || profile->y[p] < 1e-12); /* two goals, two w each */
        }
        assert_true(fabs(all - 1) < 1e-12 && profile->y[4 * w] > 1e-9);
    }
    assert_int_equal(bench_experiment(&lab, &measure), curve);
    assert_int_equal(lab.curves, curves);
    bench_lab_free(&lab);
}

/* The bar of the widest regions has cells that nothing reaches, too. */
TEST(the_widest_profile_ends_in_nothing)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SMOOTHING, .w = {16, 16, 1}};
    assert_true(lab.curves == 0 && bench_experiment(&lab, &measure) == 1);
    const BenchCurve *profile = &lab.curve[0];
    assert_string_equal(profile->name, "smoothing.w16.profile");
    assert_int_equal(profile->points, 4 * 16 + 3);
    assert_true(profile->y[64] > 1e-9 && profile->y[65] < 1e-12 && profile->y[66] < 1e-12);
    bench_lab_free(&lab);
}

/* An interval for all points together is wider than one for each. */
TEST(intervals_are_for_all_points)
{
    double value[15];
    BenchCurve curve;
    for (int i = 0; i < 15; i++) value[i] = 1 + i;
    bench_curve_begin(&curve, "x", "y");
    bench_curve_sample(&curve, 1, value, 15, 0.5, 1);
    bench_curve_sample(&curve, 2, value, 15, 0.5, 12);
    assert_true(curve.y[0] == 8 && curve.low[0] == 4 && curve.high[0] == 12);
    assert_true(curve.y[1] == 8 && curve.low[1] == 2 && curve.high[1] == 14);
}

/* A gradient that jumps at one plane by a known amount. */
TEST(jumps_are_found)
{
    enum { N = 5 };
    double g[N * N * N][3];
    for (int p = 0; p < N * N * N; p++) {
        g[p][0] = p % N;
        g[p][1] = p / N % N;
        g[p][2] = (double)(p / (N * N)) * 1.5;
        if (p % N > 2) g[p][1] += 0.75 * (p % N - 2);
    }
    const int size[3] = {N, N, N};
    assert_true(fabs(bench_deform_jump(size, (const double(*)[3])g) - 0.75) < 1e-12);
}

TEST(the_bar_bends_and_twists_by_half_a_turn)
{
    const double along = 40, radius = along / M_PI;
    double a[3], b[3];
    bench_deform_place((const double[3]){0, 0, -along / 2}, along, a);
    bench_deform_place((const double[3]){0, 0, along / 2}, along, b);
    assert_true(fabs(b[2] - a[2] - 2 * radius) < 1e-12 && fabs(b[0] - a[0]) < 1e-12);
    bench_deform_place((const double[3]){1, 0, along / 2}, along, b);
    assert_true(fabs(b[1] - 1) < 1e-12); /* a quarter turn at either end */
    bench_deform_place((const double[3]){1, 2, 0}, along, b);
    assert_true(b[0] == 1 && b[1] == 2 && b[2] == 0);
}

TEST(scenes_give_their_fields)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SCENE};
    strcpy(measure.scene, "penguin");
    strcpy(measure.field, "stage_percent");
    int shares = bench_experiment(&lab, &measure);
    double sum = 0;
    if (lab.curve[shares].busy) {
        bench_lab_free(&lab);
        skip_because("other programs take the processors");
    }
    assert_int_equal(lab.curve[shares].points, SM_STAGES);
    for (int s = 0; s < SM_STAGES; s++) sum += lab.curve[shares].y[s];
    assert_true(fabs(sum - 100) < 1e-6);
    strcpy(measure.field, "ns_per_particle_step");
    const BenchRow *row = &lab.row[0];
    int each = bench_experiment(&lab, &measure);
    assert_true(fabs(lab.curve[each].y[0] / row->ns_per_particle_step - 1) < 1e-9);
    assert_true(lab.curve[each].low[0] <= lab.curve[each].y[0]);
    assert_true(lab.curve[each].high[0] >= lab.curve[each].y[0]);
    strcpy(measure.field, "particles");
    int particles = bench_experiment(&lab, &measure);
    assert_true(lab.curve[particles].y[0] == 150);
    assert_true(lab.rows == 1 && lab.curve[particles].row == 0);
    bench_lab_free(&lab);
}

/* The stages of a step, each with its interval, add up to the step; of many bodies each has a part
 * of it. */
TEST(stages_and_bodies_share_the_step)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SCENE};
    strcpy(measure.scene, "penguin");
    double sum = 0;
    for (int s = 0; s < SM_STAGES; s++) {
        snprintf(measure.field, sizeof measure.field, "%s_ms", sm_stage_name((SmStage)s));
        int stage = bench_experiment(&lab, &measure);
        const BenchCurve *curve = &lab.curve[stage];
        if (curve->busy) {
            bench_lab_free(&lab);
            skip_because("other programs take the processors");
        }
        assert_true(curve->valid && curve->points == 1);
        assert_true(curve->low[0] <= curve->high[0]);
        sum += curve->y[0];
    }
    assert_true(fabs(sum / lab.row[0].total_ms - 1) < 1e-9);
    strcpy(measure.field, "body_ms");
    int body = bench_experiment(&lab, &measure);
    assert_true(fabs(lab.curve[body].y[0] / lab.row[0].total_ms - 1) < 1e-9);
    assert_true(lab.rows == 1 && lab.row[0].instances == 1);
    bench_lab_free(&lab);
}

/* In a cube a region has the mean of 2w + 1, less what is cut off at the ends of a row, along each
 * axis; bars and plates add as much along one at a time, and running sums do not know of w. */
TEST(additions_of_a_cube_are_known)
{
    enum { SIDE = 64 };
    BenchLab lab = quick_lab();
    for (int w = 1; w <= 2; w++) {
        double row = 2 * w + 1 - w * (w + 1.0) / SIDE, share = row / (2 * w + 1);
        const double wanted[] = {[SM_SUM_NAIVE] = share * share * share, [SM_SUM_BARS] = share};
        for (SmSummation sums = SM_SUM_FAST; sums <= SM_SUM_NAIVE; sums++) {
            BenchMeasure measure = {
                .experiment = BENCH_TRY_ADDITIONS, .summation = sums, .w = {w, w, 1}};
            const BenchCurve *curve = curve_of(&lab, &measure);
            assert_true(curve->valid && curve->points == 1 && curve->x[0] == w);
            if (sums == SM_SUM_FAST)
                assert_true(curve->y[0] > 0.9 && curve->y[0] < 1.2);
            else
                assert_true(fabs(curve->y[0] - wanted[sums]) < 1e-9);
        }
    }
    bench_lab_free(&lab);
}

/* A body without gaps or corners has one bar and one plate an index; any other has more. Naive
 * sums add a region's members, and the mean side is that of their mean. */
TEST(subsums_of_bodies_are_told_apart)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SUBSUMS, .w = {1, 2, 2}};
    for (int plates = 0; plates < 2; plates++) {
        strcpy(measure.field, plates ? "one-plate" : "one-bar");
        strcpy(measure.scene, "beam");
        int curve = bench_experiment(&lab, &measure);
        assert_true(lab.curve[curve].y[0] == 100 && lab.curve[curve].y[1] == 100);
        strcpy(measure.scene, "penguin");
        curve = bench_experiment(&lab, &measure);
        assert_true(lab.curve[curve].y[0] < 100 && lab.curve[curve].y[0] > 0);
        assert_true(lab.curve[curve].y[1] < 100 && lab.curve[curve].y[1] > 0);
    }
    BenchMeasure body = {.experiment = BENCH_TRY_BODY_ADDITIONS,
                         .summation = SM_SUM_NAIVE,
                         .scene = "penguin",
                         .w = {1, 3, 3}};
    int naive = bench_experiment(&lab, &body);
    for (int p = 0; p < 3; p++) {
        double side = lab.curve[naive].x[p];
        assert_true(fabs(side * side * side / lab.curve[naive].y[p] - 1) < 1e-12);
        assert_true(side < 2 * (p + 1) + 1);
    }
    bench_lab_free(&lab);
}

/* The sums of a body by all three ways, each held to naive sums in double precision. */
TEST(sums_of_a_body_are_timed)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_BODY_SUMS, .scene = "penguin", .w = {1, 2, 2}};
    for (measure.summation = SM_SUM_FAST; measure.summation <= SM_SUM_NAIVE; measure.summation++) {
        const BenchCurve *curve = curve_of(&lab, &measure);
        if (curve->busy) {
            bench_lab_free(&lab);
            skip_because("other programs take the processors");
        }
        assert_true(curve->valid && curve->points == 2);
        assert_true(curve->y[0] > 0 && curve->x[1] > curve->x[0] && curve->x[1] < 5);
    }
    strcpy(measure.scene, "hand-sampled");
    assert_non_null(strstr(curve_of(&lab, &measure)->reason, "on a lattice"));
    bench_lab_free(&lab);
}

/* Smoothed, a bent body comes nearer to its rest shape with every step; what a plastic block keeps
 * of its fall an elastic one does not. */
TEST(what_is_left_is_seen)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {
        .experiment = BENCH_TRY_LEFT, .scene = "penguin", .field = "smoothed", .n = {1, 64, 4}};
    const BenchCurve *curve = curve_of(&lab, &measure);
    assert_true(curve->valid && curve->points == 4 && curve->y[3] < 0.1 * curve->y[0]);
    for (int p = 1; p < 4; p++) assert_true(curve->y[p] < curve->y[p - 1]);
    BenchMeasure block = {.experiment = BENCH_TRY_LEFT, .scene = "block", .n = {40, 40, 1}};
    double plastic = curve_of(&lab, &block)->y[0];
    block.without = BENCH_WITHOUT_CREEP;
    int elastic = bench_experiment(&lab, &block);
    assert_true(lab.curve[elastic].valid && plastic > 10 * lab.curve[elastic].y[0]);
    bench_lab_free(&lab);
}

TEST(fingers_are_pushed)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_PUSHED, .scene = "hand-stiffness"};
    strcpy(measure.field, "others-percent");
    const BenchCurve *others = curve_of(&lab, &measure);
    assert_true(others->valid && others->y[0] >= 0 && others->y[0] < 100);
    strcpy(measure.field, "softness");
    double soft = curve_of(&lab, &measure)->y[0];
    measure.without = BENCH_WITHOUT_WIDTHS;
    int even = bench_experiment(&lab, &measure);
    assert_true(lab.curve[even].valid && soft > lab.curve[even].y[0]);
    strcpy(measure.scene, "penguin");
    assert_non_null(strstr(curve_of(&lab, &measure)->reason, "two forces"));
    bench_lab_free(&lab);
}

TEST(distances_reach_farther_for_more)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {
        .experiment = BENCH_TRY_DISTANCES, .scene = "hand-sampled-whole", .n = {4, 16, 3}};
    const BenchCurve *curve = curve_of(&lab, &measure);
    assert_true(curve->busy || (curve->valid && curve->points == 3));
    for (int p = 1; p < curve->points; p++) assert_true(curve->x[p] > curve->x[p - 1]);
    strcpy(measure.scene, "penguin");
    assert_non_null(strstr(curve_of(&lab, &measure)->reason, "no octree"));
    bench_lab_free(&lab);
}

TEST(what_cannot_be_measured_is_not_valid)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SCENE};
    strcpy(measure.scene, "no-such-scene");
    strcpy(measure.field, "particles");
    int curve = bench_experiment(&lab, &measure);
    assert_false(lab.curve[curve].valid);
    assert_non_null(strstr(lab.curve[curve].reason, "no-such-scene"));
    measure = (BenchMeasure){.experiment = BENCH_TRY_SAG, .w = {1, 2, 2}};
    strcpy(measure.scene, "penguin");
    curve = bench_experiment(&lab, &measure);
    assert_false(lab.curve[curve].valid);
    bench_lab_free(&lab);
}

/* At rest, about as far as the limit of small sags says of the same beam: it sags by 4 to 8%. */
TEST(a_beam_hangs_where_it_comes_to_rest)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SAG, .w = {5, 8, 2}};
    strcpy(measure.scene, "beam");
    int number = bench_experiment(&lab, &measure);
    const BenchCurve *curve = &lab.curve[number];
    assert_true(curve->valid && curve->points == 2);
    for (int p = 0; p < 2; p++) {
        BenchBending small;
        bench_bending_measure(&fastlsm_engine_f64, curve->x[p], 0, &small);
        double share = curve->y[p] / (0.8 * small.sag);
        if (!(share > 0.9 && share < 1.1)) fail_msg("w %g: %g", curve->x[p], share);
        assert_true(curve->low[p] == curve->y[p] && curve->high[p] == curve->y[p]);
    }
    bench_lab_free(&lab);
}

TEST(cubes_of_both_engines_are_timed)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_SIZE, .n = {6, 10, 3}};
    int timed = 0;
    for (int engine = 0; engine < 2; engine++) {
        strcpy(measure.engine, engine ? "octree" : "fastlsm");
        strcpy(measure.field, engine ? "sums" : "");
        int number = bench_experiment(&lab, &measure);
        const BenchCurve *curve = &lab.curve[number];
        if (curve->busy) continue;
        if (!curve->valid) fail_msg("%s", curve->reason);
        assert_true(curve->points == 3 && curve->x[2] == 1000 && curve->y[0] > 0);
        timed++;
    }
    bench_lab_free(&lab);
    needs(timed == 2, "others took the processors: not both engines were timed");
}

/* The searches alone are a part of a change. */
TEST(searches_are_a_part_of_resampling)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {
        .experiment = BENCH_TRY_RESAMPLING, .scene = "liver", .field = "distance-share"};
    int number = bench_experiment(&lab, &measure);
    const BenchCurve *curve = &lab.curve[number];
    if (!curve->valid && !curve->busy) fail_msg("%s", curve->reason);
    if (!curve->busy) assert_true(curve->points == 1 && curve->y[0] > 0 && curve->y[0] < 100);
    strcpy(measure.scene, "hand-lattice");
    number = bench_experiment(&lab, &measure);
    assert_true(!lab.curve[number].valid && strstr(lab.curve[number].reason, "is no octree"));
    bench_lab_free(&lab);
}

static BenchCurve choice(BenchLab *lab, BenchMeasure measure, const char *scene, const char *field)
{
    strcpy(measure.scene, scene);
    strcpy(measure.field, field);
    int number = bench_experiment(lab, &measure); /* moves lab->curve */
    if (!lab->curve[number].valid) fail_msg("%s", lab->curve[number].reason);
    return lab->curve[number];
}

/* Only union takes in what lies beyond (1 + epsilon) w, and only without symmetry does epsilon make
 * regions' lists shorter. */
TEST(regions_are_measured_by_their_symmetry)
{
    BenchLab lab = quick_lab();
    for (int s = 0; s < 3; s++) {
        BenchMeasure measure = {
            .experiment = BENCH_TRY_REGIONS, .symmetry = (OctSymmetry)s, .n = {2, 8, 2}};
        BenchCurve beyond = choice(&lab, measure, "hand-sampled-whole", "beyond_percent");
        const char *field = s == OCT_INTERSECTION ? "parts" : "summation_nodes";
        BenchCurve also = choice(&lab, measure, "hand-sampled-whole", field);
        assert_true(also.points == 2 && also.x[0] == 0.5 && also.x[1] == 2);
        for (int p = 0; p < 2; p++) {
            assert_true((beyond.y[p] > 1) == (s == OCT_UNION));
            assert_true(s == OCT_UNION || beyond.y[p] == 0);
            if (s == OCT_INTERSECTION) assert_true(also.y[p] > 1);
        }
        if (s == OCT_ASYMMETRIC) assert_true(also.y[1] < also.y[0]);
        if (s == OCT_UNION) assert_true(also.y[1] > also.y[0]);
    }
    bench_lab_free(&lab);
}

/* By volume a beam is as thick as the cells that it touches: five instead of four, (5/4)^2 as
 * stiff. */
TEST(stiffness_by_volume_depends_on_the_place)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_PLACEMENT};
    double material = choice(&lab, measure, "", "").y[0];
    measure.masses = OCT_VOLUME;
    double volume = choice(&lab, measure, "", "").y[0];
    assert_true(material > 1.1 && material < 1.25);
    assert_true(volume > 1.5 && volume < 1.65);
    bench_lab_free(&lab);
}

/* Kicked hard, a body of narrow regions gains energy, unless it is damped. */
TEST(energy_stays_but_with_plain_weights_and_hard_kicks)
{
    BenchLab lab = quick_lab();
    BenchMeasure measure = {.experiment = BENCH_TRY_GROWTH, .width = 1, .n = {2, 200, 2}};
    BenchCurve found = choice(&lab, measure, "penguin", "");
    assert_true(found.points == 2 && found.x[0] == 0.02 && found.x[1] == 2);
    if (!(fabs(found.y[0] - 1) < 0.05 && found.y[1] > 1.3))
        fail_msg("%g and %g", found.y[0], found.y[1]);
    measure.width = 2;
    assert_true(fabs(choice(&lab, measure, "penguin", "").y[1] - 1) < 0.05);
    measure.width = 1;
    measure.damping = 2;
    assert_true(choice(&lab, measure, "penguin", "").y[1] < 0.9);
    measure = (BenchMeasure){.experiment = BENCH_TRY_GROWTH, .n = {2, 2, 1}};
    assert_true(fabs(choice(&lab, measure, "hand-sampled-whole", "").y[0] - 1) < 0.05);
    measure.weighting = OCT_PLAIN;
    assert_true(choice(&lab, measure, "hand-sampled-whole", "").y[0] > 1.5);
    bench_lab_free(&lab);
}
