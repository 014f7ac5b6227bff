/* test_surfaces.h - irregular meshes of surfaces that are known, for the tests. */
#ifndef REF_TEST_SURFACES_H
#define REF_TEST_SURFACES_H

#include "../../../lib/mesh/mesh.h"
#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "../surface/surface_nets.h"

typedef void Place(double u, double v, double x[3]);

/* A grid of cells over the unit square, closed around where said, each halved along a random
 * diagonal, its vertices moved by up to `noise` cells but on rims. */
static inline SmMesh grid_mesh(int across, int up, bool around, bool both, Place *place,
                               double noise, unsigned *seed)
{
    int columns = across + !around, rows = up + !both;
    SmMesh mesh = sm_mesh_new((long)columns * rows, 2L * across * up);
    for (int n = 0; n < columns * rows; n++) {
        double at[2] = {n % columns, n / columns};
        int side[2] = {around ? -1 : across, both ? -1 : up};
        for (int d = 0; d < 2; d++)
            if (side[d] < 0 || (at[d] > 0 && at[d] < side[d]))
                at[d] += random_between(seed, -noise, noise);
        place(at[0] / across, at[1] / up, mesh.position[n]);
    }
    for (int n = 0; n < across * up; n++) {
        int i[2] = {n % across, (n % across + 1) % columns};
        int j[2] = {n / across, (n / across + 1) % rows}, corner[4];
        for (int k = 0; k < 4; k++) corner[k] = j[k / 2] * columns + i[(k ^ (k / 2)) & 1];
        int from = random_int(seed, 2);
        for (int k = 0; k < 3; k++) {
            mesh.triangle[2 * n][k] = corner[(from + k) % 4];
            mesh.triangle[2 * n + 1][k] = corner[(from + 2 + k) % 4];
        }
    }
    return mesh;
}

/* A unit sphere of 8 n^2 triangles, those of an octahedron split, or its half above z = 0, its
 * vertices moved by up to `noise` edges but on the rim. */
static inline SmMesh ball_mesh(int n, bool half, double noise, unsigned *seed)
{
    SmMesh mesh = sm_mesh_new((half ? 2L : 4L) * (n + 1) * (n + 2), (half ? 4L : 8L) * n * n);
    long vertex = 0, triangle = 0;
    for (int face = 0; face < (half ? 4 : 8); face++) {
        int sign[3] = {face & 1 ? -1 : 1, face & 2 ? -1 : 1, face & 4 ? -1 : 1};
        bool mirrored = sign[0] * sign[1] * sign[2] < 0;
        for (int i = 0; i <= n; i++)
            for (int j = 0; j <= n - i; j++) {
                double share[3] = {i, j, n - i - j};
                for (int d = 0; d < 3; d++) mesh.position[vertex][d] = sign[d] * share[d] / n;
                int here = (int)vertex, above = (int)(vertex + n - i + 1);
                int corner[2][3] = {{here, above, here + 1}, {above, above + 1, here + 1}};
                for (int k = 0; k < 2 && j < n - i - k; k++, triangle++)
                    for (int c = 0; c < 3; c++)
                        mesh.triangle[triangle][mirrored ? 2 - c : c] = corner[k][c];
                vertex++;
            }
    }
    sm_mesh_merge(&mesh);
    for (long v = 0; v < mesh.vertex_count; v++) {
        sm_normalize(mesh.position[v]);
        if (half && mesh.position[v][2] < 1e-9) continue;
        for (int d = 0; d < 3; d++) mesh.position[v][d] += random_between(seed, -noise, noise) / n;
        sm_normalize(mesh.position[v]);
    }
    return mesh;
}

static inline SmMesh sphere_mesh(int n, double noise, unsigned *seed)
{
    return ball_mesh(n, false, noise, seed);
}

/* Tori of radius 1 or more in a row, that have grown into one another: a smooth minimum of their
 * distances. */
typedef struct {
    int tori;
    double centre[16][2], ring[16], tube[16];
} Tori;

static inline double tori_at(const void *body, const double x[3], double gradient[3])
{
    const Tori *all = body;
    const double sharp = 4;
    double sum = 0, slope[3] = {0};
    for (int n = 0; n < all->tori; n++) {
        double way[2] = {x[0] - all->centre[n][0], x[1] - all->centre[n][1]};
        double out = hypot(way[0], way[1]), off = out - all->ring[n];
        double from = hypot(off, x[2]), share = exp(sharp * (all->tube[n] - from));
        sum += share;
        for (int d = 0; d < 3; d++)
            slope[d] += share * (d == 2 ? x[2] : off * way[d] / fmax(out, 1e-9)) / fmax(from, 1e-9);
    }
    for (int d = 0; gradient && d < 3; d++) gradient[d] = slope[d] / sum;
    return -log(sum) / sharp;
}

/* Their surface, of so many cells along its length, irregular. */
static inline SmMesh tori_mesh(const Tori *all, int cells, unsigned *seed)
{
    RefField field = {tori_at, all, {INFINITY, INFINITY, -1}, {-INFINITY, -INFINITY, 1.03}};
    for (int n = 0; n < all->tori; n++)
        for (int d = 0; d < 2; d++) {
            double out = all->ring[n] + all->tube[n] + 0.4; /* no even numbers of cells */
            field.low[d] = fmin(field.low[d], all->centre[n][d] - out);
            field.high[d] = fmax(field.high[d], all->centre[n][d] + out - 0.0173);
        }
    SmMesh mesh;
    SmError error = {0};
    double edge = (field.high[0] - field.low[0]) / cells;
    if (ref_surface_nets(&field, cells, &mesh, &error) != SM_OK) fail_msg("%s", error.text);
    for (long v = 0; v < mesh.vertex_count; v++) {
        for (int d = 0; d < 3; d++) mesh.position[v][d] += random_between(seed, -0.2, 0.2) * edge;
        assert_true(ref_field_project(&field, edge, 1e-9, mesh.position[v]));
    }
    return mesh;
}

