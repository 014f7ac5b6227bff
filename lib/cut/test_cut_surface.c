/* Surfaces split by cuts: random ones through random solids, and the awkward ones. */
#include "cut_surface.h"

#include "../mesh/test_volumes.h"
#include "../predicates.h"
#include "../shapes/polygonise.h"
#include "../test_frame.h"
#include "../test_random.h"
#include "../vector.h"
#include "test_area.h"

static unsigned seed = 1;

static long cleared; /* triangles that were far from a cut, and had to stay */

/* A cube from 0 to 10: 12 triangles. */
static SmMesh cube(void)
{
    static const int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    SmMesh mesh = sm_mesh_new(8, 12);
    for (int i = 0; i < 24; i++) mesh.position[i / 3][i % 3] = 10 * (i / 3 >> i % 3 & 1);
    for (int t = 0; t < 12; t++) {
        const int *f = face[t / 2];
        memcpy(mesh.triangle[t], ((int[3]){f[0], f[t % 2 + 1], f[t % 2 + 2]}), 3 * sizeof(int));
    }
    return mesh;
}

/* Some blended balls within about 0 .. 10. */
static SmMesh blob(void)
{
    SmImplicit solid = {0};
    SmMesh mesh;
    for (int i = 0; i < 4; i++) {
        double centre[3], size[3];
        for (int d = 0; d < 3; d++) {
            centre[d] = random_between(&seed, 3, 7);
            size[d] = random_between(&seed, 1, 3);
        }
        SmPrimitive ball = sm_primitive(SM_ELLIPSOID, 0.5, centre, size);
        sm_implicit_add(&solid, &ball);
    }
    sm_polygonise(&solid, &(SmBox){{-2, -2, -2}, {12, 12, 12}}, 1, &mesh);
    sm_implicit_free(&solid);
    return mesh;
}

/* nx x ny squares around c, along u and v; `bend` lifts its sides. Returns the first triangle. */
static long sheet(SmCut *cut, int nx, int ny, const double c[3], const double u[3],
                  const double v[3], double bend)
{
    long first = cut->triangles, base = cut->vertices;
    double up[3];
    sm_cross(u, v, up);
    sm_normalize(up);
    for (int n = 0; n < (nx + 1) * (ny + 1); n++) {
        double s = (double)(n % (nx + 1)) / nx - 0.5, t = (double)(n / (nx + 1)) / ny - 0.5, at[3];
        for (int d = 0; d < 3; d++)
            at[d] = c[d] + s * u[d] + t * v[d] + bend * (s * s - t * t / 2) * up[d];
        sm_cut_vertex(cut, at);
    }
    for (int n = 0; n < nx * ny; n++) {
        int a = (int)base + n / nx * (nx + 1) + n % nx, b = a + nx + 1;
        sm_cut_triangle(cut, (int[3]){a, a + 1, b + 1});
        sm_cut_triangle(cut, (int[3]){a, b + 1, b});
    }
    return first;
}

static bool is_near(const double (*position)[3], const int triangle[3], const double at[3],
                    double within)
{
    double corner[3][3];
    for (int d = 0; d < 3; d++) { /* most are far away */
        int above = 0, below = 0;
        for (int i = 0; i < 3; i++) {
            corner[i][d] = position[triangle[i]][d];
            above += corner[i][d] > at[d] + within;
            below += corner[i][d] < at[d] - within;
        }
        if (above == 3 || below == 3) return false;
    }
    return sm_triangle_meets_box(corner, at, (double[3]){within, within, within});
}

/* How many of the cut's triangles from `first` on a place is beside, and whether beside a corner.
 */
static int count_near(const SmCut *cut, long first, const double at[3], bool *corner)
{
    const double within = 5e-4;
    int count = 0;
    *corner = false;
    for (long t = first; t < cut->triangles; t++) {
        if (!is_near(cut->vertex, cut->triangle[t], at, within)) continue;
        count++;
        for (int i = 0; i < 3; i++) {
            const double *p = cut->vertex[cut->triangle[t][i]];
            double away[3] = {at[0] - p[0], at[1] - p[1], at[2] - p[2]};
            *corner |= sqrt(sm_dot(away, away)) < within;
        }
    }
    return count;
}

/* Every new vertex is beside the cut, and on a triangle that has gone, beside a corner of the cut,
 * or where what two of its triangles took away meets. */
