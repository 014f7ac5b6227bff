/* From meshes to lattices: known volumes, bad meshes, wanted counts, limits. */
#include "voxelise.h"

#include <dirent.h>
#include <float.h>
#include <limits.h>

#include "../mesh/import.h"
#include "../system/child.h"
#include "../test_frame.h"
#include "../test_random.h"

static unsigned seed = 1;

/* Sanitizers quarantine freed memory. */
#define PEAK_MEGABYTES (SM_CHILD_LIMITS_MEMORY ? 200 : 1000)

/* The vertex at ring i of `rings`, step j of `steps`; rings 0 and `rings` are the poles. */
static int ring_vertex(int i, int j, int rings, int steps)
{
    if (i == 0) return 0;
    if (i == rings) return 1;
    return 2 + (i - 1) * steps + j % steps;
}

/* A closed ball, positions rounded to 2^-20 so that an offset of 5e6 loses nothing. `lumps` makes
 * it a potato. Triangles begin at the upper pole. */
static SmMesh ball(double radius, int rings, int steps, double lumps)
{
    SmMesh m = sm_mesh_new(2 + (long)(rings - 1) * steps, 2L * (rings - 1) * steps);
    for (int i = 0; i <= rings; i++)
        for (int j = 0; j < steps; j++) {
            double a = M_PI * i / rings, b = 2 * M_PI * j / steps;
            double r = radius * (1 + lumps * sin(3 * a) * cos(2 * b + a));
            double at[3] = {r * sin(a) * cos(b), r * sin(a) * sin(b), r * cos(a)};
            double *p = m.position[ring_vertex(i, j, rings, steps)];
            for (int d = 0; d < 3; d++) p[d] = round(at[d] * 1048576) / 1048576;
        }
    long t = 0;
    for (int i = 0; i < rings; i++)
        for (int j = 0; j < steps; j++) {
            int a = ring_vertex(i, j, rings, steps), b = ring_vertex(i, j + 1, rings, steps);
            int c = ring_vertex(i + 1, j, rings, steps),
                d = ring_vertex(i + 1, j + 1, rings, steps);
            if (i + 1 < rings || i == 0) memcpy(m.triangle[t++], (int[3]){a, c, d}, 12);
            if (i > 0 && i + 1 < rings) memcpy(m.triangle[t++], (int[3]){a, d, b}, 12);
            if (i + 1 == rings) memcpy(m.triangle[t++], (int[3]){a, c, b}, 12);
        }
    assert_int_equal(t, m.triangle_count);
    return m;
}

static SmMesh torus(double big, double small, int rings, int steps)
{
    SmMesh m = sm_mesh_new((long)rings * steps, 2L * rings * steps);
    for (int i = 0; i < rings; i++)
        for (int j = 0; j < steps; j++) {
            double a = 2 * M_PI * i / rings, b = 2 * M_PI * j / steps, r = big + small * cos(b);
            double *p = m.position[i * steps + j];
            p[0] = r * cos(a), p[1] = r * sin(a), p[2] = small * sin(b);
            int right = (i + 1) % rings * steps, up = (j + 1) % steps;
            int corner[2][3] = {{i * steps + j, right + j, right + up},
                                {i * steps + j, right + up, i * steps + up}};
            memcpy(m.triangle[2 * (i * steps + j)], corner, sizeof corner);
        }
    return m;
}

