/* A surface brought up to date after every change against one built from scratch; and which side of
 * a cut vertices follow. */
#include "../../lib/cut/cut_surface.h"
#include "../../lib/mesh/test_volumes.h"
#include "../../lib/shapes/shape.h"
#include "../../lib/test_frame.h"
#include "../../lib/test_piece_sums.h"
#include "../change/structure.h"
#include "../tree/test_trees.h"
#include "surface.h"

enum { SEQUENCES = 50, BATCHES = 6, FIRST_VERTICES = 150 };

static OctCarrier carrier(const OctStructure *s)
{
    return (OctCarrier){&s->voxels, &s->tree, &s->graph, &s->cut};
}

/* More vertices about the body, in triangles of any three. */
static void add_vertices(unsigned *seed, const OctStructure *s, long count, SmMesh *mesh)
{
    long from = mesh->vertex_count, to = from + count;
    mesh->position = sm_realloc(mesh->position, (size_t)to, sizeof *mesh->position);
    mesh->triangle = sm_realloc(mesh->triangle, (size_t)to, sizeof *mesh->triangle);
    for (long v = from; v < to; v++)
        for (int d = 0; d < 3; d++)
            mesh->position[v][d] =
                s->origin[d] + s->cell * (random_unit(seed) * 1.2 - 0.1) * s->voxels.size[d];
    for (long n = 0; n < count; n++, mesh->triangle_count++)
        for (int i = 0; i < 3; i++)
            mesh->triangle[mesh->triangle_count][i] = random_int(seed, (int)to);
    mesh->vertex_count = to;
}

static void random_structure(unsigned *seed, int trial, OctStructure *s)
{
    SmVoxels voxels;
    OctTree tree;
    OctOptions options = {.width.edges = 1};
    random_small_tree(seed, trial, 150, &voxels, &tree);
    assert_int_equal(oct_structure_of_tree(&voxels, &options, NULL, &tree, NULL, s, NULL), SM_OK);
    sm_voxels_free(&voxels);
}

static void random_change(unsigned *seed, OctStructure *s)
{
    int node = random_int(seed, (int)s->tree.nodes), kind = random_int(seed, 4);
    if (kind == 0) {
        for (int i = 0; i < 3; i++) {
            double at[3];
            for (int d = 0; d < 3; d++)
                at[d] = s->origin[d] + s->cell * random_unit(seed) * s->voxels.size[d];
            sm_cut_vertex(&s->cut, at);
        }
        int last = (int)s->cut.vertices - 1;
        sm_cut_triangle(&s->cut, (int[3]){last, last - 1, last - 2});
    } else if (kind < 3) {
        oct_resample_split(s, node, NULL);
        if (kind == 1 && s->tree.children[node] > 0) /* the last one twice over */
            oct_resample_split(s, s->tree.child[node] + s->tree.children[node] - 1, NULL);
    } else {
        oct_resample_merge(s, node, NULL);
    }
}

static long row_length(const SmCsr *rows, long row)
{
    return rows->end[row] - rows->first[row];
}

static void assert_same(const OctSurface *s, const OctSurface *want)
{
    const OctGradients *g = &s->gradients, *w = &want->gradients;
    assert_int_equal(s->vertices, want->vertices);
    assert_int_equal(g->count, w->count);
    assert_int_equal(g->flats, w->flats);
    for (long v = 0; v < s->vertices; v++) {
        size_t count = (size_t)row_length(&s->rows, v);
        assert_int_equal(count, row_length(&want->rows, v));
        assert_memory_equal(s->rows.item + s->rows.first[v], want->rows.item + want->rows.first[v],
                            count * sizeof(int));
        assert_memory_equal((float *)s->rows.value + s->rows.first[v],
                            (float *)want->rows.value + want->rows.first[v], count * sizeof(float));
        assert_memory_equal(s->normal[v], want->normal[v], sizeof s->normal[v]);
    }
    for (long n = 0; n < w->count; n++) {
        int k = w->leaf[n];
        assert_true(g->place[k] >= 0 && g->leaf[g->place[k]] == k);
        assert_int_equal(s->users[k], want->users[k]);
        assert_memory_equal(s->centre[k], want->centre[k], sizeof s->centre[k]);
        assert_int_equal(row_length(&g->rows, k), row_length(&w->rows, k));
        assert_memory_equal(g->rows.item + g->rows.first[k], w->rows.item + w->rows.first[k],
                            (size_t)row_length(&w->rows, k) * sizeof(int));
        assert_int_equal(g->span[k], w->span[k]);
        assert_int_equal(g->flat_place[k] < 0, w->flat_place[k] < 0);
    }
}

