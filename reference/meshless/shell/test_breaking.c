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
