/* Maps of surfaces with handles and holes, and shells on them. */
#include "../shell/test_shell.h"
#include "../solve/modes.h"
#include "../test_solver.h"
#include "surface_map.h"
#include "test_surfaces.h"

static unsigned seed = 3;

static RefSurfaceMap map_of(const SmMesh *mesh, RefMapKind kind, int genus)
{
    RefSurfaceMap map;
    SmError error = {0};
    if (ref_surface_map_create(mesh, false, "mesh", &map, &error) != SM_OK)
        fail_msg("%s", error.text);
    assert_int_equal(map.kind, kind);
    assert_int_equal(map.flips, 0);
    assert_int_equal(map.handles, 0);
    assert_int_equal(ref_surface_map_triangles(&map)->genus, genus);
    return map;
}

static double area_of(const SmMesh *mesh)
{
    double area = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        double normal[3];
        const int *v = mesh->triangle[t];
        sm_area_vector(mesh->position[v[0]], mesh->position[v[1]], mesh->position[v[2]], normal);
        area += sqrt(sm_dot(normal, normal)) / 2;
    }
    return area;
}

/* The cylinders' area is the surface's, and intervals fill their sides but for those that are rims.
 * At a zero inside three cylinders meet, at a pair on a rim two, unless more are on one leaf. */
static void check_cylinders(const SmMesh *mesh, const RefSurfaceMap *map)
{
    const RefCylinders *all = map->chart.cylinders;
    const RefTriangulation *surface = ref_surface_map_triangles(map);
    int zeros = 2 * surface->genus - 2 + surface->rims, pairs = 0, whole = 0;
    double area = 0;
    assert_int_equal(all->joints, 4 * zeros);
    for (int c = 0; c < all->count; c++) {
        const RefCylinder *one = all->cylinder + c;
        double width = one->high[0] - one->low[0], filled[2] = {0};
        area += width * (one->high[1] - one->low[1]);
        assert_true(c == 0 || one->low[0] > one[-1].high[0]);
        for (int j = 0; j < all->joints; j++)
            if (all->joint[j].from == c) {
                filled[all->joint[j].up] += all->joint[j].end - all->joint[j].begin;
                pairs += all->joint[j].to < 0;
            }
        for (int k = 0; k < 2; k++) {
            whole += filled[k] == 0;
            assert_true(filled[k] == 0 || fabs(filled[k] / width - 1) < 1e-9);
        }
    }
    pairs /= 2;
    assert_true(2 * all->count <= 3 * (zeros - pairs) + 2 * pairs + whole);
    assert_true(whole + pairs >= surface->rims);
    assert_true(fabs(area / area_of(mesh) - 1) < 1e-3);
}

/* The chart is where the vertices say; places across joints are one; parts have their area. */
static void check_chart(const SmMesh *mesh, const RefSurfaceMap *map)
{
    const RefChart *chart = &map->chart;
    const RefCylinders *all = chart->cylinders;
    double parts = 0, area = area_of(mesh), size = sqrt(area);
    for (long v = 0; v < map->vertices; v++) {
        double x[3];
        chart->place(chart->data, map->theta[v], x);
        assert_true(sqrt(sm_square_between(x, mesh->position[v])) < 1e-4 * size);
    }
    for (int n = 0; n < 400; n++) {
        const RefJoint *joint = all->joint + n % all->joints;
        const RefCylinder *in = all->cylinder + joint->from;
        const double across[2] = {0, (joint->up ? 1 : -1) * 1e-9};
        double share = random_between(&seed, 0.01, 0.99), x[3], y[3];
        double theta[2] = {joint->begin + share * (joint->end - joint->begin),
                           joint->up ? in->high[1] : in->low[1]};
        if (theta[0] > in->high[0]) theta[0] -= in->high[0] - in->low[0];
        chart->place(chart->data, theta, x);
        assert_true(ref_cylinders_walk(all, theta, across) == (joint->to >= 0));
        if (joint->to < 0) continue;
        assert_int_equal(ref_cylinders_at(all, theta), joint->to);
        chart->place(chart->data, theta, y);
        assert_true(sqrt(sm_square_between(x, y)) < 1e-6 * size);
    }
    for (int c = 0; c < all->count; c++)
        for (int n = 0; n < 12; n++) {
            double low[2], high[2], side[2];
            for (int d = 0; d < 2; d++) {
                int count = d ? 4 : 3, which = d ? n / 3 : n % 3;
                side[d] = (all->cylinder[c].high[d] - all->cylinder[c].low[d]) / count;
                low[d] = all->cylinder[c].low[d] + which * side[d];
                high[d] = low[d] + side[d];
            }
            parts += pow(chart->mean(chart->data, low, high), 2) * side[0] * side[1];
        }
    assert_true(fabs(parts / area - 1) < 1e-3);
}

