/* Steps and set-up of the octree that are timed: wrong ones are found, and what they do is counted.
 */
#include "../../lib/test_frame.h"
#include "../../octree/operations.h"
#include "../check/tree_check.h"
#include "sampled.h"
#include "tree_setup.h"
#include "tree_steps.h"

/* A cube whose first region has lost a summation node that is not its own. */
static void lose_member(OctStructure *body)
{
    OctRegions *r = &body->regions;
    long lost = r->first[1] - 1;
    assert_int_not_equal(r->member[lost], body->tree.node[0]);
    memmove(r->member + lost, r->member + lost + 1,
            (size_t)(r->first[r->leaves] - lost - 1) * sizeof *r->member);
    for (long i = 1; i <= r->leaves; i++) r->first[i]--;
    r->size[0]--;
}

TEST(a_wrong_octree_step_is_not_timed)
{
    OctStructure body;
    SmError error;
    assert_int_equal(bench_sampled(6, &body, &error), SM_OK);
    BenchTreeStep steps[3] = {{.body = &body, .threads = 1, .seed = 1, .parts = true}};
    bench_tree_step_create_f32(&steps[0]);
    assert_true(steps[0].trial.valid);
    lose_member(&body); /* it is not symmetric: only the adjoint is right */
    steps[1] = (BenchTreeStep){.body = &body, .threads = 1, .seed = 1, .parts = true};
    steps[2] = steps[1];
    steps[2].adjoint = true;
    for (int s = 1; s < 3; s++) bench_tree_step_create_f32(&steps[s]);
    assert_false(steps[1].trial.valid);
    assert_non_null(strstr(steps[1].trial.reason, "brute force"));
    assert_true(steps[2].trial.valid);
    BenchTrial *trials[] = {&steps[0].trial, &steps[1].trial, &steps[2].trial};
    bench_trials_time(trials, 3, 2);
    assert_null(steps[1].trial.seconds);
    for (int s = 0; s < 3; s += 2) {
        double parts = 0, whole = steps[s].trial.laps[0].last; /* seconds of a clock, far more */
        assert_int_equal(steps[s].trial.samples, 2);
        for (int p = 0; p < BENCH_TREE_PARTS; p++)
            parts += bench_tree_step_ns_f32(&steps[s], (BenchTreePart)p, 1);
        assert_true(parts > 0 && parts < 1e9 * whole);
    }
    for (int s = 0; s < 3; s++) bench_tree_step_free_f32(&steps[s]);
    oct_structure_free(&body);
}

/* Cubes that are held to the twins, and to what regular trees are. */
TEST(a_wrong_octree_setup_is_not_timed)
{
    for (int side = 6; side <= 12; side += 6) {
        OctStructure body;
        BenchSetup setup;
        SmError error;
        assert_int_equal(bench_sampled(side, &body, &error), SM_OK);
        for (int kind = 0; kind <= BENCH_SETUP_WHOLE; kind++) {
            bench_setup_create(&body, (BenchSetupKind)kind, BENCH_F64, &setup);
            BenchTrial *trial = &setup.trial;
            assert_true(trial->valid);
            bench_trials_time(&trial, 1, 2);
            assert_in_range(trial->samples, 1, 2);
            assert_int_equal(setup.engine_bytes > 0, kind == BENCH_SETUP_WHOLE);
            bench_setup_free(&setup);
        }
        body.regions.member[0] = body.tree.node[body.tree.leaves - 1];
        bench_setup_create(&body, BENCH_SETUP_REGIONS, BENCH_F32, &setup);
        assert_false(setup.trial.valid);
        assert_non_null(strstr(setup.trial.reason, "region"));
        bench_setup_free(&setup);
        body.graph.length[0]++;
        bench_setup_create(&body, BENCH_SETUP_GRAPH, BENCH_F32, &setup);
        assert_false(setup.trial.valid);
        assert_non_null(strstr(setup.trial.reason, "edge"));
        bench_setup_free(&setup);
        oct_structure_free(&body);
    }
}

TEST(wrong_distances_are_found)
{
    OctStructure body;
    OctReach reach;
    SmError error;
    char reason[BENCH_TREE_REASON];
    assert_int_equal(bench_sampled(5, &body, &error), SM_OK);
    oct_reach_init(&reach, &body.graph);
    oct_reach_from(&reach, 7, OCT_FAR / 2);
    assert_true(bench_tree_check_distances(&reach, 7, reason));
    for (int by = -1; by <= 1; by += 2) {
        reach.distance[100] += by;
        assert_false(bench_tree_check_distances(&reach, 7, reason));
        reach.distance[100] -= by;
    }
    reach.distance[100] = OCT_FAR;
    assert_false(bench_tree_check_distances(&reach, 7, reason));
    oct_reach_free(&reach);
    oct_structure_free(&body);
}

/* One base cell, split down to the finest. */
TEST(octree_work_is_counted)
{
    OctStructure body;
    OctSumLists lists;
    SmError error;
    assert_int_equal(bench_sampled(16, &body, &error), SM_OK);
    oct_sum_lists_build(&body.tree, &body.regions, &lists);
    OctStepCounts c = oct_step_counts(&body.tree, &lists, &lists);
    double leaves = 16 * 16 * 16;
    assert_true(c.leaf_children == 1); /* a full octree of four levels */
    assert_true(c.inner_children == (512 + 64 + 8) / leaves);
    assert_true(c.inners == (512 + 64 + 8 + 1) / leaves);
    assert_true((c.leaf_entries + c.inner_entries) * leaves == (double)lists.entries);
    assert_true((c.goal_entries + c.goal_prefix_entries) * leaves == (double)lists.entries);
    assert_true(oct_depth_operations(&c).flops == 3 + 24 + 33 * c.inner_children);
    assert_true(oct_step_operations(&c).flops >
                oct_goal_operations(&c).flops + oct_damping_operations(&c).flops);
    oct_sum_lists_free(&lists);
    oct_structure_free(&body);
}
