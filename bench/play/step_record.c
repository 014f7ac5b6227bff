#include "step_record.h"

#include <math.h>
#include <stdlib.h>

#include "../scene/scene.h"

/* ---- what is of lattices alone */

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
static void write_lattice(BenchH5 *h5, hid_t group, const BenchStepSource *all)
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

/* ---- what is of octrees alone */

static void write_octree_parameters(BenchH5 *h5, hid_t group, const BenchStepSource *all)
{
    static const BenchField options[] = {
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, epsilon),
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, yield),
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, creep),
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, most),
    };
    static const BenchField body[] = {
        BENCH_FIELD(OctStructure, BENCH_DOUBLE, origin),
        BENCH_FIELD(OctStructure, BENCH_DOUBLE, cell),
    };
    OctOptions o = *all->params->octree;
    if (!(o.most > 0)) o.most = 1;
    const OctTree *tree = &all->structure->tree;
    bench_h5_fields(h5, group, options, 4, &o);
    bench_h5_fields(h5, group, body, 2, all->structure);
    bench_h5_text(h5, group, "masses", bench_masses[o.masses]);
    bench_h5_text(h5, group, "symmetry", bench_symmetries[o.symmetry]);
    bench_h5_text(h5, group, "weighting", bench_weightings[o.weighting]);
    bench_h5_text(h5, group, "goals", bench_goal_forms[o.form]);
    bench_h5_numbers(h5, group, "levels", H5T_STD_I32LE, 0, &tree->levels);
    bench_h5_numbers(h5, group, "corner", H5T_STD_I32LE, 3, tree->corner);
}

static void write_tree(BenchH5 *h5, hid_t parent, const OctTree *tree)
{
    hid_t group = bench_h5_group(h5, parent, "tree"), whole = H5T_STD_I32LE;
    hsize_t size[] = {(hsize_t)tree->nodes, 3};
    bench_h5_dataset(h5, group, "centre", whole, 2, size, tree->centre);
    bench_h5_dataset(h5, group, "size", whole, 1, size, tree->size);
    bench_h5_dataset(h5, group, "parent", whole, 1, size, tree->parent);
    bench_h5_dataset(h5, group, "leaf", whole, 1, size, tree->leaf);
    bench_h5_dataset(h5, group, "material", H5T_STD_I64LE, 1, size, tree->material);
}

static void write_leaves(BenchH5 *h5, hid_t group, const OctStructure *s)
{
    size_t count = (size_t)s->tree.leaves;
    double(*rest)[3] = sm_alloc(count, sizeof *rest), *edge = sm_alloc(count, sizeof *edge);
    for (long leaf = 0; leaf < s->tree.leaves; leaf++) {
        oct_structure_centre(s, leaf, rest[leaf]);
        edge[leaf] = 0.5 * s->cell * s->tree.size[s->tree.node[leaf]];
    }
    hsize_t size[] = {count, 3};
    bench_h5_dataset(h5, group, "node", H5T_STD_I32LE, 1, size, s->tree.node);
    bench_h5_dataset(h5, group, "rest", H5T_IEEE_F64LE, 2, size, rest);
    bench_h5_dataset(h5, group, "size", H5T_IEEE_F64LE, 1, size, edge);
    bench_h5_dataset(h5, group, "mass", H5T_IEEE_F64LE, 1, size, s->mass);
    bench_h5_dataset(h5, group, "w", H5T_STD_I32LE, 1, size, s->w);
    bench_h5_dataset(h5, group, "reached", H5T_STD_I32LE, 1, size, s->regions.width);
    free(rest);
    free(edge);
}

/* Every edge once, from the lower leaf. */
static void write_edges(BenchH5 *h5, hid_t group, const OctGraph *graph)
{
    size_t count = (size_t)graph->edges.live / 2;
    int(*edge)[2] = sm_alloc(count, sizeof *edge), *length = sm_alloc(count, sizeof *length);
    size_t at = 0;
    for (long i = 0; i < graph->edges.rows; i++)
        for (long e = graph->edges.first[i]; e < graph->edges.end[i]; e++) {
            if (graph->edges.item[e] < i) continue;
            edge[at][0] = (int)i;
            edge[at][1] = graph->edges.item[e];
            length[at++] = oct_graph_length(graph)[e];
        }
    hsize_t size[] = {count, 2};
    bench_h5_dataset(h5, group, "edge", H5T_STD_I32LE, 2, size, edge);
    bench_h5_dataset(h5, group, "length", H5T_STD_I32LE, 1, size, length);
    free(edge);
    free(length);
}

/* An octree: parameters, tree, leaves, visibility edges and regions. */
static void write_octree(BenchH5 *h5, hid_t group, const BenchStepSource *source)
{
    const OctStructure *s = source->structure;
    write_octree_parameters(h5, group, source);
    write_tree(h5, group, &s->tree);
    write_leaves(h5, group, s);
    write_edges(h5, group, &s->graph);
    hsize_t ends = (hsize_t)s->regions.members.rows + 1;
    hsize_t members = (hsize_t)s->regions.members.live;
    bench_h5_dataset(h5, group, "region_first", H5T_STD_I64LE, 1, &ends, s->regions.members.first);
    bench_h5_dataset(h5, group, "summation", H5T_STD_I32LE, 1, &members, s->regions.members.item);
}

/* ---- both */

static long instance_count(const SmEngineParams *params)
{
    return params->instances > 0 ? params->instances : 1;
}

static void write_parameters(BenchH5 *h5, hid_t group, const BenchStepSource *all)
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

void bench_step_record_begin(BenchH5 *h5, const BenchStepSource *source, BenchStepRecord *record)
{
    bool nodes = source->record == BENCH_RECORD_NODES;
    long count = nodes ? source->structure->tree.leaves : source->voxels->particle_count;
    record->count = instance_count(source->params) * count;
    hid_t group = bench_h5_group(h5, h5->file, nodes ? "nodes" : "particles");
    write_parameters(h5, group, source);
    if (nodes)
        write_octree(h5, group, source);
    else
        write_lattice(h5, group, source);
    write_boundary(h5, group, source->boundary, record->count);
    hsize_t size[] = {0, (hsize_t)record->count, 3};
    record->step = bench_h5_growing(h5, group, "step", H5T_STD_I64LE, 1, size);
    record->x = bench_h5_growing(h5, group, "x", H5T_IEEE_F64LE, 3, size);
    record->v = bench_h5_growing(h5, group, "v", H5T_IEEE_F64LE, 3, size);
    record->g = bench_h5_growing(h5, group, "g", H5T_IEEE_F64LE, 3, size);
    size[2] = 9;
    record->S = nodes && source->params->octree->creep > 0
                    ? bench_h5_growing(h5, group, "S", H5T_IEEE_F64LE, 3, size)
                    : -1;
}

void bench_step_record_append(BenchH5 *h5, const BenchStepRecord *record, long step,
                              const double (*x)[3], const double (*v)[3], const double (*g)[3],
                              const double (*S)[9])
{
    bench_h5_append(h5, record->step, 1, &step);
    bench_h5_append(h5, record->x, 1, x);
    bench_h5_append(h5, record->v, 1, v);
    if (record->S >= 0) bench_h5_append(h5, record->S, 1, S);
    if (g) {
        bench_h5_append(h5, record->g, 1, g);
        return;
    }
    double *none = sm_alloc(3 * (size_t)record->count, sizeof *none);
    for (long i = 0; i < 3 * record->count; i++) none[i] = NAN;
    bench_h5_append(h5, record->g, 1, none);
    free(none);
}
