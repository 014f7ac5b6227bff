#include "../voxel/embed.h"

#include "../pieces.h"
#include "../shapes/shape.h"
#include "../system/team.h"
#include "../test_frame.h"
#include "../vector.h"
#include "../voxel/voxelise.h"
#include "cut_surface.h"
#include "embed_cut.h"

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
    sm_embed_create(&mesh, &voxels, &c.embedding); /* 8 particles, weights and two tangents */
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
TEST(test_rest)
{
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

TEST(test_affine)
{
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
TEST(test_degenerate_cell)
{
    double line[3][3] = {{1, 0.5, 0.25}, {2, 1, 0.5}, {-1, -0.5, -0.25}}, point[3][3] = {{0}};
    SmVoxels voxels = block(0);
    Case c = make_case(voxels, sphere(&voxels));
    for (int k = 0; k < 2; k++) {
        apply(&c, k ? point : line, nowhere);
        for (long v = 0; v < c.mesh.vertex_count; v++) {
            double moved[3];
            multiply(k ? point : line, c.mesh.position[v], moved);
            assert_near(c.position[v], moved, 5e-7);
            assert_near(c.normal[v], nowhere, 0);
        }
    }
    free_case(&c);
}

/* Vertices on and beyond the box's sides, in the notch, and far away go to the nearest material. */
TEST(test_outside)
{
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

TEST(test_thread_counts)
{
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

/* ---- beside cuts */

enum { MOST_PLANES = 6, MOST_SIDES = 1 << MOST_PLANES };

/* A beam, the planes that it has been cut along, and how what is on each of their sides moves. */
typedef struct {
    Case c;
    SmSites sites;
    SmCut cut;
    int planes;
    double at[MOST_PLANES][3], normal[MOST_PLANES][3];
    double turn[MOST_SIDES][3][3], shift[MOST_SIDES][3];
} Sliced;

static void start_sliced(Sliced *s)
{
    SmMesh mesh;
    SmVoxels voxels;
    SmError error;
    SmVoxelParams params = {.fill = SM_SOLID, .cell = 0.021};
    *s = (Sliced){0};
    assert_int_equal(sm_shape_mesh("beam", &mesh, &error), SM_OK);
    assert_int_equal(sm_voxelise(&mesh, &params, "beam", &voxels, &error), SM_OK);
    s->c = make_case(voxels, mesh);
    sm_sites_init(&s->c.voxels, &s->sites);
    sm_cut_init(&s->cut, 2 * voxels.cell);
}

static void free_sliced(Sliced *s)
{
    sm_cut_free(&s->cut);
    sm_sites_free(&s->sites);
    free_case(&s->c);
}

/* What the cut has left of the lattice's links holds together. */
static void find_pieces(const Sliced *s, SmPieces *pieces)
{
    double(*x)[3] = particles(&s->c.voxels, identity, nowhere);
    sm_pieces_init(s->c.voxels.particle_count, pieces);
    for (long p = 0; p < s->c.voxels.particle_count; p++) {
        int neighbour[SM_RING], count = sm_sites_ring(&s->sites, p, neighbour);
        for (int n = 0; n < count; n++)
            if (!sm_cut_crosses(&s->cut, 0, x[p], x[neighbour[n]]))
                sm_pieces_link(pieces, p, neighbour[n]);
    }
    sm_pieces_finish(pieces, NULL, s->c.voxels.particle_count);
    free(x);
}

/* Cuts along a square about `at`, which reaches `reach` cells. */
static SmCutResult slice(Sliced *s, const double at[3], const double normal[3], double reach)
{
    double n[3] = {normal[0], normal[1], normal[2]}, u[3], v[3];
    long first = s->cut.triangles, base = s->cut.vertices;
    sm_normalize(n);
    sm_embed_tangents(n, u, v);
    for (int i = 0; i < 4; i++) {
        double corner[3];
        for (int d = 0; d < 3; d++)
            corner[d] = at[d] + reach * s->c.voxels.cell *
                                    ((i & 1 ? u[d] : -u[d]) + (i & 2 ? v[d] : -v[d]));
        sm_cut_vertex(&s->cut, corner);
    }
    sm_cut_triangle(&s->cut, (int[3]){(int)base, (int)base + 1, (int)base + 3});
    sm_cut_triangle(&s->cut, (int[3]){(int)base, (int)base + 3, (int)base + 2});
    SmCutResult result = sm_cut_surface(&s->c.mesh, &s->cut, first, s->c.voxels.cell);
    SmPieces pieces;
    find_pieces(s, &pieces);
    sm_embed_cut(&s->c.embedding, &s->c.mesh, &s->sites, &s->cut, first, pieces.piece);
    sm_pieces_free(&pieces);
    size_t vertices = (size_t)s->c.mesh.vertex_count;
    s->c.position = sm_realloc(s->c.position, vertices, sizeof *s->c.position);
    s->c.normal = sm_realloc(s->c.normal, vertices, sizeof *s->c.normal);
    return result;
}

/* The same right through, remembered as a plane. */
static void slice_through(Sliced *s, const double at[3], const double normal[3])
{
    assert_int_equal(slice(s, at, normal, 60), SM_CUT_CLOSED);
    memcpy(s->at[s->planes], at, sizeof s->at[0]);
    memcpy(s->normal[s->planes++], normal, sizeof s->normal[0]);
}

static int side_of(const Sliced *s, const double X[3])
{
    int side = 0;
    for (int n = 0; n < s->planes; n++) {
        double off[3] = {X[0] - s->at[n][0], X[1] - s->at[n][1], X[2] - s->at[n][2]};
        side |= (sm_dot(off, s->normal[n]) > 0) << n;
    }
    return side;
}

static void move_by_side(const Sliced *s, const double X[3], double x[3])
{
    int side = side_of(s, X);
    multiply((double(*)[3])s->turn[side], X, x);
    for (int d = 0; d < 3; d++) x[d] += s->shift[side][d];
}

/* Each side goes its own way; turned by up to `most`. */
static void scatter_sides(Sliced *s, double most)
{
    for (int side = 0; side < 1 << s->planes; side++) {
        double a = most * sin(1 + 5 * side), b = most * cos(3 * side);
        double turn[3][3] = {{cos(a), -sin(a), 0},
                             {sin(a) * cos(b), cos(a) * cos(b), -sin(b)},
                             {sin(a) * sin(b), cos(a) * sin(b), cos(b)}};
        memcpy(s->turn[side], turn, sizeof turn);
        for (int d = 0; d < 3; d++) s->shift[side][d] = sin(7 * side + 2 * d);
    }
    double(*x)[3] = particles(&s->c.voxels, identity, nowhere);
    for (long p = 0; p < s->c.voxels.particle_count; p++) {
        double rest[3] = {x[p][0], x[p][1], x[p][2]};
        move_by_side(s, rest, x[p]);
    }
    sm_embed_apply(&s->c.embedding, (const double(*)[3])x, s->c.position, s->c.normal);
    free(x);
}

/* Vertices in use are where they were while nothing has moved; the normals are as they are then. */
static double (*rest_normals(Sliced *s))[3]
{
    size_t vertices = (size_t)s->c.mesh.vertex_count;
    double(*rest)[3] = sm_alloc(vertices, sizeof *rest);
    assert_int_equal(s->c.embedding.vertex_count, s->c.mesh.vertex_count);
    apply(&s->c, identity, nowhere);
    memcpy(rest, s->c.normal, vertices * sizeof *rest);
    for (long t = 0; t < s->c.mesh.triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            int v = s->c.mesh.triangle[t][c];
            assert_near(s->c.position[v], s->c.mesh.position[v], 1e-7);
            assert_true(fabs(sm_dot(rest[v], rest[v]) - 1) < 1e-6);
        }
    return rest;
}

/* Every vertex in use has gone with its side, and its normal too. */
static void assert_apart(Sliced *s, double most)
{
    double(*rest)[3] = rest_normals(s);
    scatter_sides(s, most);
    for (long t = 0; t < s->c.mesh.triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            int v = s->c.mesh.triangle[t][c];
            double wanted[3];
            move_by_side(s, s->c.mesh.position[v], wanted);
            assert_near(s->c.position[v], wanted, 1e-7);
            multiply(s->turn[side_of(s, s->c.mesh.position[v])], rest[v], wanted);
            assert_near(s->c.normal[v], wanted, 1e-5);
        }
    free(rest);
}

static void assert_pieces(const Sliced *s, long pieces)
{
    SmMeshInfo info = sm_mesh_info(&s->c.mesh);
    assert_int_equal(info.open_edges + info.nonmanifold_edges, 0);
    assert_int_equal(info.components, pieces);
}

/* Halves that move apart stay whole and rigid; a second cut in the same place does no harm. */
TEST(test_cut_halves)
{
    const double normals[][3] = {{1, 0, 0}, {1, 0.3, -0.2}, {1, -2, 0.7}};
    for (int k = 0; k < 3; k++) {
        const double at[3] = {0.0217 + 0.03 * k, 0.05, 0.001};
        Sliced s;
        start_sliced(&s);
        slice_through(&s, at, normals[k]);
        assert_apart(&s, 2);
        assert_pieces(&s, 2);
        slice(&s, at, normals[k], 60);
        assert_apart(&s, 2);
        free_sliced(&s);
    }
}

/* A cut through a part, one beside the beam, and none: all that sees its cell stays as it was. */
TEST(test_cut_untouched)
{
    const double places[][3] = {{0.1, 0.1, 0}, {0.1, 0.9, 0}}, across[3] = {1, 0.1, 0};
    for (int k = 0; k < 2; k++) {
        Sliced s;
        start_sliced(&s);
        size_t before = (size_t)s.c.mesh.vertex_count, changed = 0;
        int(*corner)[8] = sm_alloc(before, sizeof *corner);
        float(*weight)[8] = sm_alloc(before, sizeof *weight);
        memcpy(corner, s.c.embedding.corner, before * sizeof *corner);
        memcpy(weight, s.c.embedding.weight, before * sizeof *weight);
        slice(&s, places[k], across, 2.4);
        double(*x)[3] = particles(&s.c.voxels, identity, nowhere);
        for (size_t v = 0; v < before; v++) {
            bool parted = false;
            for (int i = 0; i < 8; i++)
                parted |= sm_cut_crosses(&s.cut, 0, s.c.mesh.position[v], x[corner[v][i]]);
            bool same = !memcmp(corner[v], s.c.embedding.corner[v], sizeof *corner) &&
                        !memcmp(weight[v], s.c.embedding.weight[v], sizeof *weight);
            if (!parted) assert_true(same);
            changed += !same;
        }
        assert_true(k == 0 ? changed > 0 && changed < before / 4 : changed == 0);
        assert_int_equal(s.c.mesh.vertex_count > (long)before, k == 0);
        sm_embed_apply(&s.c.embedding, (const double(*)[3])x, s.c.position, NULL);
        for (long v = 0; v < s.c.mesh.vertex_count; v++)
            assert_near(s.c.position[v], s.c.mesh.position[v], 1e-7);
        free(x);
        free(corner);
        free(weight);
        free_sliced(&s);
    }
}

/* A slice about one layer of particles turns with it. Cut along the other axes too, into rows of
 * particles and single ones, pieces follow wherever these are carried. */
TEST(test_cut_thin)
{
    Sliced s;
    start_sliced(&s);
    const double *origin = s.c.voxels.origin, cell = s.c.voxels.cell;
    const int layer[3] = {20, 2, 2};
    for (int d = 0; d < 3; d++) {
        for (int end = 0; end < 2; end++) {
            double at[3] = {0.01, 0.05, 0}, normal[3] = {0};
            at[d] = origin[d] + cell * (layer[d] + (end ? 0.31 : -0.29));
            normal[d] = 1;
            slice_through(&s, at, normal);
        }
        assert_apart(&s, d == 0 ? 2 : 0);
        assert_pieces(&s, (const long[]){3, 9, 27}[d]);
        assert_true(s.c.embedding.flat_count > 0);
    }
    free_sliced(&s);
}
