#include "trajectory.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../store/draft.h"
#include "xdmf.h"

enum { TRAJECTORY_SCHEMA = 4, VERTEX_CELL = 1, TRIANGLE_CELL = 5 /* as VTK has them */ };

/* Of a surface: what frames share between two changes of topology. */
typedef struct {
    long points, cells;
    int corners;       /* of a cell */
    long cell, corner; /* its first in /VTKHDF/Types and in Connectivity */
} Topology;

struct BenchTrajectory {
    BenchDraft draft, sidecar; /* of the HDF5 and of the XDMF file */
    BenchH5 h5;
    char scene[256];
    long frames, room;
    double *time; /* [room] */
    long *part;   /* [room] a frame's topology */
    long parts;
    Topology *topology; /* [parts] */
    void *packed;       /* a frame's points as stored */
    bool single;        /* coordinates are stored in 4 bytes */
    hid_t points;       /* /VTKHDF/Points, ... */
    hid_t corners, offsets, types;
    BenchFields fields;
    hid_t value[BENCH_POINT_FIELDS]; /* /VTKHDF/PointData/NAME */
    BenchStepRecord record;
};

/* Single precision shows a surface to 1e-6 of its size unless it lies far from the origin. */
static bool single_is_enough(const SmMesh *mesh)
{
    SmBox box = sm_box_around(mesh->vertex_count, (const double(*)[3])mesh->position);
    double far = 0;
    for (int a = 0; a < 3; a++) far = fmax(far, fmax(fabs(box.low[a]), fabs(box.high[a])));
    return far * FLT_EPSILON / 2 <= 1e-6 * sm_box_longest(&box);
}

static void discard(BenchTrajectory *trajectory)
{
    bench_draft_discard(&trajectory->draft);
    bench_draft_discard(&trajectory->sidecar);
}

/* Ends the writing: removes the drafts and says why. */
static SmCode fail(BenchTrajectory *trajectory, SmError *error)
{
    bench_h5_close(&trajectory->h5);
    discard(trajectory);
    return bench_draft_fail(trajectory->draft.path, trajectory->h5.number, trajectory->h5.message,
                            error);
}

/* A surface's triangles, or its points, behind what the surfaces before had. */
static void write_topology(BenchTrajectory *trajectory, const Topology *topology,
                           const SmMesh *surface)
{
    BenchH5 *h5 = &trajectory->h5;
    size_t count = (size_t)topology->cells, corners = (size_t)topology->corners;
    long *corner = sm_alloc(corners * count, sizeof *corner);
    long *offset = sm_alloc(count + 1, sizeof(long));
    unsigned char *type = sm_alloc(count, 1);
    for (size_t cell = 0; cell < count; cell++) {
        corner[corners * cell] = (long)cell;
        for (size_t c = 0; corners == 3 && c < 3; c++)
            corner[3 * cell + c] = surface->triangle[cell][c];
        offset[cell + 1] = (long)(corners * (cell + 1));
        type[cell] = corners == 3 ? TRIANGLE_CELL : VERTEX_CELL;
    }
    bench_h5_append(h5, trajectory->corners, corners * count, corner);
    bench_h5_append(h5, trajectory->offsets, count + 1, offset);
    bench_h5_append(h5, trajectory->types, count, type);
    free(corner);
    free(offset);
    free(type);
}

static void add_topology(BenchTrajectory *trajectory, const SmMesh *surface)
{
    long parts = trajectory->parts++;
    trajectory->topology =
        sm_realloc(trajectory->topology, (size_t)trajectory->parts, sizeof(Topology));
    Topology *topology = &trajectory->topology[parts];
    *topology = surface->triangle_count > 0
                    ? (Topology){surface->vertex_count, surface->triangle_count, 3, 0, 0}
                    : (Topology){surface->vertex_count, surface->vertex_count, 1, 0, 0};
    if (parts) {
        topology->cell = topology[-1].cell + topology[-1].cells;
        topology->corner = topology[-1].corner + topology[-1].corners * topology[-1].cells;
    }
    trajectory->packed =
        sm_realloc(trajectory->packed, 3 * (size_t)surface->vertex_count, sizeof(double));
    write_topology(trajectory, topology, surface);
}

