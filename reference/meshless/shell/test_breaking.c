/* Shells that move, are held and break. */
#include "../../../lib/test_random.h"
#include "../motion/rotation.h"
#include "breaking.h"
#include "foot.h"
#include "test_shell.h"

typedef struct {
    RefChart chart;
    RefSheet sheet;
    RefBreaking breaking;
} Strip;

static const double radius = 1.5;

/* A strip, 4 by 1, flat or bent around z, that breaks above a strength. */
static void strip_create(bool bent, double strength, Strip *strip)
{
    RefSheetOptions options = {.shell = {.across = 5,
                                         .basis = REF_MLS_PLANE_LINEAR,
                                         .eta = 5,
                                         .thickness = 0.05,
                                         .material = {1e4, 0.3, 1}},
                               .damping = {1, 0.002},
                               .h = 0.01};
    RefCrackedOptions cracked = {.least_share = 0.7, .most_splits = 1};
    RefFractureOptions fracture = {.strength = strength, .most_starts = 2};
    SmError error = {0};
    strip->chart = (RefChart){.high = {4, 1}, .factor = factor_one, .place = place_flat};
    if (bent) strip->chart = cylinder_chart(&radius, 4, 1);
    if (ref_sheet_create(&strip->chart, &options, &strip->sheet, &error) != SM_OK)
        fail_msg("%s", error.text);
    if (ref_breaking_create(&strip->sheet, &cracked, &fracture, &strip->breaking, &error) != SM_OK)
        fail_msg("%s", error.text);
}

static void strip_free(Strip *strip)
{
    ref_breaking_free(&strip->breaking);
    ref_sheet_free(&strip->sheet);
}

/* From the lower side to a height, or the upper side. */
static void cut(Strip *strip, double x, double to)
{
    RefCracks *cracks = &strip->breaking.cracked.cracks;
    int arm = ref_cracks_start(cracks, (double[]){x, -0.01}, -1);
    for (double y = 0.07; cracks->arm[arm].open && y < to; y += 0.08)
        ref_cracks_grow(cracks, arm, (double[]){x + 0.05 * y, y});
    assert_int_equal(ref_breaking_update(&strip->breaking, NULL), SM_OK);
}

/* How far all holds are off at most. */
static double off(const RefSheet *sheet)
{
    double most = 0;
    for (int k = 0; k < sheet->holds; k++) {
        double place, turn;
        ref_sheet_off(sheet, k, &place, &turn);
        most = fmax(most, fmax(place, turn));
    }
    return most;
}

/* One hold on one piece, two on the other one, which are moved and turned; before the strip is cut
 * through all are of one piece. */
TEST(pieces_are_held_each_for_itself)
{
    needs_solver();
    double energy[2];
    for (int through = 0; through < 2; through++) {
        static Strip strip;
        strip_create(false, 1e30, &strip);
        cut(&strip, 1.9, through ? 2 : 0.5);
        assert_int_equal(strip.sheet.warp.pieces, 1 + through);
        double at[3][3][3] = {{{0.3, 0.5}, {0.3, 0.1}, {0.3, 0.9}},
                              {{3.7, 0.5}, {3.7, 0.1}, {3.7, 0.9}},
                              {{2.4, 0.5}}};
        RefSheetGrip grip[3] = {{3, at[0], false}, {3, at[1], false}, {1, at[2], true}};
        assert_int_equal(ref_sheet_hold(&strip.sheet, 3, grip, NULL), SM_OK);
        assert_int_equal(strip.sheet.hold[1].lead, through);
        assert_int_equal(strip.sheet.followers, 2 - through);
        for (int n = 1; n <= 100; n++) {
            double angle = 0.2 * fmin(n / 60.0, 1), c = cos(angle), s = sin(angle);
            double pose[3][4] = {{c, 0, s, 4 * (1 - c)}, {0, 1, 0, 0}, {-s, 0, c, 4 * s}};
            for (int k = 1; k < 3; k++) ref_sheet_aim(&strip.sheet, k, (const double(*)[4])pose);
            ref_sheet_step(&strip.sheet);
            assert_true(off(&strip.sheet) < 1e-6);
        }
        energy[through] = ref_steps_energy(&strip.sheet.steps);
        strip_free(&strip);
    }
    assert_true(energy[1] < 0.01 * energy[0]); /* pieces are turned, and nothing is bent */
}

/* Two strips are torn from a notch. In one of them a crack cannot be followed at first, as no step
 * can be made with its damping: it goes on as it was, and later as if that had not been. */
