/* Maps of surfaces whose conformal parameters are known. */
#include "surface_map.h"

#include "../../../lib/mesh/import.h"
#include "../test_solver.h"
#include "harmonic.h"
#include "test_surfaces.h"

static unsigned seed = 1;

static RefSurfaceMap map_of(const SmMesh *mesh, RefMapKind kind)
{
    RefSurfaceMap map;
    SmError error = {0};
    if (ref_surface_map_create(mesh, false, "mesh", &map, &error) != SM_OK)
        fail_msg("%s", error.text);
    assert_int_equal(map.kind, kind);
    assert_int_equal(map.flips, 0);
    return map;
}

/* How much the given factors vary beside those of the map: the standard deviation of the logarithm
 * of their ratio over the vertices where one is given. */
static double spread(const RefSurfaceMap *map, const double *factor)
{
    double sum = 0, squares = 0, count = 0;
    for (long v = 0; v < map->vertices; v++) {
        if (factor[v] == 0) continue;
        double off = log(map->factor[v] / factor[v]);
        sum += off;
        squares += off * off;
        count++;
    }
    return sqrt(squares / count - pow(sum / count, 2));
}

/* The chart is where the vertices say, and L what they carry; parts have the area of the whole. */
static void check_chart(const SmMesh *mesh, const RefSurfaceMap *map)
{
    for (long v = 0; v < map->vertices; v++) {
        double x[3], L = map->chart.factor(map->chart.data, map->theta[v]);
        map->chart.place(map->chart.data, map->theta[v], x);
        assert_true(sqrt(sm_square_between(x, mesh->position[v])) < 1e-6);
        assert_true(fabs(L / map->factor[v] - 1) < 1e-3);
    }
    double side[2] = {map->chart.high[0] / 3, map->chart.high[1] / 4}, area = 0;
    for (int n = 0; n < 12; n++) {
        double low[2] = {n % 3 * side[0], n / 3 * side[1]};
        double high[2] = {low[0] + side[0], low[1] + side[1]};
        area += pow(map->chart.mean(map->chart.data, low, high), 2) * side[0] * side[1];
    }
    assert_true(fabs(area / (12 * side[0] * side[1]) - 1) < 1e-3);
}

/* Places that a seam makes one are one on the surface. */
static void check_seams(const RefSurfaceMap *map)
{
    const RefChart *chart = &map->chart;
    double size = sqrt(chart->high[0] * chart->high[1]);
    for (int n = 0; n < 200; n++)
        for (int d = 0; d < 2; d++) {
            double theta[2], x[3], y[3], tiny = 1e-9 * (chart->high[d] - chart->low[d]);
            bool high = n % 2;
            theta[!d] = random_between(&seed, chart->low[!d], chart->high[!d]);
            theta[d] = high ? chart->high[d] : chart->low[d];
            chart->place(chart->data, theta, x);
            theta[d] += high ? tiny : -tiny;
            if (!ref_chart_enter(chart, theta)) continue;
            chart->place(chart->data, theta, y);
            double near = 1e-7 * size + 10 * tiny * chart->factor(chart->data, theta);
            assert_true(sqrt(sm_square_between(x, y)) < near);
        }
}

/* A length of 2 around an axis of radius 1 / 3. */
static void on_cylinder(double u, double v, double x[3])
{
    x[0] = cos(2 * M_PI * u) / 3;
    x[1] = sin(2 * M_PI * u) / 3;
    x[2] = 2 * v;
}

TEST(a_tube_is_its_own_cylinder)
{
    needs_solver();
    SmMesh mesh = grid_mesh(60, 50, true, false, on_cylinder, 0.3, &seed);
    random_move(&seed, &mesh);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_ANNULUS);
    assert_true(fabs(map.chart.high[0] / (2 * M_PI / 3) - 1) < 3e-3);
    assert_true(fabs(map.chart.high[1] / 2 - 1) < 3e-3);
    for (long v = 0; v < map.vertices; v++) assert_true(fabs(map.factor[v] - 1) < 2e-2);
    assert_true(map.angle_median < 0.5 && map.angle_95 < 1.5);
    check_chart(&mesh, &map);
    check_seams(&map);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

