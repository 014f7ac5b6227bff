#define _GNU_SOURCE
#include <malloc.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../lib/test_frame.h"
#include "../cli/test_program.h"
#include "../store/draft.h"
#include "../store/h5.h"
#include "trajectory.h"

enum { FRAMES = 5, SIDE = 12, POINTS = SIDE * SIDE, TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1) };

/* A sheet of squares, `offset` away from the origin. */
static void make_sheet(double offset, SmMesh *mesh)
{
    *mesh = sm_mesh_new(POINTS, TRIANGLES);
    int t = 0;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++) {
            int p = j * SIDE + i;
            mesh->position[p][0] = offset + i;
            mesh->position[p][1] = offset + j;
            mesh->position[p][2] = offset;
            if (i + 1 == SIDE || j + 1 == SIDE) continue;
            const int corner[2][3] = {{p, p + 1, p + SIDE}, {p + 1, p + SIDE + 1, p + SIDE}};
            memcpy(mesh->triangle[t++], corner[0], sizeof corner[0]);
            memcpy(mesh->triangle[t++], corner[1], sizeof corner[1]);
        }
}

/* Coordinate `axis` of point p in frame f: the rest position swung by a known function. */
static double moved(const SmMesh *sheet, int frame, int p, int axis)
{
    return sheet->position[p][axis] + 0.25 * frame * ((p * 3 + axis) % 17);
}

static SmCode write_frames(BenchTrajectory *trajectory, const SmMesh *sheet, int frames,
                           SmError *error)
{
    static double point[POINTS][3];
    SmCode code = SM_OK;
    for (int f = 0; f < frames && code == SM_OK; f++) {
        for (int p = 0; p < POINTS; p++)
            for (int a = 0; a < 3; a++) point[p][a] = moved(sheet, f, p, a);
        code = bench_trajectory_frame(trajectory, 0.5 * f, (const double(*)[3])point, NULL, error);
    }
    return code;
}

static BenchTrajectoryParams sheet_params(const char *path, const SmMesh *sheet)
{
    static BenchMachine machine;
    bench_machine_read(0, NULL, 1, &machine);
    return (BenchTrajectoryParams){
        .path = path, .surface = sheet, .machine = &machine, .scene = "a <sheet> & \"\x01\xff\""};
}

static SmCode write_sheet(const char *path, double offset, int frames, SmError *error)
{
    SmMesh sheet;
    make_sheet(offset, &sheet);
    BenchTrajectoryParams params = sheet_params(path, &sheet);
    BenchTrajectory *trajectory;
    SmCode code = bench_trajectory_open(&params, &trajectory, error);
    if (code == SM_OK) {
        code = write_frames(trajectory, &sheet, frames, error);
        if (code == SM_OK)
            code = bench_trajectory_close(trajectory, "0123456789abcdef", error);
        else
            bench_trajectory_abandon(trajectory);
    }
    sm_mesh_free(&sheet);
    return code;
}

static void read_longs(hid_t file, const char *name, int count, long *values)
{
    BenchH5 h5 = {.file = file};
    hsize_t size[] = {(hsize_t)count, 1};
    int rank = strstr(name, "CellOffsets") || strstr(name, "ConnectivityIdOffsets") ? 2 : 1;
    hid_t dataset = bench_h5_find_dataset(&h5, file, name, rank, size);
    bench_h5_read(&h5, dataset, H5T_NATIVE_LONG, values);
    if (h5.failed) fail_msg("%s", h5.message);
    H5Dclose(dataset);
}

static void check_points(hid_t file, const SmMesh *sheet, size_t bytes)
{
    static double point[FRAMES][POINTS][3];
    BenchH5 h5 = {.file = file};
    hsize_t size[] = {FRAMES * POINTS, 3};
    hid_t dataset = bench_h5_find_dataset(&h5, file, "VTKHDF/Points", 2, size);
    bench_h5_read(&h5, dataset, H5T_NATIVE_DOUBLE, point);
    if (h5.failed) fail_msg("%s", h5.message);
    hid_t type = H5Dget_type(dataset);
    assert_int_equal(H5Tget_size(type), bytes);
    H5Tclose(type);
    H5Dclose(dataset);
    /* The test's coordinates are multiples of 1/4 and exact in either precision. */
    for (int f = 0; f < FRAMES; f++)
        for (int p = 0; p < POINTS; p++)
            for (int a = 0; a < 3; a++) assert_true(point[f][p][a] == moved(sheet, f, p, a));
}

