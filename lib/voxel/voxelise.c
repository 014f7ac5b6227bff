#include "voxelise.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "voxel_flood.h"
#include "voxel_search.h"
#include "voxel_surface.h"
#include "voxel_vote.h"

/* By how much of a cell the mesh may stick out of its lattice: less than what counts as touching
 * (voxel_surface.h), more than the rounding of an extent that is a whole number of cells. */
#define OVERHANG 5e-7

typedef struct {
    int size[3];
    double pad[3]; /* from the lattice's origin to the mesh's low corner, in cells */
} Placement;

static void measure(SmVoxeliser *v)
{
    double high[3];
    for (int d = 0; d < 3; d++) {
        v->low[d] = INFINITY;
        high[d] = -INFINITY;
    }
    for (long t = 0; t < v->mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            const double *p = v->mesh->position[v->mesh->triangle[t][c]];
            for (int d = 0; d < 3; d++) {
                v->low[d] = p[d] < v->low[d] ? p[d] : v->low[d];
                high[d] = p[d] > high[d] ? p[d] : high[d];
            }
        }
    for (int d = 0; d < 3; d++) {
        v->extent[d] = high[d] - v->low[d];
        v->longest = fmax(v->longest, v->extent[d]);
    }
}

/* A 64-bit name of an edge (the finaliser of splitmix64). */
static uint64_t edge_name(int a, int b)
{
    uint64_t x = a < b ? (uint64_t)a << 32 | (uint64_t)b : (uint64_t)b << 32 | (uint64_t)a;
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

/* Edges used an even number of times cancel out; by chance others do once in 2^64 meshes. */
static bool is_closed(const SmMesh *mesh)
{
    uint64_t left = 0;
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            int a = mesh->triangle[t][c], b = mesh->triangle[t][(c + 1) % 3];
            if (a != b) left ^= edge_name(a, b);
        }
    return left == 0;
}

/* Checks the mesh (the errors of sm_mesh_check()) and measures it. Free in any case. */
static SmCode begin(SmVoxeliser *v, const SmMesh *mesh, SmFill fill, const char *name,
                    SmError *error)
{
    *v = (SmVoxeliser){.mesh = mesh, .name = name, .fill = fill};
    SmCode code = sm_mesh_check(mesh, name, error);
    if (code) return code;
    measure(v);
    if (!(v->longest > 0))
        return sm_fail(error, SM_INPUT, "%s: all triangles lie in one point: no body to simulate",
                       name);
    v->closed = is_closed(mesh);
    v->point = sm_alloc((size_t)mesh->vertex_count, sizeof *v->point);
    return SM_OK;
}

static void end(SmVoxeliser *v)
{
    free(v->point);
    memset(v, 0, sizeof *v);
}

/* The fewest cells that hold the mesh, moved by `shift`. False beyond the limits of voxel.h. */
static bool place(const SmVoxeliser *v, double cell, const double shift[3], Placement *at)
{
    double cells = 1;
    for (int d = 0; d < 3; d++) {
        double extent = v->extent[d] / cell;
        if (!(extent < INT_MAX - 2)) return false;
        double fewest = fmax(1, ceil(extent - OVERHANG));
        double pad = (fewest - extent) / 2 + shift[d];
        at->pad[d] = pad >= 1 ? pad - 1 : pad;
        at->size[d] = (int)fmax(1, ceil(extent + at->pad[d] - OVERHANG));
        cells *= at->size[d];
    }
    double padded = ceil(at->size[0] / 64.0) * 64 * at->size[1] * at->size[2];
    return cells <= 2147483648.0 && padded <= 4294967296.0;
}

double sm_voxeliser_words(const SmVoxeliser *v, double cell)
{
    Placement at;
    if (!place(v, cell, (double[3]){0.5, 0.5, 0.5}, &at)) return INFINITY;
    return ceil(at.size[0] / 64.0) * at.size[1] * at.size[2];
}

static long cells_of(const SmVoxels *voxels)
{
    long cells = 0;
    size_t words = (size_t)voxels->size[1] * (size_t)voxels->size[2] * (size_t)voxels->words;
    for (size_t w = 0; w < words; w++) cells += __builtin_popcountll(voxels->bits[w]);
    return cells;
}

/* Fills the inside. Returns false when there cannot be one: no axis has rays that leave again, and
 * most triangles share no edge with another. */
