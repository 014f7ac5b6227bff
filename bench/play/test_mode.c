/* A natural mode of a shell in a trajectory: its period and its shape beside Kirchhoff's theory. */
#include "mode.h"

#include <hdf5.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../../reference/meshless/test_solver.h"
#include "../engines.h"

enum { CELLS = 30, VERTICES = (CELLS + 1) * (CELLS + 1), FRAMES = 4 };

/* A square plate of side 1. */
static SmMesh plate(void)
{
    SmMesh mesh = sm_mesh_new(VERTICES, 2L * CELLS * CELLS);
    for (int v = 0; v < VERTICES; v++) {
        mesh.position[v][0] = (double)(v % (CELLS + 1)) / CELLS;
        mesh.position[v][1] = (double)(v / (CELLS + 1)) / CELLS;
    }
    for (int c = 0; c < CELLS * CELLS; c++) {
        int at = c / CELLS * (CELLS + 1) + c % CELLS, up = at + CELLS + 1;
        const int both[2][3] = {{at, at + 1, up + 1}, {at, up + 1, up}};
        memcpy(mesh.triangle[2 * c], both, sizeof both);
    }
    return mesh;
}

static const char text[] =
    "mesh = \"shape:block\"; engine = \"shell\"; fill = \"shell\";\n"
    "particles = 400; frames = 4;\n"
    "handles = ({ box_low = [-1.0, -1.0, -1.0]; box_high = [0.1, 2.0, 1.0]; });\n"
    "meshless = { nodes = 400; thickness = 0.005; young = 1.0e7; poisson = 0.3;\n"
    "             density = 10.0; metre = 1.0; };\n";

static void read_all(hid_t file, const char *name, size_t count, double *values)
{
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    assert_int_equal(H5Sget_simple_extent_npoints(space), count);
    assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space);
    H5Dclose(dataset);
}

static void record_mode(BenchPlayback *play, int mode, const char *path)
{
    static char *words[] = {"shapebench", "run"};
    BenchMachine machine;
    BenchRecording recording;
    SmError error;
    bench_machine_read(2, words, 1, &machine);
    if (bench_recording_open(play, path, BENCH_RECORD_SURFACE, 0, &machine, &recording, &error) ||
        bench_mode_record(play, &recording, mode, &error) ||
        bench_recording_close(&recording, &error))
        fail_msg("%s", error.text);
}

/* The lowest mode of a free plate twists it: corners that face each other go the same way, the
 * others the other way, a tenth of its side far; its middle stays. */
static void check_twist(const double (*x)[3], const double (*rest)[3], double sign)
{
    const int corner[4] = {0, CELLS, VERTICES - 1, VERTICES - 1 - CELLS};
    double first = x[0][2] - rest[0][2];
    assert_true(fabs(fabs(first) - 0.1) < 0.01 && first * sign > 0);
    for (int k = 0; k < 4; k++) {
        double moved = x[corner[k]][2] - rest[corner[k]][2];
        assert_true(fabs(moved - (k % 2 ? -first : first)) < 2e-3);
    }
    assert_true(fabs(x[VERTICES / 2][2] - rest[VERTICES / 2][2]) < 2e-3);
}

/* 13.468 is the frequency parameter of a free square plate of Poisson's ratio 0.3 (Leissa 1973 has
 * 13.489, from above). Held as the scene has it, or not, it is the free plate's. */
TEST(a_free_plate_twists_at_the_frequency_of_theory)
{
    needs_solver();
    SmError error;
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
    SmMesh mesh = plate();
    static double x[FRAMES + 1][VERTICES][3];
    double time[FRAMES + 1];
    assert_int_equal(bench_scene_parse(text, strlen(text), "plate.cfg", &scene, &error), SM_OK);
    if (bench_body_create(&scene, &mesh, &body, &error)) fail_msg("%s", error.text);
    const SmEngineType *type = bench_engine("shell")->type[0];
    if (bench_playback_create(&scene, &body, type, 1, 1, &play, &error)) fail_msg("%s", error.text);
    record_mode(&play, 1, path_in("plate.vtkhdf"));
    hid_t file = H5Fopen(path_in("plate.vtkhdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    read_all(file, "VTKHDF/Steps/Values", FRAMES + 1, time);
    for (int f = 0; f <= FRAMES; f++) {
        char name[32];
        snprintf(name, sizeof name, "frames/%d", f);
        read_all(file, name, (size_t)3 * VERTICES, x[f][0]);
    }
    H5Fclose(file);
    double D = 1e7 * pow(0.005, 3) / (12 * (1 - 0.3 * 0.3));
    double theory = 13.468 * sqrt(D / (10 * 0.005)) / (2 * M_PI);
    assert_true(fabs(1 / time[FRAMES] / theory - 1) < 0.01);
    double sign = x[1][0][2] > x[0][0][2] ? 1 : -1;
    for (int f = 1; f <= FRAMES; f++) {
        assert_true(fabs(time[f] - time[FRAMES] * f / FRAMES) < 1e-9);
        if (f % 2)
            check_twist((const double(*)[3])x[f], (const double(*)[3])x[0], f == 1 ? sign : -sign);
        for (int v = 0; v < VERTICES && f % 2 == 0; v++)
            for (int d = 0; d < 3; d++) assert_true(fabs(x[f][v][d] - x[0][v][d]) < 1e-6);
    }
    double half = bench_mode_of_half(&play, 1); /* 200 nodes are enough for a flat plate */
    assert_true(half > 1 / time[FRAMES] && fabs(half / theory - 1) < 0.03);
    assert_true(isnan(bench_mode_of_half(&play, 994)));
    assert_int_equal(bench_mode_record(&play, NULL, 994, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "--mode 994"));
    bench_playback_free(&play);
    bench_body_free(&body);
}
