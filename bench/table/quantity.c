#include "quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "records.h"

/* ---- what is not a plain member */

static bool changes(const void *record)
{
    return ((const BenchRow *)record)->change.frames > 0;
}

static bool meshless(const void *record)
{
    return ((const BenchRow *)record)->elastic.nodes > 0;
}

static bool timed(const void *record)
{
    return bench_row_timed(record);
}

static double ratio(const void *record)
{
    const BenchRow *row = record;
    return row->paper_total_ms / row->total_ms;
}

static const char *verdict(const void *record)
{
    return bench_row_mark(record);
}

/* ---- cells of tables for people */

static void w_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    snprintf(text, BENCH_GRID_TEXT, row->w ? "%d" : "-", row->w);
}

static void verdict_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    strcpy(text, bench_row_mark(row));
}

static void faster_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    if (!isfinite(row->paper_total_ms)) return;
    bench_grid_number(ratio(row), text);
    strcat(text, "x");
}

static void quartiles_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    bench_grid_range(row->total_low_ms, row->total_high_ms, text);
}

/* A part of the total: as text only its percent. */
static void part_text(double ms, double percent, BenchGridForm form, char *text)
{
    char number[BENCH_GRID_TEXT];
    bench_grid_number(ms, number);
    if (form == BENCH_GRID_PLAIN && isfinite(percent))
        snprintf(text, BENCH_GRID_TEXT, "%.0f%%", percent);
    else if (isfinite(percent))
        snprintf(text, BENCH_GRID_TEXT, "%.40s (%2.0f%%)", number, percent);
    else
        snprintf(text, BENCH_GRID_TEXT, "%.40s", number);
}

#define STAGE_CELL(name, stage)                                                                    \
    static void name(const BenchRow *row, BenchGridForm form, char *text)                          \
    {                                                                                              \
        part_text(row->stage_ms[stage], 100 * row->stage_ms[stage] / row->total_ms, form, text);   \
    }
STAGE_CELL(sum_cell, SM_FAST_SUM)
STAGE_CELL(match_cell, SM_SHAPE_MATCHING)
STAGE_CELL(polar_cell, SM_POLAR)
STAGE_CELL(other_cell, SM_OTHER)

static void damping_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    double ms = row->stage_ms[SM_DAMPING];
    if (row->damping > 0)
        part_text(ms, 100 * ms / row->total_ms, form, text);
    else
        strcpy(text, "-");
}

/* "a -> b", or the one that there is, or "-"; `mark` behind each. */
static void pair_text(double from, double to, const char *joint, const char *mark, char *text)
{
    char a[BENCH_GRID_TEXT], b[BENCH_GRID_TEXT];
    bench_grid_number(from, a);
    bench_grid_number(to, b);
    if (isfinite(from) && isfinite(to))
        snprintf(text, BENCH_GRID_TEXT, "%.20s%s%s%.20s%s", a, mark, joint, b, mark);
    else
        snprintf(text, BENCH_GRID_TEXT, "%.20s%s", isfinite(from) ? a : b,
                 isfinite(from) || isfinite(to) ? mark : "");
}

static void counts_text(double from, double to, char *text)
{
    if (isfinite(from) && isfinite(to))
        snprintf(text, BENCH_GRID_TEXT, "%.0f -> %.0f", from, to);
    else
        strcpy(text, "-");
}

static void nodes_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    counts_text((double)row->change.first_nodes, (double)row->change.most_nodes, text);
}

static void simulation_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    pair_text(row->change.first_ms, row->change.last_ms, " -> ", "", text);
}

static void resampling_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    pair_text(row->change.change_ms, row->change.change_most_ms, " to ", "", text);
}

static void triangles_cell(const BenchRow *row, BenchGridForm form, char *text)
{
    (void)form;
    counts_text((double)row->change.first_triangles, (double)row->change.last_triangles, text);
}

/* ---- the paper's cells below: "?" behind a damaged or misprinted value, "*" behind a second-hand
 * one */

#define BELOW(name)                                                                                \
    static void name(const RefPaperRow *paper, const RefValue *value, BenchGridForm form,          \
                     char *text)

static const char *status_mark(RefStatus status)
{
    return status == REF_DAMAGED ? "?" : status == REF_SECOND_HAND ? "*" : "";
}

BELOW(name_below)
{
    (void)paper, (void)value, (void)form;
    strcpy(text, "  paper");
}

