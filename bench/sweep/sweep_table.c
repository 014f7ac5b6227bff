#include "sweep_table.h"

#include <math.h>
#include <string.h>

#include "../engines.h"
#include "../store/export.h"
#include "../table/grid.h"

enum { REASONS = 8 };

static void number(double value, char text[BENCH_GRID_TEXT])
{
    if (value == 0)
        strcpy(text, "0");
    else
        bench_grid_number(value, text);
}

/* "40/10/16/28/6": percent of the total. */
static void stages(const BenchPoint *p, char text[BENCH_GRID_TEXT])
{
    size_t used = 0;
    for (int s = 0; s < SM_STAGES && p->valid; s++)
        used += (size_t)snprintf(text + used, BENCH_GRID_TEXT - used, "%s%.0f", s ? "/" : "",
                                 100 * p->stage_ms[s] / p->total_ms);
    if (!p->valid) strcpy(text, "-");
}

static void add_columns(BenchGrid *grid, const char *width)
{
    static char w[32];
    snprintf(w, sizeof w, "w %.20s", width);
    bench_grid_column(grid, "engine", true);
    bench_grid_column(grid, w, false);
    bench_grid_column(grid, "epsilon", false);
    bench_grid_column(grid, "nodes", false);
    bench_grid_column(grid, "w cells", false);
    bench_grid_column(grid, "sums/region", false);
    bench_grid_column(grid, "ms/step", false);
    bench_grid_column(grid, "stages %", false);
    bench_grid_column(grid, "build ms", false);
    bench_grid_column(grid, "kB", false);
    bench_grid_column(grid, "relaxation", false);
    bench_grid_column(grid, "sag %", false);
    bench_grid_column(grid, "Hz", false);
    bench_grid_column(grid, "goals off", false);
    bench_grid_column(grid, "path off %", false);
    bench_grid_column(grid, "most %", false);
    bench_grid_column(grid, "front", true);
}

static void add_line(BenchGrid *grid, const BenchPoint *p)
{
    BenchGridLine *line = bench_grid_add(grid);
    bool tree = bench_engine(p->engine)->sampled;
    int c = 0;
    strcpy((*line)[c++], p->engine);
    snprintf((*line)[c++], BENCH_GRID_TEXT, "%g", p->w);
    if (tree)
        snprintf((*line)[c++], BENCH_GRID_TEXT, "%g", p->epsilon);
    else
        strcpy((*line)[c++], "-");
    if (p->parts > 1)
        snprintf((*line)[c++], BENCH_GRID_TEXT, "%ld in %ld parts", p->particles, p->parts);
    else
        snprintf((*line)[c++], BENCH_GRID_TEXT, "%ld", p->particles);
    number(p->width_cells, (*line)[c++]);
    number(p->summation_nodes, (*line)[c++]);
    if (!p->valid || p->reason[0])
        strcpy((*line)[c++], p->valid ? "BUSY" : "INVALID");
    else
        number(p->total_ms, (*line)[c++]);
    stages(p, (*line)[c++]);
    number(1e3 * p->build_seconds, (*line)[c++]);
    number(1e-3 * (double)p->bytes, (*line)[c++]);
    number(p->relaxation, (*line)[c++]);
    number(100 * p->sag, (*line)[c++]);
    number(p->frequency, (*line)[c++]);
    number(p->goal_rms, (*line)[c++]);
    number(100 * p->path_rms, (*line)[c++]);
    number(100 * p->path_most, (*line)[c++]);
    strcpy((*line)[c], p->front ? "*" : "");
}

/* Says a reason unless it has been said. */
static void say_once(FILE *file, const BenchPoint *p, const char *what, const char *reason,
                     const char *said[REASONS], int *count)
{
    if (!reason[0] || *count == REASONS) return;
    for (int i = 0; i < *count; i++)
        if (!strcmp(said[i], reason)) return;
    said[(*count)++] = reason;
    fprintf(file, "  %s w %g epsilon %g%s: %s\n", p->engine, p->w, p->epsilon, what, reason);
}

