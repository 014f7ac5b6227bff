/* The check of octrees that single precision is hard put to: right engines stand it in every state.
 */
#include "../../lib/test_frame.h"
#include "../../octree/change/structure.h"
#include "../../octree/region/frames.h"
#include "runner_check.h"
#include "step_check.h"

static const SmEngineType *const octrees[] = {&octree_engine_f32, &octree_engine_f64};

/* Regions of 0.75 edges leave the hand in 121 parts, many of them pairs of nodes, which turn about
 * their axis as they last did: goals are found again only to a rounding of coordinates, which is
 * more than damping may be off once the hand moves slowly. */
TEST(parts_are_damped_right)
{
    for (int t = 0; t < 2; t++) {
        BenchScene scene;
        BenchBody body;
        BenchRunner runner;
        BenchCheck check;
        char reason[160];
        assert_int_equal(bench_scene_find("hand", &scene, NULL), SM_OK);
        strcpy(scene.engine, "octree");
        scene.octree.width = (OctWidth){.edges = 0.75};
        scene.octree.epsilon = 0;
        assert_int_equal(bench_body_of_scene(&scene, NULL, &body, NULL), SM_OK);
        assert_int_equal(bench_runner_create(&scene, &body, octrees[t], 1, &runner, NULL), SM_OK);
        bench_runner_disturb(&runner, 1);
        bench_check_begin(&scene, &body, octrees[t], runner.engine, &check);
        for (int step = 0; step < 100; step++) {
            bench_runner_step(&runner);
            BenchDeviation found = bench_check_state(&check, octrees[t], runner.engine);
            bench_check_damping(&check, &scene, octrees[t], runner.engine, &found);
            if (!bench_check_verdict(&found, sizeof reason, reason))
                fail_msg("step %d: %s", step, reason);
            assert_true(found.damping_error < 0.25 * found.damping_tolerance);
        }
        bench_check_free(&check);
        bench_runner_free(&runner);
        bench_body_free(&body);
    }
}

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchRunner runner;
    BenchCheck check;
} Trial;

static void trial_begin(const char *scene, int levels, const SmEngineType *type, Trial *t)
{
    SmError error;
    assert_int_equal(bench_scene_find(scene, &t->scene, NULL), SM_OK);
    strcpy(t->scene.engine, "octree");
    if (levels) t->scene.octree.sampling = (OctSampling){.levels = levels, .nodes = 60};
    t->scene.params.damping = 0.1;
    if (bench_body_of_scene(&t->scene, NULL, &t->body, &error) ||
        bench_runner_create(&t->scene, &t->body, type, 1, &t->runner, &error))
        fail_msg("%s: %s", scene, error.text);
    bench_check_begin(&t->scene, &t->body, type, t->runner.engine, &t->check);
}

static void trial_steps(Trial *t, int steps)
{
    char reason[160];
    BenchDeviation found;
    for (int step = 0; step < steps; step++) {
        bench_runner_step(&t->runner);
        if (!bench_check_all(&t->check, &t->runner, &found, sizeof reason, reason))
            fail_msg("%s, %s precision, step %d: %s", t->scene.name, t->runner.type->precision,
                     step, reason);
        assert_true(found.damping_tolerance > 0 && found.damping_tolerance < 0.01);
    }
}

static void trial_end(Trial *t)
{
    bench_check_free(&t->check);
    bench_runner_free(&t->runner);
    bench_body_free(&t->body);
}

/* The parts that no region joins, put as far apart as they drift in many thousand steps, each with
 * a speed of its own. */
TEST(parts_far_apart_are_right)
{
    for (int t = 0; t < 2; t++) {
        Trial trial;
        trial_begin("hand-sampled", 0, octrees[t], &trial);
        SmEngine *engine = trial.runner.engine;
        const OctStructure *s = oct_engine_structure(engine);
        size_t count = (size_t)trial.check.count;
        int *part = sm_alloc((size_t)s->tree.leaves, sizeof *part);
        double(*x)[3] = sm_alloc(count, sizeof *x), (*v)[3] = sm_alloc(count, sizeof *v);
        assert_true(oct_frames_groups(&s->tree, &s->regions, part) > 1);
        bench_runner_disturb(&trial.runner, 1);
        octrees[t]->get(engine, SM_POSITION, x);
        octrees[t]->get(engine, SM_VELOCITY, v);
        for (size_t i = 0; i < count; i++)
            for (int d = 0; d < 3; d++) {
                x[i][d] += 100.0 * part[i] * (d - 1);
                v[i][d] += 5.0 * part[i] * (1 - d);
            }
        octrees[t]->set(engine, SM_POSITION, (const double(*)[3])x);
        octrees[t]->set(engine, SM_VELOCITY, (const double(*)[3])v);
        trial_steps(&trial, 5);
        free(part);
        free(x);
        free(v);
        trial_end(&trial);
    }
}

/* Base cells of 4096 finest ones, whatever of them is filled. */
TEST(many_levels_are_right)
{
    static const char *const scenes[] = {"block", "penguin"};
    for (int n = 0; n < 4; n++) {
        Trial trial;
        trial_begin(scenes[n / 2], 12, octrees[n % 2], &trial);
        bench_runner_disturb(&trial.runner, 1);
        trial_steps(&trial, 5);
        trial_end(&trial);
    }
}
