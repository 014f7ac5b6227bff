/* Shells on surfaces of several cylinders that crack across joints, around handles and holes, and
 * at zeros. */
#include "../solve/modes.h"
#include "fracture.h"
#include "test_cracked.h"

static unsigned seed = 2;

/* Of a mesh, which is freed. */
static void sheet_of_mesh(SmMesh mesh, long nodes, Sheet *sheet)
{
    const RefShellOptions options = {.across = 1,
                                     .nodes = nodes,
                                     .basis = REF_MLS_PLANE_LINEAR,
                                     .eta = 5,
                                     .thickness = 0.05,
                                     .material = {1e5, 0.3, 2}};
    *sheet = (Sheet){.map = {.vertices = 0}};
    map_sheet(mesh, sheet);
    sheet_of(&sheet->chart, &options, 0.7, sheet);
}

static void double_torus_sheet(long nodes, Sheet *sheet)
{
    sheet_of_mesh(tori_mesh(&double_torus, 45, &seed), nodes, sheet);
}

/* Pieces of what samples see. */
static int count_seen_pieces(const Sheet *sheet)
{
    SmPieces pieces = pieces_of(&sheet->shell);
    bool *seen = sm_alloc((size_t)pieces.count, sizeof *seen);
    int count = 0;
    for (long n = 0; n < sheet->shell.nodes.count; n++) {
        if (!ref_cracked_seen(&sheet->cracked, n) || seen[pieces.piece[n]]) continue;
        seen[pieces.piece[n]] = true;
        count++;
    }
    free(seen);
    sm_pieces_free(&pieces);
    return count;
}

/* There are so many pieces, of which each is rigid in six ways, and no more. */
static void check_pieces(Sheet *sheet, int pieces)
{
    RefModes modes;
    int rigid = REF_RIGID_MODES * pieces;
    ref_cracked_update(&sheet->cracked, NULL);
    print_message("%ld nodes, %ld soft samples, %d pieces\n", sheet->shell.nodes.count,
                  sheet->cracked.counts.soft, pieces);
    assert_int_equal(count_seen_pieces(sheet), pieces);
    assert_int_equal(ref_modes_find(&sheet->shell.matrices, NULL, rigid + 2, &modes, NULL), SM_OK);
    for (int k = 0; k < rigid; k++) assert_true(fabs(modes.lambda[k]) < 1e-4 * modes.lambda[rigid]);
    ref_modes_free(&modes);
}

/* From a place straight by a way, in steps; the arm is ended where it meets nothing. */
static int cut_by(RefCracks *cracks, const double from[2], const double way[2], double step,
                  int parent)
{
    int arm = ref_cracks_start(cracks, from, parent);
    int count = (int)ceil(hypot(way[0], way[1]) / step);
    for (int n = 0; n < count && cracks->arm[arm].open; n++)
        grow_by(cracks, arm, hypot(way[0], way[1]) / count, atan2(way[1], way[0]));
    ref_cracks_end(cracks, arm);
    return arm;
}

/* Once around a cylinder, at a share of its height: from a short cut across to itself. */
static void cut_around(Sheet *sheet, int which, double share, double step)
{
    const RefCylinder *in = sheet->chart.cylinders->cylinder + which;
    RefCracks *cracks = &sheet->cracked.cracks;
    double width = in->high[0] - in->low[0], height = in->high[1] - in->low[1];
    double at[2] = {random_between(&seed, in->low[0], in->high[0]), in->low[1] + share * height};
    const double short_cut[2][2] = {{at[0], at[1] - step / 2}, {0, step}};
    int arm = cut_by(cracks, short_cut[0], short_cut[1], step, -1);
    int around = cut_by(cracks, at, (double[]){1.37 * width, 0}, step, arm);
    assert_true(fabs(cracks->arm[around].length - width) < 1e-6 * width);
}

static int highest_cylinder(const Sheet *sheet)
{
    const RefCylinders *all = sheet->chart.cylinders;
    int highest = 0;
    for (int c = 1; c < all->count; c++)
        if (all->cylinder[c].high[1] > all->cylinder[highest].high[1]) highest = c;
    return highest;
}

/* One cut around a handle leaves the surface whole, a second one beside it takes a part out. */
TEST(two_cuts_around_a_handle_part_it)
{
    needs_solver();
    Sheet sheet;
    double_torus_sheet(700, &sheet);
    int highest = highest_cylinder(&sheet);
    for (int n = 0; n < 2; n++) {
        cut_around(&sheet, highest, n ? 0.8 : 0.2, half_cell(&sheet));
        check_pieces(&sheet, 1 + n);
    }
    sheet_free(&sheet);
}

/* A cut around a hole of a sheet parts its rim. */
TEST(a_cut_around_a_hole_parts_its_rim)
{
    needs_solver();
    Sheet sheet;
    sheet_of_mesh(plate_mesh(&two_holes, 40, 0.05, &seed), 400, &sheet);
    int highest = highest_cylinder(&sheet);
    cut_around(&sheet, highest, 0.5, half_cell(&sheet));
    check_pieces(&sheet, 2);
    sheet_free(&sheet);
}

/* Along the sides of a square, turning left, until the first one is met; `at` is its first corner.
 */
