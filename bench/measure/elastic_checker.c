#include "elastic_checker.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "measure.h"

void bench_elastic_row_fill(const BenchRunner *runner, BenchRow *row)
{
    const RefElastic *elastic = ref_meshless_elastic(runner->engine);
    row->cell = elastic->body.octants.cell;
    row->epsilon = 0;
    row->goal_error = row->momentum_error = row->goal_tolerance = NAN;
    row->voxelise_seconds = 0;
    row->elastic = (BenchElasticRow){.nodes = elastic->body.nodes.count,
                                     .modes = elastic->modes.count,
                                     .field_seconds = elastic->field_seconds,
                                     .matrix_seconds = elastic->matrix_seconds,
                                     .mode_seconds = elastic->mode_seconds,
                                     .skin_seconds = elastic->skin_seconds};
}

SmCode bench_elastic_takes(const BenchScene *scene, SmError *error)
{
    const struct {
        bool there;
        const char *what;
    } beyond[] = {
        {scene->obstacle_count > 0, "obstacles"},
        {scene->force_count > 0, "'forces'"},
        {scene->cut_count > 0, "'cuts'"},
        {scene->touch_count > 0 || scene->view.level > 0, "'touches' or a 'view'"},
        {scene->params.collide.self || scene->params.collide.bodies, "'collide'"},
        {scene->instances > 1, "several instances"},
        {bench_scene_disturbs(scene), "'bend', 'twist', 'squash' or 'kick'"},
    };
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++)
        if (beyond[i].there)
            return sm_fail(error, SM_INPUT,
                           "%s: the frames of a meshless body are measured under handles and "
                           "gravity, and the scene has %s",
                           scene->file, beyond[i].what);
    return SM_OK;
}

static BenchRunner *runner_of(BenchPlayback *play)
{
    return &play->group[0].runner;
}

static SmCode accepts(const BenchPlayback *play, SmError *error)
{
    const RefElastic *elastic = ref_meshless_elastic(play->group[0].runner.engine);
    for (int i = 0; i < elastic->holds; i++)
        for (int other = 0; other < i; other++)
            if (!memcmp(elastic->held[other], elastic->held[i], sizeof elastic->held[i]))
                return sm_fail(error, SM_INPUT,
                               "%s: handles %d and %d bind the same point of the body: move one's "
                               "box or sphere",
                               play->scene->file, other + 1, i + 1);
    return SM_OK;
}

void bench_elastic_row_note(const BenchElasticFound *found, BenchRow *row)
{
    char reason[sizeof row->reason];
    memcpy(row->elastic.found, found->found, sizeof found->found);
    bench_elastic_text(found, sizeof row->found, row->found);
    if (!bench_elastic_verdict(found, sizeof reason, reason))
        bench_row_invalidate(row, "%s", reason);
}

static void rest(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    (void)check;
    bench_elastic_check_body(ref_meshless_elastic(runner_of(play)->engine), worst);
    bench_elastic_row_note(worst, row);
}

static void state(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    (void)check;
    bench_elastic_check_state(runner_of(play), worst);
    bench_elastic_row_note(worst, row);
}

const BenchChecker bench_elastic_checker = {.size = sizeof(BenchElasticFound),
                                            .takes = bench_elastic_takes,
                                            .accepts = accepts,
                                            .rest = rest,
                                            .state = state};

bool bench_row_of_elastic(const BenchRow *row)
{
    return bench_engine(row->engine)->own & (BENCH_OF_ELASTIC | BENCH_OF_SHELL);
}

void bench_elastic_row_describe(const BenchRunner *runner, const SmCounts *counts)
{
    const RefMeshlessOptions *options = &runner->scene->meshless;
    long points = ref_meshless_points(runner->engine, NULL);
    printf("%s: meshless, %s precision: ", runner->scene->name, runner->type->precision);
    if (points) printf("%ld given points and ", points);
    printf("%ld particles carried by %ld nodes; Young's modulus %g, "
           "Poisson's ratio %g, density %g, %.4g mesh units in a metre; built in %.3g s\n",
           counts->particles, counts->regions, options->material.young, options->material.poisson,
           options->material.density, runner->scene->metre, counts->build_seconds);
}

void bench_elastic_row_explain(FILE *file, const BenchRow *row)
{
    const BenchElasticRow *e = &row->elastic;
    fprintf(file,
            "    surface function in %.3g s, matrices of %ld nodes in %.3g s, %ld modes in %.3g s, "
            "the points' shape functions in %.3g s; octants of %.4g; %.3g MB\n",
            e->field_seconds, e->nodes, e->matrix_seconds, e->modes, e->mode_seconds,
            e->skin_seconds, row->cell, 1e-6 * (double)row->bytes);
}
