/* The papers' values hang together: derived ones follow from quoted ones. */
#include "paper.h"

#include "../lib/test_frame.h"

TEST(table_1_has_its_rows)
{
    static const char *const scenes[] = {"penguin", "statue-solid", "statue-shell", "infant"};
    static const double totals[] = {0.28, 167.83, 48.47, 4.99};
    static const double regions[] = {130, 57626, 19959, 2506};
    int count;
    const RefPaperRow *row = ref_paper_rows(&count);
    assert_true(count >= 4);
    for (int n = 0; n < 4; n++) {
        assert_string_equal(row[n].paper, "fastlsm");
        assert_string_equal(row[n].scene, scenes[n]);
        assert_ptr_equal(ref_paper_find("fastlsm", scenes[n]), row + n);
        assert_true(row[n].total_ms.value == totals[n]);
        assert_true(row[n].regions.value == regions[n]);
        assert_true(row[n].regions.value <= row[n].particles.value);
        assert_int_equal(row[n].total_ms.status, REF_QUOTED);
    }
    assert_null(ref_paper_find("fastlsm", "teapot"));
    assert_null(ref_paper_find("octopus", "penguin"));
}

/* Milliseconds and percents agree to a unit of the last printed digit, or are marked damaged. */
TEST(stages_add_up)
{
    int count;
    const RefPaperRow *row = ref_paper_rows(&count);
    for (int n = 0; n < count; n++, row++) {
        double ms = 0, percent = 0, total = row->total_ms.value;
        bool damaged = false;
        for (int s = 0; s < SM_STAGES; s++) {
            assert_int_equal(isnan(row->stage_ms[s].value), isnan(row->stage_percent[s].value));
            if (isnan(row->stage_ms[s].value)) continue;
            ms += row->stage_ms[s].value;
            percent += row->stage_percent[s].value;
            double printed = row->stage_percent[s].value * total / 100;
            bool agree = fabs(row->stage_ms[s].value - printed) <= 0.01 * total + 0.005;
            if (s == SM_OTHER) continue;
            assert_int_equal(agree, row->stage_ms[s].status != REF_DAMAGED);
            damaged = damaged || !agree;
        }
        if (percent == 0) continue; /* no stages given */
        assert_true(percent == 100);
        assert_int_equal(row->stage_ms[SM_OTHER].status, REF_DERIVED);
        if (!damaged) assert_true(fabs(ms - total) < 1e-9);
    }
    const RefPaperRow *infant = ref_paper_find("fastlsm", "infant");
    assert_int_equal(infant->stage_ms[SM_SHAPE_MATCHING].status, REF_DAMAGED);
    assert_true(isnan(ref_paper_find("fastlsm", "penguin")->stage_ms[SM_DAMPING].value));
}

TEST(a_stage_is_a_column_by_its_name)
{
    RefValue value[SM_STAGES];
    const RefPaperRow *solid = ref_paper_find("fastlsm", "statue-solid");
    assert_int_equal(ref_paper_column(solid, "polar_ms", value), 1);
    assert_true(value->value == 31.66 && value->status == REF_QUOTED);
    assert_int_equal(
        ref_paper_column(ref_paper_find("fastlsm", "infant"), "shape_matching_ms", value), 1);
    assert_int_equal(value->status, REF_DAMAGED);
    assert_int_equal(ref_paper_column(solid, "polar", value), 0);
    assert_int_equal(ref_paper_column(solid, "polar_ms_", value), 0);
}

TEST(costs_per_particle_follow_from_the_table)
{
    static const char *const pairs[][2] = {{"penguin", "penguin-particle"},
                                           {"statue-solid", "solid-particle"},
                                           {"statue-shell", "shell-particle"},
                                           {"infant", "infant-particle"}};
    for (int n = 0; n < 4; n++) {
        const RefPaperRow *row = ref_paper_find("fastlsm", pairs[n][0]);
        const RefPaperClaim *claim = ref_paper_claim("fastlsm", pairs[n][1]);
        assert_non_null(claim);
        assert_int_equal(claim->value.status, REF_DERIVED);
        assert_true(fabs(row->total_ms.value * 1e6 / row->particles.value - claim->value.value) <=
                    0.5);
    }
}

