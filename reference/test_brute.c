/* Regions on shapes whose answer is known, and what the brute-force sums must conserve. */
#include "brute.h"

#include "../lib/csr.h"
#include "../lib/test_frame.h"
#include "../lib/test_random.h"

/* A lattice from a picture: layers of rows of cells, '#' is material. */
static SmVoxels picture(int nx, int ny, int nz, const char *cells)
{
    SmVoxels voxels;
    sm_voxels_init(&voxels, nx, ny, nz, 1.0);
    assert_int_equal(strlen(cells), nx * ny * nz);
    for (int n = 0; cells[n]; n++)
        if (cells[n] == '#') sm_voxel_set(&voxels, n % nx, n / nx % ny, n / nx / ny);
    sm_voxels_count(&voxels);
    return voxels;
}

static SmVoxels random_shape(unsigned *seed)
{
    SmVoxels voxels;
    sm_voxels_init(&voxels, 3 + random_int(seed, 5), 2 + random_int(seed, 4),
                   2 + random_int(seed, 4), 1.0);
    double fill = 0.25 + 0.6 * random_unit(seed);
    sm_voxel_set(&voxels, 0, 0, 0);
    for (int k = 0; k < voxels.size[2]; k++)
        for (int j = 0; j < voxels.size[1]; j++)
            for (int i = 0; i < voxels.size[0]; i++)
                if (random_unit(seed) < fill) sm_voxel_set(&voxels, i, j, k);
    sm_voxels_count(&voxels);
    return voxels;
}

static long size_of(const RefRegions *regions, long r)
{
    return regions->start[r + 1] - regions->start[r];
}

static bool holds(const RefRegions *regions, long r, long p)
{
    for (long n = regions->start[r]; n < regions->start[r + 1]; n++)
        if (regions->member[n] == p) return true;
    return false;
}

static long particle_at(const SmVoxels *voxels, int x, int y, int z)
{
    int(*c)[3] = sm_alloc((size_t)voxels->particle_count, sizeof *c);
    sm_voxels_particles(voxels, c);
    long p = 0;
    while (p < voxels->particle_count && (c[p][0] != x || c[p][1] != y || c[p][2] != z)) p++;
    free(c);
    assert_true(p < voxels->particle_count);
    return p;
}

static int clipped(int at, int cells, int w)
{
    int low = at - w < 0 ? 0 : at - w, high = at + w > cells ? cells : at + w;
    return high - low + 1;
}

TEST(full_block_has_clipped_cubes)
{
    SmVoxels voxels;
    sm_voxels_block(&voxels, 4, 3, 5, 1.0);
    int(*c)[3] = sm_alloc((size_t)voxels.particle_count, sizeof *c);
    sm_voxels_particles(&voxels, c);
    for (int w = 1; w <= 6; w++) {
        RefRegions regions;
        ref_regions_build(&voxels, w, NULL, 0, &regions);
        assert_int_equal(regions.count, 5 * 4 * 6);
        for (long r = 0; r < regions.count; r++) {
            assert_int_equal(size_of(&regions, r), clipped(c[r][0], 4, w) * clipped(c[r][1], 3, w) *
                                                       clipped(c[r][2], 5, w));
            for (long n = regions.start[r] + 1; n < regions.start[r + 1]; n++)
                assert_true(regions.member[n - 1] < regions.member[n]);
        }
        ref_regions_free(&regions);
    }
    free(c);
    sm_voxels_free(&voxels);
}

/* Ranges [i - w, i + w] cut to [0, 4] and to [0, 2]: 5, 5, 3, 1 and 3, 1, 1, 1 different ones. */
TEST(unique_regions_of_a_block)
{
    SmVoxels voxels;
    sm_voxels_block(&voxels, 4, 2, 2, 1.0);
    static const long along[] = {5, 5, 3, 1}, across[] = {3, 1, 1, 1};
    for (int w = 1; w <= 4; w++) {
        RefRegions regions;
        ref_regions_build(&voxels, w, NULL, 0, &regions);
        assert_int_equal(ref_regions_unique(&regions),
                         along[w - 1] * across[w - 1] * across[w - 1]);
        ref_regions_free(&regions);
    }
    sm_voxels_free(&voxels);
}

