#include "elastic_row.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../check/elastic_check.h"
#include "../engines.h"
#include "blocks.h"

/* The state that every timed segment starts from. */
typedef struct {
    BenchElastic *elastic;
    double *z, *speed, time;
} Trial;

static void restore(void *subject)
{
    Trial *trial = subject;
    RefMotion *motion = &trial->elastic->motion;
    memcpy(motion->z, trial->z, (size_t)motion->modes * sizeof(double));
    memcpy(motion->speed, trial->speed, (size_t)motion->modes * sizeof(double));
    trial->elastic->time = trial->time;
    ref_motion_pose(motion);
}

static void step(void *subject, SmLaps *laps)
{
    bench_elastic_step(((Trial *)subject)->elastic, laps);
}

static void fill_row(const BenchElastic *elastic, BenchRow *row)
{
    row->particles = elastic->skin.count;
    row->regions = elastic->body.nodes.count;
    row->cell = elastic->body.octants.cell;
    row->bytes = bench_elastic_bytes(elastic);
    row->w = 0;
    row->epsilon = 0;
    row->goal_error = row->momentum_error = row->goal_tolerance = NAN;
    row->summation_nodes = row->width_cells = row->width_edges = NAN;
    row->reached = row->most_reached = NAN;
    row->voxelise_seconds = 0;
    row->build_seconds = elastic->field_seconds + elastic->matrix_seconds + elastic->mode_seconds +
                         elastic->skin_seconds;
    row->elastic = (BenchElasticRow){.nodes = elastic->body.nodes.count,
                                     .modes = elastic->modes.count,
                                     .field_seconds = elastic->field_seconds,
                                     .matrix_seconds = elastic->matrix_seconds,
                                     .mode_seconds = elastic->mode_seconds,
                                     .skin_seconds = elastic->skin_seconds};
}

static void time_frames(BenchElastic *elastic, const BenchMeasureParams *params, BenchRow *row)
{
    size_t modes = (size_t)elastic->motion.modes;
    Trial trial = {elastic, sm_alloc(modes, sizeof(double)), sm_alloc(modes, sizeof(double)),
                   elastic->time};
    memcpy(trial.z, elastic->motion.z, modes * sizeof(double));
    memcpy(trial.speed, elastic->motion.speed, modes * sizeof(double));
    bench_time_blocks(&(BenchTimed){&trial, restore, step}, params, row);
    free(trial.z);
    free(trial.speed);
}

SmCode bench_elastic_measure(const BenchScene *scene, const BenchBody *body,
                             const BenchMeasureParams *params, BenchRow *row, SmError *error)
{
    BenchElastic elastic;
    BenchElasticFound found = {{0}};
    SmCode code = bench_elastic_create(scene, body, &elastic, error);
    if (code) return code;
    fill_row(&elastic, row);
    code = bench_elastic_check_body(&elastic, &found, error);
    if (!code) {
        for (int i = 0; i < scene->settle; i++) bench_elastic_step(&elastic, NULL);
        bench_elastic_check_state(&elastic, &found);
        time_frames(&elastic, params, row);
        bench_elastic_check_state(&elastic, &found);
        memcpy(row->elastic.found, found.found, sizeof found.found);
        row->valid = bench_elastic_verdict(&found, sizeof row->reason, row->reason);
        bench_elastic_text(&found, sizeof row->found, row->found);
    }
    bench_elastic_free(&elastic);
    return code;
}

bool bench_row_of_elastic(const BenchRow *row)
{
    return bench_engine(row->engine)->elastic;
}

void bench_elastic_row_text(FILE *file, const BenchRow *row)
{
    const BenchElasticRow *e = &row->elastic;
    fprintf(file,
            "    surface function in %.3g s, matrices of %ld nodes in %.3g s, %ld modes in %.3g s, "
            "the points' shape functions in %.3g s; octants of %.4g; %.3g MB a frame\n",
            e->field_seconds, e->nodes, e->matrix_seconds, e->modes, e->mode_seconds,
            e->skin_seconds, row->cell, 1e-6 * (double)row->bytes);
}
