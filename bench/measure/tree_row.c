#include "tree_row.h"

#include <math.h>

#include "../../octree/engine.h"
#include "../../reference/paper.h"

void bench_tree_row_fill(const BenchRunner *runner, BenchRow *row)
{
    const BenchScene *scene = runner->scene;
    const OctStructure *s = oct_engine_structure(runner->engine);
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    row->particles = counts.particles;
    row->instances = runner->body->instances;
    row->bytes = runner->bytes;
    row->epsilon = scene->octree.epsilon;
    row->summation_nodes = s->regions.mean;
    row->most_summation = s->regions.most;
    row->width_cells = s->width.cells;
    row->width_edges = s->width.edges;
    row->wanted_summation = scene->octree.summation_nodes;
    row->reached = 0.5 * s->regions.mean_width;
    row->most_reached = 0.5 * s->regions.most_width;
    row->bases = s->report.bases;
    row->cells = runner->body->voxels.cell_count;
    row->parts = oct_structure_parts(s);
    row->wanted_nodes = s->report.wanted_nodes;
    row->wanted_bases = s->report.wanted_bases;
    row->local_nodes = s->local_leaves;
    row->welded_cells = s->report.welded_cells;
    row->welded_pairs = s->report.welded_pairs;
    row->splits = s->report.splits;
    row->balance_splits = s->report.balance_splits;
    row->unasked_splits = s->report.unasked_splits;
    row->plain = scene->octree.weighting == OCT_PLAIN;
    row->masses = (int)scene->octree.masses;
    row->symmetry = (int)scene->octree.symmetry;
}

static void tell_wanted(FILE *file, long wanted, long count)
{
    if (wanted && wanted != count) fprintf(file, " (nearest to the %ld wanted)", wanted);
}

/* Parts of a sentence, without an end of line: bodies, nodes, base cells, cells. */
static void tell_nodes(FILE *file, const BenchRow *row)
{
    long nodes = row->instances > 1 ? row->particles / row->instances : row->particles;
    if (row->instances > 1) fprintf(file, "%ld bodies of ", row->instances);
    fprintf(file, "%ld nodes", nodes);
    tell_wanted(file, row->wanted_nodes, nodes);
    if (row->unasked_splits)
        fprintf(file, ", %ld of %ld splits asked for by no criterion,", row->unasked_splits,
                row->splits);
    fprintf(file, " from %ld base cells", row->bases);
    tell_wanted(file, row->wanted_bases, row->bases);
    if (row->balance_splits) fprintf(file, ", %ld splits for balance alone", row->balance_splits);
    fprintf(file, ", %ld finest cells", row->cells);
}

static void tell_widths(FILE *file, const BenchRow *row)
{
    char width[BENCH_WIDTH_TEXT];
    long nodes = row->instances > 1 ? row->particles / row->instances : row->particles;
    bench_width_text(&(OctWidth){row->width_cells, row->width_edges}, width);
    if (row->local_nodes < nodes) fprintf(file, "w = %s", width);
    if (row->wanted_summation > 0 && row->local_nodes < nodes)
        fprintf(file, ", found for %.4g summation nodes a region", row->wanted_summation);
    if (row->local_nodes == nodes)
        fputs("w local at all nodes", file);
    else if (row->local_nodes > 0)
        fprintf(file, ", w local at %ld of %ld nodes", row->local_nodes, nodes);
    fprintf(file, ", epsilon %g", row->epsilon);
    if (row->symmetry == OCT_INTERSECTION) fputs(", symmetry by intersection", file);
    if (row->symmetry == OCT_ASYMMETRIC) fputs(", not symmetric", file);
    if (row->masses == OCT_VOLUME) fputs(", masses by volume", file);
}

static void tell_regions(FILE *file, const BenchRow *row)
{
    fprintf(file, "%.3g summation nodes a region on average", row->summation_nodes);
    if (row->wanted_summation > 0 && fabs(row->summation_nodes / row->wanted_summation - 1) > 0.005)
        fprintf(file, " (nearest to the %.4g wanted)", row->wanted_summation);
    fprintf(file, ", %ld at most; regions reach %.3g finest cells on average, %.4g at most",
            row->most_summation, row->reached, row->most_reached);
}

/* Whether the body holds together, where its nodes weld it, and its memory: "the body" precedes
 * it. */
static void tell_body(FILE *file, const BenchRow *row)
{
    if (row->parts == 1)
        fputs("is held together by its regions", file);
    else if (row->width_edges >= 1 && row->local_nodes == 0)
        fprintf(file, "falls into %ld parts whose nodes no region joins", row->parts);
    else
        fprintf(file,
                "falls into %ld parts that no region joins (a w of 1 edge of each node's own cell "
                "joins what touches)",
                row->parts);
    if (row->welded_cells || row->welded_pairs)
        fprintf(file, "; coarse nodes weld what does not touch: %ld inside, %ld pairs",
                row->welded_cells, row->welded_pairs);
    fprintf(file, "; %.3g MB", 1e-6 * (double)row->bytes);
}

void bench_tree_row_describe(const BenchRunner *runner, const SmCounts *counts)
{
    (void)counts;
    BenchRow row = {0};
    bench_tree_row_fill(runner, &row);
    printf("%s: octree, %s precision: ", runner->scene->name, runner->type->precision);
    tell_nodes(stdout, &row);
    printf(" of %.6g\nregions: ", runner->body->voxels.cell);
    tell_widths(stdout, &row);
    fputs(": ", stdout);
    tell_regions(stdout, &row);
    fputs("\nthe body ", stdout);
    tell_body(stdout, &row);
    putchar('\n');
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

void bench_tree_row_explain(FILE *file, const BenchRow *row)
{
    const RefPaperRow *paper = row->paper[0] ? ref_paper_find(row->paper, row->paper_row) : NULL;
    fputs("    ", file);
    tell_nodes(file, row);
    if (paper && isfinite(paper->bases.value))
        fprintf(file, "; paper: %.0f from %.0f", paper->particles.value, paper->bases.value);
    fputs(";\n    ", file);
    tell_widths(file, row);
    fputs(";\n    ", file);
    tell_regions(file, row);
    fputs(";\n    the body ", file);
    tell_body(file, row);
    fputc('\n', file);
    if (bench_row_timed(row)) print_groups(file, row);
}
