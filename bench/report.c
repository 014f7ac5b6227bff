#include "report.h"

#include <math.h>
#include <string.h>

#include "../reference/paper.h"
#include "change_grid.h"
#include "elastic_row.h"
#include "tree_row.h"

enum { FIELDS = 16, FIELD_TEXT = BENCH_GRID_TEXT };
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
    VERDICT
};

static const char *const headings[FIELDS] = {
    "scene",    "particles", "regions",     "w",        "fast sum",         "shape matching",
    "polar",    "damping",   "other",       "total ms", "ns/particle/step", "faster",
    "frames/s", "speed-up",  "sums/region", "check",
};

typedef struct {
    char field[FIELDS][FIELD_TEXT];
} Line;

static bool of_octree(const BenchRow *row)
{
    return !strcmp(row->paper, "octree") || !strcmp(row->engine, "octree");
}

static bool of_elastic(const BenchRow *row)
{
    return row->elastic.nodes > 0;
}

/* Which fields the table has. */
static void choose_fields(const BenchRow *rows, int count, bool shown[FIELDS])
{
    bool octree = false;
    for (int r = 0; r < count; r++) octree |= of_octree(&rows[r]);
    for (int f = 0; f < FIELDS; f++) shown[f] = octree || f < RATE || f > SUMS;
}

static void stage_text(double ms, double percent, char text[FIELD_TEXT])
{
    char number[FIELD_TEXT];
    bench_grid_number(ms, number);
    if (isfinite(percent))
        snprintf(text, FIELD_TEXT, "%.40s (%2.0f%%)", number, percent);
    else
        snprintf(text, FIELD_TEXT, "%.40s", number);
}

static void measured_line(const BenchRow *row, Line *line)
{
    memset(line, 0, sizeof *line);
    snprintf(line->field[SCENE], FIELD_TEXT, "%s", row->scene);
    snprintf(line->field[PARTICLES], FIELD_TEXT, "%ld", row->particles);
    snprintf(line->field[REGIONS], FIELD_TEXT, "%ld", row->regions);
    snprintf(line->field[W], FIELD_TEXT, row->w ? "%d" : "-", row->w);
    bench_grid_number(of_octree(row) ? row->summation_nodes : NAN, line->field[SUMS]);
    strcpy(line->field[VERDICT], row->valid ? "VALID" : "INVALID");
    for (int f = STAGES; f < SUMS && !row->valid; f++) strcpy(line->field[f], "INVALID");
    if (!row->valid) return;
    for (int s = 0; s < SM_STAGES; s++)
        stage_text(row->stage_ms[s], 100 * row->stage_ms[s] / row->total_ms,
                   line->field[STAGES + s]);
    if (!(row->damping > 0)) strcpy(line->field[STAGES + SM_DAMPING], "-");
    bench_grid_number(row->total_ms, line->field[TOTAL]);
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
static bool paper_line(const BenchRow *row, Line *line)
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
                   line->field[STAGES + s]);
        mark(paper->stage_ms[s].status, line->field[STAGES + s]);
    }
    bench_grid_number(paper->total_ms.value, line->field[TOTAL]);
    bench_grid_number(1e6 * paper->total_ms.value / paper->particles.value, line->field[PER_STEP]);
    bench_grid_number(paper->fps.value, line->field[RATE]);
    bench_grid_number(paper->speedup.value, line->field[SPEEDUP]);
    bench_grid_number(paper->summation_nodes.value, line->field[SUMS]);
    static const int timed[] = {TOTAL, PER_STEP, RATE};
    for (int t = 0; t < 3; t++)
        if (strcmp(line->field[timed[t]], "-") != 0)
            mark(ref_paper_step_status(paper), line->field[timed[t]]);
    return true;
}