/* Angles of the plane are those of the surface, better with more points. */
TEST(a_double_torus_is_three_cylinders)
{
    needs_solver();
    double median[2];
    for (int fine = 0; fine < 2; fine++) {
        SmMesh mesh = tori_mesh(&double_torus, fine ? 90 : 45, &seed);
        random_move(&seed, &mesh);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_MULTITORUS, 2);
        check_cylinders(&mesh, &map);
        check_chart(&mesh, &map);
        median[fine] = map.angle_median;
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
    assert_true(median[0] < 2.5 && median[1] < 0.65 * median[0]);
}

static void check_and_free(SmMesh *mesh, RefSurfaceMap *map, double most_degrees)
{
    check_chart(mesh, map);
    assert_true(map->angle_median < most_degrees);
    ref_surface_map_free(map);
    sm_mesh_free(mesh);
}

TEST(so_is_one_with_symmetries_and_a_triple_torus_is_six)
{
    needs_solver();
    for (int genus = 2; genus < 4; genus++) {
        SmMesh mesh = tori_mesh(genus == 2 ? &even_double_torus : &triple_torus, 80, &seed);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_MULTITORUS, genus);
        check_cylinders(&mesh, &map);
        check_and_free(&mesh, &map, 2);
    }
}

/* Holes in a row, one beside another, and anywhere. */
TEST(a_sheet_with_holes_is_cylinders_with_rims)
{
    needs_solver();
    for (int n = 0; n < 9; n++) {
        int holes = 2 + n % 3;
        Holes anywhere = random_holes(holes, &seed);
        const Holes *in = n == 0 ? &two_holes : n == 1 ? &three_holes : &anywhere;
        SmMesh mesh = plate_mesh(in, 50, 0.05, &seed);
        random_move(&seed, &mesh);
        sm_mesh_merge(&mesh);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_HOLED, 0);
        assert_int_equal(ref_surface_map_triangles(&map)->rims, 1 + holes);
        check_cylinders(&mesh, &map);
        check_and_free(&mesh, &map, 3);
    }
}

/* Small holes stay where there is a map with them; of more than there is one with, the smallest are
 * closed. */
TEST(holes_are_closed_only_where_there_is_no_map)
{
    needs_solver();
    Holes holes = {3, {{0.8, 1.1, 0.15}, {2, 0.9, 0.3}, {3.2, 1, 0.17}}};
    SmMesh mesh = plate_mesh(&holes, 40, 0.05, &seed);
    sm_mesh_merge(&mesh);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_HOLED, 0);
    assert_int_equal(map.closed, 0);
    check_and_free(&mesh, &map, 3);
    for (holes.holes = 0; holes.holes < 18; holes.holes++) {
        double *hole = holes.hole[holes.holes];
        hole[0] = 0.4 + 0.64 * (holes.holes % 6);
        hole[1] = 0.4 + 0.6 * (holes.holes / 6);
        hole[2] = 0.11 + 0.002 * (holes.holes * 7 % 18);
    }
    mesh = plate_mesh(&holes, 60, 0.05, &seed);
    sm_mesh_merge(&mesh);
    map = map_of(&mesh, REF_MAP_HOLED, 0);
    assert_true(map.closed >= 3);
    assert_int_equal(ref_surface_map_triangles(&map)->rims, 19 - map.closed);
    assert_true(map.angle_median < 4);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

