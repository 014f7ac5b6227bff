/* Procedural shapes: closed, of one piece, of the wanted count, recognisable where that can be
 * counted (fingers), and the same every time; the stages beneath them on solids with known sizes.
 */
#include "../system/hash.h"
#include "../test_frame.h"
#include "../voxel/voxelise.h"
#include "decimate.h"
#include "polygonise.h"
#include "shape.h"
#include "sine.h"

static SmMesh shape_mesh[16]; /* as sm_shapes() lists them; some take seconds */

static int make_all(void **state)
{
    (void)state;
    int count;
    SmError error = {0};
    const SmShape *shapes = sm_shapes(&count);
    if (count != sizeof shape_mesh / sizeof *shape_mesh) {
        print_error("%d shapes\n", count);
        return 1;
    }
    for (int s = 0; s < count; s++)
        if (sm_shape_mesh(shapes[s].name, &shape_mesh[s], &error) != SM_OK) {
            print_error("%s: %s\n", shapes[s].name, error.text);
            return 1;
        }
    return 0;
}

static int free_all(void **state)
{
    (void)state;
    for (size_t s = 0; s < sizeof shape_mesh / sizeof *shape_mesh; s++)
        sm_mesh_free(&shape_mesh[s]);
    return 0;
}
TEST_GROUP(make_all, free_all)

static const SmMesh *mesh_of(const char *name)
{
    return &shape_mesh[sm_shape_find(name) - sm_shapes(&(int){0})];
}

static void assert_closed(const SmMesh *mesh)
{
    SmMeshInfo info = sm_mesh_info(mesh);
    assert_int_equal(info.vertices, mesh->vertex_count);
    assert_int_equal(info.triangles, mesh->triangle_count);
    assert_int_equal(info.components, 1);
    assert_int_equal(info.open_edges, 0);
    assert_int_equal(info.nonmanifold_edges, 0);
    assert_int_equal(info.flipped_edges, 0);
    assert_int_equal(info.degenerate, 0);
    assert_int_equal(info.duplicates, 0);
    assert_true(info.watertight);
    assert_true(info.volume > 0);
}

static long euler(const SmMesh *mesh) /* of a closed mesh: 3 triangles = 2 edges */
{
    return mesh->vertex_count - mesh->triangle_count / 2;
}

TEST(test_the_papers_triangle_counts)
{
    assert_int_equal(sm_shape_find("penguin")->triangles, 9874);
    assert_int_equal(sm_shape_find("statue")->triangles, 200000);
    assert_int_equal(sm_shape_find("infant")->triangles, 16844);
}

TEST(test_sizes)
{
    static const struct {
        const char *name;
        int axis;
        double length;
    } wanted[] = {{"penguin", 1, 1.0}, {"statue", 1, 1.98},   {"infant", 1, 0.6},
                  {"hand", 1, 0.19},   {"liver", 0, 0.22},    {"flower", 1, 0.4},
                  {"block", 2, 0.2},   {"beam", 0, 0.8},      {"beam", 1, 0.1},
                  {"beam", 2, 0.1},    {"balljoint", 1, 0.2}, {"rabbit", 1, 0.3},
                  {"santa", 1, 0.3}};
    for (size_t w = 0; w < sizeof wanted / sizeof *wanted; w++) {
        SmMeshInfo info = sm_mesh_info(mesh_of(wanted[w].name));
        int a = wanted[w].axis;
        assert_float_equal(info.high[a] - info.low[a], wanted[w].length, 1e-12);
        assert_float_equal(info.low[1], 0, 1e-12);
    }
    SmMeshInfo info = sm_mesh_info(mesh_of("statue"));
    assert_float_equal(info.high[0] - info.low[0], 0.81, 0.02); /* the Happy Buddha's box */
    assert_float_equal(info.high[2] - info.low[2], 0.81, 0.02);
}

/* Of the lattice's place and material. */
static unsigned long long hash_of_lattice(const SmMesh *mesh, const char *name)
{
    SmVoxels voxels;
    SmVoxelParams params = {.fill = SM_SOLID, .particles = 1000};
    assert_int_equal(sm_voxelise(mesh, &params, name, &voxels, NULL), SM_OK);
    size_t rows = (size_t)voxels.size[1] * (size_t)voxels.size[2];
    unsigned long long hash = sm_hash_bytes(SM_HASH_START, voxels.origin, sizeof voxels.origin);
    hash = sm_hash_bytes(hash, &voxels.cell, sizeof voxels.cell);
    hash = sm_hash_bytes(hash, voxels.bits, rows * (size_t)voxels.words * sizeof *voxels.bits);
    sm_voxels_free(&voxels);
    return hash;
}

static void assert_sound(const SmShape *shape, const SmMesh *mesh)
{
    assert_int_equal(mesh->triangle_count, shape->triangles);
    assert_closed(mesh);
    bool handles = !strcmp(shape->name, "statue") || !strcmp(shape->name, "santa");
    bool bore = !strcmp(shape->name, "rockerarm");
    if (!handles) assert_int_equal(euler(mesh), bore ? 0 : 2);
}

