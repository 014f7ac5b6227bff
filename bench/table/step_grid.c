#include "step_grid.h"

#include <math.h>
#include <string.h>

#include "../../reference/paper.h"

enum { FIELD_TEXT = BENCH_GRID_TEXT };
enum {
    SCENE,
    PARTICLES,
    REGIONS,
    W,
    STAGES,
    TOTAL = STAGES + SM_STAGES,
    PER_STEP,
    FASTER,
    RATE, /* this and the next two only in a table with an octree's row */
    SPEEDUP,
    SUMS,
    QUARTILES, /* this and the next only in LaTeX */
    SAMPLES,
    VERDICT,
    FIELDS
};

static const char *const headings[FIELDS] = {
    "scene",
    "particles",
    "regions",
    "w",
    "fast sum",
    "shape matching",
    "polar",
    "damping",
    "other",
    "total ms",
    "ns/particle/step",
    "faster",
    "frames/s",
    "speed-up",
    "sums/region",
    "quartiles ms",
    "samples",
    "check",
};

static const char *const text_headings[FIELDS] = {
    "scene",    "particles", "regions", "w",  "sum",     "match", "polar", "damp", "other",
    "total ms", NULL,        "faster",  NULL, "speedup", NULL,    NULL,    NULL,   "check",
};

typedef struct {
    char field[FIELDS][FIELD_TEXT];
} Line;

bool bench_row_of_octree(const BenchRow *row)
{
    return !strcmp(row->paper, "octree") || !strcmp(row->engine, "octree");
}

/* Which fields the table has. */
static void choose_fields(const BenchRow *rows, int count, BenchGridForm form, bool shown[FIELDS])
{
    bool octree = false, text = form == BENCH_GRID_PLAIN;
    for (int r = 0; r < count; r++) octree |= bench_row_of_octree(&rows[r]);
    for (int f = 0; f < FIELDS; f++) shown[f] = !text || text_headings[f];
    for (int f = RATE; f <= SUMS; f++) shown[f] &= octree;
    for (int f = REGIONS; f <= W; f++) shown[f] &= !octree || !text;
    for (int f = QUARTILES; f <= SAMPLES; f++) shown[f] &= form == BENCH_GRID_LATEX;
}

static void stage_text(double ms, double percent, bool text_form, char text[FIELD_TEXT])
{
    char number[FIELD_TEXT];
    bench_grid_number(ms, number);
    if (text_form && isfinite(percent))
        snprintf(text, FIELD_TEXT, "%.0f%%", percent);
    else if (isfinite(percent))
        snprintf(text, FIELD_TEXT, "%.40s (%2.0f%%)", number, percent);
    else
        snprintf(text, FIELD_TEXT, "%.40s", number);
}

static void measured_line(const BenchRow *row, BenchGridForm form, Line *line)
{
    memset(line, 0, sizeof *line);
    snprintf(line->field[SCENE], FIELD_TEXT, "%s", row->scene);
    snprintf(line->field[PARTICLES], FIELD_TEXT, "%ld", row->particles);
    snprintf(line->field[REGIONS], FIELD_TEXT, "%ld", row->regions);
    snprintf(line->field[W], FIELD_TEXT, row->w ? "%d" : "-", row->w);
    bench_grid_number(bench_row_of_octree(row) ? row->summation_nodes : NAN, line->field[SUMS]);
    snprintf(line->field[SAMPLES], FIELD_TEXT, "%d", row->repeats);
    const char *mark = bench_row_mark(row);
    strcpy(line->field[VERDICT], mark);
    strcpy(line->field[QUARTILES], mark);
    for (int f = STAGES; f < SUMS && !bench_row_timed(row); f++)
        strcpy(line->field[f], form == BENCH_GRID_PLAIN && f < TOTAL ? "-" : mark);
    if (!bench_row_timed(row)) return;
    for (int s = 0; s < SM_STAGES; s++)
        stage_text(row->stage_ms[s], 100 * row->stage_ms[s] / row->total_ms,
                   form == BENCH_GRID_PLAIN, line->field[STAGES + s]);
    if (!(row->damping > 0)) strcpy(line->field[STAGES + SM_DAMPING], "-");
    bench_grid_number(row->total_ms, line->field[TOTAL]);
    bench_grid_range(row->total_low_ms, row->total_high_ms, line->field[QUARTILES]);
    bench_grid_number(row->ns_per_particle_step, line->field[PER_STEP]);
    bench_grid_number(row->fps, line->field[RATE]);
    bench_grid_number(row->speedup, line->field[SPEEDUP]);
    if (!isfinite(row->paper_total_ms)) return;
    bench_grid_number(row->paper_total_ms / row->total_ms, line->field[FASTER]);
    strcat(line->field[FASTER], "x");
}

