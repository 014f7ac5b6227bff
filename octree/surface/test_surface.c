#include "surface.h"

#include "../../lib/system/team.h"
#include "../../lib/test_frame.h"
#include "../tree/sampling.h"
#include "../tree/test_trees.h"

typedef struct {
    SmVoxels voxels;
    OctTree tree;
    OctGraph graph;
    SmMesh mesh;
    OctSurface surface;
    double (*x)[3], (*position)[3], (*normal)[3];
} Body;

/* Vertices at random places in random material cells, on their sides too; triangles of any three,
 * the last vertex in none. */
static void scatter(unsigned *seed, const SmVoxels *voxels, long count, SmMesh *mesh)
{
    *mesh = (SmMesh){.vertex_count = count, .triangle_count = (count - 1) / 3};
    mesh->position = sm_alloc((size_t)count, sizeof *mesh->position);
    mesh->triangle = sm_alloc((size_t)count, sizeof *mesh->triangle);
    for (long v = 0; v < count; v++) {
        int cell[3];
        do
            for (int d = 0; d < 3; d++) cell[d] = random_int(seed, voxels->size[d]);
        while (!sm_voxel_get(voxels, cell[0], cell[1], cell[2]));
        for (int d = 0; d < 3; d++) {
            double share = random_int(seed, 3) ? random_unit(seed) : random_int(seed, 2);
            mesh->position[v][d] = voxels->origin[d] + voxels->cell * (cell[d] + share);
        }
        mesh->triangle[v / 3][v % 3] = (int)v;
    }
}

/* Ties the mesh to the body, and puts the nodes at rest. */
static void attach(Body *body)
{
    oct_surface_build(&body->mesh, &(OctCarrier){&body->voxels, &body->tree, &body->graph, NULL},
                      &body->surface);
    size_t leaves = (size_t)body->tree.leaves, vertices = (size_t)body->mesh.vertex_count;
    body->x = sm_alloc(leaves, sizeof *body->x);
    body->position = sm_alloc(vertices, sizeof *body->position);
    body->normal = sm_alloc(vertices, sizeof *body->normal);
    memcpy(body->x, body->surface.centre, leaves * sizeof *body->x);
}

static void make_body(unsigned *seed, int kind, long vertices, Body *body)
{
    random_tree(seed, kind, 16, &body->voxels, &body->tree);
    oct_graph_build(&body->tree, &body->voxels, &body->graph);
    scatter(seed, &body->voxels, vertices, &body->mesh);
    attach(body);
}

static void free_body(Body *body)
{
    oct_surface_free(&body->surface);
    oct_graph_free(&body->graph);
    oct_tree_free(&body->tree);
    sm_mesh_free(&body->mesh);
    sm_voxels_free(&body->voxels);
    free(body->x);
    free(body->position);
    free(body->normal);
}

static void move(Body *body)
{
    oct_surface_move(&body->surface, (const double(*)[3])body->x, body->position, body->normal);
}

static void apply(double A[3][3], const double t[3], const double from[3], double to[3])
{
    for (int a = 0; a < 3; a++)
        to[a] = A[a][0] * from[0] + A[a][1] * from[1] + A[a][2] * from[2] + t[a];
}

/* A rotation by any angle; with `stretch` also up to that much off it in every entry. */
static void random_motion(unsigned *seed, double stretch, double A[3][3], double t[3])
{
    double q[4], square = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = random_unit(seed) - 0.5;
        square += q[i] * q[i];
    }
    double s = 2 / square, w = q[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        A[i][i] = 1 - s * (q[j] * q[j] + q[k] * q[k]);
        A[i][j] = s * (q[i] * q[j] - w * q[k]);
        A[i][k] = s * (q[i] * q[k] + w * q[j]);
        t[i] = 20 * random_unit(seed) - 10;
    }
    for (int i = 0; i < 9; i++) A[i / 3][i % 3] += stretch * (2 * random_unit(seed) - 1);
}

/* Do the neighbours of all nodes that move a vertex span that many dimensions? */
static bool spans(const OctSurface *s, long v, int dimensions)
{
    for (long n = s->rows.first[v]; n < s->rows.end[v]; n++)
        if (s->gradients.span[s->rows.item[n]] < dimensions) return false;
    return true;
}

