/* Points as bodies, by the program: good ones run, bad ones are one clear line; the settings of
 * meshless bodies in scene files and options; slices. Real clouds where SHAPEBENCH_MESHES names
 * their folder. */
#include <hdf5.h>

#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"
#include "../../reference/meshless/test_solver.h"
#include "../cli/test_program.h"

/* What is written of a ball's `count` points. */
typedef struct {
    int count, copies;
    double noise;     /* of positions; the radius is 1 */
    double from;      /* lowest height, -1 (all) to 1 */
    bool bare, inner; /* without normals; with normals inwards */
} Ball;

static void write_points(FILE *file, const Ball *ball)
{
    unsigned seed = 5;
    for (int n = 0; n < ball->count * ball->copies; n++) {
        double share = (n % ball->count + 0.5) / ball->count,
               up = ball->from + (1 - ball->from) * share;
        double turn = 2.399963229728653 * (n % ball->count), side = sqrt(1 - up * up);
        double normal[3] = {side * cos(turn), up, side * sin(turn)};
        for (int d = 0; d < 3; d++)
            fprintf(file, "%.9g ", normal[d] + ball->noise * random_between(&seed, -1, 1));
        for (int d = 0; d < 3 && !ball->bare; d++)
            fprintf(file, "%.9g ", ball->inner ? -normal[d] : normal[d]);
        fputc('\n', file);
    }
}

static void write_text_ball(const char *name, const Ball *ball)
{
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    write_points(file, ball);
    fclose(file);
}

static void write_ply_ball(const char *name, const Ball *ball)
{
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    fprintf(file, "ply\nformat ascii 1.0\nelement vertex %d\n", ball->count * ball->copies);
    fputs("property float x\nproperty float y\nproperty float z\n", file);
    if (!ball->bare) fputs("property float nx\nproperty float ny\nproperty float nz\n", file);
    fputs("end_header\n", file);
    write_points(file, ball);
    fclose(file);
}

/* Runs the file as a small body under its weight; fails unless it does so well. */
static void assert_runs(const char *name)
{
    Result result;
    char arguments[256];
    snprintf(arguments, sizeof arguments,
             "run %s --engine meshless --nodes 150 --modes 20 --particles 300 --frames 3 "
             "--overwrite -o a.vtkhdf",
             name);
    run(arguments, &result);
    if (result.code || result.err[0]) fail_msg("%s: %d, %s", name, result.code, result.err);
    assert_non_null(strstr(result.out, "meshless, double precision"));
    assert_non_null(strstr(result.out, "wrote a.vtkhdf"));
    assert_int_equal(entries(".tmp"), 0);
}

TEST(clouds_run)
{
    needs_solver();
    write_text_ball("ball.xyz", &(Ball){600, 1, 0, -1, false, false});
    write_ply_ball("ball.ply", &(Ball){600, 1, 0, -1, false, false});
    write_text_ball("noisy.txt", &(Ball){900, 1, 0.01, -1, false, false});
    write_text_ball("doubled.pts", &(Ball){500, 2, 0, -1, false, false});
    write_text_ball("inwards.xyz", &(Ball){600, 1, 0, -1, false, true});
    write_text_ball("holed.xyz", &(Ball){700, 1, 0, -0.8, false, false});
    assert_runs("ball.xyz");
    assert_runs("ball.ply");
    assert_runs("noisy.txt");
    assert_runs("doubled.pts");
    assert_runs("inwards.xyz");
    assert_runs("holed.xyz");
}

/* A dataset that takes so many bytes in memory. */
static void read_all(hid_t file, const char *name, hid_t type, size_t bytes, void *values)
{
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    assert_int_equal((size_t)H5Sget_simple_extent_npoints(space) * H5Tget_size(type), bytes);
    assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space);
    H5Dclose(dataset);
}

/* Open and bare clouds and such with doubled points are shells by the triangles between them:
 * points are vertices in their order, and come apart. */
