#include "cut_surface.h"

#include <stdlib.h>
#include <string.h>

#include "../vector.h"
#include "cut_solid.h"

/* Of a cell: what a cut takes away, and what does not matter. */
static const double thickness = 1e-4, slack = 1e-10;

enum { TRIES = 5 };

static bool is_inside_out(const SmMesh *mesh)
{
    double volume = 0;
    for (long t = 0; t < mesh->triangle_count; t++)
        volume += sm_mesh_six_volumes(mesh, t, mesh->position[0]);
    return volume < 0;
}

typedef struct {
    SmMesh *mesh;
    const SmCut *cut;
    double cell;
    bool inside_out;
    bool tear; /* it is open already, and may come to be more so */
} SurfaceCut;

/* Takes the solid for triangles first .. last - 1 away. What tears undoes itself, unless it may. */
static SmSubtractResult try_once(const SurfaceCut *s, long first, long last, unsigned seed,
                                 const SmSubtractOptions *options)
{
    SmMesh solid;
    SmCutSolidOptions thin = {thickness * s->cell, seed};
    if (!sm_cut_solid_make(s->cut, first, last, &thin, &solid)) return SM_SUBTRACT_FAILED;
    SmMesh before = s->tear ? (SmMesh){0} : sm_mesh_copy(s->mesh);
    SmSubtractResult result = sm_mesh_subtract(s->mesh, &solid, options);
    if (result == SM_SUBTRACT_TORN && !s->tear) {
        sm_mesh_free(s->mesh);
        *s->mesh = before;
        before = (SmMesh){0};
        result = SM_SUBTRACT_FAILED;
    }
    sm_mesh_free(&before);
    sm_mesh_free(&solid);
    return result;
}

/* One solid for triangles first .. last - 1, with other random moves where it fails; and where the
 * surface may tear at last without closing. */
static SmCutResult split_by(const SurfaceCut *s, long first, long last)
{
    static const SmCutResult meaning[] = {SM_CUT_MISSED, SM_CUT_CLOSED, SM_CUT_OPEN};
    SmSubtractOptions options = {s->inside_out, true, slack * s->cell};
    for (int try = 0; try < (s->tear ? 2 : 1) * TRIES; try++) {
        options.close = try < TRIES;
        SmSubtractResult result =
            try_once(s, first, last, (unsigned)(first * 2 * TRIES + try), &options);
        if (result != SM_SUBTRACT_FAILED) return meaning[result];
    }
    return SM_CUT_INCOMPLETE;
}

static bool has_area(const SmCut *cut, long t, double least)
{
    double normal[3];
    sm_cut_area_vector(cut, t, normal);
    return sqrt(sm_dot(normal, normal)) > least;
}

/* A solid for each half of the triangles first .. last - 1, and so on where that fails: at last one
 * for every triangle. They overlap, and the smaller they are, the simpler. */
static SmCutResult split_by_halves(const SurfaceCut *s, long first, long last)
{
    SmCutResult worst = SM_CUT_MISSED;
    for (int half = 0; half < 2; half++) {
        long middle = first + (last - first) / 2;
        long from = half ? middle : first, to = half ? last : middle;
        SmCutResult result = from < to ? split_by(s, from, to) : SM_CUT_MISSED;
        if (result == SM_CUT_INCOMPLETE && to - from > 1)
            result = split_by_halves(s, from, to);
        else if (result == SM_CUT_INCOMPLETE && !has_area(s->cut, from, 0.01 * s->cell * s->cell))
            result = SM_CUT_MISSED;
        if (result > worst) worst = result;
    }
    return worst;
}

static bool is_closed(const SmMesh *mesh)
{
    SmMeshInfo info = sm_mesh_info(mesh);
    return info.open_edges == 0;
}

SmCutResult sm_cut_surface(SmMesh *mesh, const SmCut *cut, long first, double cell)
{
    SurfaceCut s = {mesh, cut, cell, is_inside_out(mesh), false};
    SmCutResult result = split_by(&s, first, cut->triangles);
    if (result == SM_CUT_INCOMPLETE && cut->triangles > first && !is_closed(mesh)) {
        s.tear = true;
        result = split_by(&s, first, cut->triangles);
    }
    if (result == SM_CUT_INCOMPLETE) result = split_by_halves(&s, first, cut->triangles);
    return result;
}