static void write_reasons(FILE *file, const BenchSweep *sweep)
{
    const char *said[REASONS];
    int count = 0;
    for (long i = 0; i < sweep->count; i++) {
        const BenchPoint *p = &sweep->point[i];
        say_once(file, p, p->valid ? " is BUSY" : " is INVALID", p->reason, said, &count);
        say_once(file, p, ", goals", p->goal_why, said, &count);
        say_once(file, p, ", beam", p->beam_why, said, &count);
        say_once(file, p, ", path", p->path_why, said, &count);
    }
}

/* Times of different machines do not compare, nor does a front that is made of them. */
static void write_hosts(FILE *file, const BenchSweep *sweep)
{
    for (long i = 1; i < sweep->count; i++) {
        const char *first = sweep->point[0].host, *other = sweep->point[i].host;
        if (!strcmp(first, other)) continue;
        fprintf(file, "Points are of several hosts (%s, %s): times, and the front, mix them.\n",
                first, other);
        return;
    }
}

static void write_text(FILE *file, const BenchSweep *sweep, const BenchGrid *grid)
{
    const BenchPlan *plan = &sweep->plan;
    bool other = plan->mesh[0] && !bench_plan_alone(plan);
    fprintf(file,
            "%s%s%s: cost against stiffness and deviation, %ld of %d points, on %s, %d thread%s.\n"
            "w: half-width of regions, of fastlsm in cells, of the octree in %s.\n\n",
            plan->scene, other ? " with " : "", other ? plan->mesh : "", sweep->count, plan->points,
            sweep->machine.cpu, plan->threads, plan->threads == 1 ? "" : "s",
            strcmp(plan->width, "edges") != 0 ? "finest cells" : "edges of each node's own cell");
    bench_grid_whole(file, grid, BENCH_GRID_PLAIN);
    fputs("\nstages %: fast sum/shape matching/polar/damping/other. Stiffness is a regular beam's, "
          "0.8 m x 0.1 m: relaxation of a bending wave a step, sag\nof its length in the limit of "
          "small sags (of a soft one above 100%), first natural frequency. goals off: from epsilon "
          "0, finest cells, rms.\npath off: the surface from a lattice's of equal width (w cells) "
          "at full resolution, of the body's size, rms and most. "
          "*: on the front of\ncost (ms/step) against deviation (path off).\n",
          file);
    write_hosts(file, sweep);
    write_reasons(file, sweep);
}

static void write_csv(FILE *file, const BenchSweep *sweep)
{
    int count;
    const BenchField *fields = bench_point_fields(&count);
    bench_csv_records(file, fields, count, sweep->point, sizeof *sweep->point, sweep->count, NULL);
}

static void write_json(FILE *file, const BenchSweep *sweep)
{
    int points, plan;
    const BenchField *point_fields = bench_point_fields(&points);
    const BenchField *plan_fields = bench_plan_fields(&plan);
    json_t *root = json_object();
    json_object_set_new(
        root, "points",
        bench_json_records(point_fields, points, sweep->point, sizeof *sweep->point, sweep->count));
    json_object_set_new(root, "plan", bench_json_record(plan_fields, plan, &sweep->plan));
    json_object_set_new(root, "environment", bench_json_machine(&sweep->machine));
    bench_json_write(file, root);
}

void bench_sweep_table(FILE *file, BenchFormat format, const BenchSweep *sweep)
{
    if (format == BENCH_AS_CSV || format == BENCH_AS_JSON) {
        (format == BENCH_AS_CSV ? write_csv : write_json)(file, sweep);
        return;
    }
    BenchGrid grid = {0};
    add_columns(&grid, sweep->plan.width);
    for (long i = 0; i < sweep->count; i++) add_line(&grid, &sweep->point[i]);
    if (format == BENCH_AS_TEXT)
        write_text(file, sweep, &grid);
    else
        bench_grid_whole(file, &grid, bench_format_form(format));
    bench_grid_free(&grid);
}