/* Two cells that touch in an edge or a vertex only share its particles, hence are joined there. */
TEST(cells_joined_at_an_edge_or_a_vertex)
{
    SmVoxels edge = picture(2, 2, 1,
                            "#."
                            ".#");
    RefRegions regions;
    ref_regions_build(&edge, 1, NULL, 0, &regions);
    assert_int_equal(regions.count, 14);
    assert_int_equal(size_of(&regions, particle_at(&edge, 0, 0, 0)), 8);
    assert_int_equal(size_of(&regions, particle_at(&edge, 1, 1, 0)), 14);
    assert_false(holds(&regions, particle_at(&edge, 1, 0, 0), particle_at(&edge, 2, 1, 0)));
    assert_int_equal(ref_regions_unique(&regions), 3);
    ref_regions_free(&regions);
    sm_voxels_free(&edge);

    SmVoxels vertex = picture(2, 2, 2,
                              "#..."
                              "...#");
    ref_regions_build(&vertex, 1, NULL, 0, &regions);
    assert_int_equal(regions.count, 15);
    assert_int_equal(size_of(&regions, particle_at(&vertex, 0, 0, 0)), 8);
    assert_int_equal(size_of(&regions, particle_at(&vertex, 1, 1, 1)), 15);
    ref_regions_free(&regions);
    ref_regions_build(&vertex, 2, NULL, 0, &regions);
    assert_int_equal(size_of(&regions, particle_at(&vertex, 0, 0, 0)), 15);
    ref_regions_free(&regions);
    sm_voxels_free(&vertex);
}

TEST(one_cell_gap_is_not_jumped)
{
    SmVoxels bars = picture(5, 3, 1,
                            "#####"
                            "....."
                            "#####");
    RefRegions regions;
    ref_regions_build(&bars, 6, NULL, 0, &regions);
    for (long r = 0; r < regions.count; r++) assert_int_equal(size_of(&regions, r), 24);
    assert_int_equal(ref_regions_unique(&regions), 2);
    ref_regions_free(&regions);
    sm_voxels_free(&bars);
}

/* Arms of a U: from tip to tip it is 5 steps down, 2 across at the foot, and up again. */
TEST(u_shape_goes_round)
{
    SmVoxels u = picture(3, 5, 1,
                         "###"
                         "#.#"
                         "#.#"
                         "#.#"
                         "#.#");
    long left = particle_at(&u, 1, 5, 0), right = particle_at(&u, 2, 5, 0);
    for (int w = 1; w <= 12; w++) {
        RefRegions regions;
        ref_regions_build(&u, w, NULL, 0, &regions);
        /* (1,5) down to (1,1) is 4 steps, then (2,1): 5, then up to (2,5): 9 */
        assert_int_equal(holds(&regions, left, right), w >= 9);
        ref_regions_free(&regions);
    }
    sm_voxels_free(&u);
}

TEST(broken_links_part_neighbours)
{
    SmVoxels bar;
    sm_voxels_block(&bar, 3, 1, 1, 1.0);
    int(*broken)[2] = sm_alloc(16, sizeof *broken);
    int count = 0;
    for (int a = 0; a < 4; a++) /* all 16 links across the middle cell, either way round */
        for (int b = 0; b < 4; b++, count++) {
            broken[count][count & 1] = 4 * a + 1;
            broken[count][!(count & 1)] = 4 * b + 2;
        }
    RefRegions regions;
    ref_regions_build(&bar, 1, (const int(*)[2])broken, 1, &regions);
    assert_int_equal(size_of(&regions, 1), 11);
    assert_int_equal(size_of(&regions, 2), 11);
    assert_int_equal(size_of(&regions, 5), 12);
    ref_regions_free(&regions);
    ref_regions_build(&bar, 5, (const int(*)[2])broken, count, &regions);
    for (long r = 0; r < regions.count; r++) assert_int_equal(size_of(&regions, r), 8);
    ref_regions_free(&regions);
    free(broken);
    sm_voxels_free(&bar);
}

