/* Cells split for a ball or a viewer, and merged again when it has been gone for long enough. */
#include "refinement.h"

#include "../../lib/test_frame.h"
#include "structure.h"

enum { SIDE = 32, LEVELS = 4 };

/* A block of 32 finest cells each way, of base cells 16 wide that are split once. */
static void block(OctStructure *s)
{
    SmVoxels voxels;
    SmError error;
    OctOptions options = {.sampling = {.levels = LEVELS, .criteria_count = 1},
                          .width = {.edges = 1}};
    options.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM, .level = 1};
    sm_voxels_block(&voxels, SIDE, SIDE, SIDE, 0.5);
    if (oct_structure_build(&voxels, &options, NULL, s, &error)) fail_msg("%s", error.text);
    sm_voxels_free(&voxels);
}

static long leaves(const OctStructure *s)
{
    long count = 0;
    for (long leaf = 0; leaf < s->tree.leaves; leaf++) count += s->tree.node[leaf] >= 0;
    return count;
}

static long edges(const OctStructure *s)
{
    long count = 0;
    for (long leaf = 0; leaf < s->tree.leaves; leaf++)
        if (s->tree.node[leaf] >= 0) count += s->graph.edges.end[leaf] - s->graph.edges.first[leaf];
    return count;
}

/* How far a leaf's cell is from a point, in mesh units. */
static double distance(const OctStructure *s, long leaf, const double from[3])
{
    double centre[3], half = 0.25 * s->cell * s->tree.size[s->tree.node[leaf]], square = 0;
    oct_structure_centre(s, leaf, centre);
    for (int d = 0; d < 3; d++) square += pow(fmax(fabs(centre[d] - from[d]) - half, 0), 2);
    return sqrt(square);
}

static long update(OctRefinement *refinement, OctStructure *s, OctRefineCriterion *criterion,
                   const void *what, double time, double hold)
{
    bool due = oct_refinement_due(refinement, s, criterion, what, time, hold);
    long changes = oct_refinement_update(refinement, s, criterion, what, time, hold);
    oct_resample_update(s);
    assert_int_equal(due, changes > 0);
    assert_false(oct_refinement_due(refinement, s, criterion, what, time, hold));
    return changes;
}

TEST(a_touch_refines_while_it_lasts)
{
    OctStructure s;
    OctRefinement refinement = {0};
    OctBallRefinement ball = {{8, 16, 8}, 1.2, LEVELS};
    block(&s);
    long before = leaves(&s), joined = edges(&s);
    long split = update(&refinement, &s, oct_ball_criterion, &ball, 0, 0.5), refined = leaves(&s);
    assert_int_equal(refined - before, 7 * split); /* all cells are full */
    for (long leaf = 0; leaf < s.tree.leaves; leaf++) {
        if (s.tree.node[leaf] < 0) continue;
        int level = oct_tree_level(&s.tree, s.tree.node[leaf]);
        bool near = distance(&s, leaf, ball.centre) <= ball.radius;
        assert_true(near ? level == LEVELS : level >= 1);
    }
    assert_int_equal(update(&refinement, &s, oct_ball_criterion, &ball, 1, 0.5), 0);
    assert_int_equal(update(&refinement, &s, NULL, NULL, 1.49, 0.5), 0); /* not yet */
    assert_int_equal(leaves(&s), refined);
    long merged = 0;
    while (oct_refinement_due(&refinement, &s, NULL, NULL, 1.5, 0.5))
        merged += update(&refinement, &s, NULL, NULL, 1.5, 0.5);
    assert_int_equal(leaves(&s), before);
    assert_int_equal(7 * merged, refined - before);
    assert_int_equal(refinement.count, 0);
    assert_int_equal(edges(&s), joined);
    oct_refinement_free(&refinement);
    oct_structure_free(&s);
}

/* A viewer that comes near and goes away: levels as its distances say, and each cell split and
 * merged once. */
TEST(an_eye_refines_by_distance)
{
    OctStructure s;
    OctRefinement refinement = {0};
    OctViewRefinement view = {.near = 2, .slack = 0.2, .level = LEVELS};
    block(&s);
    long before = leaves(&s), changes = 0, splits = 0;
    for (int step = 0; step <= 40; step++) {
        view.eye[0] = -40 + step;
        view.eye[1] = view.eye[2] = 8;
        changes += update(&refinement, &s, oct_view_criterion, &view, step, 0);
        for (long leaf = 0; leaf < s.tree.leaves; leaf++) {
            if (s.tree.node[leaf] < 0) continue;
            int level = oct_tree_level(&s.tree, s.tree.node[leaf]);
            double far = fmax(distance(&s, leaf, view.eye), 1e-9);
            int wanted = LEVELS - (int)fmax(ceil(log2(far / view.near) - 1e-9), 0);
            assert_true(level >= wanted);
        }
    }
    splits = changes;
    assert_int_equal(leaves(&s) - before, 7 * splits);
    for (int step = 0; step <= 60; step++) {
        view.eye[0] = -step;
        changes += update(&refinement, &s, oct_view_criterion, &view, 100 + step, 0);
    }
    assert_int_equal(changes, 2 * splits);
    assert_int_equal(leaves(&s), before);
    oct_refinement_free(&refinement);
    oct_structure_free(&s);
}

/* What the view sees at the edge of a distance does not come and go with it. */
TEST(an_edge_does_not_flicker)
{
    OctStructure s;
    OctRefinement refinement = {0};
    OctViewRefinement view = {.near = 2, .slack = 0.2, .level = LEVELS};
    block(&s);
    view.eye[1] = view.eye[2] = 8;
    for (int step = 0; step < 20; step++) {
        view.eye[0] = -2 + (step % 2 ? -0.15 : 0.15);
        long changes = update(&refinement, &s, oct_view_criterion, &view, step, 0);
        if (step > 0) assert_int_equal(changes, 0);
    }
    oct_refinement_free(&refinement);
    oct_structure_free(&s);
}
