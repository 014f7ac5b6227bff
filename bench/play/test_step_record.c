#include <sys/wait.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"
#include "../../lib/voxel/test_bodies.h"
#include "../../reference/brute.h"
#include "../store/h5.h"
#include "trajectory.h"

/* Steps of the brute-force engine and of the octree in C, recomputed from the file alone by
 * scripts/brute_force.py. */

enum { STEPS = 3, NEXT = STEPS + 1 };

static const char *path; /* no other is asked of path_in() */

static int make_file_name(void **state)
{
    if (make_folder(state)) return -1;
    path = path_in("steps.h5");
    return 0;
}

/* An L one cell thick: regions are no boxes. */
static void make_lattice(SmVoxels *voxels)
{
    sm_voxels_init(voxels, 4, 3, 1, 0.25);
    voxels->origin[0] = 10;
    voxels->origin[2] = -3;
    for (int i = 0; i < 4; i++) sm_voxel_set(voxels, i, 0, 0);
    for (int j = 0; j < 3; j++) sm_voxel_set(voxels, 0, j, 0);
    sm_voxels_count(voxels);
}

/* Uniform in -1..1, the same every time. */
static void disturb(const SmEngineType *type, SmEngine *engine, long count, double cell)
{
    unsigned seed = 7;
    double(*field)[3] = sm_alloc((size_t)count, sizeof *field);
    type->get(engine, SM_POSITION, field);
    for (long p = 0; p < count; p++)
        for (int a = 0; a < 3; a++) field[p][a] += 0.2 * cell * random_between(&seed, -1, 1);
    type->set(engine, SM_POSITION, (const double(*)[3])field);
    for (long p = 0; p < count; p++)
        for (int a = 0; a < 3; a++) field[p][a] = 3 * cell * random_between(&seed, -1, 1);
    type->set(engine, SM_VELOCITY, (const double(*)[3])field);
    free(field);
}

/* Records STEPS steps of the engine and the state after them. */
static void record(const SmEngineType *type, BenchTrajectoryParams *params)
{
    SmEngine *engine;
    BenchTrajectory *trajectory;
    SmError error = {0};
    SmCounts counts;
    if (type->create(params->steps.voxels, params->steps.params, &engine, &error) != SM_OK)
        fail_msg("%s", error.text);
    if (params->steps.record == BENCH_RECORD_NODES)
        params->steps.structure = oct_engine_structure(engine);
    params->steps.engine = type->name;
    params->steps.precision = type->precision;
    type->count(engine, &counts);
    long count = counts.particles;
    double(*x)[3] = sm_alloc((size_t)count, sizeof *x),
    (*v)[3] = sm_alloc((size_t)count, sizeof *v);
    double(*g)[3] = sm_alloc((size_t)count, sizeof *g),
    (*S)[9] = sm_alloc((size_t)count, sizeof *S);
    if (params->steps.boundary) type->bound(engine, params->steps.boundary);
    disturb(type, engine, count, params->steps.voxels->cell);
    if (bench_trajectory_open(params, &trajectory, &error) != SM_OK) fail_msg("%s", error.text);
    for (long step = 0; step <= STEPS; step++) {
        type->get(engine, SM_POSITION, x);
        type->get(engine, SM_VELOCITY, v);
        type->goals(engine);
        type->get(engine, SM_GOAL, g);
        if (type->get_shapes) type->get_shapes(engine, S);
        if (step < STEPS) type->step(engine, NULL);
        assert_int_equal(bench_trajectory_step(trajectory, step, (const double(*)[3])x,
                                               (const double(*)[3])v,
                                               step < STEPS ? (const double(*)[3])g : NULL,
                                               (const double(*)[9])S, &error),
                         SM_OK);
    }
    if (bench_trajectory_close(trajectory, "0123456789abcdef", &error) != SM_OK)
        fail_msg("%s", error.text);
    type->destroy(engine);
    free(x);
    free(v);
    free(g);
    free(S);
}

/* Records the L with the given parameters; writes the file at `path`. */
static void record_lattice(SmEngineParams *engine, const SmBoundary *boundary, bool masses)
{
    static BenchMachine machine;
    SmVoxels voxels;
    const SmMesh none = {0};
    make_lattice(&voxels);
    double *mass = sm_alloc((size_t)voxels.particle_count, sizeof *mass);
    for (long p = 0; p < voxels.particle_count; p++) mass[p] = 1 + 0.5 * (double)(p % 5);
    if (masses) engine->mass = mass;
    bench_machine_read(0, NULL, 1, &machine);
    BenchTrajectoryParams params = {.path = path,
                                    .surface = &none,
                                    .machine = &machine,
                                    .scene = "L",
                                    .steps = {.record = BENCH_RECORD_PARTICLES,
                                              .voxels = &voxels,
                                              .params = engine,
                                              .mass = engine->mass,
                                              .boundary = boundary}};
    record(&ref_brute_engine, &params);
    free(mass);
    sm_voxels_free(&voxels);
}

