#include "trajectory.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draft.h"
#include "particles.h"
#include "xdmf.h"

enum { TRAJECTORY_SCHEMA = 2, TRIANGLE_CELL = 5 /* VTK_TRIANGLE */ };

struct BenchTrajectory {
    BenchDraft draft;
    BenchH5 h5;
    char scene[256];
    long points, triangles, frames, room;
    double *time;  /* [room] */
    void *packed;  /* a frame's points as stored */
    bool single;   /* coordinates are stored in 4 bytes */
    hid_t dataset; /* /VTKHDF/Points */
    BenchParticles particles;
};

/* Single precision shows a surface to 1e-6 of its size unless it lies far from the origin. */
static bool single_is_enough(const SmMesh *mesh)
{
    double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    double far = 0, extent = 0;
    for (long i = 0; i < mesh->vertex_count; i++)
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], mesh->position[i][a]);
            high[a] = fmax(high[a], mesh->position[i][a]);
            far = fmax(far, fabs(mesh->position[i][a]));
        }
    for (int a = 0; a < 3; a++) extent = fmax(extent, high[a] - low[a]);
    return far * FLT_EPSILON / 2 <= 1e-6 * extent;
}

static void write_topology(BenchH5 *h5, hid_t group, const SmMesh *surface)
{
    size_t count = (size_t)surface->triangle_count;
    long(*corner)[3] = sm_alloc(count, sizeof *corner), *offset = sm_alloc(count + 1, sizeof(long));
    unsigned char *type = sm_alloc(count, 1);
    for (size_t t = 0; t < count; t++) {
        for (int c = 0; c < 3; c++) corner[t][c] = surface->triangle[t][c];
        offset[t + 1] = 3 * (long)t + 3;
        type[t] = TRIANGLE_CELL;
    }
    long corners = 3 * surface->triangle_count;
    hsize_t one = 1, cells = count, ends = count + 1, connected = (hsize_t)corners;
    hid_t whole = H5T_STD_I64LE;
    bench_h5_dataset(h5, group, "NumberOfPoints", whole, 1, &one, &surface->vertex_count);
    bench_h5_dataset(h5, group, "NumberOfCells", whole, 1, &one, &surface->triangle_count);
    bench_h5_dataset(h5, group, "NumberOfConnectivityIds", whole, 1, &one, &corners);
    bench_h5_dataset(h5, group, "Connectivity", whole, 1, &connected, corner);
    bench_h5_dataset(h5, group, "Offsets", whole, 1, &ends, offset);
    bench_h5_dataset(h5, group, "Types", H5T_STD_U8LE, 1, &cells, type);
    free(corner);
    free(offset);
    free(type);
}

/* VTK's reader takes the attribute Type only as a fixed-length ASCII string without a zero. */
static void write_type(BenchH5 *h5, hid_t group)
{
    static const char name[] = "UnstructuredGrid";
    if (h5->failed) return;
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, sizeof name - 1);
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    hid_t attribute = H5Acreate2(group, "Type", type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0 || H5Awrite(attribute, type, name) < 0)
        bench_h5_fail(h5, "HDF5 cannot write an attribute");
    if (attribute >= 0) H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
}

static void write_beginning(BenchTrajectory *trajectory, const BenchTrajectoryParams *params)
{
    BenchH5 *h5 = &trajectory->h5;
    int schema = TRAJECTORY_SCHEMA, machine_count;
    const BenchField *machine_fields = bench_machine_fields(&machine_count);
    bench_h5_text(h5, h5->file, "kind", "shapebench trajectory");
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_text(h5, h5->file, "scene", params->scene);
    hid_t group = bench_h5_group(h5, h5->file, "machine");
    bench_h5_fields(h5, group, machine_fields, machine_count, params->machine);
    group = bench_h5_group(h5, h5->file, "VTKHDF");
    bench_h5_numbers(h5, group, "Version", H5T_STD_I64LE, 2, (long[]){2, 0});
    write_type(h5, group);
    write_topology(h5, group, params->surface);
    hsize_t size[] = {0, 3};
    trajectory->dataset = bench_h5_growing(
        h5, group, "Points", trajectory->single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE, 2, size);
    if (params->record) bench_particles_begin(h5, params, &trajectory->particles);
}

/* Ends the writing: the draft goes, the cause is told. */
static SmCode fail(BenchTrajectory *trajectory, SmError *error)
{
    bench_h5_close(&trajectory->h5);
    bench_draft_discard(&trajectory->draft);
    return bench_draft_fail(trajectory->draft.path, trajectory->h5.number, trajectory->h5.message,
                            error);
}

static void release(BenchTrajectory *trajectory)
{
    free(trajectory->time);
    free(trajectory->packed);
    free(trajectory);
}

SmCode bench_trajectory_open(const BenchTrajectoryParams *params, BenchTrajectory **trajectory,
                             SmError *error)
{
    *trajectory = NULL;
    const char *slash = strrchr(params->path, '/');
    if (strchr(slash ? slash : params->path, ':'))
        return sm_fail(error, SM_USAGE,
                       "cannot write %.300s: XDMF cannot name a file with a colon; "
                       "choose another name",
                       params->path);
    BenchTrajectory *made = sm_alloc(1, sizeof *made);
    SmCode code = bench_draft_begin(params->path, &made->draft, error);
    if (code != SM_OK) {
        release(made);
        return code;
    }
    snprintf(made->scene, sizeof made->scene, "%s", params->scene);
    made->points = params->surface->vertex_count;
    made->triangles = params->surface->triangle_count;
    made->single = single_is_enough(params->surface);
    made->packed = sm_alloc(3 * (size_t)made->points, sizeof(double));
    bench_h5_create(&made->h5, made->draft.tmp);
    write_beginning(made, params);
    if (made->h5.failed) {
        code = fail(made, error);
        release(made);
        return code;
    }
    *trajectory = made;
    return SM_OK;
}