/* The normal A^-T N of a vertex, or 0. */
static void turned_normal(double A[3][3], const double N[3], double n[3])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        int p = (a + 1) % 3, q = (a + 2) % 3;
        n[a] = 0;
        for (int b = 0; b < 3; b++) {
            int e = (b + 1) % 3, f = (b + 2) % 3;
            n[a] += (A[p][e] * A[q][f] - A[p][f] * A[q][e]) * N[b];
        }
        square += n[a] * n[a];
    }
    for (int a = 0; a < 3 && square > 0; a++) n[a] /= sqrt(square);
}

/* Moves all nodes by random motions and compares the vertices whose nodes' neighbours span enough;
 * returns how many. */
static long compare_motion(unsigned *seed, double stretch, int dimensions, Body *body)
{
    double A[3][3], t[3], to[3], n[3];
    long compared = 0;
    random_motion(seed, stretch, A, t);
    for (long k = 0; k < body->tree.leaves; k++) apply(A, t, body->surface.centre[k], body->x[k]);
    move(body);
    for (long v = 0; v < body->mesh.vertex_count; v++) {
        if (!spans(&body->surface, v, dimensions)) continue;
        compared++;
        apply(A, t, body->mesh.position[v], to);
        turned_normal(A, body->surface.normal[v], n);
        for (int d = 0; d < 3; d++) {
            assert_true(fabs(body->position[v][d] - to[d]) < 1e-11 * 20);
            assert_true(fabs(body->normal[v][d] - n[d]) < 1e-9);
        }
    }
    return compared;
}

TEST(exact_for_rigid_and_affine_motions)
{
    unsigned seed = 1;
    long rigid = 0, affine = 0, all = 0;
    for (int trial = 0; trial < 120; trial++) {
        Body body;
        make_body(&seed, trial % 6, 100, &body);
        all += body.mesh.vertex_count;
        rigid += compare_motion(&seed, 0, 2, &body);
        affine += compare_motion(&seed, 0.3, 3, &body);
        free_body(&body);
    }
    /* Sheets have no third dimension, chains and crumbs no second. */
    assert_true(rigid > 0.8 * (double)all);
    assert_true(affine > 0.5 * (double)all);
}

/* Weights add up to 1, each node once, the own leaf always among them; at rest nothing moves. */
TEST(weights_are_a_partition_of_unity)
{
    unsigned seed = 2;
    for (int trial = 0; trial < 60; trial++) {
        Body body;
        make_body(&seed, trial % 6, 100, &body);
        const OctSurface *s = &body.surface;
        const float *weight = s->rows.value;
        for (long v = 0; v < s->vertices; v++) {
            double others = 0;
            for (long n = s->rows.first[v] + 1; n < s->rows.end[v]; n++) {
                assert_true(weight[n] > 0 && s->rows.item[n] != s->rows.item[s->rows.first[v]]);
                others += (double)weight[n];
            }
            /* its own weight is 1/8 of its most at least */
            assert_true(others >= 0 && others < 1 - 1e-3);
        }
        move(&body);
        for (long v = 0; v < s->vertices; v++)
            for (int d = 0; d < 3; d++)
                assert_true(fabs(body.position[v][d] - body.mesh.position[v][d]) < 1e-12 * 20);
        free_body(&body);
    }
}

/* Leaves of one size fill a block: the weights are products of the kernel, none is rescaled. */
TEST(weights_of_a_lattice_are_the_kernel)
{
    unsigned seed = 3;
    Body body;
    OctTree whole;
    sm_voxels_block(&body.voxels, 16, 16, 16, 1);
    assert_int_equal(oct_tree_build(&body.voxels, 2, (int[3]){0}, &whole, NULL), SM_OK);
    unsigned char *split = sm_alloc((size_t)whole.nodes, 1);
    memset(split, 1, (size_t)whole.level_first[1]);
    oct_tree_prune(&whole, split, &body.tree); /* cells of two finest ones */
    free(split);
    oct_tree_free(&whole);
    oct_graph_build(&body.tree, &body.voxels, &body.graph);
    scatter(&seed, &body.voxels, 500, &body.mesh);
    attach(&body);
    long inner = 0;
    for (long v = 0; v < 500; v++) {
        double least = 16, most = 0, others = 0, own = 1;
        for (int d = 0; d < 3; d++) {
            double X = body.mesh.position[v][d] - body.voxels.origin[d];
            least = fmin(least, X);
            most = fmax(most, X);
            double t = fabs(fmod(X, 2) - 1) / 2;
            own *= 1 - t * t * (3 - 2 * t);
        }
        if (least < 1 || most > 15) continue;
        inner++;
        const SmCsr *rows = &body.surface.rows;
        for (long n = rows->first[v] + 1; n < rows->end[v]; n++)
            others += (double)((const float *)rows->value)[n];
        assert_true(fabs(others + own - 1) < 1e-6);
    }
    assert_true(inner > 100);
    free_body(&body);
}

