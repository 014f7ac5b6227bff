/* One number of threads everywhere: an engine's own in all it does, the program's in all else. */
#include <omp.h>

#include "../../fastlsm/fastlsm.h"
#include "../../lib/shapes/shape.h"
#include "../../lib/system/team.h"
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../lib/voxel/voxelise.h"
#include "../../octree/engine.h"
#include "../../reference/brute.h"
#include "../../reference/meshless/engine.h"
#include "../../reference/meshless/solve/solver.h"
#include "../store/h5.h"
#include "test_program.h"

/* Threads that the process has, and so the largest team of late: those of a team wait for the
 * next. 0: the system does not say. */
static int tasks(void)
{
    int count = 0;
    DIR *list = opendir("/proc/self/task");
    for (const struct dirent *entry; list && (entry = readdir(list));)
        count += entry->d_name[0] != '.';
    if (list) closedir(list);
    return count;
}

static void make_cube(int side, SmVoxels *voxels)
{
    sm_voxels_init(voxels, side, side, side, 1.0 / side);
    for (int k = 0; k < side; k++)
        for (int j = 0; j < side; j++)
            for (int i = 0; i < side; i++) sm_voxel_set(voxels, i, j, k);
    sm_voxels_count(voxels);
}

/* Splits a leaf of an octree engine's body while it runs. */
static void refine(SmEngine *engine)
{
    OctStructure *structure;
    SmError error;
    assert_int_equal(oct_engine_begin(engine, &structure, &error), SM_OK);
    const OctTree *tree = &structure->tree;
    long leaf = 0;
    while (tree->size[tree->node[leaf]] < 2) leaf++;
    assert_int_equal(oct_resample_split(structure, tree->node[leaf], &error), SM_OK);
    oct_engine_end(engine);
}

static void use(const SmEngineType *type, const SmVoxels *voxels, SmEngineParams params)
{
    SmEngine *engine, *copy;
    SmError error = {0};
    SmCounts counts;
    params.w = 1;
    params.h = 0.01;
    params.damping = 0.1;
    params.threads = 1;
    int before = tasks();
    if (type->create(voxels, &params, &engine, &error)) fail_msg("%s", error.text);
    type->count(engine, &counts);
    if (type->rebuild && params.instances < 2) {
        assert_true(counts.particles > 2000); /* smaller trees are searched by one thread anyway */
        refine(engine);
        long *order = sm_alloc((size_t)counts.particles + 7, sizeof *order);
        assert_int_equal(type->rebuild(engine, &params, &copy, order, &error), SM_OK);
        type->destroy(copy);
        free(order);
    }
    type->step(engine, NULL);
    type->goals(engine);
    type->destroy(engine);
    if (tasks() > before) fail_msg("%s: %d threads more", type->name, tasks() - before);
}

TEST(an_engine_of_one_thread_starts_no_other)
{
    SmVoxels cube, sites;
    SmMesh penguin;
    const SmVoxelParams few = {.fill = SM_SOLID, .particles = 400};
    const OctOptions fine = {.sampling = {.levels = 1, .nodes = 2500}};
    const SmCollideParams collide = {.self = true, .bodies = true};
    int number = omp_get_max_threads();
    needs(tasks() > 0, "this system does not say how many threads a process has");
    omp_set_num_threads(1);
    assert_int_equal(sm_shape_mesh("penguin", &penguin, NULL), SM_OK);
    assert_int_equal(sm_voxelise(&penguin, &few, "penguin", &sites, NULL), SM_OK);
    omp_set_num_threads(5);
    make_cube(16, &cube);
    use(&fastlsm_engine_f32, &cube, (SmEngineParams){.layout = SM_LAYOUT_LISTS});
    use(&fastlsm_engine_f64, &cube, (SmEngineParams){.layout = SM_LAYOUT_BLOCKS});
    use(&fastlsm_engine_f32, &cube, (SmEngineParams){.instances = 40, .collide = collide});
    use(&octree_engine_f32, &cube, (SmEngineParams){.octree = &fine});
    use(&octree_engine_f32, &cube,
        (SmEngineParams){.octree = &fine, .instances = 2, .collide = collide});
    use(&ref_brute_engine, &cube, (SmEngineParams){0});
    assert_int_equal(omp_get_max_threads(), 5); /* the caller's number is its own */
    const RefMeshlessOptions options = {
        .mesh = &penguin, .points = 3000, .nodes = 300, .modes = 20, .material = {1e5, 0.3, 1000}};
    if (ref_solver_built) use(&ref_meshless_engine, &sites, (SmEngineParams){.meshless = &options});
    omp_set_num_threads(number);
    sm_mesh_free(&penguin);
    sm_voxels_free(&sites);
    sm_voxels_free(&cube);
}

/* OpenMP's runtime ends the program where it is asked for so many anywhere: beyond SM_MOST_THREADS
 * in any case, and here, where there is no memory for stacks, from some hundreds on. */
