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
    changes->surface = sm_mesh_new(vertices, triangles);
    memcpy(changes->surface.position, points ? points->as_given : mesh->position,
           (size_t)vertices * sizeof *mesh->position);
    memcpy(changes->surface.triangle, mesh->triangle, (size_t)triangles * sizeof *mesh->triangle);
    for (int i = 0; i < part->runner.scene->cut_count; i++) sm_blade_init(&changes->blade[i]);
    sm_cut_init(&changes->cut, 2 * part->body.voxels.cell);
    changes->carrier = bench_engine(part->runner.type->name)->carrier;
    if (!points) changes->carrier->tie(changes);
}

void bench_changes_free(BenchChanges *changes)
{
    const BenchScene *scene = changes->part ? changes->part->runner.scene : NULL;
    for (int i = 0; scene && i < scene->cut_count; i++) sm_blade_free(&changes->blade[i]);
    for (int i = 0; scene && i < scene->touch_count; i++) oct_refinement_free(&changes->touch[i]);
    oct_refinement_free(&changes->view);
    sm_mesh_free(&changes->surface);
    sm_cut_free(&changes->cut);
    sm_embed_free(&changes->embedding);
    sm_sites_free(&changes->sites);
    oct_surface_free(&changes->carried);
    free(changes->node);
    free(changes->rest);
    free(changes->x);
    free(changes->F);
    free(changes->found);
    free(changes->absent);
    *changes = (BenchChanges){0};
}

void bench_changes_room(BenchChanges *changes, long nodes)
{
    if (nodes <= changes->room) return;
    changes->room = 2 * nodes;
    size_t room = (size_t)changes->room;
    changes->node = sm_realloc(changes->node, room, sizeof *changes->node);
    changes->rest = sm_realloc(changes->rest, room, sizeof *changes->rest);
    changes->x = sm_realloc(changes->x, room, sizeof *changes->x);
    changes->F = sm_realloc(changes->F, room, sizeof *changes->F);
    changes->found = sm_realloc(changes->found, room, 1);
    changes->absent = sm_realloc(changes->absent, room, 1);
}

void bench_changes_nodes(BenchChanges *changes, double back)
{
    const BenchRunner *runner = &changes->part->runner;
    bench_changes_room(changes, runner->particles);
    runner->type->get(runner->engine, SM_POSITION, changes->node);
    if (back == 0) return;
    double(*v)[3] = sm_alloc((size_t)runner->particles, sizeof *v);
    runner->type->get(runner->engine, SM_VELOCITY, v);
    for (long p = 0; p < runner->particles; p++)
        for (int d = 0; d < 3; d++) changes->node[p][d] -= back * v[p][d];
    free(v);
}

void bench_changes_sweep(BenchChanges *changes, double from, double to, SmCut *cut)
{
    const BenchScene *scene = changes->part->runner.scene;
    for (int i = 0; i < scene->cut_count; i++) {
        double blade[4][3];
        if (!bench_blade_moves(&scene->cut[i], from, to, blade)) continue;
        SmCarriers carriers = changes->carrier->near(changes, (const double(*)[3])blade);
        if (!changes->blade[i].down)
            sm_blade_sweep(&changes->blade[i], blade[0], blade[1], &carriers, cut);
        sm_blade_sweep(&changes->blade[i], blade[2], blade[3], &carriers, cut);
        oct_reach_free(&changes->search);
    }
}

SmCode bench_changes_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    long vertices = changes->surface.vertex_count, triangles = changes->surface.triangle_count;
    changes->last = (BenchChanged){0};
    SmCode code = changes->carrier->frame(changes, from, to, error);
    /* what has been split has vertices more, what lay in a gap triangles less; this may be so too
     * where sm_slit() has left some of it */
    changes->last.slit =
        changes->surface.vertex_count != vertices || changes->surface.triangle_count != triangles;
    return code;
}

void bench_changes_surface(BenchChanges *changes, double back, double (*point)[3])
{
    BenchPart *part = changes->part;
    BenchRunner *runner = &part->runner;
    long vertices = changes->surface.vertex_count;
    if (part->body.given) {
        ref_meshless_points(runner->engine, point);
        return;
    }
    bench_changes_nodes(changes, back);
    for (long k = 0; k < part->body.instances; k++, point += vertices)
        changes->carrier->move(changes, k, point);
}

long bench_changes_pieces(const BenchChanges *changes, int *piece)
{
    const BenchRunner *runner = &changes->part->runner;
    SmPieces pieces = {.count = 1};
    changes->carrier->pieces(runner, &pieces);
    for (long v = 0; v < changes->surface.vertex_count; v++)
        piece[v] = pieces.piece ? pieces.piece[changes->carrier->at(changes, v)] : 0;
    long count = pieces.count;
    if (pieces.piece) sm_pieces_free(&pieces);
    return count;
}