double bench_trajectory_bytes(const BenchTrajectory *trajectory, double frames)
{
    double point = 3 * (trajectory->single ? sizeof(float) : sizeof(double));
    double triangle = 4 * sizeof(long) + 1; /* corners, offset, type */
    return frames * point * (double)trajectory->points + triangle * (double)trajectory->triangles;
}

SmCode bench_trajectory_frame(BenchTrajectory *trajectory, double time, const double (*point)[3],
                              SmError *error)
{
    if (trajectory->frames == trajectory->room) {
        trajectory->room = 2 * trajectory->room + 64;
        trajectory->time = sm_realloc(trajectory->time, (size_t)trajectory->room, sizeof(double));
    }
    trajectory->time[trajectory->frames++] = time;
    const double *from = &point[0][0];
    float *narrow = trajectory->packed;
    if (trajectory->single)
        for (long i = 0; i < 3 * trajectory->points; i++) narrow[i] = (float)from[i];
    bench_h5_append(&trajectory->h5, trajectory->dataset, (hsize_t)trajectory->points,
                    trajectory->single ? trajectory->packed : (const void *)from);
    return trajectory->h5.failed ? fail(trajectory, error) : SM_OK;
}

SmCode bench_trajectory_step(BenchTrajectory *trajectory, long step, const double (*x)[3],
                             const double (*v)[3], const double (*g)[3], const double (*S)[9],
                             SmError *error)
{
    bench_particles_record(&trajectory->h5, &trajectory->particles, step, x, v, g, S);
    return trajectory->h5.failed ? fail(trajectory, error) : SM_OK;
}

/* /VTKHDF/Steps: every step has its own points and shares the one topology. */
static void write_steps(BenchTrajectory *trajectory)
{
    BenchH5 *h5 = &trajectory->h5;
    size_t count = (size_t)trajectory->frames;
    long *zero = sm_alloc(count, sizeof *zero), *one = sm_alloc(count, sizeof *one);
    long *start = sm_alloc(count, sizeof *start);
    for (size_t i = 0; i < count; i++) {
        one[i] = 1;
        start[i] = (long)i * trajectory->points;
    }
    hid_t whole = H5T_STD_I64LE, group = bench_h5_group(h5, h5->file, "VTKHDF/Steps");
    hsize_t size[] = {count, 1};
    bench_h5_numbers(h5, group, "NSteps", whole, 0, &trajectory->frames);
    bench_h5_dataset(h5, group, "Values", H5T_IEEE_F64LE, 1, size, trajectory->time);
    bench_h5_dataset(h5, group, "PartOffsets", whole, 1, size, zero);
    bench_h5_dataset(h5, group, "NumberOfParts", whole, 1, size, one);
    bench_h5_dataset(h5, group, "PointOffsets", whole, 1, size, start);
    bench_h5_dataset(h5, group, "CellOffsets", whole, 2, size, zero);
    bench_h5_dataset(h5, group, "ConnectivityIdOffsets", whole, 2, size, zero);
    free(zero);
    free(one);
    free(start);
}

/* /frames/0, /frames/1, ...: each frame's part of /VTKHDF/Points under a name of its own, without a
 * copy (HDF5 virtual datasets). XDMF could cut the parts itself (HyperSlab), but ParaView 5.11's
 * reader reports an error at every frame that it reads so. */
static void write_views(BenchTrajectory *trajectory)
{
    BenchH5 *h5 = &trajectory->h5;
    hid_t group = bench_h5_group(h5, h5->file, "frames");
    hsize_t count = (hsize_t)trajectory->points;
    for (long frame = 0; frame < trajectory->frames; frame++) {
        char name[24];
        hsize_t start[] = {(hsize_t)frame * count, 0}, size[] = {count, 3};
        snprintf(name, sizeof name, "%ld", frame);
        bench_h5_view(h5, group, name, trajectory->dataset, start, size);
    }
}

static SmCode commit(BenchTrajectory *trajectory, BenchDraft *sidecar, SmError *error)
{
    BenchXdmf xdmf = {trajectory->draft.path, trajectory->scene,  trajectory->points,
                      trajectory->triangles,  trajectory->frames, trajectory->single ? 4 : 8,
                      trajectory->time};
    SmCode code = bench_xdmf_write(&xdmf, sidecar, error);
    if (code == SM_OK) code = bench_draft_commit(&trajectory->draft, error);
    if (code == SM_OK) return bench_draft_commit(sidecar, error);
    bench_draft_discard(sidecar);
    bench_draft_discard(&trajectory->draft);
    return code;
}

SmCode bench_trajectory_close(BenchTrajectory *trajectory, SmError *error)
{
    SmCode code;
    write_steps(trajectory);
    write_views(trajectory);
    if (!bench_h5_close(&trajectory->h5)) {
        code = fail(trajectory, error);
    } else {
        char path[BENCH_DRAFT_PATH + 8];
        BenchDraft sidecar;
        snprintf(path, sizeof path, "%s.xdmf", trajectory->draft.path);
        code = bench_draft_begin(path, &sidecar, error);
        if (code == SM_OK)
            code = commit(trajectory, &sidecar, error);
        else
            bench_draft_discard(&trajectory->draft);
    }
    release(trajectory);
    return code;
}

void bench_trajectory_abandon(BenchTrajectory *trajectory)
{
    if (!trajectory) return;
    trajectory->h5.failed = true;
    bench_h5_close(&trajectory->h5);
    bench_draft_discard(&trajectory->draft);
    release(trajectory);
}