TEST(membership_is_symmetric)
{
    unsigned seed = 7;
    for (int trial = 0; trial < 60; trial++) {
        SmVoxels voxels = random_shape(&seed);
        RefRegions regions;
        ref_regions_build(&voxels, 1 + trial % 4, NULL, 0, &regions);
        assert_int_equal(regions.count, voxels.particle_count);
        for (long r = 0; r < regions.count; r++) {
            assert_true(holds(&regions, r, r));
            for (long n = regions.start[r]; n < regions.start[r + 1]; n++)
                assert_true(holds(&regions, regions.member[n], r));
        }
        ref_regions_free(&regions);
        sm_voxels_free(&voxels);
    }
}

/* A random body: rest positions, masses, regions. */
typedef struct {
    SmVoxels voxels;
    RefRegions regions;
    long count;
    double (*x0)[3], (*x)[3], (*v)[3], (*g)[3], *m;
} Body;

static Body body_create(unsigned *seed, int w)
{
    Body body = {.voxels = random_shape(seed)};
    size_t count = (size_t)body.voxels.particle_count;
    body.count = (long)count;
    ref_regions_build(&body.voxels, w, NULL, 0, &body.regions);
    int(*c)[3] = sm_alloc(count, sizeof *c);
    sm_voxels_particles(&body.voxels, c);
    body.x0 = sm_alloc(count, sizeof *body.x0);
    body.x = sm_alloc(count, sizeof *body.x);
    body.v = sm_alloc(count, sizeof *body.v);
    body.g = sm_alloc(count, sizeof *body.g);
    body.m = sm_alloc(count, sizeof *body.m);
    for (size_t p = 0; p < count; p++) {
        body.m[p] = 0.5 + random_unit(seed);
        for (int a = 0; a < 3; a++) {
            body.x0[p][a] = c[p][a];
            body.x[p][a] = c[p][a] + random_between(seed, -0.5, 0.5);
            body.v[p][a] = random_between(seed, -0.5, 0.5);
        }
    }
    free(c);
    return body;
}

static void body_free(Body *body)
{
    free(body->x0);
    free(body->x);
    free(body->v);
    free(body->g);
    free(body->m);
    ref_regions_free(&body->regions);
    sm_voxels_free(&body->voxels);
}

#define CONST(array) ((const double(*)[3])(array))

static void body_goals(Body *body)
{
    ref_goals(&body->regions, CONST(body->x0), body->m, CONST(body->x), body->g);
}

static void add_cross(const double a[3], const double b[3], double m, double sum[3])
{
    for (int k = 0; k < 3; k++)
        sum[k] += m * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
}

static void assert_near(const double (*a)[3], const double (*b)[3], long count, double tolerance)
{
    for (long p = 0; p < count; p++)
        for (int k = 0; k < 3; k++) assert_true(fabs(a[p][k] - b[p][k]) <= tolerance);
}

static void rotation_from(unsigned *seed, double R[3][3])
{
    double q[4], length = 0;
    for (int k = 0; k < 4; k++) q[k] = random_between(seed, -0.5, 0.5), length += q[k] * q[k];
    for (int k = 0; k < 4; k++) q[k] /= sqrt(length);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            int c = 3 - a - b;
            double odd = a == b ? 0 : ((b - a + 3) % 3 == 1 ? -1 : 1) * q[0] * q[c + 1];
            R[a][b] = 2 * (q[a + 1] * q[b + 1] + odd) + (a == b ? 2 * q[0] * q[0] - 1 : 0);
        }
}

TEST(rigid_motion_is_reproduced)
{
    unsigned seed = 11;
    for (int trial = 0; trial < 30; trial++) {
        Body body = body_create(&seed, 1 + trial % 3);
        double R[3][3], shift[3];
        rotation_from(&seed, R);
        for (int a = 0; a < 3; a++) shift[a] = 20 * random_unit(&seed);
        body_goals(&body); /* deformed: something else first */
        memcpy(body.x, body.x0, (size_t)body.count * sizeof *body.x);
        body_goals(&body);
        assert_near(CONST(body.g), CONST(body.x0), body.count, 1e-13);
        for (long p = 0; p < body.count; p++)
            for (int a = 0; a < 3; a++)
                body.x[p][a] = shift[a] + R[a][0] * body.x0[p][0] + R[a][1] * body.x0[p][1] +
                               R[a][2] * body.x0[p][2];
        body_goals(&body);
        assert_near(CONST(body.g), CONST(body.x), body.count, 1e-12);
        body_free(&body);
    }
}

