/* Steps of the octree that are timed: wrong ones are found, and what they do is counted. */
#include "../../lib/test_frame.h"
#include "tree_body.h"
#include "tree_steps.h"

/* A cube whose first region has lost a summation node that is not its own. */
static void lose_member(OctStructure *body)
{
    OctRegions *r = &body->regions;
    int lost = r->members.item[r->members.end[0] - 1];
    assert_int_not_equal(lost, body->tree.node[0]);
    sm_csr_remove(&r->members, 0, lost);
    r->size[0]--;
}

TEST(a_wrong_octree_step_is_not_timed)
{
    OctStructure body;
    SmError error;
    assert_int_equal(bench_sampled(6, &body, &error), SM_OK);
    BenchTreeStep steps[2] = {{.body = &body, .threads = 1, .seed = 1}};
    bench_tree_steps_f32.create(&steps[0]);
    assert_true(steps[0].trial.valid);
    lose_member(&body); /* it is not symmetric */
    steps[1] = (BenchTreeStep){.body = &body, .threads = 1, .seed = 1};
    bench_tree_steps_f32.create(&steps[1]);
    assert_false(steps[1].trial.valid);
    assert_non_null(strstr(steps[1].trial.reason, "brute force"));
    bench_trials_time((BenchTrial *[]){&steps[0].trial, &steps[1].trial}, 2, 2);
    assert_null(steps[1].trial.seconds);
    assert_int_equal(steps[0].trial.samples, 2);
    for (int s = 0; s < 2; s++) bench_tree_steps_f32.free(&steps[s]);
    oct_structure_free(&body);
}

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