/* Mercator's map of a part of the unit sphere, which has four right angles. */
enum { MERCATOR_HIGH = 1 };
static void on_sphere(double u, double v, double x[3])
{
    double y = (2 * v - 1) * MERCATOR_HIGH;
    x[0] = cos(2 * u) / cosh(y);
    x[1] = sin(2 * u) / cosh(y);
    x[2] = tanh(y);
}

TEST(a_sheet_of_right_angles_is_mercators_rectangle)
{
    needs_solver();
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        int n = fine ? 80 : 40;
        SmMesh mesh = grid_mesh(n, n, false, false, on_sphere, 0.3, &seed);
        random_move(&seed, &mesh);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_DISK);
        double *L = sm_alloc((size_t)map.vertices, sizeof *L);
        double sides[2] = {2, 2 * MERCATOR_HIGH};
        assert_true(fabs(map.chart.high[1] / map.chart.high[0] - sides[1] / sides[0]) < 2e-3);
        /* its factor is 1 / cosh of the second parameter, or of the first where that goes up */
        for (long v = 0; v < map.vertices; v++)
            L[v] = 1 / cosh(sides[1] * (map.theta[v][1] / map.chart.high[1] - 0.5));
        double one = spread(&map, L);
        for (long v = 0; v < map.vertices; v++)
            L[v] = 1 / cosh(sides[1] * (map.theta[v][0] / map.chart.high[0] - 0.5));
        assert_true(fmin(one, spread(&map, L)) < 0.02);
        error[fine] = map.angle_95;
        check_chart(&mesh, &map);
        free(L);
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
    /* half the cells' edges, half the error of the angles */
    assert_true(error[0] < 2.5 && error[1] < 0.6 * error[0]);
}

static void on_strip(double u, double v, double x[3])
{
    x[0] = 20 * u;
    x[1] = v;
    x[2] = 0;
}

/* A flat one, exactly, though the corners of its ends are near each other. */
TEST(a_long_strip_is_its_rectangle)
{
    needs_solver();
    SmMesh mesh = grid_mesh(80, 4, false, false, on_strip, 0.2, &seed);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_DISK);
    double shape = map.chart.high[1] / map.chart.high[0];
    assert_true(fabs(fmin(shape, 1 / shape) * 20 - 1) < 1e-6);
    for (long v = 0; v < map.vertices; v++) assert_true(fabs(map.factor[v] - 1) < 1e-6);
    assert_true(map.angle_95 < 1e-4);
    check_chart(&mesh, &map);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

/* Three squares around, whose rims have three edges but are no holes. */
TEST(a_coarse_tube_stays_open)
{
    needs_solver();
    SmMesh mesh = grid_mesh(3, 1, true, false, on_cylinder, 0, &seed);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_ANNULUS);
    assert_true(map.angle_95 < 0.1);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

enum { RING = 3 }; /* the radius of a torus, in those of its tube */
static void on_torus(double u, double v, double x[3])
{
    double out = RING + cos(2 * M_PI * v);
    x[0] = out * cos(2 * M_PI * u);
    x[1] = out * sin(2 * M_PI * u);
    x[2] = sin(2 * M_PI * v);
}

TEST(a_torus_is_its_rectangle)
{
    needs_solver();
    double error[2], sides = sqrt(RING * RING - 1);
    for (int fine = 0; fine < 2; fine++) {
        int n = fine ? 40 : 20;
        SmMesh mesh = grid_mesh(3 * n, n, true, true, on_torus, 0.3, &seed);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_TORUS);
        double *L = sm_alloc((size_t)map.vertices, sizeof *L);
        assert_true(fabs(map.chart.high[1] / map.chart.high[0] / sides - 1) <
                    0.05 / (fine ? 4 : 1));
        for (long v = 0; v < map.vertices; v++)
            L[v] = hypot(mesh.position[v][0], mesh.position[v][1]);
        assert_true(spread(&map, L) < (fine ? 0.015 : 0.03));
        error[fine] = map.angle_95;
        check_chart(&mesh, &map);
        check_seams(&map);
        free(L);
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
    assert_true(error[0] < 6 && error[1] < 0.6 * error[0]);
}