/* Tori in a row, of which the outer ones have a hole, or only the first. */
static SmMesh open_tori(const Tori *all, int rims, int cells)
{
    SmMesh mesh = tori_mesh(all, cells, &seed);
    for (int n = 0; n < rims; n++) {
        int at = n ? all->tori - 1 : 0, way = n ? 1 : -1;
        const double middle[3] = {all->centre[at][0] + way * (all->ring[at] + all->tube[at]),
                                  all->centre[at][1], 0.1};
        punch(middle, 0.4, &mesh);
    }
    sm_mesh_merge(&mesh);
    return mesh;
}

static const Tori single_torus = {1, {{0, 0}}, {1.1}, {0.45}};

TEST(so_are_tori_with_holes)
{
    needs_solver();
    for (int n = 0; n < 5; n++) {
        static const Tori *const tori[] = {&single_torus, &double_torus, &triple_torus};
        int genus = 1 + n % 3, rims = 1 + n / 3;
        SmMesh mesh = open_tori(tori[n % 3], n == 3 ? 1 : rims, 70);
        if (n == 3) punch((double[3]){1.55, 0, 0.1}, 0.35, &mesh);
        sm_mesh_merge(&mesh);
        random_move(&seed, &mesh);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_HOLED, genus);
        assert_int_equal(ref_surface_map_triangles(&map)->rims, rims);
        check_cylinders(&mesh, &map);
        check_and_free(&mesh, &map, 3);
    }
}

/* Angles of the plane are those of the surface, better with more points. */
TEST(angles_with_rims_get_better_with_more_points)
{
    needs_solver();
    unsigned once = seed;
    for (int kind = 0; kind < 3; kind++) {
        double median[2], most[2];
        for (int fine = 0; fine < 2; fine++) {
            unsigned same = once;
            Holes holes = random_holes(3 + kind, &same);
            SmMesh mesh = kind < 2 ? plate_mesh(&holes, fine ? 80 : 40, 0.05, &seed)
                                   : open_tori(&single_torus, 1, fine ? 120 : 60);
            sm_mesh_merge(&mesh);
            RefSurfaceMap map = map_of(&mesh, REF_MAP_HOLED, kind / 2);
            median[fine] = map.angle_median;
            most[fine] = map.angle_95;
            ref_surface_map_free(&map);
            sm_mesh_free(&mesh);
        }
        assert_true(median[0] < 3 && median[1] < 0.75 * median[0]);
        assert_true(most[1] < 0.9 * most[0]);
    }
}

/* Around every vertex the plane has one turn or, at zeros, two; on a rim half of that. */
static int count_zeros(const RefSurfaceMap *map, int *on_rims)
{
    const RefTriangulation *surface = ref_surface_map_triangles(map);
    double *turn = sm_alloc((size_t)surface->vertices, sizeof *turn);
    for (long t = 0; t < surface->triangles; t++) {
        RefMapTriangle one = ref_surface_map_triangle(map, t);
        for (int i = 0; i < 3; i++) {
            const double *at = one.theta[i], *next = one.theta[(i + 1) % 3];
            const double *last = one.theta[(i + 2) % 3];
            double a[2] = {next[0] - at[0], next[1] - at[1]};
            double b[2] = {last[0] - at[0], last[1] - at[1]};
            turn[surface->vertex[3 * t + i]] +=
                atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]) / (2 * M_PI);
        }
    }
    int zeros = 0;
    *on_rims = 0;
    for (long v = 0; v < surface->vertices; v++) {
        bool open = surface->rim[surface->corner[v]] >= 0;
        double turns = open ? 2 * turn[v] : turn[v];
        assert_true(fabs(turns - 1) < 1e-6 || fabs(turns - 2) < 1e-6);
        *(open ? on_rims : &zeros) += turns > 1.5;
    }
    free(turn);
    return zeros;
}

