/* What the page shows of the inside is the engines' own: links, regions, what sums them and goals
 * as the references have them, at rest, in motion and after a cut. */
#include <stdlib.h>
#include <string.h>

#include "../../lib/test_frame.h"
#include "../../reference/octree_regions.h"
#include "../check/check.h"
#include "../check/parted.h"
#include "inside.h"
#include "side.h"
#include "view.h"

/* Where one side alone is looked at, the other stays at rest. */
static void open_side(const char *name, int side, int frames)
{
    const char *text = view_scene_text(name);
    strcpy(view_room((int)strlen(text)), text);
    if (view_open((int)strlen(text), 0)) fail_msg("%s", view_message());
    view_step(side, frames * (int)view_figure(side, VIEW_STEPS_PER_FRAME));
}

static void open_scene(const char *name, int frames)
{
    open_side(name, 0, frames);
    for (int side = 1; side < VIEW_SIDES; side++)
        view_step(side, frames * (int)view_figure(side, VIEW_STEPS_PER_FRAME));
}

/* The only group of a side of one body. */
static BenchGroup *group_of(int side)
{
    return &view_side_of(side)->play.group[0];
}

static double (*get(const BenchGroup *group, SmField field))[3]
{
    double(*value)[3] = sm_alloc((size_t)group->runner.particles, sizeof *value);
    group->runner.type->get(group->runner.engine, field, value);
    return value;
}

/* In the last frames of two a blade is in the body, or has gone through it. */
static const struct {
    const char *name;
    int frames;
} scene[] = {{"penguin", 3}, {"hand", 4}, {"beam-cut", 45}, {"liver", 0}, {"liver", 200}};
enum { SCENES = sizeof scene / sizeof *scene };

/* ---- the lattice */

static void check_links(const BenchGroup *group, const RefLinks *wanted)
{
    long links = view_links(VIEW_LATTICE), straight;
    const int(*link)[2] = (const int(*)[2])view_link_ends(VIEW_LATTICE);
    straight = view_straight_links(VIEW_LATTICE);
    assert_int_equal(2 * links, wanted->start[wanted->count]);
    assert_int_equal(links, (long)view_figure(VIEW_LATTICE, VIEW_LINKS));
    for (long i = 0; i < links; i++) {
        double square =
            sm_square_between(group->runner.x0[link[i][0]], group->runner.x0[link[i][1]]);
        double cell = group->body.voxels.cell;
        assert_true(link[i][0] < link[i][1] && ref_linked(wanted, link[i][0], link[i][1]));
        assert_true((square < 1.5 * cell * cell) == (i < straight));
        if (i && i != straight) assert_memory_not_equal(link[i], link[i - 1], sizeof *link);
    }
}

/* Each bar is a row along one axis, alike in all bars, and each plate a plane: as many of both as
 * there are such with members. */
static void check_bars(const BenchGroup *group, const int (*member)[3], long members)
{
    long bars = (long)view_mark_figure(VIEW_LATTICE, VIEW_BARS);
    long plates = (long)view_mark_figure(VIEW_LATTICE, VIEW_PLATES);
    const double(*x0)[3] = (const double(*)[3])group->runner.x0;
    double half = group->body.voxels.cell / 2;
    int turns = 0;
    for (int turn = 0; turn < 3; turn++) { /* which axis bars run along */
        bool fits = true;
        for (long i = 0; i < members && fits; i++)
            for (long j = 0; j < members && fits; j++) {
                double apart[3];
                for (int d = 0; d < 3; d++)
                    apart[d] =
                        fabs(x0[member[i][0]][(d + turn) % 3] - x0[member[j][0]][(d + turn) % 3]);
                fits = (member[i][2] == member[j][2]) == (apart[2] < half) &&
                       (member[i][1] == member[j][1]) == (apart[2] < half && apart[1] < half);
            }
        turns += fits;
    }
    assert_true(turns > 0);
    long most[2] = {0};
    for (long i = 0; i < members; i++)
        for (int k = 0; k < 2; k++)
            most[k] = member[i][1 + k] + 1 > most[k] ? member[i][1 + k] + 1 : most[k];
    assert_int_equal(most[0], bars);
    assert_int_equal(most[1], plates);
}