TEST(frames_round_trip)
{
    for (int far = 0; far < 2; far++) {
        const char *path = path_in("sheet.vtkhdf");
        SmError error = {0};
        SmMesh sheet;
        make_sheet(far ? 5e6 : 0, &sheet);
        if (write_sheet(path, far ? 5e6 : 0, FRAMES, &error) != SM_OK) fail_msg("%s", error.text);
        assert_int_equal(entries(""), 2);
        hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
        check_points(file, &sheet, far ? 8 : 4);
        long one[FRAMES], offset[FRAMES], ends[TRIANGLES + 1], corner[3 * TRIANGLES];
        read_longs(file, "VTKHDF/NumberOfPoints", 1, one);
        assert_int_equal(one[0], POINTS);
        read_longs(file, "VTKHDF/Offsets", TRIANGLES + 1, ends);
        read_longs(file, "VTKHDF/Connectivity", 3 * TRIANGLES, corner);
        assert_int_equal(ends[TRIANGLES], 3 * TRIANGLES);
        for (int i = 0; i < 3 * TRIANGLES; i++)
            assert_int_equal(corner[i], sheet.triangle[i / 3][i % 3]);
        read_longs(file, "VTKHDF/Steps/PointOffsets", FRAMES, offset);
        read_longs(file, "VTKHDF/Steps/CellOffsets", FRAMES, one);
        for (int f = 0; f < FRAMES; f++) {
            assert_int_equal(offset[f], f * POINTS);
            assert_int_equal(one[f], 0);
        }
        H5Fclose(file);
        sm_mesh_free(&sheet);
    }
}

/* A surface that loses its last row of triangles after two frames and gets it back after three:
 * every frame with its own points, triangles and place in the file. */
TEST(topology_may_change)
{
    enum { ROW = 2 * (SIDE - 1) };
    const char *path = path_in("cut.vtkhdf");
    SmMesh sheet;
    make_sheet(0, &sheet);
    BenchTrajectoryParams params = sheet_params(path, &sheet);
    BenchTrajectory *trajectory;
    assert_int_equal(bench_trajectory_open(&params, &trajectory, NULL), SM_OK);
    assert_int_equal(write_frames(trajectory, &sheet, 2, NULL), SM_OK);
    sheet.vertex_count -= SIDE, sheet.triangle_count -= ROW;
    assert_int_equal(bench_trajectory_topology(trajectory, &sheet, NULL), SM_OK);
    assert_int_equal(write_frames(trajectory, &sheet, 1, NULL), SM_OK);
    sheet.vertex_count += SIDE, sheet.triangle_count += ROW;
    assert_int_equal(bench_trajectory_topology(trajectory, &sheet, NULL), SM_OK);
    assert_int_equal(write_frames(trajectory, &sheet, 2, NULL), SM_OK);
    assert_int_equal(bench_trajectory_close(trajectory, "0123456789abcdef", NULL), SM_OK);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    const long part[5] = {0, 0, 1, 2, 2}, less = TRIANGLES - ROW, fewer = POINTS - SIDE;
    const long points[3] = {POINTS, fewer, POINTS}, cells[3] = {TRIANGLES, less, TRIANGLES};
    const long first[3] = {0, TRIANGLES, TRIANGLES + less};
    long got[5], corner[3 * (3 * TRIANGLES - ROW)], at = 0, corners = 3 * (2 * TRIANGLES + less);
    read_longs(file, "VTKHDF/NumberOfPoints", 3, got);
    assert_memory_equal(got, points, sizeof points);
    read_longs(file, "VTKHDF/NumberOfCells", 3, got);
    assert_memory_equal(got, cells, sizeof cells);
    read_longs(file, "VTKHDF/Connectivity", (int)corners, corner);
    for (int i = 0; i < corners; i++) {
        int t = i / 3 < TRIANGLES  ? i / 3
                : i / 3 < first[2] ? i / 3 - TRIANGLES
                                   : (int)(i / 3 - first[2]);
        assert_int_equal(corner[i], sheet.triangle[t][i % 3]);
    }
    long steps[3][5];
    read_longs(file, "VTKHDF/Steps/PartOffsets", 5, steps[0]);
    read_longs(file, "VTKHDF/Steps/PointOffsets", 5, steps[1]);
    read_longs(file, "VTKHDF/Steps/CellOffsets", 5, steps[2]);
    for (int f = 0; f < 5; f++) {
        assert_int_equal(steps[0][f], part[f]);
        assert_int_equal(steps[1][f], at);
        assert_int_equal(steps[2][f], first[part[f]]);
        at += points[part[f]];
    }
    hid_t view = H5Dopen2(file, "topologies/1", H5P_DEFAULT);
    hid_t space = H5Dget_space(view);
    assert_int_equal(H5Sget_simple_extent_npoints(space), 3 * less);
    H5Sclose(space);
    H5Dclose(view);
    H5Fclose(file);
    sm_mesh_free(&sheet);
}

