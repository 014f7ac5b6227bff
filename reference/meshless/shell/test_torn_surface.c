/* Triangles that come apart with the shell that carries them. */
#include "../../../lib/pieces.h"
#include "breaking.h"
#include "test_charts.h"
#include "test_shell.h"
#include "torn_surface.h"

static unsigned seed = 1;

enum { ALONG = 60, ACROSS = 24 };

static const double length = 2.5, thickness = 0.05;

typedef struct {
    RefChart chart;
    RefSheet sheet;
    RefBreaking breaking;
    double theta[(ALONG + 1) * (ACROSS + 1)][2], rest[(ALONG + 1) * (ACROSS + 1)][3];
    int triangle[2 * ALONG * ACROSS][3];
    RefTornSurface torn;
} Plate;

static const double radius = 2.5 / (2 * M_PI); /* of a tube that is `length` around */

/* A flat plate that carries a grid of triangles; or a tube of it, its ends joined by a seam. */
static void plate_create(bool round, Plate *plate)
{
    RefSheetOptions options = {.shell = {.across = 6,
                                         .basis = REF_MLS_PLANE_LINEAR,
                                         .eta = 5,
                                         .thickness = thickness,
                                         .material = {1e4, 0.3, 1}},
                               .h = 0.01};
    RefCrackedOptions cracked = {.least_share = 0.7, .most_splits = 1};
    RefFractureOptions strong = {.strength = 1e30};
    SmError error = {0};
    plate->chart = (RefChart){.high = {length, 1}, .factor = factor_one, .place = place_flat};
    if (round) plate->chart = cylinder_chart(&radius, length, 1);
    if (round) ref_chart_wrap(&plate->chart, true, false);
    assert_int_equal(ref_sheet_create(&plate->chart, &options, &plate->sheet, &error), SM_OK);
    assert_int_equal(
        ref_breaking_create(&plate->sheet, &cracked, &strong, &plate->breaking, &error), SM_OK);
    for (int n = 0; n < (ALONG + 1) * (ACROSS + 1); n++) {
        plate->theta[n][0] = length * (n % (ALONG + 1)) / ALONG;
        plate->theta[n][1] = (double)(n / (ALONG + 1)) / ACROSS;
        plate->chart.place(plate->chart.data, plate->theta[n], plate->rest[n]);
    }
    for (int n = 0; n < ALONG * ACROSS; n++) {
        int at = n / ALONG * (ALONG + 1) + n % ALONG, up = at + ALONG + 1;
        int right = round && n % ALONG == ALONG - 1 ? at + 1 - ALONG : at + 1;
        const int both[2][3] = {{at, right, right + ALONG + 1}, {at, right + ALONG + 1, up}};
        memcpy(plate->triangle[2 * n], both, sizeof both);
    }
    ref_torn_create(&plate->chart, (ALONG + 1) * (ACROSS + 1), 2 * ALONG * ACROSS,
                    (const int(*)[3])plate->triangle, (const double(*)[2])plate->theta,
                    (const double(*)[3])plate->rest, &plate->torn);
}

static void plate_free(Plate *plate)
{
    ref_torn_free(&plate->torn);
    ref_breaking_free(&plate->breaking);
    ref_sheet_free(&plate->sheet);
}

static void cut(Plate *plate, double x, double to)
{
    RefCracks *cracks = &plate->breaking.cracked.cracks;
    int arm = ref_cracks_start(cracks, (double[]){x, -0.01}, -1);
    for (double y = 0.07; cracks->arm[arm].open && y < to; y += 0.08)
        ref_cracks_grow(cracks, arm, (double[]){x + 0.05 * y, y});
    assert_int_equal(ref_breaking_update(&plate->breaking, NULL), SM_OK);
}

/* The volume of a mesh that is closed, and how many pieces hang together. */
static double volume_of(const SmMesh *mesh, long *pieces)
{
    SmMeshInfo info = sm_mesh_info(mesh);
    assert_int_equal(info.flipped_edges, 0);
    assert_true(info.watertight);
    *pieces = info.components;
    return info.volume;
}

static SmMesh drawn(Plate *plate, const double (*outer)[3])
{
    SmMesh mesh = ref_torn_mesh(&plate->torn);
    ref_torn_place(&plate->torn, &plate->breaking.cracked, &plate->sheet.warp, outer, thickness,
                   mesh.position);
    return mesh;
}

