#include "shell_checker.h"

#include <math.h>
#include <stdio.h>

#include "../check/shell_check.h"
#include "elastic_checker.h"
#include "measure.h"

void bench_shell_row_fill(const BenchRunner *runner, BenchRow *row)
{
    const RefShellBody *body = ref_shell_body(runner->engine);
    row->cell = NAN;
    row->epsilon = 0;
    row->goal_error = row->momentum_error = row->goal_tolerance = NAN;
    row->voxelise_seconds = 0;
    row->elastic = (BenchElasticRow){.nodes = body->sheet.warp.nodes,
                                     .end_nodes = body->sheet.warp.nodes,
                                     .map_seconds = body->map.seconds,
                                     .angle = body->map.angle_median,
                                     .matrix_seconds = body->matrix_seconds,
                                     .skin_seconds = body->skin_seconds};
}

static bool breaks(const BenchScene *scene)
{
    return scene->meshless.strength > 0;
}

static void rest(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    (void)check;
    bench_shell_check_body(ref_shell_body(play->group[0].runner.engine), worst);
    bench_elastic_row_note(worst, row);
}

/* One that has come apart: what is drawn is closed, unless edges of its mesh have more than two
 * triangles. */
static void check_broken(BenchGroup *group, BenchElasticFound *found, BenchRow *row)
{
    RefShellBody *body = ref_shell_body(group->runner.engine);
    SmMeshInfo info = sm_mesh_info(&group->skin.surface), whole = sm_mesh_info(&group->body.mesh);
    bench_shell_check_broken(body, found);
    if (body->broke) bench_row_invalidate(row, "a crack could not be followed");
    if (whole.nonmanifold_edges == 0 && info.open_edges + info.nonmanifold_edges > 0)
        bench_row_invalidate(row, "the surface has %ld open edges and %ld of several triangles",
                             info.open_edges, info.nonmanifold_edges);
}

static void state(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    (void)check;
    BenchGroup *group = &play->group[0];
    if (breaks(play->scene))
        check_broken(group, worst, row);
    else
        bench_shell_check_state(&group->runner, worst);
    bench_elastic_row_note(worst, row);
}

const BenchChecker bench_shell_checker = {.size = sizeof(BenchElasticFound),
                                          .takes = bench_elastic_takes,
                                          .breaks = breaks,
                                          .rest = rest,
                                          .state = state};

void bench_shell_row_describe(const BenchRunner *runner, const SmCounts *counts)
{
    const RefShellBody *body = ref_shell_body(runner->engine);
    const RefShellOptions *options = &body->sheet.options.shell;
    const RefMaterial *material = &runner->scene->meshless.material;
    printf(
        "%s: shell, %s precision: %ld points carried by %ld nodes of a %s, %.3g thick; angles of "
        "its map off by %.2g degrees (median); Young's modulus %g, Poisson's ratio %g, density "
        "%g, %.4g mesh units in a metre; built in %.3g s\n",
        runner->scene->name, runner->type->precision, counts->particles, counts->regions,
        ref_map_kind_name(body->map.kind), options->thickness, body->map.angle_median,
        material->young, material->poisson, material->density, runner->scene->metre,
        counts->build_seconds);
    printf("of its mesh %ld triangles were dropped, %d rims closed and %d handles cut; %ld of %ld "
           "integration points are drawn out too far to be stiff\n",
           body->map.dropped, body->map.closed, body->map.handles, body->sheet.shell.soft,
           REF_SAMPLES_PER_CELL * body->sheet.shell.tree.leaves);
    if (body->sheet.tension.stretch > 1.5)
        printf("forces stretched parts of it to %.3g times their length: linear elasticity holds "
               "for some per cent\n",
               body->sheet.tension.stretch);
}

void bench_shell_row_explain(FILE *file, const BenchRow *row)
{
    const BenchElasticRow *e = &row->elastic;
    if (e->whole_ms > 0)
        fprintf(file,
                "    the time is that of steps that make cracks or let some grow; others: %.3g ms; "
                "%ld nodes at first, %ld in the end\n",
                e->whole_ms, e->nodes, e->end_nodes);
    fprintf(
        file,
        "    parameters in %.3g s, angles off by %.2g degrees (median); matrices of %ld nodes in "
        "%.3g s, the points' shape functions in %.3g s; %.3g MB\n",
        e->map_seconds, e->angle, e->nodes, e->matrix_seconds, e->skin_seconds,
        1e-6 * (double)row->bytes);
}
