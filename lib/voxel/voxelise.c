#include "voxelise.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../box.h"
#include "../system/hash.h"
#include "../system/team.h"
#include "flood.h"
#include "ray_vote.h"
#include "surface_cells.h"

/* By how much of a cell the mesh may stick out of its lattice: less than what counts as touching
 * (surface_cells.h), more than the rounding of an extent that is a whole number of cells. */
#define OVERHANG 5e-7

/* One mesh, voxelised at one or many cell sizes. */
typedef struct {
    const SmMesh *mesh;
    const char *name; /* for messages */
    SmFill fill;
    double low[3], extent[3]; /* of the triangles' box */
    double longest;           /* the largest extent */
    bool closed;              /* every edge is used by an even number of triangles */
    double (*point)[3];       /* [vertex_count], scratch */
} Voxeliser;

typedef struct {
    int size[3];
    double pad[3]; /* from the lattice's origin to the mesh's low corner, in cells */
} Placement;

static void measure(Voxeliser *v)
{
    SmBox box = sm_no_box();
    for (long t = 0; t < v->mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) sm_box_add(&box, v->mesh->position[v->mesh->triangle[t][c]]);
    for (int d = 0; d < 3; d++) {
        v->low[d] = box.low[d];
        v->extent[d] = box.high[d] - box.low[d];
        v->longest = fmax(v->longest, v->extent[d]);
    }
}

