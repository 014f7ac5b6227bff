/* What a history is written as. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../store/export.h"
#include "../table/grid.h"
#include "history.h"

const char *const bench_history_formats[] = {"text", "markdown", "json", NULL};

/* ---- for people */

/* "monday.h5 (2026-11-23T10:00, 0123456789ab)" */
static void name_file(const BenchHistoryFile *file, size_t size, char *text)
{
    const BenchMachine *machine = &file->machine;
    snprintf(text, size, "%s (%.16s, %.12s%s)", file->path, machine->utc, machine->git_commit,
             machine->git_dirty ? "+" : "");
    sm_printable(text);
}

static void fill_grid(const BenchHistory *history, BenchGrid *grid)
{
    bool cycles = history->by_cycles;
    *grid = (BenchGrid){0};
    bench_grid_column(grid, "scene", true);
    bench_grid_column(grid, "threads", false);
    bench_grid_column(grid, "files", false);
    bench_grid_column(grid, cycles ? "oldest cycles" : "oldest ms", false);
    bench_grid_column(grid, cycles ? "newest cycles" : "newest ms", false);
    bench_grid_column(grid, "newest/oldest", false);
    bench_grid_column(grid, "changes", false);
    for (int s = 0; s < history->count; s++) {
        const BenchSeries *series = &history->series[s];
        const BenchHistoryPoint *first = series->point, *last = first + series->points - 1;
        BenchGridLine *line = bench_grid_add(grid);
        snprintf((*line)[0], BENCH_GRID_TEXT, "%s", first->row->scene);
        snprintf((*line)[1], BENCH_GRID_TEXT, "%d", first->row->threads);
        snprintf((*line)[2], BENCH_GRID_TEXT, "%d", series->points);
        bench_grid_number(first->value, (*line)[3]);
        bench_grid_number(last->value, (*line)[4]);
        snprintf((*line)[5], BENCH_GRID_TEXT, "%.3f", last->value / first->value);
        if (series->points < BENCH_CHANGE_LEAST)
            strcpy((*line)[6], "-");
        else
            snprintf((*line)[6], BENCH_GRID_TEXT, "%d", series->changes);
    }
}

static void write_changes(FILE *file, const BenchHistory *history, const char *bullet)
{
    char name[320];
    for (int s = 0; s < history->count; s++)
        for (int c = 0; c < history->series[s].changes; c++) {
            const BenchSeries *series = &history->series[s];
            const BenchHistoryChange *one = &series->change[c];
            const BenchHistoryPoint *point = &series->point[one->change.first];
            bool slower = one->ratio.ratio > 1;
            name_file(&history->file[point->file], sizeof name, name);
            fprintf(file, "%s%s is %s from %s on: %.3f times (%.3f to %.3f), p %.3f", bullet,
                    point->row->scene, slower ? "slower" : "faster", name, one->ratio.ratio,
                    one->ratio.low, one->ratio.high, one->change.p);
            for (int m = 0; m < history->marks; m++)
                if (history->mark[m].file == point->file)
                    fprintf(file, "; there the %s changed", history->mark[m].what);
            fputc('\n', file);
        }
}

static void write_text(FILE *file, const BenchHistory *history, bool markdown)
{
    BenchGrid grid;
    char first[320], last[320];
    const char *bullet = markdown ? "- " : "  ";
    int most = 0;
    name_file(&history->file[0], sizeof first, first);
    name_file(&history->file[history->files - 1], sizeof last, last);
    fprintf(file, "%d file%s, from %s to %s.\n\n", history->files, history->files > 1 ? "s" : "",
            first, last);
    fill_grid(history, &grid);
    bench_grid_whole(file, &grid, markdown ? BENCH_GRID_MARKDOWN : BENCH_GRID_PLAIN);
    bench_grid_free(&grid);
    fputc('\n', file);
    write_changes(file, history, bullet);
    for (int m = 0; m < history->marks; m++) {
        const BenchHistoryMark *mark = &history->mark[m];
        fprintf(file, "%s%s: %s %s, before %s\n", bullet, history->file[mark->file].path,
                mark->what, mark->new, mark->old);
    }
    for (int s = 0; s < history->count; s++)
        if (history->series[s].points > most) most = history->series[s].points;
    if (most < BENCH_CHANGE_LEAST)
        fprintf(file, "%sno change can be told from noise in fewer than %d files of a scene\n",
                bullet, BENCH_CHANGE_LEAST);
}

/* ---- for programs */

static json_t *series_json(const BenchSeries *series)
{
    const BenchRow *row = series->point[0].row;
    json_t *points = json_array(), *changes = json_array();
    for (int i = 0; i < series->points; i++) {
        const BenchHistoryPoint *point = &series->point[i];
        json_array_append_new(points, json_pack("{s:i, s:o, s:o, s:o}", "file", point->file,
                                                "value", bench_json_number(point->value), "low",
                                                bench_json_number(point->low), "high",
                                                bench_json_number(point->high)));
    }
    for (int c = 0; c < series->changes; c++) {
        const BenchHistoryChange *one = &series->change[c];
        json_array_append_new(changes,
                              json_pack("{s:i, s:o, s:o, s:o, s:o}", "point", one->change.first,
                                        "p", bench_json_number(one->change.p), "ratio",
                                        bench_json_number(one->ratio.ratio), "low",
                                        bench_json_number(one->ratio.low), "high",
                                        bench_json_number(one->ratio.high)));
    }
    return json_pack("{s:o, s:o, s:o, s:i, s:o, s:o}", "scene", bench_json_text(row->scene),
                     "engine", bench_json_text(row->engine), "precision",
                     bench_json_text(row->precision), "threads", row->threads, "points", points,
                     "changes", changes);
}

static void write_json(FILE *file, const BenchHistory *history)
{
    json_t *files = json_array(), *series = json_array(), *marks = json_array();
    for (int f = 0; f < history->files; f++) {
        const BenchMachine *machine = &history->file[f].machine;
        json_array_append_new(files, json_pack("{s:o, s:o, s:o, s:b}", "file",
                                               bench_json_text(history->file[f].path), "utc",
                                               bench_json_text(machine->utc), "commit",
                                               bench_json_text(machine->git_commit), "dirty",
                                               (int)machine->git_dirty));
    }
    for (int s = 0; s < history->count; s++)
        json_array_append_new(series, series_json(&history->series[s]));
    for (int m = 0; m < history->marks; m++) {
        const BenchHistoryMark *mark = &history->mark[m];
        json_array_append_new(marks, json_pack("{s:i, s:s, s:o, s:o}", "file", mark->file, "what",
                                               mark->what, "old", bench_json_text(mark->old), "new",
                                               bench_json_text(mark->new)));
    }
    bench_json_write(file, json_pack("{s:i, s:s, s:o, s:o, s:o}", "schema", 1, "by",
                                     history->by_cycles ? "cycles" : "time", "files", files,
                                     "series", series, "marks", marks));
}

void bench_history_write(FILE *file, BenchHistoryFormat format, const BenchHistory *history)
{
    switch (format) {
    case BENCH_HISTORY_TEXT:
    case BENCH_HISTORY_MARKDOWN:
        write_text(file, history, format == BENCH_HISTORY_MARKDOWN);
        break;
    case BENCH_HISTORY_JSON:
        write_json(file, history);
        break;
    }
}
