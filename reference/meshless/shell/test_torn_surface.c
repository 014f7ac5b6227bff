/* Triangles that come apart with the shell that carries them. */
#include "../../../lib/pieces.h"
#include "breaking.h"
#include "test_charts.h"
#include "test_shell.h"
#include "torn_surface.h"

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

/* A flat plate that carries a grid of triangles. */
static void plate_create(Plate *plate)
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
    assert_int_equal(ref_sheet_create(&plate->chart, &options, &plate->sheet, &error), SM_OK);
    assert_int_equal(
        ref_breaking_create(&plate->sheet, &cracked, &strong, &plate->breaking, &error), SM_OK);
    for (int n = 0; n < (ALONG + 1) * (ACROSS + 1); n++) {
        plate->theta[n][0] = length * (n % (ALONG + 1)) / ALONG;
        plate->theta[n][1] = (double)(n / (ALONG + 1)) / ACROSS;
        place_flat(NULL, plate->theta[n], plate->rest[n]);
    }
    for (int n = 0; n < ALONG * ACROSS; n++) {
        int at = n / ALONG * (ALONG + 1) + n % ALONG, up = at + ALONG + 1;
        const int both[2][3] = {{at, at + 1, up + 1}, {at, up + 1, up}};
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
    plate_create(&plate);
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
    plate_create(&plate);
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
