/* Maps of points: uneven, unoriented, noisy, doubled, and such that have none. */
#include "../surface/local_triangles.h"
#include "../test_solver.h"
#include "surface_map.h"
#include "test_surfaces.h"

static unsigned seed = 1;

/* Points with normals that are known. */
typedef struct {
    long count;
    double (*x)[3], (*normal)[3];
} Points;

static Points points_new(long count)
{
    return (Points){count, sm_alloc((size_t)count, sizeof(double[3])),
                    sm_alloc((size_t)count, sizeof(double[3]))};
}

static void points_free(Points *points)
{
    free(points->x);
    free(points->normal);
}

/* Random on the unit sphere, evenly but for chance. */
static Points random_sphere(long count)
{
    Points points = points_new(count);
    for (long p = 0; p < count; p++) {
        double square;
        do {
            square = 0;
            for (int d = 0; d < 3; d++) {
                points.x[p][d] = random_between(&seed, -1, 1);
                square += points.x[p][d] * points.x[p][d];
            }
        } while (square > 1 || square < 0.1);
        sm_normalize(points.x[p]);
        memcpy(points.normal[p], points.x[p], sizeof *points.x);
    }
    return points;
}

/* A part of a cylinder of radius 1 over two units of its arc, or all around, as a grid whose places
 * are moved by up to `noise` of its step. */
static Points round_sheet(int n, bool around, double noise)
{
    double arc = around ? 2 * M_PI : 2;
    int columns = around ? 3 * n : n;
    Points points = points_new((long)n * columns);
    for (long p = 0; p < points.count; p++) {
        double place[2] = {(double)(p % columns), (double)(p / columns)};
        int most[2] = {columns - 1, n - 1};
        for (int d = 0; d < 2; d++)
            if ((around && d == 0) || (place[d] > 0 && place[d] < most[d]))
                place[d] += random_between(&seed, -noise, noise);
        double angle = arc * place[0] / (around ? columns : columns - 1);
        points.normal[p][0] = points.x[p][0] = cos(angle);
        points.normal[p][1] = points.x[p][1] = sin(angle);
        points.x[p][2] = 2 * place[1] / (n - 1);
    }
    return points;
}

static SmMesh mesh_of(const Points *points, bool oriented)
{
    SmError error = {0};
    SmMesh mesh = {0};
    SmCode code = ref_local_triangles(points->count, (const double(*)[3])points->x,
                                      oriented ? (const double(*)[3])points->normal : NULL,
                                      "points", &mesh, &error);
    if (code != SM_OK) fail_msg("%s", error.text);
    return mesh;
}

static RefSurfaceMap map_of(const Points *points, bool oriented, RefMapKind kind)
{
    RefSurfaceMap map;
    SmError error = {0};
    SmMesh mesh = mesh_of(points, oriented);
    if (ref_surface_map_create(&mesh, true, "points", &map, &error) != SM_OK)
        fail_msg("%s", error.text);
    sm_mesh_free(&mesh);
    assert_int_equal(map.kind, kind);
    assert_int_equal(map.flips, 0);
    assert_int_equal(map.vertices, points->count);
    return map;
}

/* How many points the chart does not have where it says, to within `near`. */
static long away(const Points *points, const RefSurfaceMap *map, double near)
{
    long count = 0;
    for (long p = 0; p < points->count; p++) {
        double x[3];
        map->chart.place(map->chart.data, map->theta[p], x);
        count += sqrt(sm_square_between(x, points->x[p])) > near;
    }
    return count;
}

/* Also points that are there twice, the later of which has no triangle, and some that fit in none:
 * these are close to one. */
