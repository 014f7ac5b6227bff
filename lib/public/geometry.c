/* geometry.c - meshes and voxels of shapebench.h. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../mesh/import.h"
#include "../shapes/shape.h"
#include "../system/team.h"
#include "../voxel/voxelise.h"
#include "inner.h"

_Static_assert(sizeof(long) == sizeof(int64_t), "numbers of particles go through as they are");
_Static_assert((int)SB_USAGE == SM_USAGE && (int)SB_INPUT == SM_INPUT &&
                   (int)SB_MEMORY == SM_MEMORY,
               "codes go through as they are");

/* ---- meshes */

void sb_load_params_init(sb_load_params *params)
{
    *params = (sb_load_params){0};
}

static int finish_mesh(SmCode code, const SmError *why, SmMesh *mesh, sb_mesh **result,
                       sb_error *error)
{
    if (code) return sm_done(code, why, error);
    *result = sm_alloc(1, sizeof **result);
    **result = (sb_mesh){.mesh = *mesh};
    return sm_done(SM_OK, why, error);
}

int sb_mesh_load(const char *path, const sb_load_params *params, sb_mesh **mesh, sb_error *error)
{
    const sb_load_params p = params ? *params : (sb_load_params){0};
    SmMesh made;
    SmMeshLeftOut left_out;
    SmError why;
    int code = sm_begin(mesh, "mesh", error);
    if (!code) code = sm_check_given(path, "path", error);
    if (!code) code = sm_check_range(p.seconds, 0, 1e6, "seconds", error);
    if (!code) code = sm_check_range(p.megabytes, 0, 1e6, "megabytes", error);
    if (code) return code;
    SmImportLimits limits = {p.seconds, p.megabytes};
    SmCode inner = sm_import(path, &limits, &made, &left_out, &why);
    code = finish_mesh(inner, &why, &made, mesh, error);
    if (!code) (*mesh)->left_out = left_out;
    return code;
}

int sb_mesh_make(int64_t vertices, const double *position, int64_t triangles, const int *triangle,
                 sb_mesh **mesh, sb_error *error)
{
    SmError why;
    int code = sm_begin(mesh, "mesh", error);
    if (!code) code = sm_check_range((double)vertices, 1, INT_MAX, "vertices", error);
    if (!code) code = sm_check_range((double)triangles, 1, INT_MAX, "triangles", error);
    if (!code) code = sm_check_given(position, "position", error);
    if (!code) code = sm_check_given(triangle, "triangle", error);
    if (code) return code;
    SmMesh made = sm_mesh_new(vertices, triangles);
    memcpy(made.position, position, (size_t)vertices * sizeof *made.position);
    memcpy(made.triangle, triangle, (size_t)triangles * sizeof *made.triangle);
    SmCode inner = sm_mesh_prepare(&made, "mesh", &why);
    return finish_mesh(inner, &why, &made, mesh, error);
}

int sb_mesh_shape(const char *name, sb_mesh **mesh, sb_error *error)
{
    SmMesh made;
    SmError why;
    int code = sm_begin(mesh, "mesh", error);
    if (!code) code = sm_check_given(name, "name", error);
    if (code) return code;
    SmCode inner = sm_shape_mesh(name, &made, &why);
    return finish_mesh(inner, &why, &made, mesh, error);
}

const char *sb_shape_name(int number)
{
    int count;
    const SmShape *shapes = sm_shapes(&count);
    return number >= 0 && number < count ? shapes[number].name : NULL;
}

int sb_mesh_measure(const sb_mesh *mesh, sb_mesh_facts *facts, sb_error *error)
{
    int code = sm_check_given(mesh, "mesh", error);
    if (!code) code = sm_check_given(facts, "facts", error);
    if (code) return code;
    SmMeshInfo info = sm_mesh_info(&mesh->mesh);
    const SmMeshLeftOut *out = &mesh->left_out;
    *facts = (sb_mesh_facts){.vertices = info.vertices,
                             .triangles = info.triangles,
                             .components = info.components,
                             .open_edges = info.open_edges,
                             .nonmanifold_edges = info.nonmanifold_edges,
                             .flipped_edges = info.flipped_edges,
                             .degenerate = info.degenerate,
                             .duplicates = info.duplicates,
                             .watertight = info.watertight,
                             .volume = info.volume,
                             .left_out = out->points + out->lines + out->curves + out->scenes};
    memcpy(facts->low, info.low, sizeof facts->low);
    memcpy(facts->high, info.high, sizeof facts->high);
    return sm_done(SM_OK, NULL, error);
}