/* A sheared ring: going up once goes a part around, so that upper and lower sides join shifted. */
static void on_twisted(double u, double v, double x[3])
{
    on_torus(u, v, x);
    x[0] += 0.4 * sin(2 * M_PI * (u + v));
    x[1] += 0.3 * cos(2 * M_PI * (2 * u - v));
}

TEST(a_torus_without_symmetry_has_a_skewed_chart)
{
    needs_solver();
    SmMesh mesh = grid_mesh(90, 45, true, true, on_twisted, 0.3, &seed);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_TORUS);
    assert_true(fabs(map.chart.seam[2].shift[0]) + fabs(map.chart.seam[3].shift[0]) > 0);
    check_chart(&mesh, &map);
    check_seams(&map);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

/* The places on the surface of the branch points of a chart's folds; returns how many. */
static int find_branches(const RefSurfaceMap *map, double branch[4][3])
{
    const RefChart *chart = &map->chart;
    int count = 0;
    for (int s = 0; s < chart->seams; s++)
        for (int half = 0; half < 2 && chart->seam[s].turned; half++) {
            const RefSeam *fold = chart->seam + s;
            double at[2] = {(fold->shift[0] + half * chart->high[0]) / 2, fold->shift[1] / 2}, x[3];
            bool known = at[0] < 0 || at[0] >= chart->high[0] * (1 - 1e-9);
            chart->place(chart->data, at, x);
            for (int b = 0; b < count; b++) known |= sm_square_between(branch[b], x) < 1e-6;
            if (!known) memcpy(branch[count++], x, sizeof x);
        }
    return count;
}

/* On a unit sphere L is the root of the product of the distances from the four branch points, times
 * a constant: dz / dw is the root of the product of all z - a. */
TEST(a_sphere_is_a_pillowcase)
{
    needs_solver();
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        SmMesh mesh = sphere_mesh(fine ? 40 : 20, 0.2, &seed);
        RefSurfaceMap map = map_of(&mesh, REF_MAP_SPHERE);
        double *L = sm_alloc((size_t)map.vertices, sizeof *L), branch[4][3];
        assert_int_equal(find_branches(&map, branch), 4);
        for (long v = 0; v < map.vertices; v++) {
            L[v] = 1;
            for (int b = 0; b < 4; b++)
                L[v] *= sqrt(sqrt(sm_square_between(branch[b], mesh.position[v])));
            if (L[v] < 0.3) L[v] = 0; /* the mean around a branch point is not 0 */
        }
        assert_true(spread(&map, L) < (fine ? 0.01 : 0.02));
        error[fine] = map.angle_95;
        check_chart(&mesh, &map);
        check_seams(&map);
        free(L);
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
    assert_true(error[0] < 8 && error[1] < 0.6 * error[0]);
}

/* Most of a sphere: what of the plane is within R of the origin, by stereographic projection, made
 * of the half by R-fold enlargement there. */
enum { R = 3 };
static SmMesh bulb_mesh(int n)
{
    SmMesh mesh = ball_mesh(n, true, 0.2, &seed);
    for (long v = 0; v < mesh.vertex_count; v++) {
        double *x = mesh.position[v], below = 1 + x[2], square;
        for (int d = 0; d < 2; d++) x[d] *= R / below;
        square = x[0] * x[0] + x[1] * x[1];
        for (int d = 0; d < 2; d++) x[d] *= 2 / (1 + square);
        x[2] = (1 - square) / (1 + square);
    }
    return mesh;
}