/* At rest it is a closed brick, cut half through, too; apart, there are two. */
TEST(what_is_drawn_is_closed)
{
    needs_solver();
    static Plate plate;
    long pieces;
    plate_create(false, &plate);
    SmMesh mesh = drawn(&plate, (const double(*)[3])plate.rest);
    assert_true(fabs(volume_of(&mesh, &pieces) / (length * thickness) - 1) < 1e-9);
    assert_int_equal(pieces, 1);
    sm_mesh_free(&mesh);
    for (int through = 0; through < 2; through++) {
        cut(&plate, through ? 1.9 : 0.7, through ? 2 : 0.5);
        assert_true(ref_torn_update(&plate.torn, &plate.breaking.cracked));
        assert_false(ref_torn_update(&plate.torn, &plate.breaking.cracked));
        assert_true(plate.torn.copies > (through ? ACROSS : ACROSS / 4));
        mesh = drawn(&plate, (const double(*)[3])plate.rest);
        for (long c = 0; c < plate.torn.copies; c++)
            assert_true(sm_square_between(mesh.position[plate.torn.vertices + c],
                                          plate.rest[plate.torn.of[c]]) < 1e-12);
        for (long n = 0; n < mesh.vertex_count; n++) /* apart, so that what is equal is one piece */
            mesh.position[n][1] += 1e-6 * (double)(n % (mesh.vertex_count / 2));
        assert_true(fabs(volume_of(&mesh, &pieces) / (length * thickness) - 1) < 1e-2);
        assert_int_equal(pieces, 1 + through);
        sm_mesh_free(&mesh);
    }
    plate_free(&plate);
}

/* A piece that flies away takes its copies with it. */
TEST(copies_go_with_their_side)
{
    needs_solver();
    static Plate plate;
    plate_create(false, &plate);
    cut(&plate, 1.2, 2);
    ref_torn_update(&plate.torn, &plate.breaking.cracked);
    assert_int_equal(plate.sheet.warp.pieces, 2);
    double(*v)[3] = (double(*)[3])plate.sheet.steps.v;
    for (long n = 0; n < plate.sheet.warp.nodes; n++)
        v[n][0] = copysign(1, plate.sheet.warp.X[n][0] - 1.2 - 0.05 * plate.sheet.warp.X[n][1]);
    for (int n = 0; n < 10; n++) ref_sheet_step(&plate.sheet);
    SmMesh mesh = drawn(&plate, (const double(*)[3])plate.rest);
    for (long c = 0; c < plate.torn.copies; c++) {
        const double *was = plate.rest[plate.torn.of[c]],
                     *is = mesh.position[plate.torn.vertices + c];
        double side = plate.torn.eye[c][0] - 1.2 - 0.05 * plate.torn.eye[c][1];
        assert_true(fabs(side) < 1e-9 || fabs(is[0] - was[0] - copysign(0.1, side)) < 1e-6);
    }
    sm_mesh_free(&mesh);
    plate_free(&plate);
}

/* Whether the triangles beside each other have the same corner there, but along open edges. */
static void check_corners(const RefTornSurface *torn)
{
    for (long t = 0; t < torn->triangles; t++)
        for (int k = 0; k < 3; k++) {
            if (torn->open[t][k]) continue;
            const int *beside = torn->corner[torn->beside[t][k]];
            for (int e = 0; e < 2; e++) {
                int corner = torn->corner[t][(k + e) % 3];
                assert_true(beside[0] == corner || beside[1] == corner || beside[2] == corner);
            }
        }
}

/* Triangles that turn the other way do not come apart for that, nor do those beside a seam; and a
 * crack along the seam or beside it tears as many as elsewhere. */