TEST(zeros_have_two_turns)
{
    needs_solver();
    int on_rims;
    SmMesh mesh = tori_mesh(&triple_torus, 70, &seed);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_MULTITORUS, 3);
    assert_int_equal(count_zeros(&map, &on_rims), 4);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
    mesh = open_tori(&single_torus, 1, 60);
    map = map_of(&mesh, REF_MAP_HOLED, 1);
    assert_int_equal(count_zeros(&map, &on_rims), 0); /* what flows in at a rim flows out there */
    assert_int_equal(on_rims, 2);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

/* Four triangles in place of each are the same surface. */
TEST(quarters_are_the_same_surface)
{
    SmMesh mesh = tori_mesh(&double_torus, 40, &seed);
    RefTriangulation surface;
    assert_int_equal(ref_triangulation_create(&mesh, "mesh", 0, &surface, NULL), SM_OK);
    ref_triangulation_delaunay(&surface);
    RefTriangulation four = ref_triangulation_quarter(&surface);
    assert_int_equal(four.triangles, 4 * surface.triangles);
    assert_int_equal(four.genus, 2);
    assert_int_equal(four.rims, 0);
    double area = ref_triangulation_area(&surface);
    assert_true(fabs(ref_triangulation_area(&four) / area - 1) < 1e-12);
    for (int c = 0; c < 3 * four.triangles; c++) {
        int twin = four.twin[c];
        assert_int_equal(four.twin[twin], c);
        assert_int_equal(four.vertex[twin], four.vertex[ref_corner_next(c)]);
        assert_true(four.length[twin] == four.length[c]);
    }
    for (int v = 0; v < four.vertices; v++) {
        assert_int_equal(four.vertex[four.corner[v]], v);
        assert_true(v >= surface.vertices || four.source[v] == surface.source[v]);
    }
    ref_triangulation_free(&four);
    ref_triangulation_free(&surface);
    sm_mesh_free(&mesh);
}

static RefShellOptions options_of(long nodes, bool linear)
{
    return (RefShellOptions){.across = 1,
                             .nodes = nodes,
                             .basis = linear ? REF_MLS_PLANE_LINEAR : REF_MLS_PLANE_QUADRATIC,
                             .thickness = 0.05,
                             .material = {1e5, 0.3, 2}};
}

/* How large the forces of a rigid motion are, beside those of a random one that is as large. */
static double forces_of(const RefShell *shell, int kind)
{
    long size = 3 * shell->nodes.count;
    double length[2][2] = {{0}}, *f = sm_alloc((size_t)size, sizeof *f);
    double(*u)[3] = sm_alloc((size_t)size / 3, sizeof *u);
    for (int random = 0; random < 2; random++) {
        memset(f, 0, (size_t)size * sizeof *f);
        for (long n = 0; n < shell->nodes.count; n++) {
            double turn[3] = {0};
            for (int d = 0; d < 3; d++) u[n][d] = random ? random_between(&seed, -1, 1) : kind == d;
            if (!random && kind > 2) turn[kind - 3] = 1;
            if (!random && kind > 2) sm_cross(turn, shell->X[n], u[n]);
        }
        ref_sparse_apply(&shell->matrices.stiffness, 1, u[0], f);
        for (long n = 0; n < size; n++) {
            length[random][0] += f[n] * f[n];
            length[random][1] += u[n / 3][n % 3] * u[n / 3][n % 3];
        }
    }
    sm_free_all(f, u);
    return sqrt(length[0][0] / length[0][1] / (length[1][0] / length[1][1]));
}

/* Six motions cost nothing, and, if that is asked, no seventh does; the middle surface has the
 * mesh's area. */
