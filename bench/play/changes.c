#include "changes.h"

#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../scene/blades.h"

bool bench_changes_any(const BenchPart *part)
{
    const BenchScene *scene = part->runner.scene;
    return part->own || scene->cut_count > 0 || scene->view.level > 0;
}

SmCode bench_changes_check(const BenchPart *part, SmError *error)
{
    const BenchCarrier *carrier = bench_engine(part->runner.type->name)->carrier;
    if (!carrier->may_change || !bench_changes_any(part)) return SM_OK;
    SmError why;
    SmCode code = carrier->may_change(part->runner.engine, &why);
    return code ? sm_fail(error, code, "%s: %s", part->runner.scene->file, why.text) : SM_OK;
}

void bench_changes_create(BenchPart *part, BenchChanges *changes)
{
    const SmMesh *mesh = &part->body.mesh;
    const RefPoints *points = part->body.given ? &part->body.given->points : NULL;
    *changes = (BenchChanges){.part = part};
    long vertices = points ? points->given : mesh->vertex_count;
    long triangles = points ? 0 : mesh->triangle_count;
    SmMesh surface = sm_mesh_new(vertices, triangles);
    memcpy(surface.position, points ? points->as_given : mesh->position,
           (size_t)vertices * sizeof *mesh->position);
    memcpy(surface.triangle, mesh->triangle, (size_t)triangles * sizeof *mesh->triangle);
    const BenchRunner *runner = &part->runner;
    for (int i = 0; i < runner->scene->cut_count; i++) sm_blade_init(&changes->blade[i]);
    changes->carrier = bench_engine(runner->type->name)->carrier;
    bool cut_lattice = runner->scene->cut_count > 0 && !runner->type->refines;
    sm_skin_create(runner->type, runner->engine, &part->body.voxels, part->body.instances,
                   cut_lattice ? (const double(*)[3])runner->x0 : NULL,
                   points ? (SmMesh){0} : surface, &changes->skin);
    if (points) changes->skin.surface = surface;
    if (cut_lattice) part->body.cut = &changes->skin.cut;
}

void bench_changes_free(BenchChanges *changes)
{
    const BenchScene *scene = changes->part ? changes->part->runner.scene : NULL;
    for (int i = 0; scene && i < scene->cut_count; i++) sm_blade_free(&changes->blade[i]);
    for (int i = 0; scene && i < scene->touch_count; i++) oct_refinement_free(&changes->touch[i]);
    oct_refinement_free(&changes->view);
    sm_skin_free(&changes->skin);
    *changes = (BenchChanges){0};
}

void bench_changes_sweep(BenchChanges *changes, double from, double to, SmCut *cut)
{
    const BenchScene *scene = changes->part->runner.scene;
    for (int i = 0; i < scene->cut_count; i++) {
        double blade[4][3];
        if (!bench_blade_moves(&scene->cut[i], from, to, blade)) continue;
        SmCarriers carriers = sm_skin_carriers(&changes->skin, (const double(*)[3])blade);
        if (!changes->blade[i].down)
            sm_blade_sweep(&changes->blade[i], blade[0], blade[1], &carriers, cut);
        sm_blade_sweep(&changes->blade[i], blade[2], blade[3], &carriers, cut);
        sm_skin_carried(&changes->skin);
    }
}

SmCode bench_changes_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    long vertices = changes->skin.surface.vertex_count,
         triangles = changes->skin.surface.triangle_count;
    changes->last = (BenchChanged){0};
    SmCode code = changes->carrier->frame(changes, from, to, error);
    /* what has been split has vertices more, what lay in a gap triangles less; this may be so too
     * where sm_cut_surface() has left some of it */
    changes->last.slit = changes->skin.surface.vertex_count != vertices ||
                         changes->skin.surface.triangle_count != triangles;
    return code;
}

/* Places of the nodes of all instances where their velocities had them `back` s ago. The caller
 * frees them. */
static double (*nodes_back(const BenchRunner *runner, double back))[3]
{
    size_t count = (size_t)runner->particles;
    double(*x)[3] = sm_alloc(count, sizeof *x), (*v)[3] = sm_alloc(count, sizeof *v);
    runner->type->get(runner->engine, SM_POSITION, x);
    runner->type->get(runner->engine, SM_VELOCITY, v);
    for (size_t p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) x[p][d] -= back * v[p][d];
    free(v);
    return x;
}

void bench_changes_surface(BenchChanges *changes, double back, double (*point)[3])
{
    const BenchPart *part = changes->part;
    if (part->body.given) {
        ref_meshless_points(part->runner.engine, point);
        return;
    }
    double(*node)[3] = back == 0 ? NULL : nodes_back(&part->runner, back);
    sm_skin_points(&changes->skin, (const double(*)[3])node, point, NULL);
    free(node);
}

long bench_changes_pieces(const BenchChanges *changes, int *piece)
{
    SmPieces pieces;
    sm_skin_pieces(&changes->skin, &pieces);
    for (long v = 0; v < changes->skin.surface.vertex_count; v++)
        piece[v] = pieces.piece[sm_skin_carrier(&changes->skin, v)];
    long count = pieces.count;
    sm_pieces_free(&pieces);
    return count;
}