static SmMesh box(double x0, double y0, double z0, double x1, double y1, double z1)
{
    static const int side[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                    {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                    {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    SmMesh m = sm_mesh_new(8, 12);
    for (int i = 0; i < 8; i++) {
        m.position[i][0] = i & 1 ? x1 : x0;
        m.position[i][1] = i & 2 ? y1 : y0;
        m.position[i][2] = i & 4 ? z1 : z0;
    }
    memcpy(m.triangle, side, sizeof side);
    return m;
}

/* Adds the triangles of `b`, turned over or not, to `a`. */
static void join(SmMesh *a, const SmMesh *b, bool turn)
{
    SmMesh m =
        sm_mesh_new(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
    memcpy(m.position, a->position, (size_t)a->vertex_count * sizeof *m.position);
    memcpy(m.position + a->vertex_count, b->position, (size_t)b->vertex_count * sizeof *m.position);
    memcpy(m.triangle, a->triangle, (size_t)a->triangle_count * sizeof *m.triangle);
    for (long t = 0; t < b->triangle_count; t++)
        for (int c = 0; c < 3; c++)
            m.triangle[a->triangle_count + t][turn ? 2 - c : c] =
                b->triangle[t][c] + (int)a->vertex_count;
    sm_mesh_free(a);
    *a = m;
}

static SmVoxels made(const SmMesh *mesh, SmFill fill, double cell, SmVoxelReport *report)
{
    SmVoxelParams params = {.fill = fill, .cell = cell};
    SmVoxels v;
    SmError error = {0};
    if (sm_voxelise_report(mesh, &params, "test", &v, report, &error)) fail_msg("%s", error.text);
    return v;
}

static void assert_same(const SmVoxels *a, const SmVoxels *b)
{
    assert_memory_equal(a->size, b->size, sizeof a->size);
    size_t words = (size_t)a->words * (size_t)a->size[1] * (size_t)a->size[2];
    assert_memory_equal(a->bits, b->bits, words * sizeof *a->bits);
    assert_int_equal(a->particle_count, b->particle_count);
}

/* How far cell (i, j, k)'s centre is from the world's origin. */
static double centre_distance(const SmVoxels *v, int i, int j, int k)
{
    double at[3] = {i + 0.5, j + 0.5, k + 0.5}, sum = 0;
    for (int d = 0; d < 3; d++) sum += pow(v->origin[d] + v->cell * at[d], 2);
    return sqrt(sum);
}

TEST(a_ball_is_filled_and_no_more)
{
    SmMesh m = ball(1, 60, 90, 0);
    SmVoxelReport report;
    SmVoxels v = made(&m, SM_SOLID, 0.05, &report);
    assert_int_equal(report.inside, SM_INSIDE_CLOSED);
    assert_int_equal(report.voxelisations, 1);
    assert_int_equal(report.shell_cells + report.flood_cells, v.cell_count);
    for (int k = 0; k < v.size[2]; k++)
        for (int j = 0; j < v.size[1]; j++)
            for (int i = 0; i < v.size[0]; i++) {
                double r = centre_distance(&v, i, j, k);
                if (r < 0.99) assert_true(sm_voxel_get(&v, i, j, k));
                if (r > 1 + 0.05 * sqrt(3) / 2) assert_false(sm_voxel_get(&v, i, j, k));
            }
    sm_voxels_free(&v);
    sm_mesh_free(&m);
}

TEST(bad_balls_are_the_same_solid)
{
    SmMesh m = ball(1, 120, 180, 0);
    SmVoxels good = made(&m, SM_SOLID, 0.09, NULL), v;
    SmVoxelReport report;

    SmMesh turned = ball(1, 120, 180, 0), doubled = ball(1, 120, 180, 0);
    for (long t = 0; t < turned.triangle_count; t++) {
        int swap = turned.triangle[t][0];
        turned.triangle[t][0] = turned.triangle[t][1];
        turned.triangle[t][1] = swap;
    }
    v = made(&turned, SM_SOLID, 0.09, NULL);
    assert_same(&good, &v);
    sm_voxels_free(&v);

    join(&doubled, &m, true);
    v = made(&doubled, SM_SOLID, 0.09, NULL);
    assert_same(&good, &v);
    sm_voxels_free(&v);

    SmMesh inner = ball(0.5, 60, 90, 0);
    join(&turned, &inner, false);
    v = made(&turned, SM_SOLID, 0.09, NULL);
    assert_same(&good, &v); /* a cavity is filled */
    sm_voxels_free(&v);

    m.triangle_count--;
    v = made(&m, SM_SOLID, 0.09, &report);
    assert_int_equal(report.inside, SM_INSIDE_TIGHT);
    assert_same(&good, &v);
    sm_voxels_free(&v);
    m.triangle_count++;

    for (long i = 0; i < m.vertex_count; i++)
        for (int d = 0; d < 3; d++) m.position[i][d] += 5e6;
    v = made(&m, SM_SOLID, 0.09, NULL);
    assert_same(&good, &v);
    sm_voxels_free(&v);

    sm_voxels_free(&good);
    sm_mesh_free(&inner);
    sm_mesh_free(&turned);
    sm_mesh_free(&doubled);
    sm_mesh_free(&m);
}

TEST(wide_holes_are_bridged)
{
    /* Without its first rings of triangles the ball is open above z = cos(pi / 6). */
    int rings = 60, steps = 90, gone = 10;
    SmMesh open = ball(1, rings, steps, 0);
    long first = (2L * gone - 1) * steps;
    open.triangle_count -= first;
    memmove(open.triangle, open.triangle + first,
            (size_t)open.triangle_count * sizeof *open.triangle);
    SmVoxelReport report;
    SmVoxels v = made(&open, SM_SOLID, 0.05, &report);
    assert_int_equal(report.inside, SM_INSIDE_VOTED);
    double top = cos(M_PI * gone / rings);
    for (int k = 0; k < v.size[2]; k++)
        for (int j = 0; j < v.size[1]; j++)
            for (int i = 0; i < v.size[0]; i++) {
                double r = centre_distance(&v, i, j, k), z = v.origin[2] + v.cell * (k + 0.5);
                if (r < 0.99 && z < top - 0.05) assert_true(sm_voxel_get(&v, i, j, k));
                if (r > 1 + 0.05 * sqrt(3) / 2) assert_false(sm_voxel_get(&v, i, j, k));
            }
    sm_voxels_free(&v);
    sm_mesh_free(&open);
}

TEST(faces_on_cell_boundaries_are_not_doubled)
{
    SmMesh m = box(0, 0, 0, 10, 10, 10);
    SmVoxels v = made(&m, SM_SHELL, 1, NULL);
    assert_int_equal(v.cell_count, 1000 - 512);
    sm_voxels_free(&v);
    v = made(&m, SM_SOLID, 1, NULL);
    assert_int_equal(v.cell_count, 1000);
    assert_int_equal(v.particle_count, 1331);
    sm_voxels_free(&v);
    v = made(&m, SM_SOLID, 0.1, NULL); /* 10 / 0.1 is not 100 in binary */
    assert_int_equal(v.cell_count, 1000000);
    sm_voxels_free(&v);

    for (int over = 0; over < 2; over++) {
        SmMesh large = box(0, 0, 0, 10 + (over ? 1e-6 : 1e-7), 10, 10);
        v = made(&large, SM_SOLID, 1, NULL);
        assert_int_equal(v.size[0], 10 + over);
        sm_voxels_free(&v);
        sm_mesh_free(&large);
    }

    SmMesh near = box(10, 0, 0, 20, 10, 10);
    join(&m, &near, false);
    v = made(&m, SM_SOLID, 1, NULL);
    assert_int_equal(v.cell_count, 2000);
    assert_int_equal(v.particle_count, 21 * 11 * 11);
    sm_voxels_free(&v);
    sm_mesh_free(&near);
    sm_mesh_free(&m);
}

TEST(a_flat_square_is_one_cell_thick)
{
    for (int axis = 0; axis < 3; axis++) {
        SmMesh m = sm_mesh_new(4, 2);
        for (int i = 0; i < 4; i++) {
            m.position[i][(axis + 1) % 3] = i & 1 ? 7 : -3;
            m.position[i][(axis + 2) % 3] = i & 2 ? 7 : -3;
            m.position[i][axis] = 5;
        }
        memcpy(m.triangle, (int[2][3]){{0, 1, 2}, {1, 3, 2}}, 2 * sizeof *m.triangle);
        SmVoxelReport report;
        SmVoxels v = made(&m, SM_SOLID, 1, &report);
        assert_int_equal(report.inside, SM_INSIDE_NONE);
        assert_int_equal(v.size[axis], 1);
        assert_int_equal(v.cell_count, 100);
        assert_int_equal(v.particle_count, 242);
        assert_non_null(strstr(sm_voxel_verdict(&report), "no inside"));
        sm_voxels_free(&v);
        sm_mesh_free(&m);
    }
}

TEST(a_torus_keeps_its_hole)
{
    SmMesh m = torus(2, 0.5, 120, 40);
    SmVoxels v = made(&m, SM_SOLID, 0.1, NULL);
    for (int k = 0; k < v.size[2]; k++)
        for (int j = 0; j < v.size[1]; j++)
            for (int i = 0; i < v.size[0]; i++) {
                double x = v.origin[0] + v.cell * (i + 0.5), y = v.origin[1] + v.cell * (j + 0.5);
                double z = v.origin[2] + v.cell * (k + 0.5), r = hypot(hypot(x, y) - 2, z);
                if (r < 0.49) assert_true(sm_voxel_get(&v, i, j, k));
                if (r > 0.5 + 0.1 * sqrt(3) / 2) assert_false(sm_voxel_get(&v, i, j, k));
            }
    sm_voxels_free(&v);
    sm_mesh_free(&m);
}

static SmMesh soup(int triangles)
{
    SmMesh m = sm_mesh_new(3L * triangles, triangles);
    for (int i = 0; i < 3 * triangles; i++) {
        for (int d = 0; d < 3; d++) m.position[i][d] = random_between(&seed, 0, 1);
        m.triangle[i / 3][i % 3] = i;
    }
    return m;
}

TEST(a_soup_has_no_inside)
{
    SmMesh m = soup(100);
    SmVoxelParams params = {.fill = SM_SOLID, .particles = 3000};
    SmVoxels v;
    SmError error;
    assert_int_equal(sm_voxelise(&m, &params, "soup.stl", &v, &error), SM_INPUT);
    assert_int_equal(strncmp(error.text, "soup.stl: ", 10), 0);
    assert_non_null(strstr(error.text, "shell"));
    assert_null(v.bits);
    params.fill = SM_SHELL;
    assert_int_equal(sm_voxelise(&m, &params, "soup.stl", &v, &error), SM_OK);
    sm_voxels_free(&v);
    sm_mesh_free(&m);
}

TEST(wanted_particle_counts_are_met)
{
    const struct {
        SmFill fill;
        long particles;
    } wanted[] = {{SM_SOLID, 150},   {SM_SHELL, 150},   {SM_SOLID, 2570},
                  {SM_SHELL, 19959}, {SM_SOLID, 57626}, {SM_SOLID, 500000}};
    SmMesh m = ball(3, 80, 120, 0.15);
    for (size_t w = 0; w < sizeof wanted / sizeof *wanted; w++) {
        SmVoxelParams params = {.fill = wanted[w].fill, .particles = wanted[w].particles};
        SmVoxels v, again, same;
        SmVoxelReport report;
        assert_int_equal(sm_voxelise_report(&m, &params, "test", &v, &report, NULL), SM_OK);
        double miss = fabs((double)v.particle_count / (double)wanted[w].particles - 1);
        assert_true(miss <= 0.01);
        assert_true(report.voxelisations <= 59);
        assert_int_equal(sm_voxelise(&m, &params, "test", &again, NULL), SM_OK);
        assert_same(&v, &again);
        if (report.voxelisations <= 12) { /* the centred lattice of that cell size */
            same = made(&m, wanted[w].fill, v.cell, NULL);
            assert_same(&v, &same);
            sm_voxels_free(&same);
        }
        sm_voxels_free(&v);
        sm_voxels_free(&again);
    }
    sm_mesh_free(&m);
}

static void expect_error(const SmMesh *m, SmFill fill, double cell, long particles)
{
    SmVoxelParams params = {.fill = fill, .cell = cell, .particles = particles};
    SmVoxels v;
    SmError error = {0};
    assert_int_equal(sm_voxelise(m, &params, "bad.obj", &v, &error), SM_INPUT);
    assert_int_equal(strncmp(error.text, "bad.obj", 7), 0);
    assert_null(v.bits);
}

TEST(absurd_input_is_an_error)
{
    SmMesh m = ball(1, 10, 10, 0), none = {0};
    const double cells[] = {0, -1, NAN, INFINITY, 1e-12, 1e-300, DBL_MIN, 1e300, 1e-4};
    for (size_t c = 0; c < sizeof cells / sizeof *cells; c++)
        expect_error(&m, SM_SHELL, cells[c], 0);
    expect_error(&m, SM_SOLID, 1, -5);
    if (sizeof(long) > sizeof(int)) expect_error(&m, SM_SOLID, 1, LONG_MAX);
    expect_error(&none, SM_SOLID, 1, 0);
    SmMesh large = box(0, 0, 0, 1291, 1291, 1291); /* more than 2^31 cells */
    expect_error(&large, SM_SOLID, 1, 0);
    for (long t = 0; t < large.triangle_count; t++)
        memset(large.triangle[t], 0, sizeof *large.triangle);
    expect_error(&large, SM_SOLID, 10, 0);
    sm_mesh_free(&large);
    m.position[3][1] = NAN;
    expect_error(&m, SM_SOLID, 0.1, 0);
    for (long i = 0; i < m.vertex_count; i++)
        for (int d = 0; d < 3; d++) m.position[i][d] = 2;
    expect_error(&m, SM_SHELL, 1, 0);
    sm_mesh_free(&m);
}

TEST(few_particles_are_one_cell)
{
    SmMesh m = ball(1, 10, 10, 0);
    for (long wanted = 1; wanted <= 8; wanted++) {
        SmVoxelParams params = {.fill = SM_SOLID, .particles = wanted};
        SmVoxels v;
        assert_int_equal(sm_voxelise(&m, &params, "test", &v, NULL), SM_OK);
        assert_int_equal(v.particle_count, 8);
        sm_voxels_free(&v);
    }
    sm_mesh_free(&m);
}

static long peak_megabytes(void)
{
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    long kilobytes = 0;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "VmHWM: %ld", &kilobytes) == 1) break;
    if (file) fclose(file);
    return kilobytes / 1024;
}

/* The volume is that of the unit ball, but for a layer of cells and a half around it. */
static void assert_ball(const SmVoxels *v)
{
    double volume = (double)v->cell_count * pow(v->cell, 3);
    assert_float_equal(volume, 4.0 / 3 * M_PI, 4 * M_PI * v->cell * 1.5);
}

TEST(a_hundred_million_cells_fit)
{
    SmMesh m = ball(1, 200, 300, 0);
    SmVoxels v = made(&m, SM_SOLID, 2.0 / 465, NULL);
    assert_true((double)v.size[0] * v.size[1] * v.size[2] >= 1e8);
    assert_ball(&v);
    sm_voxels_free(&v);
    m.triangle_count -= 3000; /* with a wide hole: votes too */
    SmVoxelReport report;
    v = made(&m, SM_SOLID, 2.0 / 465, &report);
    assert_int_equal(report.inside, SM_INSIDE_VOTED);
    assert_ball(&v);
    sm_voxels_free(&v);
    sm_mesh_free(&m);
    assert_true(peak_megabytes() < PEAK_MEGABYTES);
}

/* The open meshes whose holes are wide, and what must be filled there. */
static bool must_be_bridged(const char *name)
{
    return !strcmp(name, "hand_lowres_open.obj") || !strcmp(name, "demosthenes_lowres.obj") ||
           !strcmp(name, "lionstatue.obj") || !strcmp(name, "bunny_zipper_flipped.ply");
}

/* Is it a mesh, of which there is a verdict? */
static bool check_file(const char *path, const char *name)
{
    SmMesh m;
    SmError error = {0};
    if (sm_import(path, NULL, &m, NULL, &error)) return false;
    SmVoxelParams params = {.fill = SM_SOLID, .particles = 5000};
    SmVoxels v;
    SmVoxelReport report;
    SmCode code = sm_voxelise_report(&m, &params, name, &v, &report, &error);
    if (strcmp(name, "bad_soup.stl") == 0) {
        assert_int_equal(code, SM_INPUT);
    } else {
        if (code) fail_msg("%s", error.text);
        assert_true(labs(v.particle_count - 5000) <= 100);
        if (must_be_bridged(name)) {
            assert_int_equal(report.inside, SM_INSIDE_VOTED);
            assert_true(report.flood_cells + report.vote_cells > report.shell_cells / 2);
        }
        sm_voxels_free(&v);
    }
    sm_mesh_free(&m);
    return true;
}

TEST(meshes_made_by_others_have_a_verdict)
{
    const char *folder = getenv("SHAPEBENCH_MESHES");
    if (!folder) folder = SOURCE_DIR "/../shared/meshes";
    DIR *listing = opendir(folder);
    needs(listing, "SHAPEBENCH_MESHES names no folder of meshes");
    int meshes = 0;
    for (struct dirent *entry; (entry = readdir(listing));) {
        if (entry->d_name[0] == '.' || strstr(entry->d_name, ".md")) continue;
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        meshes += check_file(path, entry->d_name);
    }
    closedir(listing);
    needs(meshes > 0, "SHAPEBENCH_MESHES names a folder without a mesh that can be read");
}