TEST(turned_triangles_and_seams_hold_together)
{
    needs_solver();
    static Plate plate;
    for (int turned = 0; turned < 2; turned++) {
        plate_create(true, &plate);
        for (int t = 0; turned && t < 2 * ALONG * ACROSS; t++)
            if (random_int(&seed, 3) == 0) {
                int *corner = plate.triangle[t], other = corner[1];
                corner[1] = corner[2];
                corner[2] = other;
            }
        ref_torn_free(&plate.torn);
        ref_torn_create(&plate.chart, (ALONG + 1) * (ACROSS + 1), 2 * ALONG * ACROSS,
                        (const int(*)[3])plate.triangle, (const double(*)[2])plate.theta,
                        (const double(*)[3])plate.rest, &plate.torn);
        assert_false(ref_torn_update(&plate.torn, &plate.breaking.cracked));
        assert_int_equal(plate.torn.copies, 0);
        assert_int_equal(plate.torn.open_edges, 2 * ALONG);
        for (int n = 0; n < 2; n++) {
            cut(&plate, n ? length - 0.02 : 1.2, 2);
            assert_true(ref_torn_update(&plate.torn, &plate.breaking.cracked));
            check_corners(&plate.torn);
            assert_in_range(plate.torn.copies, (n + 1) * ACROSS, (n + 1) * 4 * ACROSS);
            assert_int_equal(plate.sheet.warp.pieces, 1 + n);
        }
        plate_free(&plate);
    }
}

/* Another crack than before that tears as many edges and vertices is seen. */
TEST(what_has_changed_is_seen)
{
    needs_solver();
    static Plate plate;
    RefCracks *cracks = &plate.breaking.cracked.cracks;
    plate_create(false, &plate);
    for (int n = 0; n < 2; n++) {
        RefCracks none;
        double x = n ? 1.7 : 0.7;
        int arm = ref_cracks_start(cracks, (double[]){x + 0.01, 0.51}, -1);
        ref_cracks_grow(cracks, arm, (double[]){x + 0.01, 0.71});
        assert_true(ref_torn_update(&plate.torn, &plate.breaking.cracked));
        assert_true(plate.torn.copies > 0);
        ref_cracks_create(&plate.chart, cracks->margin, &none);
        ref_cracks_free(cracks);
        *cracks = none;
    }
    plate_free(&plate);
}

/* A crack across no more than one edge, whose ends hold together, tears nothing: what is drawn
 * stays a surface. */
TEST(a_crack_of_one_edge_is_not_drawn)
{
    needs_solver();
    static Plate plate;
    plate_create(false, &plate);
    RefCracks *cracks = &plate.breaking.cracked.cracks;
    const RefTornSurface *torn = &plate.torn;
    long edges = torn->open_edges;
    for (long t = 50; t < torn->triangles; t += 97) {
        const double *a = torn->middle[t], *b = torn->next[t][0];
        double at[2], to[2];
        if (fabs(a[0] - length / 2) > length / 2 - 0.3 || fabs(a[1] - 0.5) > 0.3) continue;
        for (int d = 0; d < 2; d++) {
            at[d] = (a[d] + b[d]) / 2 + 0.05 * (d ? a[0] - b[0] : b[1] - a[1]);
            to[d] = a[d] + b[d] - at[d];
        }
        ref_cracks_grow(cracks, ref_cracks_start(cracks, at, -1), to);
        assert_true(ref_cracks_part(cracks, a, b));
    }
    assert_true(cracks->pieces > 2);
    assert_int_equal(ref_breaking_update(&plate.breaking, NULL), SM_OK);
    assert_false(ref_torn_update(&plate.torn, &plate.breaking.cracked));
    assert_int_equal(torn->open_edges, edges);
    SmMesh mesh = drawn(&plate, (const double(*)[3])plate.rest);
    assert_true(sm_mesh_info(&mesh).watertight);
    sm_mesh_free(&mesh);
    plate_free(&plate);
}

/* A straight crack, by steps, that is ended where it does not meet another one. */
static int crack_to(RefCracks *cracks, const double from[2], const double to[2], int parent)
{
    int arm = ref_cracks_start(cracks, from, parent);
    for (int n = 1; n <= 8 && cracks->arm[arm].open; n++)
        ref_cracks_grow(
            cracks, arm,
            (double[]){from[0] + (to[0] - from[0]) * n / 8, from[1] + (to[1] - from[1]) * n / 8});
    if (cracks->arm[arm].open) ref_cracks_end(cracks, arm);
    return arm;
}

/* Where cracks enclose no node, between four of them, the eight triangles there are crumbs: they
 * are not drawn, the hole that they leave is closed, and what is beside does not hang on them. */