/* How far the counts are from the paper's. */
static bool difference_line(const BenchRow *row, Line *line)
{
    const RefPaperRow *paper = row->paper[0] ? ref_paper_find(row->paper, row->paper_row) : NULL;
    memset(line, 0, sizeof *line);
    if (!paper) return false;
    strcpy(line->field[SCENE], "  difference");
    double particles = 100 * ((double)row->particles / paper->particles.value - 1);
    double regions = 100 * ((double)row->regions / paper->regions.value - 1);
    if (isfinite(particles)) snprintf(line->field[PARTICLES], FIELD_TEXT, "%+.1f%%", particles);
    if (isfinite(regions)) snprintf(line->field[REGIONS], FIELD_TEXT, "%+.1f%%", regions);
    return true;
}

static void print_check(FILE *file, const BenchRow *row)
{
    fprintf(file, "  %s, %s in %s precision: %s: ", row->scene, row->engine, row->precision,
            row->valid ? "VALID" : "INVALID");
    if (!row->valid) {
        fprintf(file, "%s\n", row->reason);
        return;
    }
    fprintf(file,
            "%s;\n    quartiles %.4g to %.4g ms, %d repeats of %d steps; stage clocks cost %.1f%%, "
            "which the total is without (below 0: noise);\n",
            row->found, row->total_low_ms, row->total_high_ms, row->repeats, row->steps,
            row->instruments_percent);
    if (!of_elastic(row))
        fprintf(file, "    voxelised in %.3g ms, built in %.3g ms, %.4g bytes a particle\n",
                1e3 * row->voxelise_seconds, 1e3 * row->build_seconds,
                (double)row->bytes / (double)row->particles);
}

/* The step's time as the octree paper groups it. */
static void print_groups(FILE *file, const BenchRow *row)
{
    const RefPaperClaim *third = ref_paper_claim("octree", "hand-third");
    double percent = 100 / row->total_ms;
    fprintf(file,
            "    summation and matching %.0f%%, polar %.0f%%, damping %.0f%%, other %.0f%% (paper, "
            "regular sampling: %.0f/%.0f/%.0f)\n",
            percent * (row->stage_ms[SM_FAST_SUM] + row->stage_ms[SM_SHAPE_MATCHING]),
            percent * row->stage_ms[SM_POLAR], percent * row->stage_ms[SM_DAMPING],
            percent * row->stage_ms[SM_OTHER], third->value.value, third->value.value,
            third->value.value);
}

/* What an octree's row is made of. */
static void print_octree(FILE *file, const BenchRow *row)
{
    const RefPaperRow *paper = row->paper[0] ? ref_paper_find(row->paper, row->paper_row) : NULL;
    fputs("    ", file);
    bench_tree_row_nodes(file, row);
    if (paper && isfinite(paper->bases.value))
        fprintf(file, "; paper: %.0f from %.0f", paper->particles.value, paper->bases.value);
    fputs(";\n    ", file);
    bench_tree_row_widths(file, row);
    fputs(";\n    ", file);
    bench_tree_row_regions(file, row);
    fputs(";\n    the body ", file);
    bench_tree_row_body(file, row);
    fputc('\n', file);
    if (row->valid) print_groups(file, row);
}

/* The adaptive octree's speed-ups beside the paper's 88, which is over a lattice without low-level
 * optimisation: over that of ours, too. */
static void print_speedups(FILE *file, const BenchRow *rows, int count)
{
    const BenchRow *sampled = NULL;
    for (int r = 0; r < count; r++)
        if (!strcmp(rows[r].paper_row, "hand-sampled") && rows[r].valid) sampled = &rows[r];
    const RefPaperClaim *claim = ref_paper_claim("octree", "hand-speedup");
    for (int r = 0; r < count && sampled; r++)
        if (!strcmp(rows[r].engine, "fastlsm") && of_octree(&rows[r]) && rows[r].valid)
            fprintf(file, "  %s is %.3g times as fast as %s%s\n", sampled->scene,
                    rows[r].total_ms / sampled->total_ms, rows[r].scene,
                    strcmp(rows[r].paper_row, "hand-lattice-plain") ? "" : " (paper: 88 times)");
    if (sampled)
        fprintf(file, "  paper, %s: %s; %s\n", claim->place, claim->note,
                ref_paper_claim("octree", "hand-third")->note);
}