static void count_text(RefValue value, char text[FIELD_TEXT])
{
    if (isfinite(value.value)) snprintf(text, FIELD_TEXT, "%.0f", value.value);
}

/* What stands behind a value of the paper's. */
static void mark(RefStatus status, char text[FIELD_TEXT])
{
    if (status == REF_DAMAGED) strcat(text, "?");
    if (status == REF_SECOND_HAND) strcat(text, "*");
}

/* The paper's values, "?" behind a damaged or misprinted one, "*" behind a second-hand one; false
 * where there are none. */
static bool paper_line(const BenchRow *row, BenchGridForm form, Line *line)
{
    const RefPaperRow *paper = row->paper[0] ? ref_paper_find(row->paper, row->paper_row) : NULL;
    memset(line, 0, sizeof *line);
    if (!paper) return false;
    strcpy(line->field[SCENE], "  paper");
    count_text(paper->particles, line->field[PARTICLES]);
    count_text(paper->regions, line->field[REGIONS]);
    count_text(paper->w, line->field[W]);
    for (int s = 0; s < SM_STAGES; s++) {
        stage_text(paper->stage_ms[s].value, paper->stage_percent[s].value,
                   form == BENCH_GRID_PLAIN, line->field[STAGES + s]);
        mark(paper->stage_ms[s].status, line->field[STAGES + s]);
    }
    bench_grid_number(paper->total_ms.value, line->field[TOTAL]);
    bench_grid_number(1e6 * paper->total_ms.value / paper->particles.value, line->field[PER_STEP]);
    bench_grid_number(paper->fps.value, line->field[RATE]);
    bench_grid_number(paper->speedup.value, line->field[SPEEDUP]);
    if (isfinite(paper->speedup.value)) mark(paper->speedup.status, line->field[SPEEDUP]);
    bench_grid_number(paper->summation_nodes.value, line->field[SUMS]);
    static const int timed[] = {TOTAL, PER_STEP, RATE};
    for (int t = 0; t < 3; t++)
        if (strcmp(line->field[timed[t]], "-") != 0)
            mark(ref_paper_step_status(paper), line->field[timed[t]]);
    return true;
}

void bench_step_columns(const BenchRow *rows, int count, BenchGridForm form, BenchGrid *grid)
{
    bool shown[FIELDS];
    choose_fields(rows, count, form, shown);
    for (int f = 0; f < FIELDS; f++)
        if (shown[f])
            bench_grid_column(grid, form == BENCH_GRID_PLAIN ? text_headings[f] : headings[f],
                              f == SCENE || f == VERDICT);
    for (int r = 0; r < count; r++)
        if ((int)strlen(rows[r].scene) > grid->width[SCENE])
            grid->width[SCENE] = (int)strlen(rows[r].scene);
}

static void add_line(BenchGrid *grid, const Line *line, const bool shown[FIELDS])
{
    BenchGridLine *to = bench_grid_add(grid);
    for (int f = 0, column = 0; f < FIELDS; f++)
        if (shown[f]) strcpy((*to)[column++], line->field[f]);
}

void bench_step_lines(const BenchRow *rows, int count, int r, BenchGridForm form, BenchGrid *grid)
{
    bool shown[FIELDS];
    Line line;
    choose_fields(rows, count, form, shown);
    measured_line(&rows[r], form, &line);
    add_line(grid, &line, shown);
    if (paper_line(&rows[r], form, &line)) add_line(grid, &line, shown);
}
