#include "sweep_table.h"

#include <string.h>

#include "../campaign/export.h"
#include "../table/records.h"

enum { REASONS = 8 };

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

static void write_reasons(FILE *file, const BenchCampaign *sweep)
{
    const char *said[REASONS];
    int count = 0;
    for (long i = 0; i < sweep->count; i++) {
        const BenchPoint *p = bench_campaign_at(sweep, i);
        say_once(file, p, p->valid ? " is BUSY" : " is INVALID", p->reason, said, &count);
        say_once(file, p, ", goals", p->goal_why, said, &count);
        say_once(file, p, ", beam", p->beam_why, said, &count);
        say_once(file, p, ", path", p->path_why, said, &count);
    }
}

/* Times of different machines do not compare, nor does a front that is made of them. */
static void write_hosts(FILE *file, const BenchCampaign *sweep)
{
    for (long i = 1; i < sweep->count; i++) {
        const char *first = ((const BenchPoint *)bench_campaign_at(sweep, 0))->host,
                   *other = ((const BenchPoint *)bench_campaign_at(sweep, i))->host;
        if (!strcmp(first, other)) continue;
        fprintf(file, "Points are of several hosts (%s, %s): times, and the front, mix them.\n",
                first, other);
        return;
    }
}

static void write_text(FILE *file, const BenchCampaign *sweep, const BenchGrid *grid)
{
    const BenchPlan *plan = sweep->plan;
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

void bench_sweep_table(FILE *file, BenchFormat format, const BenchCampaign *sweep)
{
    if (format == BENCH_AS_CSV || format == BENCH_AS_JSON) {
        bench_campaign_export(file, format, sweep, NULL);
        return;
    }
    BenchGrid grid = bench_records_grid(bench_point_fields, bench_point_field_count, sweep->point,
                                        sizeof(BenchPoint), sweep->count, 0);
    char width[32];
    snprintf(width, sizeof width, "w %.20s", ((const BenchPlan *)sweep->plan)->width);
    bench_grid_rename(&grid, 1, width);
    if (format == BENCH_AS_TEXT)
        write_text(file, sweep, &grid);
    else
        bench_grid_whole(file, &grid, bench_format_form(format));
    bench_grid_free(&grid);
}