static void check_goal(int side, const double wanted[3], const double x[3], double cell)
{
    const double *goal = view_goal(side);
    double off = sqrt(sm_square_between(goal, wanted)) / cell;
    double far = sqrt(sm_square_between(goal, x)) / cell;
    if (!(off < 1e-3)) fail_msg("side %d: goal is %g cells off", side, off);
    assert_true(fabs(view_mark_figure(side, VIEW_GOAL_CELLS) - far) < 1e-9);
}

TEST(lattices_are_as_brute_force_has_them)
{
    for (int n = 0; n < SCENES; n++) {
        open_side(scene[n].name, VIEW_LATTICE, scene[n].frames);
        const BenchGroup *group = group_of(VIEW_LATTICE);
        const BenchRunner *runner = &group->runner;
        long parted_count = 0, count = runner->count;
        int(*parted)[2] = bench_parted(&group->body, runner->type, runner->engine, &parted_count);
        assert_int_equal(group->body.cut ? bench_parted_wrong(&group->body, parted_count, parted)
                                         : parted_count,
                         0);
        if (scene[n].frames > 40 && parted_count < 20) fail_msg("%ld links cut", parted_count);
        RefLinks links;
        RefRegions regions;
        ref_links_build(&group->body.voxels, (const int(*)[2])parted, parted_count, &links);
        ref_regions_reach(&links, view_side_of(VIEW_LATTICE)->scene.params.w, &regions);
        check_links(group, &links);
        double(*x)[3] = get(group, SM_POSITION), (*g)[3] = sm_alloc((size_t)count, sizeof *g);
        double *mass = sm_alloc((size_t)count, sizeof *mass);
        runner->type->masses(runner->engine, mass);
        ref_goals(&regions, (const double(*)[3])runner->x0, mass, (const double(*)[3])x, g);
        for (long p = 0; p < count; p += 1 + count / 60) {
            long members = view_mark(VIEW_LATTICE, (int)p);
            const int(*member)[3] = (const int(*)[3])view_members(VIEW_LATTICE);
            assert_int_equal(members, regions.start[p + 1] - regions.start[p]);
            for (long i = 0; i < members; i++)
                assert_int_equal(member[i][0], regions.member[regions.start[p] + i]);
            check_bars(group, member, members);
            check_goal(VIEW_LATTICE, g[p], x[p], group->body.voxels.cell);
        }
        ref_links_free(&links);
        ref_regions_free(&regions);
        sm_free_all(parted, x, g, mass);
    }
}

/* ---- the octree */

/* A node's members are the leaves below it: none is below two, and all are below one. */
static void check_summation_nodes(const OctStructure *s, const int *leaf, long p, long members)
{
    const int(*member)[3] = (const int(*)[3])view_members(VIEW_OTHER);
    const SmCsr *rows = &s->regions.members;
    long nodes = (long)view_mark_figure(VIEW_OTHER, VIEW_NODES), below = 0;
    assert_int_equal(nodes, rows->end[leaf[p]] - rows->first[leaf[p]]);
    for (long i = 0; i < members; i++) {
        int at = s->tree.node[leaf[member[i][0]]], wanted;
        assert_true(member[i][1] >= 0 && member[i][1] < nodes);
        wanted = rows->item[rows->first[leaf[p]] + member[i][1]];
        while (at >= 0 && at != wanted) at = s->tree.parent[at];
        assert_int_equal(at, wanted);
        if (i) assert_true(member[i][0] > member[i - 1][0]);
    }
    for (long l = 0; l < s->tree.leaves; l++)
        for (int at = s->tree.node[l]; at >= 0; at = s->tree.parent[at])
            for (long n = 0; n < nodes; n++) below += rows->item[rows->first[leaf[p]] + n] == at;
    assert_int_equal(below, members);
}

