/* Stored bodies: they move as the bodies did that were stored, stiffer and heavier ones, too, held
 * by other handles they follow these; and what is no such file is refused. */
#include "../../lib/shapes/shape.h"
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../lib/voxel/voxelise.h"
#include "engine.h"
#include "stored.h"
#include "test_solver.h"

static const SmEngineType *const type = &ref_meshless_engine;

typedef struct {
    SmMesh mesh;
    SmVoxels voxels;
    RefMeshlessOptions options;
    SmEngineParams params;
    long *low, *high; /* particles of two handles: the lowest and the highest eighth */
    long lows, highs, count;
} Scene;

static Scene scene_create(void)
{
    Scene scene = {.options = {.points = 3000,
                               .nodes = 100,
                               .modes = 40,
                               .material = {.young = 1e6, .poisson = 0.3, .density = 1000}},
                   .params = {.w = 1, .h = 0.01, .damping = 0.02, .gravity = {0, -9.81, 0}}};
    SmVoxelParams solid = {.fill = SM_SOLID, .particles = 400};
    assert_int_equal(sm_shape_mesh("penguin", &scene.mesh, NULL), SM_OK);
    assert_int_equal(sm_voxelise(&scene.mesh, &solid, "penguin", &scene.voxels, NULL), SM_OK);
    scene.count = scene.voxels.particle_count;
    double(*x)[3] = sm_alloc((size_t)scene.count, sizeof *x), least = INFINITY, most = -INFINITY;
    sm_voxels_rest(&scene.voxels, x);
    scene.low = sm_alloc((size_t)scene.count, sizeof *scene.low);
    scene.high = sm_alloc((size_t)scene.count, sizeof *scene.high);
    for (long p = 0; p < scene.count; p++) {
        least = fmin(least, x[p][1]);
        most = fmax(most, x[p][1]);
    }
    for (long p = 0; p < scene.count; p++) {
        double share = (x[p][1] - least) / (most - least);
        if (share < 0.125) scene.low[scene.lows++] = p;
        if (share > 0.875) scene.high[scene.highs++] = p;
    }
    free(x);
    return scene;
}

static void scene_free(Scene *scene)
{
    sm_mesh_free(&scene->mesh);
    sm_voxels_free(&scene->voxels);
    free(scene->low);
    free(scene->high);
}

static SmEngine *create(Scene *scene, const RefStored *stored)
{
    SmEngine *engine;
    SmError error = {0};
    scene->options.mesh = &scene->mesh;
    scene->options.stored = stored;
    scene->params.meshless = &scene->options;
    if (type->create(&scene->voxels, &scene->params, &engine, &error) != SM_OK)
        fail_msg("%s", error.text);
    return engine;
}

/* Holds the lowest particles, and moves the highest, if they are held, to and fro. */
static void bind(SmEngine *engine, const Scene *scene, int handles, double turn)
{
    double c = cos(turn), s = sin(turn);
    SmHandle handle[2] = {
        {.count = scene->lows, .particle = scene->low, .pose = {{1}, {0, 1}, {0, 0, 1}}},
        {.count = scene->highs,
         .particle = scene->high,
         .pose = {{c, -s}, {s, c, 0, 0.02 * turn}, {0, 0, 1}}}};
    SmBoundary boundary = {.handle_count = handles, .handle = handle};
    type->bound(engine, &boundary);
}

static void play(SmEngine *engine, const Scene *scene, int handles, int steps)
{
    for (int step = 1; step <= steps; step++) {
        bind(engine, scene, handles, 0.4 * sin(0.06 * step));
        type->step(engine, NULL);
    }
}

static double (*places(SmEngine *engine, const Scene *scene))[3]
{
    double(*x)[3] = sm_alloc((size_t)scene->count, sizeof *x);
    type->get(engine, SM_POSITION, x);
    return x;
}

/* How far apart particles of two engines are, at most. */
static double apart(SmEngine *a, SmEngine *b, const Scene *scene)
{
    double(*x)[3] = places(a, scene), (*y)[3] = places(b, scene), most = 0;
    for (long p = 0; p < scene->count; p++)
        for (int d = 0; d < 3; d++) {
            assert_true(isfinite(x[p][d]) && isfinite(y[p][d]));
            most = fmax(most, fabs(x[p][d] - y[p][d]));
        }
    free(x);
    free(y);
    return most;
}

/* A body with two handles as bytes, and read again. */
static void store(Scene *scene, SmEngine **engine, RefStored *stored)
{
    RefStored first;
    SmError error = {0};
    size_t size;
    *engine = create(scene, NULL);
    bind(*engine, scene, 2, 0);
    ref_stored_of("a penguin", ref_meshless_elastic(*engine), &first);
    unsigned char *bytes = ref_stored_write(&first, &size);
    if (ref_stored_read(bytes, size, stored, &error) != SM_OK) fail_msg("%s", error.text);
    ref_stored_free(&first);
    free(bytes);
}