BELOW(dash_below)
{
    (void)paper, (void)value, (void)form;
    strcpy(text, "-");
}

BELOW(count_below)
{
    (void)paper, (void)form;
    if (isfinite(value->value)) snprintf(text, BENCH_GRID_TEXT, "%.0f", value->value);
}

BELOW(bound_below)
{
    (void)paper, (void)form;
    snprintf(text, BENCH_GRID_TEXT, "< %.0f", value->value);
}

BELOW(number_below)
{
    (void)paper, (void)form;
    bench_grid_number(value->value, text);
}

BELOW(marked_below)
{
    (void)paper, (void)form;
    bench_grid_number(value->value, text);
    if (isfinite(value->value)) strcat(text, status_mark(value->status));
}

/* Times of a step, and the rate, are as sound as each other. */
static void step_text(const RefPaperRow *paper, double value, char *text)
{
    bench_grid_number(value, text);
    if (isfinite(value)) strcat(text, status_mark(ref_paper_step_status(paper)));
}

BELOW(step_below)
{
    (void)form;
    step_text(paper, value->value, text);
}

BELOW(particle_below)
{
    (void)form;
    step_text(paper, 1e6 * value->value / paper->particles.value, text);
}

BELOW(stage_below)
{
    part_text(value->value, paper->stage_percent[value - paper->stage_ms].value, form, text);
    strcat(text, status_mark(value->status));
}

BELOW(nodes_below)
{
    (void)form;
    counts_text(value->value, paper->last_particles.value, text);
}

BELOW(simulation_below)
{
    (void)form;
    bool second_hand = ref_paper_step_status(paper) == REF_SECOND_HAND;
    pair_text(value->value, paper->last_ms.value, " -> ", second_hand ? "*" : "", text);
}

BELOW(resampling_below)
{
    (void)form;
    pair_text(value->value, paper->change_most_ms.value, " to ", "", text);
}

/* ---- the list */

enum { TEXT = 1 << BENCH_GRID_PLAIN, LATEX = 1 << BENCH_GRID_LATEX };
enum { PAGE = 1 << BENCH_GRID_MARKDOWN | LATEX, EVERY = TEXT | PAGE };

#define LATTICES   .shown[BENCH_TABLE_LATTICES]
#define STEPS      .shown[BENCH_TABLE_STEPS]
#define FRAMES     .shown[BENCH_TABLE_FRAMES]
#define CHANGES    .shown[BENCH_TABLE_CHANGES]
#define BOTH_STEPS LATTICES = EVERY, STEPS = EVERY

#define PLACE(type, member)                                                                        \
    .field.kind = BENCH_##type, .field.offset = offsetof(BenchRow, member),                        \
    .field.size = sizeof(((BenchRow *)0)->member)
#define STORED(type, member) .field.name = #member, PLACE(type, member)
#define CHANGE(type, member) .of = "change", .field.given = changes, STORED(type, change.member)
#define ELASTIC(type, member)                                                                      \
    .of = "meshless", .elastic = true, .field.given = meshless, .field.name = #member,             \
    PLACE(type, elastic.member)
#define OCTREE(type, member) .of = "octree", STORED(type, member)
#define COLUMN(title)        .field.column = title
#define TIME(title)          .field.column = title, .field.timed = timed
#define STAGE(stage, title)  PLACE(DOUBLE, stage_ms[stage]), TIME(title)
#define MEANS(unit_, words)  .field.unit = unit_, .field.meaning = words
#define PAPER(member, how)   .paper = offsetof(RefPaperRow, member), .below = how