/* The regions' leaves are those of the slow twin, pair by pair. */
static void check_regions(const OctStructure *s)
{
    RefOctree twin;
    long leaves = s->tree.leaves;
    bool *member = sm_alloc((size_t)(leaves * leaves), sizeof *member);
    int *leaf = sm_alloc((size_t)leaves, sizeof *leaf);
    ref_octree_build(&s->tree, &s->voxels, &twin);
    ref_octree_regions(&s->tree, &twin, s->w, s->options.epsilon, OCT_UNION, member);
    for (long i = 0; i < leaves; i++) {
        oct_regions_leaves(&s->tree, &s->regions, i, leaf);
        for (long n = 0; n < s->regions.size[i]; n++) {
            assert_true(member[i * leaves + leaf[n]]);
            member[i * leaves + leaf[n]] = false;
        }
        assert_null(memchr(member + i * leaves, true, (size_t)leaves));
    }
    ref_octree_free(&twin);
    sm_free_all(member, leaf);
}

TEST(octrees_are_as_brute_force_has_them)
{
    for (int n = 0; n < SCENES; n++) {
        open_side(scene[n].name, VIEW_OTHER, scene[n].frames);
        const BenchGroup *group = group_of(VIEW_OTHER);
        const BenchRunner *runner = &group->runner;
        const OctStructure *s = oct_engine_structure(runner->engine);
        const int *leaf = oct_engine_leaves(runner->engine);
        long count = runner->count;
        bool changed = s->resample != NULL; /* held to a build from scratch by octree/change */
        if (!changed && count <= 1000) check_regions(s);
        double(*x)[3] = get(group, SM_POSITION), (*cells)[3] = sm_alloc((size_t)count, sizeof *x);
        double(*g)[3] = sm_alloc((size_t)count, sizeof *g);
        for (long p = 0; p < count; p++)
            for (int d = 0; d < 3; d++) cells[p][d] = (x[p][d] - s->origin[d]) / s->cell;
        RefTreeBody ref;
        ref_tree_init(&s->tree, &s->regions, s->mass, false, &ref);
        ref_tree_goals(&ref, (const double(*)[3])cells, false, g);
        for (long p = 0; p < count; p += 1 + count / 40) {
            long members = view_mark(VIEW_OTHER, (int)p);
            const int(*member)[3] = (const int(*)[3])view_members(VIEW_OTHER);
            assert_int_equal(members, ref.regions.start[p + 1] - ref.regions.start[p]);
            sm_sort_ints(ref.regions.member + ref.regions.start[p], members);
            for (long i = 0; i < members; i++)
                assert_int_equal(member[i][0], ref.regions.member[ref.regions.start[p] + i]);
            check_summation_nodes(s, leaf, p, members);
            for (int d = 0; d < 3; d++) g[p][d] = s->origin[d] + s->cell * g[p][d];
            check_goal(VIEW_OTHER, g[p], x[p], s->cell);
        }
        ref_tree_free(&ref);
        sm_free_all(x, cells, g);
    }
}

/* Is a place within a box whose frame is at right angles, as all are at rest? */
static bool is_within(const float *cell, const double place[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double along = 0, square = 0;
        for (int d = 0; d < 3; d++) {
            double half = cell[3 + 3 * axis + d];
            along += half * (place[d] - cell[d]);
            square += half * half;
        }
        if (fabs(along) > square) return false;
    }
    return true;
}

/* At rest every finest cell of material is in one cell, and each cell is as large as its level
 * says.
 */