static void check_shell(const SmMesh *mesh, const RefSurfaceMap *map, bool linear, bool seventh,
                        double off)
{
    RefShellOptions options = options_of(2000, linear);
    RefShell shell;
    RefModes modes = {.count = 0};
    shell_of(&map->chart, &options, &shell);
    for (int kind = 0; kind < 6; kind++) assert_true(forces_of(&shell, kind) < 1e-10);
    if (seventh) assert_int_equal(ref_modes_find(&shell.matrices, NULL, 8, &modes, NULL), SM_OK);
    for (int k = 0; k < 6 && seventh; k++)
        assert_true(fabs(modes.lambda[k]) < 1e-5 * modes.lambda[6]);
    double *mass = sm_alloc((size_t)shell.nodes.count, sizeof *mass), area = 0;
    ref_sparse_sums(&shell.matrices.mass, mass);
    for (long n = 0; n < shell.nodes.count; n++)
        area += mass[n] / (options.material.density * options.thickness);
    assert_true(fabs(area / area_of(mesh) - 1) < off);
    free(mass);
    ref_modes_free(&modes);
    ref_shell_free(&shell);
}

TEST(shells_of_it_are_rigid_in_six_ways)
{
    needs_solver();
    SmMesh mesh = tori_mesh(&double_torus, 150, &seed);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_MULTITORUS, 2);
    for (int linear = 0; linear < 2; linear++)
        check_shell(&mesh, &map, linear, true, linear ? 1.5e-3 : 1e-3);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

TEST(so_are_those_with_holes)
{
    needs_solver();
    for (int n = 0; n < 4; n++) {
        Holes holes = random_holes(1 + n, &seed);
        SmMesh mesh = n ? plate_mesh(&holes, 80, 0.05, &seed) : open_tori(&single_torus, 1, 100);
        sm_mesh_merge(&mesh);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_HOLED, n == 0);
        check_shell(&mesh, &map, false, false, n ? 2e-3 : 4e-3);
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
}

/* Tori of any size in a row, with round holes anywhere that are apart. */
static SmMesh tori_anywhere(int tori, int rims, int cells, unsigned from)
{
    Tori all = {.tori = tori};
    for (int n = 0; n < tori; n++) {
        all.ring[n] = random_between(&from, 0.9, 1.2);
        all.tube[n] = random_between(&from, 0.32, 0.45);
        if (n)
            all.centre[n][0] = all.centre[n - 1][0] + all.ring[n - 1] + all.ring[n] +
                               random_between(&from, 0, 0.2);
        all.centre[n][1] = random_between(&from, -0.3, 0.3);
    }
    double middle = all.centre[tori - 1][0] / 2, hole[8][3], radius[8];
    for (int n = 0; n < tori; n++) all.centre[n][0] -= middle;
    SmMesh mesh = tori_mesh(&all, cells, &from);
    for (int k = 0; k < rims;) {
        memcpy(hole[k], mesh.position[random_int(&from, (int)mesh.vertex_count)], sizeof *hole);
        radius[k] = random_between(&from, 0.32, 0.5);
        bool apart = true;
        for (int j = 0; j < k; j++)
            apart &= sqrt(sm_square_between(hole[j], hole[k])) > radius[j] + radius[k] + 0.2;
        k += apart;
    }
    for (int k = 0; k < rims; k++) punch(hole[k], radius[k], &mesh);
    sm_mesh_merge(&mesh);
    return mesh;
}

/* Of some every form that suits has zeros nearly on one leaf, or one whose vertex is not where a
 * quadratic function has it: they keep all their handles and rims as well. */
TEST(no_handle_or_rim_is_lost)
{
    needs_solver();
    static const struct {
        int genus, rims, cells;
        unsigned from;
    } given[] = {{3, 4, 40, 4252699469u}, {4, 3, 45, 476248821u}, {4, 3, 45, 3049328483u}};
    for (int n = 0; n < 3; n++) {
        SmMesh mesh = tori_anywhere(given[n].genus, given[n].rims, given[n].cells, given[n].from);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_HOLED, given[n].genus);
        assert_int_equal(ref_surface_map_triangles(&map)->rims, given[n].rims);
        check_cylinders(&mesh, &map);
        check_and_free(&mesh, &map, 5);
    }
}

/* As many as the search takes. */
TEST(sixteen_handles_are_kept)
{
    needs_solver();
    SmMesh mesh = tori_anywhere(16, 0, 160, 5);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_MULTITORUS, 16);
    check_cylinders(&mesh, &map);
    check_and_free(&mesh, &map, 5);
}