static void assert_new_vertices(const SmMesh *old, const SmMesh *mesh, const SmCut *cut, long first)
{
    long gone = 0, *went = sm_alloc((size_t)old->triangle_count, sizeof *went);
    for (long t = 0; t < old->triangle_count; t++)
        if (t >= mesh->triangle_count ||
            memcmp(old->triangle[t], mesh->triangle[t], sizeof *old->triangle) != 0)
            went[gone++] = t;
    for (long v = old->vertex_count; v < mesh->vertex_count; v++) {
        bool corner, on_surface = false;
        const double *at = mesh->position[v];
        int count = count_near(cut, first, at, &corner);
        for (long n = 0; n < gone && !corner && !on_surface; n++)
            on_surface = is_near(old->position, old->triangle[went[n]], at, 1e-8);
        assert_true(count > 0 && (on_surface || corner || count > 1));
    }
    free(went);
}

/* Is a triangle's box, a little wider, clear of the cut? */
static bool is_clear(const SmMesh *mesh, long t, const SmCut *cut, long first)
{
    double centre[3], half[3], corner[3][3];
    for (int d = 0; d < 3; d++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < 3; i++) {
            double at = mesh->position[mesh->triangle[t][i]][d];
            low = fmin(low, at);
            high = fmax(high, at);
        }
        centre[d] = (low + high) / 2;
        half[d] = (high - low) / 2 + 1e-3;
    }
    for (long c = first; c < cut->triangles; c++) {
        for (int i = 0; i < 3; i++)
            memcpy(corner[i], cut->vertex[cut->triangle[c][i]], sizeof corner[i]);
        if (sm_triangle_meets_box(corner, centre, half)) return false;
    }
    return true;
}

static bool has_triangle(const SmMesh *mesh, const int triangle[3])
{
    for (long t = 0; t < mesh->triangle_count; t++)
        if (memcmp(mesh->triangle[t], triangle, sizeof *mesh->triangle) == 0) return true;
    return false;
}

/* What is clear of the cut stays, with its number, but the last triangles may fill gaps. Looks at
 * every third triangle. */
static void assert_rest_stays(const SmMesh *old, const SmMesh *mesh, const SmCut *cut, long first)
{
    assert_true(mesh->vertex_count >= old->vertex_count);
    assert_memory_equal(mesh->position, old->position,
                        (size_t)old->vertex_count * sizeof *old->position);
    for (long t = first % 3; t < old->triangle_count; t += 3) {
        if (!is_clear(old, t, cut, first)) continue;
        if (t < mesh->triangle_count)
            assert_memory_equal(mesh->triangle[t], old->triangle[t], sizeof *old->triangle);
        else
            assert_true(has_triangle(mesh, old->triangle[t]));
        cleared++;
    }
}

/* Splits a closed mesh and checks that it is closed, lost no more than the cut takes, and that
 * nothing changed but what is along the cut. */
static SmCutResult split(SmMesh *mesh, const SmCut *cut, long first)
{
    SmMeshInfo before = sm_mesh_info(mesh);
    SmMesh old = sm_mesh_new(mesh->vertex_count, mesh->triangle_count);
    memcpy(old.position, mesh->position, (size_t)old.vertex_count * sizeof *old.position);
    memcpy(old.triangle, mesh->triangle, (size_t)old.triangle_count * sizeof *old.triangle);
    SmCutResult result = sm_cut_surface(mesh, cut, first, 1);
    SmMeshInfo after = sm_mesh_info(mesh);
    assert_true(result == SM_CUT_MISSED || result == SM_CUT_CLOSED);
    assert_true(after.watertight);
    assert_int_equal(after.flipped_edges, 0);
    double most = 1.3e-4 * (cut_area(cut, first) + 1);
    assert_true(after.volume <= before.volume + 1e-9 && after.volume >= before.volume - most);
    assert_rest_stays(&old, mesh, cut, first);
    assert_new_vertices(&old, mesh, cut, first);
    if (result == SM_CUT_MISSED) {
        assert_int_equal(mesh->vertex_count, old.vertex_count);
        assert_int_equal(mesh->triangle_count, old.triangle_count);
        assert_memory_equal(mesh->triangle, old.triangle,
                            (size_t)old.triangle_count * sizeof *old.triangle);
    }
    sm_mesh_free(&old);
    return result;
}

static void random_frame(double c[3], double u[3], double v[3])
{
    double w[3];
    for (int d = 0; d < 3; d++) {
        c[d] = random_between(&seed, 1, 9);
        u[d] = random_between(&seed, -1, 1);
        v[d] = random_between(&seed, -1, 1);
    }
    sm_cross(u, v, w);
    sm_cross(w, u, v);
    sm_normalize(u);
    sm_normalize(v);
    double along = random_between(&seed, 1, 20), across = random_between(&seed, 1, 20);
    for (int d = 0; d < 3; d++) {
        u[d] *= along;
        v[d] *= across;
    }
}