int sb_mesh_read_vertices(const sb_mesh *mesh, double *position, int64_t room, sb_error *error)
{
    int code = sm_check_given(mesh, "mesh", error);
    if (code) return code;
    return sm_give_array(mesh->mesh.position, mesh->mesh.vertex_count, sizeof *mesh->mesh.position,
                         position, room, "position", error);
}

int sb_mesh_read_triangles(const sb_mesh *mesh, int *triangle, int64_t room, sb_error *error)
{
    int code = sm_check_given(mesh, "mesh", error);
    if (code) return code;
    return sm_give_array(mesh->mesh.triangle, mesh->mesh.triangle_count,
                         sizeof *mesh->mesh.triangle, triangle, room, "triangle", error);
}

void sb_mesh_free(sb_mesh *mesh)
{
    if (!mesh) return;
    sm_mesh_free(&mesh->mesh);
    free(mesh);
}

/* ---- voxels */

void sb_voxel_params_init(sb_voxel_params *params)
{
    *params = (sb_voxel_params){.fill = SB_SOLID};
}

int sb_voxels_of_mesh(const sb_mesh *mesh, const sb_voxel_params *params, sb_voxels **voxels,
                      sb_error *error)
{
    int code = sm_begin(voxels, "voxels", error);
    if (!code) code = sm_check_given(mesh, "mesh", error);
    if (!code) code = sm_check_given(params, "params", error);
    if (code) return code;
    const sb_voxel_params p = *params;
    code = sm_check_range(p.fill, SB_SOLID, SB_SHELL, "fill", error);
    if (!code && p.particles == 0 && !(p.cell > 0))
        code = sm_refuse(error, SB_USAGE,
                         "'particles' is 0 and 'cell' is %g: give one of them, above 0", p.cell);
    if (code) return code;
    SmVoxelParams inner = {p.fill == SB_SHELL ? SM_SHELL : SM_SOLID, p.cell, p.particles,
                           p.fewer != 0};
    SmError why;
    sb_voxels *made = sm_alloc(1, sizeof *made);
    SmCode failed =
        sm_voxelise_report(&mesh->mesh, &inner, "mesh", &made->voxels, &made->report, &why);
    if (failed)
        free(made);
    else
        *voxels = made;
    return sm_done(failed, &why, error);
}

static int check_lattice(const int cells[3], double cell, const double *origin, sb_error *error)
{
    const double most = 2147483648.0, bytes = 512.0 * 1024 * 1024;
    int code = sm_check_given(cells, "cells", error);
    for (int d = 0; d < 3 && !code; d++)
        code = sm_check_range(cells[d], 1, INT_MAX - 64, "cells", error);
    if (!code) code = sm_check_range(cell, 1e-30, 1e30, "cell", error);
    if (!code && origin) code = sm_check_finite(origin, 3, 1e30, "origin", error);
    if (code) return code;
    double rows = (double)cells[1] * cells[2];
    if (rows * cells[0] <= most && rows * (cells[0] / 64 + 1) * 8 <= bytes) return SB_OK;
    return sm_refuse(error, SB_INPUT, "a lattice of %d x %d x %d cells is too large: 2^31 at most",
                     cells[0], cells[1], cells[2]);
}

static int64_t cells_of(const SmVoxels *v)
{
    return (int64_t)v->size[0] * v->size[1] * v->size[2];
}

static void take_cells(SmVoxels *v, const uint8_t *filled)
{
#pragma omp parallel for schedule(static) num_threads(sm_team_for(cells_of(v)))
    for (int k = 0; k < v->size[2]; k++)
        for (int j = 0; j < v->size[1]; j++) {
            const uint8_t *row = filled + ((int64_t)k * v->size[1] + j) * v->size[0];
            for (int i = 0; i < v->size[0]; i++)
                if (row[i]) sm_voxel_set(v, i, j, k);
        }
}

