/* Maps of surfaces whose conformal parameters are known. */
#include "surface_map.h"

#include "../test_solver.h"
#include "test_surfaces.h"

static unsigned seed = 1;

static RefSurfaceMap map_of(const SmMesh *mesh, RefMapKind kind)
{
    RefSurfaceMap map;
    SmError error = {0};
    if (ref_surface_map_create(mesh, "mesh", &map, &error) != SM_OK) fail_msg("%s", error.text);
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

/* The chart is where the vertices say, and L what they carry. */
static void check_chart(const SmMesh *mesh, const RefSurfaceMap *map)
{
    for (long v = 0; v < map->vertices; v++) {
        double x[3], L = map->chart.factor(map->chart.data, map->theta[v]);
        map->chart.place(map->chart.data, map->theta[v], x);
        assert_true(sqrt(sm_square_between(x, mesh->position[v])) < 1e-6);
        assert_true(fabs(L / map->factor[v] - 1) < 1e-3);
    }
}

/* Places that a seam makes one are one on the surface. */
static void check_seams(const RefSurfaceMap *map)
{
    const RefChart *chart = &map->chart;
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
            assert_true(sqrt(sm_square_between(x, y)) < 1e-6);
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
        int branches = 0;
        for (int s = 2; s < map.chart.seams; s++) { /* half turns' middles */
            const RefSeam *fold = map.chart.seam + s;
            for (int half = 0; half < 2; half++) {
                double at[2] = {(fold->shift[0] + half * map.chart.high[0]) / 2,
                                fold->shift[1] / 2};
                if (at[0] < 0 || at[0] >= map.chart.high[0] * (1 - 1e-9)) continue;
                double x[3];
                map.chart.place(map.chart.data, at, x);
                bool known = false;
                for (int b = 0; b < branches; b++) known |= sm_square_between(branch[b], x) < 1e-6;
                if (!known) memcpy(branch[branches++], x, sizeof x);
            }
        }
        assert_int_equal(branches, 4);
        for (long v = 0; v < map.vertices; v++) {
            L[v] = 1;
            for (int b = 0; b < 4; b++)
                L[v] *= sqrt(sqrt(sm_square_between(branch[b], mesh.position[v])));
            if (L[v] < 0.3) L[v] = 0; /* the mean around a branch point is not 0 */
        }
        assert_true(spread(&map, L) < (fine ? 0.01 : 0.02));
        error[fine] = map.angle_95;
        check_seams(&map);
        free(L);
        ref_surface_map_free(&map);
        sm_mesh_free(&mesh);
    }
    assert_true(error[0] < 8 && error[1] < 0.6 * error[0]);
}