/* A sheet pulled to 1.5 times its length along x, pressed to 0.4 of it along y and turned about z:
 * the larger of the two is what is told, wherever it is. */
TEST(strain_is_the_largest_stretch)
{
    float strain[POINTS];
    double point[POINTS][3];
    const double pull[2][2] = {{1.5, 0.8}, {1.5, 0.4}}, wanted[2] = {0.5, 0.6};
    SmMesh sheet;
    make_sheet(0, &sheet);
    for (int n = 0; n < 2; n++) {
        for (int p = 0; p < POINTS; p++) {
            double x = pull[n][0] * sheet.position[p][0], y = pull[n][1] * sheet.position[p][1];
            point[p][0] = 0.6 * x - 0.8 * y, point[p][1] = 0.8 * x + 0.6 * y, point[p][2] = 7;
        }
        bench_strain(&sheet, (const double(*)[3])point, strain);
        for (int p = 0; p < POINTS; p++) assert_float_equal(strain[p], wanted[n], 1e-6);
    }
    for (int p = 0; p < POINTS; p++) /* all rests in one point */
        for (int d = 0; d < 3; d++) sheet.position[p][d] = 1;
    bench_strain(&sheet, (const double(*)[3])point, strain);
    for (int p = 0; p < POINTS; p++) assert_true(strain[p] == 0);
    sm_mesh_free(&sheet);
}

/* Values of every point and frame, each frame's also under a name of its own, which the sidecar
 * has. */
TEST(fields_are_stored)
{
    static float speed[POINTS], displacement[3 * POINTS], got[2 * POINTS], part[3 * POINTS];
    const float *value[BENCH_POINT_FIELDS] = {
        [BENCH_DISPLACEMENT] = displacement, [BENCH_SPEED] = speed};
    SmMesh sheet;
    make_sheet(0, &sheet);
    BenchTrajectoryParams params = sheet_params(path_in("fields.vtkhdf"), &sheet);
    params.fields = 1u << BENCH_DISPLACEMENT | 1u << BENCH_SPEED;
    BenchTrajectory *trajectory;
    assert_int_equal(bench_trajectory_open(&params, &trajectory, NULL), SM_OK);
    for (int f = 0; f < 2; f++) {
        for (int i = 0; i < 3 * POINTS; i++) displacement[i] = (float)(1000 * f + i);
        for (int p = 0; p < POINTS; p++) speed[p] = (float)(-1000 * f - p);
        assert_int_equal(
            bench_trajectory_frame(trajectory, f, (const double(*)[3])sheet.position, value, NULL),
            SM_OK);
    }
    assert_int_equal(bench_trajectory_close(trajectory, "0123456789abcdef", NULL), SM_OK);
    BenchH5 h5 = {.file = H5Fopen(params.path, H5F_ACC_RDONLY, H5P_DEFAULT)};
    hsize_t all[] = {2 * POINTS}, one[] = {POINTS, 3};
    hid_t whole = bench_h5_find_dataset(&h5, h5.file, "VTKHDF/PointData/speed", 1, all);
    bench_h5_read(&h5, whole, H5T_NATIVE_FLOAT, got);
    hid_t view = bench_h5_find_dataset(&h5, h5.file, "fields/displacement/1", 2, one);
    bench_h5_read(&h5, view, H5T_NATIVE_FLOAT, part);
    if (h5.failed) fail_msg("%s", h5.message);
    for (int i = 0; i < 2 * POINTS; i++)
        assert_true(got[i] == (float)(-1000 * (i / POINTS) - i % POINTS));
    assert_memory_equal(part, displacement, sizeof part);
    H5Dclose(whole);
    H5Dclose(view);
    long offset[2];
    read_longs(h5.file, "VTKHDF/Steps/PointDataOffsets/speed", 2, offset);
    assert_int_equal(offset[1], POINTS);
    H5Fclose(h5.file);
    char text[8192];
    slurp("fields.vtkhdf.xdmf", text, sizeof text);
    assert_non_null(strstr(text, "<Attribute Name=\"speed\""));
    assert_non_null(strstr(text, "fields.vtkhdf:/fields/displacement/1<"));
    sm_mesh_free(&sheet);
}