SmCode bench_trajectory_topology(BenchTrajectory *trajectory, const SmMesh *surface, SmError *error)
{
    add_topology(trajectory, surface);
    return trajectory->h5.failed ? fail(trajectory, error) : SM_OK;
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

/* As rows of numbers. */
static void write_obstacles(BenchH5 *h5, const SmBoundary *boundary)
{
    int count = boundary ? boundary->obstacle_count : 0;
    double(*row)[9] = sm_alloc((size_t)count, sizeof *row);
    for (int i = 0; i < count; i++) {
        const SmObstacle *o = &boundary->obstacle[i];
        const double values[9] = {o->kind, o->a[0], o->a[1],   o->a[2],    o->b[0],
                                  o->b[1], o->b[2], o->radius, o->friction};
        for (int a = 0; a < 9; a++) row[i][a] = values[a];
    }
    hsize_t size[] = {(hsize_t)count, 9};
    bench_h5_dataset(h5, h5->file, "obstacles", H5T_IEEE_F64LE, 2, size, row);
    free(row);
}

/* They grow as points do. */
static void begin_fields(BenchTrajectory *trajectory)
{
    BenchH5 *h5 = &trajectory->h5;
    if (!trajectory->fields) return;
    hid_t group = bench_h5_group(h5, h5->file, "VTKHDF/PointData");
    for (int f = 0; f < BENCH_POINT_FIELDS; f++) {
        hsize_t size[] = {0, (hsize_t)bench_field_components[f]};
        if (trajectory->fields & 1u << f)
            trajectory->value[f] = bench_h5_growing(h5, group, bench_field_names[f], H5T_IEEE_F32LE,
                                                    size[1] > 1 ? 2 : 1, size);
    }
}

static void write_beginning(BenchTrajectory *trajectory, const BenchTrajectoryParams *params)
{
    BenchH5 *h5 = &trajectory->h5;
    int schema = TRAJECTORY_SCHEMA;
    bench_h5_text(h5, h5->file, "kind", "shapebench trajectory");
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_text(h5, h5->file, "scene", params->scene);
    bench_machine_store(h5, params->machine);
    write_obstacles(h5, params->steps.boundary);
    hid_t group = bench_h5_group(h5, h5->file, "VTKHDF");
    bench_h5_numbers(h5, group, "Version", H5T_STD_I64LE, 2, (long[]){2, 0});
    write_type(h5, group);
    hsize_t size[] = {0, 3};
    hid_t whole = H5T_STD_I64LE, real = trajectory->single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    trajectory->points = bench_h5_growing(h5, group, "Points", real, 2, size);
    trajectory->corners = bench_h5_growing(h5, group, "Connectivity", whole, 1, size);
    trajectory->offsets = bench_h5_growing(h5, group, "Offsets", whole, 1, size);
    trajectory->types = bench_h5_growing(h5, group, "Types", H5T_STD_U8LE, 1, size);
    begin_fields(trajectory);
    add_topology(trajectory, params->surface);
    if (params->steps.record) bench_step_record_begin(h5, &params->steps, &trajectory->record);
}

static void release(BenchTrajectory *trajectory)
{
    free(trajectory->time);
    free(trajectory->part);
    free(trajectory->topology);
    free(trajectory->packed);
    free(trajectory);
}

/* Both drafts: nothing is simulated for a file that cannot be written. */
static SmCode begin(BenchTrajectory *trajectory, const char *path, SmError *error)
{
    char sidecar[BENCH_DRAFT_PATH + 8];
    snprintf(sidecar, sizeof sidecar, "%s.xdmf", path);
    SmCode code = bench_draft_begin(path, &trajectory->draft, error);
    if (code) return code;
    code = bench_draft_begin(sidecar, &trajectory->sidecar, error);
    if (code) bench_draft_discard(&trajectory->draft);
    return code;
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
    SmCode code = begin(made, params->path, error);
    if (code != SM_OK) {
        release(made);
        return code;
    }
    snprintf(made->scene, sizeof made->scene, "%s", params->scene);
    made->fields = params->fields;
    made->single = single_is_enough(params->surface);
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
    for (int f = 0; f < BENCH_POINT_FIELDS; f++)
        if (trajectory->fields & 1u << f) point += bench_field_components[f] * sizeof(float);
    const Topology *first = trajectory->topology;
    double cell = (double)(first->corners + 1) * sizeof(long) + 1; /* corners, offset, type */
    return frames * point * (double)first->points + cell * (double)first->cells;
}

SmCode bench_trajectory_frame(BenchTrajectory *trajectory, double time, const double (*point)[3],
                              const float *const value[BENCH_POINT_FIELDS], SmError *error)
{
    long points = trajectory->topology[trajectory->parts - 1].points;
    if (trajectory->frames == trajectory->room) {
        trajectory->room = 2 * trajectory->room + 64;
        trajectory->time = sm_realloc(trajectory->time, (size_t)trajectory->room, sizeof(double));
        trajectory->part = sm_realloc(trajectory->part, (size_t)trajectory->room, sizeof(long));
    }
    trajectory->part[trajectory->frames] = trajectory->parts - 1;
    trajectory->time[trajectory->frames++] = time;
    const double *from = &point[0][0];
    float *narrow = trajectory->packed;
    if (trajectory->single)
        for (long i = 0; i < 3 * points; i++) narrow[i] = (float)from[i];
    bench_h5_append(&trajectory->h5, trajectory->points, (hsize_t)points,
                    trajectory->single ? trajectory->packed : (const void *)from);
    for (int f = 0; f < BENCH_POINT_FIELDS; f++)
        if (trajectory->fields & 1u << f)
            bench_h5_append(&trajectory->h5, trajectory->value[f], (hsize_t)points, value[f]);
    return trajectory->h5.failed ? fail(trajectory, error) : SM_OK;
}

SmCode bench_trajectory_step(BenchTrajectory *trajectory, long step, const double (*x)[3],
                             const double (*v)[3], const double (*g)[3], const double (*S)[9],
                             SmError *error)
{
    bench_step_record_append(&trajectory->h5, &trajectory->record, step, x, v, g, S);
    return trajectory->h5.failed ? fail(trajectory, error) : SM_OK;
}

/* How many points, cells and corners each topology has: a part of VTKHDF's. */
static void write_parts(BenchTrajectory *trajectory)
{
    BenchH5 *h5 = &trajectory->h5;
    size_t count = (size_t)trajectory->parts;
    long *points = sm_alloc(count, sizeof *points), *cells = sm_alloc(count, sizeof *cells);
    long *corners = sm_alloc(count, sizeof *corners);
    for (size_t i = 0; i < count; i++) {
        points[i] = trajectory->topology[i].points;
        cells[i] = trajectory->topology[i].cells;
        corners[i] = trajectory->topology[i].corners * cells[i];
    }
    hid_t whole = H5T_STD_I64LE, file = h5->file;
    hsize_t size = count;
    bench_h5_dataset(h5, file, "VTKHDF/NumberOfPoints", whole, 1, &size, points);
    bench_h5_dataset(h5, file, "VTKHDF/NumberOfCells", whole, 1, &size, cells);
    bench_h5_dataset(h5, file, "VTKHDF/NumberOfConnectivityIds", whole, 1, &size, corners);
    free(points);
    free(cells);
    free(corners);
}

/* /VTKHDF/Steps: every step has its own points; steps of one topology share it. */
static void write_steps(BenchTrajectory *trajectory)
{
    BenchH5 *h5 = &trajectory->h5;
    size_t count = (size_t)trajectory->frames;
    long *one = sm_alloc(count, sizeof *one), *point = sm_alloc(count, sizeof *point);
    long *cell = sm_alloc(count, sizeof *cell), *corner = sm_alloc(count, sizeof *corner), at = 0;
    for (size_t i = 0; i < count; i++) {
        const Topology *topology = &trajectory->topology[trajectory->part[i]];
        one[i] = 1;
        point[i] = at;
        cell[i] = topology->cell;
        corner[i] = topology->corner;
        at += topology->points;
    }
    hid_t whole = H5T_STD_I64LE, group = bench_h5_group(h5, h5->file, "VTKHDF/Steps");
    hsize_t size[] = {count, 1};
    bench_h5_numbers(h5, group, "NSteps", whole, 0, &trajectory->frames);
    bench_h5_dataset(h5, group, "Values", H5T_IEEE_F64LE, 1, size, trajectory->time);
    bench_h5_dataset(h5, group, "PartOffsets", whole, 1, size, trajectory->part);
    bench_h5_dataset(h5, group, "NumberOfParts", whole, 1, size, one);
    bench_h5_dataset(h5, group, "PointOffsets", whole, 1, size, point);
    bench_h5_dataset(h5, group, "CellOffsets", whole, 2, size, cell);
    bench_h5_dataset(h5, group, "ConnectivityIdOffsets", whole, 2, size, corner);
    if (trajectory->fields) group = bench_h5_group(h5, group, "PointDataOffsets");
    for (int f = 0; f < BENCH_POINT_FIELDS; f++)
        if (trajectory->fields & 1u << f)
            bench_h5_dataset(h5, group, bench_field_names[f], whole, 1, size, point);
    free(one);
    free(point);
    free(cell);
    free(corner);
}

/* Each frame's part, from its first point on, of a dataset that all share, as GROUP/0, GROUP/1. */
static void view_frames(BenchTrajectory *trajectory, const char *where, hid_t shared, hsize_t width)
{
    BenchH5 *h5 = &trajectory->h5;
    hid_t group = bench_h5_group(h5, h5->file, where);
    hsize_t start[] = {0, 0};
    char name[24];
    for (long frame = 0; frame < trajectory->frames; frame++) {
        hsize_t size[] = {(hsize_t)trajectory->topology[trajectory->part[frame]].points, width};
        snprintf(name, sizeof name, "%ld", frame);
        bench_h5_view(h5, group, name, shared, start, size);
        start[0] += size[0];
    }
}

/* /frames/0, /frames/1, ...: each frame's part of /VTKHDF/Points under a name of its own, without a
 * copy (HDF5 virtual datasets), and so /fields/NAME/0, ... of fields, and /topologies/0, ... of
 * /VTKHDF/Connectivity. XDMF could cut the parts itself (HyperSlab), but ParaView 5.11's reader
 * reports an error at every frame that it reads so. */
static void write_views(BenchTrajectory *trajectory)
{
    BenchH5 *h5 = &trajectory->h5;
    char name[48];
    view_frames(trajectory, "frames", trajectory->points, 3);
    if (trajectory->fields) bench_h5_group(h5, h5->file, "fields");
    for (int f = 0; f < BENCH_POINT_FIELDS; f++) {
        if (!(trajectory->fields & 1u << f)) continue;
        snprintf(name, sizeof name, "fields/%s", bench_field_names[f]);
        view_frames(trajectory, name, trajectory->value[f], (hsize_t)bench_field_components[f]);
    }
    hid_t group = bench_h5_group(h5, h5->file, "topologies");
    for (long part = 0; part < trajectory->parts; part++) {
        const Topology *topology = &trajectory->topology[part];
        hsize_t first = (hsize_t)topology->corner;
        hsize_t size = (hsize_t)topology->corners * (hsize_t)topology->cells;
        snprintf(name, sizeof name, "%ld", part);
        bench_h5_view(h5, group, name, trajectory->corners, &first, &size);
    }
}

/* The sidecar's counts of every frame. */
static SmCode write_sidecar(const BenchTrajectory *trajectory, SmError *error)
{
    size_t count = (size_t)trajectory->frames;
    BenchXdmfFrame *frame = sm_alloc(count, sizeof *frame);
    for (size_t i = 0; i < count; i++) {
        const Topology *topology = &trajectory->topology[trajectory->part[i]];
        frame[i] = (BenchXdmfFrame){trajectory->time[i], topology->points, topology->cells,
                                    topology->corners, trajectory->part[i]};
    }
    BenchXdmf xdmf = {trajectory->draft.path,     trajectory->scene,  trajectory->frames,
                      trajectory->single ? 4 : 8, trajectory->fields, frame};
    SmCode code = bench_xdmf_write(&xdmf, &trajectory->sidecar, error);
    free(frame);
    return code;
}

SmCode bench_trajectory_close(BenchTrajectory *trajectory, const char *hash, SmError *error)
{
    SmCode code;
    bench_h5_text(&trajectory->h5, trajectory->h5.file, "state_hash", hash);
    write_parts(trajectory);
    write_steps(trajectory);
    write_views(trajectory);
    if (!bench_h5_close(&trajectory->h5)) {
        code = fail(trajectory, error);
    } else {
        code = write_sidecar(trajectory, error);
        if (!code) code = bench_draft_commit(&trajectory->draft, error);
        if (!code) code = bench_draft_commit(&trajectory->sidecar, error);
        if (code) discard(trajectory);
    }
    release(trajectory);
    return code;
}

void bench_trajectory_abandon(BenchTrajectory *trajectory)
{
    if (!trajectory) return;
    trajectory->h5.failed = true; /* nothing more is written */
    bench_h5_close(&trajectory->h5);
    discard(trajectory);
    release(trajectory);
}