/* The same bits on every machine and from every compiler: else a result from elsewhere is one of
 * another body. Where a shape is changed on purpose, its hashes are, too. */
TEST(test_shapes_are_closed_and_have_the_same_bits_everywhere)
{
    static const struct {
        const char *name;
        unsigned long long mesh, lattice;
    } wanted[] = {
        {"penguin", 0x5bfafb46cb3f61a4, 0xed137f3a8419959},
        {"statue", 0xbdb2bccd96aa77a4, 0xc04acbb78cf04764},
        {"infant", 0xb6c320c0fdcb16f6, 0xe199ba7e49f54ef9},
        {"hand", 0xdff8a458953ee2eb, 0x1d96c287f8ac469d},
        {"liver", 0x6fd694cdfa21a1a7, 0x8b834eb56664b65b},
        {"flower", 0xfd69025b303c89c2, 0xaef705e59325fb0c},
        {"balljoint", 0x3d68da6df65651a9, 0xc2bbc6f97c3af25f},
        {"rabbit", 0x9490ada622026c9a, 0x5daf0416cfd322da},
        {"santa", 0x268943912ca10804, 0xb37188ca30c4fc4a},
        {"rockerarm", 0x98de8db830ed6c87, 0x979d145f9d23a07e},
        {"gargoyle", 0x88afea098ab9dba9, 0x59199799cc0ce0ce},
        {"bunny", 0xff046c24a9783a65, 0x390a54e53a9bef7f},
        {"bust", 0x1bf7db595ee7f824, 0x35328c7b5e2171f0},
        {"block", 0x5fb2af01487556fc, 0xfed019a248a48e27},
        {"beam", 0xf56852dcdcc37bc8, 0x555874870a66497a},
        {"bar", 0x923b81b254f57595, 0xfecb6db755e068d9},
    };
    int count;
    const SmShape *shapes = sm_shapes(&count);
    assert_int_equal(count, sizeof wanted / sizeof *wanted);
    for (int s = 0; s < count; s++) {
        assert_sound(&shapes[s], &shape_mesh[s]);
        unsigned long long found = sm_mesh_hash(&shape_mesh[s]);
        unsigned long long lattice = hash_of_lattice(&shape_mesh[s], shapes[s].name);
        assert_string_equal(wanted[s].name, shapes[s].name);
        if (found != wanted[s].mesh || lattice != wanted[s].lattice)
            fail_msg("%s: mesh 0x%llx, lattice 0x%llx", wanted[s].name, found, lattice);
    }
}

TEST(test_sines_are_exact_to_their_last_bit)
{
    for (int n = -3000; n <= 3000; n++) {
        double angle = n < 0 ? 0.0021 * n : 333.3 * n;
        assert_float_equal(sm_sin(angle), sin(angle), 2.3e-16);
        assert_float_equal(sm_cos(angle), cos(angle), 2.3e-16);
    }
    assert_true(sm_sin(0) == 0 && sm_cos(0) == 1);
}

/* Pieces of the part of the mesh above y (by labels spread over triangles until nothing changes):
 * each is one cross section of a shape that only narrows upwards. */
static int pieces_above(const SmMesh *mesh, double y)
{
    int *label = malloc((size_t)mesh->vertex_count * sizeof *label), pieces = 0;
    for (long v = 0; v < mesh->vertex_count; v++) label[v] = mesh->position[v][1] > y ? (int)v : -1;
    for (int changed = 1; changed;) {
        changed = 0;
        for (long t = 0; t < mesh->triangle_count; t++)
            for (int k = 0; k < 6; k++) {
                int a = mesh->triangle[t][k % 3], b = mesh->triangle[t][(k + 1 + k / 3) % 3];
                if (label[a] < 0 || label[b] <= label[a]) continue;
                label[b] = label[a];
                changed = 1;
            }
    }
    for (long v = 0; v < mesh->vertex_count; v++) pieces += label[v] == v;
    free(label);
    return pieces;
}

TEST(test_fingers_are_separate)
{
    const SmMesh *hand = mesh_of("hand");
    SmMeshInfo info = sm_mesh_info(hand);
    double top = info.high[1];
    assert_int_equal(pieces_above(hand, 0.97 * top), 1); /* the middle finger alone */
    assert_int_equal(pieces_above(hand, 0.72 * top), 4);
    assert_int_equal(pieces_above(hand, 0.60 * top), 2); /* palm and thumb */
    assert_int_equal(pieces_above(hand, 0.10 * top), 1);
}

TEST(test_unknown_name)
{
    SmMesh mesh;
    SmError error;
    assert_null(sm_shape_find("teapot"));
    assert_int_equal(sm_shape_mesh("teapot", &mesh, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "teapot: no such shape; there are penguin, "));
    assert_non_null(strstr(error.text, ", beam and bar"));
    assert_null(mesh.position);
}

