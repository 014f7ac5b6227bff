/* Steps and set-up of the octree that are timed: wrong ones are found, and what they do is counted.
 */
#include "../../lib/test_frame.h"
#include "../../octree/operations.h"
#include "../check/tree_check.h"
#include "tree_body.h"

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
    BenchTreeStep steps[3] = {{.body = &body, .threads = 1, .seed = 1, .parts = true}};
    bench_tree_steps_f32.create(&steps[0]);
    assert_true(steps[0].trial.valid);
    lose_member(&body); /* it is not symmetric: only the adjoint is right */
    steps[1] = (BenchTreeStep){.body = &body, .threads = 1, .seed = 1, .parts = true};
    steps[2] = steps[1];
    steps[2].adjoint = true;
    for (int s = 1; s < 3; s++) bench_tree_steps_f32.create(&steps[s]);
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
            parts += bench_tree_steps_f32.ns(&steps[s], (BenchTreePart)p, 1);
        assert_true(parts > 0 && parts < 1e9 * whole);
    }
    for (int s = 0; s < 3; s++) bench_tree_steps_f32.free(&steps[s]);
    oct_structure_free(&body);
}

/* Prepared anew on the body of another job, which has been damaged: it is not valid. */
static void is_found_wrong(const BenchJob *other, BenchSetupKind kind, const char *says)
{
    BenchKernel kernel = *other->kernel;
    BenchJob job = *other;
    SmError error;
    kernel.part = kind;
    job.kernel = &kernel;
    job.shares = true;
    assert_int_equal(bench_jobs_time(&job, 1, &error), SM_OK);
    assert_false(job.trial->valid);
    assert_non_null(strstr(job.trial->reason, says));
    assert_null(job.trial->seconds);
    bench_jobs_close(&job, 1);
}

/* Cubes that are held to the twins, and to what regular trees are. */
TEST(a_wrong_octree_setup_is_not_timed)
{
    const BenchKernelParams params = {.precision = BENCH_F64, .threads = 1, .repeats = 2};
    for (int side = 6; side <= 12; side += 6) {
        enum { KINDS = BENCH_SETUP_WHOLE + 1 };
        BenchKernel kernel[KINDS];
        BenchJob job[KINDS];
        SmError error;
        for (int k = 0; k < KINDS; k++) {
            kernel[k] = (BenchKernel){.kind = &bench_tree_setup_kernels, .side = side, .part = k};
            job[k] = bench_job(&kernel[k], &params, NULL);
        }
        assert_int_equal(bench_jobs_open(job, KINDS, &error), SM_OK);
        for (int k = 0; k < KINDS; k++) {
            BenchKernelRow row = {.ns = 1};
            assert_int_equal(bench_jobs_time(&job[k], 1, &error), SM_OK);
            assert_true(job[k].trial->valid);
            assert_in_range(job[k].trial->samples, 1, 2);
            kernel[k].kind->report(&job[k], &row);
            /* only what builds an engine holds more than the tree, its graph and its regions */
            assert_int_equal(job[k].footprint > job[BENCH_SETUP_STRUCTURE].footprint &&
                                 k > BENCH_SETUP_STRUCTURE,
                             k == BENCH_SETUP_WHOLE);
        }
        OctStructure *body = &((BenchTreeBody *)job->body)->structure;
        body->regions.members.item[0] = body->tree.node[body->tree.leaves - 1];
        is_found_wrong(job, BENCH_SETUP_REGIONS, "region");
        oct_graph_length(&body->graph)[0]++;
        is_found_wrong(job, BENCH_SETUP_GRAPH, "edge");
        bench_jobs_close(job, KINDS);
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