static const Tori double_torus = {2, {{-1.1, 0}, {1.2, 0.3}}, {1, 1.2}, {0.42, 0.35}};
static const Tori even_double_torus = {2, {{-1.1, 0}, {1.1, 0}}, {1, 1}, {0.42, 0.42}};
static const Tori triple_torus = {
    3, {{-2.3, 0}, {0, 0.2}, {2.4, 0}}, {1, 1.1, 1}, {0.42, 0.42, 0.4}};

/* A plate of 4 by 2, bent up by `bend` x^2, with round holes; irregular. */
typedef struct {
    int holes;
    double hole[24][3]; /* middles and radii */
} Holes;

/* By how much a place is outside of all holes; moves it onto a rim that is nearer than `near`. */
static inline double outside_of(const Holes *holes, double near, double x[3])
{
    double least = INFINITY;
    for (int n = 0; n < holes->holes; n++) {
        const double *hole = holes->hole[n];
        double way[2] = {x[0] - hole[0], x[1] - hole[1]}, out = hypot(way[0], way[1]);
        double off = fabs(out - hole[2]) < near ? 0 : out - hole[2];
        for (int d = 0; d < 2 && off == 0; d++) x[d] = hole[d] + hole[2] / out * way[d];
        least = fmin(least, off);
    }
    return least;
}

static inline void on_plate(double u, double v, double x[3])
{
    x[0] = 4 * u;
    x[1] = 2 * v;
    x[2] = 0;
}

static inline SmMesh plate_mesh(const Holes *holes, int cells, double bend, unsigned *seed)
{
    SmMesh mesh = grid_mesh(2 * cells, cells, false, false, on_plate, 0.2, seed);
    double *off = sm_alloc((size_t)mesh.vertex_count, sizeof *off);
    long kept = 0;
    for (long v = 0; v < mesh.vertex_count; v++) {
        off[v] = outside_of(holes, 1.0 / cells, mesh.position[v]);
        mesh.position[v][2] = bend * mesh.position[v][0] * mesh.position[v][0];
    }
    for (long t = 0; t < mesh.triangle_count; t++) {
        const int *v = mesh.triangle[t];
        double least = fmin(off[v[0]], fmin(off[v[1]], off[v[2]]));
        if (least < 0 || fmax(off[v[0]], fmax(off[v[1]], off[v[2]])) <= 0) continue;
        memcpy(mesh.triangle[kept++], v, sizeof *mesh.triangle);
    }
    mesh.triangle_count = kept;
    free(off);
    return mesh;
}

/* Round holes anywhere in the plate, a quarter from one another and from its rim. */
static inline Holes random_holes(int holes, unsigned *seed)
{
    Holes all = {0};
    while (all.holes < holes) {
        double *hole = all.hole[all.holes], apart = INFINITY;
        hole[2] = random_between(seed, 0.2, 0.35);
        for (int d = 0; d < 2; d++)
            hole[d] = random_between(seed, hole[2] + 0.25, (d ? 2 : 4) - hole[2] - 0.25);
        for (int n = 0; n < all.holes; n++)
            apart = fmin(apart, hypot(hole[0] - all.hole[n][0], hole[1] - all.hole[n][1]) -
                                    hole[2] - all.hole[n][2]);
        all.holes += apart > 0.25;
    }
    return all;
}

/* Takes the triangles away of which two corners are in a ball. */
static inline void punch(const double middle[3], double radius, SmMesh *mesh)
{
    long kept = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        int inside = 0;
        for (int i = 0; i < 3; i++)
            inside +=
                sm_square_between(mesh->position[mesh->triangle[t][i]], middle) < radius * radius;
        if (inside < 2) memcpy(mesh->triangle[kept++], mesh->triangle[t], sizeof *mesh->triangle);
    }
    mesh->triangle_count = kept;
}

static const Holes two_holes = {2, {{1.1, 1, 0.45}, {2.9, 0.9, 0.5}}};
static const Holes three_holes = {3, {{0.8, 1.1, 0.35}, {2, 0.9, 0.35}, {3.2, 1, 0.4}}};

static inline void random_move(unsigned *seed, SmMesh *mesh)
{
    double axis[2][3], third[3];
    for (int k = 0; k < 2; k++)
        for (int d = 0; d < 3; d++) axis[k][d] = random_between(seed, -1, 1);
    sm_normalize(axis[0]);
    double along = sm_dot(axis[0], axis[1]);
    for (int d = 0; d < 3; d++) axis[1][d] -= along * axis[0][d];
    sm_normalize(axis[1]);
    sm_cross(axis[0], axis[1], third);
    for (long v = 0; v < mesh->vertex_count; v++) {
        double x[3];
        memcpy(x, mesh->position[v], sizeof x);
        for (int d = 0; d < 3; d++)
            mesh->position[v][d] = x[0] * axis[0][d] + x[1] * axis[1][d] + x[2] * third[d];
    }
}

/* Writes an OBJ file, and frees the mesh. */
static inline void write_obj(const char *path, SmMesh mesh)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (long v = 0; v < mesh.vertex_count; v++)
        fprintf(file, "v %.9g %.9g %.9g\n", mesh.position[v][0], mesh.position[v][1],
                mesh.position[v][2]);
    for (long t = 0; t < mesh.triangle_count; t++)
        fprintf(file, "f %d %d %d\n", mesh.triangle[t][0] + 1, mesh.triangle[t][1] + 1,
                mesh.triangle[t][2] + 1);
    assert_int_equal(fclose(file), 0);
    sm_mesh_free(&mesh);
}

#endif
