#include "body_group.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../scene/blades.h"

/* How far its links may be stretched before they break; 0: they do not, or its engine does not say
 * which did. */
static double strain_limit(const BenchRunner *runner)
{
    double limit = runner->scene->params.strain_limit;
    return runner->type->links && runner->type->pieces && isfinite(limit) ? limit : 0;
}

bool bench_group_changes(const BenchGroup *group)
{
    const BenchScene *scene = group->runner.scene;
    return group->touched || group->skin.drawn || scene->cut_count > 0 || scene->view.level > 0 ||
           strain_limit(&group->runner) > 0;
}

static SmCode check(const BenchGroup *group, SmError *error)
{
    const BenchCarrier *carrier = group->carrier;
    if (!carrier->may_change || !bench_group_changes(group)) return SM_OK;
    SmError why;
    SmCode code = carrier->may_change(group->runner.engine, &why);
    return code ? sm_fail(error, code, "%s: %s", group->runner.scene->file, why.text) : SM_OK;
}

/* Embeds the surface in the bodies. */
static void create_skin(BenchGroup *group)
{
    const SmMesh *mesh = &group->body.mesh;
    const RefPoints *points = group->body.given ? &group->body.given->points : NULL;
    long vertices = points ? points->given : mesh->vertex_count;
    long triangles = points ? 0 : mesh->triangle_count;
    SmMesh surface = sm_mesh_new(vertices, triangles);
    memcpy(surface.position, points ? points->as_given : mesh->position,
           (size_t)vertices * sizeof *mesh->position);
    memcpy(surface.triangle, mesh->triangle, (size_t)triangles * sizeof *mesh->triangle);
    const BenchRunner *runner = &group->runner;
    for (int i = 0; i < runner->scene->cut_count; i++) sm_blade_init(&group->blade[i]);
    double limit = strain_limit(runner);
    bool cut_lattice = runner->scene->cut_count > 0 && !runner->type->refines;
    sm_skin_create(runner->type, runner->engine, &group->body.voxels, group->body.instances,
                   cut_lattice || limit > 0 ? (const double(*)[3])runner->x0 : NULL, limit,
                   points ? (SmMesh){0} : surface, &group->skin);
    if (points) group->skin.surface = surface;
    if (cut_lattice && !(limit > 0)) group->body.cut = &group->skin.cut;
}

SmCode bench_group_create(const BenchScene *scene, const BenchBody *body, long count,
                          const long *instance, bool touched, const SmEngineType *type, int threads,
                          BenchGroup *group, SmError *error)
{
    *group = (BenchGroup){.body = *body, .touched = touched};
    group->carrier = bench_engine(type->name)->carrier;
    group->body.instances = count;
    group->body.pose = sm_alloc((size_t)count, sizeof *group->body.pose);
    group->instance = sm_alloc((size_t)count, sizeof *group->instance);
    for (long i = 0; i < count; i++) {
        group->instance[i] = instance[i];
        memcpy(group->body.pose[i], body->pose[instance[i]], sizeof *group->body.pose);
    }
    SmCode code = bench_runner_create(scene, &group->body, type, threads, &group->runner, error);
    if (!code) code = check(group, error);
    if (code)
        bench_group_free(group);
    else
        create_skin(group);
    return code;
}

void bench_group_free(BenchGroup *group)
{
    for (int i = 0; i < BENCH_MAX; i++) {
        sm_blade_free(&group->blade[i]);
        oct_refinement_free(&group->touch[i]);
    }
    oct_refinement_free(&group->view);
    sm_skin_free(&group->skin);
    bench_runner_free(&group->runner);
    free(group->body.pose);
    free(group->instance);
    *group = (BenchGroup){0};
}

void bench_group_sweep(BenchGroup *group, double from, double to, SmCut *cut)
{
    const BenchScene *scene = group->runner.scene;
    for (int i = 0; i < scene->cut_count; i++) {
        double blade[4][3];
        if (!bench_blade_moves(&scene->cut[i], from, to, blade)) continue;
        if (group->blade[i].down) memcpy(blade, group->blade[i].end, sizeof group->blade[i].end);
        SmCarriers carriers = sm_skin_carriers(&group->skin, (const double(*)[3])blade);
        if (!group->blade[i].down)
            sm_blade_sweep(&group->blade[i], blade[0], blade[1], &carriers, cut);
        sm_blade_sweep(&group->blade[i], blade[2], blade[3], &carriers, cut);
        sm_skin_carried(&group->skin);
    }
}

/* What has been split has vertices more, what lay in a gap triangles less; this may be so too where
 * sm_cut_surface() has left some of it. */
static bool differs(const BenchGroup *group, long vertices, long triangles)
{
    const SmMesh *surface = &group->skin.surface;
    return surface->vertex_count != vertices || surface->triangle_count != triangles;
}

bool bench_group_follow(BenchGroup *group)
{
    long vertices = group->skin.surface.vertex_count,
         triangles = group->skin.surface.triangle_count;
    double start = sm_now();
    if (!group->carrier->follow || !group->carrier->follow(group)) return false;
    group->last.resampled = true;
    group->last.split |= group->skin.drawn || differs(group, vertices, triangles);
    group->last.follow_seconds += sm_now() - start;
    return true;
}

SmCode bench_group_frame(BenchGroup *group, double from, double to, SmError *error)
{
    long vertices = group->skin.surface.vertex_count,
         triangles = group->skin.surface.triangle_count;
    group->last = (BenchChanged){0};
    bench_group_follow(group);
    SmCode code = SM_OK;
    if (group->carrier->frame) code = group->carrier->frame(group, from, to, error);
    group->last.split |= differs(group, vertices, triangles);
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

void bench_group_surface(BenchGroup *group, double back, double (*point)[3])
{
    if (group->body.given && !group->runner.type->vertices) {
        ref_meshless_points(group->runner.engine, point);
        return;
    }
    double(*node)[3] = back == 0 ? NULL : nodes_back(&group->runner, back);
    sm_skin_points(&group->skin, (const double(*)[3])node, point, NULL);
    free(node);
}

long bench_group_pieces(const BenchGroup *group, int *piece)
{
    SmPieces pieces;
    sm_skin_pieces(&group->skin, &pieces);
    for (long v = 0; v < group->skin.surface.vertex_count; v++)
        piece[v] = pieces.piece[sm_skin_carrier(&group->skin, v)];
    long count = pieces.count;
    sm_pieces_free(&pieces);
    return count;
}
