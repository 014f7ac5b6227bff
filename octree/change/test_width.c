/* Widths of regions: given, local, and found for as many summation nodes as are wanted. */
#include "width.h"

#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../test_engine_body.h"

/* Wide regions on one arm, narrow ones on the other: the same pull bends them differently. */
static double tip_moved(const SmVoxels *voxels, const OctOptions *options, double x_tip)
{
    SmEngineParams params = usual(options);
    params.damping = 0.3;
    SmCounts counts;
    SmEngine *engine = make(1, voxels, &params, &counts);
    long n = counts.particles, *held = sm_alloc((size_t)n, sizeof *held), tip = 0;
    double(*x0)[3] = triples(n), (*x)[3] = triples(n), best = INFINITY;
    octree_engine_f64.get(engine, SM_REST, x0);
    SmHandle handle = {.pose = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (long i = 0; i < n; i++) {
        if (x0[i][1] < 2) held[handle.count++] = i;
        double off = fabs(x0[i][0] - x_tip) + fabs(x0[i][1] - 5.75) + fabs(x0[i][2]);
        if (off < best) best = off, tip = i;
    }
    handle.particle = held;
    SmBoundary boundary = {.handle_count = 1, .handle = &handle};
    octree_engine_f64.bound(engine, &boundary);
    double impulse[1][3] = {{0, 0, 5}};
    for (int step = 0; step < 60; step++) {
        octree_engine_f64.push(engine, 1, &tip, (const double(*)[3])impulse);
        octree_engine_f64.step(engine, NULL);
    }
    octree_engine_f64.get(engine, SM_POSITION, x);
    double moved = x[tip][2] - x0[tip][2];
    free(held);
    free(x0);
    free(x);
    octree_engine_f64.destroy(engine);
    return moved;
}

TEST(wide_regions_are_stiff)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    OctOptions options = {
        .sampling = {.levels = 1, .criteria = {{.kind = OCT_UNIFORM}}, .criteria_count = 1},
        .width = {.cells = 1},
        .local = {{.width = {.cells = 4}, .low = {3, 0, -9}, .high = {5.6, 9, 9}}},
        .local_count = 1};
    double stiff = tip_moved(&voxels, &options, 3.25), soft = tip_moved(&voxels, &options, 8.75);
    if (!(stiff > 0 && soft > 3 * stiff)) fail_msg("stiff arm %g, soft arm %g", stiff, soft);
    sm_voxels_free(&voxels);
}

TEST(a_width_is_found_for_summation_nodes)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    for (double wanted = 4; wanted < 20;
         wanted += wanted < 11 ? 1 : 5) { /* there are not 16 within four edges */
        OctOptions options = {
            .epsilon = 0.5, .summation_nodes = wanted, .sampling = {.levels = 2, .nodes = 90}};
        SmEngineParams params = usual(&options);
        SmCounts counts;
        SmEngine *engine = make(1, &voxels, &params, &counts);
        double edges = oct_engine_structure(engine)->width.edges, found = counts.summation_nodes;
        octree_engine_f64.destroy(engine);
        options.summation_nodes = 0; /* no sixteenth of an edge beside it comes nearer */
        int same = 0, beside = wanted < 16;
        assert_int_equal(edges == OCT_WIDTH_EDGES, wanted == 16);
        for (int by = -beside; by <= beside; by++) {
            options.width.edges = edges + by / 16.0;
            engine = make(1, &voxels, &params, &counts);
            assert_true(fabs(counts.summation_nodes - wanted) >= fabs(found - wanted));
            same += options.width.edges == edges && counts.summation_nodes == found;
            octree_engine_f64.destroy(engine);
        }
        assert_int_equal(same, 1);
    }
    sm_voxels_free(&voxels);
}

/* Regions of single nodes hold nothing together. */
TEST(parts_are_counted)
{
    SmVoxels voxels;
    make_voxels(&voxels);
    OctOptions options = {.width = {.cells = 0.5}, .sampling = {.levels = 2, .nodes = 90}};
    SmEngineParams params = usual(&options);
    for (int whole = 0; whole < 2; whole++) {
        SmCounts counts;
        if (whole) options.width = (OctWidth){0, 0};
        SmEngine *engine = make(0, &voxels, &params, &counts);
        assert_int_equal(oct_structure_parts(oct_engine_structure(engine)),
                         whole ? 1 : counts.particles);
        octree_engine_f32.destroy(engine);
    }
    sm_voxels_free(&voxels);
}
