#include "change_grid.h"

#include <math.h>
#include <string.h>

#include "../../reference/paper.h"

enum {
    SCENE,
    NODES,
    ADDED,
    SIMULATION,
    RESAMPLING,
    FOLLOWING,
    SURFACE,
    TRIANGLES, /* this and the next ones not as text */
    PIECES,
    VERDICT
};

static const char *const headings[] = {
    "scene",        "nodes",      "added at once", "simulation ms", "resampling ms",
    "splitting ms", "surface ms", "triangles",     "pieces",        "check",
};

/* "a -> b", or the one that there is, or "-"; `second_hand` marks those that are second-hand. */
static void pair_text(double from, double to, const char *joint, bool second_hand,
                      char text[BENCH_GRID_TEXT])
{
    char a[BENCH_GRID_TEXT], b[BENCH_GRID_TEXT];
    const char *mark = second_hand ? "*" : "";
    bench_grid_number(from, a);
    bench_grid_number(to, b);
    if (isfinite(from) && isfinite(to))
        snprintf(text, BENCH_GRID_TEXT, "%.20s%s%s%.20s%s", a, mark, joint, b, mark);
    else
        snprintf(text, BENCH_GRID_TEXT, "%.20s%s", isfinite(from) ? a : b,
                 isfinite(from) || isfinite(to) ? mark : "");
}

static void count_text(double from, double to, char text[BENCH_GRID_TEXT])
{
    if (isfinite(from) && isfinite(to))
        snprintf(text, BENCH_GRID_TEXT, "%.0f -> %.0f", from, to);
    else
        strcpy(text, "-");
}

static void measured_line(const BenchRow *row, BenchGridLine *line)
{
    const BenchChangeRow *c = &row->change;
    snprintf((*line)[SCENE], BENCH_GRID_TEXT, "%.60s", row->scene);
    count_text((double)c->first_nodes, (double)c->most_nodes, (*line)[NODES]);
    snprintf((*line)[ADDED], BENCH_GRID_TEXT, "%ld", c->most_added);
    count_text((double)c->first_triangles, (double)c->last_triangles, (*line)[TRIANGLES]);
    snprintf((*line)[PIECES], BENCH_GRID_TEXT, "%ld", c->pieces);
    const char *mark = bench_row_mark(row);
    strcpy((*line)[VERDICT], mark);
    for (int column = SIMULATION; column <= SURFACE; column++)
        strcpy((*line)[column], row->valid ? "BUSY" : mark);
    if (!row->valid || bench_row_frames_busy(row)) return;
    pair_text(c->first_ms, c->last_ms, " -> ", false, (*line)[SIMULATION]);
    pair_text(c->change_ms, c->change_most_ms, " to ", false, (*line)[RESAMPLING]);
    bench_grid_number(c->follow_ms, (*line)[FOLLOWING]);
    bench_grid_number(c->surface_ms, (*line)[SURFACE]);
}

static void paper_line(const RefPaperRow *paper, BenchGridLine *line)
{
    strcpy((*line)[SCENE], "  paper");
    count_text(paper->particles.value, paper->last_particles.value, (*line)[NODES]);
    bench_grid_number(paper->added.value, (*line)[ADDED]);
    pair_text(paper->total_ms.value, paper->last_ms.value, " -> ",
              ref_paper_step_status(paper) == REF_SECOND_HAND, (*line)[SIMULATION]);
    pair_text(paper->change_ms.value, paper->change_most_ms.value, " to ", false,
              (*line)[RESAMPLING]);
    bench_grid_number(paper->surface_ms.value, (*line)[SURFACE]);
}

void bench_change_left(FILE *file, const char *before, long left)
{
    if (left)
        fprintf(file, "%sthe surface of %ld bod%s could not follow a cut everywhere\n", before,
                left, left == 1 ? "y" : "ies");
}

void bench_change_grid(const BenchRow *rows, int count, BenchGridForm form, BenchGrid *grid)
{
    int last = form == BENCH_GRID_PLAIN ? SURFACE : VERDICT;
    *grid = (BenchGrid){0};
    for (int r = 0; r < count; r++) {
        const BenchRow *row = &rows[r];
        if (row->change.frames == 0) continue;
        for (int f = 0; f <= last && grid->columns <= last; f++)
            bench_grid_column(grid, headings[f], f == SCENE || f == VERDICT);
        measured_line(row, bench_grid_add(grid));
        const RefPaperRow *paper =
            row->paper[0] ? ref_paper_find(row->paper, row->paper_row) : NULL;
        if (paper) paper_line(paper, bench_grid_add(grid));
    }
}