TEST(cells_hold_the_body_once)
{
    static const char *const names[] = {"hand-sampled", "liver", "flowers"};
    for (int n = 0; n < 3; n++) {
        open_scene(names[n], 0);
        BenchGroup *group = group_of(VIEW_OTHER);
        double(*rest)[3] = get(group, SM_REST);
        group->runner.type->set(group->runner.engine, SM_POSITION, (const double(*)[3])rest);
        free(rest);
        const OctStructure *s = oct_engine_structure(group->runner.engine);
        const float *cell = view_cell_frames(VIEW_OTHER);
        assert_int_equal(view_cells(VIEW_OTHER), view_particles(VIEW_OTHER));
        long held = 0;
        for (long i = 0; i < group->runner.count; i++) {
            const float *c = cell + VIEW_CELL_NUMBERS * i;
            double edge = s->cell * (1 << (s->tree.levels - (int)c[12]));
            for (int axis = 0; axis < 3; axis++)
                for (int d = 0; d < 3; d++)
                    assert_true(fabs(c[3 + 3 * axis + d] - (axis == d) * edge / 2) < 1e-4 * edge);
        }
        const SmVoxels *voxels = &group->body.voxels;
        for (int k = 0; k < voxels->size[2]; k++)
            for (int j = 0; j < voxels->size[1]; j++)
                for (int i = 0; i < voxels->size[0]; i++) {
                    double middle[3] = {i + 0.5, j + 0.5, k + 0.5};
                    int in = 0;
                    if (!sm_voxel_get(voxels, i, j, k)) continue;
                    for (int d = 0; d < 3; d++)
                        middle[d] = s->origin[d] + s->cell * middle[d] + group->body.pose[0][d][3];
                    for (long c = 0; c < group->runner.count; c++)
                        in += is_within(cell + VIEW_CELL_NUMBERS * c, middle);
                    assert_int_equal(in, 1);
                    held++;
                }
        assert_int_equal(held, voxels->cell_count);
    }
}

/* A summation node's box at rest is its cell: what is carried otherwise starts from there. */
TEST(boxes_are_the_nodes_cells)
{
    open_scene("hand-sampled", 0);
    BenchGroup *group = group_of(VIEW_OTHER);
    double(*rest)[3] = get(group, SM_REST);
    group->runner.type->set(group->runner.engine, SM_POSITION, (const double(*)[3])rest);
    const OctStructure *s = oct_engine_structure(group->runner.engine);
    for (long p = 0; p < group->runner.count; p += 17) {
        long members = view_mark(VIEW_OTHER, (int)p);
        const int(*member)[3] = (const int(*)[3])view_members(VIEW_OTHER);
        const float *box = view_boxes(VIEW_OTHER);
        for (long i = 0; i < members; i++) {
            const float *b = box + VIEW_BOX_NUMBERS * member[i][1];
            double edge = s->cell * (1 << (s->tree.levels - (int)b[24]));
            for (int d = 0; d < 3; d++) {
                double low = b[d], high = b[21 + d], x = rest[member[i][0]][d];
                assert_true(fabs(high - low - edge) < 1e-4 * edge && low < x && x < high);
            }
        }
    }
    free(rest);
}

/* ---- both */

/* Looking at the inside changes motion by no more than rounding: goals are where the next step's
 * rotations begin. */
TEST(who_looks_changes_nothing)
{
    static const char *const names[] = {"penguin", "hand-sampled", "liver"};
    for (int n = 0; n < 3; n++) {
        double(*was[2])[3] = {NULL, NULL}, most[2] = {0}, cell;
        for (int looks = 0; looks < 2; looks++) {
            open_scene(names[n], 0);
            for (int side = 0; side < VIEW_SIDES; side++) {
                for (int frame = 0; frame < 15; frame++) {
                    view_step(side, 3);
                    if (!looks) continue;
                    view_mark(side, frame);
                    view_link_ends(side);
                    view_cell_frames(side);
                    view_rest_points(side);
                }
                double(*x)[3] = get(group_of(side), SM_POSITION);
                for (long i = 0; looks && i < 3 * group_of(side)->runner.particles; i++)
                    most[side] = fmax(most[side], fabs(x[i / 3][i % 3] - was[side][i / 3][i % 3]));
                free(was[side]);
                was[side] = x;
            }
        }
        cell = view_figure(0, VIEW_CELL);
        if (!(fmax(most[0], most[1]) < 1e-3 * cell))
            fail_msg("%s: %g and %g cells", names[n], most[0] / cell, most[1] / cell);
        sm_free_all(was[0], was[1]);
    }
}

/* The ghost is the surface as it would be drawn at rest, with what has been cut, whose vertices are
 * not compared. */