/* A 64-bit name of an edge. */
static uint64_t edge_name(int a, int b)
{
    return sm_mix(a < b ? (uint64_t)a << 32 | (uint64_t)b : (uint64_t)b << 32 | (uint64_t)a);
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
static SmCode begin(Voxeliser *v, const SmMesh *mesh, SmFill fill, const char *name, SmError *error)
{
    *v = (Voxeliser){.mesh = mesh, .name = name, .fill = fill};
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

static void end(Voxeliser *v)
{
    free(v->point);
    memset(v, 0, sizeof *v);
}

static double cells_along(double extent)
{
    return fmax(1, ceil(extent - OVERHANG));
}

/* The fewest cells that hold the mesh, moved by `shift`. False beyond the limits of voxelise.h. */
static bool place(const Voxeliser *v, double cell, const double shift[3], Placement *at)
{
    double cells = 1;
    for (int d = 0; d < 3; d++) {
        double extent = v->extent[d] / cell;
        if (!(extent < INT_MAX - 2)) return false;
        double pad = (cells_along(extent) - extent) / 2 + shift[d];
        at->pad[d] = pad >= 1 ? pad - 1 : pad;
        at->size[d] = (int)cells_along(extent + at->pad[d]);
        cells *= at->size[d];
    }
    double padded = ceil(at->size[0] / 64.0) * 64 * at->size[1] * at->size[2];
    return cells <= 2147483648.0 && padded <= fmin(4294967296.0, (double)LONG_MAX);
}

/* 64-bit words of a lattice of this cell size, moved by half a cell; INFINITY beyond the limits. */
static double words_of(const Voxeliser *v, double cell)
{
    Placement at;
    if (!place(v, cell, (double[3]){0.5, 0.5, 0.5}, &at)) return INFINITY;
    return ceil(at.size[0] / 64.0) * at.size[1] * at.size[2];
}

/* Fills the inside. Returns false when there cannot be one: no axis has rays that leave again, and
 * most triangles share no edge with another. */
static bool fill_inside(Voxeliser *v, SmVoxels *voxels, SmVoxelReport *report)
{
    sm_flood_inside(voxels);
    long flooded = sm_voxels_cells(voxels);
    report->flood_cells = flooded - report->shell_cells;
    report->inside = SM_INSIDE_CLOSED;
    if (v->closed) return true;
    int axes = sm_ray_vote(v->mesh, (const double(*)[3])v->point, voxels);
    if (axes == 0 && sm_mesh_info(v->mesh).open_edges * 2 > v->mesh->triangle_count * 5)
        return false;
    sm_flood_inside(voxels);
    report->vote_cells = sm_voxels_cells(voxels) - flooded;
    report->inside = report->vote_cells    ? SM_INSIDE_VOTED
                     : report->flood_cells ? SM_INSIDE_TIGHT
                                           : SM_INSIDE_NONE;
    return true;
}

/* Makes a lattice, its box moved by `shift` of a cell (0..1 along each axis) from the centred one;
 * fills all of `report` but its number of voxelisations. */
static SmCode build(Voxeliser *v, double cell, const double shift[3], SmVoxels *voxels,
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
#pragma omp parallel for schedule(static) num_threads(sm_team_for(v->mesh->vertex_count))
    for (long i = 0; i < v->mesh->vertex_count; i++)
        for (int d = 0; d < 3; d++)
            v->point[i][d] = (v->mesh->position[i][d] - v->low[d]) / cell + at.pad[d];
    sm_surface_cells(v->mesh, (const double(*)[3])v->point, voxels);
    report->shell_cells = sm_voxels_cells(voxels);
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

/* ---- the cell size that gives a wanted number of particles */

#define CELL_SIZES 12
#define SHIFTS     47
#define WORDS      67108864.0 /* of all lattices: some seconds */

typedef struct {
    double cell; /* 0: none yet */
    double count;
} Sample;

typedef struct {
    Voxeliser *voxeliser;
    long wanted;
    SmVoxels best;
    SmVoxelReport report; /* of the best */
    Sample few, many;     /* nearest samples to either side */
    Sample last;
    double words; /* that more lattices may have together */
    bool limited; /* a cell size was beyond the limits */
    int tried;
} Search;

/* Whether a lattice of this cell size is within the limits, and within those of the search. */
static bool affordable(Search *s, double cell)
{
    double words = words_of(s->voxeliser, cell);
    if (!(words <= s->words)) return false;
    s->words -= words;
    return true;
}

static long miss(const Search *s)
{
    return labs(s->best.particle_count - s->wanted);
}

/* Makes one lattice and keeps it when it is nearer than the best. */
static SmCode try_lattice(Search *s, double cell, const double shift[3], SmError *error)
{
    SmVoxels voxels;
    SmVoxelReport report;
    SmCode code = build(s->voxeliser, cell, shift, &voxels, &report, error);
    if (code) return code;
    s->tried++;
    s->last = (Sample){cell, (double)voxels.particle_count};
    if (!s->best.bits || labs(voxels.particle_count - s->wanted) < miss(s)) {
        SmVoxels swap = s->best;
        s->best = voxels;
        voxels = swap;
        s->report = report;
    }
    sm_voxels_free(&voxels);
    return SM_OK;
}

/* A cell size without the last bits, in which libraries' powers and logarithms differ: machines are
 * to simulate the same particles. */
static double rounded(double cell)
{
    return (double)(float)cell;
}

/* The cell size to try next. Counts go as a power of the cell size, -2 for a shell to -3 for a
 * solid; interpolated between the nearest samples or extrapolated from the last. */
static double next_cell(const Search *s, bool halve)
{
    if (s->few.cell == 0 || s->many.cell == 0) {
        double power = s->voxeliser->fill == SM_SHELL ? 2 : 2.7;
        double cell = s->last.cell * pow(s->last.count / (double)s->wanted, 1 / power);
        return fmin(cell, s->voxeliser->longest);
    }
    if (halve || isinf(s->many.count)) return sqrt(s->few.cell * s->many.cell);
    double part = log((double)s->wanted / s->few.count) / log(s->many.count / s->few.count);
    return s->few.cell * pow(s->many.cell / s->few.cell, part);
}

/* Places a sample in the bracket. Returns whether it replaced the side that the one before did. */
static bool narrow(Search *s, Sample sample, bool *was_many)
{
    bool is_many = sample.count >= (double)s->wanted, same = is_many == *was_many;
    *(is_many ? &s->many : &s->few) = sample;
    *was_many = is_many;
    return same;
}

static SmCode search_cell(Search *s, SmError *error)
{
    double cell = s->voxeliser->longest / 24;
    bool was_many = false, same = false;
    for (int i = 0; i < CELL_SIZES; i++) {
        if (!affordable(s, cell)) {
            s->limited = true;
            same = narrow(s, (Sample){cell, INFINITY}, &was_many);
        } else {
            SmCode code = try_lattice(s, cell, (double[3]){0, 0, 0}, error);
            if (code) return code;
            if (miss(s) <= s->wanted / 1000) return SM_OK;
            same = narrow(s, s->last, &was_many) && i > 1;
        }
        double next = rounded(next_cell(s, same));
        if (fabs(next - cell) <= cell * 1e-9) return SM_OK;
        cell = next;
    }
    return SM_OK;
}

/* Where the count jumps with the cell size, other positions of the lattice have counts between:
 * first half a cell along some axes, then anywhere (the R4 sequence of Roberts, 2018, whose points
 * spread evenly) with a cell size between those to either side. */
static SmCode search_shift(Search *s, SmError *error)
{
    const double step[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                            0.5385972572236101};
    double least = s->many.cell && isfinite(s->many.count) ? s->many.cell : s->best.cell;
    double most = s->few.cell ? s->few.cell : s->best.cell, centred = s->best.cell;
    for (int i = 1; i <= SHIFTS && miss(s) * 100 > s->wanted; i++) {
        double shift[3], part = fmod(i * step[3], 1);
        double cell = i < 8 ? centred : rounded(least * pow(most / least, 1.5 * part - 0.25));
        for (int d = 0; d < 3; d++) shift[d] = i < 8 ? (i >> d & 1) * 0.5 : fmod(i * step[d], 1);
        if (!affordable(s, cell)) continue;
        SmCode code = try_lattice(s, cell, shift, error);
        if (code) return code;
    }
    return SM_OK;
}

/* Makes the lattice whose particle count is nearest to params->particles among those tried: at most
 * 12 cell sizes, then, while it is more than a hundredth off, 47 lattices moved by a part of a
 * cell. Fills `voxels` and `report`. All lattices together have at most 2^32 cells. */
static SmCode search_particles(Voxeliser *voxeliser, const SmVoxelParams *params, SmVoxels *voxels,
                               SmVoxelReport *report, SmError *error)
{
    Search s = {.voxeliser = voxeliser, .wanted = params->particles, .words = WORDS};
    SmCode code = search_cell(&s, error);
    if (!code) code = search_shift(&s, error);
    if (!code && s.limited && !params->fewer && miss(&s) * 50 > s.wanted)
        code =
            sm_fail(error, SM_INPUT,
                    "%s: %ld particles need too large a lattice (most of its box would be empty); "
                    "%ld were reached: ask for that many",
                    voxeliser->name, s.wanted, s.best.particle_count);
    if (code) {
        sm_voxels_free(&s.best);
        return code;
    }
    *voxels = s.best;
    *report = s.report;
    report->voxelisations = s.tried;
    return SM_OK;
}

/* ---- the interface */

static SmCode check_params(const Voxeliser *v, const SmVoxelParams *params, SmError *error)
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
    Voxeliser v;
    SmCode code = begin(&v, mesh, params->fill, name, error);
    if (!code) code = check_params(&v, params, error);
    if (!code && params->particles)
        code = search_particles(&v, params, voxels, report, error);
    else if (!code) {
        code = build(&v, params->cell, (double[3]){0, 0, 0}, voxels, report, error);
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