/* A palm and two fingers on it, a gap of one finest cell between them, the cells 8 wide where there
 * is no gap to keep. */
static void make_fingers(unsigned *seed, Body *body)
{
    OctSampling sampling = {.levels = 3, .criteria_count = 1};
    sampling.criteria[0] = (OctCriterion){.kind = OCT_FEATURES, .level = 3};
    sm_voxels_init(&body->voxels, 31, 56, 10, 0.5);
    for (int k = 0; k < 10; k++)
        for (int j = 0; j < 56; j++)
            for (int i = 0; i < 31; i++)
                if (j < 16 || i != 15) sm_voxel_set(&body->voxels, i, j, k);
    sm_voxels_count(&body->voxels);
    assert_int_equal(oct_sampling_tree(&sampling, &body->voxels, &body->tree, NULL, NULL), SM_OK);
    oct_graph_build(&body->tree, &body->voxels, &body->graph);
    scatter(seed, &body->voxels, 4000, &body->mesh);
    attach(body);
}

/* In finest cells, along axis d. */
static double along(const Body *body, const double at[3], int d)
{
    return (at[d] - body->voxels.origin[d]) / body->voxels.cell;
}

TEST(fingers_move_alone)
{
    unsigned seed = 4;
    Body body;
    make_fingers(&seed, &body);
    move(&body);
    double(*before)[3] = sm_alloc(4000, sizeof *before), (*turned)[3] = sm_alloc(4000, 24);
    memcpy(before, body.position, 4000 * sizeof *before);
    memcpy(turned, body.normal, 4000 * sizeof *turned);
    for (long k = 0; k < body.tree.leaves; k++)
        if (along(&body, body.surface.centre[k], 0) > 15.5 &&
            along(&body, body.surface.centre[k], 1) > 16 + 8)
            body.x[k][2] += 3;
    move(&body);
    long still = 0, moved = 0, near = 0;
    for (long v = 0; v < 4000; v++) {
        const double *X = body.mesh.position[v];
        bool left = along(&body, X, 0) <= 15, beyond = along(&body, X, 1) > 16 + 8;
        if (left) {
            assert_memory_equal(body.position[v], before[v], sizeof before[v]);
            assert_memory_equal(body.normal[v], turned[v], sizeof turned[v]);
        }
        still += left;
        /* within half a cell's width of the other finger */
        near += left && beyond && along(&body, X, 0) > 12;
        moved += !left && beyond && body.position[v][2] > before[v][2] + 1;
    }
    assert_true(still > 1000 && near > 100 && moved > 1000);
    free(before);
    free(turned);
    free_body(&body);
}

/* The largest step between neighbours of `count` vertices along a line through the block. */
static double largest_step(unsigned line, const Body *source, long count)
{
    Body body = *source;
    unsigned seed = line;
    double from[3], to[3], largest = 0;
    for (int d = 0; d < 3; d++) {
        from[d] = body.voxels.origin[d] + 16 * body.voxels.cell * random_unit(&seed);
        to[d] = body.voxels.origin[d] + 16 * body.voxels.cell * random_unit(&seed);
    }
    body.mesh = (SmMesh){.vertex_count = count};
    body.mesh.position = sm_alloc((size_t)count, sizeof *body.mesh.position);
    for (long v = 0; v < count; v++)
        for (int d = 0; d < 3; d++)
            body.mesh.position[v][d] =
                from[d] + (to[d] - from[d]) * (double)v / (double)(count - 1);
    attach(&body);
    memcpy(body.x, source->x, (size_t)body.tree.leaves * sizeof *body.x);
    move(&body);
    for (long v = 1; v < count; v++) {
        double square = 0;
        for (int d = 0; d < 3; d++) square += pow(body.position[v][d] - body.position[v - 1][d], 2);
        largest = fmax(largest, sqrt(square));
    }
    oct_surface_free(&body.surface);
    sm_mesh_free(&body.mesh);
    free(body.x);
    free(body.position);
    free(body.normal);
    return largest;
}

