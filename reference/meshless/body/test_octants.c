/* Balance, classes and volumes of the octants of bricks and a ball. */
#include "nodes.h"

#include "../../../lib/test_frame.h"

static double ball_at(const void *body, const double x[3], double gradient[3])
{
    double radius = *(const double *)body, length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (int d = 0; gradient && d < 3; d++) gradient[d] = length > 0 ? x[d] / length : 0;
    return length - radius;
}

static const double radius = 1;
static const RefField ball = {ball_at, &radius, {-1, -1, -1}, {1, 1, 1}};

static RefOctants octants_of(const RefField *field, double cell, int coarser)
{
    RefOctantOptions options = {
        .cell = cell, .coarser = coarser, .split = 1, .gauss = 2, .clip = 2};
    RefOctants octants;
    assert_int_equal(ref_octants_build(field, &options, &octants, NULL), SM_OK);
    return octants;
}

/* No terminal octant touches one across a face or an edge that is two levels finer. */
TEST(one_level_at_faces_and_edges)
{
    RefOctants octants = octants_of(&ball, 0.05, 3);
    int sizes = 0;
    for (long o = 0; o < octants.count; o++) {
        const RefOctant *octant = octants.octant + o;
        if (octant->child >= 0) continue;
        sizes |= octant->size;
        for (int n = 0; n < 27; n++) {
            int step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}, place[3];
            if (step[0] * step[1] * step[2] != 0) continue;
            for (int d = 0; d < 3; d++)
                place[d] = octant->corner[d] + (step[d] > 0 ? octant->size : -(step[d] < 0));
            int other = ref_octants_at(&octants, place);
            if (other >= 0) assert_true(octants.octant[other].size <= 2 * octant->size);
        }
    }
    assert_true((sizes & 7) == 7); /* three levels at least */
    ref_octants_free(&octants);
}

/* Classes by what the samples of an octant say, and points inside, whose weights are its share. */
TEST(classes_of_a_ball)
{
    RefOctants octants = octants_of(&ball, 0.21, 1);
    for (long o = 0; o < octants.count; o++) {
        const RefOctant *octant = octants.octant + o;
        long end = o + 1 < octants.count ? octants.octant[o + 1].first : octants.points;
        double centre[3], edge = octants.cell * octant->size, weight = 0;
        int inside = 0;
        if (octant->child >= 0) continue;
        ref_octants_centre(&octants, octant, centre);
        for (int n = 0; n < 512; n++) {
            double x[3] = {n % 8, n / 8 % 8, n / 64};
            for (int d = 0; d < 3; d++) x[d] = centre[d] + ((x[d] + 0.5) / 8 - 0.5) * edge;
            inside += ref_field_at(&ball, x, NULL) < 0;
        }
        for (long p = octant->first; p < end; p++) weight += octants.point[p].weight;
        assert_true(fabs(weight - octant->share * edge * edge * edge) < 1e-12);
        assert_true(fabs(octant->share - inside / 512.0) < 0.03);
        if (inside > 0 && inside < 512)
            assert_int_equal(octant->kind, ref_field_at(&ball, centre, NULL) < 0
                                               ? REF_BOUNDARY_IN
                                               : REF_BOUNDARY_OUT);
        else if (inside == 512)
            assert_true(octant->kind != REF_EXTERIOR);
    }
    ref_octants_free(&octants);
}

/* Volumes converge with the square of the octants' size. */
TEST(volumes)
{
    double off[2], wanted = 4 * acos(-1) / 3;
    for (int n = 0; n < 2; n++) {
        RefOctants octants = octants_of(&ball, n ? 0.11 : 0.22, 1);
        off[n] = fabs(ref_octants_volume(&octants) / wanted - 1);
        ref_octants_free(&octants);
    }
    assert_true(off[0] < 5e-3 && off[1] < off[0] / 3);
    RefBrick brick = {{-3, 1, 2}, {-1, 2, 4.5}};
    RefField field = ref_field_brick(&brick);
    RefOctants octants = octants_of(&field, 0.25, 2);
    assert_true(fabs(ref_octants_volume(&octants) / 5 - 1) < 1e-12);
    for (long o = 0; o < octants.count; o++) {
        RefOctantClass kind = octants.octant[o].kind;
        assert_true(kind == REF_INTERIOR || kind == REF_EXTERIOR);
    }
    ref_octants_free(&octants);
}

/* Every node is in the body and stands alone; those of octants cut outside are on the surface. */
TEST(nodes_of_a_ball)
{
    RefOctants octants = octants_of(&ball, 0.21, 1);
    RefNodes nodes;
    ref_nodes_place(&ball, &octants, 3, &nodes);
    long on_surface = 0;
    assert_true(nodes.count > 300);
    for (long a = 0; a < nodes.count; a++) {
        double value = ref_field_at(&ball, nodes.position[a], NULL);
        assert_true(value < 1e-6);
        assert_true(nodes.reach[a] > 1.49 * 0.21);
        on_surface += value > -1e-6;
        for (long b = 0; b < a; b++) {
            double square = 0;
            for (int d = 0; d < 3; d++)
                square += pow(nodes.position[a][d] - nodes.position[b][d], 2);
            assert_true(square > 0.06 * 0.21 * 0.21);
        }
    }
    assert_true(on_surface > 50);
    ref_nodes_free(&nodes);
    ref_octants_free(&octants);
}

TEST(what_has_no_octants)
{
    RefBrick brick = {{0, 0, 0}, {1, 1, 1}};
    RefField field = ref_field_brick(&brick);
    RefOctantOptions options = {.cell = 1e-9, .split = 1, .gauss = 2, .clip = 1};
    RefOctants octants;
    SmError error = {0};
    assert_int_equal(ref_octants_build(&field, &options, &octants, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "too fine"));
    options.cell = 1e-3;
    assert_int_equal(ref_octants_build(&field, &options, &octants, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "fewer nodes"));
    double inside_out = -1;
    RefField empty = {ball_at, &inside_out, {-1, -1, -1}, {1, 1, 1}};
    options.cell = 0.3;
    assert_int_equal(ref_octants_build(&empty, &options, &octants, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "normals"));
}