static void update(OctSurface *surface, const SmMesh *mesh, const OctStructure *s,
                   const OctChange *change, long first)
{
    OctCarrier c = carrier(s);
    long count = 0;
    int *node = sm_alloc((size_t)(change->added_count + change->removed_count), sizeof *node);
    for (long n = 0; n < change->added_count; n++) node[count++] = change->added[n].node;
    for (long n = 0; n < change->removed_count; n++) node[count++] = change->removed[n].node;
    oct_surface_update(surface, mesh, &c, count, node, first);
    free(node);
}

TEST(tied_anew_is_tied_from_scratch)
{
    unsigned seed = 5;
    for (int trial = 0; trial < SEQUENCES; trial++) {
        OctStructure s;
        SmMesh mesh = {0};
        OctSurface surface, want;
        random_structure(&seed, trial, &s);
        add_vertices(&seed, &s, FIRST_VERTICES, &mesh);
        OctCarrier c = carrier(&s);
        oct_surface_build(&mesh, &c, &surface);
        for (int batch = 0; batch < BATCHES; batch++) {
            long first = s.cut.triangles;
            for (int n = random_int(&seed, 4); n >= 0; n--) random_change(&seed, &s);
            const OctChange *change = oct_resample_update(&s);
            if (batch % 2) add_vertices(&seed, &s, 20, &mesh);
            update(&surface, &mesh, &s, change, first);
            oct_surface_build(&mesh, &c, &want);
            assert_same(&surface, &want);
            oct_surface_free(&want);
        }
        double(*x)[3] = surface.centre, (*position)[3];
        position = sm_alloc((size_t)mesh.vertex_count, sizeof *position);
        oct_surface_move(&surface, (const double(*)[3])x, position, NULL);
        for (long v = 0; v < mesh.vertex_count; v++)
            for (int d = 0; d < 3; d++)
                assert_true(fabs(position[v][d] - mesh.position[v][d]) < 1e-9);
        free(position);
        oct_surface_free(&surface);
        sm_mesh_free(&mesh);
        oct_structure_free(&s);
    }
}

/* A block of 8 finest cells, whose surface is its box. */
static SmMesh box(double side)
{
    static const int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    SmMesh mesh = sm_mesh_new(8, 12);
    for (int i = 0; i < 24; i++) mesh.position[i / 3][i % 3] = side * (i / 3 >> i % 3 & 1);
    for (int t = 0; t < 12; t++)
        for (int i = 0; i < 3; i++) mesh.triangle[t][i] = face[t / 2][i == 0 ? 0 : t % 2 + i];
    return mesh;
}

/* Splits the leaves near the cut's triangles down to the finest cells. */
static void refine(OctStructure *s)
{
    const int *node;
    for (long count; (count = oct_resample_near_cut(s, 0, 1, s->tree.levels, &node)) > 0;) {
        int *list = sm_alloc((size_t)count, sizeof *list);
        memcpy(list, node, (size_t)count * sizeof *list);
        for (long n = 0; n < count; n++)
            assert_int_equal(oct_resample_split(s, list[n], NULL), SM_OK);
        free(list);
    }
}

/* Two triangles right through the block, z = level + tilt (x - 8). */
static void add_plane(SmCut *cut, double level, double tilt)
{
    for (int n = 0; n < 4; n++) {
        double x = n % 2 ? 18 : -2, y = n / 2 ? 18 : -2;
        sm_cut_vertex(cut, (double[3]){x, y, level + tilt * (x - 8)});
    }
    sm_cut_triangle(cut, (int[3]){0, 1, 3});
    sm_cut_triangle(cut, (int[3]){0, 3, 2});
}