/* A full block of leaves of 1 to 8 cells, each node moved by half a cell at random: eight times
 * shorter steps along a line are eight times shorter on the moved surface, so there is no jump. */
TEST(continuous_across_leaves_of_all_sizes)
{
    for (unsigned seed = 1; seed <= 3; seed++) {
        Body body;
        unsigned random = seed;
        sm_voxels_block(&body.voxels, 16, 16, 16, 0.5);
        random_split_tree(&random, &body.voxels, 3, (int[3]){0}, 0.6, &body.tree);
        oct_graph_build(&body.tree, &body.voxels, &body.graph);
        scatter(&random, &body.voxels, 1, &body.mesh);
        attach(&body);
        for (long k = 0; k < body.tree.leaves; k++)
            for (int d = 0; d < 3; d++) body.x[k][d] += 0.5 * (random_unit(&random) - 0.5);
        for (unsigned line = 1; line <= 3; line++) {
            double coarse = largest_step(line, &body, 1501),
                   fine = largest_step(line, &body, 12001);
            assert_true(fine <= coarse / 8 * 1.1);
        }
        free_body(&body);
    }
}

TEST(any_number_of_threads_gives_the_same_bits)
{
    unsigned seed = 6;
    Body body;
    make_body(&seed, 2, 2000, &body);
    random_deformation(&seed, 0.5, 0.3, body.tree.leaves, (const double(*)[3])body.surface.centre,
                       body.x);
    double(*one)[3] = sm_alloc(2000, sizeof *one);
    int before = omp_get_max_threads();
    omp_set_num_threads(1);
    move(&body);
    memcpy(one, body.position, 2000 * sizeof *one);
    omp_set_num_threads(3);
    oct_surface_free(&body.surface);
    oct_surface_build(&body.mesh, &(OctCarrier){&body.voxels, &body.tree, &body.graph, NULL},
                      &body.surface);
    move(&body);
    omp_set_num_threads(before);
    assert_memory_equal(one, body.position, 2000 * sizeof *one);
    free(one);
    free_body(&body);
}

/* One cell, and a row of them: no neighbours, and neighbours on a line. */
TEST(few_nodes)
{
    for (int cells = 1; cells <= 5; cells += 4) {
        Body body;
        unsigned seed = 7;
        sm_voxels_block(&body.voxels, cells, 1, 1, 2);
        assert_int_equal(oct_tree_build(&body.voxels, 1, (int[3]){0}, &body.tree, NULL), SM_OK);
        oct_graph_build(&body.tree, &body.voxels, &body.graph);
        scatter(&seed, &body.voxels, 50, &body.mesh);
        attach(&body);
        for (long k = 0; k < cells; k++) { /* the row from x to y: the smallest turn is about z */
            double along_row = body.surface.centre[k][0];
            memcpy(body.x[k], body.surface.centre[k], sizeof body.x[k]);
            if (cells > 1) body.x[k][0] = -body.surface.centre[k][1], body.x[k][1] = along_row;
            body.x[k][2] += 7;
        }
        move(&body);
        for (long v = 0; v < 50; v++) {
            const double *X = body.mesh.position[v];
            double to[3] = {cells > 1 ? -X[1] : X[0], cells > 1 ? X[0] : X[1], X[2] + 7};
            for (int d = 0; d < 3; d++) assert_true(fabs(body.position[v][d] - to[d]) < 1e-12);
        }
        memset(body.x, 0, (size_t)cells * sizeof *body.x); /* collapsed */
        move(&body);
        for (long v = 0; v < 50; v++)
            for (int d = 0; d < 3; d++)
                assert_true(fabs(body.position[v][d]) <= 1 && fabs(body.normal[v][d]) <= 1 + 1e-12);
        free_body(&body);
    }
}
