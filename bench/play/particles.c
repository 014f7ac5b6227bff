#include "particles.h"

#include <math.h>
#include <stdlib.h>

#include "nodes.h"

static long instance_count(const SmEngineParams *params)
{
    return params->instances > 0 ? params->instances : 1;
}

static void write_cells(BenchH5 *h5, hid_t group, const SmVoxels *voxels)
{
    int(*cell)[3] = sm_alloc((size_t)voxels->cell_count, sizeof *cell);
    hsize_t count = 0;
    for (int k = 0; k < voxels->size[2]; k++)
        for (int j = 0; j < voxels->size[1]; j++)
            for (int i = 0; i < voxels->size[0]; i++) {
                if (!sm_voxel_get(voxels, i, j, k)) continue;
                cell[count][0] = i;
                cell[count][1] = j;
                cell[count++][2] = k;
            }
    hsize_t size[] = {count, 3};
    bench_h5_dataset(h5, group, "cells", H5T_STD_I32LE, 2, size, cell);
    free(cell);
}

static void write_particles(BenchH5 *h5, hid_t group, const SmVoxels *voxels, const double *mass)
{
    size_t count = (size_t)voxels->particle_count;
    int(*coordinate)[3] = sm_alloc(count, sizeof *coordinate);
    double(*rest)[3] = sm_alloc(count, sizeof *rest), *unit = sm_alloc(count, sizeof *unit);
    sm_voxels_particles(voxels, coordinate);
    for (size_t p = 0; p < count; p++) {
        unit[p] = 1.0;
        for (int a = 0; a < 3; a++)
            rest[p][a] = voxels->origin[a] + voxels->cell * coordinate[p][a];
    }
    hsize_t size[] = {count, 3};
    bench_h5_dataset(h5, group, "coordinate", H5T_STD_I32LE, 2, size, coordinate);
    bench_h5_dataset(h5, group, "rest", H5T_IEEE_F64LE, 2, size, rest);
    bench_h5_dataset(h5, group, "mass", H5T_IEEE_F64LE, 1, size, mass ? mass : unit);
    free(coordinate);
    free(rest);
    free(unit);
}

/* The lattice itself, and what is asked of it alone. */
static void write_lattice(BenchH5 *h5, hid_t group, const BenchTrajectoryParams *all)
{
    static const BenchField lattice[] = {
        BENCH_FIELD(SmVoxels, BENCH_INT, size),
        BENCH_FIELD(SmVoxels, BENCH_DOUBLE, origin),
        BENCH_FIELD(SmVoxels, BENCH_DOUBLE, cell),
    };
    static const BenchField own[] = {
        BENCH_FIELD(SmEngineParams, BENCH_INT, w),
        BENCH_FIELD(SmEngineParams, BENCH_DOUBLE, strain_limit),
    };
    bench_h5_fields(h5, group, lattice, 3, all->voxels);
    bench_h5_fields(h5, group, own, 2, all->params);
    write_cells(h5, group, all->voxels);
    write_particles(h5, group, all->voxels, all->mass);
}

static void write_parameters(BenchH5 *h5, hid_t group, const BenchTrajectoryParams *all)
{
    static const BenchField step[] = {
        BENCH_FIELD(SmEngineParams, BENCH_DOUBLE, h),
        BENCH_FIELD(SmEngineParams, BENCH_DOUBLE, damping),
        BENCH_FIELD(SmEngineParams, BENCH_INT, damping_every),
        BENCH_FIELD(SmEngineParams, BENCH_DOUBLE, gravity),
    };
    bench_h5_fields(h5, group, step, 4, all->params);
    long instances = instance_count(all->params);
    bench_h5_numbers(h5, group, "instances", H5T_STD_I64LE, 0, &instances);
    bench_h5_text(h5, group, "engine", all->engine ? all->engine : "unknown");
    bench_h5_text(h5, group, "precision", all->precision ? all->precision : "unknown");
}

/* Which particles follow a handle; and the file's obstacles under a second name. */
static void write_boundary(BenchH5 *h5, hid_t group, const SmBoundary *boundary, long count)
{
    unsigned char *held = sm_alloc((size_t)count, 1);
    for (int i = 0; boundary && i < boundary->handle_count; i++)
        for (long p = 0; p < boundary->handle[i].count; p++)
            held[boundary->handle[i].particle[p]] = 1;
    hsize_t held_size = (hsize_t)count;
    bench_h5_dataset(h5, group, "held", H5T_STD_U8LE, 1, &held_size, held);
    bench_h5_link(h5, "obstacles", group, "obstacles");
    free(held);
}

void bench_particles_begin(BenchH5 *h5, const BenchTrajectoryParams *params,
                           BenchParticles *particles)
{
    bool nodes = params->record == BENCH_RECORD_NODES;
    long count = nodes ? params->structure->tree.leaves : params->voxels->particle_count;
    particles->count = instance_count(params->params) * count;
    hid_t group = bench_h5_group(h5, h5->file, nodes ? "nodes" : "particles");
    write_parameters(h5, group, params);
    if (nodes)
        bench_nodes_write(h5, group, params);
    else
        write_lattice(h5, group, params);
    write_boundary(h5, group, params->boundary, particles->count);
    hsize_t size[] = {0, (hsize_t)particles->count, 3};
    particles->step = bench_h5_growing(h5, group, "step", H5T_STD_I64LE, 1, size);
    particles->x = bench_h5_growing(h5, group, "x", H5T_IEEE_F64LE, 3, size);
    particles->v = bench_h5_growing(h5, group, "v", H5T_IEEE_F64LE, 3, size);
    particles->g = bench_h5_growing(h5, group, "g", H5T_IEEE_F64LE, 3, size);
    size[2] = 9;
    particles->S = nodes && params->params->octree->creep > 0
                       ? bench_h5_growing(h5, group, "S", H5T_IEEE_F64LE, 3, size)
                       : -1;
}

void bench_particles_record(BenchH5 *h5, const BenchParticles *particles, long step,
                            const double (*x)[3], const double (*v)[3], const double (*g)[3],
                            const double (*S)[9])
{
    bench_h5_append(h5, particles->step, 1, &step);
    bench_h5_append(h5, particles->x, 1, x);
    bench_h5_append(h5, particles->v, 1, v);
    if (particles->S >= 0) bench_h5_append(h5, particles->S, 1, S);
    if (g) {
        bench_h5_append(h5, particles->g, 1, g);
        return;
    }
    double *none = sm_alloc(3 * (size_t)particles->count, sizeof *none);
    for (long i = 0; i < 3 * particles->count; i++) none[i] = NAN;
    bench_h5_append(h5, particles->g, 1, none);
    free(none);
}