TEST(random_points_on_a_sphere_are_all_mapped)
{
    needs_solver();
    for (int trial = 0; trial < 4; trial++) {
        Points points = random_sphere(2000 + 500 * trial);
        for (long p = 0; p < 100; p++) memcpy(points.x[p + 100], points.x[p], sizeof *points.x);
        RefSurfaceMap map = map_of(&points, trial % 2, REF_MAP_SPHERE);
        assert_true(away(&points, &map, 1e-6) <= points.count / 200);
        assert_int_equal(away(&points, &map, 0.05), 0);
        assert_true(map.angle_median < 3);
        ref_surface_map_free(&map);
        points_free(&points);
    }
}

/* Points off the surface by up to 0.4 of their distances, and others anywhere. */
TEST(noise_and_outliers_leave_a_sphere)
{
    needs_solver();
    SmMesh ball = sphere_mesh(30, 0.3, &seed);
    Points points = points_new(ball.vertex_count + 60);
    for (long p = 0; p < points.count; p++)
        for (int d = 0; d < 3; d++)
            points.x[p][d] = p < ball.vertex_count
                                 ? ball.position[p][d] + random_between(&seed, -0.4, 0.4) / 30
                                 : random_between(&seed, -1.5, 1.5);
    RefSurfaceMap map = map_of(&points, false, REF_MAP_SPHERE);
    assert_true(map.angle_median < 2 && map.angle_95 < 8);
    assert_true(away(&points, &map, 0.05) <= 60);
    ref_surface_map_free(&map);
    points_free(&points);
    sm_mesh_free(&ball);
}

/* Sheets and tubes of points keep their rims, on exact grids, too, where four points lie on a
 * circle; L is 1, and the sides are known. */
TEST(sheets_and_tubes_of_points_keep_their_rims)
{
    needs_solver();
    for (int trial = 0; trial < 8; trial++) {
        bool around = trial & 1;
        double noise = trial & 2 ? 0.25 : 0, sides[2] = {around ? 2 * M_PI : 2, 2};
        Points points = round_sheet(31, around, noise);
        RefSurfaceMap map = map_of(&points, trial & 4, around ? REF_MAP_ANNULUS : REF_MAP_DISK);
        double shape = map.chart.high[1] / map.chart.high[0];
        assert_true(fabs(shape / (sides[1] / sides[0]) - 1) < 0.02);
        for (long p = 0; p < map.vertices; p++) assert_true(fabs(map.factor[p] - 1) < 0.1);
        assert_true(map.angle_median < 1.5 && map.angle_95 < 5);
        assert_int_equal(away(&points, &map, 1e-6), 0);
        ref_surface_map_free(&map);
        points_free(&points);
    }
}

/* Normals that look to either side, of one point in five or at random, are as none; of fewer they
 * are kept. */
TEST(normals_at_odds_are_not_taken)
{
    needs_solver();
    for (int trial = 0; trial < 6; trial++) {
        static const double share[] = {0.5, 0.2, 0.02};
        bool ball = trial % 2;
        Points points = ball ? random_sphere(1500) : round_sheet(30, false, 0.3);
        for (long p = 0; p < points.count; p++)
            for (int d = 0, turn = random_between(&seed, 0, 1) < share[trial / 2]; d < 3; d++)
                points.normal[p][d] *= turn ? -1 : 1;
        RefSurfaceMap map = map_of(&points, true, ball ? REF_MAP_SPHERE : REF_MAP_DISK);
        assert_true(away(&points, &map, 0.05) <= points.count / 20);
        ref_surface_map_free(&map);
        SmMesh bare = mesh_of(&points, false), mesh = mesh_of(&points, true);
        bool same = mesh.triangle_count == bare.triangle_count &&
                    memcmp(mesh.triangle, bare.triangle,
                           (size_t)mesh.triangle_count * sizeof *mesh.triangle) == 0;
        assert_int_equal(same, trial < 4);
        sm_mesh_free(&bare);
        sm_mesh_free(&mesh);
        points_free(&points);
    }
}