TEST(ghosts_are_at_rest)
{
    open_scene("liver", 200);
    for (int side = 0; side < VIEW_SIDES; side++) {
        const BenchGroup *group = group_of(side);
        const float *point = view_rest_points(side), *normal = view_rest_normals(side);
        assert_int_equal(group->skin.surface.vertex_count, view_vertices(side));
        for (long v = 0; v < view_vertices(side); v++) {
            double off = 0, length = 0;
            for (int d = 0; d < 3; d++) {
                double rest = group->skin.surface.position[v][d] + group->body.pose[0][d][3];
                off = fmax(off, fabs(point[3 * v + d] - rest));
                length += normal[3 * v + d] * normal[3 * v + d];
            }
            assert_true(off < 0.02 * group->body.voxels.cell && length < 1.0001);
        }
    }
    assert_null(view_difference(VIEW_LATTICE));
    assert_non_null(strstr(view_not_comparable(), "has been cut"));
}

/* Vertices are compared by body and number: a flower that is touched has a group of its own. */
TEST(differences_are_of_the_same_vertex)
{
    open_scene("flowers", 20);
    long each = group_of(VIEW_LATTICE)->skin.surface.vertex_count, far = 0;
    assert_true(view_side_of(VIEW_OTHER)->play.count > 1);
    for (int side = 0; side < VIEW_SIDES; side++) view_surface(side);
    const float *apart = view_difference(VIEW_OTHER);
    assert_non_null(apart);
    assert_string_equal(view_not_comparable(), "");
    double cell = view_figure(0, VIEW_CELL);
    for (long v = 0; v < view_vertices(VIEW_OTHER); v += 7) {
        long instance;
        double rest[3], square = 0;
        assert_true(view_side_vertex(view_side_of(VIEW_OTHER), v, &instance, rest));
        const float *a = view_points(VIEW_OTHER) + 3 * v; /* the lattices share one group */
        const float *b = view_points(VIEW_LATTICE) + 3 * (instance * each + v % each);
        for (int d = 0; d < 3; d++) square += (double)(a[d] - b[d]) * (a[d] - b[d]);
        assert_true(fabs(apart[v] - sqrt(square) / cell) < 1e-3);
        far += apart[v] > 0.01;
    }
    assert_true(far > 0);
}

/* Naive sums have no bars, and regions all the same. */
TEST(naive_sums_have_no_bars)
{
    const char *text = "mesh = \"shape:block\"; particles = 300; w = 2; summation = \"naive\";";
    strcpy(view_room((int)strlen(text)), text);
    assert_int_equal(view_open((int)strlen(text), 0), 0);
    long members = view_mark(VIEW_LATTICE, 40);
    const int(*member)[3] = (const int(*)[3])view_members(VIEW_LATTICE);
    assert_true(members > 26 && view_mark_figure(VIEW_LATTICE, VIEW_BARS) == 0);
    assert_true(view_mark_figure(VIEW_LATTICE, VIEW_PLATES) == 0);
    for (long i = 0; i < members; i++) assert_true(member[i][1] == 0 && member[i][2] == 0);
}

TEST(numbers_that_nothing_has_do_nothing)
{
    open_scene("penguin", 0);
    assert_int_equal(view_particles(2) + view_particles(-1) + view_links(7), 0);
    assert_int_equal(view_links(VIEW_OTHER) + view_cells(VIEW_LATTICE), 0);
    assert_int_equal(view_mark(0, -1) + view_mark(0, 1 << 30) + view_mark(9, 0), 0);
    assert_null(view_particle_points(2));
    assert_null(view_cell_frames(VIEW_LATTICE));
    assert_null(view_members(-1));
    assert_null(view_goal(2));
    assert_null(view_boxes(2));
    assert_null(view_rest_points(-1));
    assert_null(view_difference(2));
    assert_true(isnan(view_mark_figure(0, VIEW_MARK_FIGURES)));
    assert_true(isnan(view_mark_figure(0, -1)) && isnan(view_mark_figure(3, 0)));
}

TEST_GROUP(NULL, NULL)