static void cut_square(Sheet *sheet, double at[2], double side, int sides)
{
    static const double way[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const double over = 0.1 * side;
    RefCracks *cracks = &sheet->cracked.cracks;
    for (int n = 0, arm = -1; n < sides; n++) {
        double from[2] = {at[0], at[1]}, along[2], step[2];
        for (int d = 0; d < 2; d++) {
            along[d] = (side + over * (n ? 1 : 2)) * way[n % 4][d];
            step[d] = side * way[n % 4][d];
        }
        if (n == 0) from[0] -= over;
        arm = cut_by(cracks, from, along, half_cell(sheet), arm);
        assert_true(ref_chart_walk(&sheet->chart, at, step));
    }
}

/* A square across a joint comes out. */
TEST(a_patch_across_a_joint_comes_out)
{
    needs_solver();
    Sheet sheet;
    double_torus_sheet(800, &sheet);
    const RefCylinders *all = sheet.chart.cylinders;
    const RefJoint *joint = all->joint;
    double longest = 0;
    for (int j = 0; j < all->joints; j++) {
        const RefJoint *one = all->joint + j;
        if (!one->up || one->end - one->begin <= longest) continue;
        longest = one->end - one->begin;
        joint = one;
    }
    double side = 6 * half_cell(&sheet);
    assert_true(joint->end - joint->begin > 1.5 * side);
    double at[2] = {joint->begin, all->cylinder[joint->from].high[1] - side / 2};
    double along = (joint->end - joint->begin - side) / 2;
    assert_true(ref_chart_walk(&sheet.chart, at, (double[]){along, 0}));
    cut_square(&sheet, at, side, 4);
    check_pieces(&sheet, 2);
    sheet_free(&sheet);
}

/* So does one around a zero, of two turns. */
TEST(a_patch_around_a_zero_comes_out)
{
    needs_solver();
    Sheet sheet;
    double_torus_sheet(800, &sheet);
    const RefCylinders *all = sheet.chart.cylinders;
    const RefJoint *joint = all->joint;
    double side = 5 * half_cell(&sheet);
    double at[2] = {joint->begin, joint->up ? all->cylinder[joint->from].high[1] : 0};
    at[1] += joint->up ? -side / 2 : side / 2;
    double to_corner[2] = {-side / 2, joint->up ? 0 : -side};
    assert_true(ref_chart_walk(&sheet.chart, at, to_corner));
    cut_square(&sheet, at, side, 8);
    check_pieces(&sheet, 2);
    sheet_free(&sheet);
}

/* Tips that run into a zero, or end at it, are the ends of cracks as others are, and leave all but
 * a few samples their stiffness. */
TEST(a_tip_runs_into_a_zero)
{
    needs_solver();
    for (int trial = 0; trial < 4; trial++) {
        Sheet sheet;
        double_torus_sheet(400, &sheet);
        RefCracks *cracks = &sheet.cracked.cracks;
        const RefCylinders *all = sheet.chart.cylinders;
        const RefJoint *joint = all->joint + trial % all->joints;
        const RefCylinder *in = all->cylinder + joint->from;
        double step = half_cell(&sheet);
        double angle = (joint->up ? 1 : -1) * random_between(&seed, 0.3, M_PI - 0.3);
        double at[2] = {joint->begin, joint->up ? in->high[1] : in->low[1]};
        ref_chart_walk(&sheet.chart, at,
                       (double[]){-3 * step * cos(angle), -3 * step * sin(angle)});
        int arm = ref_cracks_start(cracks, at, -1);
        for (int n = 0; n < 6; n++) {
            grow_by(cracks, arm, step * (trial % 2 ? 0.7 : 1), angle);
            ref_cracked_update(&sheet.cracked, NULL);
            assert_true(isfinite(cracks->arm[arm].tip[0]) && isfinite(cracks->arm[arm].tip[1]));
        }
        assert_true(fabs(cracks->arm[arm].length - 6 * step * (trial % 2 ? 0.7 : 1)) < 1e-6 * step);
        check_pieces(&sheet, 1);
        assert_true(sheet.cracked.counts.soft <
                    0.03 * REF_SAMPLES_PER_CELL * (double)sheet.shell.tree.leaves);
        sheet_free(&sheet);
    }
}

/* Tips that have come to a joint, where all stresses before them are behind it, go on by those:
 * the surface is stretched evenly. */
TEST(a_tip_sees_stresses_behind_a_joint)
{
    needs_solver();
    Sheet sheet;
    double_torus_sheet(400, &sheet);
    RefCracks *cracks = &sheet.cracked.cracks;
    const RefCylinders *all = sheet.chart.cylinders;
    const RefMaterial *material = &sheet.cracked.options.material;
    double stretch = 0.01, near = 1e-3 * half_cell(&sheet), length[8];
    double stress = material->young / (1 - material->poisson) * stretch;
    RefFractureOptions options = {.strength = 0.5 * stress};
    for (int j = 0; j < all->joints; j++) {
        const RefJoint *joint = all->joint + j;
        double far = fmin(joint->end - joint->begin, half_cell(&sheet)) / 4;
        double at[2] = {joint->begin, all->cylinder[joint->from].high[1] - near - far};
        if (!joint->up) continue;
        ref_chart_walk(&sheet.chart, at, (double[]){(joint->end - joint->begin) / 2, 0});
        int arm = ref_cracks_start(cracks, at, -1);
        grow_by(cracks, arm, far, M_PI / 2);
        assert_int_equal(ref_chart_plane(&sheet.chart, cracks->arm[arm].tip), joint->from);
        length[arm] = cracks->arm[arm].length;
    }
    assert_int_equal(cracks->arms, 4);
    ref_cracked_update(&sheet.cracked, NULL);
    double(*u)[3] = sm_alloc((size_t)sheet.shell.nodes.count, sizeof *u);
    for (long n = 0; n < sheet.shell.nodes.count; n++)
        for (int d = 0; d < 3; d++) u[n][d] = stretch * sheet.shell.X[n][d];
    assert_int_equal(ref_fracture_grow(&sheet.cracked, &options, (const double(*)[3])u), 4);
    for (long arm = 0; arm < cracks->arms; arm++)
        assert_true(cracks->arm[arm].length > length[arm]);
    free(u);
    sheet_free(&sheet);
}