static void print_notes(FILE *file, const BenchRow *rows, int count)
{
    for (int r = 0; r < count; r++) {
        const RefPaperRow *paper =
            rows[r].paper[0] ? ref_paper_find(rows[r].paper, rows[r].paper_row) : NULL;
        if (paper && paper->note[0]) fprintf(file, "  %s, paper: %s\n", rows[r].scene, paper->note);
    }
}

static void add_line(BenchGrid *grid, const Line *line, const bool shown[FIELDS])
{
    BenchGridLine *to = bench_grid_add(grid);
    for (int f = 0, column = 0; f < FIELDS; f++)
        if (shown[f]) strcpy((*to)[column++], line->field[f]);
}

/* The rows of shape matching, each with the paper's below, and, if wanted, with how far its counts
 * are off. */
static BenchGrid make_grid(const BenchRow *rows, int count, bool differences)
{
    BenchGrid grid = {0};
    bool shown[FIELDS];
    choose_fields(rows, count, shown);
    for (int f = 0; f < FIELDS; f++)
        if (shown[f]) bench_grid_column(&grid, headings[f], f == SCENE || f == VERDICT);
    for (int r = 0; r < count; r++) {
        if (of_elastic(&rows[r])) continue;
        Line line;
        measured_line(&rows[r], &line);
        add_line(&grid, &line, shown);
        if (paper_line(&rows[r], &line)) add_line(&grid, &line, shown);
        if (differences && difference_line(&rows[r], &line)) add_line(&grid, &line, shown);
    }
    return grid;
}

/* The tables, in order; one without lines is not there. */
enum { STEPS, CHANGES, FRAMES, GRIDS };

static void make_grids(const BenchRow *rows, int count, bool differences, BenchGrid grid[GRIDS])
{
    grid[STEPS] = make_grid(rows, count, differences);
    bench_change_grid(rows, count, &grid[CHANGES]);
    bench_elastic_grid(rows, count, differences, &grid[FRAMES]);
}

/* What stands above a table as text. */
static void print_heading(FILE *file, int table, const BenchMachine *machine)
{
    if (table == STEPS)
        fprintf(file, "Times of one step, median, on %s, %d thread%s.\n\n", machine->cpu,
                machine->threads, machine->threads == 1 ? "" : "s");
    else if (table == FRAMES)
        fprintf(
            file,
            "Meshless bodies: times of one frame, median, on %s, one thread: the modes' motion, "
            "and the points that it carries.\n\n",
            machine->cpu);
    else
        fputs("While they change: nodes at first and at most; simulation is the time of a frame "
              "before the first change and after the last.\n\n",
              file);
}

void bench_report_text(FILE *file, const BenchRow *rows, int count, const BenchMachine *machine)
{
    BenchGrid grid[GRIDS];
    make_grids(rows, count, true, grid);
    for (int g = 0; g < GRIDS; g++) {
        if (grid[g].lines) {
            print_heading(file, g, machine);
            bench_grid_text(file, &grid[g]);
            fputc('\n', file);
        }
        bench_grid_free(&grid[g]);
    }
    for (int r = 0; r < count; r++) {
        print_check(file, &rows[r]);
        bench_change_left(file, "    ", rows[r].change.left);
        if (!strcmp(rows[r].engine, "octree")) print_octree(file, &rows[r]);
        if (of_elastic(&rows[r])) bench_elastic_row_text(file, &rows[r]);
    }
    print_speedups(file, rows, count);
    print_notes(file, rows, count);
}

static void write_grids(FILE *file, const BenchRow *rows, int count,
                        void (*write)(FILE *, const BenchGrid *))
{
    BenchGrid grid[GRIDS];
    const char *between = "";
    make_grids(rows, count, false, grid);
    for (int g = 0; g < GRIDS; g++) {
        if (grid[g].lines) {
            fputs(between, file);
            write(file, &grid[g]);
            between = "\n";
        }
        bench_grid_free(&grid[g]);
    }
}

void bench_report_markdown(FILE *file, const BenchRow *rows, int count)
{
    write_grids(file, rows, count, bench_grid_markdown);
}

void bench_report_latex(FILE *file, const BenchRow *rows, int count)
{
    write_grids(file, rows, count, bench_grid_latex);
}