static bool fill_inside(SmVoxeliser *v, SmVoxels *voxels, SmVoxelReport *report)
{
    sm_voxel_flood(voxels);
    long flooded = cells_of(voxels);
    report->flood_cells = flooded - report->shell_cells;
    report->inside = SM_INSIDE_CLOSED;
    if (v->closed) return true;
    int axes = sm_voxel_vote(v->mesh, (const double(*)[3])v->point, voxels);
    if (axes == 0 && sm_mesh_info(v->mesh).open_edges * 2 > v->mesh->triangle_count * 5)
        return false;
    sm_voxel_flood(voxels);
    report->vote_cells = cells_of(voxels) - flooded;
    report->inside = report->vote_cells    ? SM_INSIDE_VOTED
                     : report->flood_cells ? SM_INSIDE_TIGHT
                                           : SM_INSIDE_NONE;
    return true;
}

SmCode sm_voxeliser_build(SmVoxeliser *v, double cell, const double shift[3], SmVoxels *voxels,
                          SmVoxelReport *report, SmError *error)
{
    memset(voxels, 0, sizeof *voxels);
    *report = (SmVoxelReport){0};
    Placement at;
    if (!place(v, cell, shift, &at))
        return sm_fail(error, SM_INPUT,
                       "%s: cells of %g in a mesh of %g x %g x %g are more than 2^31: "
                       "take larger cells or fewer particles",
                       v->name, cell, v->extent[0], v->extent[1], v->extent[2]);
    sm_voxels_init(voxels, at.size[0], at.size[1], at.size[2], cell);
    for (int d = 0; d < 3; d++) voxels->origin[d] = v->low[d] - at.pad[d] * cell;
    for (long i = 0; i < v->mesh->vertex_count; i++)
        for (int d = 0; d < 3; d++)
            v->point[i][d] = (v->mesh->position[i][d] - v->low[d]) / cell + at.pad[d];
    sm_voxel_surface(v->mesh, (const double(*)[3])v->point, voxels);
    report->shell_cells = cells_of(voxels);
    if (v->fill == SM_SOLID && !fill_inside(v, voxels, report)) {
        sm_voxels_free(voxels);
        return sm_fail(error, SM_INPUT,
                       "%s: no inside to fill: its triangles are loose (most share no edge with "
                       "another); join its vertices, or simulate it as a shell ('run --shell')",
                       v->name);
    }
    sm_voxels_count(voxels);
    return SM_OK;
}

static SmCode check_params(const SmVoxeliser *v, const SmVoxelParams *params, SmError *error)
{
    if (params->particles < 0 || params->particles > INT_MAX)
        return sm_fail(error, SM_INPUT, "%s: %ld particles wanted: give 1 to %d", v->name,
                       params->particles, INT_MAX);
    if (params->particles) return SM_OK;
    if (!(params->cell > 0) || !isfinite(params->cell))
        return sm_fail(error, SM_INPUT, "%s: a cell size of %g: give a positive length", v->name,
                       params->cell);
    if (params->cell > v->longest * 1e6)
        return sm_fail(error, SM_INPUT, "%s: a cell size of %g for a mesh %g long: give less",
                       v->name, params->cell, v->longest);
    return SM_OK;
}

SmCode sm_voxelise_report(const SmMesh *mesh, const SmVoxelParams *params, const char *name,
                          SmVoxels *voxels, SmVoxelReport *report, SmError *error)
{
    memset(voxels, 0, sizeof *voxels);
    SmVoxelReport unasked;
    if (!report) report = &unasked;
    *report = (SmVoxelReport){0};
    SmVoxeliser v;
    SmCode code = begin(&v, mesh, params->fill, name, error);
    if (!code) code = check_params(&v, params, error);
    if (!code && params->particles)
        code = sm_voxel_search(&v, params, voxels, report, error);
    else if (!code) {
        code = sm_voxeliser_build(&v, params->cell, (double[3]){0, 0, 0}, voxels, report, error);
        report->voxelisations = 1;
    }
    end(&v);
    if (!code && voxels->particle_count > INT_MAX) {
        code = sm_fail(error, SM_INPUT, "%s: %ld particles are more than %d: take larger cells",
                       name, voxels->particle_count, INT_MAX);
        sm_voxels_free(voxels);
    }
    return code;
}

SmCode sm_voxelise(const SmMesh *mesh, const SmVoxelParams *params, const char *name,
                   SmVoxels *voxels, SmError *error)
{
    return sm_voxelise_report(mesh, params, name, voxels, NULL, error);
}

const char *sm_voxel_verdict(const SmVoxelReport *report)
{
    bool thin = (report->flood_cells + report->vote_cells) * 50 < report->shell_cells;
    switch (report->inside) {
    case SM_INSIDE_CLOSED:
        return thin ? "no open edges, but little or no inside at this cell size" : "no open edges";
    case SM_INSIDE_TIGHT:
        return thin ? "open, with little inside: a sheet one cell thick"
                    : "open, but its holes are narrower than a cell";
    case SM_INSIDE_VOTED:
        return "open; its wide holes were bridged";
    default:
        return "open, with no inside: a sheet one cell thick";
    }
}