/* What the bodies met lies in the file, recorded particles or not. */
TEST(obstacles_are_stored)
{
    const SmObstacle obstacle[2] = {
        {.kind = SM_PLANE, .a = {1, 2, 3}, .b = {0, 1, 0}, .friction = 0.25},
        {.kind = SM_CAPSULE, .a = {4, 5, 6}, .b = {7, 8, 9}, .radius = 0.5}};
    const SmBoundary boundary = {.obstacle_count = 2, .obstacle = obstacle};
    const double wanted[2][9] = {{0, 1, 2, 3, 0, 1, 0, 0, 0.25}, {3, 4, 5, 6, 7, 8, 9, 0.5, 0}};
    double got[2][9];
    SmMesh sheet;
    make_sheet(0, &sheet);
    BenchTrajectoryParams params = sheet_params(path_in("met.vtkhdf"), &sheet);
    params.steps.boundary = &boundary;
    BenchTrajectory *trajectory;
    assert_int_equal(bench_trajectory_open(&params, &trajectory, NULL), SM_OK);
    assert_int_equal(write_frames(trajectory, &sheet, 1, NULL), SM_OK);
    assert_int_equal(bench_trajectory_close(trajectory, "0123456789abcdef", NULL), SM_OK);
    BenchH5 h5 = {.file = H5Fopen(params.path, H5F_ACC_RDONLY, H5P_DEFAULT)};
    hid_t dataset = bench_h5_find_dataset(&h5, h5.file, "obstacles", 2, (hsize_t[]){2, 9});
    bench_h5_read(&h5, dataset, H5T_NATIVE_DOUBLE, got);
    if (h5.failed) fail_msg("%s", h5.message);
    assert_memory_equal(got, wanted, sizeof wanted);
    H5Dclose(dataset);
    H5Fclose(h5.file);
    sm_mesh_free(&sheet);
}

/* The sidecar is well-formed with a scene's name and a file's name of odd characters. */
TEST(sidecar_is_xml)
{
    needs_python("xml.etree.ElementTree");
    char path[256], command[1024];
    snprintf(path, sizeof path, "%s", path_in("odd & <name> \xc3\xa9 \".vtkhdf"));
    SmError error = {0};
    if (write_sheet(path, 0, FRAMES, &error) != SM_OK) fail_msg("%s", error.text);
    snprintf(command, sizeof command,
             "/usr/bin/python3 -c 'import sys, os, xml.etree.ElementTree as E\n"
             "p = sys.argv[1]; r = E.parse(p + \".xdmf\").getroot()\n"
             "c = r.find(\"Domain/Grid\"); assert c.get(\"Name\").startswith(\"a <sheet> & \")\n"
             "assert len(c.findall(\"Grid\")) == %d\n"
             "n = {i.text.split(\":\")[0] for i in r.iter(\"DataItem\") "
             "if i.get(\"Format\") == \"HDF\"}\n"
             "assert n == {os.path.basename(p)}, n' '%s'",
             FRAMES, path);
    assert_int_equal(system(command), 0);
}

TEST(bad_targets)
{
    SmError error = {0};
    int before = entries("");
    assert_int_equal(write_sheet(path_in("missing/a.h5"), 0, 1, &error), SM_OUTPUT);
    assert_non_null(strstr(error.text, "create the folder"));
    assert_int_equal(write_sheet(folder, 0, 1, &error), SM_OUTPUT);
    assert_int_equal(write_sheet(path_in("a:b.h5"), 0, 1, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "a:b.h5"));
    assert_int_equal(entries(""), before);
}

