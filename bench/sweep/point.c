#include "point.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../engines.h"
#include "../table/grid.h"

#define FIELD(type, member)  BENCH_FIELD_AS(BenchPoint, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)
#define PLACE(type, member)                                                                        \
    .kind = BENCH_##type, .offset = offsetof(BenchPoint, member),                                  \
    .size = sizeof(((BenchPoint *)0)->member)

/* ---- cells of the table for people */

static void epsilon_cell(const void *record, char *text)
{
    const BenchPoint *p = record;
    if (bench_engine(p->engine)->sampled)
        snprintf(text, BENCH_GRID_TEXT, "%g", p->epsilon);
    else
        strcpy(text, "-");
}

static void nodes_cell(const void *record, char *text)
{
    const BenchPoint *p = record;
    snprintf(text, BENCH_GRID_TEXT, "%ld", p->particles);
    if (p->parts > 1) sm_append(text, BENCH_GRID_TEXT, " in %ld parts", p->parts);
}

static void total_cell(const void *record, char *text)
{
    const BenchPoint *p = record;
    if (!p->valid || p->reason[0])
        strcpy(text, p->valid ? "BUSY" : "INVALID");
    else
        bench_grid_number(p->total_ms, text);
}

/* "40/10/16/28/6": percent of the total. */
static void stages_cell(const void *record, char *text)
{
    const BenchPoint *p = record;
    strcpy(text, p->valid ? "" : "-");
    for (int s = 0; s < SM_STAGES && p->valid; s++)
        sm_append(text, BENCH_GRID_TEXT, "%s%.0f", s ? "/" : "",
                  100 * p->stage_ms[s] / p->total_ms);
}

/* ---- all members */

const BenchField bench_point_fields[] = {
    {FIELD(INT, index), MEANS(NULL, "place in the plan")},
    {FIELD(TEXT, engine), MEANS(NULL, "fastlsm or octree"), .given_by_plan = true,
     .title = "engine", .left = true},
    {FIELD(DOUBLE, w),
     MEANS(NULL, "half-width of regions: of fastlsm in cells, of an octree as `width` of the plan "
                 "counts"),
     .given_by_plan = true, .title = "w", .format = "%g"},
    {FIELD(DOUBLE, epsilon), MEANS(NULL, "the octree's; 0 of a lattice"), .given_by_plan = true,
     BENCH_CELL("epsilon", epsilon_cell)},
    {FIELD(BOOL, valid),
     MEANS(NULL, "1: the check against brute force, as of a row, and those of the qualities below "
                 "passed; otherwise all times are NaN")},
    {FIELD(TEXT, reason),
     MEANS(NULL, "why it is not valid; of a valid point why it is BUSY, and has no times")},
    {FIELD(LONG, particles), MEANS(NULL, "or nodes"), BENCH_CELL("nodes", nodes_cell)},
    {FIELD(LONG, regions), MEANS(NULL, "unique ones")},
    {FIELD(DOUBLE, width_cells),
     MEANS("finest cells", "half-width with which a lattice's regions hold as much, see below; of "
                           "a lattice w"),
     .title = "w cells"},
    {PLACE(DOUBLE, summation_nodes), .title = "sums/region"},
    {FIELD(DOUBLE, total_ms), MEANS("ms", "median of a step"), BENCH_CELL("ms/step", total_cell)},
    {FIELD(DOUBLE, total_low_ms), MEANS("ms", "lower quartile")},
    {FIELD(DOUBLE, total_high_ms), MEANS("ms", "upper quartile")},
    {FIELD(DOUBLE, stage_ms), MEANS("ms", "as of a row"), .stages = true,
     BENCH_CELL("stages %", stages_cell)},
    {FIELD(DOUBLE, build_seconds), MEANS("s", "set-up"), .title = "build ms", .scale = 1e3},
    {FIELD(LONG, bytes),
     MEANS("bytes", "of memory that making the engine took, about; 0: not known"), .title = "kB",
     .scale = 1e-3},
    {FIELD(DOUBLE, summation_nodes), MEANS(NULL, "of a region: mean; NaN of a lattice")},
    {FIELD(LONG, most_summation), MEANS(NULL, "of a region: most; 0 of a lattice")},
    {FIELD(LONG, parts),
     MEANS(NULL, "groups of nodes that no region holds together; 0 of a lattice")},
    {FIELD(DOUBLE, goal_error),
     MEANS("cells", "of the timed engine from brute force over the same regions")},
    {PLACE(DOUBLE, sag), .title = "sag %", .scale = 100},
    {PLACE(DOUBLE, frequency), .title = "Hz"},
    {FIELD(DOUBLE, goal_rms),
     MEANS("finest cells", "goal positions from those of epsilon 0: root of the mean square by "
                           "mass"),
     .title = "goals off"},
    {FIELD(DOUBLE, goal_most), MEANS("finest cells", "the same: most")},
    {FIELD(TEXT, goal_why), MEANS(NULL, "why they are not there")},
    {FIELD(DOUBLE, sag), MEANS("of the length", "of a clamped beam in the limit of small ones")},
    {FIELD(DOUBLE, frequency), MEANS("Hz", "first natural one of that beam")},
    {FIELD(TEXT, beam_why), MEANS(NULL, "why these two are not there")},
    {FIELD(INT, full_w),
     MEANS("cells", "half-width of the lattice that `path_rms` is from: `width_cells` rounded")},
    {FIELD(DOUBLE, path_rms), MEANS("of `size`", "surface from full resolution: root mean square"),
     .title = "path off %", .scale = 100},
    {FIELD(DOUBLE, path_most), MEANS("of `size`", "the same: most"), .title = "most %",
     .scale = 100},
    {FIELD(TEXT, path_why), MEANS(NULL, "why they are not there")},
    {FIELD(BOOL, front),
     MEANS(NULL, "1: no other valid point with a `frequency` within 10% of this one's is at most "
                 "as far off (`path_rms`) and cheaper beyond the noise: its `total_high_ms` below "
                 "this one's `total_low_ms`"),
     .may_differ = true, .title = "front", .left = true},
    BENCH_STAMP_FIELDS(BenchPoint, "that the point took"),
    {FIELD(INT, samples), MEANS(NULL, "repeats; 0 of an invalid point")},
    {.name = "sample",
     PLACE(DOUBLE, sample),
     MEANS("s", "a step, of every repeat"),
     .series = true},
};

const int bench_point_field_count = sizeof bench_point_fields / sizeof bench_point_fields[0];

BenchPoint bench_point_none(void)
{
    BenchPoint point;
    bench_record_none(bench_point_fields, bench_point_field_count, &point, sizeof point);
    return point;
}

/* ---- the front */

bool bench_point_judged(const BenchPoint *p)
{
    return p->valid && isfinite(p->total_ms) && isfinite(p->path_rms) && p->frequency > 0;
}

/* Quartiles that are not known overlap with all. */
static bool beats(const BenchPoint *a, const BenchPoint *b)
{
    return a->total_high_ms < b->total_low_ms && a->path_rms <= b->path_rms &&
           fabs(log(a->frequency / b->frequency)) <= log(BENCH_ALIKE);
}

void bench_front_mark(BenchPoint *point, long count)
{
    for (long i = 0; i < count; i++) {
        point[i].front = bench_point_judged(&point[i]);
        for (long j = 0; j < count && point[i].front; j++)
            point[i].front = !(bench_point_judged(&point[j]) && beats(&point[j], &point[i]));
    }
}