/* The mirror image of a sheet with a circle for its rim makes it a sphere, which has the branch
 * points a and R^2 / conj a in the plane. */
TEST(a_bulb_is_a_cap)
{
    needs_solver();
    SmMesh mesh = bulb_mesh(40);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_CAP);
    double *L = sm_alloc((size_t)map.vertices, sizeof *L), branch[4][3], at[4][2];
    assert_int_equal(find_branches(&map, branch), 2);
    for (int b = 0; b < 2; b++) {
        double square = 0;
        for (int d = 0; d < 2; d++) {
            at[b][d] = branch[b][d] / (1 + branch[b][2]);
            square += at[b][d] * at[b][d];
        }
        for (int d = 0; d < 2; d++) at[b + 2][d] = R * R * at[b][d] / square;
    }
    for (long v = 0; v < map.vertices; v++) {
        const double *x = mesh.position[v];
        L[v] = 1 + x[2]; /* 2 / (1 + |z|^2) */
        for (int b = 0; b < 4; b++)
            L[v] *= sqrt(hypot(x[0] / (1 + x[2]) - at[b][0], x[1] / (1 + x[2]) - at[b][1]));
        for (int b = 0; b < 2; b++)
            if (sm_square_between(branch[b], x) < 0.01) L[v] = 0;
    }
    assert_true(spread(&map, L) < 0.02);
    assert_true(map.angle_median < 1 && map.angle_95 < 5);
    check_chart(&mesh, &map);
    check_seams(&map);
    free(L);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