/* A sidecar that cannot be written is found before the simulation. */
TEST(blocked_sidecar)
{
    char command[300];
    snprintf(command, sizeof command, "mkdir %s", path_in("b.h5.xdmf"));
    assert_int_equal(system(command), 0);
    SmError error = {0};
    SmMesh sheet;
    make_sheet(0, &sheet);
    BenchTrajectoryParams params = sheet_params(path_in("b.h5"), &sheet);
    BenchTrajectory *trajectory;
    assert_int_equal(bench_trajectory_open(&params, &trajectory, &error), SM_OUTPUT);
    sm_mesh_free(&sheet);
    assert_non_null(strstr(error.text, "b.h5.xdmf"));
    assert_int_not_equal(access(path_in("b.h5"), F_OK), 0);
    assert_int_equal(entries(".tmp"), 0);
    assert_int_equal(rmdir(path_in("b.h5.xdmf")), 0);
}

TEST(abandoned)
{
    SmMesh sheet;
    make_sheet(0, &sheet);
    BenchTrajectoryParams params = sheet_params(path_in("gone.h5"), &sheet);
    BenchTrajectory *trajectory;
    int before = entries("");
    assert_int_equal(bench_trajectory_open(&params, &trajectory, NULL), SM_OK);
    assert_int_equal(write_frames(trajectory, &sheet, FRAMES, NULL), SM_OK);
    assert_int_equal(entries(""), before + 2); /* with the sidecar's draft */
    bench_trajectory_abandon(trajectory);
    bench_trajectory_abandon(NULL);
    assert_int_equal(entries(""), before);
    sm_mesh_free(&sheet);
}

static void remove_and_die(int number)
{
    bench_drafts_remove();
    signal(number, SIG_DFL);
    raise(number);
}

/* Bytes of the file whose draft is being written. */
static long long draft_bytes(pid_t writer)
{
    char name[64];
    struct stat status;
    snprintf(name, sizeof name, "killed.h5.%ld.tmp", (long)writer);
    return stat(path_in(name), &status) ? -1 : (long long)status.st_size;
}

/* Writes for ever in a child until `number` ends it, which is sent once frames are there. */
static void write_until(int number)
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        if (number != SIGKILL) signal(number, remove_and_die);
        write_sheet(path_in("killed.h5"), 0, 1 << 30, NULL);
        _exit(0);
    }
    while (draft_bytes(child) < 1 << 16 && waitpid(child, NULL, WNOHANG) == 0) usleep(1000);
    kill(child, number);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == number);
    assert_int_not_equal(access(path_in("killed.h5"), F_OK), 0);
    assert_int_not_equal(access(path_in("killed.h5.xdmf"), F_OK), 0);
}

TEST(killed_writer)
{
    char command[300];
    write_until(SIGTERM);
    assert_int_equal(entries(".tmp"), 0);
    write_until(SIGKILL); /* nothing can tidy up after this one */
    assert_int_equal(entries(".tmp"), 2);
    snprintf(command, sizeof command, "rm %s/*.tmp", folder);
    assert_int_equal(system(command), 0);
}

/* A size limit on files stands in for a full disk. HDF5 must neither print nor crash at the
 * program's end. */
static void write_with_limit(long limit)
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        struct rlimit bound = {(rlim_t)limit, RLIM_INFINITY};
        SmError error = {0};
        signal(SIGXFSZ, SIG_IGN);
        if (!freopen(path_in("stderr"), "w", stderr)) _exit(5);
        setrlimit(RLIMIT_FSIZE, &bound);
        SmCode code = write_sheet(path_in("full.h5"), 0, 200, &error);
        if (code != SM_OUTPUT) _exit(2);
        if (!strstr(error.text, "size limit")) _exit(3);
        exit(ftell(stderr) > 0 ? 4 : 0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(unlink(path_in("stderr")), 0);
}

TEST(full_disk)
{
    int before = entries("");
    for (long limit = 0; limit < 300000; limit = 2 * limit + 700) write_with_limit(limit);
    assert_int_equal(entries(""), before);
}

/* Memory that has been freed is overwritten here, so that whoever looks at it again crashes: HDF5
 * is no part of what sanitizers see. */
/* Memory that nobody has set is not zero. */
static int set_up(void **state)
{
    mallopt(M_PERTURB, 0x5a);
    return make_folder(state);
}

TEST_GROUP(set_up, remove_folder)