TEST(random_cuts_leave_closed_surfaces)
{
    long closed = 0;
    for (int trial = 0; trial < 120; trial++) {
        SmMesh mesh = trial % 4 ? cube() : blob();
        SmCut cut;
        sm_cut_init(&cut, 2);
        for (int n = 0; n < 8; n++) {
            double c[3], u[3], v[3], bend = n % 2 ? random_between(&seed, -10, 10) : 0;
            random_frame(c, u, v);
            long first =
                sheet(&cut, 1 + random_int(&seed, 8), 1 + random_int(&seed, 8), c, u, v, bend);
            closed += split(&mesh, &cut, first) == SM_CUT_CLOSED;
        }
        sm_cut_free(&cut);
        sm_mesh_free(&mesh);
    }
    assert_true(closed > 800);
    assert_true(cleared > 400000);
}

static long count_pieces(const SmMesh *mesh)
{
    return sm_mesh_info(mesh).components;
}

TEST(cuts_right_through_leave_the_pieces_that_they_should)
{
    SmMesh mesh = cube();
    SmCut cut;
    sm_cut_init(&cut, 2);
    long expected = 1;
    for (int axis = 0; axis < 3; axis++)
        for (int n = 1; n < 4; n++) {
            double c[3] = {5, 5, 5}, u[3] = {0}, v[3] = {0};
            c[axis] = 2.5 * n;
            u[(axis + 1) % 3] = 11;
            v[(axis + 2) % 3] = 11;
            assert_int_equal(split(&mesh, &cut, sheet(&cut, 5, 4, c, u, v, 0)), SM_CUT_CLOSED);
            expected += expected / n;
            assert_int_equal(count_pieces(&mesh), expected);
        }
    assert_int_equal(expected, 64);
    sm_cut_free(&cut);
    sm_mesh_free(&mesh);
}

TEST(pieces_have_the_volumes_that_a_cut_leaves_them)
{
    SmMesh mesh = cube();
    SmCut cut;
    SmPieces pieces;
    double volume[2];
    sm_cut_init(&cut, 2);
    const double c[3] = {2.5, 5, 5}, u[3] = {0, 12, 0}, v[3] = {0, 0, 12};
    assert_int_equal(split(&mesh, &cut, sheet(&cut, 1, 1, c, u, v, 0)), SM_CUT_CLOSED);
    sm_mesh_pieces(&mesh, &pieces);
    assert_int_equal(pieces.count, 2);
    sum_volumes(&mesh, &pieces, volume);
    assert_float_equal(fmin(volume[0], volume[1]), 250, 0.02);
    assert_float_equal(fmax(volume[0], volume[1]), 750, 0.02);
    sm_pieces_free(&pieces);
    sm_cut_free(&cut);
    sm_mesh_free(&mesh);
}

/* Row by row, each going on where the one before stopped: its front opens, nothing else changes,
 * and the last one parts the cube. */
TEST(a_cut_goes_on_from_its_front)
{
    for (int turn = 0; turn < 20; turn++) {
        SmMesh mesh = cube();
        SmCut cut;
        sm_cut_init(&cut, 2);
        enum { WIDE = 7, ROWS = 12 };
        double tilt = turn == 0 ? 0 : random_between(&seed, -0.5, 0.5),
               wave = turn < 2 ? 0 : random_between(&seed, 0, 1);
        for (int row = 0; row <= ROWS; row++) {
            long first = cut.triangles;
            for (int i = 0; i <= WIDE; i++) {
                double x = -1 + 12.0 * i / WIDE, y = -0.9 + 11.8 * row / ROWS;
                double z = 5 + tilt * (x - 5) + wave * sin(y * 1.5 + i * 0.2);
                sm_cut_vertex(&cut, (double[3]){x, y, z});
            }
            for (int i = 0; i < WIDE && row > 0; i++) {
                int a = (row - 1) * (WIDE + 1) + i, b = a + WIDE + 1;
                sm_cut_triangle(&cut, (int[3]){a, a + 1, b + 1});
                sm_cut_triangle(&cut, (int[3]){a, b + 1, b});
            }
            if (row == 0) continue;
            split(&mesh, &cut, first);
            assert_int_equal(count_pieces(&mesh), row == ROWS ? 2 : 1);
        }
        sm_cut_free(&cut);
        sm_mesh_free(&mesh);
    }
}

