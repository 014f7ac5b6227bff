/* Theory of beams: limits, and what modes must fulfil. */
#include "beam_theory.h"

#include "../lib/test_frame.h"

/* A slender beam does not shear; a thick one is softer, the more so in higher modes. */
TEST(timoshenko_tends_to_euler)
{
    double before[REF_BEAM_MODES] = {0};
    for (int length = 3; length <= 3000; length *= 10) {
        RefBeam beam = {length, 1, 0.3};
        double thin[REF_BEAM_MODES], thick[REF_BEAM_MODES];
        ref_beam_frequencies(&beam, REF_EULER, thin);
        ref_beam_frequencies(&beam, REF_TIMOSHENKO, thick);
        for (int k = 0; k < REF_BEAM_MODES; k++) {
            double ratio = thick[k] / thin[k];
            assert_true(ratio < 1 && ratio > before[k]);
            if (k) assert_true(ratio < thick[k - 1] / thin[k - 1]);
            before[k] = ratio;
        }
        double sag = ref_beam_sag(&beam, REF_TIMOSHENKO) / ref_beam_sag(&beam, REF_EULER);
        assert_true(sag > 1 && (sag - 1) * length * length < 1.01);
    }
    for (int k = 0; k < REF_BEAM_MODES; k++) assert_true(before[k] > 1 - 1e-4);
}

/* omega^2 of the first mode times the sag under a load is 12.36 / 8 of it (Euler and Bernoulli);
 * lengths and thicknesses scale. */
TEST(sag_and_frequency_belong_together)
{
    double square[2][REF_BEAM_MODES];
    RefBeam beam = {10, 1, 0.3}, larger = {20, 2, 0.3};
    ref_beam_frequencies(&beam, REF_EULER, square[0]);
    assert_true(fabs(square[0][0] * ref_beam_sag(&beam, REF_EULER) - 12.362363 / 8) < 1e-6);
    for (int theory = 0; theory < 2; theory++) {
        ref_beam_frequencies(&beam, (RefBeamTheory)theory, square[0]);
        ref_beam_frequencies(&larger, (RefBeamTheory)theory, square[1]);
        for (int k = 0; k < REF_BEAM_MODES; k++)
            assert_true(fabs(square[0][k] / square[1][k] / 4 - 1) < 1e-9);
        double ratio = ref_beam_sag(&larger, (RefBeamTheory)theory) /
                       ref_beam_sag(&beam, (RefBeamTheory)theory);
        assert_true(fabs(ratio / 4 - 1) < 1e-12);
    }
}

/* Held at the clamp, 2 at the tip, no moment there, and orthogonal. */
TEST(modes_fulfil_their_ends)
{
    enum { PARTS = 2000 };
    double product[REF_BEAM_MODES][REF_BEAM_MODES] = {{0}}, slope;
    for (int k = 0; k < REF_BEAM_MODES; k++) {
        assert_true(fabs(ref_beam_shape(k, 0, &slope)) < 1e-12 && fabs(slope) < 1e-12);
        assert_true(fabs(fabs(ref_beam_shape(k, 1, &slope)) - 2) < 1e-9);
        double tip = slope, inner;
        ref_beam_shape(k, 1 - 1e-4, &inner);
        assert_true(fabs(tip - inner) < 1e-4 * fabs(tip)); /* the slope is at its end */
    }
    for (int n = 0; n < PARTS; n++)
        for (int a = 0; a < REF_BEAM_MODES; a++)
            for (int b = 0; b < REF_BEAM_MODES; b++)
                product[a][b] += ref_beam_shape(a, (n + 0.5) / PARTS, &slope) *
                                 ref_beam_shape(b, (n + 0.5) / PARTS, &slope) / PARTS;
    for (int a = 0; a < REF_BEAM_MODES; a++)
        for (int b = 0; b < REF_BEAM_MODES; b++) assert_true(fabs(product[a][b] - (a == b)) < 1e-4);
}
