#include "elastic_row.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/paper.h"
#include "../check/elastic_check.h"
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
    return !strcmp(row->engine, "meshless");
}

enum {
    SCENE,
    POINTS,
    NODES,
    MODES,
    MATRICES,
    MODE_TIME,
    MOTION,
    SKIN,
    FRAME,
    FASTER,
    VERDICT,
    QUARTILES, /* this and the next only in LaTeX */
    SAMPLES,
    FIELDS
};

static const char *const headings[] = {
    "scene",   "points",   "nodes",  "modes", "matrices s",   "modes s", "motion ms",
    "skin ms", "frame ms", "faster", "check", "quartiles ms", "samples",
};

static int fields_of(BenchGridForm form)
{
    return form == BENCH_GRID_LATEX ? FIELDS : QUARTILES;
}

void bench_elastic_columns(const BenchRow *rows, int count, BenchGridForm form, BenchGrid *grid)
{
    bool text = form == BENCH_GRID_PLAIN;
    for (int f = 0; f < fields_of(form); f++)
        bench_grid_column(grid,
                          text && f == MOTION ? "motion"
                          : text && f == SKIN ? "skin"
                                              : headings[f],
                          f == SCENE || f == VERDICT);
    for (int r = 0; r < count; r++)
        if (bench_row_of_elastic(&rows[r]) && (int)strlen(rows[r].scene) > grid->width[SCENE])
            grid->width[SCENE] = (int)strlen(rows[r].scene);
}

/* A part of the frame: as text only its percent. */
static void part_text(double ms, double total, BenchGridForm form, char text[BENCH_GRID_TEXT])
{
    char number[BENCH_GRID_TEXT];
    bench_grid_number(ms, number);
    if (form == BENCH_GRID_PLAIN)
        snprintf(text, BENCH_GRID_TEXT, "%.0f%%", 100 * ms / total);
    else
        snprintf(text, BENCH_GRID_TEXT, "%.40s (%2.0f%%)", number, 100 * ms / total);
}

static void measured_line(const BenchRow *row, BenchGridForm form, BenchGridLine *line)
{
    const BenchElasticRow *e = &row->elastic;
    snprintf((*line)[SCENE], BENCH_GRID_TEXT, "%.60s", row->scene);
    snprintf((*line)[POINTS], BENCH_GRID_TEXT, "%ld", row->particles);
    snprintf((*line)[NODES], BENCH_GRID_TEXT, "%ld", e->nodes);
    snprintf((*line)[MODES], BENCH_GRID_TEXT, "%ld", e->modes);
    snprintf((*line)[SAMPLES], BENCH_GRID_TEXT, "%d", row->repeats);
    const char *mark = bench_row_mark(row);
    strcpy((*line)[VERDICT], mark);
    strcpy((*line)[QUARTILES], mark);
    for (int column = MATRICES; column <= FASTER; column++)
        strcpy((*line)[column], form == BENCH_GRID_PLAIN && column < FRAME ? "-" : mark);
    if (!bench_row_timed(row)) return;
    bench_grid_number(e->matrix_seconds, (*line)[MATRICES]);
    bench_grid_number(e->mode_seconds, (*line)[MODE_TIME]);
    part_text(row->stage_ms[SM_SHAPE_MATCHING], row->total_ms, form, (*line)[MOTION]);
    part_text(row->stage_ms[SM_OTHER], row->total_ms, form, (*line)[SKIN]);
    bench_grid_number(row->total_ms, (*line)[FRAME]);
    bench_grid_range(row->total_low_ms, row->total_high_ms, (*line)[QUARTILES]);
    (*line)[FASTER][0] = '\0';
    if (!isfinite(row->paper_total_ms)) return;
    bench_grid_number(row->paper_total_ms / row->total_ms, (*line)[FASTER]);
    strcat((*line)[FASTER], "x");
}

/* The paper's times of set-up are upper bounds. */
static void paper_line(const RefPaperRow *paper, BenchGridLine *line)
{
    strcpy((*line)[SCENE], "  paper");
    snprintf((*line)[POINTS], BENCH_GRID_TEXT, "%.0f", paper->particles.value);
    snprintf((*line)[NODES], BENCH_GRID_TEXT, "%.0f", paper->nodes.value);
    snprintf((*line)[MODES], BENCH_GRID_TEXT, "%.0f", paper->modes.value);
    snprintf((*line)[MATRICES], BENCH_GRID_TEXT, "< %.0f", paper->matrix_s.value);
    snprintf((*line)[MODE_TIME], BENCH_GRID_TEXT, "< %.0f", paper->mode_s.value);
    strcpy((*line)[MOTION], "-");
    strcpy((*line)[SKIN], "-");
    bench_grid_number(paper->total_ms.value, (*line)[FRAME]);
}

void bench_elastic_lines(const BenchRow *rows, int count, int r, BenchGridForm form,
                         BenchGrid *grid)
{
    const BenchRow *row = &rows[r];
    const RefPaperRow *paper = row->paper[0] ? ref_paper_find(row->paper, row->paper_row) : NULL;
    (void)count;
    measured_line(row, form, bench_grid_add(grid));
    if (paper && isfinite(paper->nodes.value)) paper_line(paper, bench_grid_add(grid));
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