TEST(crumbs_are_left_out)
{
    needs_solver();
    static Plate plate;
    const double middle[2] = {1, 0.5}, half = 0.035, over = 0.002; /* cells are 1/6 wide */
    long pieces, crumbs = 0;
    plate_create(false, &plate);
    RefCracks *cracks = &plate.breaking.cracked.cracks;
    for (int side = 0, arm = -1; side < 4;
         side++) { /* each from the one before, the last to the first */
        double c = side % 2 ? 0 : 1 - side, s = side % 2 ? 2 - side : 0, end[2][2];
        for (int e = 0; e < 2; e++) {
            double along = e ? half + over : side ? -half : -half - over;
            end[e][0] = middle[0] + c * half - s * along;
            end[e][1] = middle[1] + s * half + c * along;
        }
        arm = crack_to(cracks, end[0], end[1], arm);
    }
    assert_int_equal(ref_breaking_update(&plate.breaking, NULL), SM_OK);
    assert_true(plate.breaking.cracked.counts.blind > 0);
    assert_true(ref_torn_update(&plate.torn, &plate.breaking.cracked));
    for (long t = 0; t < plate.torn.triangles; t++) {
        bool within = true;
        for (int d = 0; d < 2; d++) within &= fabs(plate.torn.middle[t][d] - middle[d]) < half;
        assert_int_equal(plate.torn.crumb[t], within);
        for (int k = 0; k < 3 && within; k++) /* crumbs need no copies */
            assert_int_equal(plate.torn.corner[t][k], plate.triangle[t][k]);
        crumbs += within;
    }
    assert_int_equal(crumbs, 8);
    assert_int_equal(plate.torn.crumbs, crumbs);
    SmMesh mesh = drawn(&plate, (const double(*)[3])plate.rest);
    double area = length * (1 - (double)crumbs / (double)plate.torn.triangles);
    assert_true(fabs(volume_of(&mesh, &pieces) / (area * thickness) - 1) < 1e-9);
    assert_int_equal(pieces, 1);
    sm_mesh_free(&mesh);
    plate_free(&plate);
}

/* Two cracks end a little before they meet, so near that no function reaches through between them:
 * the triangles there, which no crack parts, come apart with the pieces that they move with. */
TEST(triangles_of_different_pieces_come_apart)
{
    needs_solver();
    static Plate plate;
    const double x = 29.0 / 24 + 0.003, y = 0.522333, gap = 1e-5;
    long pieces, unparted = 0;
    plate_create(false, &plate);
    RefCracks *cracks = &plate.breaking.cracked.cracks;
    crack_to(cracks, (double[]){x, -0.01}, (double[]){x, y - gap}, -1);
    crack_to(cracks, (double[]){x, 1.01}, (double[]){x, y + gap}, -1);
    assert_int_equal(ref_breaking_update(&plate.breaking, NULL), SM_OK);
    assert_int_equal(plate.sheet.warp.pieces, 2);
    assert_true(ref_torn_update(&plate.torn, &plate.breaking.cracked));
    assert_int_equal(plate.torn.crumbs, 0);
    check_corners(&plate.torn);
    for (long t = 0; t < plate.torn.triangles; t++)
        for (int k = 0; k < 3; k++) {
            long beside = plate.torn.beside[t][k];
            if (beside < 0) continue;
            bool apart = (plate.torn.middle[t][0] < x) != (plate.torn.middle[beside][0] < x);
            assert_int_equal(plate.torn.open[t][k], apart);
            unparted +=
                apart && !ref_cracks_part(cracks, plate.torn.middle[t], plate.torn.middle[beside]);
        }
    assert_true(unparted > 0);
    SmMesh mesh = drawn(&plate, (const double(*)[3])plate.rest);
    for (long n = 0; n < mesh.vertex_count; n++) /* apart, so that what is equal is two pieces */
        mesh.position[n][1] += 1e-6 * (double)(n % (mesh.vertex_count / 2));
    assert_true(fabs(volume_of(&mesh, &pieces) / (length * thickness) - 1) < 1e-2);
    assert_int_equal(pieces, 2);
    sm_mesh_free(&mesh);
    plate_free(&plate);
}