/* sum m g = sum m x and sum m x cross g = 0: then a step changes neither momentum. */
TEST(goals_conserve_momentum)
{
    unsigned seed = 13;
    for (int trial = 0; trial < 40; trial++) {
        Body body = body_create(&seed, 1 + trial % 3);
        body_goals(&body);
        double linear[3] = {0}, angular[3] = {0}, moved = 0;
        for (long p = 0; p < body.count; p++) {
            for (int a = 0; a < 3; a++) {
                double d = body.g[p][a] - body.x[p][a];
                linear[a] += body.m[p] * d;
                moved += fabs(d);
            }
            add_cross(body.x[p], body.g[p], body.m[p], angular);
        }
        assert_true(moved > 1); /* the bodies are far from rest */
        for (int a = 0; a < 3; a++) assert_true(fabs(linear[a]) < 1e-11);
        for (int a = 0; a < 3; a++) assert_true(fabs(angular[a]) < 1e-10);
        body_free(&body);
    }
}

TEST(rigid_velocity_of_rigid_motion_is_itself)
{
    unsigned seed = 17;
    for (int trial = 0; trial < 30; trial++) {
        Body body = body_create(&seed, 1 + trial % 3);
        const double omega[3] = {random_unit(&seed), -random_unit(&seed), 2 * random_unit(&seed)};
        for (long p = 0; p < body.count; p++) {
            body.v[p][0] = 3, body.v[p][1] = -1, body.v[p][2] = 0.5;
            add_cross(omega, body.x[p], 1, body.v[p]);
        }
        ref_rigid_velocity(&body.regions, body.m, CONST(body.x), CONST(body.v), NULL, body.g);
        assert_near(CONST(body.g), CONST(body.v), body.count, 1e-11);
        body_free(&body);
    }
}

TEST(rigid_velocity_conserves_momentum)
{
    unsigned seed = 19;
    for (int trial = 0; trial < 30; trial++) {
        Body body = body_create(&seed, 1 + trial % 3);
        ref_rigid_velocity(&body.regions, body.m, CONST(body.x), CONST(body.v), NULL, body.g);
        double linear[3] = {0}, angular[3] = {0}, left = 0, right = 0;
        for (long p = 0; p < body.count; p++) {
            double d[3];
            for (int a = 0; a < 3; a++) {
                d[a] = body.g[p][a] - body.v[p][a];
                linear[a] += body.m[p] * d[a];
                left += body.m[p] * body.g[p][a] * body.g[p][a];
                right += body.m[p] * body.v[p][a] * body.v[p][a];
            }
            add_cross(body.x[p], d, body.m[p], angular);
        }
        assert_true(left < right); /* an average of rigid fits never gains energy */
        for (int a = 0; a < 3; a++) assert_true(fabs(linear[a]) < 1e-11);
        for (int a = 0; a < 3; a++) assert_true(fabs(angular[a]) < 1e-10);
        body_free(&body);
    }
}

/* A rod along x, `thickness` across, that turns as a whole: about its own axis, too, for as long as
 * I_r's least eigenvalue (thickness^2 of the largest) is above the threshold. */
TEST(thin_bodies_turn_too)
{
    static const double thickness[] = {1e-1, 1e-3, 1e-7, 0};
    unsigned seed = 29;
    for (int n = 0; n < 4; n++) {
        Body body = body_create(&seed, 9);
        bool spins = thickness[n] > 1e-5;
        const double omega[3] = {spins ? 2 : 0, 1, -3}, spin[3] = {spins ? 0 : 5, 0, 0};
        double(*all)[3] = sm_alloc((size_t)body.count, sizeof *all);
        for (long p = 0; p < body.count; p++) {
            body.x[p][0] = body.x0[p][0];
            for (int a = 1; a < 3; a++) body.x[p][a] = thickness[n] * body.x0[p][a];
            memset(body.v[p], 0, sizeof body.v[p]);
            add_cross(omega, body.x[p], 1, body.v[p]);
            memcpy(all[p], body.v[p], sizeof all[p]);
            add_cross(spin, body.x[p], 1, all[p]); /* too thin to be felt */
        }
        ref_rigid_velocity(&body.regions, body.m, CONST(body.x), CONST(all), NULL, body.g);
        assert_near(CONST(body.g), CONST(body.v), body.count, spins ? 1e-9 : 1e-5);
        free(all);
        body_free(&body);
    }
}