TEST(it_moves_as_what_was_stored)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *own, *read;
    RefStored stored;
    store(&scene, &own, &stored);
    assert_string_equal(stored.key, "a penguin");
    read = create(&scene, &stored);
    bind(read, &scene, 2, 0);
    play(own, &scene, 2, 100);
    play(read, &scene, 2, 100);
    double size = ref_meshless_elastic(own)->motion.size, off = apart(own, read, &scene);
    if (!(off < 1e-5 * size)) fail_msg("off by %g of its size", off / size);
    type->destroy(own);
    /* another Young's modulus and density: as a body that is made so */
    scene.options.material.young *= 3;
    scene.options.material.density *= 1.5;
    type->destroy(read);
    own = create(&scene, NULL);
    read = create(&scene, &stored);
    play(own, &scene, 2, 100);
    play(read, &scene, 2, 100);
    off = apart(own, read, &scene);
    if (!(off < 1e-5 * size)) fail_msg("stiffer: off by %g of its size", off / size);
    type->destroy(own);
    type->destroy(read);
    ref_stored_free(&stored);
    scene_free(&scene);
}

/* How far particles have sunk, in the mean. */
static double sunk(SmEngine *engine, const Scene *scene, long count, const long *particle)
{
    double(*x)[3] = places(engine, scene), (*rest)[3] = places(engine, scene), sum = 0;
    type->get(engine, SM_REST, rest);
    for (long p = 0; p < count; p++) sum += rest[particle[p]][1] - x[particle[p]][1];
    free(x);
    free(rest);
    return sum / (double)count;
}

/* Of two handles one lets go: the body sinks as far as one whose modes are sought anew, but for
 * what the choice of points held makes of a hundred nodes. */
TEST(other_handles_bind_what_its_modes_can)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *own, *read;
    RefStored stored;
    store(&scene, &own, &stored);
    read = create(&scene, &stored);
    play(own, &scene, 2, 40);
    play(read, &scene, 2, 40);
    play(own, &scene, 1, 600);
    play(read, &scene, 1, 600);
    double wanted = sunk(own, &scene, scene.highs, scene.high);
    double is = sunk(read, &scene, scene.highs, scene.high);
    assert_true(fabs(sunk(read, &scene, scene.lows, scene.low)) < 1e-3);
    if (!(wanted > 1e-3 && fabs(is / wanted - 1) < 0.2)) fail_msg("%g, not %g", is, wanted);
    type->destroy(own);
    type->destroy(read);
    ref_stored_free(&stored);
    scene_free(&scene);
}

/* Turned far about its foot, a body goes on in another engine where it was, and as fast. */
TEST(motion_goes_on_in_another_engine)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *own, *from, *to;
    RefStored stored;
    store(&scene, &own, &stored);
    from = create(&scene, &stored);
    play(from, &scene, 2, 26);
    scene.options.material.young *= 2;
    to = create(&scene, &stored);
    bind(to, &scene, 2, 0);
    ref_meshless_go_on(to, from);
    double size = ref_meshless_elastic(own)->motion.size, off = apart(from, to, &scene);
    if (!(off < 1e-6 * size)) fail_msg("off by %g of its size", off / size);
    SmEngine *both[] = {own, from, to};
    for (int n = 0; n < 3; n++) type->destroy(both[n]);
    ref_stored_free(&stored);
    scene_free(&scene);
}

TEST(what_is_no_stored_body_is_refused)
{
    needs_solver();
    Scene scene = scene_create();
    SmEngine *engine;
    RefStored stored, again;
    SmError error = {0};
    size_t size;
    store(&scene, &engine, &stored);
    unsigned char *bytes = ref_stored_write(&stored, &size);
    for (size_t end = 0; end < size; end += end < 2000 ? 1 : 997)
        assert_int_equal(ref_stored_read(bytes, end, &again, &error), SM_INPUT);
    for (size_t at = 0; at < size; at += at < 2000 ? 1 : 997) {
        bytes[at] ^= 0x40;
        assert_int_equal(ref_stored_read(bytes, size, &again, &error), SM_INPUT);
        bytes[at] ^= 0x40;
    }
    assert_non_null(strstr(error.text, "damaged"));
    bytes[strlen("shapebench elastic body ")] = '2';
    assert_int_equal(ref_stored_read(bytes, size, &again, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "another version"));
    free(bytes);
    stored.child[0] = stored.octants; /* whole, but wrong */
    bytes = ref_stored_write(&stored, &size);
    assert_int_equal(ref_stored_read(bytes, size, &again, &error), SM_INPUT);
    stored.child[0] = -1;
    free(bytes);
    stored.reach[3] *= 100; /* a cover of many bins */
    bytes = ref_stored_write(&stored, &size);
    assert_int_equal(ref_stored_read(bytes, size, &again, &error), SM_INPUT);
    stored.reach[3] /= 100;
    free(bytes);
    bytes = ref_stored_write(&stored, &size);
    assert_int_equal(ref_stored_read(bytes, size, &again, &error), SM_OK);
    ref_stored_free(&again);
    free(bytes);
    stored.shape[5] = NAN;
    bytes = ref_stored_write(&stored, &size);
    assert_int_equal(ref_stored_read(bytes, size, &again, &error), SM_INPUT);
    free(bytes);
    type->destroy(engine);
    ref_stored_free(&stored);
    scene_free(&scene);
}