/* The script's exit code on the file; skips the test where Python or h5py is missing. */
static int check_file(void)
{
    static bool found; /* asked once */
    char command[256];
    if (!found) needs_python("h5py, numpy");
    found = true;
    fflush(NULL);
    snprintf(command, sizeof command, "/usr/bin/python3 '%s/scripts/brute_force.py' %s", SOURCE_DIR,
             path);
    int status = system(command);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

TEST(free_body)
{
    SmEngineParams params = {.w = 1, .h = 0.01, .gravity = {0, -9.81, 0}, .threads = 1};
    record_lattice(&params, NULL, false);
    assert_int_equal(check_file(), 0);
}

TEST(damped_masses_and_instances)
{
    static const double pose[2][3][4] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                         {{0, -1, 0, 5}, {1, 0, 0, 0}, {0, 0, 1, 2}}};
    SmEngineParams params = {.w = 2,
                             .h = 0.02,
                             .damping = 0.4,
                             .damping_every = 2,
                             .instances = 2,
                             .instance_pose = pose,
                             .threads = 1};
    record_lattice(&params, NULL, true);
    assert_int_equal(check_file(), 0);
}

TEST(held_and_obstructed)
{
    static const long particle[] = {0, 1, 2};
    const SmHandle pin = {3, particle, {{1, 0, 0, 0.01}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const SmObstacle plane = {SM_PLANE, {0, 0.2, 0}, {0, 1, 0}, 0, 0.5};
    const SmBoundary boundary = {1, &pin, 1, &plane};
    SmEngineParams params = {
        .w = 1, .h = 0.01, .damping = 0.5, .gravity = {0, -9.81, 0}, .threads = 1};
    record_lattice(&params, &boundary, true);
    assert_int_equal(check_file(), 0);
}

/* Features and a fine corner; each node's own width and, in half of the body, a wider one. */
static void choose_octree(const SmVoxels *voxels, OctOptions *options)
{
    options->epsilon = 0.5;
    options->sampling = (OctSampling){.levels = 2, .criteria_count = 2};
    options->sampling.criteria[0] = (OctCriterion){.kind = OCT_FEATURES};
    options->sampling.criteria[1] = (OctCriterion){.kind = OCT_SPHERE, .radius = 6 * voxels->cell};
    options->local_count = 1;
    options->local[0] = (OctLocalWidth){.width = {.cells = 3, .edges = 1}};
    for (int d = 0; d < 3; d++) {
        options->sampling.criteria[1].centre[d] = voxels->origin[d];
        options->local[0].low[d] = voxels->origin[d] - 4 * voxels->cell;
        options->local[0].high[d] =
            voxels->origin[d] + (d ? 20 : 0.5 * voxels->size[0]) * voxels->cell;
    }
}

/* Records a body of kind `kind` (lib/voxel/test_bodies.h) in an octree engine. */
static void record_octree(const SmEngineType *type, int kind, SmEngineParams *engine,
                          OctOptions *options, const SmBoundary *boundary)
{
    static BenchMachine machine;
    SmVoxels voxels;
    const SmMesh none = {0};
    unsigned seed = 5;
    random_body(&seed, kind, 12, &voxels);
    choose_octree(&voxels, options);
    engine->octree = options;
    bench_machine_read(0, NULL, 1, &machine);
    BenchTrajectoryParams params = {.path = path,
                                    .surface = &none,
                                    .machine = &machine,
                                    .scene = "octree",
                                    .steps = {.record = BENCH_RECORD_NODES,
                                              .voxels = &voxels,
                                              .params = engine,
                                              .boundary = boundary}};
    record(type, &params);
    sm_voxels_free(&voxels);
}

TEST(octrees)
{
    static const double pose[2][3][4] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                         {{0, -1, 0, 5}, {1, 0, 0, 0}, {0, 0, 1, 2}}};
    OctOptions options = {0};
    for (int kind = 1; kind < 5; kind++) {
        SmEngineParams params = {.h = 0.01,
                                 .damping = 0.3,
                                 .damping_every = 1 + kind % 2,
                                 .gravity = {0, -9.81, 0},
                                 .instances = 2,
                                 .instance_pose = pose,
                                 .threads = 1};
        options.weighting = kind % 2 ? OCT_PLAIN : OCT_CONSERVING;
        options.form = kind % 3 ? OCT_HIERARCHICAL : OCT_ADJOINT;
        options.masses = (OctMassRule)(kind / 2 % 2);
        options.symmetry = (OctSymmetry)(kind % 3);
        if (options.symmetry == OCT_ASYMMETRIC) options.form = OCT_ADJOINT;
        record_octree(&octree_engine_f64, kind, &params, &options, NULL);
        assert_int_equal(check_file(), 0);
    }
}

TEST(octree_held_in_single_precision)
{
    static const long particle[] = {0, 1, 2};
    const SmHandle pin = {3, particle, {{1, 0, 0, 0.01}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const SmObstacle plane = {SM_PLANE, {0, 0.2, 0}, {0, 1, 0}, 0, 0.5};
    const SmBoundary boundary = {1, &pin, 1, &plane};
    OctOptions options = {0};
    SmEngineParams params = {.h = 0.01, .damping = 0.2, .threads = 1};
    record_octree(&octree_engine_f32, 2, &params, &options, &boundary);
    assert_int_equal(check_file(), 0);
}

TEST(a_lattice_has_its_cells_along_every_axis)
{
    int size[3] = {0};
    SmEngineParams params = {.w = 2, .h = 0.01, .threads = 1};
    record_lattice(&params, NULL, false);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t size_of = H5Aopen_by_name(file, "particles", "size", H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Aget_space(size_of);
    assert_int_equal(H5Sget_simple_extent_npoints(space), 3);
    assert_true(H5Aread(size_of, H5T_NATIVE_INT, size) >= 0);
    assert_true(size[0] > 0 && size[1] > 0 && size[2] > 0);
    H5Sclose(space);
    H5Aclose(size_of);
    H5Fclose(file);
}

/* Adds `amount` to one number of a dataset of vectors of every particle and record. */
static void corrupt(const char *name, int record_number, double amount)
{
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    hsize_t point[] = {(hsize_t)record_number, 5, 1}, one = 1;
    H5Sselect_elements(space, H5S_SELECT_SET, 1, point);
    hid_t single = H5Screate_simple(1, &one, NULL);
    double value = NAN;
    assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, single, space, H5P_DEFAULT, &value) >= 0);
    value += amount;
    assert_true(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, single, space, H5P_DEFAULT, &value) >= 0);
    H5Sclose(single);
    H5Sclose(space);
    H5Dclose(dataset);
    H5Fclose(file);
}

/* Adds `amount` to the first whole number in row `at` of a list. */
static void corrupt_whole(const char *name, hsize_t at, int amount)
{
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    hsize_t one = 1, first[] = {at, 0};
    hid_t single = H5Screate_simple(1, &one, NULL);
    int value = 0;
    H5Sselect_elements(space, H5S_SELECT_SET, 1, first);
    assert_true(H5Dread(dataset, H5T_NATIVE_INT, single, space, H5P_DEFAULT, &value) >= 0);
    value += amount;
    assert_true(H5Dwrite(dataset, H5T_NATIVE_INT, single, space, H5P_DEFAULT, &value) >= 0);
    H5Sclose(single);
    H5Sclose(space);
    H5Dclose(dataset);
    H5Fclose(file);
}

/* Regions that are not those of their widths, distances and tree. */
TEST(octree_corrupted)
{
    OctOptions options = {0};
    SmEngineParams params = {.h = 0.01, .threads = 1};
    static const struct {
        const char *name;
        int amount;
        int code;
    } change[] = {{"nodes/w", 40, 1},        {"nodes/length", 2, 1},
                  {"nodes/summation", 1, 1}, {"nodes/reached", 1, 1},
                  {"nodes/edge", 100000, 3}, {"nodes/tree/parent", 100000, 3}};
    for (size_t i = 0; i < sizeof change / sizeof change[0]; i++) {
        record_octree(&octree_engine_f64, 2, &params, &options, NULL);
        corrupt_whole(change[i].name, 0, change[i].amount);
        int code = check_file();
        if (code != change[i].code) fail_msg("%s: exit code %d", change[i].name, code);
    }
}

/* Rest shapes flow from record to record, in either precision, to the most that is allowed. */
TEST(plastic_octrees)
{
    static const SmEngineType *const types[] = {&octree_engine_f64, &octree_engine_f32};
    for (int t = 0; t < 2; t++) {
        OctOptions options = {.yield = 0.02, .creep = 20, .most = t ? 0 : 0.05};
        SmEngineParams params = {.h = 0.01, .damping = 0.2, .instances = 2, .threads = 1};
        record_octree(types[t], 2, &params, &options, NULL);
        assert_int_equal(check_file(), 0);
    }
    corrupt("nodes/S", 1, 1e-2);
    assert_int_equal(check_file(), 1);
}

TEST(corrupted)
{
    static const struct {
        const char *name;
        int record;
        double amount;
    } change[] = {{"particles/g", 1, 1e-8},
                  {"particles/x", NEXT - 1, 1e-8},
                  {"particles/v", NEXT - 1, 1e-6},
                  {"particles/x", 0, 1e-6},
                  {"particles/g", 0, INFINITY}};
    SmEngineParams params = {.w = 1, .h = 0.01, .damping = 0.1, .threads = 1};
    for (size_t i = 0; i < sizeof change / sizeof change[0]; i++) {
        record_lattice(&params, NULL, false);
        corrupt(change[i].name, change[i].record, change[i].amount);
        assert_int_equal(check_file(), 1);
    }
}

TEST(broken_links_are_not_checked)
{
    SmEngineParams params = {.w = 1, .h = 0.01, .strain_limit = 1.01, .threads = 1};
    record_lattice(&params, NULL, false);
    assert_int_equal(check_file(), 3);
}

TEST(no_trajectory)
{
    write_text("steps.h5", "no HDF5\n");
    assert_int_equal(check_file(), 3);
}

TEST_GROUP(make_file_name, remove_folder)