/* The same sheet again and again; a flat one, which lies in its own sides, and one through the
 * cube's corners and edges. */
TEST(a_cut_may_be_repeated)
{
    const double c[3] = {5, 5, 5};
    const double v[3] = {0, 14, 0};
    const double way[4][3] = {{14, 0, 0}, {20, 0, 20}, {10, 0, 0}, {10, 0, 10}};
    for (int kind = 0; kind < 4; kind++) {
        SmMesh mesh = cube();
        SmCut cut;
        sm_cut_init(&cut, 2);
        for (int n = 0; n < 6; n++)
            split(&mesh, &cut, sheet(&cut, 4 + n % 2, 3, c, way[kind], v, 0));
        if (kind < 2) assert_true(count_pieces(&mesh) >= 2);
        assert_true(sm_mesh_info(&mesh).volume > 1000 - 0.1);
        sm_cut_free(&cut);
        sm_mesh_free(&mesh);
    }
}

/* In a face's plane, along an edge, through a corner, beside it, and far away. */
TEST(grazing_cuts_do_no_harm)
{
    const double where[6][3] = {{5, 5, 10},   {5, 5, 0},      {0, 0, 5},
                                {10, 10, 10}, {5, 5, 10.001}, {500, 0, 0}};
    const double ways[3][2][3] = {
        {{8, 0, 0}, {0, 8, 0}}, {{12, 0, 0}, {0, 12, 0}}, {{4, -4, 0}, {0, 0, 4}}};
    for (int place = 0; place < 6; place++)
        for (int way = 0; way < 3; way++) {
            SmMesh mesh = cube();
            SmCut cut;
            sm_cut_init(&cut, 2);
            long first = sheet(&cut, 3, 3, where[place], ways[way][0], ways[way][1], 0);
            SmCutResult result = split(&mesh, &cut, first);
            if (place >= 4 && way < 2) assert_int_equal(result, SM_CUT_MISSED);
            split(&mesh, &cut, first);
            sm_cut_free(&cut);
            sm_mesh_free(&mesh);
        }
}

/* A sheet that does not reach the surface leaves a flat hollow in the material. */
TEST(a_cut_within_the_material_is_a_hollow)
{
    SmMesh mesh = cube();
    SmCut cut;
    sm_cut_init(&cut, 2);
    const double c[3] = {5, 5, 5}, u[3] = {4, 1, 0}, v[3] = {0, 3, 1};
    long first = sheet(&cut, 3, 2, c, u, v, 1);
    assert_int_equal(split(&mesh, &cut, first), SM_CUT_CLOSED);
    assert_int_equal(count_pieces(&mesh), 2);
    assert_int_equal(mesh.triangle_count, 12 + 2 * 12 + 2 * 10);
    sm_cut_free(&cut);
    sm_mesh_free(&mesh);
}

/* Triangles without area, three on an edge, folded ones, a Moebius band of them. */
TEST(odd_sheets_are_cut_triangle_by_triangle)
{
    for (int kind = 0; kind < 4; kind++) {
        SmMesh mesh = cube();
        SmCut cut;
        sm_cut_init(&cut, 2);
        const double at[6][3] = {{2, 2, 5}, {8, 2, 5}, {5, 8, 5}, {5, 5, 9}, {5, -3, 4}, {5, 2, 5}};
        for (int n = 0; n < 6; n++) sm_cut_vertex(&cut, at[n]);
        sm_cut_triangle(&cut, (int[3]){0, 1, kind == 0 ? 5 : 2});
        if (kind == 1) sm_cut_triangle(&cut, (int[3]){0, 1, 3});
        if (kind == 1) sm_cut_triangle(&cut, (int[3]){0, 1, 4});
        if (kind == 2) sm_cut_triangle(&cut, (int[3]){1, 0, 2});
        if (kind == 3) sm_cut_triangle(&cut, (int[3]){0, 1, 4});
        assert_int_equal(split(&mesh, &cut, 0), kind == 0 ? SM_CUT_MISSED : SM_CUT_CLOSED);
        sm_cut_free(&cut);
        sm_mesh_free(&mesh);
    }
}

