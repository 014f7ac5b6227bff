/* What the octree paper's figures show, in numbers: fingers that move apart, a soft pinky and a
 * stiff thumb, a dent that stays, flowers that share their structure. */
#include "../../lib/polar.h"
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../octree/engine.h"
#include "../../octree/surface/surface.h"
#include "../engines.h"
#include "../play/runner.h"

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchRunner runner;
    double (*x)[3]; /* [runner.particles] */
} Run;

static void find_scene(const char *name, Run *run)
{
    SmError error;
    if (bench_scene_find(name, &run->scene, &error)) fail_msg("%s", error.text);
}

static void make_body(Run *run)
{
    SmError error;
    if (bench_body_of_scene(&run->scene, NULL, &run->body, &error)) fail_msg("%s", error.text);
}

/* At rest, on the body that is there. */
static void start(Run *run)
{
    SmError error;
    const SmEngineType *type;
    bool failed = bench_engine_find(run->scene.engine, NULL, &type, &error) ||
                  bench_runner_create(&run->scene, &run->body, type, 1, &run->runner, &error);
    if (failed) fail_msg("%s", error.text);
    run->x = sm_alloc((size_t)run->runner.particles, sizeof *run->x);
}

static void end(Run *run)
{
    free(run->x);
    bench_runner_free(&run->runner);
}

static void steps(Run *run, int count)
{
    for (int step = 0; step < count; step++) bench_runner_step(&run->runner);
    run->runner.type->get(run->runner.engine, SM_POSITION, run->x);
}

/* Steps, each slowed down as a whole, until nothing moves by 10 micrometres a second. */
static void settle(Run *run)
{
    const SmEngineType *type = run->runner.type;
    SmEngine *engine = run->runner.engine;
    double fastest = INFINITY;
    for (int step = 0; step < 6000 && !(step > 300 && fastest < 1e-5); step++) {
        bench_runner_step(&run->runner);
        type->get(engine, SM_VELOCITY, run->x);
        fastest = 0;
        for (long p = 0; p < run->runner.particles; p++)
            for (int d = 0; d < 3; d++) {
                run->x[p][d] *= 0.98;
                fastest = fmax(fastest, fabs(run->x[p][d]));
            }
        type->set(engine, SM_VELOCITY, (const double(*)[3])run->x);
    }
    if (!(fastest < 1e-5)) fail_msg("still moves by %g m/s", fastest);
    type->get(engine, SM_POSITION, run->x);
}

/* Largest distance between where nodes `at` are and where the rigid motion that fits nodes `by`
 * best takes them. */
static double off_rigid(const Run *run, const bool *by, const bool *at)
{
    static const double same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double(*x0)[3] = (const double(*)[3])run->runner.x0;
    double count = 0, c0[3] = {0}, c[3] = {0}, A[9] = {0}, R[9], worst = 0;
    for (long p = 0; p < run->runner.count; p++)
        for (int d = 0; by[p] && d < 3; d++) {
            c0[d] += x0[p][d];
            c[d] += run->x[p][d];
            count += d == 0;
        }
    if (count < 4) fail_msg("%g nodes make no rigid motion", count);
    for (int d = 0; d < 3; d++) c0[d] /= count, c[d] /= count;
    for (long p = 0; p < run->runner.count; p++)
        for (int e = 0; by[p] && e < 9; e++)
            A[e] += (run->x[p][e / 3] - c[e / 3]) * (x0[p][e % 3] - c0[e % 3]);
    sm_polar_robust(A, same, 1e-9, R);
    for (long p = 0; p < run->runner.count; p++) {
        double square = 0;
        for (int i = 0; at[p] && i < 3; i++) {
            double off = run->x[p][i] - c[i];
            for (int d = 0; d < 3; d++) off -= R[i * 3 + d] * (x0[p][d] - c0[d]);
            square += off * off;
        }
        worst = fmax(worst, sqrt(square));
    }
    return worst;
}

enum { FINGERS = 4 };

/* Index, middle, ring finger and pinky of shape:hand, from where they leave the palm. */
static const double finger[FINGERS][2][3] = {
    {{-0.0139, 0.1123, -0.0057}, {-0.0235, 0.1717, 0.0040}},
    {{0.0047, 0.1168, -0.0057}, {0.0017, 0.1830, 0.0040}},
    {{0.0237, 0.1150, -0.0057}, {0.0280, 0.1759, 0.0040}},
    {{0.0423, 0.1088, -0.0057}, {0.0518, 0.1556, 0.0040}},
};

/* A place's share of the way from a finger's root to its tip; its distance from that line. */
static double along(int which, const double place[3], double *distance)
{
    const double *root = finger[which][0], *tip = finger[which][1];
    double share = 0, length = 0, square = 0;
    for (int d = 0; d < 3; d++) {
        share += (place[d] - root[d]) * (tip[d] - root[d]);
        length += (tip[d] - root[d]) * (tip[d] - root[d]);
    }
    share /= length;
    for (int d = 0; d < 3; d++) square += pow(place[d] - root[d] - share * (tip[d] - root[d]), 2);
    *distance = sqrt(square);
    return share;
}

