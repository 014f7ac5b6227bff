/* Bodies of many thin parts, dropped: goals are found again in every state that they pass. */
#include "check.h"

#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"

/* A triangle of a base `width` wide about `foot` and a tip `way` from there. */
static void add_sliver(SmMesh *mesh, unsigned *seed, const double foot[3], const double way[3],
                       double width)
{
    double side[3],
        to[3] = {random_between(seed, -1, 1), random_between(seed, -1, 1),
                 random_between(seed, -1, 1)},
        square = 0;
    long v = 3 * mesh->triangle_count;
    for (int d = 0; d < 3; d++) {
        side[d] = way[(d + 1) % 3] * to[(d + 2) % 3] - way[(d + 2) % 3] * to[(d + 1) % 3];
        square += side[d] * side[d];
    }
    for (int d = 0; d < 3; d++) {
        side[d] *= 0.5 * width / sqrt(square);
        mesh->position[v][d] = foot[d] - side[d];
        mesh->position[v + 1][d] = foot[d] + side[d];
        mesh->position[v + 2][d] = foot[d] + way[d];
    }
    for (int c = 0; c < 3; c++) mesh->triangle[mesh->triangle_count][c] = (int)v + c;
    mesh->triangle_count++;
    mesh->vertex_count += 3;
}

static SmMesh new_slivers(long count)
{
    SmMesh mesh = sm_mesh_new(3 * count, count);
    mesh.vertex_count = mesh.triangle_count = 0;
    return mesh;
}

/* From one place to all sides above it: `width` as of leaves, or as of needles. */
static SmMesh fan(unsigned seed, int count, double width)
{
    SmMesh mesh = new_slivers(count);
    for (int i = 0; i < count; i++) {
        const double way[3] = {random_between(&seed, -1, 1),
                               fabs(random_between(&seed, -1, 1)) + 0.01,
                               random_between(&seed, -1, 1)};
        add_sliver(&mesh, &seed, (double[3]){0}, way, width);
    }
    return mesh;
}

/* Anywhere: most touch nothing. */
static SmMesh scattered(unsigned seed, int count, double width)
{
    SmMesh mesh = new_slivers(count);
    for (int i = 0; i < count; i++) {
        const double foot[3] = {random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                                random_between(&seed, -1, 1)};
        const double way[3] = {random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                               random_between(&seed, -1, 1)};
        add_sliver(&mesh, &seed, foot, way, width);
    }
    return mesh;
}

/* Stems of short pieces that wander upwards, each with a leaf. */
static SmMesh plant(unsigned seed, int stems)
{
    enum { PIECES = 12 };
    SmMesh mesh = new_slivers(2L * stems * PIECES);
    for (int s = 0; s < stems; s++) {
        double at[3] = {0.1 * random_between(&seed, -1, 1), 0, 0.1 * random_between(&seed, -1, 1)},
               along[3];
        for (int d = 0; d < 3; d++) along[d] = d == 1 ? 0.1 : 0.05 * random_between(&seed, -1, 1);
        for (int p = 0; p < PIECES; p++) {
            add_sliver(&mesh, &seed, at, along, 0.02);
            for (int d = 0; d < 3; d++)
                at[d] += 0.9 * along[d] + 0.005 * random_between(&seed, -1, 1);
            const double leaf[3] = {0.2 * random_between(&seed, -1, 1),
                                    0.1 * random_between(&seed, -1, 1),
                                    0.2 * random_between(&seed, -1, 1)};
            add_sliver(&mesh, &seed, at, leaf, 0.03);
        }
    }
    return mesh;
}

/* As `shapebench run MESH --engine octree --shell` drops it, through the air and the first impact.
 */
static void drop(SmMesh mesh, const char *name)
{
    BenchScene scene;
    BenchBody body;
    BenchRunner runner = {0};
    BenchCheck check;
    SmError error = {0};
    char reason[160];
    bench_scene_drop(&mesh, name, &scene);
    bench_scene_sample(&mesh, &scene);
    scene.voxel = (SmVoxelParams){.fill = SM_SHELL, .particles = 20000};
    if (bench_body_create(&scene, &mesh, &body, &error) ||
        bench_runner_create(&scene, &body, &octree_engine_f32, 1, &runner, &error))
        fail_msg("%s: %s", name, error.text);
    bench_check_begin(&scene, &body, &octree_engine_f32, runner.engine, &check);
    for (int step = 0; step < 60; step++) {
        bench_runner_step(&runner);
        if (step % 12) continue;
        BenchDeviation found = bench_check_state(&check, runner.type, runner.engine);
        if (!bench_check_verdict(&found, sizeof reason, reason))
            fail_msg("%s, step %d: %s", name, step, reason);
    }
    bench_check_free(&check);
    bench_runner_free(&runner);
    bench_body_free(&body);
}

TEST(what_is_thin_is_as_exact_as_its_check)
{
    drop(fan(1, 12, 0.01), "spray");
    drop(fan(2, 20, 1e-4), "needles");
    drop(scattered(3, 20, 0.02), "few slivers");
    drop(scattered(4, 60, 0.01), "slivers");
    drop(plant(5, 6), "plant");
}