TEST(everything_into_small_cubes)
{
    SmMesh mesh = cube();
    SmCut cut;
    sm_cut_init(&cut, 2);
    for (int n = 0; n < 27; n++) {
        double c[3] = {5, 5, 5}, u[3] = {0}, v[3] = {0};
        int axis = n % 3;
        c[axis] = n / 3 + 1;
        u[(axis + 1) % 3] = 10.5;
        v[(axis + 2) % 3] = 10.5;
        assert_int_equal(split(&mesh, &cut, sheet(&cut, 1, 1, c, u, v, 0)), SM_CUT_CLOSED);
    }
    assert_int_equal(count_pieces(&mesh), 1000);
    sm_cut_free(&cut);
    sm_mesh_free(&mesh);
}

/* Some triangles of the surface: with a corner twice or three times, those of others again or
 * turned over, of no area, as thin as rounding. Split or left, never harmed. */
TEST(triangles_that_should_not_be_do_no_harm)
{
    const double c[3] = {5, 5, 4.9}, u[3] = {30, 0, 1}, v[3] = {0, 30, 1};
    for (int kind = 0; kind < 6; kind++)
        for (int many = 1; many < 60; many += 29) {
            static const int odd[6][3] = {{0, 4, 0}, {4, 4, 4}, {0, 4, 5}, {5, 4, 0}, {0, 4, 8}};
            SmMesh small = cube(), mesh = sm_mesh_new(9, 12 + many);
            memcpy(mesh.position, small.position, 8 * sizeof *mesh.position);
            memcpy(mesh.triangle, small.triangle, 12 * sizeof *mesh.triangle);
            for (int d = 0; d < 3; d++)
                mesh.position[8][d] = (mesh.position[0][d] + mesh.position[4][d]) / 2;
            for (int n = 0; n < many; n++) memcpy(mesh.triangle[12 + n], odd[kind], sizeof *odd);
            if (kind == 5) {
                mesh.position[8][0] = 1e-17;
                for (int n = 0; n < many; n++)
                    memcpy(mesh.triangle[12 + n], ((int[3]){0, 8, 4}), sizeof *odd);
            }
            SmCut cut;
            sm_cut_init(&cut, 2);
            for (int n = 0; n < 3; n++) {
                long first = sheet(&cut, 3, 3, c, u, v, n);
                assert_in_range(sm_cut_surface(&mesh, &cut, first, 1), SM_CUT_MISSED,
                                SM_CUT_INCOMPLETE);
                assert_true(mesh.triangle_count >= 12);
            }
            for (long t = 0; t < mesh.triangle_count; t++)
                for (int i = 0; i < 3; i++)
                    assert_in_range(mesh.triangle[t][i], 0, mesh.vertex_count - 1);
            sm_cut_free(&cut);
            sm_mesh_free(&small);
            sm_mesh_free(&mesh);
        }
}

/* Inside out: closed, and inside out still. Open, or two that cross: split along the cut, or
 * closed where that is possible; never harmed. */
TEST(surfaces_that_are_not_solid_are_split_too)
{
    const double c[3] = {5, 5, 4}, u[3] = {12, 0, 1}, v[3] = {0, 12, 1};
    for (int kind = 0; kind < 4; kind++) {
        SmMesh mesh = cube();
        SmCut cut;
        sm_cut_init(&cut, 2);
        long first = sheet(&cut, 4, 4, c, u, v, 1);
        if (kind == 0)
            for (int t = 0; t < 12; t++) {
                int swap = mesh.triangle[t][1];
                mesh.triangle[t][1] = mesh.triangle[t][2];
                mesh.triangle[t][2] = swap;
            }
        if (kind == 1) mesh.triangle_count = 10; /* no lid at x = 10, which the cut crosses */
        if (kind == 2) memcpy(mesh.triangle[2], mesh.triangle[0], sizeof *mesh.triangle);
        if (kind == 3) mesh.position[7][0] = mesh.position[7][1] = mesh.position[7][2] = -3;
        SmMeshInfo before = sm_mesh_info(&mesh);
        SmCutResult result = sm_cut_surface(&mesh, &cut, first, 1);
        SmMeshInfo after = sm_mesh_info(&mesh);
        if (kind == 0) {
            assert_int_equal(result, SM_CUT_CLOSED);
            assert_true(after.watertight && fabs(after.volume + 1000) < 0.1);
            assert_int_equal(after.components, 2);
        }
        if (kind == 1) {
            assert_int_equal(result, SM_CUT_OPEN);
            assert_int_equal(after.components, 2);
        }
        assert_true(after.flipped_edges <= before.flipped_edges);
        assert_true(after.triangles >= before.triangles);
        if (result != SM_CUT_OPEN) assert_true(after.open_edges <= before.open_edges);
        sm_cut_free(&cut);
        sm_mesh_free(&mesh);
    }
}