const BenchQuantity bench_quantities[] = {
    {STORED(TEXT, paper), COLUMN("paper"),
     MEANS(NULL, "the paper whose row is set beside it; empty: none")},
    {STORED(TEXT, paper_row), MEANS(NULL, "that row")},
    {STORED(TEXT, scene), COLUMN("scene"), MEANS(NULL, "what was measured"), .title = "scene",
     BOTH_STEPS, FRAMES = EVERY, CHANGES = EVERY, .left = true, .below = name_below},
    {STORED(TEXT, engine), COLUMN("engine"), MEANS(NULL, "fastlsm, octree or meshless")},
    {STORED(TEXT, precision), MEANS(NULL, "single or double")},
    {STORED(TEXT, polar), MEANS(NULL, "how rotations are found: fast, or jacobi (without low-level "
                                      "optimisation)")},
    {STORED(TEXT, summation), MEANS(NULL, "how sums are found: fast, bars or naive")},
    {STORED(LONG, triangles), MEANS(NULL, "of the mesh")},
    {STORED(LONG, particles), COLUMN("particles"),
     MEANS(NULL, "of all instances; of a meshless body points on its surface"),
     .title = "particles", BOTH_STEPS, PAPER(particles, count_below)},
    {PLACE(LONG, particles), .title = "points", FRAMES = EVERY, PAPER(particles, count_below)},
    {PLACE(LONG, elastic.nodes), .title = "nodes", FRAMES = EVERY, PAPER(nodes, count_below)},
    {PLACE(LONG, elastic.modes), .title = "modes", FRAMES = EVERY, PAPER(modes, count_below)},
    {PLACE(DOUBLE, elastic.matrix_seconds), .field.timed = timed, .title = "matrices s",
     FRAMES = EVERY, .dash = true, PAPER(matrix_s, bound_below)},
    {PLACE(DOUBLE, elastic.mode_seconds), .field.timed = timed, .title = "modes s", FRAMES = EVERY,
     .dash = true, PAPER(mode_s, bound_below)},
    {STORED(LONG, regions), COLUMN("regions"),
     MEANS(NULL, "unique ones of one instance; of a meshless body nodes"), .title = "regions",
     LATTICES = EVERY, STEPS = PAGE, PAPER(regions, count_below)},
    {STORED(LONG, instances), MEANS(NULL, "bodies")},
    {STORED(INT, w), COLUMN("w"),
     MEANS("cells", "half-width of regions; 0 of an octree, see `width_cells`, and of meshless "
                    "bodies"),
     .title = "w", LATTICES = EVERY, STEPS = PAGE, .cell = w_cell, PAPER(w, count_below)},
    {STORED(DOUBLE, epsilon), COLUMN("epsilon"), MEANS(NULL, "an octree's; 0 of others")},
    {STORED(DOUBLE, h), MEANS("s", "time step")},
    {STORED(DOUBLE, cell), MEANS("mesh units", "edge of a cell")},
    {STORED(DOUBLE, damping), MEANS(NULL, "the parameter k")},
    {STAGE(SM_FAST_SUM, "fast_sum_ms"), MEANS("ms", "the stages of `stage_ms`, one by one"),
     .title = "fast sum", .terse = "sum", BOTH_STEPS, .dash = true, .cell = sum_cell,
     PAPER(stage_ms[SM_FAST_SUM], stage_below)},
    {STAGE(SM_SHAPE_MATCHING, "shape_matching_ms"),
     MEANS("ms", "of a meshless body the motion of its modes"), .title = "shape matching",
     .terse = "match", BOTH_STEPS, .dash = true, .cell = match_cell,
     PAPER(stage_ms[SM_SHAPE_MATCHING], stage_below)},
    {STAGE(SM_POLAR, "polar_ms"), MEANS("ms", "rotations"), .title = "polar", BOTH_STEPS,
     .dash = true, .cell = polar_cell, PAPER(stage_ms[SM_POLAR], stage_below)},
    {STAGE(SM_DAMPING, "damping_ms"), MEANS("ms", "damping"), .title = "damping", .terse = "damp",
     BOTH_STEPS, .dash = true, .cell = damping_cell, PAPER(stage_ms[SM_DAMPING], stage_below)},
    {STAGE(SM_OTHER, "other_ms"), MEANS("ms", "of a meshless body the points that its modes carry"),
     .title = "other", BOTH_STEPS, .dash = true, .cell = other_cell,
     PAPER(stage_ms[SM_OTHER], stage_below)},
    {PLACE(DOUBLE, stage_ms[SM_SHAPE_MATCHING]), .field.timed = timed, .title = "motion ms",
     .terse = "motion", FRAMES = EVERY, .dash = true, .cell = match_cell, .below = dash_below},
    {PLACE(DOUBLE, stage_ms[SM_OTHER]), .field.timed = timed, .title = "skin ms", .terse = "skin",
     FRAMES = EVERY, .dash = true, .cell = other_cell, .below = dash_below},
    {STORED(DOUBLE, stage_ms),
     MEANS("ms", "of each stage: its share of the instrumented run times `total_ms`")},
    {STORED(DOUBLE, total_ms), TIME("total_ms"),
     MEANS("ms", "median of a step, or of a meshless body's frame"), .title = "total ms",
     BOTH_STEPS, PAPER(total_ms, step_below)},
    {PLACE(DOUBLE, total_ms), .field.timed = timed, .title = "frame ms", FRAMES = EVERY,
     PAPER(total_ms, number_below)},
    {STORED(DOUBLE, ns_per_particle_step), TIME("ns_per_particle_step"),
     MEANS("ns", "the median a particle"), .title = "ns/particle/step", LATTICES = PAGE,
     STEPS = PAGE, PAPER(total_ms, particle_below)},
    {STORED(DOUBLE, paper_total_ms), COLUMN("paper_total_ms"),
     MEANS("ms", "the paper's; NaN where it gives none")},
    {STORED(DOUBLE, paper_stage_ms), MEANS("ms", "the paper's stages; NaN where it gives none")},
    {.field.kind = BENCH_DOUBLE,
     .field.number = ratio,
     TIME("ratio"),
     MEANS(NULL, "how many times as fast as the paper: `paper_total_ms` / `total_ms`"),
     .title = "faster",
     BOTH_STEPS,
     FRAMES = EVERY,
     .cell = faster_cell},
    {STORED(BOOL, valid), COLUMN("valid"), .field.text = verdict,
     MEANS(NULL, "whether the check on this very scene passed; in csv VALID, INVALID or BUSY"),
     .title = "check", FRAMES = EVERY, .left = true, .cell = verdict_cell},
    {STORED(TEXT, reason), MEANS(NULL, "why it did not")},
    {STORED(TEXT, found), MEANS(NULL, "what the check found: goals, momentum, damping, contacts, "
                                      "obstacles, and particles that were left out and why")},
    {STORED(DOUBLE, fps), TIME("fps"), MEANS("1/s", "steps a second"), .title = "frames/s",
     STEPS = PAGE, PAPER(fps, step_below)},
    {STORED(DOUBLE, speedup), TIME("speedup"),
     MEANS(NULL, "how many times as fast as the table's first lattice row of the same paper, mesh "
                 "and `polar` whose sums are not naive; NaN where there is none"),
     .title = "speed-up", .terse = "speedup", STEPS = EVERY, PAPER(speedup, marked_below)},
    {OCTREE(DOUBLE, summation_nodes), COLUMN("summation_nodes"),
     MEANS(NULL, "of a region, mean; NaN of others"), .title = "sums/region", STEPS = PAGE,
     PAPER(summation_nodes, number_below)},
    {OCTREE(LONG, most_summation), MEANS(NULL, "of a region, most; 0 of others, like all below")},
    {OCTREE(DOUBLE, width_cells),
     MEANS("finest cells", "a region's w is this and `width_edges` times its node's edge; NaN of "
                           "others, like the next")},
    {OCTREE(DOUBLE, width_edges), MEANS(NULL, "edges of the node's own cell")},
    {OCTREE(DOUBLE, wanted_summation),
     MEANS(NULL, "w was searched for this mean of summation nodes; 0: given")},
    {OCTREE(LONG, bases), MEANS(NULL, "base cells")},
    {OCTREE(LONG, cells), MEANS(NULL, "finest cells of material")},
    {OCTREE(LONG, parts), MEANS(NULL, "groups of nodes that no region holds together")},
    {OCTREE(DOUBLE, reached),
     MEANS("finest cells", "width that regions have, the largest distance of a leaf in one: mean; "
                           "NaN of others, like the next")},
    {OCTREE(DOUBLE, most_reached), MEANS("finest cells", "the same: most")},
    {OCTREE(LONG, wanted_nodes), MEANS(NULL, "as the scene asks for; 0: it does not")},
    {OCTREE(LONG, wanted_bases), MEANS(NULL, "base cells as the scene asks for; 0: it does not")},
    {OCTREE(LONG, local_nodes), MEANS(NULL, "nodes of a body whose place has a width of its own")},
    {OCTREE(LONG, welded_cells),
     MEANS(NULL, "nodes above the finest that hold material in several pieces")},
    {OCTREE(LONG, welded_pairs),
     MEANS(NULL, "pairs of touching ones whose material does not touch there")},
    {OCTREE(LONG, splits), MEANS(NULL, "cells that were split")},
    {OCTREE(LONG, balance_splits), MEANS(NULL, "for 2:1 balance alone")},
    {OCTREE(LONG, unasked_splits),
     MEANS(NULL, "for the wanted number of nodes alone, which no criterion asks for")},
    {OCTREE(BOOL, plain),
     MEANS(NULL, "1: the paper's plain weighting, which does not keep momentum")},
    {OCTREE(INT, masses), MEANS(NULL, "of nodes, 0: by material, 1: by volume")},
    {OCTREE(INT, symmetry), MEANS(NULL, "of regions, 0: union, 1: intersection, 2: none")},
    {CHANGE(LONG, frames),
     MEANS(NULL, "of a scene that is cut, touched or looked at: frames played; 0 of others, like "
                 "all of it")},
    {CHANGE(LONG, changed), MEANS(NULL, "frames with a change")},
    {CHANGE(LONG, first_nodes), MEANS(NULL, "of all bodies, at first"), .title = "nodes",
     CHANGES = EVERY, .cell = nodes_cell, PAPER(particles, nodes_below)},
    {CHANGE(LONG, most_nodes), MEANS(NULL, "at most")},
    {CHANGE(LONG, last_nodes), COLUMN("last_particles"), MEANS(NULL, "in the end")},
    {CHANGE(LONG, most_added), MEANS(NULL, "nodes added in a frame, at most"),
     .title = "added at once", CHANGES = EVERY, PAPER(added, number_below)},
    {CHANGE(DOUBLE, first_ms), TIME("frame_ms"),
     MEANS("ms", "simulation of a frame, collisions included: median before the first change"),
     .title = "simulation ms", CHANGES = EVERY, .cell = simulation_cell,
     PAPER(total_ms, simulation_below)},
    {CHANGE(DOUBLE, last_ms), TIME("last_frame_ms"), MEANS("ms", "after the last change")},
    {CHANGE(DOUBLE, change_ms), TIME("resampling_ms"),
     MEANS("ms", "resampling in a frame with a change: median"), .title = "resampling ms",
     CHANGES = EVERY, .cell = resampling_cell, PAPER(change_ms, resampling_below)},
    {CHANGE(DOUBLE, change_most_ms), TIME("most_resampling_ms"), MEANS("ms", "the same: most")},
    {CHANGE(DOUBLE, follow_ms), TIME("splitting_ms"),
     MEANS("ms", "splitting and tying surfaces in such a frame: median"), .title = "splitting ms",
     CHANGES = EVERY},
    {CHANGE(DOUBLE, surface_ms), TIME("surface_ms"),
     MEANS("ms", "moving one body's surface: median"), .title = "surface ms", CHANGES = EVERY,
     PAPER(surface_ms, number_below)},
    {CHANGE(LONG, first_triangles), MEANS(NULL, "of all surfaces, at first"), .title = "triangles",
     CHANGES = PAGE, .cell = triangles_cell},
    {CHANGE(LONG, last_triangles), MEANS(NULL, "of all surfaces, in the end")},
    {CHANGE(LONG, pieces), MEANS(NULL, "of all surfaces, in the end"), .title = "pieces",
     CHANGES = PAGE},
    {CHANGE(LONG, open_edges), MEANS(NULL, "of all surfaces, in the end")},
    {CHANGE(LONG, left), MEANS(NULL, "bodies whose surface could not follow a cut everywhere")},
    {ELASTIC(LONG, nodes), COLUMN("nodes"), MEANS(NULL, "simulation nodes")},
    {ELASTIC(LONG, modes), COLUMN("modes"), MEANS(NULL, "natural modes")},
    {ELASTIC(DOUBLE, field_seconds), MEANS("s", "set-up: implicit surface")},
    {ELASTIC(DOUBLE, matrix_seconds), TIME("matrices_s"),
     MEANS("s", "set-up: octants, nodes and matrices, with the search for the wanted number of "
                "nodes")},
    {ELASTIC(DOUBLE, mode_seconds), TIME("modes_s"), MEANS("s", "set-up: modes")},
    {ELASTIC(DOUBLE, skin_seconds), MEANS("s", "set-up: the points' shape functions")},
    {ELASTIC(DOUBLE, found),
     MEANS(NULL, "how far off each thing that is checked is, in the order of "
                 "`bench/check/elastic_found.h`; `found` of the row says the same in words")},
    {STORED(DOUBLE, total_low_ms), TIME("total_low_ms"), MEANS("ms", "lower quartile of a step"),
     .title = "quartiles ms", LATTICES = LATEX, STEPS = LATEX, FRAMES = LATEX,
     .cell = quartiles_cell},
    {STORED(DOUBLE, total_high_ms), TIME("total_high_ms"), MEANS("ms", "upper quartile")},
    {STORED(INT, repeats), MEANS(NULL, "samples of every time"), .title = "samples",
     LATTICES = LATEX, STEPS = LATEX, FRAMES = LATEX},
    {STORED(INT, steps), COLUMN("steps"), MEANS(NULL, "steps in each repeat")},
    {STORED(INT, threads), MEANS(NULL, "threads used")},
    {STORED(BOOL, busy), COLUMN("busy"),
     MEANS(NULL, "1: other programs left too little of the processors, and all times but the "
                 "samples are NaN")},
    {STORED(DOUBLE, lost_percent), COLUMN("lost_percent"),
     MEANS("%", "of the time that other programs took, which the samples are without "
                "(`bench/measure/moment.h`)")},
    {STORED(DOUBLE, load), COLUMN("load"), MEANS(NULL, "load average")},
    {STORED(DOUBLE, goal_error),
     MEANS("cells", "largest deviation of goals from brute force; NaN of meshless bodies")},
    {STORED(DOUBLE, goal_tolerance), MEANS("cells", "what is allowed of it")},
    {STORED(DOUBLE, momentum_error),
     MEANS(NULL, "change of linear momentum, relative; measured with plain weighting too, where "
                 "it makes no row invalid; NaN of meshless bodies")},
    {STORED(DOUBLE, drift),
     MEANS("cells a step", "change of the velocity of the body's centre in each step, left alone "
                           "for `drift_steps` (`bench/measure/drift.h`); 0 of meshless bodies and "
                           "of what was stored before, like the next two")},
    {STORED(DOUBLE, twist), MEANS("radians a step", "the same of its angular momentum over its "
                                                    "moment of inertia")},
    {STORED(LONG, drift_steps), MEANS(NULL, "how many steps it was left alone")},
    {STORED(LONG, left_out),
     MEANS(NULL, "particles left out of a check: rotation or inertia not resolved")},
    {STORED(DOUBLE, instruments_percent), MEANS("%", "what the instruments cost")},
    {STORED(DOUBLE, voxelise_seconds), MEANS("s", "set-up")},
    {STORED(DOUBLE, build_seconds), MEANS("s", "set-up")},
    {STORED(LONG, bytes), MEANS("bytes", "memory held")},
    {STORED(HASH, input_hash), MEANS(NULL, "FNV-1a of the mesh's coordinates and indices")},
    {.samples = true,
     TIME("samples_ms"),
     MEANS("ms", "every sample; in files the dataset `total`, in seconds")},
    {CHANGE(DOUBLE, surface_bytes), COLUMN("surface_bytes"),
     MEANS("bytes a particle", "what ties the surfaces to the bodies' particles, in the end"),
     .title = "surface bytes/particle", CHANGES = PAGE},
    {.title = "check", BOTH_STEPS, CHANGES = PAGE, .left = true, .cell = verdict_cell},
};

const int bench_quantity_count = sizeof bench_quantities / sizeof bench_quantities[0];

/* ---- documentation */

void bench_quantities_document(FILE *file)
{
    fputs("| attribute | type | in csv, json | of | unit | meaning |\n"
          "| --- | --- | --- | --- | --- | --- |\n",
          file);
    for (int q = 0; q < bench_quantity_count; q++) {
        const BenchField *field = &bench_quantities[q].field;
        const char *group = bench_quantities[q].elastic ? "elastic/" : "";
        char type[32];
        bench_field_type(field, sizeof type, type);
        if (!field->name && !field->column) continue;
        if (field->name) fprintf(file, "| `%s%s` | %s", group, field->name, type);
        if (!field->name) fputs("| | ", file);
        fprintf(file, field->column ? " | `%s` |" : " |%s |", field->column ? field->column : "");
        const char *of = bench_quantities[q].of, *unit = field->unit;
        fprintf(file, " %s | %s | %s |\n", of ? of : "", unit ? unit : "", field->meaning);
    }
}
