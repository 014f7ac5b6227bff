#include "explain.h"

#include <math.h>
#include <string.h>

#include "../../reference/paper.h"
#include "../engines.h"
#include "../measure/elastic_checker.h"
#include "../measure/measure.h"
#include "grid.h"

void bench_change_left(FILE *file, const char *before, long left)
{
    if (left)
        fprintf(file, "%sthe surface of %ld bod%s could not follow a cut everywhere\n", before,
                left, left == 1 ? "y" : "ies");
}

/* ---- one line a row */

/* Prints processor time lost to other programs and the container's quota, from 5%. */
static void print_lost(FILE *file, const BenchRow *row, const char *before)
{
    if (row->busy)
        fprintf(file, "%sBUSY: %s: measure again on free processors", before, row->reason);
    else if (row->reason[0])
        fprintf(file, "%s%s, which is not counted", before, row->reason);
}

/* At how many things was looked: those that `found` names. */
static int checks_made(const BenchRow *row)
{
    int count = row->found[0] != '\0';
    for (const char *at = row->found; *at; at++) count += *at == ',';
    return count;
}

static void brief_row(FILE *file, const BenchRow *row, int width)
{
    char range[BENCH_GRID_TEXT];
    fprintf(file, "  %-*s  ", width, row->scene);
    if (!row->valid) {
        fprintf(file, "INVALID: %s\n", row->reason);
        return;
    }
    bool elastic = bench_row_of_elastic(row);
    if (elastic ? !checks_made(row) : isnan(row->goal_error))
        fputs("checked before", file);
    else if (elastic)
        fprintf(file, "all %d checks hold", checks_made(row));
    else
        fprintf(file, "goals %.1e, drift %.0e%s", row->goal_error, row->drift,
                row->plain ? " plain" : "");
    if (row->sampled)
        fprintf(file, ", of %ld of %ld particles alone", row->sampled, row->particles);
    if (row->left_out) fprintf(file, ", %ld left out", row->left_out);
    print_lost(file, row, "; ");
    if (row->busy) {
        fputc('\n', file);
        return;
    }
    bench_grid_range(row->total_low_ms, row->total_high_ms, range);
    fprintf(file, "; %s ms", range);
    if (row->elastic.whole_ms > 0)
        fprintf(file, " with new cracks, %.3g without", row->elastic.whole_ms);
    fputc('\n', file);
}

void bench_explain_briefly(FILE *file, const BenchRow *rows, int count)
{
    int width = 0;
    for (int r = 0; r < count; r++)
        if ((int)strlen(rows[r].scene) > width) width = (int)strlen(rows[r].scene);
    fputs(
        "On the state that was timed: goals off in cells; drift of the velocity, in cells a step, "
        "over free\nsteps; then times' quartiles (more: --explain)\n",
        file);
    for (int r = 0; r < count; r++) {
        brief_row(file, &rows[r], width);
        bench_change_left(file, "    ", rows[r].change.left);
    }
}

/* ---- all of a row */

/* How far a count is from the paper's, in brackets; nothing where the paper has none. */
static void print_difference(FILE *file, double count, double paper)
{
    if (isfinite(paper)) fprintf(file, " (%+.1f%% of the paper's)", 100 * (count / paper - 1));
}

static void print_counts(FILE *file, const BenchRow *row)
{
    const RefPaperRow *paper = ref_paper_find(row->paper, row->paper_row);
    bool elastic = bench_row_of_elastic(row);
    fprintf(file, "    %ld %s", row->particles, elastic ? "points" : "particles");
    if (paper) print_difference(file, (double)row->particles, paper->particles.value);
    fprintf(file, ", %ld %s", row->regions, elastic ? "nodes" : "regions");
    if (paper)
        print_difference(file, (double)row->regions,
                         elastic ? paper->nodes.value : paper->regions.value);
    fputs(";\n", file);
}