/* Of particles moved from `a` to `b`: how far their centre goes, over the largest coordinate. */
static double centre_moves(const Body *body, const double (*a)[3], const double (*b)[3])
{
    double largest = 0, mass = 0, moves[3] = {0};
    for (long p = 0; p < body->count; p++) {
        mass += body->m[p];
        for (int d = 0; d < 3; d++) {
            largest = fmax(largest, fmax(fabs(a[p][d]), fabs(b[p][d])));
            moves[d] += body->m[p] * (b[p][d] - a[p][d]);
        }
    }
    return (fabs(moves[0]) + fabs(moves[1]) + fabs(moves[2])) / mass / fmax(largest, 1);
}

/* Crushed to a plane, a line, a point, or turned inside out; far away; huge. */
TEST(crushed_bodies_keep_their_momentum)
{
    unsigned seed = 23;
    const double scale[][3] = {{1, 1, 0},    {1, 0, 0},          {0, 0, 0},         {-1, 1, 1},
                               {-1, -1, -1}, {1000, 1000, 1000}, {1e-200, 1, 1e90}, {1e150, 1, 1}};
    for (size_t n = 0; n < sizeof scale / sizeof *scale; n++) {
        Body body = body_create(&seed, 2);
        for (long p = 0; p < body.count; p++)
            for (int a = 0; a < 3; a++) body.x[p][a] = scale[n][a] * body.x0[p][a];
        body_goals(&body);
        assert_true(centre_moves(&body, CONST(body.x), CONST(body.g)) < 1e-13);
        ref_rigid_velocity(&body.regions, body.m, CONST(body.x), CONST(body.v), NULL, body.g);
        assert_true(centre_moves(&body, CONST(body.v), CONST(body.g)) < 1e-13);
        body_free(&body);
    }
}

/* Regions that are found anew at each use, in every order, are those that are kept. */
TEST(regions_that_are_not_kept)
{
    unsigned seed = 31;
    for (int trial = 0; trial < 20; trial++) {
        Body body = body_create(&seed, 1 + trial % 5);
        RefLinks links;
        RefRegions anew;
        int *found = sm_alloc((size_t)body.count, sizeof *found);
        double(*other)[3] = sm_alloc((size_t)body.count, sizeof *other);
        ref_links_build(&body.voxels, NULL, 0, &links);
        ref_regions_walk(&links, 1 + trial % 5, &anew);
        assert_int_equal(ref_regions_unique(&anew), ref_regions_unique(&body.regions));
        for (long n = 0; n < 2 * body.count; n++) {
            long r = n % 2 ? n / 2 : (n * 7919) % body.count, count = size_of(&body.regions, r);
            RefMembers members = ref_members(&anew, r), kept = ref_members(&body.regions, r);
            assert_int_equal(members.count, count);
            assert_int_equal(size_of(&anew, r), count);
            memcpy(found, members.member, (size_t)count * sizeof *found);
            sm_sort_ints(found, count);
            assert_memory_equal(found, kept.member, (size_t)count * sizeof *found);
        }
        body_goals(&body);
        ref_goals(&anew, CONST(body.x0), body.m, CONST(body.x), other);
        assert_near(CONST(other), CONST(body.g), body.count, 1e-12);
        const long some[] = {body.count / 2, body.count - 1, 0};
        for (long p = 0; p < body.count; p++) other[p][0] = NAN;
        ref_goals_of(&links, 1 + trial % 5, CONST(body.x0), body.m, CONST(body.x), some, 3, other);
        for (int i = 0; i < 3; i++)
            assert_near(CONST(&other[some[i]]), CONST(&body.g[some[i]]), 1, 1e-12);
        ref_rigid_velocity(&body.regions, body.m, CONST(body.x), CONST(body.v), NULL, body.g);
        ref_rigid_velocity(&anew, body.m, CONST(body.x), CONST(body.v), NULL, other);
        assert_near(CONST(other), CONST(body.g), body.count, 1e-9);
        ref_regions_free(&anew);
        free(found);
        free(other);
        body_free(&body);
    }
}