/* Moves the nodes above the plane up by 10, and with them every vertex above it, exactly. */
static void part(OctSurface *surface, const OctTree *tree, double level, double tilt)
{
    double(*x)[3] = sm_alloc((size_t)tree->leaves, sizeof *x);
    double(*position)[3] = sm_alloc((size_t)surface->vertices, sizeof *position);
    long moved = 0;
    for (long k = 0; k < tree->leaves; k++) {
        const double *X = surface->centre[k];
        if (tree->node[k] < 0) continue;
        memcpy(x[k], X, sizeof x[k]);
        x[k][2] += X[2] > level + tilt * (X[0] - 8) ? 10 : 0;
    }
    oct_surface_move(surface, (const double(*)[3])x, position, NULL);
    for (long v = 0; v < surface->vertices; v++) {
        const double *X = surface->rest[v];
        double up = X[2] > level + tilt * (X[0] - 8) ? 10 : 0;
        moved += up > 0;
        assert_true(fabs(position[v][2] - X[2] - up) < 1e-9);
    }
    assert_true(moved > 4 && moved < surface->vertices - 4);
    free(x);
    free(position);
}

/* Two pieces, of nodes and of surface: every triangle follows the piece on its side, and the
 * pieces' masses and volumes add up to the block's. */
static void count_pieces(const OctStructure *s, const OctSurface *surface, const SmMesh *mesh,
                         double level, double tilt)
{
    SmPieces nodes, parts;
    double mass[2], volume[2];
    int *piece = sm_alloc((size_t)mesh->triangle_count, sizeof *piece), below = -1;
    oct_graph_pieces(&s->tree, &s->graph, &nodes);
    sm_mesh_pieces(mesh, &parts);
    assert_int_equal(nodes.count, 2);
    assert_int_equal(parts.count, 2);
    for (long k = 0; k < s->tree.leaves; k++) {
        const double *X = surface->centre[k];
        if (s->tree.node[k] < 0) continue;
        bool up = X[2] > level + tilt * (X[0] - 8);
        if (below < 0) below = up ? 1 - nodes.piece[k] : nodes.piece[k];
        assert_int_equal(nodes.piece[k] == below, !up);
    }
    for (long t = 0; t < mesh->triangle_count; t++) {
        int leaf = surface->rows.item[surface->rows.first[mesh->triangle[t][0]]];
        piece[t] = nodes.piece[leaf];
        double height = 0;
        for (int i = 0; i < 3; i++) {
            const double *X = mesh->position[mesh->triangle[t][i]];
            height += X[2] - level - tilt * (X[0] - 8);
        }
        assert_int_equal(piece[t] == below, height < 0);
        assert_int_equal(parts.piece[t] == parts.piece[0], piece[t] == piece[0]);
    }
    sum_pieces(&nodes, s->tree.leaves, s->mass, mass);
    sum_volumes(mesh, &parts, volume);
    assert_true(fabs(mass[0] + mass[1] - 4096) < 1e-9);
    assert_true(fabs(volume[0] + volume[1] - 4096) < 0.05);
    double under = volume[parts.piece[0] == 0 && piece[0] == below ? 0 : 1];
    assert_true(fabs(under - 256 * level) < 0.05 || tilt != 0);
    free(piece);
    sm_pieces_free(&nodes);
    sm_pieces_free(&parts);
}

/* A plane somewhere through a block of large and small leaves, often through the middle of cells:
 * one half moves away, and every vertex goes or stays with its own half. */