TEST(clouds_are_shells)
{
    needs_solver();
    Result result;
    static const struct {
        Ball ball;
        const char *shape;
    } cloud[] = {{{600, 1, 0, -1, false, false}, "of a sphere"},
                 {{600, 1, 0, -1, false, true}, "of a sphere"},
                 {{600, 1, 0, -1, true, false}, "of a sphere"},
                 {{500, 2, 0, -1, true, false}, "of a sphere"},
                 {{600, 1, 0, 0.3, false, false}, "of a disk"},
                 {{600, 1, 0, 0.3, true, false}, "of a disk"}};
    for (size_t n = 0; n < sizeof cloud / sizeof *cloud; n++) {
        write_text_ball("cloud.xyz", &cloud[n].ball);
        run("run cloud.xyz --engine shell --nodes 150 --frames 2 --overwrite -o a.vtkhdf", &result);
        if (result.code || !strstr(result.out, cloud[n].shape))
            fail_msg("%zu: %d, %s%s", n, result.code, result.out, result.err);
        hid_t file = H5Fopen(path_in("a.vtkhdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
        double still[1000][3], first[3];
        int count = cloud[n].ball.count * cloud[n].ball.copies;
        read_all(file, "frames/0", H5T_NATIVE_DOUBLE, (size_t)count * sizeof *still, still);
        H5Fclose(file);
        FILE *given = fopen(path_in("cloud.xyz"), "r");
        for (int p = 0; p < count; p++) {
            assert_int_equal(fscanf(given, "%lf %lf %lf%*[^\n]", first, first + 1, first + 2), 3);
            for (int d = 0; d < 3; d++) assert_true(fabs(still[p][d] - first[d]) < 1e-6);
        }
        fclose(given);
    }
    write_ply_ball("cloud.ply", &(Ball){600, 1, 0, 0.3, true, false});
    run("run cloud.ply --engine shell --nodes 150 --frames 2 --no-output", &result);
    if (result.code || !strstr(result.out, "of a disk")) fail_msg("%s%s", result.out, result.err);
    run("run cloud.xyz --engine shell --nodes 150 --strength 1e-3 --frames 4 --no-output", &result);
    if (result.code) fail_msg("%d, %s", result.code, result.err);
    run("info cloud.xyz --map", &result);
    if (result.code || !strstr(result.out, "disk")) fail_msg("%s%s", result.out, result.err);
}

/* All given points, doubles too, are carried and written in their order, as cells of one corner. */
TEST(given_points_are_written_as_they_are_given)
{
    needs_solver();
    Result result;
    char text[4096];
    double first[3], still[1000][3], fallen[1000][3];
    unsigned char types[1000];
    write_text_ball("doubled.pts", &(Ball){500, 2, 0, -1, false, false});
    run("run doubled.pts --engine meshless --nodes 150 --modes 20 --particles 300 --frames 2 "
        "--points 600",
        &result);
    assert_int_equal(result.code, 2);
    assert_non_null(strstr(result.err, "doubled.pts has its own"));
    run("run doubled.pts --engine meshless --nodes 150 --modes 20 --particles 300 --frames 2 "
        "-o given.vtkhdf",
        &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, ": 1000 given points and "));
    hid_t file = H5Fopen(path_in("given.vtkhdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    read_all(file, "VTKHDF/Types", H5T_NATIVE_UCHAR, sizeof types, types);
    read_all(file, "frames/0", H5T_NATIVE_DOUBLE, sizeof still, still);
    read_all(file, "frames/2", H5T_NATIVE_DOUBLE, sizeof fallen, fallen);
    FILE *given = fopen(path_in("doubled.pts"), "r");
    for (int p = 0; p < 1000; p++) {
        assert_int_equal(types[p], 1); /* VTK_VERTEX */
        assert_int_equal(fscanf(given, "%lf %lf %lf %*f %*f %*f", first, first + 1, first + 2), 3);
        for (int d = 0; d < 3; d++) assert_true(fabs(still[p][d] - first[d]) < 1e-6);
        assert_true(first[1] < 0 || (fallen[p][1] < still[p][1] && fallen[p][1] > -1));
        assert_memory_equal(fallen[p], fallen[p % 500], sizeof *fallen);
    }
    fclose(given);
    H5Fclose(file);
    slurp("given.vtkhdf.xdmf", text, sizeof text);
    assert_non_null(strstr(text, "TopologyType=\"Polyvertex\" NumberOfElements=\"1000\""));
}

/* A plate 50 times as wide as it is thick: sides are told apart by points as near to each other. */
TEST(a_thin_mesh_says_how_many_points_would_do)
{
    needs_solver();
    write_text(
        "plate.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 0.02\nv 1 0 0.02\nv 0 1 0.02\nv 1 1 0.02\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    static const Mistake mistakes[] = {
        {"run plate.obj --engine meshless --points 3000", 3, "take 24000 (run --points, or points"},
        {"run plate.obj --engine meshless --points 49", 2, "--points: '49'"},
        {"run plate.obj --points 3000", 2, "add --engine meshless"},
    };
    make_mistakes(mistakes, sizeof mistakes / sizeof *mistakes);
}

TEST(bad_clouds_are_one_clear_line)
{
    write_text_ball("bare.xyz", &(Ball){600, 1, 0, -1, true, false});
    write_ply_ball("bare.ply", &(Ball){600, 1, 0, -1, true, false});
    write_text_ball("few.xyz", &(Ball){20, 1, 0, -1, false, false});
    write_text_ball("same.xyz", &(Ball){10, 40, 0, -1, false, false});
    write_text_ball("half.xyz", &(Ball){600, 1, 0, 0.3, false, false});
    write_text("broken.xyz", "0 0 0 0 0 1\n1 0 0 nan 0 1\n");
    write_text("empty.xyz", "");
    write_text("torn.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                           "property float y\nproperty float z\nelement face 1\n"
                           "property list uchar int vertex_indices\nend_header\n"
                           "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
    static const Mistake mistakes[] = {
        {"run bare.xyz --engine meshless", 3, "bare.xyz: the points have no normals"},
        {"run bare.ply --engine meshless", 3, "bare.ply: the points have no normals"},
        {"run few.xyz --engine meshless", 3, "few.xyz: "},
        {"run same.xyz --engine meshless", 3, "same.xyz: "},
        {"run half.xyz --engine meshless", 3, "half.xyz: "},
        {"run broken.xyz --engine meshless", 3, "broken.xyz: point 2"},
        {"run empty.xyz --engine meshless", 3, "empty.xyz: "},
        {"run absent.xyz --engine meshless", 3, "absent.xyz: "},
        {"run bare.xyz", 3, "bare.xyz"},
        {"run torn.ply --engine meshless", 3,
         "torn.ply: line 11: the y of a vertex is not a finite"},
        {"run torn.ply --engine shell", 3, "torn.ply: line 11: the y of a vertex is not a finite"},
    };
    make_mistakes(mistakes, sizeof mistakes / sizeof *mistakes);
}

TEST(wrong_options_are_said)
{
    static const Mistake mistakes[] = {
        {"run penguin --young 1e5", 2, "add --engine meshless"},
        {"run shape:bar --engine meshless --poisson 0.5", 2, "--poisson: '0.5'"},
        {"run shape:bar --engine meshless --young 0", 2, "--young: '0'"},
        {"run shape:bar --engine meshless --density -1", 2, "--density: '-1'"},
        {"run shape:bar --engine meshless --modes 6", 2, "--modes: '6'"},
        {"run shape:bar --engine meshless --record particles", 2, "--record"},
        {"info shape:bar -o a.h5", 2, "--output goes with --map"},
    };
    make_mistakes(mistakes, sizeof mistakes / sizeof *mistakes);
}

static const char bar[] =
    "mesh = \"shape:bar\"; particles = 200; engine = \"meshless\";\n"
    "gravity = [0.0, -9.81, 0.0]; frames = 2;\n"
    "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.1, 1.0, 1.0]; } );\n";

static void write_scene(const char *name, const char *material)
{
    char text[1024];
    snprintf(text, sizeof text, "%smeshless = {\n%s\n};\n", bar, material);
    write_text(name, text);
}

TEST(settings_are_read_and_options_come_first)
{
    needs_solver();
    Result result;
    write_scene("bar.cfg", "young = 2e6; poisson = 0.25; density = 1500.0;\n"
                           "points = 2000; nodes = 150; modes = 20; stiffness_damping = 1e-4;\n"
                           "uniform = true; metre = 2.0;");
    run("run bar.cfg --no-output", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "Young's modulus 2e+06, Poisson's ratio 0.25, density 1500, "
                                       "2 mesh units in a metre"));
    run("run bar.cfg --no-output --frames 1 --young 3e6 --poisson 0.1 --density 900", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "Young's modulus 3e+06, Poisson's ratio 0.1, density 900"));
    run("tables --scene bar.cfg --repeats 1 --block 1 --format csv", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, ",bar,meshless,"));
}

TEST(wrong_settings_have_a_line)
{
    write_scene("stiff.cfg", "young = 1e5;\npoisson = 0.5;");
    write_scene("light.cfg", "density = 0.0;");
    write_scene("few.cfg", "\n\npoints = 10;");
    write_scene("odd.cfg", "yuong = 1e5;");
    write_scene("text.cfg", "modes = \"many\";");
    static const Mistake mistakes[] = {
        {"run stiff.cfg", 3, "stiff.cfg:6: 'poisson' must be a number from -0.99 to 0.49"},
        {"run light.cfg", 3, "light.cfg:5: 'density' must be a number"},
        {"run few.cfg", 3, "few.cfg:7: 'points' must be a whole number from 50"},
        {"run odd.cfg", 3, "odd.cfg:5: unknown setting 'yuong'; known: young, poisson"},
        {"run text.cfg", 3, "text.cfg:5: 'modes' must be a whole number from 7 to 1000"},
    };
    make_mistakes(mistakes, sizeof mistakes / sizeof *mistakes);
}

/* Clouds of others: those with normals run, the others are refused. */
TEST(real_clouds)
{
    needs_solver();
    const char *meshes = getenv("SHAPEBENCH_MESHES");
    char command[1024];
    Result result;
    needs(meshes, "SHAPEBENCH_MESHES names no folder of meshes");
    snprintf(command, sizeof command, "ln -sf '%.200s'/*.xyz '%.200s'/*.pts '%.200s'/*.ply %s/",
             meshes, meshes, meshes, folder);
    assert_int_equal(system(command), 0);
    assert_runs("oni.xyz");
    run("run points_utm_offset.xyz --engine meshless", &result);
    assert_int_equal(result.code, 3);
    assert_non_null(strstr(result.err, "not 1 (text: columns 4 to 6; PLY: nx ny nz)"));
    run("run bunny_points.pts --engine meshless", &result);
    assert_int_equal(result.code, 3);
    assert_non_null(strstr(result.err, "the points have no normals"));
}
