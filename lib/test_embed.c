#include "embed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { N = 4, RINGS = 12, SPOKES = 16 };

/* A solid block of N^3 cells with a notch, away from the origin. */
static SmVoxels block(double offset)
{
    SmVoxels voxels;
    sm_voxels_init(&voxels, N, N, N, 0.5);
    for (int a = 0; a < 3; a++) voxels.origin[a] = offset + 0.25 * a;
    for (int k = 0; k < N; k++)
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++)
                if (i < N - 1 || j < N - 1) sm_voxel_set(&voxels, i, j, k);
    sm_voxels_count(&voxels);
    return voxels;
}

/* A sphere of radius 0.7 about the block's middle, outside counter-clockwise. */
static SmMesh sphere(const SmVoxels *voxels)
{
    SmMesh mesh = sm_mesh_new(RINGS * SPOKES, 2L * (RINGS - 1) * SPOKES);
    for (int v = 0; v < RINGS * SPOKES; v++) {
        double polar = M_PI * (v / SPOKES + 0.5) / RINGS, around = 2 * M_PI * (v % SPOKES) / SPOKES;
        double p[3] = {sin(polar) * cos(around), sin(polar) * sin(around), cos(polar)};
        for (int a = 0; a < 3; a++) mesh.position[v][a] = voxels->origin[a] + 1 + 0.7 * p[a];
    }
    for (int v = 0; v < (RINGS - 1) * SPOKES; v++) {
        int right = v % SPOKES == SPOKES - 1 ? v + 1 - SPOKES : v + 1;
        int corner[2][3] = {{v, v + SPOKES, right}, {right, v + SPOKES, right + SPOKES}};
        memcpy(mesh.triangle[2 * v], corner, sizeof corner);
    }
    return mesh;
}

/* Particle positions F X + t. */
static double (*particles(const SmVoxels *voxels, double f[3][3], const double t[3]))[3]
{
    size_t count = (size_t)voxels->particle_count;
    int(*coordinate)[3] = sm_alloc(count, sizeof *coordinate);
    double(*x)[3] = sm_alloc(count, sizeof *x);
    sm_voxels_particles(voxels, coordinate);
    for (size_t p = 0; p < count; p++)
        for (int a = 0; a < 3; a++) {
            x[p][a] = t[a];
            for (int b = 0; b < 3; b++)
                x[p][a] += f[a][b] * (voxels->origin[b] + voxels->cell * coordinate[p][b]);
        }
    free(coordinate);
    return x;
}

typedef struct {
    SmVoxels voxels;
    SmMesh mesh;
    SmEmbedding embedding;
    double (*position)[3], (*normal)[3];
} Case;

static Case make_case(SmVoxels voxels, SmMesh mesh)
{
    Case c = {.voxels = voxels, .mesh = mesh};
    sm_embed_create(&mesh, &voxels, &c.embedding);
    c.position = sm_alloc((size_t)mesh.vertex_count, sizeof *c.position);
    c.normal = sm_alloc((size_t)mesh.vertex_count, sizeof *c.normal);
    return c;
}

static void free_case(Case *c)
{
    sm_voxels_free(&c->voxels);
    sm_mesh_free(&c->mesh);
    sm_embed_free(&c->embedding);
    free(c->position);
    free(c->normal);
}

static void apply(Case *c, double f[3][3], const double t[3])
{
    double(*x)[3] = particles(&c->voxels, f, t);
    sm_embed_apply(&c->embedding, (const double(*)[3])x, c->position, c->normal);
    free(x);
}

static void assert_near(const double *value, const double *expected, double tolerance)
{
    for (int a = 0; a < 3; a++)
        if (!(fabs(value[a] - expected[a]) <= tolerance))
            fail_msg("%.17g is not %.17g", value[a], expected[a]);
}

static double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double nowhere[3] = {0, 0, 0};

/* Weights are single precision, relative to the cell: 1e-7 of 0.5, far from the origin too. */
static void test_rest(void **state)
{
    (void)state;
    const double offsets[] = {0, 5e6};
    for (int o = 0; o < 2; o++) {
        SmVoxels voxels = block(offsets[o]);
        Case c = make_case(voxels, sphere(&voxels));
        apply(&c, identity, nowhere);
        for (long v = 0; v < c.mesh.vertex_count; v++) {
            double outward[3];
            for (int a = 0; a < 3; a++)
                outward[a] = (c.mesh.position[v][a] - voxels.origin[a] - 1) / 0.7;
            assert_near(c.position[v], c.mesh.position[v], 2e-7);
            if (v / SPOKES > 0 && v / SPOKES < RINGS - 1) assert_near(c.normal[v], outward, 0.1);
        }
        free_case(&c);
    }
}

