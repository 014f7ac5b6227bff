#include "map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../../lib/system/clock.h"
#include "../../reference/meshless/shell_engine.h"
#include "../store/h5.h"
#include "body.h"

enum { SCHEMA = 1 };

#define CONST(array) ((const double(*)[3])(array))

/* ---- made */

static SmCode map_surface(const char *source, RefSurfaceMap *map, double *longest, SmError *error)
{
    SmMesh mesh;
    SmError why;
    bool of_points;
    SmCode code = bench_sheet_load(source, &mesh, &of_points, error);
    if (code != SM_OK) return code;
    SmBox box = sm_box_around(mesh.vertex_count, CONST(mesh.position));
    *longest = sm_box_longest(&box);
    code =
        ref_surface_map_create(&mesh, of_points, of_points ? "the points" : "the mesh", map, &why);
    sm_mesh_free(&mesh);
    return code == SM_OK ? SM_OK : sm_fail(error, code, "%s: %s", source, why.text);
}

static int by_value(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static void look_at_factors(BenchMap *map)
{
    size_t count = (size_t)map->map.vertices;
    double *factor = sm_alloc(count, sizeof *factor);
    memcpy(factor, map->map.factor, count * sizeof *factor);
    qsort(factor, count, sizeof *factor, by_value);
    map->factors[0] = factor[0];
    map->factors[1] = factor[count / 2];
    map->factors[2] = factor[count - 1];
    free(factor);
}

static void look_at_covers(BenchMap *map)
{
    RefShape shape = ref_shape_create(&map->shell.nodes);
    long covered = 0;
    for (long p = 0; p < map->map.vertices; p++) {
        const double theta[3] = {map->map.theta[p][0], map->map.theta[p][1]};
        if (!ref_shell_shape(&map->shell, theta, &shape)) continue;
        if (covered++ == 0 || shape.count < map->least_covers) map->least_covers = shape.count;
        map->mean_covers += shape.count;
    }
    map->mean_covers /= covered > 0 ? (double)covered : 1;
    map->uncovered = map->map.vertices - covered;
    ref_shape_free(&shape);
}

/* Where a cell is in the plane; returns the root of the mean of L^2 there. */
static double cell_factor(const RefQuadtree *tree, const RefCell *cell, double low[2],
                          double high[2])
{
    double middle[2], edge[2];
    ref_quadtree_cell(tree, cell, middle, edge);
    for (int d = 0; d < 2; d++) {
        low[d] = middle[d] - edge[d] / 2;
        high[d] = middle[d] + edge[d] / 2;
    }
    return tree->chart->mean(tree->chart->data, low, high);
}

double bench_map_spread(const RefQuadtree *tree)
{
    double sum = 0, squares = 0;
    for (long c = 0; c < tree->count; c++) {
        double low[2], high[2];
        if (tree->cell[c].child >= 0) continue;
        double length = cell_factor(tree, tree->cell + c, low, high);
        length *= sqrt((high[0] - low[0]) * (high[1] - low[1]));
        sum += length;
        squares += length * length;
    }
    double leaves = (double)tree->leaves;
    return sqrt(fmax(squares * leaves / (sum * sum) - 1, 0));
}

SmCode bench_map_make(const char *source, long nodes, BenchMap *map, SmError *error)
{
    double longest;
    SmError why;
    *map = (BenchMap){.spread = 0};
    SmCode code = map_surface(source, &map->map, &longest, error);
    if (code != SM_OK) return code;
    RefMeshlessOptions options = {.nodes = nodes,
                                  .material = {.young = 1, .poisson = 0.3, .density = 1}};
    RefShellOptions shell = ref_shell_options(&options, longest);
    double start = sm_now();
    code = ref_shell_build(&map->map.chart, &shell, &map->shell, &why);
    map->shell_seconds = sm_now() - start;
    if (code != SM_OK) {
        ref_surface_map_free(&map->map);
        return sm_fail(error, code, "%s: %s", source, why.text);
    }
    map->spread = bench_map_spread(&map->shell.tree);
    look_at_factors(map);
    look_at_covers(map);
    return SM_OK;
}

void bench_map_free(BenchMap *map)
{
    ref_shell_free(&map->shell);
    ref_surface_map_free(&map->map);
}

/* ---- stored */

typedef struct {
    const BenchMap *map;
    const char *source;
} File;

static void write_numbers(BenchH5 *h5, hid_t group, const char *name, hid_t type, long rows,
                          long columns, const void *values)
{
    bench_h5_dataset(h5, group, name, type, columns > 1 ? 2 : 1,
                     (hsize_t[]){(hsize_t)rows, (hsize_t)columns}, values);
}

static void write_seams(BenchH5 *h5, const RefChart *chart)
{
    double shift[REF_MOST_SEAMS][2];
    unsigned char turned[REF_MOST_SEAMS];
    for (int s = 0; s < chart->seams; s++) {
        memcpy(shift[s], chart->seam[s].shift, sizeof shift[s]);
        turned[s] = chart->seam[s].turned;
    }
    hid_t group = bench_h5_group(h5, h5->file, "seams");
    write_numbers(h5, group, "shift", H5T_IEEE_F64LE, chart->seams, 2, shift);
    write_numbers(h5, group, "turned", H5T_STD_U8LE, chart->seams, 1, turned);
}

/* The rectangles of a surface with two handles or holes and more, and what joins them. */
static void write_cylinders(BenchH5 *h5, const RefCylinders *all)
{
    size_t count = (size_t)all->count, joints = (size_t)all->joints;
    double(*low)[2] = sm_alloc(count, sizeof *low), (*high)[2] = sm_alloc(count, sizeof *high);
    double(*shift)[2] = sm_alloc(joints, sizeof *shift);
    double *begin = sm_alloc(joints, sizeof *begin), *end = sm_alloc(joints, sizeof *end);
    int *from = sm_alloc(joints, sizeof *from), *to = sm_alloc(joints, sizeof *to);
    unsigned char *up = sm_alloc(joints, sizeof *up);
    for (size_t c = 0; c < count; c++) {
        memcpy(low[c], all->cylinder[c].low, sizeof low[c]);
        memcpy(high[c], all->cylinder[c].high, sizeof high[c]);
    }
    for (size_t j = 0; j < joints; j++) {
        const RefJoint *joint = all->joint + j;
        from[j] = joint->from;
        to[j] = joint->to;
        up[j] = joint->up;
        begin[j] = joint->begin;
        end[j] = joint->end;
        memcpy(shift[j], joint->shift, sizeof shift[j]);
    }
    hid_t group = bench_h5_group(h5, h5->file, "cylinders");
    write_numbers(h5, group, "low", H5T_IEEE_F64LE, all->count, 2, low);
    write_numbers(h5, group, "high", H5T_IEEE_F64LE, all->count, 2, high);
    group = bench_h5_group(h5, h5->file, "joints");
    write_numbers(h5, group, "from", H5T_STD_I32LE, all->joints, 1, from);
    write_numbers(h5, group, "to", H5T_STD_I32LE, all->joints, 1, to);
    write_numbers(h5, group, "up", H5T_STD_U8LE, all->joints, 1, up);
    write_numbers(h5, group, "begin", H5T_IEEE_F64LE, all->joints, 1, begin);
    write_numbers(h5, group, "end", H5T_IEEE_F64LE, all->joints, 1, end);
    write_numbers(h5, group, "shift", H5T_IEEE_F64LE, all->joints, 2, shift);
    sm_free_all(low, high, shift, begin, end, from, to, up);
}

/* The triangles of the map, and those of their points that were given. */
static void write_surface(BenchH5 *h5, const RefSurfaceMap *map)
{
    const RefTriangulation *surface = ref_surface_map_triangles(map);
    size_t triangles = (size_t)surface->triangles;
    double(*theta)[3][2] = sm_alloc(triangles, sizeof *theta);
    double(*off)[3] = sm_alloc(triangles, sizeof *off);
    double *factor = sm_alloc((size_t)surface->vertices, sizeof *factor);
    for (size_t t = 0; t < triangles; t++) {
        RefMapTriangle one = ref_surface_map_triangle(map, (long)t);
        memcpy(theta[t], one.theta, sizeof theta[t]);
        memcpy(off[t], one.off, sizeof off[t]);
        for (int i = 0; i < 3; i++) factor[surface->vertex[3 * t + (size_t)i]] = one.factor[i];
    }
    hid_t group = bench_h5_group(h5, h5->file, "surface");
    write_numbers(h5, group, "points", H5T_IEEE_F64LE, surface->vertices, 3, surface->position);
    write_numbers(h5, group, "factor", H5T_IEEE_F64LE, surface->vertices, 1, factor);
    write_numbers(h5, group, "given", H5T_STD_I32LE, surface->vertices, 1, surface->source);
    write_numbers(h5, group, "triangles", H5T_STD_I32LE, surface->triangles, 3, surface->vertex);
    bench_h5_dataset(h5, group, "parameters", H5T_IEEE_F64LE, 3, (hsize_t[]){triangles, 3, 2},
                     theta);
    write_numbers(h5, group, "angle_error", H5T_IEEE_F64LE, surface->triangles, 3, off);
    sm_free_all(theta, off, factor);
}

static void write_cells(BenchH5 *h5, const RefQuadtree *tree)
{
    size_t leaves = (size_t)tree->leaves;
    double(*low)[2] = sm_alloc(leaves, sizeof *low), (*high)[2] = sm_alloc(leaves, sizeof *high);
    double *factor = sm_alloc(leaves, sizeof *factor);
    for (long c = 0, leaf = 0; c < tree->count; c++) {
        if (tree->cell[c].child >= 0) continue;
        factor[leaf] = cell_factor(tree, tree->cell + c, low[leaf], high[leaf]);
        leaf++;
    }
    hid_t group = bench_h5_group(h5, h5->file, "cells");
    write_numbers(h5, group, "low", H5T_IEEE_F64LE, tree->leaves, 2, low);
    write_numbers(h5, group, "high", H5T_IEEE_F64LE, tree->leaves, 2, high);
    write_numbers(h5, group, "factor", H5T_IEEE_F64LE, tree->leaves, 1, factor);
    sm_free_all(low, high, factor);
}

static void write_nodes(BenchH5 *h5, const RefShell *shell)
{
    size_t count = (size_t)shell->nodes.count;
    double(*theta)[2] = sm_alloc(count, sizeof *theta), (*x)[3] = sm_alloc(count, sizeof *x);
    for (size_t n = 0; n < count; n++) {
        memcpy(theta[n], shell->nodes.position[n], sizeof theta[n]);
        shell->chart.place(shell->chart.data, theta[n], x[n]);
    }
    hid_t group = bench_h5_group(h5, h5->file, "nodes");
    write_numbers(h5, group, "parameters", H5T_IEEE_F64LE, shell->nodes.count, 2, theta);
    write_numbers(h5, group, "reach", H5T_IEEE_F64LE, shell->nodes.count, 1, shell->nodes.reach);
    write_numbers(h5, group, "points", H5T_IEEE_F64LE, shell->nodes.count, 3, x);
    sm_free_all(theta, x);
}

static void write_file(BenchH5 *h5, void *record)
{
    const File *file = record;
    const RefSurfaceMap *map = &file->map->map;
    const double angles[2] = {map->angle_median, map->angle_95};
    const int schema = SCHEMA;
    bench_h5_text(h5, h5->file, "kind", "shapebench map");
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_text(h5, h5->file, "source", file->source);
    bench_h5_text(h5, h5->file, "surface_kind", ref_map_kind_name(map->kind));
    bench_h5_numbers(h5, h5->file, "low", H5T_IEEE_F64LE, 2, map->chart.low);
    bench_h5_numbers(h5, h5->file, "high", H5T_IEEE_F64LE, 2, map->chart.high);
    bench_h5_numbers(h5, h5->file, "angle_error", H5T_IEEE_F64LE, 2, angles);
    bench_h5_numbers(h5, h5->file, "flips", H5T_STD_I64LE, 0, &map->flips);
    write_seams(h5, &map->chart);
    if (map->chart.cylinders) write_cylinders(h5, map->chart.cylinders);
    write_surface(h5, map);
    hid_t given = bench_h5_group(h5, h5->file, "given");
    write_numbers(h5, given, "parameters", H5T_IEEE_F64LE, map->vertices, 2, map->theta);
    write_numbers(h5, given, "factor", H5T_IEEE_F64LE, map->vertices, 1, map->factor);
    write_cells(h5, &file->map->shell.tree);
    write_nodes(h5, &file->map->shell);
}

SmCode bench_map_write(const BenchMap *map, const char *source, const char *path, SmError *error)
{
    return bench_h5_store(path, write_file, &(File){map, source}, error);
}