TEST(what_cannot_be_followed_has_not_happened)
{
    needs_solver();
    static Strip strip[2];
    bool changed[2], again;
    for (int k = 0; k < 2; k++) {
        strip_create(false, 14, strip + k);
        cut(strip + k, 1.9, 0.3);
        double(*v)[3] = (double(*)[3])strip[k].sheet.steps.v;
        for (long n = 0; n < strip[k].sheet.warp.nodes; n++)
            v[n][0] = strip[k].sheet.warp.X[n][0] - 2;
    }
    const RefShell *shell = &strip[1].sheet.shell;
    RefDamping *damping = &strip[1].sheet.options.damping;
    int failures = 0, changes = 0;
    for (int n = 0; n < 20; n++) {
        long nodes = shell->nodes.count, arms = strip[1].breaking.cracked.cracks.arms;
        damping->mass_damping = n % 2 ? 1 : -1;
        SmCode code = ref_breaking_step(&strip[1].breaking, changed + 1, NULL);
        if (code != SM_OK) {
            failures++;
            assert_false(changed[1]);
            assert_int_equal(shell->nodes.count, nodes);
            assert_int_equal(strip[1].breaking.cracked.cracks.arms, arms);
            damping->mass_damping = 1;
            again = ref_fracture_grow(&strip[1].breaking.cracked, &strip[1].breaking.options,
                                      (const double(*)[3])strip[1].sheet.steps.u) > 0;
            assert_true(again);
            assert_int_equal(ref_breaking_update(&strip[1].breaking, NULL), SM_OK);
            changed[1] = true;
        }
        assert_int_equal(ref_breaking_step(&strip[0].breaking, changed, NULL), SM_OK);
        assert_int_equal(changed[0], changed[1]);
        changes += changed[0];
        assert_int_equal(shell->nodes.count, strip[0].sheet.shell.nodes.count);
        assert_memory_equal(strip[0].sheet.warp.moved, strip[1].sheet.warp.moved,
                            (size_t)shell->nodes.count * sizeof(double[3]));
    }
    print_message("%d changes, %d failures, %ld nodes\n", changes, failures, shell->nodes.count);
    assert_true(failures > 2 && changes > failures);
    for (int k = 0; k < 2; k++) strip_free(strip + k);
}

/* How far points are from where functions carry them that are taken at each alone. */
static double off_alone(const Strip *strip, const RefSkin *skin, const double (*theta)[2],
                        const double (*now)[3])
{
    const RefSheet *sheet = &strip->sheet;
    RefShape shape = ref_shape_create(&sheet->shell.nodes);
    double most = 0, lift;
    for (long s = 0; s < skin->count; s++) {
        assert_true(ref_foot_at(&sheet->shell, &sheet->warp, theta[skin->order[s]], skin->rest[s],
                                &shape, &lift));
        for (int d = 0; d < 3; d++) {
            double at = skin->rest[s][d];
            for (int n = 0; n < shape.count; n++)
                at += shape.value[n] * (sheet->warp.moved[shape.node[n]][d] +
                                        lift * sheet->warp.turned[shape.node[n]][d]);
            most = fmax(most, fabs(now[s][d] - at));
        }
    }
    ref_shape_free(&shape);
    return most;
}

/* Points beside a strip that a crack goes into are carried by what it has made of the functions and
 * normals there: they turn with a strip that turns. */
TEST(points_are_carried_after_cracks)
{
    needs_solver();
    enum { POINTS = 600 };
    static Strip strip;
    static double theta[POINTS][2], x[POINTS][3], now[POINTS][3];
    unsigned seed = 1;
    RefSheet *sheet = &strip.sheet;
    RefSkin skin;
    long loose;
    strip_create(true, 1e30, &strip);
    for (int p = 0; p < POINTS; p++) {
        double r = radius + random_between(&seed, -0.06, 0.06);
        for (int d = 0; d < 2; d++)
            theta[p][d] = random_between(&seed, 0, sheet->shell.chart.high[d]);
        x[p][0] = r * cos(theta[p][0] / radius);
        x[p][1] = r * sin(theta[p][0] / radius);
        x[p][2] = theta[p][1];
    }
    ref_foot_skin(&sheet->shell, &sheet->warp, POINTS, (const double(*)[2])theta,
                  (const double(*)[3])x, &skin, &loose);
    for (int n = 0; n < 2; n++) {
        cut(&strip, n ? 2.9 : 1.3, n ? 0.7 : 0.4);
        ref_foot_renew(&strip.breaking.cracked, &sheet->warp, (const double(*)[2])theta,
                       (const double(*)[3])x, &skin, &loose);
    }
    assert_int_equal(loose, 0);
    const double w[3] = {0.5, -1.2, 0.4};
    double R[9], shift[3], most = 0;
    for (long n = 0; n < sheet->warp.nodes; n++)
        sm_cross(w, sheet->warp.X[n], sheet->steps.u + 3 * n);
    ref_sheet_pose(sheet);
    ref_skin_place(&skin, (const double(*)[3])sheet->warp.moved,
                   (const double(*)[3])sheet->warp.turned, now);
    ref_rotation(w, R);
    for (int d = 0; d < 3; d++)
        shift[d] =
            sheet->warp.X[0][d] + sheet->warp.moved[0][d] - sm_dot(R + 3 * d, sheet->warp.X[0]);
    for (int s = 0; s < POINTS; s++)
        for (int d = 0; d < 3; d++)
            most = fmax(most, fabs(now[s][d] - sm_dot(R + 3 * d, skin.rest[s]) - shift[d]));
    assert_true(most < 1e-5);
    assert_true(off_alone(&strip, &skin, (const double(*)[2])theta, (const double(*)[3])now) <
                1e-5);
    ref_skin_free(&skin);
    strip_free(&strip);
}