/* Of a flat ellipsoid, without normals. */
TEST(flat_bodies_keep_their_sides_apart)
{
    needs_solver();
    SmMesh ball = sphere_mesh(24, 0.2, &seed);
    Points points = points_new(ball.vertex_count);
    for (long p = 0; p < points.count; p++)
        for (int d = 0; d < 3; d++) points.x[p][d] = ball.position[p][d] * (d == 2 ? 0.3 : 1);
    RefSurfaceMap map = map_of(&points, false, REF_MAP_SPHERE);
    assert_true(away(&points, &map, 1e-6) <= points.count / 100);
    ref_surface_map_free(&map);
    points_free(&points);
    sm_mesh_free(&ball);
}

/* Feet of points off the surface are below them. */
TEST(feet_are_the_nearest_places)
{
    needs_solver();
    Points points = round_sheet(41, true, 0.25);
    RefSurfaceMap map = map_of(&points, true, REF_MAP_ANNULUS);
    for (int n = 0; n < 200; n++) {
        double angle = random_between(&seed, 0, 2 * M_PI), out = random_between(&seed, 0.97, 1.03);
        double x[1][3] = {{out * cos(angle), out * sin(angle), random_between(&seed, 0.1, 1.9)}};
        double theta[1][2], foot[3];
        ref_surface_map_feet(&map, 1, (const double(*)[3])x, theta);
        map.chart.place(map.chart.data, theta[0], foot);
        assert_true(fabs(foot[0] - cos(angle)) + fabs(foot[1] - sin(angle)) < 0.01);
        assert_true(fabs(foot[2] - x[0][2]) < 0.002);
    }
    ref_surface_map_free(&map);
    points_free(&points);
}

/* By the triangles between points, or by the map of these; says why. */
static SmError refusal(long count, const double (*x)[3], const double (*normal)[3])
{
    RefSurfaceMap map;
    SmMesh mesh;
    SmError error = {0};
    SmCode code = ref_local_triangles(count, x, normal, "points", &mesh, &error);
    if (code == SM_OK) {
        code = ref_surface_map_create(&mesh, true, "points", &map, &error);
        sm_mesh_free(&mesh);
    }
    assert_int_equal(code, SM_INPUT);
    return error;
}

static void refused(long count, const double (*x)[3], const char *why)
{
    SmError error = refusal(count, x, NULL);
    if (!strstr(error.text, why)) fail_msg("%s", error.text);
}

TEST(points_without_a_surface_are_refused)
{
    needs_solver();
    Points points = round_sheet(20, false, 0.2);
    refused(10, (const double(*)[3])points.x, "too few");
    points.x[7][1] = NAN;
    refused(points.count, (const double(*)[3])points.x, "point 8 has a coordinate");
    for (long p = 0; p < points.count; p++) /* all at one place */
        memset(points.x[p], 0, sizeof *points.x);
    refused(points.count, (const double(*)[3])points.x, "lie in no surface");
    for (long p = 0; p < points.count; p++) { /* in a line */
        points.x[p][0] = (double)p;
    }
    refused(points.count, (const double(*)[3])points.x, "lie in no surface");
    for (long p = 0; p < points.count; p++) /* anywhere in a cube */
        for (int d = 0; d < 3; d++) points.x[p][d] = random_between(&seed, 0, 1);
    refusal(points.count, (const double(*)[3])points.x, NULL);
    points_free(&points);
    points = round_sheet(20, true, 0.2); /* two layers, near to each other, that look apart */
    for (long p = 0; p < points.count; p += 2)
        for (int d = 0; d < 2; d++) {
            points.x[p][d] *= 0.99;
            points.normal[p][d] *= -1;
        }
    SmError error =
        refusal(points.count, (const double(*)[3])points.x, (const double(*)[3])points.normal);
    assert_non_null(strstr(error.text, "2 surfaces"));
    points_free(&points);
    points = random_sphere(1000); /* two of them */
    for (long p = 0; p < 500; p++) points.x[p][0] += 5;
    refused(points.count, (const double(*)[3])points.x, "do not hang together");
    points_free(&points);
}