TEST(both_sides_of_a_cut_follow_their_own)
{
    for (unsigned trial = 1; trial <= 40; trial++) {
        unsigned seed = trial;
        SmVoxels voxels;
        OctTree tree;
        OctStructure s;
        OctSurface surface;
        OctOptions options = {.width.edges = 1};
        SmMesh mesh = box(16);
        double tilt = trial % 2 ? 0 : random_unit(&seed) - 0.5, level = 4 + 8 * random_unit(&seed);
        sm_voxels_block(&voxels, 16, 16, 16, 1);
        for (int d = 0; d < 3; d++) voxels.origin[d] = 0;
        random_split_tree(&seed, &voxels, 3, (int[3]){0}, 0.3, &tree);
        assert_int_equal(oct_structure_of_tree(&voxels, &options, NULL, &tree, NULL, &s, NULL),
                         SM_OK);
        OctCarrier c = carrier(&s);
        oct_surface_build(&mesh, &c, &surface);
        add_plane(&s.cut, level, tilt);
        refine(&s);
        assert_int_equal(sm_cut_surface(&mesh, &s.cut, 0, 1), SM_CUT_CLOSED);
        update(&surface, &mesh, &s, oct_resample_update(&s), 0);
        part(&surface, &s.tree, level, tilt);
        count_pieces(&s, &surface, &mesh, level, tilt);
        oct_surface_free(&surface);
        oct_structure_free(&s);
        sm_voxels_free(&voxels);
        sm_mesh_free(&mesh);
    }
}

/* A block's fine surface in the box from 0 to 16. */
static SmMesh fine_box(void)
{
    SmMesh mesh;
    assert_int_equal(sm_shape_mesh("block", &mesh, NULL), SM_OK);
    SmMeshInfo info = sm_mesh_info(&mesh);
    for (long v = 0; v < mesh.vertex_count; v++)
        for (int d = 0; d < 3; d++)
            mesh.position[v][d] =
                16 * (mesh.position[v][d] - info.low[d]) / (info.high[d] - info.low[d]);
    return mesh;
}

/* Makes a vertex follow the leaf of another. */
static void mislead(OctSurface *s, long v, long as)
{
    int leaf = s->rows.item[s->rows.first[as]];
    for (long n = s->rows.first[v]; n < s->rows.end[v]; n++) s->users[s->rows.item[n]]--;
    sm_csr_set(&s->rows, v, 1, &leaf);
    ((float *)s->rows.value)[s->rows.first[v]] = 0;
    s->users[leaf]++;
}

/* Some vertices next to a cut follow the other side: they come back, and no others move. */
TEST(a_few_on_the_wrong_side_go_with_the_many)
{
    OctStructure s;
    OctSurface surface;
    OctTree tree;
    SmVoxels voxels;
    unsigned seed = 3;
    OctOptions options = {.width.edges = 1};
    SmMesh mesh = fine_box();
    double level = 7.8;
    sm_voxels_block(&voxels, 16, 16, 16, 1);
    random_split_tree(&seed, &voxels, 3, (int[3]){0}, 0.3, &tree);
    assert_int_equal(oct_structure_of_tree(&voxels, &options, NULL, &tree, NULL, &s, NULL), SM_OK);
    OctCarrier c = carrier(&s);
    oct_surface_build(&mesh, &c, &surface);
    add_plane(&s.cut, level, 0);
    refine(&s);
    assert_int_equal(sm_cut_surface(&mesh, &s.cut, 0, 1), SM_CUT_CLOSED);
    update(&surface, &mesh, &s, oct_resample_update(&s), 0);
    assert_int_equal(oct_surface_agree(&surface, &mesh, &c), 0);
    long misled = 0, below = 0;
    while (surface.rest[below][2] > level - 1 || surface.rest[below][2] < level - 3) below++;
    for (long v = 0; v < surface.vertices && misled < 10; v++)
        if (surface.rest[v][2] > level && surface.rest[v][2] < level + 2 &&
            random_int(&seed, 3) == 0) {
            mislead(&surface, v, below);
            misled++;
        }
    assert_int_equal(misled, 10);
    assert_in_range(oct_surface_agree(&surface, &mesh, &c), 1, 10);
    part(&surface, &s.tree, level, 0);
    oct_surface_free(&surface);
    oct_structure_free(&s);
    sm_voxels_free(&voxels);
    sm_mesh_free(&mesh);
}