/* Two meshes as one. */
static SmMesh both(const SmMesh *a, const SmMesh *b)
{
    SmMesh mesh =
        sm_mesh_new(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
    for (long v = 0; v < mesh.vertex_count; v++)
        memcpy(mesh.position[v],
               v < a->vertex_count ? a->position[v] : b->position[v - a->vertex_count],
               sizeof *mesh.position);
    for (long t = 0; t < mesh.triangle_count; t++)
        for (int i = 0; i < 3; i++)
            mesh.triangle[t][i] = t < a->triangle_count ? a->triangle[t][i]
                                                        : b->triangle[t - a->triangle_count][i] +
                                                              (int)a->vertex_count;
    return mesh;
}

/* A missing triangle is closed, triangles that are turned round are turned back, a crumb beside is
 * dropped, and a fin on one edge is parted. */
TEST(small_faults_are_mended)
{
    needs_solver();
    SmMesh sphere = sphere_mesh(20, 0.2, &seed), crumb = sphere_mesh(1, 0, &seed);
    for (long v = 0; v < crumb.vertex_count; v++) crumb.position[v][0] += 9;
    SmMesh mesh = both(&sphere, &crumb);
    for (long t = 0; t < sphere.triangle_count; t += 3) {
        int other = mesh.triangle[t][0];
        mesh.triangle[t][0] = mesh.triangle[t][1];
        mesh.triangle[t][1] = other;
    }
    memcpy(mesh.triangle[7], mesh.triangle[1000],
           sizeof *mesh.triangle); /* one gone, one doubled */
    RefSurfaceMap map = map_of(&mesh, REF_MAP_SPHERE);
    assert_int_equal(map.closed, 1);
    assert_int_equal(map.dropped, crumb.triangle_count + 1);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
    sm_mesh_free(&crumb);
    crumb = sm_mesh_new(1, 1);
    for (int d = 0; d < 3; d++)
        crumb.position[0][d] = 1.2 * sphere.position[sphere.triangle[5][0]][d];
    mesh = both(&sphere, &crumb);
    memcpy(mesh.triangle[mesh.triangle_count - 1],
           (int[3]){sphere.triangle[5][0], sphere.triangle[5][1], (int)sphere.vertex_count},
           sizeof *mesh.triangle);
    map = map_of(&mesh, REF_MAP_SPHERE);
    assert_int_equal(map.dropped, 1);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
    sm_mesh_free(&crumb);
    sm_mesh_free(&sphere);
}

/* A torus with a slender handle across its hole, which is cut: of genus 2 without. */
TEST(a_slender_handle_is_cut)
{
    needs_solver();
    SmMesh ring = grid_mesh(60, 24, true, true, on_torus, 0, &seed);
    SmMesh rod = grid_mesh(6, 40, true, false, on_cylinder, 0, &seed), mesh = both(&ring, &rod);
    long end[2] = {-1, -1};
    for (long t = 0; t < ring.triangle_count; t++) { /* where the rod's ends are put */
        const double *x = ring.position[ring.triangle[t][0]];
        for (int k = 0; k < 2; k++)
            if (fabs(x[1]) < 0.3 && fabs(x[2]) < 0.3 && (k ? -1 : 1) * x[0] > 0 &&
                hypot(x[0], x[1]) < RING)
                end[k] = t;
    }
    long first = mesh.triangle_count;
    mesh.triangle = sm_realloc(mesh.triangle, (size_t)first + 40, sizeof *mesh.triangle);
    for (int k = 0; k < 2; k++) { /* sew its six vertices to the triangle's three */
        const int *corner = mesh.triangle[end[k]];
        int from = (int)ring.vertex_count + (k ? 40 * 6 : 0);
        for (int n = 0; n < 3; n++) {
            int v[3] = {corner[k ? n : 2 - n], corner[k ? (n + 1) % 3 : (4 - n) % 3], 0};
            const int next[3] = {from + 2 * n, from + 2 * n + 1, from + (2 * n + 2) % 6};
            const int triangle[3][3] = {
                {next[0], next[1], v[0]}, {next[1], next[2], v[0]}, {next[2], v[1], v[0]}};
            memcpy(mesh.triangle[mesh.triangle_count], triangle, sizeof triangle);
            mesh.triangle_count += 3;
        }
    }
    for (int k = 0; k < 2; k++)
        memcpy(mesh.triangle[end[k]], mesh.triangle[first + 1 - k], sizeof *mesh.triangle);
    for (long v = ring.vertex_count; v < mesh.vertex_count; v++) { /* along x */
        double *x = mesh.position[v], along = x[2] - 1;
        x[2] = 1.5 * x[0];
        x[1] *= 1.5;
        x[0] = -1.9 * along;
    }
    RefSurfaceMap map = map_of(&mesh, REF_MAP_TORUS);
    assert_int_equal(map.handles, 1);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
    sm_mesh_free(&ring);
    sm_mesh_free(&rod);
}

static void refused(const SmMesh *mesh, const char *why)
{
    RefSurfaceMap map;
    SmError error = {0};
    assert_int_equal(ref_surface_map_create(mesh, false, "mesh", &map, &error), SM_INPUT);
    if (!strstr(error.text, why)) fail_msg("%s", error.text);
}

/* Arrays have room for no more triangles after a cut than there are. */
TEST(a_handle_is_cut_after_a_hole_was_closed)
{
    enum { SIDE = 24 };
    SmMesh mesh = grid_mesh(SIDE, SIDE, true, true, on_torus, 0, &seed);
    RefTriangulation surface;
    SmError error;
    int loop[SIDE], found = 0;
    mesh.triangle_count -= 2; /* the last quadrangle */
    assert_int_equal(ref_triangulation_create(&mesh, "torus", 0, &surface, &error), SM_OK);
    assert_true(surface.genus == 1 && surface.rims == 1);
    assert_int_equal(ref_triangulation_close(&surface, 10, 100, 10), 1);
    for (int c = 0; c < 3 * surface.triangles && found < SIDE; c++) { /* the first row's edges */
        int from = surface.source[surface.vertex[c]];
        int to = surface.source[surface.vertex[ref_corner_next(c)]];
        if (from == found && to == (found + 1) % SIDE) {
            loop[found++] = c;
            c = -1;
        }
    }
    assert_int_equal(found, SIDE);
    ref_triangulation_cut(&surface, SIDE, loop);
    assert_true(surface.genus == 0 && surface.rims == 0);
    assert_int_equal(surface.vertices - surface.triangles / 2, 2);
    ref_triangulation_free(&surface);
    sm_mesh_free(&mesh);
}

/* With so many edges across it, and maybe a fin on one of these. */
static SmMesh moebius_strip(int around, int fins)
{
    SmMesh mesh = sm_mesh_new(2 * around + fins, 2 * around + fins);
    for (int n = 0; n < 2 * around; n++) {
        double angle = 2 * M_PI * (n / 2) / around, side = (n % 2 ? 1 : -1) * 0.4;
        mesh.position[n][0] = cos(angle) * (2 + side * cos(angle / 2));
        mesh.position[n][1] = sin(angle) * (2 + side * cos(angle / 2));
        mesh.position[n][2] = side * sin(angle / 2);
        for (int k = 0; k < 3; k++) {
            int to = n + k;
            mesh.triangle[n][n % 2 ? 2 - k : k] = to < 2 * around ? to : (to - 2 * around) ^ 1;
        }
    }
    for (int n = 2 * around; n < 2 * around + fins; n++) {
        mesh.position[n][2] = 1;
        memcpy(mesh.triangle[n], (int[3]){2, 3, n}, sizeof *mesh.triangle);
    }
    return mesh;
}

/* Three triangles with two edges between vertices 1 and 2, one of them on the rim: where a form is
 * harmonic, what flows into each vertex flows out of it. */
TEST(forms_are_harmonic_where_two_edges_join_two_vertices)
{
    needs_solver();
    int vertex[9] = {1, 3, 2, 1, 2, 0, 2, 3, 1}, twin[9] = {7, 6, 3, 2, -1, -1, 1, 0, -1};
    double weight[9] = {1, 2, 3, 3, 4, 5, 2, 1, 6}, form[9] = {1, 3, -2, 2, 1, -4, -3, -1, 5};
    double *forms[1] = {form}, left[4] = {0};
    RefTriangulation surface = {.triangles = 3, .vertices = 4, .vertex = vertex, .twin = twin};
    assert_true(ref_harmonic_product(&surface, weight, form, form) == 265);
    assert_int_equal(ref_harmonic_solve(&surface, weight, NULL, 1, forms, NULL), SM_OK);
    for (int c = 0; c < 9; c++) {
        left[vertex[c]] += weight[c] * form[c];
        if (twin[c] < 0) left[vertex[ref_corner_next(c)]] -= weight[c] * form[c];
    }
    for (int v = 0; v < 4; v++) assert_true(fabs(left[v]) < 1e-12);
}

/* A rim of three edges has no four corners: its triangle is cut into four, and stays open. */
TEST(a_triangle_is_a_disk)
{
    needs_solver();
    SmMesh mesh = sm_mesh_new(3, 1);
    memcpy(mesh.position, (double[3][3]){{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, sizeof(double[3][3]));
    memcpy(mesh.triangle, (int[3]){0, 1, 2}, sizeof *mesh.triangle);
    RefSurfaceMap map = map_of(&mesh, REF_MAP_DISK);
    assert_int_equal(map.closed, 0);
    assert_true(fabs(ref_triangulation_area(ref_surface_map_triangles(&map)) - 0.5) < 1e-12);
    ref_surface_map_free(&map);
    sm_mesh_free(&mesh);
}

TEST(surfaces_without_a_map_are_refused)
{
    needs_solver();
    SmMesh sphere = sphere_mesh(8, 0, &seed),
           ring = grid_mesh(30, 12, true, true, on_torus, 0, &seed);
    SmMesh mesh = both(&sphere, &ring);
    refused(&mesh, "2 surfaces that do not hang together");
    sm_mesh_free(&mesh);
    mesh = moebius_strip(20, 0);
    refused(&mesh, "one side only");
    sm_mesh_free(&mesh);
    mesh = grid_mesh(8, 8, false, false, on_sphere, 0, &seed);
    for (long v = 0; v < mesh.vertex_count; v++)
        for (int d = 1; d < 3; d++) mesh.position[v][d] = mesh.position[v][0];
    refused(&mesh, "they are but lines");
    sm_mesh_free(&mesh);
    sm_mesh_free(&sphere);
    sm_mesh_free(&ring);
}

/* Three sheets at an edge, and two at a vertex: where that is. One that is no manifold may have one
 * slip in a thousand triangles. */
TEST(what_is_no_manifold_says_where)
{
    needs_solver();
    SmMesh mesh = sm_mesh_new(5, 3);
    static const double corner[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 0.5}};
    static const int at_edge[3][3] = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    static const int at_vertex[2][3] = {{0, 1, 2}, {0, 3, 4}};
    memcpy(mesh.position, corner, sizeof corner);
    memcpy(mesh.triangle, at_edge, sizeof at_edge);
    refused(&mesh, "2 of 3 triangles: give the shell one; it is non-manifold, too: more than two "
                   "triangles meet in 1 edge from (0, 0, 0) to (1, 0, 0), where it is parted");
    memcpy(mesh.triangle, at_vertex, sizeof at_vertex);
    mesh.triangle_count = 2;
    refused(&mesh, "(two touch in a vertex, at (0, 0, 0))");
    sm_mesh_free(&mesh);
    mesh = moebius_strip(80, 1);
    refused(&mesh, "a shell needs two; it is non-manifold, too");
    sm_mesh_free(&mesh);
    mesh = moebius_strip(600, 0);
    refused(&mesh, "one side only");
    sm_mesh_free(&mesh);
    mesh = moebius_strip(600, 1);
    RefTriangulation surface;
    assert_int_equal(ref_triangulation_create(&mesh, "strip", 0.01, &surface, NULL), SM_OK);
    assert_true(surface.triangles == 1200 && surface.rims == 1 && surface.genus == 0);
    ref_triangulation_free(&surface);
    sm_mesh_free(&mesh);
}

/* Real ones, of every kind and with faults. */
TEST(real_meshes_have_maps)
{
    static const struct {
        const char *file;
        RefMapKind kind;
        double median, most; /* degrees */
    } wanted[] = {{"bunny_duplicates.ply", REF_MAP_SPHERE, 2, 12},
                  {"hand_closed.obj", REF_MAP_SPHERE, 2, 8},
                  {"hand_lowres_open.obj", REF_MAP_CAP, 8, 30},
                  {"demosthenes_lowres.obj", REF_MAP_CAP, 1.5, 8},
                  {"cloth_50x50.obj", REF_MAP_DISK, 0.01, 0.05},
                  {"torus.obj", REF_MAP_TORUS, 1, 3},
                  {"bad_hourglass_one_hole.stl", REF_MAP_SPHERE, 4, 15},
                  {"bad_self_intersecting_tube.obj", REF_MAP_SPHERE, 0.5, 6},
                  {"liver_ct_downsample.stl", REF_MAP_MULTITORUS, 7, 30}};
    const char *folder = getenv("SHAPEBENCH_MESHES");
    needs_solver();
    needs(folder, "SHAPEBENCH_MESHES names no folder of meshes");
    for (size_t n = 0; n < sizeof wanted / sizeof *wanted; n++) {
        char path[512];
        SmMesh mesh;
        SmError error = {0};
        snprintf(path, sizeof path, "%s/%s", folder, wanted[n].file);
        if (sm_import(path, NULL, &mesh, NULL, &error) != SM_OK ||
            sm_mesh_prepare(&mesh, path, &error) != SM_OK)
            fail_msg("%s", error.text);
        RefSurfaceMap map = map_of(&mesh, wanted[n].kind);
        if (map.angle_median > wanted[n].median || map.angle_95 > wanted[n].most)
            fail_msg("%s: %g and %g degrees", path, map.angle_median, map.angle_95);
        if (!map.chart.cylinders) check_seams(&map);
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
}