static SmMesh ball_mesh(double cell)
{
    SmImplicit solid = {0};
    SmMesh mesh;
    SmPrimitive ball =
        sm_primitive(SM_ELLIPSOID, 0, (double[]){0.1, 0.2, 0.3}, (double[]){1, 1, 1});
    sm_implicit_add(&solid, &ball);
    sm_polygonise(&solid, &(SmBox){{-1, -0.9, -0.8}, {1.2, 1.3, 1.4}}, cell, &mesh);
    sm_implicit_free(&solid);
    return mesh;
}

TEST(test_polygonised_ball)
{
    SmMesh mesh = ball_mesh(0.1);
    SmMeshInfo info = sm_mesh_info(&mesh);
    assert_true(info.watertight);
    assert_int_equal(info.flipped_edges, 0);
    assert_int_equal(euler(&mesh), 2);
    assert_float_equal(info.volume, 4.0 / 3 * M_PI, 0.02 * 4);
    for (long v = 0; v < mesh.vertex_count; v++) {
        double *p = mesh.position[v], x = p[0] - 0.1, y = p[1] - 0.2, z = p[2] - 0.3;
        assert_float_equal(sqrt(x * x + y * y + z * z), 1, 1e-4);
    }
    sm_mesh_free(&mesh);
}

TEST(test_decimation_keeps_shape_and_topology)
{
    SmMesh mesh = ball_mesh(0.05);
    sm_decimate(&mesh, 1000);
    assert_int_equal(mesh.triangle_count, 1000);
    assert_closed(&mesh);
    assert_int_equal(euler(&mesh), 2);
    assert_float_equal(sm_mesh_info(&mesh).volume, 4.0 / 3 * M_PI, 0.02 * 4);
    sm_decimate(&mesh, 0); /* stops where the link condition does */
    assert_closed(&mesh);
    assert_true(mesh.triangle_count >= 4);
    sm_mesh_free(&mesh);
}

/* The distance functions against a search over the surface, in all sorts of directions. */
TEST(test_ellipsoid_is_a_distance)
{
    SmImplicit solid = {0};
    double r[3] = {0.5, 0.04, 0.2};
    SmPrimitive egg = sm_primitive(SM_ELLIPSOID, 0, (double[]){0, 0, 0}, r);
    sm_implicit_add(&solid, &egg);
    int all = 0;
    for (int n = 0; n < 40; n++) {
        double p[3] = {0.7 * sin(3.7 * n), 0.3 * sin(1.9 * n + 1), 0.5 * sin(2.3 * n + 2)};
        double least = 1e9, k0 = 0;
        for (int i = 0; i < 400; i++)
            for (int j = 0; j < 400; j++) {
                double a = M_PI * i / 400, b = 2 * M_PI * j / 400;
                double d[3] = {p[0] - r[0] * sin(a) * cos(b), p[1] - r[1] * cos(a),
                               p[2] - r[2] * sin(a) * sin(b)};
                least = fmin(least, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            }
        for (int i = 0; i < 3; i++) k0 += p[i] * p[i] / (r[i] * r[i]);
        double wanted = k0 < 1 ? -sqrt(least) : sqrt(least);
        assert_float_equal(sm_implicit_at(&solid, &all, 1, p), wanted, 2e-3);
    }
    sm_implicit_free(&solid);
}

TEST(test_pruning_changes_no_bit)
{
    SmImplicit solid = {0};
    int active[60], kept[60], kept_count;
    for (int i = 0; i < 60; i++) {
        SmPrimitive made =
            sm_primitive((SmPrimitiveKind)(i % 6), 0.05 + 0.01 * (i % 5),
                         (double[]){sin(2.1 * i), sin(3.3 * i), sin(4.7 * i)},
                         (double[]){0.2, i % 6 == SM_RING || i % 6 == SM_PETAL ? 0.05 : 0.15, 0.3});
        made.tip[0] = sin(5.1 * i);
        made.rounding = 0.02;
        made.cut = i % 12 == 8;
        made.chain = i >= 30 && i < 36 ? 7 : 0;
        if (made.chain) made.blend = 0.08, made.cut = 0;
        sm_primitive_turn(&made, i % 3, 0.7 * i);
        sm_implicit_add(&solid, &made);
        active[i] = i;
    }
    long saved = 0;
    for (int n = 0; n < 200; n++) {
        double c[3] = {1.2 * sin(1.7 * n), 1.2 * sin(2.9 * n), 1.2 * sin(4.3 * n)}, radius = 0.1;
        sm_implicit_prune(&solid, active, 60, c, radius, kept, &kept_count);
        saved += 60 - kept_count;
        for (int m = 0; m < 20; m++) {
            double p[3];
            for (int i = 0; i < 3; i++) p[i] = c[i] + radius * sin(13.0 * m + 2 * i) / sqrt(3);
            double whole = sm_implicit_at(&solid, active, 60, p);
            double pruned = sm_implicit_at(&solid, kept, kept_count, p);
            assert_memory_equal(&whole, &pruned, sizeof whole);
        }
    }
    assert_true(saved > 200 * 30); /* most do not matter in a small ball */
    sm_implicit_free(&solid);
}