/* Milliseconds are those of the frames per second, and so are the speed-ups. */
TEST(the_hand_has_its_rows)
{
    static const char *const scenes[] = {"hand-lattice", "hand-lattice-plain", "hand-regular",
                                         "hand-sampled"};
    double plain = ref_paper_find("octree", "hand-lattice-plain")->fps.value;
    for (int n = 0; n < 4; n++) {
        const RefPaperRow *row = ref_paper_find("octree", scenes[n]);
        assert_true(fabs(row->fps.value * row->total_ms.value - 1000) < 0.5);
        if (!isnan(row->speedup.value))
            assert_true(fabs(row->fps.value / plain / row->speedup.value - 1) < 0.005);
        assert_true(isnan(row->summation_nodes.value) == (n < 3));
    }
    assert_int_equal(ref_paper_find("octree", "hand-regular")->fps.status, REF_SECOND_HAND);
    assert_int_equal(ref_paper_find("octree", "hand-regular")->speedup.status, REF_SECOND_HAND);
    assert_int_equal(ref_paper_find("octree", "hand-lattice-plain")->fps.status, REF_DERIVED);
    assert_int_equal(ref_paper_find("octree", "hand-lattice")->fps.status, REF_QUOTED);
    assert_true(fabs(plain - 222.0 / 88) < 0.005);
    assert_true(ref_paper_claim("octree", "hand-rate")->value.value ==
                ref_paper_find("octree", "hand-lattice")->fps.value);
}

/* Scenes that change say what becomes of them, in numbers that agree. */
TEST(changing_scenes_have_an_end)
{
    const RefPaperRow *liver = ref_paper_find("octree", "liver");
    const RefPaperRow *flowers = ref_paper_find("octree", "flowers");
    assert_true(liver->last_particles.value > 3 * liver->particles.value);
    assert_true(liver->last_ms.value > liver->total_ms.value);
    assert_true(liver->change_ms.value < liver->change_most_ms.value);
    assert_true(flowers->particles.value + flowers->added.value == flowers->last_particles.value);
    assert_int_equal((int)(100 * flowers->added.value / flowers->particles.value), 6);
    assert_true(isnan(ref_paper_find("octree", "block")->last_particles.value));
    assert_true(isnan(ref_paper_find("fastlsm", "penguin")->change_most_ms.value));
}

/* A rate that is second-hand makes the time that is derived from it so, and the other way round. */
TEST(a_step_is_as_sound_as_its_source)
{
    static const struct {
        const char *paper, *scene;
        RefStatus status;
    } cases[] = {
        {"octree", "hand-regular", REF_SECOND_HAND},   {"octree", "liver", REF_SECOND_HAND},
        {"octree", "hand-sampled", REF_QUOTED},        {"octree", "hand-lattice", REF_QUOTED},
        {"octree", "hand-lattice-plain", REF_DERIVED}, {"fastlsm", "penguin", REF_QUOTED}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
        assert_int_equal(ref_paper_step_status(ref_paper_find(cases[c].paper, cases[c].scene)),
                         cases[c].status);
}

TEST(claims_are_complete)
{
    int count, kinds[REF_SECOND_HAND + 1] = {0};
    const RefPaperClaim *claim = ref_paper_claims(&count);
    for (int n = 0; n < count; n++) {
        assert_true(isfinite(claim[n].value.value) && claim[n].value.value >= 0);
        assert_true(claim[n].unit[0] && claim[n].place[0] && claim[n].note[0]);
        assert_ptr_equal(ref_paper_claim(claim[n].paper, claim[n].name), claim + n);
        kinds[claim[n].value.status]++;
    }
    for (RefStatus s = REF_QUOTED; s <= REF_OURS; s++) assert_true(kinds[s] > 0);
    assert_true(ref_paper_claim("fastlsm", "warm-polar")->value.value == 450);
    assert_string_equal(ref_status_name(REF_SECOND_HAND), "second-hand");
    assert_null(ref_paper_claim("fastlsm", "nothing"));
}