TEST(the_program_runs_on_the_number_it_is_given)
{
    static const char *const numbers[] = {"", "--threads 2"};
    const char *room = TEST_FIGURES ? "ulimit -v 2000000;" : ""; /* sanitizers need more */
    omp_set_num_threads(100000);
    assert_int_equal(sm_team(0), SM_MOST_THREADS);
    assert_int_equal(sm_team(SM_MOST_THREADS + 1), SM_MOST_THREADS);
    omp_set_num_threads(1);
    for (int i = 0; i < 2; i++) {
        Result result;
        char prefix[80], arguments[80];
        snprintf(prefix, sizeof prefix, "%s OMP_NUM_THREADS=100000", room);
        snprintf(arguments, sizeof arguments, "run flowers --no-output --frames 2 --steps 1 %s",
                 numbers[i]);
        run_with(prefix, arguments, &result);
        if (result.code) fail_msg("%s: exit code %d: %s", numbers[i], result.code, result.err);
    }
}

/* Bodies of every engine, the crowd one that collides. */
static void write_bodies(void)
{
    write_text("lattice.cfg", "mesh = \"shape:block\"; particles = 1200; w = 2; damping = 0.1; "
                              "bend = 0.5; kick = 0.02; frames = 4; steps_per_frame = 5;");
    write_text("crowd.cfg", "mesh = \"shape:block\"; particles = 100; w = 2; instances = 10; "
                            "spacing = 0.19; kick = 0.05; collide = { bodies = true; }; "
                            "frames = 4; steps_per_frame = 5;");
    write_text("tree.cfg", "mesh = \"shape:block\"; particles = 2500; engine = \"octree\"; "
                           "damping = 0.1; bend = 0.5; kick = 0.02; frames = 4; "
                           "steps_per_frame = 5; octree = { levels = 2; nodes = 800; };");
    write_text("elastic.cfg", "mesh = \"shape:bar\"; particles = 500; engine = \"meshless\"; "
                              "gravity = (0.0, -9.81, 0.0); frames = 4; steps_per_frame = 5; "
                              "handles = ( { box_high = (0.1, 1.0, 1.0); } ); "
                              "meshless = { points = 400; nodes = 150; modes = 12; };");
}

/* The hash that "run NAME.cfg OPTIONS" prints of its last state. */
static void run_hash(const char *name, const char *options, char hash[17])
{
    Result result;
    char arguments[256];
    snprintf(arguments, sizeof arguments, "run %s.cfg --hash --quiet %s", name, options);
    run_with("OMP_WAIT_POLICY=passive", arguments, &result);
    if (result.code) fail_msg("%s: exit code %d: %s", arguments, result.code, result.err);
    const char *line = strstr(result.out, "\nstate after ");
    if (!line || sscanf(line, "%*[^:]: %16[0-9a-f] (", hash) != 1 || strlen(hash) != 16)
        fail_msg("%s: no hash in %s", arguments, result.out);
}

/* On 1, 2 and 3 threads. */
static void compare_threads(const char *name, const char *isa)
{
    char first[17] = "", hash[17], options[64];
    for (int threads = 1; threads <= 3; threads++) {
        snprintf(options, sizeof options, "--no-output --isa %s --threads %d", isa, threads);
        run_hash(name, options, hash);
        if (threads == 1) strcpy(first, hash);
        if (strcmp(hash, first) != 0)
            fail_msg("%s, %s: %s on 1 thread, %s on %d", name, isa, first, hash, threads);
    }
}

TEST(threads_change_no_bit_in_any_instruction_set)
{
    write_bodies();
    for (int isa = 0; isa < sm_isa_count(); isa++) {
        if (!sm_isa_there(isa)) continue;
        compare_threads("lattice", sm_isa_name(isa));
        compare_threads("crowd", sm_isa_name(isa));
        compare_threads("tree", sm_isa_name(isa));
        if (ref_solver_built) compare_threads("elastic", sm_isa_name(isa));
    }
}

/* A row's is of the state after the scene's `settle` steps, here 8, a trajectory's of its last. */
TEST(a_states_hash_is_the_same_wherever_it_is_held)
{
    write_bodies();
    for (int b = 0; b < 2; b++) {
        const char *name = b ? "tree" : "lattice";
        Result result;
        char hash[17], later[17], held[17], arguments[128];
        BenchH5 h5;
        run_hash(name, "--frames 1 --steps 8 -o a.vtkhdf --overwrite", hash);
        run_hash(name, "--frames 1 --steps 9 --no-output", later);
        assert_string_not_equal(hash, later);
        bench_h5_open(&h5, path_in("a.vtkhdf"));
        bench_h5_read_text(&h5, h5.file, "state_hash", sizeof held, held);
        assert_true(bench_h5_close(&h5));
        assert_string_equal(held, hash);
        snprintf(arguments, sizeof arguments,
                 "tables --scene %s.cfg --repeats %d --block 1 --threads 2 --format csv", name,
                 1 + b);
        run(arguments, &result);
        if (!strstr(result.out, hash)) fail_msg("no %s in %s", hash, result.out);
        for (int wrong = 0; wrong < 2; wrong++) { /* and is not checked again where it is known */
            snprintf(arguments, sizeof arguments,
                     "tables --scene %s.cfg --repeats 1 --block 1 --checked %s%s", name, hash,
                     wrong ? "0" : "");
            run(arguments, &result);
            assert_int_equal(result.code, wrong);
            const char *said = wrong ? "that was checked" : "  checked before; ";
            if (!strstr(result.out, said)) fail_msg("no '%s' in %s", said, result.out);
        }
    }
}