int sb_voxels_make(const int cells[3], double cell, const double origin[3], const uint8_t *filled,
                   sb_voxels **voxels, sb_error *error)
{
    int code = sm_begin(voxels, "voxels", error);
    if (!code) code = check_lattice(cells, cell, origin, error);
    if (code) return code;
    SmVoxels v;
    sm_voxels_init(&v, cells[0], cells[1], cells[2], cell);
    if (origin) memcpy(v.origin, origin, sizeof v.origin);
    if (filled)
        take_cells(&v, filled);
    else
        sm_voxels_fill(&v);
    sm_voxels_count(&v);
    if (v.cell_count < 1 || v.particle_count > INT_MAX) {
        code = sm_refuse(error, SB_INPUT, "%lld cells of material with %lld particles: 1 to %d",
                         (long long)v.cell_count, (long long)v.particle_count, INT_MAX);
        sm_voxels_free(&v);
        return code;
    }
    *voxels = sm_alloc(1, sizeof **voxels);
    **voxels = (sb_voxels){.voxels = v};
    return sm_done(SM_OK, NULL, error);
}

int sb_voxels_measure(const sb_voxels *voxels, sb_voxel_facts *facts, sb_error *error)
{
    int code = sm_check_given(voxels, "voxels", error);
    if (!code) code = sm_check_given(facts, "facts", error);
    if (code) return code;
    const SmVoxels *v = &voxels->voxels;
    *facts = (sb_voxel_facts){.inside = (int)voxels->report.inside,
                              .cell = v->cell,
                              .material = v->cell_count,
                              .particles = v->particle_count,
                              .shell_cells = voxels->report.shell_cells,
                              .flooded_cells = voxels->report.flood_cells,
                              .voted_cells = voxels->report.vote_cells};
    memcpy(facts->cells, v->size, sizeof facts->cells);
    memcpy(facts->origin, v->origin, sizeof facts->origin);
    return sm_done(SM_OK, NULL, error);
}

int sb_voxels_read_cells(const sb_voxels *voxels, uint8_t *filled, int64_t room, sb_error *error)
{
    int code = sm_check_given(voxels, "voxels", error);
    if (code) return code;
    const SmVoxels *v = &voxels->voxels;
    code = sm_check_array(filled, room, cells_of(v), "filled", error);
    if (code) return code;
    for (int64_t at = 0; at < cells_of(v); at++) {
        int64_t row = at / v->size[0];
        filled[at] = sm_voxel_get(v, (int)(at % v->size[0]), (int)(row % v->size[1]),
                                  (int)(row / v->size[1]));
    }
    return sm_done(SM_OK, NULL, error);
}

int sb_voxels_read_particles(const sb_voxels *voxels, double *position, int64_t room,
                             sb_error *error)
{
    int code = sm_check_given(voxels, "voxels", error);
    if (code) return code;
    const SmVoxels *v = &voxels->voxels;
    code = sm_check_array(position, room, v->particle_count, "position", error);
    if (code) return code;
    sm_voxels_rest(v, (double(*)[3])position);
    return sm_done(SM_OK, NULL, error);
}

int sb_voxels_weigh(const sb_voxels *voxels, double density, double *mass, int64_t room,
                    sb_error *error)
{
    int code = sm_check_given(voxels, "voxels", error);
    if (!code) code = sm_check_array(mass, room, voxels->voxels.particle_count, "mass", error);
    if (!code && !(density > 0 && isfinite(density)))
        code = sm_refuse(error, SB_USAGE, "'density' is %g: it is above 0", density);
    if (code) return code;
    sm_voxels_weigh(&voxels->voxels, density, mass);
    return sm_done(SM_OK, NULL, error);
}

void sb_voxels_free(sb_voxels *voxels)
{
    if (!voxels) return;
    sm_voxels_free(&voxels->voxels);
    free(voxels);
}