static void multiply(double m[3][3], const double v[3], double result[3])
{
    for (int a = 0; a < 3; a++) result[a] = m[a][0] * v[0] + m[a][1] * v[1] + m[a][2] * v[2];
}

/* det F times F^-T. */
static void cofactors(double f[3][3], double result[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            result[i][j] = f[a][c] * f[b][d] - f[a][d] * f[b][c];
        }
}

static void test_affine(void **state)
{
    (void)state;
    double f[3][3] = {{1.5, 0.4, -0.2}, {0.1, 0.7, 0.9}, {-0.6, 0.3, 1.1}}, cofactor[3][3];
    const double t[3] = {3, -2, 10};
    SmVoxels voxels = block(0);
    Case c = make_case(voxels, sphere(&voxels));
    apply(&c, identity, nowhere);
    double(*rest)[3] = sm_alloc((size_t)c.mesh.vertex_count, sizeof *rest);
    memcpy(rest, c.normal, (size_t)c.mesh.vertex_count * sizeof *rest);
    apply(&c, f, t);
    cofactors(f, cofactor);
    for (long v = 0; v < c.mesh.vertex_count; v++) {
        double moved[3], turned[3];
        multiply(f, c.mesh.position[v], moved);
        for (int a = 0; a < 3; a++) moved[a] += t[a];
        assert_near(c.position[v], moved, 5e-7);
        multiply(cofactor, rest[v], turned);
        double length = sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2]);
        for (int a = 0; a < 3; a++) turned[a] /= length;
        assert_near(c.normal[v], turned, 2e-6);
    }
    free(rest);
    free_case(&c);
}

/* Crushed to a line or a point, tangents are parallel or nothing. */
static void test_degenerate_cell(void **state)
{
    (void)state;
    double line[3][3] = {{1, 0.5, 0.25}, {2, 1, 0.5}, {-1, -0.5, -0.25}}, point[3][3] = {{0}};
    SmVoxels voxels = block(0);
    Case c = make_case(voxels, sphere(&voxels));
    for (int k = 0; k < 2; k++) {
        apply(&c, k ? point : line, nowhere);
        for (long v = 0; v < c.mesh.vertex_count; v++)
            for (int a = 0; a < 3; a++) {
                assert_true(c.normal[v][a] == 0);
                assert_true(isfinite(c.position[v][a]));
            }
    }
    free_case(&c);
}

/* Vertices on and beyond the box's sides, in the notch, and far away go to the nearest material. */
static void test_outside(void **state)
{
    (void)state;
    const double place[][3] = {{-1e-9, 1, 1}, {2, 1, 1},      {1, 2 + 1e-9, 2 + 1e-9},
                               {0, 0, 0},     {1.75, 1.5, 1}, {1.75, 1.5 + 1e-9, 1},
                               {1.9, 1.6, 1}, {-20, 1, 1},    {1, 1, 30}};
    enum { PLACES = sizeof place / sizeof *place };
    SmVoxels voxels = block(0);
    SmMesh mesh = {.vertex_count = PLACES};
    mesh.position = sm_alloc(PLACES, sizeof *mesh.position);
    for (int v = 0; v < PLACES; v++)
        for (int a = 0; a < 3; a++) mesh.position[v][a] = voxels.origin[a] + place[v][a];
    Case c = make_case(voxels, mesh);
    apply(&c, identity, nowhere);
    for (int v = 0; v < PLACES; v++) {
        double distance = fmax(fabs(place[v][0] - 1), fabs(place[v][2] - 1));
        assert_near(c.position[v], mesh.position[v], 1e-6 * fmax(1, distance));
        for (int a = 0; a < 3; a++) assert_true(c.normal[v][a] == 0); /* no triangle, no normal */
    }
    free_case(&c);
}

static void test_thread_counts(void **state)
{
    (void)state;
    double f[3][3] = {{1.5, 0.4, -0.2}, {0.1, 0.7, 0.9}, {-0.6, 0.3, 1.1}};
    SmVoxels voxels = block(0);
    Case c = make_case(voxels, sphere(&voxels));
    size_t bytes = (size_t)c.mesh.vertex_count * sizeof *c.position;
    double *first = sm_alloc(2, bytes);
    int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    apply(&c, f, nowhere);
    memcpy(first, c.position, bytes);
    memcpy((char *)first + bytes, c.normal, bytes);
    omp_set_num_threads(3);
    apply(&c, f, nowhere);
    assert_memory_equal(first, c.position, bytes);
    assert_memory_equal((char *)first + bytes, c.normal, bytes);
    omp_set_num_threads(threads);
    free(first);
    free_case(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_affine),
        cmocka_unit_test(test_degenerate_cell),
        cmocka_unit_test(test_outside),
        cmocka_unit_test(test_thread_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
