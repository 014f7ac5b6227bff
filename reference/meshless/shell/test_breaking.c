/* Shells that move, are held and break. */
#include "breaking.h"
#include "test_shell.h"

typedef struct {
    RefChart chart;
    RefSheet sheet;
    RefBreaking breaking;
} Strip;

/* A flat strip, 4 by 1, that breaks above a strength. */
static void strip_create(double strength, Strip *strip)
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
        strip_create(1e30, &strip);
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
        strip_create(20, strip + k);
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