static void print_stages(FILE *file, const BenchRow *row)
{
    const RefPaperRow *paper = ref_paper_find(row->paper, row->paper_row);
    const char *joint = "    ms: ", *stage;
    char number[BENCH_GRID_TEXT];
    for (int s = 0; s < SM_STAGES; s++) {
        stage = sm_engine_stage(bench_engine(row->engine)->type[0], (SmStage)s);
        if (!stage) continue;
        fputs(joint, file);
        joint = ", ";
        for (; *stage; stage++) fputc(*stage == '_' ? ' ' : *stage, file);
        bench_grid_number(row->stage_ms[s], number);
        fprintf(file, " %s", number);
        if (!paper || !isfinite(paper->stage_ms[s].value)) continue;
        bench_grid_number(paper->stage_ms[s].value, number);
        fprintf(file, " (paper %s)", number);
    }
    bench_grid_number(row->ns_per_particle_step, number);
    fprintf(file, "; %s ns a particle and step\n", number);
}

/* What timing stages costs; a negative share is noise. */
static void print_instruments(FILE *file, double percent)
{
    if (isnan(percent))
        fputs("clocks inside the steps;\n", file);
    else if (percent >= 0.05)
        fprintf(file, "timing the stages makes a step %.1f%% longer; the total is without it;\n",
                percent);
    else
        fputs("timing the stages costs nothing that can be measured;\n", file);
}

static void print_check(FILE *file, const BenchRow *row)
{
    fprintf(file, "  %s, %s in %s precision: %s: ", row->scene, row->engine, row->precision,
            bench_row_mark(row));
    if (!row->valid) {
        fprintf(file, "%s\n", row->reason);
        return;
    }
    print_lost(file, row, "");
    if (row->busy) {
        fprintf(file, ";\n    %s\n", row->found);
        return;
    }
    if (row->reason[0]) fputs("; ", file);
    fprintf(file, "%s;\n    quartiles %.4g to %.4g ms, %d repeats of %d step%s; ", row->found,
            row->total_low_ms, row->total_high_ms, row->repeats, row->steps,
            row->steps == 1 ? "" : "s");
    print_instruments(file, row->instruments_percent);
    print_counts(file, row);
    print_stages(file, row);
    if (bench_row_of_elastic(row)) return;
    fprintf(file, "    voxelised in %.3g ms, built in %.3g ms, %.4g bytes a particle\n",
            1e3 * row->voxelise_seconds, 1e3 * row->build_seconds,
            (double)row->bytes / (double)row->particles);
}

/* How many times as fast as a lattice an octree of the same body is, like with like; the paper's 88
 * is of an adaptive one, both without low-level optimisation. */
static void print_speedups(FILE *file, const BenchRow *rows, int count)
{
    const RefPaperClaim *claim = ref_paper_claim("octree", "hand-speedup");
    for (int r = 0; r < count; r++) {
        const BenchRow *lattice = bench_row_lattice(rows, count, &rows[r]);
        if (!bench_engine(rows[r].engine)->sampled || !lattice || !(rows[r].speedup > 0)) continue;
        bool same = !strcmp(lattice->paper_row, "hand-lattice-plain") && rows[r].wanted_nodes > 0;
        fprintf(file, "  %s is %.3g times as fast as %s, both with %s rotations", rows[r].scene,
                rows[r].speedup, lattice->scene, rows[r].polar);
        if (same) fprintf(file, " (paper, %s: %.0f times)", claim->place, claim->value.value);
        fputc('\n', file);
    }
}

static void print_notes(FILE *file, const BenchRow *rows, int count)
{
    for (int r = 0; r < count; r++) {
        const RefPaperRow *paper = ref_paper_find(rows[r].paper, rows[r].paper_row);
        if (paper && paper->note[0]) fprintf(file, "  %s, paper: %s\n", rows[r].scene, paper->note);
    }
}

void bench_explain_rows(FILE *file, const BenchRow *rows, int count)
{
    for (int r = 0; r < count; r++) {
        const BenchRow *row = &rows[r];
        print_check(file, row);
        bench_change_left(file, "    ", row->change.left);
        if (row->change.frames)
            fprintf(file, "    its surface has %ld triangles, at the end %ld in %ld piece%s\n",
                    row->change.first_triangles, row->change.last_triangles, row->change.pieces,
                    row->change.pieces == 1 ? "" : "s");
        const BenchEngine *engine = bench_engine(row->engine);
        if (engine->explain) engine->explain(file, row);
    }
    print_speedups(file, rows, count);
    print_notes(file, rows, count);
}