/* A finger's nodes from one share of its length to another. */
static void part_of(const Run *run, int which, double from, double to, bool *in)
{
    for (long p = 0; p < run->runner.count; p++) {
        double distance, other;
        double share = along(which, run->runner.x0[p], &distance);
        in[p] = share >= from && share <= to && distance < 0.018;
        for (int f = 0; f < FINGERS; f++) {
            along(f, run->runner.x0[p], &other);
            in[p] &= other >= distance;
        }
    }
}

/* How far a finger's tip is from where its own knuckle and lower half carry it. */
static double bend_of(const Run *run, int which)
{
    bool *root = sm_alloc((size_t)run->runner.count, sizeof *root);
    bool *tip = sm_alloc((size_t)run->runner.count, sizeof *tip);
    part_of(run, which, -0.35, 0.5, root);
    part_of(run, which, 0.8, 2, tip);
    double bend = off_rigid(run, root, tip);
    free(root);
    free(tip);
    return bend;
}

/* Holds the wrist, and a fingertip a centimetre along an axis: 0 to the side, 2 forward. */
static void hold(Run *run, int which, int axis)
{
    size_t n = (size_t)run->runner.count;
    long *wrist = sm_alloc(n, sizeof *wrist), *pulled = sm_alloc(n, sizeof *pulled);
    bool *tip = sm_alloc(n, sizeof *tip);
    SmHandle handle[2] = {{.particle = wrist, .pose = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
                          {.particle = pulled, .pose = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
    handle[1].pose[axis][3] = 0.01;
    part_of(run, which, 0.8, 2, tip);
    for (long p = 0; p < run->runner.count; p++) {
        if (run->runner.x0[p][1] < 0.03) wrist[handle[0].count++] = p;
        if (tip[p]) pulled[handle[1].count++] = p;
    }
    run->runner.type->bound(run->runner.engine, &(SmBoundary){.handle_count = 2, .handle = handle});
    free(wrist);
    free(pulled);
    free(tip);
}

/* bent[a][b]: how much finger b, next to a, bends when a's tip is pulled, relative to a. */
static double neighbours_bend(Run *run, int axis, double bent[FINGERS][FINGERS])
{
    double mean = 0;
    run->scene.handle_count = 0;
    run->scene.params.damping = 0.3;
    make_body(run);
    for (int a = 0; a < FINGERS; a++) {
        start(run);
        hold(run, a, axis);
        settle(run);
        for (int b = 0; b < FINGERS; b++) {
            bent[a][b] = abs(a - b) == 1 ? bend_of(run, b) / bend_of(run, a) : 0;
            mean += bent[a][b] / (2 * (FINGERS - 1));
        }
        end(run);
    }
    bench_body_free(&run->body);
    return mean;
}

static double most_of(double bent[FINGERS][FINGERS])
{
    double most = 0;
    for (int a = 0; a < FINGERS; a++)
        for (int b = 0; b < FINGERS; b++) most = fmax(most, bent[a][b]);
    return most;
}

static double neighbours_bend_welded(int axis, double welded[FINGERS][FINGERS])
{
    Run run;
    find_scene("hand-sampled-whole", &run);
    run.scene.octree.sampling.nodes = 0;
    run.scene.octree.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM, .level = 2};
    run.scene.octree.sampling.criteria_count = 1;
    return neighbours_bend(&run, axis, welded);
}

/* Pulling a fingertip carries the fingers next to it along, as the palm is soft, but hardly bends
 * them; where cells of one size weld fingers, here index to middle and ring to pinky, they bend. */
TEST(fingers_move_independently)
{
    needs_figures();
    static const char *const names[2] = {"hand-sampled-whole", "hand-sampled"};
    for (int i = 0; i < 4; i++) {
        Run run;
        int axis = i / 2 * 2;
        const char *name = names[i % 2];
        double bent[FINGERS][FINGERS];
        static double welded[FINGERS][FINGERS], mean_welded;
        if (i % 2 == 0) mean_welded = neighbours_bend_welded(axis, welded);
        find_scene(name, &run);
        double mean = neighbours_bend(&run, axis, bent);
        print_message("%s, axis %d: neighbours bend %.3f as far as the pulled finger on average, "
                      "at most %.3f; welded, %.3f\n",
                      name, axis, mean, most_of(bent), mean_welded);
        for (int a = 0; a < FINGERS; a++) {
            int b = a ^ 1;
            if (!(welded[a][b] > 0.25 && welded[a][b] > 2 * bent[a][b]))
                fail_msg("%s: finger %d bends %.3f as far as finger %d, welded %.3f", name, b,
                         bent[a][b], a, welded[a][b]);
        }
        assert_true(most_of(bent) < 0.15);
        assert_true(mean < 0.06 && mean_welded > 5 * mean);
    }
}

/* How far the nodes that a force pushes have gone, on average. */
static double pushed(const Run *run, int force)
{
    double sum = 0;
    for (long k = 0; k < run->runner.push_count[force]; k++) {
        long p = run->runner.push_particle[force][k];
        const double *x = run->x[p], *x0 = run->runner.x0[p];
        sum += hypot(hypot(x[0] - x0[0], x[1] - x0[1]), x[2] - x0[2]);
    }
    return sum / (double)run->runner.push_count[force];
}

/* How many times as far as the thumb's the pinky's tip goes. */
static double pinky_over_thumb(Run *run)
{
    make_body(run);
    start(run);
    settle(run);
    double pinky = pushed(run, 0), thumb = pushed(run, 1);
    print_message("pinky %.2f mm, thumb %.2f mm\n", 1e3 * pinky, 1e3 * thumb);
    end(run);
    bench_body_free(&run->body);
    return pinky / thumb;
}

/* Under forces that move both alike while their widths are equal. */
TEST(a_pinky_is_soft_and_a_thumb_stiff)
{
    needs_figures();
    Run run;
    find_scene("hand-stiffness", &run);
    double differing = pinky_over_thumb(&run);
    for (int i = 0; i < 2; i++) run.scene.octree.local[i].width = (OctWidth){.cells = 4};
    double equal = pinky_over_thumb(&run);
    assert_true(equal > 0.75 && equal < 1.33);
    assert_true(differing > 20);
}

/* The volume inside the surface that a body's nodes carry. */
static double volume_of(const Run *run)
{
    const OctStructure *structure = oct_engine_structure(run->runner.engine);
    const SmMesh *rest = &run->body.mesh;
    OctSurface surface;
    oct_surface_build(rest,
                      &(OctCarrier){&run->body.voxels, &structure->tree, &structure->graph, NULL},
                      &surface);
    SmMesh moved = *rest;
    moved.position = sm_alloc((size_t)rest->vertex_count, sizeof *moved.position);
    oct_surface_move(&surface, (const double(*)[3])run->x, moved.position, NULL);
    double volume = sm_mesh_info(&moved).volume;
    free(moved.position);
    oct_surface_free(&surface);
    return volume;
}

/* The largest way of a node from where it would be in a rigid body, as a share of the block's
 * height: as the block hits the ridge, and in the end. */
static void drop(const char *name, double *hit, double *dent, double *volume)
{
    Run run;
    find_scene(name, &run);
    make_body(&run);
    start(&run);
    double height = run.body.high[1] - run.body.low[1];
    bool *all = sm_alloc((size_t)run.runner.count, sizeof *all);
    for (long p = 0; p < run.runner.count; p++) all[p] = true;
    *hit = *dent = 0;
    for (int frame = 0; frame < run.scene.frames; frame++) {
        steps(&run, run.scene.steps_per_frame);
        *dent = off_rigid(&run, all, all) / height;
        *hit = fmax(*hit, *dent);
    }
    SmMeshInfo rest = sm_mesh_info(&run.body.mesh);
    *volume = volume_of(&run) / rest.volume;
    print_message("%s: %.3f of its height when it hits, %.3f in the end, volume %.3f\n", name, *hit,
                  *dent, *volume);
    free(all);
    end(&run);
    bench_body_free(&run.body);
}

TEST(a_dent_stays_where_it_is_plastic)
{
    double hit, dent, volume;
    drop("block-elastic", &hit, &dent, &volume);
    assert_true(hit > 0.1 && dent < 0.01);
    assert_true(fabs(volume - 1) < 0.01);
    drop("block", &hit, &dent, &volume);
    assert_true(hit > 0.1 && dent > 0.05);
    assert_true(fabs(volume - 1) < 0.05);
}

static SmCounts counts_of(Run *run)
{
    SmCounts counts;
    start(run);
    run->runner.type->count(run->runner.engine, &counts);
    return counts;
}

/* Tree, graph, regions and lists are there once: thirty-nine more flowers cost their state. */
TEST(flowers_share_their_structure)
{
    Run run;
    find_scene("flowers", &run);
    run.scene.instances = 1;
    make_body(&run);
    counts_of(&run);
    long alone = run.runner.bytes, n = run.runner.count;
    end(&run);
    bench_body_free(&run.body);
    find_scene("flowers", &run);
    make_body(&run);
    SmCounts counts = counts_of(&run);
    assert_int_equal(counts.particles, 40 * n);
    double each = (double)(run.runner.bytes - alone) / 39;
    print_message("%ld nodes: one flower %ld bytes, another %.0f\n", n, alone, each);
    assert_true(alone == 0 || (each > 36.0 * (double)n && each < 64.0 * (double)n));
    assert_true(each <= 0.1 * (double)alone);
    steps(&run, 150);
    double most = 0;
    for (long p = 0; p < counts.particles; p++)
        for (int d = 0; d < 3; d++) {
            double from = run.runner.x0[p % n][d] + run.body.pose[p / n][d][3];
            most = fmax(most, fabs(run.x[p][d] - from));
            double first = run.x[p % n][d] - run.body.pose[0][d][3];
            assert_true(fabs(run.x[p][d] - run.body.pose[p / n][d][3] - first) < 1e-4);
        }
    assert_true(most > 0.01); /* the wind moves them, all alike */
    end(&run);
    bench_body_free(&run.body);
}
